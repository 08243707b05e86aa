// A short arc of a Bezier curve: what curves are made of. Its numbers (SkeletonColumns) are a cubic in x from
// -1 to 1, c(x) = k0 + x k1 + x^2 k2 + x^3 k3, relative to the curve's first control point a.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/interval/interval.h"
#include "core/math/vec3.h"
#include "core/shape/skeleton_values.h"

namespace ivory {

// With v = p - a - k0, the foot of p is where
//     g(x) = (v - x k1 - x^2 k2 - x^3 k3) . c'(x)
//          = v.k1 + (2 v.k2 - k1.k1) x + 3 (v.k3 - k1.k2) x^2
//            - (2 k2.k2 + 4 k1.k3) x^3 - 5 k2.k3 x^4 - 3 k3.k3 x^5
// is 0, a polynomial whose other coefficients are the arc's: D = |p - c|^2 has D' = -2 g.
namespace curve_arc {

// Where its numbers stand: k0 .. k3; of g, k1.k1, 3 k1.k2, 2 k2.k2 + 4 k1.k3, 5 k2.k3, 3 k3.k3; the places
// of both ends less k0; on the arc, the least and the greatest |c'|, the greatest |c''|, the greatest
// |c' . c''|, |c'''|; the radius of a ball around k0; what the first twelve may be off by beside their own
// rounding, and the square of the size with those of g. All of them bounds where they have to be. Last the x
// of the curve's own end, if the arc has one: -1 or 1, 0 if none, 2 if both.
inline constexpr std::size_t at_k0 = 0, at_k1 = 3, at_k2 = 6, at_k3 = 9, at_g = 12, at_begin = 17,
                             at_end = 20, at_slowest = 23, at_fastest = 24, at_turn = 25,
                             at_speeding = 26, at_third = 27, at_radius = 28, at_lost = 29,
                             at_lost_square = 30, at_own_end = 31, most_numbers = 32;

// The piece of an arc on which x = middle + half y, y from -1 to 1, is an arc like any other: its numbers, of
// which no coefficient is off by more than 16 u of the whole arc's, times half to the power that belongs to it.
// Where x = -1 or 1 is in it that has to be exact. One of no size stays one.
void numbers_of_piece(std::span<const double> numbers, double middle, double half,
                      std::span<double, most_numbers> piece);

// An arc is short: |c' - k1| <= |k1| / 4, and 3 |c'.c''| <= |c'|^2 / 3; or, at a cusp, of no size.
inline constexpr double greatest_turn = 1.0 / 4, greatest_speeding = 1.0 / 3;

[[nodiscard]] constexpr float in_units(std::size_t k, double value, double per_unit) {
    if (k == at_own_end) return static_cast<float>(value);
    const bool is_square = (k >= at_g && k < at_begin) || k == at_speeding || k == at_lost_square;
    return static_cast<float>(is_square ? value * per_unit * per_unit : value * per_unit);
}

// The places that may be the nearest, and |v - c|^2 there.
struct Feet {
    Interval<double> square;
    std::array<Interval<double>, 6> x;  // all are in one of these
    std::size_t count = 0;
    // There is one foot, and after a way t from a v of the box (D' - 2 t) has changed by at most 2 |t| bend.
    double bend = infinity<double>;
};
// Of all v in a box, k0 subtracted. Sharp where it is thin.
[[nodiscard]] Feet feet(std::span<const double> numbers, const Vec3<Interval<double>>& v);

// What leads from the nearest place to v, k0 subtracted, to nearest: from the one foot that Newton's steps
// find, or from an end, where there is certainly but one; else by `feet`.
struct OffArc {
    Vec3d away;
    bool one_place = true;  // else there may be another as near, elsewhere
};
[[nodiscard]] OffArc off_arc(std::span<const double> numbers, const Vec3d& v);

// v - c(x).
[[nodiscard]] Vec3<Interval<double>> away_at(std::span<const double> numbers,
                                             const Vec3<Interval<double>>& v,
                                             const Interval<double>& x);

}  // namespace curve_arc

// The arcs of a curve of 3 or 4 control points: halves, until they are short.
[[nodiscard]] std::vector<SkeletonPart> curve_arcs(std::span<const Vec3d> control_points);

}  // namespace ivory
