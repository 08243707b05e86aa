// The bounds of a window against the field itself.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "core/field/surface.h"
#include "core/math/direction.h"
#include "tests/core/field/stage_check.h"
#include "tests/core/trace/bundle_windows.h"
#include "tests/reference/reference.h"
#include "tests/tools/kinds.h"
#include "tests/tools/parts.h"
#include "tests/tools/random_scene.h"
#include "tests/tools/seed.h"

namespace ivory {
namespace {

using tools::Random;

Vec3d place(const Vec3d& origin, double t, const Vec3d& d) { return origin + t * d; }

// Calls visit(field, ray's origin, window, scale, ray's direction) for windows of random scenes, with several
// rays of the bundle each; all lengths are near 1, so that plain double serves as truth.
template <class Visit>
void for_random_windows(const tools::ElementKind& kind, const Visit& visit) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Random random(seed);
        tools::SceneRecipe recipe{.elements = 10};
        if (seed % 4 != 0) recipe.only = kind;  // the others among all kinds
        const Scene scene = tools::random_scene(recipe, seed);
        const Field field = compile(scene);
        const Vec3d origin = 4.0 * unit(random.in_cube(1));
        // Every third one from origins side by side.
        const double radius = seed % 3 == 0 ? 0.05 : 0;
        const Bundle bundle{origin, unit(0.5 * random.in_cube(1) - origin), 0.02, radius};
        BundleWindows along;
        ASSERT_TRUE(along.build(field, all_elements(field), bundle, 1e-6));
        const double scale = along.threshold() / field.threshold;
        const std::array parts{whole_of(bundle)};
        const auto every = [](const BundlePart&, double, double) { return true; };
        const int no_end = std::numeric_limits<int>::max();
        along.for_windows(parts, {}, every, no_end, [&](Window& window, const BundlePart&) {
            along.complete(window);
            for (int n = 0; n < 4; ++n) {
                const Vec3d side = unit(cross(bundle.axis, random.in_cube(1)));
                visit(field, origin + 0.99 * radius * random.uniform(0, 1) * side, window, scale,
                      unit(bundle.axis + 0.019 * random.uniform(0, 1) * unit(random.in_cube(1))),
                      random);
            }
            return true;
        });
    }
}

class BundleOf : public testing::TestWithParam<tools::ElementKind> {};
INSTANTIATE_TEST_SUITE_P(Each, BundleOf, testing::ValuesIn(tools::every_kind), tools::name_of_kind);

// f <= (the sum over the window's entries) + above, and likewise below: what is left out is not
// forgotten.
TEST_P(BundleOf, WhatIsLeftOutStaysInAsAnInterval) {
    int left_out = 0;
    double share = 0;  // of the bounds, used
    for_random_windows(GetParam(), [&](const Field& field, const Vec3d& origin,
                                       const Window& window, double scale, const Vec3d& d,
                                       Random& random) {
        const Vec3d p = place(origin, random.uniform(window.begin, window.end), d);
        std::vector<bool> kept(field.size(), false);
        for (const std::uint32_t i : window.fine.elements()) kept[i] = true;
        for (const std::uint32_t i : window.fine_in_float.elements()) kept[i] = true;
        const tools::LeftOutThere there = tools::left_out_at(field, kept, p);
        left_out += there.count;
        const double above = there.above * scale, below = there.below * scale;
        ASSERT_LE(above, window.fine_bounds.above);
        ASSERT_LE(below, window.fine_bounds.below);
        share =
            std::max({share, above / window.fine_bounds.above, below / window.fine_bounds.below});
    });
    std::printf("%d left out, up to %.3f of a bound\n", left_out, share);
    EXPECT_GT(left_out, 50);  // where kernels end, in the scenes of all kinds alone
    // What curves may be off by, in the scenes of all kinds, hides what others leave out.
    EXPECT_GT(share, GetParam().kernel == KernelKind::blinn ? 0.1 : 0.001);
}

// The sums of a window's stages are off by no more than they say.
TEST_P(BundleOf, StagesAreAsGoodAsTheirBounds) {
    int windows = 0;
    double share = 0;
    for_random_windows(GetParam(), [&](const Field& field, const Vec3d& origin,
                                       const Window& window, double, const Vec3d& d,
                                       Random& random) {
        ++windows;
        share =
            std::max(share, tools::expect_stages_hold(field, window, origin, d,
                                                      random.uniform(window.begin, window.end)));
    });
    std::printf("%d windows, up to %.3f of a bound\n", windows, share);
    EXPECT_GT(windows, 400);
    EXPECT_GT(share, 0.1);
}

// Of a piece of a window about one ray rounding is all that is left: it is bounded, against the
// field in 256 bits, and closer than in the window.
TEST(Bundle, RoundingAboutOneRayIsBoundedClosely) {
    const std::uint64_t first = tools::announced_seed(70);
    int pieces = 0;
    double share = 0;
    std::vector<double> gains;
    for (std::uint64_t seed = first; seed < first + 60; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Random random(seed);
        const Scene scene = tools::random_scene({.elements = 24}, seed);
        const Field field = compile(scene);
        const reference::ReferenceField exact(scene);
        const Vec3d origin = 4.0 * unit(random.in_cube(1));
        const Bundle bundle{origin, unit(0.5 * random.in_cube(1) - origin), 0.005};
        BundleWindows along;
        ASSERT_TRUE(along.build(field, all_elements(field), bundle, 1e-12));
        const std::array parts{whole_of(bundle)};
        const auto every = [](const BundlePart&, double, double) { return true; };
        const int no_end = std::numeric_limits<int>::max();
        along.for_windows(parts, {}, every, no_end, [&](const Window& window, const BundlePart&) {
            const Vec3d d = unit(bundle.axis + 0.0049 * unit(random.in_cube(1)));
            const Window& piece =
                along.about_root(origin, d, random.uniform(window.begin, window.end));
            EXPECT_GE(piece.begin, window.begin);
            EXPECT_LE(piece.end, window.end);
            if (!piece.fine_usable) return true;
            for (const double share_of_piece : {0.0, 0.3, 1.0}) {
                const double t = piece.begin + share_of_piece * (piece.end - piece.begin);
                const Vec3d p = piece.middle * (d - piece.axis) + (t - piece.middle) * d;
                const tools::StageValue fine = tools::stage_value(piece.fine, field, p, d);
                const reference::Real f = exact.at({origin, d}, reference::Real(t)).f.lo;
                const auto g = static_cast<double>(fine.f - along.threshold());
                const double off = f.to_double() * field.scale - g;
                // What double loses of that difference.
                const double slack = 0x1p-51 * std::abs(g);
                EXPECT_LE(off, piece.fine_bounds.above + slack);
                EXPECT_LE(-off, piece.fine_bounds.below + slack);
                share = std::max({share, (off - slack) / piece.fine_bounds.above,
                                  (-off - slack) / piece.fine_bounds.below});
                ++pieces;
            }
            const Window& finer = along.full_mixed();
            gains.push_back(finer.fine_bounds.above / piece.fine_bounds.above);
            return true;
        });
    }
    std::sort(gains.begin(), gains.end());
    EXPECT_GT(pieces, 1000);
    EXPECT_GT(share, 0.02);
    EXPECT_GT(gains[gains.size() / 2], 1.1);
    std::printf("%d places, up to %.3f of a bound; bounds %.1f times closer\n", pieces, share,
                gains[gains.size() / 2]);
}

// Where no element is so far away that it is left out, what float loses of the faint ones is all
// that the bounds of the fine stage are made of.
TEST(Bundle, FaintElementsAreOffByNoMoreThanTheirBounds) {
    const std::uint64_t first = tools::announced_seed(68);
    int faint = 0;
    double share = 0;
    for (std::uint64_t seed = first; seed < first + 40; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Random random(seed);
        Scene scene;
        scene.threshold = 0.5;
        for (int n = 0; n < 20; ++n) {
            const Vec3d aside{n % 2 == 0 ? 2.3 : -2.3, 0, 0};
            scene.elements.push_back({.skeleton = PointSkeleton{aside + random.in_cube(0.1)},
                                      .width = random.uniform(0.95, 1)});
        }
        const Field field = compile(scene);
        const Vec3d origin = 6.0 * unit(random.in_cube(1));
        const Bundle bundle{origin, unit(field.a(0) - origin), 0.02};
        BundleWindows along;
        ASSERT_TRUE(along.build(field, all_elements(field), bundle, 1e-6));
        const std::array parts{whole_of(bundle)};
        const auto every = [](const BundlePart&, double, double) { return true; };
        along.for_windows(parts, {}, every, 1000, [&](Window& window, const BundlePart&) {
            along.complete(window);
            faint += static_cast<int>(window.fine_in_float.size);
            for (int n = 0; n < 20; ++n) {
                const Vec3d d = unit(bundle.axis + 0.019 * unit(random.in_cube(1)));
                const double t = random.uniform(window.begin, window.end);
                share = std::max(share, tools::expect_stages_hold(field, window, origin, d, t));
            }
            return true;
        });
    }
    EXPECT_GT(faint, 500);
    EXPECT_GT(share, 0.05);
    std::printf("%d faint entries, up to %.3f of a bound\n", faint, share);
}

// Where a wide bundle is parted while its stretches are still long, its parts and their rays see
// the elements where they are.
TEST(Bundle, PartsOfWideBundlesAreAsGoodAsTheirBounds) {
    int of_parts = 0, of_rays = 0, inside = 0;
    for (std::uint64_t seed = 40; seed < 50; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Random random(seed);
        Scene scene;
        scene.threshold = 0.5;
        for (int n = 0; n < 300; ++n) {
            scene.elements.push_back({.skeleton = PointSkeleton{random.in_cube(12)},
                                      .width = random.uniform(0.1, 0.12)});
        }
        const Field field = compile(scene);
        const Vec3d origin = 60.0 * unit(random.in_cube(1));
        const Vec3d axis = unit(-1.0 * origin);
        std::vector<BundlePart> parts{{.axis = axis,
                                       .spread = 0.45,
                                       .origin = origin,
                                       .end = 48,
                                       .first_part = 1,
                                       .end_of_parts = 13}};
        std::vector<double> x, y, z;
        std::vector<Vec3d> targets;
        for (std::uint32_t k = 0; k < 12; ++k) {
            const Vec3d target = field.a(random.below(field.size()));
            const Vec3d part_axis = unit(target - origin + random.in_cube(1));
            parts.push_back({.axis = part_axis,
                             .spread = 0.05,
                             .origin = origin,
                             .first = 4 * k,
                             .end = 4 * k + 4});
            for (int ray = 0; ray < 4; ++ray) {
                targets.push_back(target + random.in_cube(0.05));
                const Vec3d d = unit(targets.back() - origin);
                x.push_back(d.x);
                y.push_back(d.y);
                z.push_back(d.z);
            }
        }
        BundleWindows along;
        ASSERT_TRUE(along.build(field, all_elements(field), {origin, axis, 0.45}, 1e-6));
        const RayColumns rays{x.data(), y.data(), z.data()};
        struct Seen {
            double begin, end;
            std::uint32_t first_ray, end_of_rays;
        };
        std::vector<Seen> seen;
        along.for_windows(
            parts, rays, [](const BundlePart&, double, double) { return true; },
            std::numeric_limits<int>::max(),
            [&](Window& window, const BundlePart& part) {
                along.complete(window);
                (part.end - part.first > 1 ? of_parts : of_rays) += 1;
                seen.push_back({window.begin, window.end, part.first, part.end});
                for (std::uint32_t k = part.first; k < part.end; ++k) {
                    tools::expect_stages_hold(field, window, origin, rays[k],
                                              random.uniform(window.begin, window.end));
                }
                return !testing::Test::HasFailure();
            });
        for (std::uint32_t k = 0; k < 48; ++k) {
            for (int n = 0; n < 20; ++n) {
                const double t = dot(targets[k] - origin, rays[k]) + random.uniform(-0.1, 0.1);
                if (!(sample(field, origin + t * rays[k]).value > 1e-9)) continue;
                ++inside;
                ASSERT_TRUE(std::any_of(seen.begin(), seen.end(),
                                        [&](const Seen& window) {
                                            return window.begin <= t && t <= window.end &&
                                                   window.first_ray <= k && k < window.end_of_rays;
                                        }))
                    << "t " << t;
            }
        }
    }
    EXPECT_GT(of_rays, 50);
    EXPECT_GT(inside, 100);
    std::printf("%d windows of several rays, %d of one\n", of_parts, of_rays);
}

// Bundles that are parts of a common one: their windows hold, none is missing where a ray is
// inside, and they are to the bit what they would be if the others had never come.
TEST(Bundle, WhatIsSharedIsAsGoodAndLeavesNoTrace) {
    BundleWindows along;
    std::uint64_t number = 0, stretches_alone = 0, stretches_shared = 0;
    int inside = 0;
    const auto every = [](const BundlePart&, double, double) { return true; };
    const int no_end = std::numeric_limits<int>::max();
    for (std::uint64_t seed = 70; seed < 78; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Random random(seed);
        Scene scene = tools::random_scene({.elements = 12}, seed);
        if (seed % 2 == 0) {  // clusters
            scene = {};
            scene.threshold = 0.5;
            for (int n = 0; n < 3000; ++n) {
                scene.elements.push_back({.skeleton = PointSkeleton{random.in_cube(1)},
                                          .width = random.uniform(0.05, 0.08)});
            }
        }
        const Field field = compile(scene);
        ASSERT_EQ(field.clusters.empty(), seed % 2 != 0);
        const ElementList all = all_clusters(field);
        const Vec3d origin = 4.0 * unit(random.in_cube(1));
        const Vec3d axis = unit(0.2 * random.in_cube(1) - origin);
        const CommonBundle common{{origin, axis, 0.03}, &all, ++number};
        struct Seen {
            double begin, end, rise;
            std::vector<BundleEntry<float>> strong, weak;
            bool operator==(const Seen& other) const {
                const auto same = [](const auto& a, const auto& b) {
                    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                                      [](const auto& p, const auto& q) {
                                          return p.cx == q.cx && p.cy == q.cy && p.cz == q.cz &&
                                                 p.strength == q.strength;
                                      });
                };
                return begin == other.begin && end == other.end && rise == other.rise &&
                       same(strong, other.strong) && same(weak, other.weak);
            }
        };
        for (int tile = 0; tile < 4; ++tile) {
            const Vec3d tile_axis = unit(axis + 0.015 * unit(random.in_cube(1)));
            const Bundle bundle{origin, tile_axis, 0.012};
            const std::array parts{whole_of(bundle)};
            const auto windows_of = [&](BundleWindows& by, const CommonBundle& in,
                                        const auto& visit) {
                std::vector<Seen> seen;
                EXPECT_TRUE(by.build(field, all, bundle, 1e-6, true, &in));
                by.for_windows(parts, {}, every, no_end, [&](Window& window, const BundlePart&) {
                    const auto entries = [](const StageEntries<float>& stage) {
                        return std::vector(
                            stage.entry.begin(),
                            stage.entry.begin() + static_cast<std::ptrdiff_t>(stage.size));
                    };
                    seen.push_back({window.begin, window.end, window.rise, entries(window.strong),
                                    entries(window.weak)});
                    visit(window);
                    return !testing::Test::HasFailure();
                });
                return seen;
            };
            const auto ray = [&] {
                return unit(tile_axis + 0.0119 * random.uniform(0, 1) * unit(random.in_cube(1)));
            };
            const std::vector<Seen> seen = windows_of(along, common, [&](Window& window) {
                along.complete(window);
                for (int n = 0; n < 4; ++n) {
                    tools::expect_stages_hold(field, window, origin, ray(),
                                              random.uniform(window.begin, window.end));
                }
            });
            stretches_shared += along.stretches();
            BundleWindows fresh;
            const CommonBundle again{common.bundle, &all, ++number};
            EXPECT_TRUE(seen == windows_of(fresh, again, [](Window&) {}));
            stretches_alone += fresh.stretches();
            for (int n = 0; n < 500; ++n) {
                const double t = random.uniform(2, 6);
                if (!(sample(field, origin + t * ray()).value > 1e-9)) continue;
                ++inside;
                ASSERT_TRUE(std::any_of(
                    seen.begin(), seen.end(),
                    [&](const Seen& window) { return window.begin <= t && t <= window.end; }))
                    << "t " << t;
            }
        }
    }
    EXPECT_GT(inside, 500);
    EXPECT_LT(stretches_shared, stretches_alone * 9 / 10);
    std::printf("%d places inside; %llu stretches bounded, alone %llu\n", inside,
                static_cast<unsigned long long>(stretches_shared),
                static_cast<unsigned long long>(stretches_alone));
}

// Between two places of a window without kinks f' rises by `rise` times their distance at the
// most, and falls by `fall` times it.
TEST_P(BundleOf, TheSlopeChangesNoFasterThanItsBounds) {
    int windows = 0;
    double share = 0;
    for_random_windows(
        GetParam(), [&](const Field& field, const Vec3d& origin, const Window& window, double scale,
                        const Vec3d& d, Random& random) {
            const auto has_kinks = [](const auto& stage) {
                const std::span entries(stage.entry.data(), stage.size);
                return std::any_of(entries.begin(), entries.end(), [](const auto& entry) {
                    return entry.slope == 0 || entry.joins != 0;
                });
            };
            if (has_kinks(window.fine) || has_kinks(window.fine_in_float)) return;
            const double a = random.uniform(window.begin, window.end);
            const double b = random.uniform(window.begin, window.end);
            const double t0 = std::min(a, b), t1 = std::max(a, b);
            const auto slope = [&](double t) {
                return scale * dot(sample(field, place(origin, t, d)).gradient, d);
            };
            const double change = slope(t1) - slope(t0);
            // What is left out has a slope of its own, below 1e-9 here.
            ASSERT_LE(change, window.rise * (t1 - t0) + 1e-9);
            ASSERT_GE(change, -window.fall * (t1 - t0) - 1e-9);
            ++windows;
            if (t1 - t0 < 1e-3) return;
            share = std::max(
                {share, change / (window.rise * (t1 - t0)), -change / (window.fall * (t1 - t0))});
        });
    std::printf("%d windows, up to %.3f of a bound\n", windows, share);
    // Windows of one part alone, where there are others, are few.
    EXPECT_GT(windows, is_joined(GetParam().shape) ? 40 : 150);
    EXPECT_GT(share, 0.5);
}

}  // namespace
}  // namespace ivory
