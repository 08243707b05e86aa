// Feet that each ray proves by itself: what is said of one place of an arc is true of the arc, and
// of an end with the other arcs that have it.
#include "core/math/instruction_sets.h"
// After that: for the build's own instruction set, without dispatch.
#include "core/shape/shape_lanes.inl"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "tests/core/field/stage_check.h"
#include "tests/tools/seed.h"

HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {
namespace {

// One of a curve's arcs as an entry has it, its first place at the origin.
template <class Real>
struct Arc {
    std::vector<Real> numbers;
    BundleEntry<Real> entry{};
};

template <class Real>
std::vector<Arc<Real>> arcs_of(const std::vector<Vec3d>& control_points) {
    std::vector<Arc<Real>> arcs;
    for (const SkeletonPart& part : curve_arcs(control_points)) {
        Arc<Real>& arc = arcs.emplace_back();
        for (std::size_t k = 0; k < part.numbers.size(); ++k) {
            arc.numbers.push_back(
                sizeof(Real) == sizeof(float)
                    ? static_cast<Real>(curve_arc::in_units(k, part.numbers[k], 1))
                    : static_cast<Real>(part.numbers[k]));
        }
    }
    for (Arc<Real>& arc : arcs) arc.entry.set_numbers(arc.numbers.data());
    return arcs;
}

template <class Real>
struct Foot {
    Vec3<long double> away;
    long double square, slack, bend, pull;
    bool in_reach, is_point;
};

template <class Real>
Foot<Real> foot_of(const Arc<Real>& arc, const Vec3<Real>& p, Real reach) {
    using Tag = hn::ScalableTag<Real>;
    const Tag d;
    using CurveLanes = ShapeLanes<CurveSkeleton>;
    const Vec3v<Tag> at{hn::Set(d, p.x), hn::Set(d, p.y), hn::Set(d, p.z)};
    const ProvedFoot<Tag> foot = CurveLanes::proved_foot(d, arc.entry, at, hn::Set(d, reach));
    return {{hn::GetLane(foot.away.x), hn::GetLane(foot.away.y), hn::GetLane(foot.away.z)},
            hn::GetLane(foot.square),
            hn::GetLane(foot.slack),
            hn::GetLane(foot.bend),
            hn::GetLane(foot.pull),
            !hn::AllFalse(d, foot.in_reach),
            !(arc.numbers[curve_arc::at_slowest] > 0)};
}

long double inner(const Vec3<long double>& a, const Vec3<long double>& b) { return dot(a, b); }

// The arc's distance squared, by its numbers as they are.
template <class Real>
long double square_of_arc(const Arc<Real>& arc, const Vec3<long double>& p) {
    const std::vector<long double> numbers(arc.numbers.begin(), arc.numbers.end());
    const Vec3<long double> away = tools::away_from_arc(numbers.data(), p);
    return inner(away, away);
}

// That of its ends which other arcs have too.
template <class Real>
long double square_of_inner_ends(const Arc<Real>& arc, const Vec3<long double>& p) {
    using namespace curve_arc;
    const auto vector = [&](std::size_t k) {
        return Vec3<long double>{arc.numbers[k], arc.numbers[k + 1], arc.numbers[k + 2]};
    };
    long double least = infinity<double>;
    for (const int x : {-1, 1}) {
        if (arc.numbers[at_own_end] == static_cast<Real>(x) || arc.numbers[at_own_end] == 2)
            continue;
        const long double y = x;
        const Vec3<long double> away =
            (p - vector(at_k0)) - y * (vector(at_k1) + y * (vector(at_k2) + y * vector(at_k3)));
        least = std::min(least, inner(away, away));
    }
    return least;
}

// Places about a curve where feet are hard to tell: anywhere; about where it is bent; about the centre of
// the circle that it follows there, and beyond.
Vec3d hard_place(const std::vector<Vec3d>& points, std::mt19937_64& numbers) {
    const auto uniform = [&](double from, double to) {
        return std::uniform_real_distribution<double>(from, to)(numbers);
    };
    const double u = uniform(0, 1), v = 1 - u;
    const Vec3d &a = points[0], &b = points[1], &c = points[2], &e = points[3];
    const Vec3d at = (v * v * v) * a + (3 * u * v * v) * b + (3 * u * u * v) * c + (u * u * u) * e;
    const Vec3d first = 3.0 * ((v * v) * (b - a) + (2 * u * v) * (c - b) + (u * u) * (e - c));
    const Vec3d second = 6.0 * (v * (c - 2.0 * b + a) + u * (e - 2.0 * c + b));
    const Vec3d noise{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    const double size = std::pow(10.0, uniform(-8, 0.3));
    const double square = dot(first, first);
    const Vec3d normal = second - (dot(second, first) / square) * first;
    const double turn = dot(normal, normal);
    if (numbers() % 3 == 0 || !(turn > 1e-6) || !(square > 1e-6)) return at + size * noise;
    // At the centre or beyond, where the arc about it is farther than its ends.
    const double beyond = numbers() % 2 == 0 ? 1 : 1 + std::pow(uniform(0, 1.6), 3);
    return at + (beyond * square / turn) * normal + (beyond > 1 ? 0.1 * size : size) * noise;
}

template <class Real>
void expect_feet_hold(std::uint64_t seed) {
    std::mt19937_64 numbers(seed);
    const auto uniform = [&](double from, double to) {
        return std::uniform_real_distribution<double>(from, to)(numbers);
    };
    constexpr long double u = sizeof(Real) == sizeof(float) ? 0x1p-24L : 0x1p-53L;
    int proved = 0, ends = 0, unproved = 0;
    for (int trial = 0; trial < 250; ++trial) {
        std::vector<Vec3d> points{{0, 0, 0}, {0, 0.5, 0}, {0.5, 1, 0}, {1, 1, 0}};
        // Some quarter of a circle, nearly a line, which is one arc, or anything.
        const bool is_round = trial % 2 == 0, is_flat = trial % 5 == 1;
        for (std::size_t k = 1; k < 4; ++k) {
            const Vec3d noise{uniform(-1, 1), uniform(-1, 1), trial % 4 == 1 ? 0 : uniform(-1, 1)};
            points[k] =
                is_round  ? points[k] + uniform(0, 0.2) * noise
                : is_flat ? Vec3d{static_cast<double>(k) / 3, k == 3 ? 0 : 0.05, 0} + 0.003 * noise
                          : noise;
        }
        const std::vector<Arc<Real>> arcs = arcs_of<Real>(points);
        for (int place = 0; place < 5; ++place) {
            const Vec3d hard = hard_place(points, numbers);
            const Vec3<Real> p{static_cast<Real>(hard.x), static_cast<Real>(hard.y),
                               static_cast<Real>(hard.z)};
            const Vec3<long double> p0{p.x, p.y, p.z};
            const double reach = std::pow(10.0, uniform(-6, 0));
            std::vector<Foot<Real>> feet;
            for (const Arc<Real>& arc : arcs) {
                feet.push_back(foot_of(arc, p, static_cast<Real>(reach)));
                if (feet.back().is_point) feet.back().slack += 1e-20L;
                ++(feet.back().bend > 0 ? proved : feet.back().pull > 0 ? unproved : ends);
            }
            for (int way = 0; way < 4; ++way) {
                Vec3<long double> v{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
                v = (1 / std::sqrt(inner(v, v))) * v;
                const long double t =
                    way == 0 ? 0 : static_cast<long double>(reach * std::pow(uniform(-1, 1), 3));
                // What the places are off by: `own` of the errors.
                const long double own = 64 * u * (std::sqrt(inner(p0, p0)) + 4);
                for (std::size_t k = 0; k < arcs.size(); ++k) {
                    const Foot<Real>& foot = feet[k];
                    const long double line = foot.square + 2 * t * inner(foot.away, v) + t * t;
                    long double least =
                        line - foot.slack - foot.bend * t * t - 2 * foot.pull * std::abs(t);
                    const bool is_end = foot.in_reach && foot.pull == 0;
                    if (is_end) least = std::min(least, square_of_inner_ends(arcs[k], p0 + t * v));
                    const long double exact = square_of_arc(arcs[k], p0 + t * v);
                    const long double off = own * (2 * (std::sqrt(exact) + std::abs(t)) + own);
                    EXPECT_LE(exact, line + off) << "trial " << trial << " t " << double(t);
                    EXPECT_GE(exact, least - off) << "trial " << trial << " t " << double(t);
                }
            }
        }
    }
    // No case is left out.
    EXPECT_GT(proved, 500);
    EXPECT_GT(ends, 100);
    EXPECT_GT(unproved, 100);
}

TEST(ProvedFoot, HoldsInDouble) { expect_feet_hold<double>(tools::announced_seed(19)); }
TEST(ProvedFoot, HoldsInFloat) { expect_feet_hold<float>(tools::announced_seed(20)); }

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();
