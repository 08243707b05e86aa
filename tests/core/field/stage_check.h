// What the entries of a window add up to in their own arithmetic, and whether its bounds cover the
// rest.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/field/field.h"
#include "core/field/surface.h"
#include "core/field/window.h"
#include "core/math/direction.h"
#include "tests/tools/parts.h"

namespace ivory::tools {

struct StageValue {
    long double f = 0;  // without T
    double slope = 0;
    double jump = 0;  // between the slopes of parts of one element
};

// Each shape's and each kernel's formula, once more: one that is new has to be added.
static_assert(field_shape_count == 9 && kernel_count == 5);

// From the nearest place of a convex part of a polygon, or of an arc of a curve, to a + v.
template <class Real>
Vec3<Real> away_from_part(const Real* numbers, const Vec3<Real>& v) {
    using namespace convex_part;
    const auto axis = [&](std::size_t k) {
        return Vec3<Real>{numbers[k], numbers[k + 1], numbers[k + 2]};
    };
    const Real x = dot(v, axis(at_e1)), y = dot(v, axis(at_e2)), h = dot(v, axis(at_n));
    Real best_x = 0, best_y = 0, nearest = infinity<Real>;
    bool inside = true;
    for (std::size_t k = 0; k < static_cast<std::size_t>(numbers[at_count]); ++k) {
        const Real* const edge = numbers + at_edges + per_edge * k;
        const Real from_x = x - edge[0], from_y = y - edge[1];
        const Real foot = std::clamp(from_x * edge[2] + from_y * edge[3], Real{0}, edge[4]);
        const Real off_x = from_x - foot * edge[2], off_y = from_y - foot * edge[3];
        inside = inside && from_y * edge[2] - from_x * edge[3] > 0;
        if (off_x * off_x + off_y * off_y >= nearest) continue;
        nearest = off_x * off_x + off_y * off_y;
        best_x = off_x;
        best_y = off_y;
    }
    if (inside) best_x = best_y = 0;
    return h * axis(at_n) + best_x * axis(at_e1) + best_y * axis(at_e2);
}
template <class Real>
Vec3<Real> away_from_arc(const Real* numbers, const Vec3<Real>& v) {
    using namespace curve_arc;
    const auto vector = [&](std::size_t k) {
        return Vec3<Real>{numbers[k], numbers[k + 1], numbers[k + 2]};
    };
    const auto from = [&](Real x) {
        return (v - vector(at_k0)) - x * (vector(at_k1) + x * (vector(at_k2) + x * vector(at_k3)));
    };
    // The best of many, and between its neighbours by thirds: in long double, since the least of a square tells
    // where it is to half the digits.
    using Exact = long double;
    const auto square_at = [&](Exact x) {
        Exact sum = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto k = [&](std::size_t at) { return Exact{numbers[at + axis]}; };
            const Exact off =
                (Exact{v[axis]} - k(at_k0)) - x * (k(at_k1) + x * (k(at_k2) + x * k(at_k3)));
            sum += off * off;
        }
        return sum;
    };
    constexpr int places = 64;
    Exact best = -1;
    for (int i = 0; i <= places; ++i) {
        const Exact x = Exact{2} * i / places - 1;
        if (square_at(x) < square_at(best)) best = x;
    }
    Exact lo = std::max(best - Exact{2} / places, Exact{-1}),
          hi = std::min(best + Exact{2} / places, Exact{1});
    for (int step = 0; step < 80; ++step) {
        const Exact c = lo + (hi - lo) / 3, e = hi - (hi - lo) / 3;
        (square_at(c) < square_at(e) ? hi : lo) = square_at(c) < square_at(e) ? e : c;
    }
    const Exact between = (lo + hi) / 2;
    return from(static_cast<Real>(square_at(between) < square_at(best) ? between : best));
}

// At p, relative to the window's middle, along d; in the lengths and the arithmetic of the entries,
// but for the sums.
template <class Real>
StageValue stage_value(const StageEntries<Real>& stage, const Field& field, const Vec3<Real>& p,
                       const Vec3<Real>& d) {
    StageValue sum;
    double greatest = -1, slope = 0, lowest = 0, highest = 0;  // of the parts so far
    for (std::size_t n = 0; n < stage.size; ++n) {
        const BundleEntry<Real>& e = stage.entry[n];
        const std::size_t i = stage.element[n];
        const Vec3<Real> v = p - Vec3<Real>{e.cx, e.cy, e.cz}, m{e.mx, e.my, e.mz};
        Vec3<Real> away = v;
        Real widths = 1;  // at the nearest point, in the element's
        if (field.shape[i] == Shape::segment || field.shape[i] == Shape::polyline) {
            away = v - std::clamp(dot(v, m) * e.parameter, Real{0}, Real{1}) * m;
        } else if (field.shape[i] == Shape::circle) {
            const Vec3<Real> across = v - dot(v, m) * m;
            away = v - (e.parameter / std::sqrt(dot(across, across))) * across;
        } else if (field.shape[i] == Shape::disc) {
            const Vec3<Real> across = v - dot(v, m) * m;
            const Real rho = std::sqrt(dot(across, across));
            away = rho > e.parameter ? v - (e.parameter / rho) * across : v - across;
        } else if (field.shape[i] == Shape::polygon) {
            away = away_from_part(e.numbers(), v);
        } else if (field.shape[i] == Shape::curve) {
            away = away_from_arc(e.numbers(), v);
        } else if (is_taper(field.shape[i])) {
            const Real rises = dot(m, m) + dot(v, m) * e.taper_rate;
            const Real foot = rises > 0 ? (dot(v, m) + dot(v, v) * e.taper_rate) / rises : 1;
            const Real u = std::clamp(foot, Real{0}, Real{1});
            widths = 1 + u * e.taper_rate;
            away = (1 / widths) * (v - u * m);
        }
        const Real s = dot(away, away) * e.inverse_square;
        away = (1 / widths) * away;
        Real k = 0, dk = 0;
        if (field.kernel[i] == KernelKind::blinn) {
            k = dk = std::exp2(-s);
        } else if (field.kernel[i] == KernelKind::wyvill && s < 1) {
            k = (1 - s) * (1 - s) * (9 - 4 * s) / 9;
            dk = -2 * (1 - s) * (11 - 6 * s) / 9;
        } else if (field.kernel[i] == KernelKind::murakami && s < 1) {
            k = (1 - s) * (1 - s);
            dk = -2 * (1 - s);
        } else if (field.kernel[i] == KernelKind::blobtree && s < 1) {
            k = (1 - s) * (1 - s) * (1 - s);
            dk = -3 * (1 - s) * (1 - s);
        } else if (s < 1) {
            const Real q = std::sqrt(s);
            k = s <= Real{1} / 9 ? 1 - 3 * s : Real{1.5} * (1 - q) * (1 - q);
            dk = s <= Real{1} / 9 ? -3 : Real{-1.5} * (1 - q) / q;
        }
        const double own = double{e.slope * dk * dot(away, d)};
        const bool is_first = greatest < 0;
        lowest = is_first ? own : std::min(lowest, own);
        highest = is_first ? own : std::max(highest, own);
        if (double{k} > greatest) {
            greatest = double{k};
            slope = own;
        }
        if (e.joins != 0) continue;
        sum.f += static_cast<long double>(e.strength) * greatest;
        sum.slope += slope;
        sum.jump += highest - lowest;
        greatest = -1;
    }
    return sum;
}

inline Vec3<float> narrowed(const Vec3d& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

// That the strong entries, those with the weak ones, and the fine with the faint ones say of the
// field what their bounds promise, where the ray from `origin` along d is near that t. Returns the
// greatest share of a bound that was needed.
inline double expect_stages_hold(const Field& field, const Window& window, const Vec3d& origin,
                                 const Vec3d& d, double near_t) {
    // A place that float can name.
    const auto tau = static_cast<float>((near_t - window.middle) / field.unit);
    const double t = window.middle + double{tau} * field.unit;
    const Vec3d aside = origin - window.origin;
    const Vec3d p = (window.middle * (d - window.axis) + aside) + (t - window.middle) * d;
    double exact = 0, most = 0;
    for_elements(field, all_parts(field), [&](std::span<const std::uint32_t> parts) {
        const double value = element_value(field, parts, origin + t * d) * field.scale;
        exact += value;
        most += std::abs(value);
    });
    const StageValue fine = stage_value(window.fine, field, p, d);
    const StageValue faint =
        stage_value(window.fine_in_float, field, narrowed((1 / field.unit) * p), narrowed(d));
    const double kept_slope = fine.slope + faint.slope / field.unit;
    const double jump = fine.jump + faint.jump / field.unit;
    const auto middle = static_cast<float>(window.middle / field.unit);
    const Vec3<float> p_near = tau * narrowed(d) + (middle * narrowed(d - window.axis) +
                                                    narrowed((1 / field.unit) * aside));
    const StageValue strong = stage_value(window.strong, field, p_near, narrowed(d));
    const StageValue weak = stage_value(window.weak, field, p_near, narrowed(d));
    double share = 0;
    const auto expect = [&](const char* name, long double sum, double slope, double unit,
                            const StageBounds& bounds) {
        SCOPED_TRACE(name);
        const auto f = static_cast<double>(sum);
        // What plain double costs: the sum, and the place, whose error is so many widths.
        const double reach = std::abs(origin.x) + std::abs(origin.y) + std::abs(origin.z) + t;
        const double slack = 0x1p-51 * static_cast<double>(field.size() + 8) * (1 + most) +
                             0x1p-52 * reach / field.least_width * most;
        EXPECT_LE(exact - f, bounds.above + slack);
        EXPECT_LE(f - exact, bounds.below + slack);
        EXPECT_LE(std::abs(kept_slope * unit - slope),
                  bounds.slope + (window.fine_bounds.slope + jump) * unit + slack);
        share = std::max(
            {share, (exact - f - slack) / bounds.above, (f - exact - slack) / bounds.below});
    };
    if (window.coarse_usable) {
        expect("strong", strong.f, strong.slope, field.unit, window.strong_bounds);
        expect("coarse", strong.f + weak.f, strong.slope + weak.slope, field.unit,
               window.coarse_bounds);
    }
    if (window.fine_usable) {
        expect("fine", fine.f + faint.f, fine.slope, 1, window.fine_bounds);
    }
    return share;
}

}  // namespace ivory::tools
