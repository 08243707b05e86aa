// Clusters hold their members, lists of clusters stand for the whole field, and the windows made
// from them miss nothing.
#include "core/field/clusters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/field/bundle_steps.h"
#include "core/field/surface.h"
#include "core/math/direction.h"
#include "tests/core/field/stage_check.h"
#include "tests/core/trace/bundle_windows.h"
#include "tests/tools/kinds.h"
#include "tests/tools/on_skeleton.h"
#include "tests/tools/parts.h"
#include "tests/tools/random_scene.h"
#include "tests/tools/seed.h"

namespace ivory {
namespace {

using tools::Random;

double length(const Vec3d& v) { return std::sqrt(dot(v, v)); }

// Every shape, kernel and sign, in a cube of half side 2: most of it is far from any ray.
Scene crowd(std::size_t elements, std::uint64_t seed) {
    const double scale = 2 / (0.9 * std::cbrt(static_cast<double>(elements)));
    Scene scene = tools::random_scene({.elements = elements, .scale = scale}, seed);
    for (Element& element : scene.elements) element.visible = true;
    return scene;
}

TEST(Clusters, HoldTheirMembers) {
    const std::uint64_t seed = tools::announced_seed(61);
    Random random(seed);
    const Scene scene = crowd(3000, seed);
    const Field field = compile(scene);
    const Clusters& clusters = field.clusters;
    ASSERT_GT(clusters.size(), field.size() / cluster_size);
    ASSERT_EQ(clusters.first.back(), field.size());
    for (std::size_t c = 0; c < clusters.size(); ++c) {
        ASSERT_GT(clusters.first[c + 1], clusters.first[c]);
        ASSERT_LE(clusters.first[c + 1] - clusters.first[c], cluster_size);
        const Vec3d center{clusters.x[c], clusters.y[c], clusters.z[c]};
        double above = 0, below = 0;
        for (std::uint32_t i = clusters.first[c]; i < clusters.first[c + 1]; ++i) {
            ASSERT_EQ(clusters.of(i), c);
            if (i == clusters.first[c] || !field.joins_next(i - 1)) {
                (field.strength[i] > 0 ? above : below) += std::abs(field.strength[i]);
            }
            ASSERT_LE(clusters.inverse_square[c], 1 / (field.width[i] * field.width[i]));
            for (int n = 0; n < 5; ++n) {
                const Vec3d p =
                    tools::on_skeleton(tools::element_of_part(scene, field, i).skeleton, random);
                ASSERT_LE(length(p - center), clusters.radius[c] * (1 + 1e-12));
            }
        }
        ASSERT_GE(clusters.above[c], above);
        ASSERT_GE(clusters.below[c], below);
    }
    for (std::size_t group = 0; group < field_groups; ++group) {
        ASSERT_EQ(clusters.first_of_group.has(group), field.first.has(group));
        if (!field.first.has(group)) continue;
        const std::uint32_t first = clusters.first_of_group.range(group).first;
        ASSERT_EQ(clusters.first[first], field.first.range(group).first);
    }
}

TEST(Clusters, AreTheSameForAnyNumberOfThreads) {
    Scene scene = crowd(40'000, tools::announced_seed(67));
    // In one group, so that several threads sort it.
    for (Element& element : scene.elements) {
        element.skeleton = PointSkeleton{place_of(element)};
        element.kernel = KernelKind::blinn;
    }
    const Field field = compile(scene);
    ASSERT_FALSE(field.clusters.empty());
    EXPECT_TRUE(field == compile(scene, 2));
    EXPECT_TRUE(field == compile(scene, 5));
}

TEST(Clusters, FewElementsHaveNone) {
    Scene scene = crowd(least_clustered, 62);
    for (Element& element : scene.elements) element.skeleton = PointSkeleton{place_of(element)};
    EXPECT_FALSE(compile(scene).clusters.empty());
    scene.elements.pop_back();
    EXPECT_TRUE(compile(scene).clusters.empty());
    const Field field = compile(crowd(20, 62));
    EXPECT_EQ(all_clusters(field).elements.size(), field.size());
    EXPECT_TRUE(all_clusters(field).clusters.empty());
}

Cone some_cone(const Field& field, Random& random) {
    const Vec3d apex = 5.0 * unit(random.in_cube(1));
    const Vec3d target =
        random.chance(0.7) ? field.a(random.below(field.size())) : random.in_cube(4);
    return {apex, target - apex, std::exp(random.uniform(-8, -2))};
}

Vec3d direction_in(const Cone& cone, Random& random) {
    const Vec3d axis = unit(cone.axis);
    const Vec3d side = unit(cross(axis, random.in_cube(1)));
    const double sine = cone.sine * (random.chance(0.4) ? 1 - 1e-9 : random.uniform(0, 1));
    return unit(std::sqrt(1 - sine * sine) * axis + sine * side);
}

// What is not on the list sums to a member of its rest, and an empty list's rays stay outside.
void expect_stands_for_all(const Field& field, const ElementList& list, const Cone& cone,
                           Random& random, int& left_out) {
    std::vector<bool> listed(field.size(), false);
    for (const std::uint32_t i : list.elements) listed[i] = true;
    for (const std::uint32_t c : list.clusters) {
        std::fill(listed.begin() + field.clusters.first[c],
                  listed.begin() + field.clusters.first[c + 1], true);
    }
    for (int n = 0; n < 4; ++n) {
        const Vec3d d = direction_in(cone, random);
        const Vec3d p = cone.apex + random.uniform(0, 10) * d;
        if (list.certainly_empty) {
            ASSERT_LT(sample(field, p).value, 1e-12);
            continue;
        }
        const tools::LeftOutThere there = tools::left_out_at(field, listed, p);
        left_out += there.count;
        ASSERT_LE(there.above * (1 - 1e-9), list.left_out.hi);
        ASSERT_LE(there.below * (1 - 1e-9), -list.left_out.lo);
    }
}

// One element is so thin that float does not suit the field.
Scene uneven_crowd(std::size_t elements, std::uint64_t seed) {
    Scene scene = crowd(elements, seed);
    scene.elements.front().width *= 1e-4;
    return scene;
}

TEST(Clusters, ListsOfThemStandForAllElements) {
    const std::uint64_t first = tools::announced_seed(63);
    int left_out = 0, empty = 0, clustered = 0;
    for (std::uint64_t seed = first; seed < first + 3; ++seed) {
        const bool uneven = seed == first + 2;
        const Field field = compile(uneven ? uneven_crowd(4000, seed) : crowd(4000, seed));
        ASSERT_EQ(field.suits_float, !uneven);
        const ElementList all = all_clusters(field);
        Random random(seed);
        for (int n = 0; n < 40; ++n) {
            SCOPED_TRACE("seed " + std::to_string(seed) + ", cone " + std::to_string(n));
            const Cone cone = some_cone(field, random);
            Cone part = cone;
            part.axis = direction_in({cone.apex, cone.axis, 0.4 * cone.sine}, random);
            part.sine = 0.4 * cone.sine;
            const ElementList list = reaching_clusters(field, all, cone);
            const ElementList shorter = reaching_clusters(field, list, part);
            const ElementList elements = reaching_elements(field, list, part);
            ASSERT_TRUE(elements.clusters.empty());
            ASSERT_NO_FATAL_FAILURE(expect_stands_for_all(field, list, cone, random, left_out));
            ASSERT_NO_FATAL_FAILURE(expect_stands_for_all(field, shorter, part, random, left_out));
            ASSERT_NO_FATAL_FAILURE(expect_stands_for_all(field, elements, part, random, left_out));
            empty += list.certainly_empty;
            clustered += !list.clusters.empty();
        }
    }
    EXPECT_GT(left_out, 100000);
    EXPECT_GT(empty, 0);
    EXPECT_GT(clustered, 20);
}

// Where f >= 0 on a ray of a bundle's part there is a window, of the part or of the bundle, and
// all that can matter is in it.
TEST(Clusters, NoPlaceInsideIsWithoutAWindow) {
    const std::uint64_t first = tools::announced_seed(64);
    int inside = 0, windows = 0, of_parts = 0;
    for (std::uint64_t seed = first; seed < first + 6; ++seed) {
        const std::size_t elements = seed % 2 == 0 ? 3000 : 300;
        const Field field =
            compile(seed < first + 4 ? crowd(elements, seed) : uneven_crowd(elements, seed));
        Random random(seed);
        for (int n = 0; n < 5; ++n) {
            SCOPED_TRACE("seed " + std::to_string(seed) + ", bundle " + std::to_string(n));
            const Vec3d origin = 5.0 * unit(random.in_cube(1));
            const Vec3d axis = unit(field.a(random.below(field.size())) - origin);
            constexpr double spread = 0.04;
            std::vector<BundlePart> parts{{.axis = axis,
                                           .spread = spread,
                                           .origin = origin,
                                           .end = 1,
                                           .first_part = 1,
                                           .end_of_parts = 5}};
            for (int k = 0; k < 4; ++k) {
                const Vec3d side = unit(cross(axis, random.in_cube(1)));
                parts.push_back({.axis = unit(axis + 0.029 * side),
                                 .spread = 0.01,
                                 .origin = origin,
                                 .end = 1});
            }
            BundleWindows along;
            ASSERT_TRUE(along.build(field, all_clusters(field), {origin, axis, spread}, 1e-6));
            struct Stretch {
                double begin, end;
                std::size_t part;
            };
            std::vector<Stretch> seen;
            along.for_windows(
                parts, {}, [](const BundlePart&, double, double) { return true; },
                std::numeric_limits<int>::max(),
                [&](Window& window, const BundlePart& part) {
                    const auto number = static_cast<std::size_t>(
                        std::find_if(parts.begin(), parts.end(),
                                     [&](const BundlePart& p) { return p.axis == part.axis; }) -
                        parts.begin());
                    seen.push_back({window.begin, window.end, number});
                    of_parts += number > 0;
                    if (random.below(40) != 0) return true;
                    along.complete(window);
                    // A bound of what the window leaves out, at one of its places.
                    const Vec3d d = unit(part.axis + 0.9 * part.spread * random.uniform(0, 1) *
                                                         unit(random.in_cube(1)));
                    const Vec3d p = origin + random.uniform(window.begin, window.end) * d;
                    std::vector<bool> kept(field.size(), false);
                    for (const std::uint32_t i : window.fine.elements()) kept[i] = true;
                    for (const std::uint32_t i : window.fine_in_float.elements()) {
                        EXPECT_FALSE(kept[i]);
                        kept[i] = true;
                    }
                    const tools::LeftOutThere there = tools::left_out_at(field, kept, p);
                    const double share = field.scale * (1 - 1e-9);
                    EXPECT_LE(there.above * share, window.fine_bounds.above);
                    EXPECT_LE(there.below * share, window.fine_bounds.below);
                    return true;
                });
            windows += static_cast<int>(seen.size());
            for (std::size_t k = 1; k < parts.size(); ++k) {
                for (int ray = 0; ray < 4; ++ray) {
                    const Vec3d d =
                        unit(parts[k].axis + 0.9 * parts[k].spread * unit(random.in_cube(1)));
                    for (int place = 0; place < 60; ++place) {
                        const double t = random.uniform(0, 10);
                        if (!(sample(field, origin + t * d).value > 1e-9)) continue;
                        ++inside;
                        EXPECT_TRUE(std::any_of(seen.begin(), seen.end(),
                                                [&](const Stretch& s) {
                                                    return (s.part == 0 || s.part == k) &&
                                                           s.begin <= t && t <= s.end;
                                                }))
                            << "t " << t;
                    }
                }
            }
        }
    }
    EXPECT_GT(inside, 200);
    EXPECT_GT(windows, 500);
    EXPECT_GT(of_parts, 100);
}

// No element is nearer to a stretch than its bound says, though it stands in a cluster that is
// hundreds of widths wide: its place relative to the cluster's centre has lost digits.
class ClustersOf : public testing::TestWithParam<Shape> {};
INSTANTIATE_TEST_SUITE_P(Each, ClustersOf, testing::ValuesIn(tools::every_shape),
                         tools::name_of_kind);

TEST_P(ClustersOf, MembersOfWideClustersAreNoNearerThanTheirBounds) {
    const std::uint64_t seed = tools::announced_seed(66);
    Random random(seed);
    Scene scene = tools::random_scene(
        {.elements = least_clustered, .only = tools::ElementKind{GetParam(), KernelKind{}}}, seed);
    scene.threshold = 0.5;
    for (Element& element : scene.elements) {
        element.strength = element.width = 1;
        element.widths.assign(element.widths.size(), 1);
        element.visible = true;
        const Vec3d by = random.in_cube(200) - place_of(element);
        for (Vec3d* const place : tools::Members(element.skeleton).places) *place = *place + by;
    }
    const Field field = compile(scene);
    ActiveElements clusters;
    clusters.take(field.clusters.first_of_group, all_clusters(field).clusters);
    const BundleSteps& steps = bundle_steps();
    int checked = 0;
    double greatest = 0;  // share of the true s that the bound is
    LocalElements near, nearer;
    for (int n = 0; n < 2000; ++n) {
        const std::size_t aim = random.below(field.size());
        const Skeleton skeleton = tools::element_of_part(scene, field, aim).skeleton;
        const Vec3d target = tools::on_skeleton(skeleton, random);
        const Vec3d origin = target + 60.0 * unit(random.in_cube(1));
        const Vec3d axis = unit(target + random.in_cube(0.7) - origin);
        const double t = dot(target - origin, axis), middle = t + random.uniform(-2, 2);
        const auto stretch = [&](double half) {
            return LocalStretch{axis,
                                {},
                                0,
                                0,
                                (t - half - middle) / field.unit,
                                (t + half - middle) / field.unit,
                                middle / field.unit};
        };
        steps.bound_members(field, {origin, axis, 0, 0, t - 2, t + 2}, middle, stretch(2), 1e-12,
                            clusters, &near);
        steps.bound_local(near, stretch(0.25), 1e-12, nearer);
        for (const LocalElements* found : {&near, &nearer}) {
            for (std::size_t k = 0; k < found->size(); ++k) {
                if (static_cast<std::size_t>(found->element[k]) != aim) continue;
                const Vec3d p = origin + t * axis, off = p - tools::nearest_place(skeleton, p);
                ASSERT_LE(double{found->least[k]}, dot(off, off) * (1 + 1e-9) + 1e-12);
                greatest = std::max(greatest, double{found->least[k]} / dot(off, off));
                ++checked;
            }
        }
    }
    EXPECT_GT(checked, 3000);
    EXPECT_GT(greatest, 0.99);
}

// Windows whose elements come from clusters, crowded or hundreds of widths apart, where a member's
// place relative to its cluster has lost digits.
TEST(Clusters, StagesAreAsGoodAsTheirBounds) {
    const std::uint64_t first = tools::announced_seed(65);
    int windows = 0, sparse = 0, faint = 0, finer_faint = 0;
    double share = 0;
    for (std::uint64_t seed = first; seed < first + 8; ++seed) {
        Scene scene = crowd(2200, seed);
        const bool is_sparse = seed % 2 == 0;
        for (Element& element : scene.elements) {
            // Far from each other: the skeletons stay where they are.
            if (is_sparse) element.width *= 0.02;
        }
        const Field field = compile(scene);
        ASSERT_FALSE(field.clusters.empty());
        Random random(seed);
        for (int n = 0; n < 25; ++n) {
            SCOPED_TRACE("seed " + std::to_string(seed) + ", bundle " + std::to_string(n));
            const Vec3d origin = 5.0 * unit(random.in_cube(1));
            const std::size_t aim = random.below(field.size());
            const Vec3d target =
                tools::on_skeleton(scene.elements[field.source[aim]].skeleton, random);
            const double spread = is_sparse ? 1e-4 : 0.01;
            const Bundle bundle{origin, unit(target - origin), spread};
            BundleWindows along;
            ASSERT_TRUE(along.build(field, all_clusters(field), bundle, 1e-6));
            const std::array parts{whole_of(bundle)};
            along.for_windows(
                parts, {}, [](const BundlePart&, double, double) { return true; },
                std::numeric_limits<int>::max(),
                [&](Window& window, const BundlePart&) {
                    along.complete(window);
                    const Vec3d d = unit(bundle.axis + 0.9 * spread * random.uniform(0, 1) *
                                                           unit(random.in_cube(1)));
                    const double t = random.uniform(window.begin, window.end);
                    share = std::max(share, tools::expect_stages_hold(field, window, origin, d, t));
                    faint += window.fine_in_float.size > 0;
                    ++windows;
                    sparse += is_sparse;
                    if (random.below(8) != 0) return true;
                    const Window &finer = along.full_mixed(), &refined = along.full();
                    tools::expect_stages_hold(field, finer, origin, d, t);
                    tools::expect_stages_hold(field, refined, origin, d, t);
                    const Window& closer = along.about_root(origin, d, t);
                    EXPECT_TRUE(closer.begin <= t && t <= closer.end);
                    tools::expect_stages_hold(field, closer, origin, d, t);
                    EXPECT_LE(closer.fine_bounds.above, finer.fine_bounds.above);
                    // Arcs that are bent more than they are far leave more to the place than to float.
                    const auto entries = refined.fine.elements();
                    if (std::none_of(entries.begin(), entries.end(), [&](std::uint32_t i) {
                            return field.shape[i] == Shape::curve;
                        })) {
                        EXPECT_LT(finer.fine_bounds.above, 2 * refined.fine_bounds.above + 1e-11);
                    }
                    finer_faint += finer.fine_in_float.size > 0;
                    EXPECT_EQ(refined.fine_in_float.size, 0u);
                    return true;
                });
        }
    }
    EXPECT_GT(windows, 500);
    EXPECT_GT(sparse, 50);
    EXPECT_GT(faint, 200);
    EXPECT_GT(finer_faint, 20);
    EXPECT_GT(share, 0.1);
    std::printf("%d windows, %d of sparse fields, up to %.3f of a bound\n", windows, sparse, share);
}

}  // namespace
}  // namespace ivory
