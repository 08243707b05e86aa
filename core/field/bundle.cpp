#include "core/field/bundle.h"

#include <algorithm>
#include <cmath>

#include "core/field/kernel.h"
#include "core/math/direction.h"
#include "core/math/offset.h"

namespace ivory {
namespace {

// Doubles below are computed to nearest; each result that has to bound something is moved by
// `margin` of the magnitudes that entered it. No chain here is longer than some 40 roundings.
constexpr double margin = 0x1p-46;
constexpr double more = 1 + 0x1p-46, less = 1 - 0x1p-46;

// Windows are halved until f'' could bend f by less than this share of T over one of them.
constexpr double bend_limit = 2;

constexpr double coarse_cut_share = 0x1p-26, fine_cut_share = 0x1p-40;

// And until what is only known of |f'|, near the axes of circles, could change f by no more than
// this share of T; but not below this share of the least width.
constexpr double kink_limit = 0x1p-6, least_length = 0x1p-5;
constexpr std::size_t greatest_depth = 30;

// The s'' of a circle is bounded where r / rho stays below this; else the element counts as kinked.
constexpr double greatest_outward = 32;

// sup of x e^-x^2 and of x^3 e^-x^2 for x >= 0 are 0.4289 and 0.4099.
constexpr double unit_slope = 0.43;

double peak_of(KernelKind kind, double s) {
    if (kind == KernelKind::blinn) return exp_nearest(-s) * more + 1e-300;
    return kernel_at(kind, s).hi;
}

KernelKind kernel_of(std::uint32_t group) { return static_cast<KernelKind>(group % 3); }
Shape shape_of(std::uint32_t group) { return static_cast<Shape>(group / 3); }

// An upper bound of w / (2 |b|) |F'| = x |k'| <= sqrt(s) |k'| where s >= least: for Blinn's, with
// s = least + y, e^-s sqrt(s) <= e^-least (sqrt(least) + sup sqrt(y) e^-y); for the other two the
// greatest value of sqrt(s) |k'| is 1 and 0.79.
double slope_of(KernelKind kind, double least, double peak) {
    if (kind != KernelKind::blinn) return least >= 1 ? 0 : 1;
    return std::min(unit_slope, peak * (std::sqrt(least) + unit_slope)) * more;
}

// Rounding errors of one entry, with u the unit roundoff of its stage, eta the error of `away` and
// eta_slope that of its direction, both in widths. Blinn's: the computed s is off by
//     ds <= 2 sqrt(s) eta + eta^2 + 7 u s,
// five roundings of the square and one of 1 / w^2; the exponential adds 2 u, so that with
// e^ds <= 1.02 |dk| <= 1.02 e^-s (ds + 2 u). (For s in the hundreds e^ds is larger, but then
// e^-(s - least) or e^-s itself leaves nothing to bound.) Now e^-s s^(j/2) <= peak (sqrt(least) +
// c_j)^j with c_j < 1, since sqrt(s) <= sqrt(least) + sqrt(s - least) and the suprema of y^(j/2)
// e^-y are 0.43, 0.37, 0.41 for j = 1, 2, 3. With r = sqrt(least) + 1 that is at most
//     |dF|  <= |b| peak (3 eta r + 10 u r^2),
//     |dF'| <= 2 |b| / w peak (4 eta_slope r^2 + 40 u r^3),
// the second from |d(k x)| <= |dk| sqrt(s) + 1.02 k (eta_slope + 5 u sqrt(s)) and four more
// roundings. The other kernels: |k'| <= 3, |k''| <= 20.25, s <= 1 where k is not 0, and ten
// roundings.
struct EntryErrors {
    double value, slope;
};

EntryErrors errors_of(KernelKind kind, double u, double eta, double eta_slope, double least,
                      double peak) {
    if (kind == KernelKind::blinn) {
        const double r = std::sqrt(least) + 1;
        return {peak * (3 * eta + 10 * u * r) * r, peak * (4 * eta_slope + 40 * u * r) * r * r};
    }
    return {8 * eta + 60 * u, 60 * eta_slope + 300 * u};
}

}  // namespace

bool BundleField::build(const Field& field, const ElementList& list, const Bundle& bundle,
                        double tolerance) {
    bundle_ = bundle;
    spread_ = bundle.spread * more + 0x1p-49;
    span_ = Interval<double>::empty_set();
    elements_.clear();
    if (!field.compact || !(bundle.spread <= 0.5)) return false;
    const Vec3d& o = bundle.origin;
    const Vec3d& d = bundle.axis;
    if (!(std::max({std::abs(o.x), std::abs(o.y), std::abs(o.z)}) < 1e30)) return false;
    if (list.certainly_empty || field.box.empty()) return true;

    // Every ray is in the box at t only if the axis is in the box made larger by t spread.
    double farthest = 0;
    Box3 box = field.box;
    for (std::size_t k = 0; k < 3; ++k) {
        const double side = std::max(std::abs(box.lo[k] - o[k]), std::abs(box.hi[k] - o[k]));
        farthest += side * side;
    }
    farthest = std::sqrt(farthest) * more;
    const double aside = farthest * spread_ * more + farthest * margin;
    for (std::size_t k = 0; k < 3; ++k) {
        box.lo[k] -= aside + std::abs(box.lo[k]) * margin;
        box.hi[k] += aside + std::abs(box.hi[k]) * margin;
    }
    span_ = {0.0, infinity<double>};
    for (std::size_t k = 0; k < 3; ++k) {
        if (std::abs(d[k]) > 1e-9) {  // smaller ones bound nothing that matters
            const Interval<double> slab(box.lo[k], box.hi[k]);
            span_ = intersection(span_, (slab - Interval<double>(o[k])) / Interval<double>(d[k]));
        } else if (d[k] == 0 && (o[k] < box.lo[k] || o[k] > box.hi[k])) {
            span_ = Interval<double>::empty_set();
        }
    }
    if (is_empty(span_)) return true;
    span_.hi = std::min(span_.hi * more, farthest * more);
    span_.lo = std::max(span_.lo * less, 0.0);
    if (!(span_.lo < span_.hi)) {
        span_ = Interval<double>::empty_set();
        return true;
    }

    int exponent = 0;
    std::frexp(field.threshold, &exponent);
    scale_ = std::ldexp(1.0, -exponent);
    threshold_ = field.threshold * scale_;
    std::frexp(field.greatest_width, &exponent);
    unit_ = std::ldexp(1.0, exponent - 1);
    least_width_ = field.least_width;
    coarse_cut_ = threshold_ * coarse_cut_share;
    fine_cut_ = threshold_ * std::min(fine_cut_share, tolerance * 0x1p-16);
    rest_above_ = std::max(list.rest.hi, 0.0) * scale_ * more;
    rest_below_ = std::max(-list.rest.lo, 0.0) * scale_ * more;

    for (const std::uint32_t i : list.elements) {
        Element e;
        e.index = i;
        e.group = static_cast<std::uint32_t>(field.shape[i]) * 3 +
                  static_cast<std::uint32_t>(field.kernel[i]);
        e.c = field.a(i);
        e.from_origin = e.c - o;
        e.m = {};
        e.extra = 0;
        e.length = 0;
        if (field.shape[i] == Shape::segment) {
            e.m = field.b(i) - field.a(i);
            const double square = dot(e.m, e.m);
            e.length = std::sqrt(square);
            // A segment as short as that counts as its end a; `etas` adds its length.
            e.extra = e.length > 1e-40 ? 1 / square : 0;
        } else if (field.shape[i] == Shape::circle) {
            e.m = ivory::unit(field.b(i));  // not the member
            e.extra = field.radius[i];
        }
        e.width = field.width[i];
        e.inverse_square = 1 / (e.width * e.width);
        e.strength = field.strength[i] * scale_;
        e.along = dot(e.from_origin, d);
        const Vec3d across = e.from_origin - e.along * d;
        e.across_square = dot(across, across);
        e.far = std::sqrt(dot(e.from_origin, e.from_origin)) * more + e.length +
                (field.shape[i] == Shape::circle ? e.extra : 0);
        elements_.push_back(e);
    }
    return true;
}

double BundleField::distance(const Element& e, double t) const {
    if (shape_of(e.group) == Shape::point) {
        const double x = t - e.along;
        return std::sqrt(e.across_square + x * x);
    }
    const Vec3d v = t * bundle_.axis - e.from_origin;
    if (shape_of(e.group) == Shape::segment) {
        const double lambda = std::min(std::max(dot(v, e.m) * e.extra, 0.0), 1.0);
        const Vec3d away = v - lambda * e.m;
        return std::sqrt(dot(away, away));
    }
    const double h = dot(v, e.m);
    const Vec3d across = v - h * e.m;
    const double off = std::sqrt(dot(across, across)) - e.extra;
    return std::sqrt(off * off + h * h);
}

namespace {

// (1) of bundle.h: a lower bound of the distance between two places at most L apart from lower
// bounds of those there, with which it rises. Errors have to be taken off before: near 0 the result
// follows their square roots.
double least_between(double d0, double d1, double L) {
    const double square0 = d0 * d0, square1 = d1 * d1, squareL = L * L;
    const double half = 0.5 * (squareL + square0 - square1);  // of y L^2 at the vertex
    double least = std::min(square0, square1);
    if (half > 0 && half < squareL) least = square0 - half * half / squareL;
    least -= (square0 + square1 + squareL) * margin;
    return least > 0 ? std::sqrt(least) * less : 0;
}

}  // namespace

bool BundleField::bound(std::size_t depth, double t0, double t1) {
    if (bounded_by_depth_.size() <= depth + 1) bounded_by_depth_.resize(depth + 2);
    Bounded& here = bounded_by_depth_[depth];
    const Bounded* parent = depth > 0 ? &bounded_by_depth_[depth - 1] : nullptr;
    here.active.clear();
    here.rest_above = parent != nullptr ? parent->rest_above : rest_above_;
    here.rest_below = parent != nullptr ? parent->rest_below : rest_below_;
    const std::size_t count = parent != nullptr ? parent->active.size() : elements_.size();

    const double L = (t1 - t0) * more;
    const double aside = t1 * spread_ * more;
    double above = 0, sum = 0;
    for (std::size_t k = 0; k < count; ++k) {
        Active a;
        a.element = parent != nullptr ? parent->active[k].element : static_cast<std::uint32_t>(k);
        const Element& e = elements_[a.element];
        const KernelKind kind = kernel_of(e.group);
        const double error = (e.far + t1) * margin;
        const double d0 = distance(e, t0), d1 = distance(e, t1);
        const double near =
            least_between(std::max(d0 - error, 0.0), std::max(d1 - error, 0.0), L) - aside;
        // The distance to any set changes by at most L over the window; to a convex one it is
        // convex.
        const double far =
            (shape_of(e.group) == Shape::circle ? 0.5 * (d0 + d1 + L) : std::max(d0, d1)) + error +
            aside;
        a.least = near > 0 ? near * near * e.inverse_square * less : 0;
        a.most = far * far * e.inverse_square * more;
        a.peak = peak_of(kind, a.least);
        a.inverse = 0;
        const double most = std::abs(e.strength) * a.peak * more;
        if (most <= fine_cut_) {
            (e.strength > 0 ? here.rest_above : here.rest_below) += most;
            continue;
        }
        sum += most;
        if (e.strength > 0) above += most;
        here.active.push_back(a);
    }
    const double sums = 1 + static_cast<double>(count + 64) * 0x1p-52;
    here.rest_above *= sums;
    here.rest_below *= sums;
    const double slack = static_cast<double>(here.active.size() + 4) * 0x1p-52 * (sum + threshold_);
    if (above + here.rest_above + slack < threshold_) return false;

    here.rise = here.fall = here.kinks = 0;
    for (Active& a : here.active) {
        const Element& e = elements_[a.element];
        double rise = 0, fall = 0;
        bend(e, a, t0, t1, rise, fall);
        if (a.inverse < 0) {
            here.kinks +=
                2 * std::abs(e.strength) / e.width * slope_of(kernel_of(e.group), a.least, a.peak);
        }
        here.rise += (e.strength > 0 ? rise : fall) * std::abs(e.strength) * e.inverse_square;
        here.fall += (e.strength > 0 ? fall : rise) * std::abs(e.strength) * e.inverse_square;
    }
    here.rise *= 1 + 0x1p-30;
    here.fall *= 1 + 0x1p-30;
    return true;
}

// rise: an upper bound of w^2 (k'' s'^2 + k' s'') for all rays on the window; fall: of its
// negative.
void BundleField::bend(const Element& e, Active& a, double t0, double t1, double& rise,
                       double& fall) const {
    const KernelKind kind = kernel_of(e.group);
    // A circle: s'' w^2 / 2 = 1 - r rho'' lies in 1 - r / rho .. 1.
    double outward = 0;  // r / rho
    if (shape_of(e.group) == Shape::circle) {
        const auto rho_at = [&](double t) {
            const Vec3d v = t * bundle_.axis - e.from_origin;
            const Vec3d across = v - dot(v, e.m) * e.m;
            return std::sqrt(dot(across, across));
        };
        const double error = (e.far + t1) * margin;
        const double rho = least_between(std::max(rho_at(t0) - error, 0.0),
                                         std::max(rho_at(t1) - error, 0.0), (t1 - t0) * more) -
                           t1 * spread_ * more;
        const double inverse = 1 / rho;
        if (e.extra == 0) {
            a.inverse = 0;
        } else {
            a.inverse = rho > 0 && e.extra * inverse < greatest_outward ? inverse * more : -1;
        }
        if (a.inverse < 0) return;
        outward = e.extra * a.inverse;
    }
    if (kind == KernelKind::blinn) {
        // 2 e^-s (2 x^2 - 1 + outward), with y = x^2 at most s; for a point s = y + h^2.
        double y0 = a.least, y1 = a.most, h_square = 0;
        if (shape_of(e.group) == Shape::point) {
            const double across = std::sqrt(e.across_square);
            const double error = (e.far + t1) * margin;
            const double turn = e.far * spread_ * more;
            const double h = across - turn - error;
            h_square = h > 0 ? h * h * e.inverse_square * less : 0;
            const double slip =
                std::abs(e.along) * spread_ * spread_ + across * spread_ * more + error;
            const double x0 = t0 - e.along - slip, x1 = t1 - e.along + slip;
            const double near = x0 > 0 ? x0 : x1 < 0 ? x1 : 0;
            const double far = std::max(std::abs(x0), std::abs(x1));
            y0 = near * near * e.inverse_square * less;
            y1 = far * far * e.inverse_square * more;
            fall = (2 * std::max(1 - 2 * y0, 0.0) + margin) * a.peak;
        } else {
            fall = 2 * a.peak;
        }
        const double y = y1 <= 1.5 ? y1 : y0 >= 1.5 ? y0 : 1.5;  // (2 y - 1) e^-y rises up to 1.5
        if (y > 0.5) rise = 2 * (2 * y - 1) * peak_of(kind, y + h_square);
        rise += margin * a.peak;  // |d|^2 is 1 but for 2^-49
        rise += 2 * outward * a.peak;
        return;
    }
    if (a.least >= 1) return;
    // 4 x^2 k'' - 2 (1 - outward) |k'| with x^2 <= s.
    const double slope = -kernel_slope_at(kind, a.least).lo;
    double most;  // of 4 s k''
    if (kind == KernelKind::wyvill) {
        const double s = std::max(a.least, 17.0 / 24);  // 4 s (34 - 24 s) / 9 falls from there
        most = 4 * s * (34 - 24 * s) / 9;
    } else {
        most = 3 / std::sqrt(std::max(a.least, 1.0 / 9));  // 4 s 3/4 / q^3
    }
    rise = (most + 2 * std::max(outward - 1, 0.0) * slope) * more;
    fall = 2 * slope * more;
}

bool BundleField::splits(std::size_t depth, double t0, double t1) const {
    const Bounded& here = bounded_by_depth_[depth];
    const double L = t1 - t0;
    return depth < greatest_depth && L > least_length * least_width_ &&
           (std::max(here.rise, here.fall) * L * L > bend_limit * threshold_ ||
            here.kinks * L > kink_limit * threshold_);
}

void BundleField::finish(std::size_t depth, double t0, double t1) {
    constexpr double coarse_u = 0x1p-24, fine_u = 0x1p-53;
    Window& w = window_;
    const Bounded& here = bounded_by_depth_[depth];
    w.begin = t0;
    w.end = t1;
    w.axis = bundle_.axis;
    w.middle = 0.5 * (t0 + t1);
    const double inverse_unit = 1 / unit_;
    const auto tau = [&](double t) { return static_cast<float>((t - w.middle) * inverse_unit); };
    w.tau_begin = tau(t0) * (1 + 0x1p-22f);  // negative
    w.tau_end = tau(t1) * (1 + 0x1p-22f);
    w.rise = here.rise;
    w.fall = here.fall;
    w.coarse.clear();
    w.coarse_count.fill(0);
    w.fine.clear();
    w.fine_count.fill(0);
    w.fine_element.clear();

    // Lists by shape and kernel. Those of one shape already stand together.
    StageBounds coarse, fine;
    coarse.above = fine.above = here.rest_above;
    coarse.below = fine.below = here.rest_below;
    double coarse_sum = 0, fine_sum = 0;  // of the peaks, for the roundings of the sum
    double coarse_error = 0, fine_error = 0;
    bool usable = true;
    const double H = 0.5 * (t1 - t0) * more + t1 * spread_ * more;  // |p - middle| at most
    for (std::uint32_t group = 0; group < bundle_groups; ++group) {
        const KernelKind kind = kernel_of(group);
        const Shape shape = shape_of(group);
        for (const Active& a : here.active) {
            const Element& e = elements_[a.element];
            if (e.group != group) continue;
            const double b = std::abs(e.strength);
            const double most = b * a.peak * more;
            const double per_length = 2 * b / e.width * more;
            const bool kinked = a.inverse < 0;
            const double full_slope = per_length * slope_of(kind, a.least, a.peak);

            const Vec3d& o = bundle_.origin;
            const Vec3d& axis = bundle_.axis;
            const Vec3d c{-offset(o.x, e.c.x, w.middle, axis.x),
                          -offset(o.y, e.c.y, w.middle, axis.y),
                          -offset(o.z, e.c.z, w.middle, axis.z)};
            const double c_length = std::sqrt(dot(c, c)) * more;
            // |away| as computed is off by `eta` in widths. With t |d - axis| and |t - middle| at
            // most H, (2) costs 7 u H for p (d - axis, the product; t - middle, d, the product; the
            // sum), 2 u |c - M| and u^2 of its terms for c, and u (H + |c - M|) the difference. The
            // foot moves away by 10 u |p - c| more at the most; so does the circle's axis.
            const auto etas = [&](double u) {
                const double v_length = H + c_length;
                double eta = u * (8 * H + 4 * c_length) + (e.far + t1) * 0x1p-98;
                double eta_slope = 0;
                if (shape == Shape::segment) {
                    eta = 2 * eta + u * (12 * v_length + 3 * e.length) +
                          (e.extra == 0 ? e.length : 0);
                } else if (shape == Shape::circle) {
                    eta = 3 * eta + u * (16 * v_length + 3 * e.extra);
                    eta_slope = kinked ? 0 : e.extra * a.inverse * (4 * eta + 16 * u * v_length);
                }
                return EntryErrors{eta / e.width * more, (eta + eta_slope) / e.width * more};
            };

            {
                const EntryErrors eta = etas(fine_u);
                usable = usable && eta.value < 5e-4;
                const EntryErrors error =
                    errors_of(kind, fine_u, eta.value, eta.slope, a.least, a.peak);
                fine_error += b * error.value;
                fine.slope += kinked ? full_slope : per_length * error.slope;
                fine_sum += most;
                const double square = e.inverse_square;
                w.fine.push_back({c.x, c.y, c.z, square, e.strength,
                                  kinked ? 0 : 2 * e.strength * square, e.m.x, e.m.y, e.m.z,
                                  e.extra});
                w.fine_element.push_back(e.index);
                ++w.fine_count[group];
            }

            if (most <= coarse_cut_) {
                (e.strength > 0 ? coarse.above : coarse.below) += most;
                coarse.slope += full_slope;
                continue;
            }
            const EntryErrors eta = etas(coarse_u);
            usable = usable && eta.value < 5e-4 && eta.slope < 1e-2;
            const EntryErrors error =
                errors_of(kind, coarse_u, eta.value, eta.slope, a.least, a.peak);
            coarse_error += b * error.value;
            coarse.slope += kinked ? full_slope : per_length * error.slope;
            coarse_sum += most;
            const auto f = [](double x) { return static_cast<float>(x); };
            const double square = e.inverse_square * unit_ * unit_;
            const bool segment = shape == Shape::segment;
            const double m_unit = segment ? inverse_unit : 1;
            const double extra = segment ? e.extra * unit_ * unit_ : e.extra * inverse_unit;
            w.coarse.push_back({f(c.x * inverse_unit), f(c.y * inverse_unit), f(c.z * inverse_unit),
                                f(square), f(e.strength), kinked ? 0 : f(2 * e.strength * square),
                                f(e.m.x * m_unit), f(e.m.y * m_unit), f(e.m.z * m_unit), f(extra)});
            // 1 / |m|^2 of a very short segment and such are beyond float.
            usable = usable && square < 1e12 && extra < 1e12 && b < 1e12;
            ++w.coarse_count[group];
        }
    }
    const double sums = 1 + static_cast<double>(here.active.size() + 64) * 0x1p-51;
    const auto rounding = [&](double u, std::size_t count, double sum) {
        return static_cast<double>(count + 4) * u * (sum + threshold_) * sums;
    };
    coarse.above *= sums;
    coarse.below *= sums;
    const double coarse_rounding =
        coarse_error * sums + rounding(coarse_u, w.coarse.size(), coarse_sum) + 1e-30;
    const double fine_rounding =
        fine_error * sums + rounding(fine_u, w.fine.size(), fine_sum) + 1e-280;
    coarse.above += coarse_rounding;
    coarse.below += coarse_rounding;
    fine.above += fine_rounding;
    fine.below += fine_rounding;
    // The slope's own sum: each term is at most 2 b / w.
    double slope_sum = 0;
    for (const Active& a : here.active) {
        const Element& e = elements_[a.element];
        slope_sum +=
            2 * std::abs(e.strength) / e.width * slope_of(kernel_of(e.group), a.least, a.peak);
    }
    const double n = static_cast<double>(here.active.size() + 4);
    coarse.slope = (coarse.slope + n * coarse_u * slope_sum) * unit_ * sums + 1e-30;
    fine.slope = (fine.slope + n * fine_u * slope_sum) * sums + 1e-280;
    w.coarse_bounds = coarse;
    w.fine_bounds = fine;
    // No product of the walk's formulas comes near the end of float.
    w.coarse_usable = usable && (coarse_sum + threshold_) * w.rise * unit_ * unit_ < 1e30 &&
                      (coarse_sum + threshold_) * w.fall * unit_ * unit_ < 1e30 &&
                      slope_sum * unit_ < 1e14 && coarse.slope < 1e14;
}

}  // namespace ivory
