// s(t) = q^2 = (d(p(t)) / w)^2 of one skeleton along a ray p(t) = o + t d, enclosed at a t or over
// [t0, t1]: the forms that it takes, which the files of the shapes fill in, and the vectors that they
// are built from. Those move linearly (core/interval/moving_square.h), in units of the element's
// width: from a point to p(t); or the part of it perpendicular to an axis, from a segment's line or a
// circle's axis.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <variant>

#include "core/interval/interval.h"
#include "core/interval/moving_square.h"
#include "core/interval/quick.h"
#include "core/math/offset.h"
#include "core/math/vec3.h"
#include "core/shape/circle_along_ray.h"
#include "core/shape/convex_along_ray.h"
#include "core/shape/curve_along_ray.h"
#include "core/shape/skeleton_values.h"
#include "core/shape/taper_along_ray.h"

namespace ivory {

// One of a segment's three cases along a ray, or a point's only one: while t lies in `where`, s may
// be this square; outside of it, it certainly is another piece's.
struct Piece {
    MovingSquare square;
    Interval<double> where;
};

// A point, or a segment: s is the square of the piece that t lies in.
struct SquaresAlongRay {
    std::array<Piece, 3> pieces;
    std::size_t count = 0;

    void add(const Piece& piece) { pieces[count++] = piece; }
    [[nodiscard]] std::span<const Piece> all() const { return {pieces.data(), count}; }
};

// Numbers too large or too small for the lemma: 0 <= k <= 1 is all that is known.
struct UnboundedAlongRay {};

// One skeleton seen from one ray, for t in a span.
struct SkeletonAlongRay {
    std::variant<UnboundedAlongRay, SquaresAlongRay, CircleAlongRay, TaperAlongRay, ConvexAlongRay,
                 CurveAlongRay>
        form;
    // s >= cut certainly holds on the span outside of this; empty: nowhere on the span is s <= cut.
    Interval<double> active = Interval<double>::entire();
};

// The ray that a skeleton is seen from.
struct SeenFrom {
    Vec3d origin, direction;  // the largest component of the direction lies in [1, 2)
    Interval<double> span;    // of t, finite
    double cut;               // bounds `active`: a value of s beyond which k counts as nothing
};

namespace along_ray_detail {

constexpr double u = unit_roundoff;

inline double one_norm(const Vec3d& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }

// The lemma's range: no product of two of its quantities overflows, none that matters underflows.
inline bool usable(double kappa, double reach, double span) {
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

inline Relative relative_to(const Vec3d& c, double width, const Vec3d& origin,
                            const Vec3d& direction) {
    const double scale = 1 / width;
    Relative r{origin, direction, c, scale, scale * (origin - c), scale * direction, 0, 0};
    r.offset_norm = one_norm(r.offset_vector);
    r.direction_norm = one_norm(r.direction);
    return r;
}

// The t of the span nearest to the foot of the perpendicular on offset + t direction. Any t of the
// span is right as a reference; this one is the sharpest.
inline double foot(const Vec3d& offset_vector, const Vec3d& direction,
                   const Interval<double>& span) {
    const double square = dot(direction, direction);
    const double t = square > 0 ? -dot(offset_vector, direction) / square : span.lo;
    return std::min(std::max(t, span.lo), span.hi);
}

// |v_r + (t - t_r) direction|^2 with |dv_r| <= eta and |d direction| <= nu.
inline MovingSquare moving_square(double reference, const Vec3d& v, const Vec3d& direction,
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
inline MovingSquare from_point(const Relative& r, const Interval<double>& span) {
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

inline FromAxis from_axis(const Relative& r, const Vec3d& n, const Interval<double>& span) {
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

// {t: |v(t)|^2 <= cut}, enclosed from outside.
inline Interval<double> sublevel(const MovingSquare& q, double cut) {
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

// A point, or a skeleton that is within `extra_error` of one. False: not in the lemma's range.
inline bool set_point(SkeletonAlongRay& e, const Relative& r, double extra_error,
                      const Interval<double>& span, double cut) {
    SquaresAlongRay& squares = e.form.emplace<SquaresAlongRay>();
    squares.count = 1;
    Piece& piece = squares.pieces[0];
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

}  // namespace along_ray_detail

// A ball that holds a skeleton, along a ray, in widths; whether its numbers are within the lemma's range.
struct BallAlongRay {
    MovingSquare middle;
    double radius;
    bool fits;

    BallAlongRay(const Ball& ball, double width, const SeenFrom& ray) {
        using namespace along_ray_detail;
        const Relative from = relative_to(ball.center, width, ray.origin, ray.direction);
        middle = from_point(from, ray.span);
        radius = ball.radius / width * (1 + 4 * u) + 1e-300;
        fits = usable(middle.kappa, from.offset_norm + middle.rho + radius, mag(ray.span)) &&
               width > 1e-75 && width < 1e75;
    }
    // Outside of it s > cut.
    [[nodiscard]] Interval<double> active(double cut) const {
        using namespace along_ray_detail;
        const double reach = (std::sqrt(cut) + radius) * (1 + 16 * u);
        return sublevel(middle, reach * reach * (1 + 4 * u));
    }
};
}  // namespace ivory
