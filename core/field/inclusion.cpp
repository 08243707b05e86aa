#include "core/field/inclusion.h"

#include "core/interval/quick.h"

namespace ivory {
namespace {

constexpr double u = unit_roundoff;

// The field of one element of strength 1 over [t0, t1], in the notation of Enclosure.
struct Terms {
    Interval<double> left, right, value;
    Interval<double> left_slope, slope, curvature;
};

// [lo, hi] [k] for k >= 0, with room for four roundings of the ends.
Interval<double> times_positive(double lo, double hi, const Interval<double>& k) {
    const double x = lo * (lo >= 0 ? k.lo : k.hi), y = hi * (hi >= 0 ? k.hi : k.lo);
    return {x - std::abs(x) * (4 * u), y + std::abs(y) * (4 * u)};
}

// s' k.
Interval<double> slope_times(const SquareAt& at, const Interval<double>& k) {
    return times_positive(at.ds - at.ds_radius, at.ds + at.ds_radius, k);
}

// (s'^2 - s'') k; the difference cancels, so its rounding is counted by its terms.
Interval<double> bend_times(const SquareAt& at, const Interval<double>& c2,
                            const Interval<double>& k) {
    const double steepest = std::abs(at.ds) + at.ds_radius;
    const double flattest = std::max(std::abs(at.ds) - at.ds_radius, 0.0);
    const double most = steepest * steepest, fewest = flattest * flattest;
    const double rounding = 8 * u * (most + c2.hi);
    return times_positive(fewest - c2.hi - rounding, most - c2.lo + rounding, k);
}

// Blinn's kernel along a parabola s = least + c (t - t_0)^2: with x = s', c2 = s'' = 2 c,
//   k   = exp(-s)              extremum at x = 0: exp(-least)
//   k'  = -x exp(-s)           extrema at x^2 = c2: -+ sqrt(c2) exp(-1/2 - least)
//   k'' = (x^2 - c2) exp(-s)   extrema at x = 0: -c2 exp(-least), at x^2 = 3 c2: 2 c2 exp(-3/2 -
//   least)
// (a one-dimensional Gaussian; x rises with t, so each range is that of its ends and of the extrema
// between them).
Terms blinn_parabola(const MovingSquare& square, double peak, double t0, double t1) {
    const SquareAt a = square.at(t0), b = square.at(t1);
    const Interval<double> c2 = square.curvature();
    Terms k;
    k.left = exp_minus(a.s, a.s_radius);
    k.right = exp_minus(b.s, b.s_radius);
    const double x0 = a.ds - a.ds_radius, x1 = b.ds + b.ds_radius;
    const bool dips = x0 < 0 && x1 > 0;
    k.value = {std::min(k.left.lo, k.right.lo), dips ? peak : std::max(k.left.hi, k.right.hi)};

    const Interval<double> slope0 = slope_times(a, k.left);
    const Interval<double> slope1 = slope_times(b, k.right);
    Interval<double> slope = hull(slope0, slope1);
    const double steepest = std::sqrt(c2.hi) * (1 + 4 * u);  // >= sqrt(c2)
    const double flattest = std::sqrt(c2.lo) * (1 - 4 * u);  // <= sqrt(c2)
    // exp(-least) is the value at the foot on the whole line, even if that lies outside of the
    // window.
    const auto extreme = [&](double factor) {
        return std::min(factor * exp_minus(square.vertex, 0).hi, k.value.hi) * (1 + 8 * u);
    };
    if (x0 < steepest && x1 > flattest)
        slope.hi = std::max(slope.hi, steepest * extreme(0.60653065971263345));
    if (x0 < -flattest && x1 > -steepest)
        slope.lo = std::min(slope.lo, -steepest * extreme(0.60653065971263345));
    k.left_slope = -slope0;
    k.slope = -slope;

    const Interval<double> bend0 = bend_times(a, c2, k.left);
    const Interval<double> bend1 = bend_times(b, c2, k.right);
    k.curvature = hull(bend0, bend1);
    constexpr double root3 = 1.7320508075688774;
    const double outer = root3 * steepest * (1 + 4 * u), inner = root3 * flattest * (1 - 4 * u);
    if ((x0 < outer && x1 > inner) || (x0 < -inner && x1 > -outer)) {
        k.curvature.hi =
            std::max(k.curvature.hi, 2 * c2.hi * extreme(0.22313016014842985) * (1 + 8 * u));
    }
    if (dips) k.curvature.lo = std::min(k.curvature.lo, -c2.hi * peak * (1 + 4 * u));
    return k;
}

// exp(-s) over a thin [s], by one exponential.
Interval<double> blinn_over(const Interval<double>& s) {
    if (!(s.hi < infinity<double>)) return kernel_over(KernelKind::blinn, s);
    const double middle = midpoint(s);
    return exp_minus(middle, std::max(s.hi - middle, middle - s.lo) * (1 + 4 * u));
}

// Any kernel, from ranges of s, s' and s'': k(s(t))' = k' s', k(s(t))'' = k'' s'^2 + k' s''.
Terms composed(KernelKind kernel, const Interval<double>& s0, const Interval<double>& ds0,
               const Interval<double>& s1, const Interval<double>& s, const Interval<double>& ds,
               const Interval<double>& dds) {
    Terms k;
    const KernelRange range = kernel_range(kernel, s);
    if (kernel == KernelKind::blinn) {
        k.left = blinn_over(s0);
        k.right = blinn_over(s1);
        k.left_slope = quick::mul(-k.left, ds0);
    } else {
        k.left = kernel_over(kernel, s0);
        k.right = kernel_over(kernel, s1);
        k.left_slope =
            is_empty(s0)
                ? Interval<double>::entire()
                : quick::mul({kernel_slope_at(kernel, s0.lo).lo, kernel_slope_at(kernel, s0.hi).hi},
                             ds0);
    }
    k.value = range.k;
    k.slope = quick::mul(range.dk, ds);
    k.curvature = quick::add(quick::mul(range.ddk, quick::sqr(ds)), quick::mul(range.dk, dds));
    return k;
}

Terms parabola(KernelKind kernel, const MovingSquare& square, double peak, double t0, double t1) {
    if (kernel == KernelKind::blinn) return blinn_parabola(square, peak, t0, t1);
    const SquareAt a = square.at(t0), b = square.at(t1);
    const Interval<double> ds{a.ds - a.ds_radius, b.ds + b.ds_radius};  // s' rises
    return composed(kernel, a.value(), a.slope(), b.value(), square.over(a, b), ds,
                    square.curvature());
}

Terms hull(const Terms& a, const Terms& b) {
    return {hull(a.left, b.left),   hull(a.right, b.right),
            hull(a.value, b.value), hull(a.left_slope, b.left_slope),
            hull(a.slope, b.slope), hull(a.curvature, b.curvature)};
}

// Each piece over the part of the window in which it may be the nearest; s and s' pass continuously
// from piece to piece, s'' jumps, so the hull of the pieces' ranges encloses all three.
Terms squares(const ElementAlongRay& e, double t0, double t1) {
    Terms sum;  // all empty
    for (std::size_t i = 0; i < e.piece_count; ++i) {
        const Piece& piece = e.pieces[i];
        const double from = std::max(t0, piece.where.lo), to = std::min(t1, piece.where.hi);
        if (!(from <= to)) continue;
        Terms k = parabola(e.kernel, piece.square, e.peak, from, to);
        if (from > t0) k.left = k.left_slope = Interval<double>::empty_set();
        if (to < t1) k.right = Interval<double>::empty_set();
        sum = hull(sum, k);
    }
    return sum;
}

Terms circle(const ElementAlongRay& e, double t0, double t1) {
    const CircleAlongRay::At a = e.circle.at(t0), b = e.circle.at(t1);
    const CircleAlongRay::Over range = e.circle.over(t0, t1, a, b);
    return composed(e.kernel, a.s, a.ds, b.s, range.s, range.ds, range.dds);
}

Terms unbounded() {
    const Interval<double> k{0.0, 1.0};
    const Interval<double> all = Interval<double>::entire();
    return {k, k, k, all, all, all};
}

Terms element_over(const ElementAlongRay& e, double t0, double t1) {
    switch (e.form) {
        case ElementAlongRay::Form::squares:
            return squares(e, t0, t1);
        case ElementAlongRay::Form::circle:
            return circle(e, t0, t1);
        case ElementAlongRay::Form::unbounded:
            break;
    }
    return unbounded();
}

Interval<double> element_at(const ElementAlongRay& e, double t) {
    if (e.form == ElementAlongRay::Form::unbounded) return {0.0, 1.0};
    if (e.form == ElementAlongRay::Form::circle) {
        const Interval<double> s = e.circle.at(t).s;
        return e.kernel == KernelKind::blinn ? blinn_over(s) : kernel_over(e.kernel, s);
    }
    Interval<double> k = Interval<double>::empty_set();
    for (std::size_t i = 0; i < e.piece_count; ++i) {
        const Piece& piece = e.pieces[i];
        if (!(piece.where.lo <= t && t <= piece.where.hi)) continue;
        const SquareAt a = piece.square.at(t);
        k = hull(k, e.kernel == KernelKind::blinn ? exp_minus(a.s, a.s_radius)
                                                  : kernel_over(e.kernel, a.value()));
    }
    return k;
}

// A sum of intervals in plain doubles. n terms, each b k with one rounding, added one by one, err
// by at most (n + 2) u times the sum of their magnitudes, which `finish` subtracts and adds. A term
// that is unbounded on one side leaves the other side's bound alone.
class Sum {
  public:
    void add(double strength, const Interval<double>& k) {
        const double lo = strength > 0 ? strength * k.lo : strength * k.hi;
        const double hi = strength > 0 ? strength * k.hi : strength * k.lo;
        lo_ += lo;
        hi_ += hi;
        magnitude_lo_ += std::abs(lo);
        magnitude_hi_ += std::abs(hi);
    }
    [[nodiscard]] Interval<double> finish(std::size_t terms) const {
        const double relative = static_cast<double>(terms + 4) * 1.001 * u;
        const double lo = lo_ - (relative * magnitude_lo_ + 1e-300);
        const double hi = hi_ + (relative * magnitude_hi_ + 1e-300);
        // Overflow and NaN bound nothing.
        return {magnitude_lo_ < infinity<double> ? lo : -infinity<double>,
                magnitude_hi_ < infinity<double> ? hi : infinity<double>};
    }

  private:
    double lo_ = 0, hi_ = 0, magnitude_lo_ = 0, magnitude_hi_ = 0;
};

}  // namespace

void FieldAlongRay::build(const Field& field, const ElementList& list, const Vec3d& origin,
                          const Vec3d& direction, const Interval<double>& span) {
    elements_.clear();
    magnitude_ = 0;
    // All of f in units of a power of two near T: exact, but for strengths that overflow, which
    // then bound nothing, and what underflows beside T, which Sum's absolute term covers.
    threshold_ = std::frexp(field.threshold, &exponent_);
    Sum peaks, rest;
    const Interval<double> left_out(std::ldexp(list.rest.lo, -exponent_),
                                    std::ldexp(list.rest.hi, -exponent_));
    rest.add(1, left_out);
    peaks.add(1, left_out);
    peaks.add(-1, Interval<double>(threshold_));
    for (const std::uint32_t i : list.elements) {
        ElementAlongRay& element = elements_.emplace_back();
        along_ray(field, i, origin, direction, span, field.cut[i], element);
        element.strength = std::ldexp(element.strength, -exponent_);
        element.beyond = {std::ldexp(element.beyond.lo, -exponent_),
                          std::ldexp(element.beyond.hi, -exponent_)};
        // What is known of nothing but 0 <= k <= 1 would leave the derivatives unbounded; where it
        // is too weak to matter it only widens the rest.
        if (element.form == ElementAlongRay::Form::unbounded &&
            std::abs(element.strength) <= 0x1p-50 / static_cast<double>(field.size())) {
            element.beyond = {std::min(element.strength, 0.0), std::max(element.strength, 0.0)};
            element.active = Interval<double>::empty_set();
        }
        if (is_empty(element.active)) {
            rest.add(1, element.beyond);
            peaks.add(1, element.beyond);
            elements_.pop_back();
            continue;
        }
        magnitude_ += std::abs(element.strength) * element.peak;
        if (element.strength > 0) peaks.add(element.strength, {0.0, element.peak});
    }
    rest_ = rest.finish(list.elements.size() + 1);
    peaks_ = peaks.finish(list.elements.size() + 2).hi;
}

Enclosure FieldAlongRay::over(double t0, double t1) const {
    Sum left, right, value, left_slope, slope, curvature, rest;
    rest.add(1, rest_);
    rest.add(-1, Interval<double>(threshold_));
    for (const ElementAlongRay& e : elements_) {
        if (e.active.hi < t0 || e.active.lo > t1) {
            rest.add(1, e.beyond);
            continue;
        }
        const Terms k = element_over(e, t0, t1);
        left.add(e.strength, k.left);
        right.add(e.strength, k.right);
        value.add(e.strength, k.value);
        left_slope.add(e.strength, k.left_slope);
        slope.add(e.strength, k.slope);
        curvature.add(e.strength, k.curvature);
    }
    const std::size_t terms = elements_.size() + 2;
    const Interval<double> constant = rest.finish(terms);
    return {left.finish(terms) + constant,
            right.finish(terms) + constant,
            value.finish(terms) + constant,
            left_slope.finish(terms),
            slope.finish(terms),
            curvature.finish(terms)};
}

Interval<double> FieldAlongRay::at(double t) const {
    Sum value, rest;
    rest.add(1, rest_);
    rest.add(-1, Interval<double>(threshold_));
    for (const ElementAlongRay& e : elements_) {
        if (e.active.hi < t || e.active.lo > t) {
            rest.add(1, e.beyond);
        } else {
            value.add(e.strength, element_at(e, t));
        }
    }
    const std::size_t terms = elements_.size() + 2;
    return value.finish(terms) + rest.finish(terms);
}

}  // namespace ivory
