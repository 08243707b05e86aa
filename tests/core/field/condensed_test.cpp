// Crowds as polynomials, against sums of their elements in long double.
#include "core/field/condensed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "core/field/bundle_steps.h"
#include "core/math/direction.h"
#include "core/math/instruction_sets.h"
#include "tests/tools/instruction_sets.h"
#include "tests/tools/random_scene.h"
#include "tests/tools/seed.h"

namespace ivory {
namespace {

using tools::Random;
using Exact = long double;

struct Derivatives {
    Exact f = 0, slope = 0, bend = 0;
};

// b exp(-|p|^2 / w^2) along `direction`.
void add_gaussian(Exact strength, Exact inverse_square, const Vec3<Exact>& p,
                  const Vec3<Exact>& direction, Derivatives& sum) {
    const Exact k = strength * std::exp(-dot(p, p) * inverse_square);
    const Exact slope = -2 * dot(p, direction) * inverse_square;
    sum.f += k;
    sum.slope += k * slope;
    sum.bend += k * (slope * slope - 2 * inverse_square * dot(direction, direction));
}

Vec3<Exact> exact(const Vec3d& v) { return {v.x, v.y, v.z}; }

// Points in float and their peaks on a window, as BundleField has them.
struct Crowd {
    LocalElements near;
    LocalStretch stretch;
    Vec3d axis;

    Crowd(std::size_t count, double half, double radius, double spread, bool alike,
          Random& random) {
        axis = unit(unit(random.in_cube(1)));
        stretch = {axis, {}, spread, radius, -half, half, random.uniform(2, 40)};
        const double aside = radius + (stretch.t_offset + half) * spread;
        near.make_room(count);
        near.first.begin(group_of(Shape::point, KernelKind::blinn), 0);
        near.first.end(count);
        for (std::size_t k = 0; k < count; ++k) {
            const Vec3d place = random.in_cube(2);
            const double width = alike ? 1 : random.uniform(0.8, 1.6);
            near.x[k] = static_cast<float>(place.x);
            near.y[k] = static_cast<float>(place.y);
            near.z[k] = static_cast<float>(place.z);
            near.strength[k] = static_cast<float>(random.uniform(-0.3, 1));
            near.inverse_square[k] = static_cast<float>(1 / (width * width));
            // From the capsule about the axis.
            const Vec3d c{near.x[k], near.y[k], near.z[k]};
            const Vec3d off = c - std::clamp(dot(c, axis), -half, half) * axis;
            const double away = std::max(std::sqrt(dot(off, off)) - aside, 0.0) * (1 - 1e-6);
            near.least[k] =
                static_cast<float>(away * away * double{near.inverse_square[k]} * (1 - 1e-6));
            near.peak[k] = static_cast<float>(std::exp(-double{near.least[k]}) * (1 + 1e-6));
        }
        // What stands beyond the last one is nobody's.
        for (std::size_t k = count; k < near.x.size(); ++k) near.x[k] = near.strength[k] = NAN;
    }

    // A ray of the bundle: its place at tau, and its direction.
    struct RayPlace {
        Vec3d middle, direction;
    };
    [[nodiscard]] RayPlace ray(Random& random) const {
        const auto across = [&](double length) {
            return random.uniform(0, length) * unit(cross(axis, random.in_cube(1)));
        };
        const Vec3d direction = unit(unit(axis + across(0.99 * stretch.spread)));
        return {across(stretch.radius) + stretch.t_offset * (direction - axis), direction};
    }

    [[nodiscard]] Derivatives sum(const Vec3d& p, const Vec3d& direction) const {
        Derivatives all;
        for (std::size_t k = 0; k < near.size(); ++k) {
            add_gaussian(near.strength[k], near.inverse_square[k],
                         exact(p) - Vec3<Exact>{near.x[k], near.y[k], near.z[k]}, exact(direction),
                         all);
        }
        return all;
    }
};

// P and its derivative, by powers.
Derivatives value_of(const Condensed& condensed, const Vec3d& p, const Vec3d& direction) {
    const auto along = [&](const Vec3d& v, std::size_t axis) {
        const Vec3<float>& to = condensed.frame[axis];
        return dot(exact(v), Vec3<Exact>{to.x, to.y, to.z});
    };
    const Exact x[] = {along(p, 0), along(p, 1), along(p, 2)};
    const Exact d[] = {along(direction, 0), along(direction, 1), along(direction, 2)};
    Derivatives sum;
    std::size_t at = 0;
    for (std::size_t i = 0; i <= condensed.degree; ++i) {
        for (std::size_t j = 0; i + j <= condensed.degree; ++j) {
            for (std::size_t k = 0; i + j + k <= condensed.degree; ++k) {
                const std::size_t powers[] = {i, j, k};
                Exact term = condensed.coefficient[at++], slope = 0;
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    Exact others =
                        powers[axis] == 0 ? 0 : static_cast<Exact>(powers[axis]) * d[axis];
                    for (std::size_t other = 0; other < 3; ++other) {
                        const std::size_t power =
                            powers[other] - (other == axis && powers[axis] > 0);
                        others *= std::pow(x[other], static_cast<Exact>(power));
                    }
                    slope += term * others;
                    if (axis == 2) {
                        sum.slope += slope;
                        for (std::size_t other = 0; other < 3; ++other) {
                            term *= std::pow(x[other], static_cast<Exact>(powers[other]));
                        }
                        sum.f += term;
                    }
                }
            }
        }
    }
    return sum;
}

// No crowd is farther from its polynomial than that says, in value, slope or second derivative, on any
// instruction set; and what it says is not much.
TEST(Condensed, IsAsCloseToItsElementsAsItSays) {
    const std::uint64_t seed = tools::announced_seed(611);
    for (const std::string_view name : instruction_sets()) {
        SCOPED_TRACE(std::string(name));
        const tools::OnInstructionSet on(name);
        Random random(seed);
        int condensed_ones = 0, too_large = 0, highest = 0, lowest = 99;
        double largest = 0;
        for (int trial = 0; trial < 120; ++trial) {
            const double half = std::pow(10.0, random.uniform(-2, 0));
            const double radius = random.chance(0.3) ? 0 : half * random.uniform(0.05, 1);
            const double spread = half * random.uniform(1e-3, 2e-2);
            const Crowd crowd(100 + random.below(700), half, radius, spread, random.chance(0.5),
                              random);
            const double threshold = 10;
            Condensed condensed;
            const bool close = random.chance(0.7);
            const Condensing done =
                bundle_steps().condense(crowd.near, crowd.stretch, 0, threshold, false,
                                        close ? Closeness::close : Closeness::rough, condensed);
            too_large += done != Condensing::condensed;
            if (done != Condensing::condensed) continue;
            ++condensed_ones;
            highest = std::max(highest, static_cast<int>(condensed.degree));
            lowest = std::min(lowest, static_cast<int>(condensed.degree));
            if (close) largest = std::max(largest, condensed.error);
            for (int n = 0; n < 24; ++n) {
                const auto [middle, direction] = crowd.ray(random);
                // Also at the very ends.
                const double tau =
                    n < 4 ? (n % 2 == 0 ? half : -half) : random.uniform(-half, half);
                const Vec3d p = middle + tau * direction;
                const Derivatives truth = crowd.sum(p, direction);
                const Derivatives found = value_of(condensed, p, direction);
                ASSERT_LE(std::abs(truth.f - found.f), condensed.error);
                ASSERT_LE(std::abs(truth.slope - found.slope), condensed.slope_error);
                ASSERT_LE(truth.bend, condensed.rise);
                ASSERT_GE(truth.bend, -condensed.fall);
                ASSERT_LE(truth.f, condensed.most);
            }
        }
        EXPECT_GT(condensed_ones, 60);
        EXPECT_GT(too_large, 10);
        EXPECT_EQ(lowest, 3);
        EXPECT_GT(highest, 11);
        EXPECT_LT(largest, 10 * 0x1p-11);
        std::printf("%d crowds, degrees %d to %d, off by %.1e at most\n", condensed_ones, lowest,
                    highest, largest);
    }
}

// Bounds that a little less would break: where the greatest error is, more than a part of what is allowed for the
// remainder alone is there.
TEST(Condensed, RemaindersAreNotBoundedForNothing) {
    Random random(tools::announced_seed(612));
    double greatest = 0;
    for (int trial = 0; trial < 200; ++trial) {
        // One element, at the window's edge or nearer, whose Taylor series converges slowly.
        Crowd crowd(100, 0.7, 0.1, 1e-3, true, random);
        for (std::size_t k = 0; k < 100; ++k) {
            crowd.near.strength[k] = k == 0 ? 1 : 0;
            crowd.near.x[k] = static_cast<float>(random.uniform(-1, 1));
            crowd.near.y[k] = crowd.near.z[k] = 0;
            crowd.near.least[k] = 0;
            crowd.near.peak[k] = 1;
        }
        Condensed condensed;
        if (bundle_steps().condense(crowd.near, crowd.stretch, 0, 10, false, Closeness::close,
                                    condensed) != Condensing::condensed) {
            continue;
        }
        for (int n = 0; n < 50; ++n) {
            const auto [middle, direction] = crowd.ray(random);
            const Vec3d p = middle + (n % 2 == 0 ? 0.7 : -0.7) * direction;
            const Exact off =
                std::abs(crowd.sum(p, direction).f - value_of(condensed, p, direction).f);
            greatest = std::max(greatest, static_cast<double>(off) / condensed.error);
        }
    }
    EXPECT_GT(greatest, 0.02);
    EXPECT_LE(greatest, 1);
}

// The same along one ray, in double.
TEST(Condensed, ARaysPolynomialIsAsCloseAsItSays) {
    const std::uint64_t seed = tools::announced_seed(613);
    for (const std::string_view name : instruction_sets()) {
        SCOPED_TRACE(std::string(name));
        const tools::OnInstructionSet on(name);
        Random random(seed);
        int condensed_ones = 0;
        double largest = 0;
        for (int trial = 0; trial < 60; ++trial) {
            Scene scene;
            scene.threshold = 10;
            const std::size_t count = 130 + random.below(300);
            const double far = random.chance(0.5) ? 1e5 : 10;
            for (std::size_t k = 0; k < count; ++k) {
                Element element{.skeleton = PointSkeleton{random.in_cube(2)},
                                .width = random.uniform(0.9, 1.3)};
                element.strength = random.uniform(-0.3, 1);
                scene.elements.push_back(element);
            }
            const Field field = compile(scene);
            const Vec3d direction = unit(unit(random.in_cube(1)));
            const Vec3d origin = random.in_cube(0.5) - far * direction;
            const double half = std::pow(10.0, random.uniform(-2, -0.1));
            const double begin = far - half, end = far + half, middle = 0.5 * (begin + end);
            LocalElements near;
            near.make_room(count);
            near.first.begin(group_of(Shape::point, KernelKind::blinn), 0);
            near.first.end(count);
            for (std::size_t k = 0; k < count; ++k) {
                near.element[k] = static_cast<std::int32_t>(k);
                const Vec3d c{field.ax[k], field.ay[k], field.az[k]};
                const Vec3d from = c - origin;
                const Vec3d off = from - std::clamp(dot(from, direction), begin, end) * direction;
                near.peak[k] = static_cast<float>(
                    std::exp(-dot(off, off) * field.inverse_square[k]) * (1 + 1e-5));
            }
            for (std::size_t k = count; k < near.element.size(); ++k) near.element[k] = 1 << 30;
            CondensedRay condensed;
            if (!bundle_steps().condense_ray(field, near, origin, direction, begin, end,
                                             field.scale, field.threshold * field.scale,
                                             condensed)) {
                continue;
            }
            ++condensed_ones;
            largest = std::max(largest, condensed.error);
            for (int n = 0; n < 30; ++n) {
                const double t = n == 0 ? begin : n == 1 ? end : random.uniform(begin, end);
                Derivatives truth, found;
                for (std::size_t k = 0; k < count; ++k) {
                    const Vec3<Exact> c{field.ax[k], field.ay[k], field.az[k]};
                    const Exact width = scene.elements[field.source[k]].width;
                    add_gaussian(Exact{field.strength[k]} * field.scale, 1 / (width * width),
                                 exact(origin) + Exact{t} * exact(direction) - c, exact(direction),
                                 truth);
                }
                const Exact tau = Exact{t} - middle;
                for (std::size_t k = condensed.degree + 1; k-- > 0;) {
                    found.slope = found.slope * tau + found.f;
                    found.f = found.f * tau + condensed.coefficient[k];
                }
                ASSERT_LE(std::abs(truth.f - found.f), condensed.error);
                ASSERT_LE(std::abs(truth.slope - found.slope), condensed.slope_error);
                ASSERT_LE(truth.bend, condensed.rise);
                ASSERT_GE(truth.bend, -condensed.fall);
            }
        }
        EXPECT_GT(condensed_ones, 40);
        EXPECT_LT(largest, 10 * 0x1p-37);
        std::printf("%d rays, off by %.1e at most\n", condensed_ones, largest);
    }
}

}  // namespace
}  // namespace ivory
