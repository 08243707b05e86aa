// The bytes of a picture depend on the picture alone: not on threads, order, tiles or history.
#include "core/render/render.h"

#include <gtest/gtest.h>

#include <atomic>
#include <bit>
#include <cmath>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <new>
#include <numeric>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "core/render/statistics.h"
#include "core/trace/trace.h"
#include "tests/tools/random_scene.h"
#include "tests/tools/seed.h"

namespace ivory {
namespace {

// Every shape, kernel and sign, some of it out of the picture.
Scene mixed_scene() {
    Scene scene;
    scene.threshold = 0.5;
    scene.camera = Camera{{0.5, 1, 7}, {0, 0, 0}, {0, 1, 0}, 40};
    scene.elements = {
        {.skeleton = CircleSkeleton{{0, 0, 0}, {0, 0.4, 1}, 1.3},
         .color = {0.9, 0.7, 0.1},
         .width = 0.4},
        {.skeleton = SegmentSkeleton{{-1.5, -1, 0}, {1.5, 1, 0.5}},
         .color = {0.1, 0.4, 0.9},
         .width = 0.5},
        {.skeleton = PointSkeleton{{0.3, 0.9, 0.6}},
         .color = {0.8, 0.1, 0.2},
         .kernel = KernelKind::wyvill,
         .width = 1.1},
        {.skeleton = PointSkeleton{{-0.9, 0.8, 0.2}},
         .kernel = KernelKind::nishimura,
         .width = 1.3},
        {.skeleton = PointSkeleton{{0.4, 0.3, 1}}, .strength = -0.8, .width = 0.5},
        {.skeleton = PointSkeleton{{3, -2, -40}}, .width = 2},
        {.skeleton = PointSkeleton{{0, 0, 3}}, .visible = false},
    };
    return scene;
}

constexpr int frame_width = 150,
              frame_height = 90;  // no multiples of a tile, several regions across 64

Picture picture_of(const Scene& scene, const char* method = "proved", int w = frame_width,
                   int h = frame_height) {
    return make_picture(scene, w, h, *find_method(method), {.tolerance = 1e-6});
}

// All that a frame holds, miss by miss and bit by bit.
std::vector<std::uint64_t> bits_of(const Frame& frame, bool with_color = true) {
    std::vector<std::uint64_t> bits;
    for (std::size_t p = 0; p < frame.size(); ++p) {
        bits.push_back(static_cast<std::uint64_t>(frame.status[p]));
        if (with_color) bits.push_back(std::bit_cast<std::uint32_t>(frame.color[p]));
        if (!possibly_hit(frame.status[p])) continue;
        bits.push_back(std::bit_cast<std::uint64_t>(frame.t_lo[p]));
        bits.push_back(std::bit_cast<std::uint64_t>(frame.t_hi[p]));
        if (frame.surface.empty()) continue;
        for (const Vec3d& v : {frame.surface[p].normal, frame.surface[p].color}) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                bits.push_back(std::bit_cast<std::uint64_t>(v[axis]));
            }
        }
    }
    return bits;
}

const std::vector<std::uint64_t>& expected_bits() {
    static const std::vector<std::uint64_t> bits = [] {
        Canvas canvas(frame_width, frame_height, true);
        render(picture_of(mixed_scene()), canvas, {});
        return bits_of(canvas.frame);
    }();
    return bits;
}

TEST(Render, PixelsAreTheAnswersOfTheirRays) {
    for (const char* method : {"proved", "bisection"}) {
        const Picture picture = picture_of(mixed_scene(), method);
        const ElementList all = all_elements(*picture.field);
        Canvas canvas(frame_width, frame_height, true);
        render(picture, canvas, {});
        std::size_t roots = 0, differing = 0;
        for (int j = 0; j < frame_height; ++j) {
            for (int i = 0; i < frame_width; ++i) {
                const Ray ray = primary_ray(picture.view, frame_width, frame_height, i, j);
                Counts counts;
                const Answer answer =
                    trace(*picture.field, all, ray, *picture.method, picture.options, counts);
                const std::size_t p = canvas.frame.at(i, j);
                ASSERT_EQ(canvas.frame.status[p], answer.isolation.status) << i << ", " << j;
                if (!possibly_hit(answer.isolation.status)) {
                    ASSERT_EQ(canvas.frame.color[p], picture.lighting.background);
                    continue;
                }
                ++roots;
                const Interval<double> t = answer.isolation.t;
                ASSERT_FALSE(is_empty(intersection(canvas.frame.t(p), t))) << i << ", " << j;
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    ASSERT_NEAR(canvas.frame.surface[p].normal[axis], answer.surface.normal[axis],
                                1e-4);
                    ASSERT_NEAR(canvas.frame.surface[p].color[axis], answer.surface.color[axis],
                                1e-4);
                }
                // What is only looked at is made in float.
                const Rgba8 a = canvas.frame.color[p];
                const Rgba8 b = shade(picture.lighting, ray.direction, canvas.frame.surface[p]);
                ASSERT_LE(std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)}),
                          1)
                    << i << ", " << j;
                differing += a != b;
            }
        }
        EXPECT_GT(roots, canvas.frame.size() / 10);
        EXPECT_LT(roots, canvas.frame.size() / 2);
        EXPECT_LT(differing, roots / 100);
    }
}

// Of many elements, so that lists are cut and parts of tiles have windows of their own: each pixel
// is answered as its ray alone is against all elements.
TEST(Render, CrowdedPicturesAreTheAnswersOfTheirRays) {
    constexpr int side = 64;
    std::uint64_t left_out = 0, shorter = 0;
    int hits = 0, misses = 0;
    for (std::uint64_t seed = 21; seed < 27; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Scene scene = tools::random_scene({.elements = 80}, seed);
        scene.camera = Camera{{0, 0, 6}, {0, 0, 0}, {0, 1, 0}, 35};
        Picture picture = picture_of(scene, "proved", side, side);
        const ElementList all = all_elements(*picture.field);
        Canvas canvas(side, side, false);
        const SkippingCounts counts = render(picture, canvas, {}).counts.skipping;
        left_out += counts.list_left_out;
        for (int j = 0; j < side; j += 3) {
            for (int i = 0; i < side; ++i) {
                const Ray ray = primary_ray(picture.view, side, side, i, j);
                Counts alone_counts;
                const Isolation alone = picture.method->isolate(*picture.field, all, ray,
                                                                picture.options, alone_counts);
                const std::size_t p = canvas.frame.at(i, j);
                const Status found = canvas.frame.status[p];
                if (alone.status == Status::unresolved || found == Status::unresolved) continue;
                ASSERT_EQ(found, alone.status) << i << ", " << j;
                ++(found == Status::hit ? hits : misses);
                if (found == Status::miss) continue;
                ASSERT_FALSE(is_empty(intersection(canvas.frame.t(p), alone.t))) << i << ", " << j;
            }
        }
        picture.options.skipping.parts = false;
        Canvas whole(side, side, false);
        shorter += render(picture, whole, {}).counts.skipping.stretches != counts.stretches;
    }
    EXPECT_GT(hits, 500);
    EXPECT_GT(misses, 500);
    EXPECT_GT(left_out, 0u);
    EXPECT_GT(shorter, 0u);
}

// Where pixels lie farther apart than the elements are wide, each ray has windows of its own:
// hardly one is left to be traced alone, which takes a hundred times as long.
TEST(Render, SmallPicturesOfCrowdedScenesLeaveNoRayAlone) {
    constexpr int width = 64, height = 36;
    const Picture picture = picture_of(tools::mixed_scene(600, 11), "proved", width, height);
    Canvas canvas(width, height, false);
    JobSettings settings;
    settings.threads = 2;
    const JobReport report = render(picture, canvas, settings);
    EXPECT_GT(report.counts.skipping.rays, 1000u);
    EXPECT_LT(report.counts.skipping.rays_alone, report.counts.skipping.rays / 100);
}

TEST(Render, BytesDoNotDependOnThreadsOrOrder) {
    for (const int threads : {1, 2, 4, 7}) {
        for (const Order order : {Order::plain, Order::from_focus}) {
            for (const bool keep_lists : {false, true}) {
                Canvas canvas(frame_width, frame_height, true);
                JobSettings settings;
                settings.threads = threads;
                settings.order = order;
                settings.keep_lists = keep_lists;
                settings.focus_i = threads * 20;
                settings.focus_j = 85;
                EXPECT_TRUE(render(picture_of(mixed_scene()), canvas, settings).complete);
                EXPECT_TRUE(bits_of(canvas.frame) == expected_bits()) << threads;
            }
        }
    }
}

// What was tested for lists and bounded, not only what came of it: nobody takes another list
// because the one for him is not ready yet. Here the second picture's region takes longer than
// threads do.
TEST(Render, WorkDoesNotDependOnThreads) {
    constexpr int side = 32;
    Scene scene;
    scene.threshold = 0.5;
    scene.camera = Camera{{0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 10};
    tools::Random random(7);
    for (int n = 0; n < 200000; ++n) {
        scene.elements.push_back({.skeleton = PointSkeleton{random.in_cube(1)}, .width = 0.004});
    }
    const Picture picture = picture_of(scene, "proved", side, side);
    std::array<std::uint64_t, 4> expected[2];
    for (const int threads : {1, 2, 4}) {
        Canvas canvas(side, side, false);
        JobSettings settings;
        settings.threads = threads;
        settings.keep_lists = true;
        for (int n = 0; n < 6; ++n) {
            const JobReport by_others = render(picture, canvas, settings);
            const SkippingCounts counts = by_others.counts.skipping;
            const std::array work{counts.list_elements, counts.list_left_out, counts.stretches,
                                  counts.stretches_ended};
            std::array<std::uint64_t, 4>& first = expected[std::min(n, 1)];
            if (threads == 1 && n < 2) first = work;
            EXPECT_EQ(work, first) << threads;
        }
    }
    EXPECT_LT(expected[1][0], expected[0][0]);
}

TEST(Render, BytesDoNotDependOnWhatWasOnTheCanvas) {
    Canvas canvas(frame_width, frame_height, true);
    Scene other = mixed_scene();
    other.threshold = 0.3;
    JobSettings settings;
    settings.keep_lists = true;
    settings.threads = 2;
    render(picture_of(other), canvas, settings);
    canvas.forget_lists();
    render(picture_of(mixed_scene()), canvas, settings);
    EXPECT_TRUE(bits_of(canvas.frame) == expected_bits());
    // With the lists of the same field and view, once more.
    render(picture_of(mixed_scene()), canvas, settings);
    EXPECT_TRUE(bits_of(canvas.frame) == expected_bits());
}

// Misses all rays and remembers them.
class Recorder final : public Method {
  public:
    std::string_view name() const override { return "recorder"; }
    std::string_view proves() const override { return "nothing"; }
    Isolation isolate(const Field&, const ElementList&, const Ray& ray, const MethodOptions&,
                      Counts&) const override {
        const std::lock_guard lock(mutex_);
        const Vec3d d = ray.direction;
        ++times_[{d.x, d.y, d.z}];
        return {Status::claimed_miss, {}};
    }
    const std::map<std::array<double, 3>, int>& times() const { return times_; }

  private:
    mutable std::mutex mutex_;
    mutable std::map<std::array<double, 3>, int> times_;
};

TEST(Render, NoPixelIsTracedTwice) {
    Scene scene;
    scene.camera = Camera{{0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 30};
    scene.elements = {{.skeleton = PointSkeleton{}, .width = 10}};  // fills the picture
    for (const Order order : {Order::plain, Order::from_focus}) {
        const Recorder recorder;
        Picture picture = picture_of(scene);
        picture.method = &recorder;
        Canvas canvas(frame_width, frame_height, false);
        JobSettings settings;
        settings.order = order;
        settings.threads = 2;
        render(picture, canvas, settings);
        EXPECT_EQ(recorder.times().size(), canvas.frame.size());
        for (const auto& [direction, times] : recorder.times()) EXPECT_EQ(times, 1);
    }
}

TEST(Render, EachTileIsToldOnceWithItsFinalPixels) {
    const Picture picture = picture_of(mixed_scene());
    Canvas expected(frame_width, frame_height, false);
    render(picture, expected, {});

    Canvas canvas(frame_width, frame_height, false);
    std::vector<std::atomic<int>> told(canvas.tiles.size());
    std::atomic<int> wrong{0};
    JobSettings settings;
    settings.order = Order::from_focus;
    settings.threads = 3;
    settings.on_tile = [&](const TileNotice& notice) {
        ++told[notice.tile];
        if (notice.rect != canvas.grid.tiles.rect(notice.tile)) ++wrong;
        for (int j = notice.rect.y0; j < notice.rect.y1; ++j) {
            for (int i = notice.rect.x0; i < notice.rect.x1; ++i) {
                const std::size_t p = canvas.frame.at(i, j);
                if (canvas.frame.color[p] != expected.frame.color[p]) ++wrong;
            }
        }
    };
    render(picture, canvas, settings);
    EXPECT_EQ(wrong, 0);
    for (const std::atomic<int>& times : told) EXPECT_EQ(times, 1);
}

// The statuses that are in the frame, counted one by one.
std::array<std::uint64_t, 5> counted(const Frame& frame) {
    std::array<std::uint64_t, 5> count{};
    for (std::size_t p = 0; p < frame.size(); ++p) {
        ++count[static_cast<std::size_t>(frame.status[p])];
    }
    return count;
}

// Tiles of 256 pixels, and tiles that the picture's edge cuts off.
TEST(Render, TheTallyIsThatOfThePixels) {
    for (const Order order : {Order::plain, Order::from_focus}) {
        Canvas canvas(frame_width, frame_height, false);
        JobSettings settings;
        settings.order = order;
        render(picture_of(mixed_scene()), canvas, settings);
        const std::array<std::uint64_t, 5> expected = counted(canvas.frame);
        EXPECT_EQ(pixel_statistics(canvas).pixels, expected);
        EXPECT_GT(expected[0], 1000u);
        EXPECT_EQ(std::accumulate(expected.begin(), expected.end(), std::uint64_t{0}),
                  canvas.frame.size());
    }
}

// Of any tiles each pixel is traced, and none is left over from the picture before.
TEST(Render, SelectedTilesAreTracedWhole) {
    constexpr int width = 900, height = 760;
    const Picture picture = picture_of(mixed_scene(), "proved", width, height);
    Scene other = mixed_scene();
    other.threshold = 0.3;
    other.background = {0.5, 0.5, 0.5};
    Canvas expected(width, height, false), before(width, height, false);
    render(picture, expected, {});
    const Picture picture_before = picture_of(other, "proved", width, height);
    render(picture_before, before, {});
    std::mt19937 random(tools::announced_seed(3));
    for (const unsigned one_in : {2u, 5u, 40u}) {
        Canvas canvas(width, height, false);
        render(picture_before, canvas, {});
        JobSettings settings;
        settings.order = Order::from_focus;
        settings.threads = 2;
        for (std::size_t t = 0; t < canvas.tiles.size(); ++t) {
            settings.selected.push_back(random() % one_in == 0);
        }
        render(picture, canvas, settings);
        for (std::size_t t = 0; t < canvas.tiles.size(); ++t) {
            const PixelRect rect = canvas.grid.tiles.rect(t);
            const Frame& wanted = (settings.selected[t] != 0 ? expected : before).frame;
            for (int j = rect.y0; j < rect.y1; ++j) {
                for (int i = rect.x0; i < rect.x1; ++i) {
                    const std::size_t p = canvas.frame.at(i, j);
                    ASSERT_EQ(canvas.frame.color[p], wanted.color[p]) << i << ", " << j;
                    ASSERT_EQ(canvas.frame.status[p], wanted.status[p]) << i << ", " << j;
                }
            }
        }
        EXPECT_EQ(pixel_statistics(canvas).pixels, counted(canvas.frame));
    }
}

TEST(Render, TheFocusComesFirst) {
    Canvas canvas(600, 400, false);
    std::vector<PixelRect> seen;
    JobSettings settings;
    settings.order = Order::from_focus;
    settings.focus_i = 590;
    settings.focus_j = 10;
    settings.on_tile = [&](const TileNotice& notice) { seen.push_back(notice.rect); };
    render(picture_of(mixed_scene(), "proved", 600, 400), canvas, settings);
    ASSERT_EQ(seen.size(), canvas.tiles.size());
    EXPECT_GE(seen.front().x0, 576);
    EXPECT_LT(seen.front().y0, 64);
}

TEST(Render, ACancelledJobLeavesEveryTileWhatItsStateSays) {
    const Picture picture = picture_of(mixed_scene());
    Canvas expected(frame_width, frame_height, false);
    render(picture, expected, {});
    constexpr Rgba8 untouched{1, 2, 3, 4};  // a is 255 in every pixel that is drawn

    for (const int notices : {0, 1, 5, 20, 40, 59, 60}) {
        for (const Order order : {Order::plain, Order::from_focus}) {
            Canvas canvas(frame_width, frame_height, false);
            for (std::size_t p = 0; p < canvas.frame.size(); ++p) canvas.frame.color[p] = untouched;
            std::mutex mutex;
            std::condition_variable reached;
            int count = 0;
            JobSettings settings;
            settings.order = order;
            settings.threads = 2;
            settings.on_tile = [&](const TileNotice&) {
                const std::lock_guard lock(mutex);
                ++count;
                reached.notify_all();
            };
            FrameJob job(picture, canvas, settings);
            {
                std::unique_lock lock(mutex);
                reached.wait_for(lock, std::chrono::seconds(1),
                                 [&] { return count >= notices || job.finished(); });
            }
            job.cancel();
            const JobReport report = job.finish();
            EXPECT_TRUE(job.finished());

            std::size_t done = 0;
            for (std::size_t t = 0; t < canvas.tiles.size(); ++t) {
                const TileState& tile = canvas.tiles[t];
                const PixelRect rect = canvas.grid.tiles.rect(t);
                if (tile.traced) ++done;
                std::size_t pixels = 0;
                for (int j = rect.y0; j < rect.y1; ++j) {
                    for (int i = rect.x0; i < rect.x1; ++i) {
                        const std::size_t p = canvas.frame.at(i, j);
                        ASSERT_EQ(canvas.frame.color[p],
                                  tile.traced ? expected.frame.color[p] : untouched);
                        pixels += tile.traced;
                    }
                }
                EXPECT_EQ(std::accumulate(tile.pixels.begin(), tile.pixels.end(), std::size_t{0}),
                          pixels);
            }
            EXPECT_EQ(report.complete, done == canvas.tiles.size());
        }
    }
}

TEST(Render, AJobThatIsDroppedIsCancelled) {
    Canvas canvas(2000, 2000, false);
    { const FrameJob job(picture_of(mixed_scene(), "proved", 2000, 2000), canvas, {}); }
    std::size_t done = 0;
    for (const TileState& tile : canvas.tiles) done += tile.traced;
    EXPECT_LT(done, canvas.tiles.size());
}

TEST(Render, WhatIsCancelledCanBeCompleted) {
    const Picture picture = picture_of(mixed_scene());
    Canvas canvas(frame_width, frame_height, true);
    JobSettings settings;
    settings.keep_lists = true;
    for (int n = 0; n < 20; ++n) {
        FrameJob job(picture, canvas, settings);
        static_cast<void>(job.wait_for(std::chrono::milliseconds(n)));
        job.cancel();
        job.finish();
    }
    render(picture, canvas, settings);
    EXPECT_TRUE(bits_of(canvas.frame) == expected_bits());
}

TEST(Render, OnlySelectedTilesAreTouched) {
    const Picture picture = picture_of(mixed_scene());
    Canvas expected(frame_width, frame_height, false);
    render(picture, expected, {});
    for (const Order order : {Order::plain, Order::from_focus}) {
        Canvas canvas(frame_width, frame_height, false);
        JobSettings settings;
        settings.order = order;
        settings.threads = 2;
        settings.selected.resize(canvas.tiles.size());
        for (std::size_t t = 0; t < canvas.tiles.size(); t += 3) settings.selected[t] = 1;
        std::mutex mutex;
        std::set<std::size_t> noticed;
        settings.on_tile = [&](const TileNotice& notice) {
            const std::lock_guard lock(mutex);
            noticed.insert(notice.tile);
        };
        const JobReport report = render(picture, canvas, settings);
        EXPECT_TRUE(report.complete);
        EXPECT_EQ(report.tiles_traced, noticed.size());
        for (std::size_t t = 0; t < canvas.tiles.size(); ++t) {
            EXPECT_EQ(canvas.tiles[t].traced, t % 3 == 0);
            EXPECT_EQ(noticed.contains(t), t % 3 == 0);
            if (t % 3 != 0) continue;
            const PixelRect rect = canvas.grid.tiles.rect(t);
            const std::size_t p = canvas.frame.at(rect.x1 - 1, rect.y1 - 1);
            EXPECT_EQ(canvas.frame.color[p], expected.frame.color[p]);
        }
    }
}

TEST(Render, ShadingAgainEqualsAFullRender) {
    Scene recolored = mixed_scene();
    recolored.background = {0.5, 0.4, 0.3};
    recolored.elements[0].color = {0, 0.3, 0.2};
    recolored.lights = {Light{{1, 2, 3}, {1, 0.8, 0.6}, 0.9, false}};
    Canvas expected(frame_width, frame_height, true);
    render(picture_of(recolored), expected, {});

    for (const bool keep_lists : {false, true}) {
        for (const bool keep_looks : {false, true}) {
            Canvas canvas(frame_width, frame_height, !keep_looks, keep_looks);
            JobSettings settings;
            settings.keep_lists = keep_lists;
            settings.threads = 2;
            const Picture before = picture_of(mixed_scene());
            render(before, canvas, settings);
            settings.task = Task::shade;
            Field field = *before.field;
            settings.recolored = recolor(field, recolored);
            EXPECT_EQ(settings.recolored.size(), 1u);
            const JobReport report = render(picture_of(recolored), canvas, settings);
            EXPECT_TRUE(report.complete);
            EXPECT_EQ(report.counts.evaluations, 0u);
            if (!keep_looks) {
                EXPECT_TRUE(bits_of(canvas.frame) == bits_of(expected.frame));
            }
            for (std::size_t p = 0; p < canvas.frame.size(); ++p) {
                ASSERT_EQ(canvas.frame.color[p], expected.frame.color[p]) << p;
            }
        }
    }
}

// Element by element, with lists of elements and of clusters: the picture is that of a full render,
// and tiles that the element has no share in keep their looks.
TEST(Render, EveryRecoloredElementIsSeenWhereItHasAShare) {
    for (const std::size_t elements : {40U, 2400U}) {
        SCOPED_TRACE(std::to_string(elements) + " elements");
        Scene scene = tools::mixed_scene(elements, 5);
        Canvas canvas(frame_width, frame_height, false, true);
        JobSettings settings;
        settings.keep_lists = true;
        settings.threads = 2;
        const Picture before = picture_of(scene);
        render(before, canvas, settings);
        settings.task = Task::shade;
        Field field = *before.field;
        EXPECT_EQ(field.clusters.empty(), elements < 2048);
        std::size_t kept = 0, tiles = 0;
        for (std::size_t n = 0; n < 20; ++n) {
            const std::size_t element = n * (elements / 20);
            scene.elements[element].color = {0.02 * static_cast<double>(n), 0.9, 0.1};
            settings.recolored = recolor(field, scene);
            ASSERT_EQ(settings.recolored.size(), 1u);
            for (const TileState& tile : canvas.tiles) {
                ElementFilter one;
                one.add(settings.recolored);
                tiles += !tile.empty;
                kept += !tile.empty && !tile.looked_at.meets(one);
            }
            const Picture picture = picture_of(scene);
            render(picture, canvas, settings);
            Canvas expected(frame_width, frame_height, false, true);
            render(picture, expected, {});
            for (std::size_t p = 0; p < canvas.frame.size(); ++p) {
                ASSERT_EQ(canvas.frame.color[p], expected.frame.color[p])
                    << "element " << element << ", pixel " << p;
            }
            // To the last bit: what bytes hardly show.
            for (std::size_t tile = 0; tile < canvas.tiles.size(); ++tile) {
                if (canvas.tiles[tile].empty) continue;
                const Looks &now = canvas.looks[tile], &then = expected.looks[tile];
                for (std::size_t k = 0; k < canvas.grid.tiles.rect(tile).area(); ++k) {
                    ASSERT_EQ(std::isnan(now.nx[k]), std::isnan(then.nx[k]));
                    if (std::isnan(now.nx[k])) continue;
                    ASSERT_TRUE(now.r[k] == then.r[k] && now.g[k] == then.g[k] &&
                                now.b[k] == then.b[k])
                        << "element " << element << ", tile " << tile << ", ray " << k;
                }
            }
        }
        EXPECT_GT(kept, tiles / 8);
    }
}

// Where all share one colour it is not mixed; once they do not it is, everywhere.
TEST(Render, AnotherColorThanTheCommonOneIsMixedEverywhere) {
    Scene scene = mixed_scene();
    for (Element& element : scene.elements) element.color = {0.3, 0.6, 0.7};
    Field field = compile(scene);
    ASSERT_TRUE(field.one_color);
    scene.elements[1].color = {0.3, 0.6, 0.1};
    EXPECT_EQ(recolor(field, scene).size(), field.size());
    scene.elements[0].color = {0.3, 0.6, 0.1};
    EXPECT_EQ(recolor(field, scene).size(), 1u);
}

TEST(Render, TracingWithoutShadingGivesTheSameAnswers) {
    Canvas canvas(frame_width, frame_height, true);
    JobSettings settings;
    settings.task = Task::trace;
    const Picture picture = picture_of(mixed_scene());
    render(picture, canvas, settings);
    Canvas shaded(frame_width, frame_height, true);
    render(picture, shaded, {});
    EXPECT_TRUE(bits_of(canvas.frame, false) == bits_of(shaded.frame, false));
    settings.task = Task::shade;
    render(picture, canvas, settings);
    EXPECT_TRUE(bits_of(canvas.frame) == bits_of(shaded.frame));
}

TEST(Render, StatisticsCountEveryPixelOnce) {
    Canvas canvas(frame_width, frame_height, false);
    JobSettings settings;
    settings.threads = 2;
    const JobReport report = render(picture_of(mixed_scene()), canvas, settings);
    const PixelStatistics statistics = pixel_statistics(canvas);
    std::array<std::uint64_t, 5> pixels{};
    double widest = 0;
    for (std::size_t p = 0; p < canvas.frame.size(); ++p) {
        ++pixels[static_cast<std::size_t>(canvas.frame.status[p])];
        if (canvas.frame.status[p] == Status::hit) {
            widest = std::max(widest, width(canvas.frame.t(p)));
        }
    }
    EXPECT_EQ(statistics.pixels, pixels);
    EXPECT_EQ(statistics.enclosure_width_max, widest);
    EXPECT_EQ(statistics.tiles, 10u * 6u);
    EXPECT_EQ(report.tiles_traced, statistics.tiles);
    EXPECT_GT(statistics.empty_tiles, 0u);
    EXPECT_LT(statistics.empty_tiles, statistics.tiles);
    EXPECT_GE(report.elements_reached, 5u);
    EXPECT_LE(report.elements_reached, 6u);  // one of the seven is invisible
    EXPECT_GE(report.shade_share, 0);
    EXPECT_LE(report.shade_share, 1);
}

// No hit becomes a miss without a kind of skipping, nor the reverse, and the statistics tell that
// it was off.
TEST(Render, NoAnswerRestsOnWhatIsSkipped) {
    Scene scene = mixed_scene();
    for (int i = 0; i < 12; ++i) {  // enough for lists of their own in a tile's parts
        scene.elements.push_back(
            {.skeleton = PointSkeleton{{-1.2 + 0.2 * i, -0.9, 0.3}}, .width = 0.2});
    }
    JobSettings settings;
    settings.threads = 2;
    Canvas usual(frame_width, frame_height, false);
    const JobReport all = render(picture_of(scene), usual, settings);
    EXPECT_GT(all.counts.skipping.list_left_out, 0u);
    EXPECT_GT(all.counts.skipping.stretches_ended, 0u);
    EXPECT_GT(all.counts.skipping.rays, 0u);
    for (const SkippingName& kind : skipping_names) {
        SCOPED_TRACE(kind.name);
        Picture picture = picture_of(scene);
        picture.options.skipping.*kind.member = false;
        Canvas canvas(frame_width, frame_height, false);
        const JobReport by_others = render(picture, canvas, settings);
        const SkippingCounts counts = by_others.counts.skipping;
        int hits = 0;
        for (std::size_t p = 0; p < canvas.frame.size(); ++p) {
            ASSERT_EQ(canvas.frame.status[p], usual.frame.status[p]);
            if (canvas.frame.status[p] != Status::hit) continue;
            ++hits;
            ASSERT_FALSE(is_empty(intersection(canvas.frame.t(p), usual.frame.t(p))));
        }
        EXPECT_GT(hits, 1000);
        EXPECT_EQ(counts.list_elements == 0, kind.name == "lists");
        EXPECT_EQ(counts.stretches_ended == 0, kind.name == "windows" || kind.name == "packets");
        EXPECT_EQ(counts.rays == 0, kind.name == "packets");
        if (kind.name == "parts") {
            EXPECT_NE(counts.stretches, all.counts.skipping.stretches);
        }
        if (kind.name == "coarse") {
            EXPECT_GT(by_others.counts.climbers[Rung::walk_again], counts.rays / 2);
        }
    }
}

// The samples of a pixel, from the larger picture.
struct Samples {
    std::set<Status> status;
};

// Pixel by pixel.
std::vector<Samples> samples_of(const Picture& picture, int w, int h, int n) {
    Canvas larger(w * n, h * n, true);
    JobSettings no_colors;
    no_colors.task = Task::trace;
    render(picture, larger, no_colors);
    std::vector<Samples> samples(static_cast<std::size_t>(w * h));
    for (int j = 0; j < h * n; ++j) {
        for (int i = 0; i < w * n; ++i) {
            const std::size_t p = larger.frame.at(i, j);
            samples[static_cast<std::size_t>(j / n * w + i / n)].status.insert(
                larger.frame.status[p]);
        }
    }
    return samples;
}

int most_apart(const Rgba8& a, const Rgba8& b) {
    return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
}

JobSettings sampling(SampledPicture& sampled, int threads = 1) {
    JobSettings settings;
    settings.threads = threads;
    settings.task = Task::sample;
    settings.sampled = &sampled;
    return settings;
}

// The contract's promise: of pixels whose samples differ in status the picture is their mean, of all
// others within a byte of it.
TEST(Render, SeveralSamplesArePromisedMeans) {
    Scene orthographic = mixed_scene();
    orthographic.camera->projection = Camera::Projection::orthographic;
    std::size_t pixels = 0, apart = 0, mixed = 0, mixed_apart = 0;
    for (const Scene& scene :
         {mixed_scene(), orthographic, tools::random_scene({.elements = 12}, 5),
          tools::random_scene({.elements = 40}, 8)}) {
        for (const int n : {2, 3, 4}) {
            SCOPED_TRACE(std::to_string(n * n) + " samples");
            const Picture picture = picture_of(scene);
            Canvas canvas(frame_width, frame_height, false),
                larger(n * frame_width, n * frame_height, true);
            SampledPicture sampled(canvas, n, false);
            const JobReport report = render(picture, canvas, sampling(sampled));
            ASSERT_TRUE(report.complete);
            render(picture, larger, {});
            const SampledPicture mean = mean_of(picture, larger, n);
            const std::vector<Samples> samples = samples_of(picture, frame_width, frame_height, n);
            for (std::size_t p = 0; p < canvas.frame.size(); ++p) {
                const int off = most_apart(sampled.color[p], mean.color[p]);
                ASSERT_LE(off, 1) << p % frame_width << ", " << p / frame_width;
                apart += off != 0;
                if (samples[p].status.size() < 2) continue;
                ++mixed;
                mixed_apart += off != 0;
            }
            pixels += samples.size();
            EXPECT_EQ(sampled.pixels.size(), mean.pixels.size());
            for (std::size_t tile = 0; tile < mean.pixels.size(); ++tile) {
                ASSERT_EQ(sampled.pixels[tile], mean.pixels[tile]) << tile;
            }
        }
    }
    std::printf("%zu pixels, %zu a byte away; %zu of mixed status, %zu a byte away\n", pixels,
                apart, mixed, mixed_apart);
    EXPECT_GT(mixed, 1000u);
    EXPECT_LT(apart, pixels / 50);
    // What float leaves of a sum near a byte's edge: the lists, and so the windows, are not the larger
    // picture's.
    EXPECT_LT(mixed_apart, mixed / 50);
}

// Most pixels are known from fewer samples, and no thread, tile or order is seen in what comes out.
TEST(Render, SeveralSamplesCostFewMore) {
    constexpr int across = 4 * frame_width, down = 4 * frame_height, n = 4;
    const Picture picture = picture_of(mixed_scene(), "proved", across, down);
    Canvas canvas(across, down, false);
    SampledPicture sampled(canvas, n, false), all(canvas, n, true);
    const JobReport some = render(picture, canvas, sampling(sampled));
    const JobReport every = render(picture, canvas, sampling(all));
    EXPECT_LT(3 * some.counts.evaluations, every.counts.evaluations);
    EXPECT_GT(some.elements_reached, 3u);
    SampledPicture again(canvas, n, false);
    render(picture, canvas, sampling(again, 3));
    std::vector<std::uint8_t> selected(canvas.tiles.size());
    for (std::size_t tile = 0; tile < selected.size(); tile += 3) selected[tile] = 1;
    SampledPicture few(canvas, n, false);
    JobSettings settings = sampling(few);
    settings.selected = selected;
    render(picture, canvas, settings);
    for (std::size_t p = 0; p < canvas.frame.size(); ++p) {
        ASSERT_EQ(again.color[p], sampled.color[p]);
        const std::size_t tile =
            canvas.grid.tiles.at(static_cast<int>(p) % across, static_cast<int>(p) / across);
        if (selected[tile] != 0) {
            ASSERT_EQ(few.color[p], sampled.color[p]);
        }
    }
    for (std::size_t tile = 0; tile < selected.size(); ++tile) {
        const auto& count = sampled.pixels[tile];
        EXPECT_EQ(std::accumulate(count.begin(), count.end(), 0),
                  static_cast<int>(canvas.grid.tiles.rect(tile).area()));
        EXPECT_EQ(few.pixels[tile] == count, selected[tile] != 0) << tile;
    }
}

// The least t of all samples.
TEST(Render, TheDepthOfSamplesIsTheLeast) {
    const Picture picture = picture_of(mixed_scene());
    Canvas canvas(frame_width, frame_height, false),
        larger(2 * frame_width, 2 * frame_height, true);
    SampledPicture sampled(canvas, 2, true);
    render(picture, canvas, sampling(sampled));
    render(picture, larger, {});
    const SampledPicture mean = mean_of(picture, larger, 2);
    int finite = 0;
    for (std::size_t p = 0; p < canvas.frame.size(); ++p) {
        if (mean.depth[p] == infinity<double>) {
            ASSERT_EQ(sampled.depth[p], mean.depth[p]);
            continue;
        }
        ASSERT_NEAR(sampled.depth[p], mean.depth[p], 2e-6);
        ++finite;
    }
    EXPECT_GT(finite, 1000);
}

// Each ray of an orthographic picture is answered as it is alone.
TEST(Render, OrthographicPixelsAreTheAnswersOfTheirRays) {
    Scene scene = mixed_scene();
    scene.camera->projection = Camera::Projection::orthographic;
    const Picture picture = picture_of(scene);
    const ElementList all = all_elements(*picture.field);
    Canvas canvas(frame_width, frame_height, false);
    const JobReport report = render(picture, canvas, {});
    int hits = 0;
    for (int j = 0; j < frame_height; ++j) {
        for (int i = 0; i < frame_width; ++i) {
            Counts counts;
            const Answer answer = trace(*picture.field, all,
                                        primary_ray(picture.view, frame_width, frame_height, i, j),
                                        *picture.method, picture.options, counts);
            const std::size_t p = canvas.frame.at(i, j);
            ASSERT_EQ(canvas.frame.status[p], answer.isolation.status) << i << ", " << j;
            if (!possibly_hit(answer.isolation.status)) continue;
            ++hits;
            ASSERT_LE(canvas.frame.t_lo[p], answer.isolation.t.hi);
            ASSERT_GE(canvas.frame.t_hi[p], answer.isolation.t.lo);
        }
    }
    EXPECT_GT(hits, 1500);
    // in packets, not one by one
    EXPECT_LT(report.counts.skipping.rays_alone, canvas.frame.size() / 100);
}

TEST(Render, AnEmptySceneIsAllBackground) {
    Scene scene;
    Canvas canvas(33, 20, true);
    const JobReport report = render(picture_of(scene, "proved", 33, 20), canvas, {});
    const PixelStatistics statistics = pixel_statistics(canvas);
    EXPECT_EQ(statistics.pixels[static_cast<std::size_t>(Status::miss)], 33u * 20u);
    EXPECT_EQ(statistics.empty_tiles, statistics.tiles);
    EXPECT_EQ(report.counts.evaluations, 0u);
    EXPECT_EQ(report.elements_reached, 0u);
    for (std::size_t p = 0; p < canvas.frame.size(); ++p) {
        ASSERT_EQ(canvas.frame.color[p], to_srgb(scene.background));
    }
}

TEST(Render, OnePixelIsAPicture) {
    Canvas canvas(1, 1, false);
    JobSettings settings;
    settings.threads = 8;
    settings.order = Order::from_focus;
    Scene scene;
    scene.elements = {{.skeleton = PointSkeleton{}}};
    EXPECT_TRUE(render(picture_of(scene, "proved", 1, 1), canvas, settings).complete);
    EXPECT_EQ(canvas.frame.status[0], Status::hit);
}

class Exhausted final : public Method {
  public:
    std::string_view name() const override { return "exhausted"; }
    std::string_view proves() const override { return "nothing"; }
    Isolation isolate(const Field&, const ElementList&, const Ray&, const MethodOptions&,
                      Counts&) const override {
        throw std::bad_alloc();
    }
};

TEST(Render, WhatAWorkerThrowsReachesTheCaller) {
    const Exhausted exhausted;
    Picture picture = picture_of(mixed_scene());
    picture.method = &exhausted;
    Canvas canvas(frame_width, frame_height, false);
    JobSettings settings;
    settings.threads = 3;
    EXPECT_THROW(render(picture, canvas, settings), std::bad_alloc);
}

TEST(Render, ProgressRunsFromNothingToAll) {
    Canvas canvas(frame_width, frame_height, false);
    FrameJob job(picture_of(mixed_scene()), canvas, {});
    EXPECT_GE(job.progress(), 0);
    while (!job.wait_for(std::chrono::milliseconds(1))) EXPECT_LE(job.progress(), 1);
    EXPECT_EQ(job.progress(), 1);
    EXPECT_TRUE(job.finish().complete);
}

}  // namespace
}  // namespace ivory
