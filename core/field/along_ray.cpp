#include "core/field/along_ray.h"

#include "core/interval/quick.h"
#include "core/math/offset.h"

namespace ivory {
namespace {

constexpr double u = unit_roundoff;

double one_norm(const Vec3d& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }

// The lemma's range: no product of two of its quantities overflows, none that matters underflows.
bool usable(double kappa, double reach, double span) {
    return kappa > 1e-75 && kappa < 1e75 && reach < 1e75 && kappa * span < 1e75;
}

// The vector v(t) from a point c of the skeleton to p(t), in units of the element's width.
struct Relative {
    Vec3d origin, ray_direction, c;
    double scale;                        // 1 / w, within u
    Vec3d offset_vector;                 // (o - c) / w, each component within 3.01 u
    Vec3d direction;                     // d / w, each component within 2.01 u
    double offset_norm, direction_norm;  // 1-norms, which exceed the Euclidean ones

    // v(t), each component within 3.01 u of itself and far_error(t): however far the ray comes
    // from, what counts is how near it is at t.
    [[nodiscard]] Vec3d at(double t) const {
        return {scale * offset(origin.x, c.x, t, ray_direction.x),
                scale * offset(origin.y, c.y, t, ray_direction.y),
                scale * offset(origin.z, c.z, t, ray_direction.z)};
    }
    [[nodiscard]] double far_error(double t) const {
        return 10 * u * u * (offset_norm + std::abs(t) * direction_norm);
    }
};

Relative relative_to(const Vec3d& c, double width, const Vec3d& origin, const Vec3d& direction) {
    const double scale = 1 / width;
    Relative r{origin, direction, c, scale, scale * (origin - c), scale * direction, 0, 0};
    r.offset_norm = one_norm(r.offset_vector);
    r.direction_norm = one_norm(r.direction);
    return r;
}

// The t of the span nearest to the foot of the perpendicular on offset + t direction. Any t of the
// span is right as a reference; this one is the sharpest.
double foot(const Vec3d& offset_vector, const Vec3d& direction, const Interval<double>& span) {
    const double square = dot(direction, direction);
    const double t = square > 0 ? -dot(offset_vector, direction) / square : span.lo;
    return std::min(std::max(t, span.lo), span.hi);
}

// |v_r + (t - t_r) direction|^2 with |dv_r| <= eta and |d direction| <= nu.
MovingSquare moving_square(double reference, const Vec3d& v, const Vec3d& direction,
                           const Interval<double>& span, double eta, double nu) {
    MovingSquare q;
    q.reference = reference;
    q.alpha = dot(v, v);
    q.beta = dot(v, direction);
    q.gamma = dot(direction, direction);
    q.rho = std::sqrt(q.alpha) * (1 + 8 * u) + 1e-150;
    q.kappa = std::sqrt(q.gamma) * (1 + 8 * u) + 1e-150;
    q.eta = eta + 1e-300;
    q.nu = nu + 1e-300;

    // |v|^2 = (least on the line) + (distance from the foot, measured along v's path)^2. Where the
    // slope at an end of the span points out of it, the least on the span is at that end.
    const SquareAt here = q.at(reference);
    const bool falls = here.ds + here.ds_radius <= 0;
    const bool rises = here.ds - here.ds_radius >= 0;
    const double speed = q.kappa * (1 - 16 * u) - q.nu - 1e-149;  // <= |e|
    const double along = (0.5 * (std::abs(here.ds) + here.ds_radius)) / speed * (1 + 8 * u);
    const double at_foot = speed > 0 ? here.s - here.s_radius - along * along * (1 + 4 * u) : 0;
    const bool at_end = (reference == span.hi && falls) || (reference == span.lo && rises);
    const double at_least = at_end ? here.s - here.s_radius : at_foot;
    q.vertex = at_foot > 0 ? at_foot * (1 - 4 * u) : 0;
    q.least = at_least > 0 ? at_least * (1 - 4 * u) : 0;
    return q;
}

// The vector from a point itself.
MovingSquare from_point(const Relative& r, const Interval<double>& span) {
    const double reference = foot(r.offset_vector, r.direction, span);
    const Vec3d v = r.at(reference);
    return moving_square(reference, v, r.direction, span,
                         4 * u * one_norm(v) + r.far_error(reference), 3 * u * r.direction_norm);
}

// The part of v perpendicular to a unit vector n known within 8 u. The part along n, a = v.n, errs
// by at most (3.01 + 8 + 3.01) u |v|, v - a n by (3.01 + 14.1 + 8 + 2.02) u |v| < 28 u |v|; the
// direction likewise.
struct FromAxis {
    MovingSquare across;
    double height, rise;  // v_r.n and direction.n, within across' eta and nu
};

FromAxis from_axis(const Relative& r, const Vec3d& n, const Interval<double>& span) {
    const double rise = dot(r.direction, n);
    const Vec3d direction = r.direction - rise * n;
    const double reference = foot(r.offset_vector - dot(r.offset_vector, n) * n, direction, span);
    const Vec3d v = r.at(reference);
    const double height = dot(v, n);
    return {
        moving_square(reference, v - height * n, direction, span,
                      32 * u * one_norm(v) + 2 * r.far_error(reference), 32 * u * r.direction_norm),
        height, rise};
}

// t1 - t0, rounded up.
double up_to(double t1, double t0) { return quick::up(t1 - t0); }

// {t: |v(t)|^2 <= cut}, enclosed from outside.
Interval<double> sublevel(const MovingSquare& q, double cut) {
    if (q.least > cut) return Interval<double>::empty_set();
    const double speed = q.kappa * (1 - 16 * u) - q.nu - 1e-149;
    if (!(speed > 0.5 * q.kappa)) return Interval<double>::entire();
    // |v|^2 = least + |e|^2 (t - t0)^2, t0 the foot: t0 = t_r - (v.e) / |e|^2 within its slope's
    // error.
    const SquareAt here = q.at(q.reference);
    const double half = std::sqrt(cut) / speed;
    const double centre = q.reference - 0.5 * here.ds / q.gamma;
    const double error = 0.5 * here.ds_radius / (speed * speed) +
                         8 * (q.nu / speed + u) * std::abs(centre - q.reference) +
                         8 * u * std::abs(centre) + 1e-6 * half;
    return {centre - half - error, centre + half + error};
}

// A unit vector along n, each component within 4 u: the power of two takes care of overflow.
Vec3d unit(const Vec3d& n) {
    const double largest = std::max(std::abs(n.x), std::max(std::abs(n.y), std::abs(n.z)));
    int exponent = 0;
    std::frexp(largest, &exponent);
    const Vec3d m{std::ldexp(n.x, -exponent), std::ldexp(n.y, -exponent),
                  std::ldexp(n.z, -exponent)};
    const double length = std::sqrt(dot(m, m));
    return {m.x / length, m.y / length, m.z / length};
}

bool set_point(ElementAlongRay& e, const Relative& r, double extra_error,
               const Interval<double>& span, double cut) {
    e.form = ElementAlongRay::Form::squares;
    e.piece_count = 1;
    Piece& piece = e.pieces[0];
    piece.square = from_point(r, span);
    if (extra_error > 0) {
        piece.square.eta += extra_error;
        const double root =
            std::max(std::sqrt(piece.square.least) * (1 - 4 * u) - extra_error, 0.0);
        piece.square.least = root * root * (1 - 4 * u);
        piece.square.vertex = 0;
    }
    piece.where = span;
    e.active = sublevel(piece.square, cut);
    return usable(piece.square.kappa, r.offset_norm + piece.square.rho, mag(span));
}

// The foot of p(t) on the line A + lambda M is lambda(t) = (v(t).M) / |M|^2, affine in t. Where it
// is below 0 or above 1 the end is nearest, between the two the line is; at lambda = 0 and 1 the
// squares meet with equal slopes. The times of the two changes are known within an error, so the
// pieces overlap by it.
bool set_segment(ElementAlongRay& e, const Field& field, std::size_t i, const Vec3d& origin,
                 const Vec3d& direction, const Interval<double>& span, double cut) {
    const Vec3d a = field.a(i), b = field.b(i);
    const double width = field.width[i];
    const Relative from_a = relative_to(a, width, origin, direction);
    const Vec3d m = from_a.scale * (b - a);  // within 3.01 u
    const double m_norm = one_norm(m);
    if (!(m_norm > 1e-120)) return set_point(e, from_a, 2 * m_norm, span, cut);
    if (!(m_norm < 1e100)) return false;
    const Relative from_b = relative_to(b, width, origin, direction);
    const double mm = dot(m, m);
    const double length = std::sqrt(mm);

    const double lambda0 = dot(from_a.offset_vector, m) / mm;
    const double lambda1 = dot(from_a.direction, m) / mm;
    // |d lambda| over the span: the data err by 3.01 u each, the dot products by 3 u, the quotient
    // by 5 u, the product with t and the sum by 2 u, all of (|offset| + |t direction|) / |M|.
    const double lambda_error =
        32 * u * (from_a.offset_norm + mag(span) * from_a.direction_norm) / length + 1e-300;
    const double at_start = lambda0 + lambda1 * span.lo;
    const double at_end = lambda0 + lambda1 * span.hi;
    const Interval<double> lambda{std::min(at_start, at_end) - lambda_error,
                                  std::max(at_start, at_end) + lambda_error};

    // The time at which lambda(t) = value, within the error; the whole span where lambda hardly
    // moves.
    const auto crossing = [&](double value) -> Interval<double> {
        const double speed = std::abs(lambda1);
        if (!(speed * (span.hi - span.lo) > 8 * lambda_error)) return span;
        const double t = (value - lambda0) / lambda1;
        const double error = 2 * lambda_error / speed + 8 * u * std::abs(t);
        return {t - error, t + error};
    };
    const bool forward = lambda1 > 0;
    const Interval<double> enters = crossing(forward ? 0 : 1);
    const Interval<double> leaves = crossing(forward ? 1 : 0);
    const Relative& first = forward ? from_a : from_b;
    const Relative& last = forward ? from_b : from_a;
    const bool first_possible = forward ? lambda.lo < 0 : lambda.hi > 1;
    const bool last_possible = forward ? lambda.hi > 1 : lambda.lo < 0;
    const bool middle_possible = lambda.hi >= 0 && lambda.lo <= 1;

    e.form = ElementAlongRay::Form::squares;
    e.piece_count = 0;
    bool fits = true;
    e.active = Interval<double>::empty_set();
    const auto add = [&](const MovingSquare& square, const Interval<double>& where, double reach) {
        e.active = hull(e.active, intersection(sublevel(square, cut), where));
        e.pieces[e.piece_count++] = {square, where};
        fits = fits && usable(square.kappa, reach + square.rho, mag(span));
    };
    const auto within = [&](double lo, double hi) {
        return intersection(span, Interval<double>(lo, hi));
    };
    if (const auto where = within(span.lo, enters.hi); first_possible && !is_empty(where)) {
        add(from_point(first, where), where, first.offset_norm);
    }
    if (const auto where = within(enters.lo, leaves.hi); middle_possible && !is_empty(where)) {
        const Vec3d axis{m.x / length, m.y / length, m.z / length};
        const MovingSquare square = from_axis(from_a, axis, where).across;
        // A ray along the segment leaves no speed across it, which the lemma allows.
        e.active = hull(e.active, intersection(sublevel(square, cut), where));
        e.pieces[e.piece_count++] = {square, where};
        fits = fits && usable(from_a.direction_norm, from_a.offset_norm + square.rho, mag(span));
    }
    if (const auto where = within(leaves.lo, span.hi); last_possible && !is_empty(where)) {
        add(from_point(last, where), where, last.offset_norm);
    }
    return fits && e.piece_count > 0;
}

bool set_circle(ElementAlongRay& e, const Field& field, std::size_t i, const Vec3d& origin,
                const Vec3d& direction, const Interval<double>& span, double cut) {
    const Relative r = relative_to(field.a(i), field.width[i], origin, direction);
    if (field.radius[i] == 0) return set_point(e, r, 0, span, cut);
    const Vec3d n = unit(field.b(i));
    const FromAxis axial = from_axis(r, n, span);
    e.form = ElementAlongRay::Form::circle;
    CircleAlongRay& c = e.circle;
    c.across = axial.across;
    c.height = axial.height;
    c.rise = axial.rise;
    const MovingSquare& q = c.across;
    c.radius = Interval<double>(field.radius[i]) / Interval<double>(field.width[i]);

    // |d|^2 / w^2 of the exact direction and width.
    const MovingSquare whole = from_point(r, span);
    c.curvature = whole.curvature();

    // rho_0^2 = |v|^2 - (v.e)^2 / |e|^2 at t_r; only an upper bound where the ray hardly moves
    // across.
    const SquareAt here = q.at(q.reference);
    const double speed = q.kappa * (1 - 16 * u) - q.nu - 1e-149;
    if (speed > 0.999 * q.kappa) {
        const double along = 0.5 * std::abs(here.ds), error = 0.5 * here.ds_radius;
        const double most = (along + error) / speed;
        const double fewest = std::max(along - error, 0.0) / (q.kappa + q.nu);
        const double lo = here.s - here.s_radius - most * most * (1 + 16 * u);
        const double hi = here.s + here.s_radius - fewest * fewest * (1 - 16 * u);
        c.least_across = {lo > 0 ? lo * (1 - 4 * u) : 0, hi > 0 ? hi * (1 + 4 * u) : 1e-290};
    } else {
        c.least_across = {0.0, here.s + here.s_radius};
    }

    // The circle lies on the sphere |v| = r: |v| <= r + sqrt(cut) where s <= cut.
    const double reach = (c.radius.hi + std::sqrt(cut)) * (1 + 8 * u);
    e.active = intersection(sublevel(whole, reach * reach * (1 + 4 * u)),
                            sublevel(q, reach * reach * (1 + 4 * u)));
    return usable(whole.kappa, r.offset_norm + whole.rho + c.radius.hi, mag(span));
}

// A lower bound of s over the span.
double least_square(const ElementAlongRay& e, const Interval<double>& span, double cut) {
    if (e.form == ElementAlongRay::Form::squares) {
        double least = infinity<double>;
        for (int k = 0; k < e.piece_count; ++k) {
            least = std::min(least, e.pieces[static_cast<std::size_t>(k)].square.least);
        }
        return least;
    }
    // Cut the active part into windows: their ranges are tighter than that of the whole.
    const Interval<double> where = intersection(span, e.active);
    if (is_empty(where)) return cut;
    constexpr int windows = 6;
    // Outside of it, all that is known is s >= cut.
    double least = is_subset(span, where) ? infinity<double> : cut;
    CircleAlongRay::At left = e.circle.at(where.lo);
    double t0 = where.lo;
    for (int k = 1; k <= windows; ++k) {
        const double t1 = k == windows ? where.hi : where.lo + (where.hi - where.lo) * k / windows;
        const CircleAlongRay::At right = e.circle.at(t1);
        if (t1 > t0) least = std::min(least, e.circle.over(t0, t1, left, right).s.lo);
        left = right;
        t0 = t1;
    }
    return least < infinity<double> ? std::max(least, 0.0) : 0;
}

}  // namespace

CircleAlongRay::At CircleAlongRay::at(double t) const {
    At at;
    at.square = across.at(t);
    const double tau = t - across.reference;
    const double error =
        across.eta + across.nu * std::abs(tau) + 8 * u * (std::abs(height) + std::abs(tau * rise));
    const double h = height + tau * rise;
    at.h = {h - error, h + error};
    at.rho = quick::sqrt(at.square.value());
    // |rho'| <= |e|, whatever rho is; the quotient is sharper away from the axis.
    const double speed = across.kappa + across.nu;
    at.drho = {-speed, speed};
    if (at.rho.lo > 0) {
        const Interval<double> quotient = quick::div(quick::scale(0.5, at.square.slope()), at.rho);
        at.drho = {std::max(quotient.lo, -speed), std::min(quotient.hi, speed)};
        if (is_empty(at.drho)) at.drho = {-speed, speed};
    }
    const Interval<double> dh{rise - across.nu, rise + across.nu};
    const Interval<double> off = quick::sub(at.rho, radius);
    at.s = quick::add(quick::sqr(off), quick::sqr(at.h));
    at.ds = quick::scale(2, quick::add(quick::mul(off, at.drho), quick::mul(at.h, dh)));
    return at;
}

CircleAlongRay::Over CircleAlongRay::over(double t0, double t1, const At& at0,
                                          const At& at1) const {
    const Interval<double> rho = quick::sqrt(across.over(at0.square, at1.square));
    const Interval<double> drho{at0.drho.lo, at1.drho.hi};  // rho is convex
    const Interval<double> h = hull(at0.h, at1.h);
    const Interval<double> dh{rise - across.nu, rise + across.nu};
    const Interval<double> off = quick::sub(rho, radius);

    // rho'' = gamma rho_0^2 / rho^3, unbounded where rho can be 0.
    const Interval<double> bend =
        rho.lo > 0 ? quick::div(quick::mul(quick::scale(0.5, across.curvature()), least_across),
                                quick::mul(rho, quick::sqr(rho)))
                   : Interval<double>(0.0, infinity<double>);
    Over range;
    range.dds = quick::sub(curvature, quick::scale(2, quick::mul(radius, bend)));
    const Interval<double> elapsed{0.0, up_to(t1, t0)};

    range.ds = quick::scale(2, quick::add(quick::mul(off, drho), quick::mul(h, dh)));
    if (range.dds.lo > -infinity<double>) {
        const Interval<double> gain = quick::mul(range.dds, elapsed);
        range.ds = intersection(range.ds,
                                intersection(quick::add(at0.ds, gain), quick::sub(at1.ds, gain)));
    }
    range.s = quick::add(quick::sqr(off), quick::sqr(h));
    if (range.ds.lo >= 0) {
        range.s = intersection(range.s, Interval<double>(at0.s.lo, at1.s.hi));
    } else if (range.ds.hi <= 0) {
        range.s = intersection(range.s, Interval<double>(at1.s.lo, at0.s.hi));
    } else {
        const Interval<double> gain = quick::mul(range.ds, elapsed);
        range.s =
            intersection(range.s, intersection(quick::add(at0.s, gain), quick::sub(at1.s, gain)));
    }
    return range;
}

void along_ray(const Field& field, std::size_t i, const Vec3d& origin, const Vec3d& direction,
               const Interval<double>& span, double cut, ElementAlongRay& e) {
    e.kernel = field.kernel[i];
    e.strength = field.strength[i];
    const double beyond = e.strength * kernel_at(e.kernel, cut).hi;
    e.beyond = {std::min(beyond, 0.0), std::max(beyond, 0.0)};
    bool fits = false;
    switch (field.shape[i]) {
        case Shape::point:
            fits = set_point(e, relative_to(field.a(i), field.width[i], origin, direction), 0, span,
                             cut);
            break;
        case Shape::segment:
            fits = set_segment(e, field, i, origin, direction, span, cut);
            break;
        case Shape::circle:
            fits = set_circle(e, field, i, origin, direction, span, cut);
            break;
    }
    if (!fits) {
        e.form = ElementAlongRay::Form::unbounded;
        e.active = Interval<double>::entire();
        e.least = 0;
        e.peak = 1;
        return;
    }
    e.active = intersection(e.active, span);
    e.least = is_empty(e.active) ? cut : least_square(e, span, cut);
    e.peak = kernel_at(e.kernel, e.least).hi;
}

}  // namespace ivory
