// Tracing while a person works. What is asserted are pictures and counts, never times.
#include "app/viewer/render_session.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include "app/viewer/wake_up.h"
#include "core/render/canvas.h"
#include "core/render/render.h"
#include "tests/tools/random_scene.h"
#include "tests/tools/seed.h"

namespace ivory {
namespace {

using Clock = std::chrono::steady_clock;
using SceneValue = std::shared_ptr<const Scene>;

constexpr WindowSize size{200, 136};
constexpr double tolerance = 1e-6;

Camera camera() {
    Camera c;
    c.position = {0.5, 0.4, 7};
    c.target = {0, 0, 0};
    return c;
}

Element point(Vec3d position, KernelKind kernel, double width, Color color) {
    Element element;
    element.skeleton = PointSkeleton{position};
    element.kernel = kernel;
    element.width = width;
    element.color = color;
    return element;
}

Scene two_blobs() {
    Scene scene;
    scene.threshold = 0.4;
    scene.elements = {point({-1.2, 0.2, 0}, KernelKind::wyvill, 1.5, {0.9, 0.3, 0.1}),
                      point({1.4, -0.3, 0}, KernelKind::blinn, 0.7, {0.1, 0.4, 0.9})};
    return scene;
}

SceneValue with_left_blob_at(double x) {
    Scene scene = two_blobs();
    std::get<PointSkeleton>(scene.elements[0].skeleton).position.x = x;
    return std::make_shared<const Scene>(std::move(scene));
}

// What `ivory render` draws, and how many of its pixels have each Status.
struct Rendered {
    std::vector<Rgba8> color;
    std::array<std::uint64_t, 5> pixels{};
};

Rendered rendered_and_counted(const Scene& scene, const Camera& c, WindowSize picture_size) {
    Scene seen = scene;
    seen.camera = c;
    const Picture picture = make_picture(seen, picture_size.width, picture_size.height,
                                         *methods().front(), {.tolerance = tolerance});
    Canvas canvas(picture_size.width, picture_size.height, false);
    JobSettings settings;
    settings.threads = 2;
    render(picture, canvas, settings);
    Rendered rendered;
    rendered.color.assign(&canvas.frame.color[0], &canvas.frame.color[0] + canvas.frame.size());
    for (std::size_t p = 0; p < canvas.frame.size(); ++p) {
        ++rendered.pixels[static_cast<std::size_t>(canvas.frame.status[p])];
    }
    return rendered;
}

std::vector<Rgba8> rendered(const Scene& scene, const Camera& c, WindowSize picture_size = size) {
    return rendered_and_counted(scene, c, picture_size).color;
}

class Session : public testing::Test {
  protected:
    WakeUp wake_up;
    RenderSession session{{2, tolerance, false, [this] { wake_up.wake(); }}};

    // How long a first picture may take: by default so long that it is one of every pixel.
    std::chrono::milliseconds budget{60'000};

    int samples = 1;  // a pixel

    void show(const SceneValue& scene, const Camera& c = camera(), WindowSize picture_size = size) {
        const Clock::time_point now = Clock::now();
        session.show({scene, c, picture_size, std::nullopt, now, now + budget, samples});
    }
    // False after a minute.
    bool wait_until(const std::function<bool()>& done) {
        const Clock::time_point start = Clock::now();
        while (!done()) {
            if (Clock::now() - start > std::chrono::minutes(1)) return false;
            session.stays();
            wake_up.wait(0.02);
        }
        return true;
    }
    bool wait_final() {
        return wait_until([this] {
            session.poll();
            return session.state().final;
        });
    }
    // The picture at rest is that of `render`, and what is said of its pixels adds up.
    void expect_as_render(const Scene& scene, const Camera& c = camera(),
                          WindowSize picture_size = size) {
        const Rendered expected = rendered_and_counted(scene, c, picture_size);
        EXPECT_TRUE(session.shown().color == expected.color);
        const PictureState& state = session.state();
        EXPECT_TRUE(state.final);
        const auto count = [&](Status status) {
            return expected.pixels[static_cast<std::size_t>(status)];
        };
        EXPECT_EQ(state.hit, count(Status::hit));
        EXPECT_EQ(state.miss, count(Status::miss));
        EXPECT_EQ(state.unresolved, count(Status::unresolved));
        EXPECT_EQ(state.progress, 1);
    }
    // Whether the wanted picture can be shown now.
    bool showable() { return session.wait_until_showable(Clock::now()); }
    bool wait_first() {
        return session.wait_until_showable(Clock::now() + std::chrono::minutes(1));
    }
};

TEST_F(Session, WithoutARequestThereIsNoPicture) {
    EXPECT_FALSE(session.poll().any());
    EXPECT_EQ(session.state().scene, nullptr);
    EXPECT_FALSE(session.state().final);
}

TEST_F(Session, TheFinalPictureIsThatOfRender) {
    const auto scene = std::make_shared<const Scene>(two_blobs());
    show(scene);
    ASSERT_TRUE(wait_final());
    expect_as_render(*scene, camera());
    const PictureState& state = session.state();
    EXPECT_EQ(state.scene, scene);
    EXPECT_EQ(state.size, size);
    EXPECT_EQ(state.progress, 1);
    EXPECT_EQ(state.hit + state.miss + state.unresolved,
              static_cast<std::uint64_t>(size.width * size.height));
    EXPECT_GT(state.hit, 0u);
    EXPECT_EQ(state.tiles, state.tiles_traced);
    EXPECT_FALSE(state.surface_certainly_empty);
}

TEST_F(Session, DepthIsTheDistanceAndInfiniteOnAMiss) {
    show(std::make_shared<const Scene>(two_blobs()));
    ASSERT_TRUE(wait_final());
    std::uint64_t hits = 0;
    for (const float depth : session.state().depth.pixels)
        if (std::isfinite(depth)) {
            ++hits;
            EXPECT_GT(depth, 4);
            EXPECT_LT(depth, 9);
        }
    EXPECT_EQ(hits, session.state().hit + session.state().unresolved);
    EXPECT_FALSE(std::isfinite(session.state().depth_at({-1, 5})));
}

TEST_F(Session, AnEditChangesOnlyWhatItSaysItChanged) {
    show(with_left_blob_at(-1.2));
    ASSERT_TRUE(wait_final());
    std::vector<Rgba8> mirror = session.shown().color;
    show(with_left_blob_at(-1.0));
    ASSERT_TRUE(wait_until([&] {
        const PictureChange change = session.poll();
        EXPECT_FALSE(change.all);
        for (const PixelRect& rect : change.tiles)
            for (int j = rect.y0; j < rect.y1; ++j)
                for (int i = rect.x0; i < rect.x1; ++i) {
                    const auto p = static_cast<std::size_t>(j * size.width + i);
                    mirror[p] = session.shown().color[p];
                }
        EXPECT_EQ(mirror, session.shown().color);
        return session.state().final;
    }));
    EXPECT_EQ(mirror, rendered(*with_left_blob_at(-1.0), camera()));
}

// What the shown picture is, to the byte but for what float may differ by where only touched tiles
// were traced again.
bool near(Rgba8 a, Rgba8 b) {
    return std::abs(a.r - b.r) <= 1 && std::abs(a.g - b.g) <= 1 && std::abs(a.b - b.b) <= 1;
}

// Scenes and their pictures in full and of fewer pixels, rendered when they are first asked for.
class Gallery {
  public:
    [[nodiscard]] const std::vector<Rgba8>& picture(const SceneValue& scene, WindowSize of) {
        auto& known = pictures_[{scene, of.width, of.height}];
        if (known.empty()) known = rendered(*scene, camera(), of);
        return known;
    }

  private:
    std::map<std::tuple<SceneValue, int, int>, std::vector<Rgba8>> pictures_;
};

// Whenever one looks, whatever is in work and however little time there is: every pixel that is seen is
// that of the scene that is said to be shown, all of them in one resolution; only when nothing has
// changed for a while fine tiles come to a coarse picture. `seen` collects the resolutions.
void expect_even(const RenderSession& session, Gallery& gallery, bool moving,
                 std::set<double>& seen) {
    const ShownPicture& shown = session.shown();
    const SceneValue scene = session.state().scene;
    if (scene == nullptr) return;
    ASSERT_EQ(shown.size, size);
    const Squares tiles = TileGrid(size.width, size.height).tiles;
    ASSERT_EQ(shown.fine.size(), tiles.size());
    const auto fine = std::count(shown.fine.begin(), shown.fine.end(), 1);
    const bool all_fine = fine == std::ssize(shown.fine);
    if (moving) {
        EXPECT_TRUE(fine == 0 || all_fine) << fine;
    }
    seen.insert(session.state().resolution);
    EXPECT_EQ(session.state().resolution == 1, all_fine);
    if (!all_fine) {
        ASSERT_EQ(shown.coarse.size, coarse_size(size, shown.coarse.step));
        EXPECT_EQ(shown.coarse.step, session.state().resolution);
        EXPECT_EQ(shown.coarse.color, gallery.picture(scene, shown.coarse.size));
    }
    const std::vector<Rgba8>& full = gallery.picture(scene, size);
    for (std::size_t tile = 0; tile < tiles.size(); ++tile) {
        if (shown.fine[tile] == 0) continue;
        const PixelRect rect = tiles.rect(tile);
        for (int j = rect.y0; j < rect.y1; ++j)
            for (int i = rect.x0; i < rect.x1; ++i) {
                const auto p = static_cast<std::size_t>(j * size.width + i);
                ASSERT_TRUE(near(shown.color[p], full[p])) << "pixel " << i << ", " << j;
            }
    }
}

TEST_F(Session, NoPictureMixesScenesOrResolutions) {
    std::mt19937 random(tools::announced_seed(7));
    std::uniform_int_distribution<int> pause(0, 12);
    Gallery gallery;
    std::vector<SceneValue> scenes;
    for (int i = 0; i < 8; ++i) scenes.push_back(with_left_blob_at(-1.2 + 0.15 * i));
    std::set<double> seen;
    for (int edit = 0; edit < 60; ++edit) {
        // none at all, so that all but the coarsest are late, and enough for every pixel
        budget = std::chrono::milliseconds(edit % 3 == 0 ? 0 : edit % 20);
        show(scenes[random() % scenes.size()]);
        for (int look = 0; look < 3; ++look) {
            std::this_thread::sleep_for(std::chrono::milliseconds(pause(random)));
            session.poll();
            expect_even(session, gallery, true, seen);
            if (HasFatalFailure()) return;
        }
    }
    show(scenes[3]);
    ASSERT_TRUE(wait_until([&] {
        session.poll();
        expect_even(session, gallery, false, seen);
        return session.state().final || HasFatalFailure();
    }));
    EXPECT_EQ(session.shown().color, gallery.picture(scenes[3], size));
    EXPECT_GE(seen.size(), 2u);
}

// A picture of fewer pixels stands for itself until the hand rests; then tiles of the final picture come
// one after the other, and what was traced before them is not lost.
TEST_F(Session, ACoarsePictureIsRefinedTileByTileWhenTheHandRests) {
    budget = std::chrono::milliseconds(0);
    const SceneValue scene = with_left_blob_at(-1.2);
    constexpr WindowSize large{1400, 1000};
    show(scene, camera(), large);
    ASSERT_TRUE(wait_first());
    session.poll();
    const CoarsePicture coarse = session.shown().coarse;
    EXPECT_EQ(coarse.size, coarse_size(large, coarse.step));
    EXPECT_EQ(coarse.color, rendered(*scene, camera(), coarse.size));
    EXPECT_EQ(session.state().fine, 0);
    double before = 0;
    ASSERT_TRUE(wait_until([&] {
        const PictureChange change = session.poll();
        EXPECT_FALSE(change.replaced || change.all);
        EXPECT_GE(session.state().fine, before);
        before = session.state().fine;
        EXPECT_EQ(session.shown().coarse.color, coarse.color);
        return session.state().final;
    }));
    EXPECT_EQ(before, 1);
    expect_as_render(*scene, camera(), large);
    EXPECT_EQ(session.state().tiles, session.state().tiles_traced);
}

// Colours, too, may come as a coarse picture; and edits of all kinds that are cut short while they are.
TEST_F(Session, CoarsePicturesOfEditsThatOvertakeEachOtherEndAsRender) {
    std::mt19937 random(tools::announced_seed(43));
    Scene scene = two_blobs();
    for (int round = 0; round < 5; ++round) {
        for (int edit = 0; edit < 8; ++edit) {
            budget = std::chrono::milliseconds(random() % 3);
            const double share = static_cast<double>(random() % 100) / 100;
            switch (random() % 4) {
                case 0:
                    scene.elements[0].color = {share, 0.3, 1 - share};
                    break;
                case 1:
                    scene.threshold = 0.3 + 0.2 * share;
                    break;
                case 2:
                    scene.background = {share, 0.1, 0.1};
                    break;
                default:
                    std::get<PointSkeleton>(scene.elements[1].skeleton).position.y = share - 0.5;
            }
            show(std::make_shared<const Scene>(scene));
            std::this_thread::sleep_for(std::chrono::milliseconds(random() % 200));
            session.poll();
        }
        ASSERT_TRUE(wait_final());
        SCOPED_TRACE("round " + std::to_string(round));
        expect_as_render(scene, camera());
    }
}

// What an edit does not touch keeps its bytes all the while, though the hierarchy is made anew and every
// pixel's samples are looked for again.
TEST_F(Session, SampledTilesKeepTheirBytesThroughAnEdit) {
    samples = 16;
    show(with_left_blob_at(-1.2));
    ASSERT_TRUE(wait_final());
    const std::vector<Rgba8> before = session.shown().color;
    show(with_left_blob_at(-1.15));
    std::vector<std::uint8_t> changed(before.size());
    ASSERT_TRUE(wait_until([&] {
        session.poll();
        for (std::size_t p = 0; p < before.size(); ++p)
            changed[p] |= session.shown().color[p] != before[p];
        return session.state().final;
    }));
    // The right blob has no pixel in the left half, the left one none in the right third.
    std::size_t flickering = 0, kept_edges = 0;
    const auto at = [&](int i, int j) { return static_cast<std::size_t>(j * size.width + i); };
    for (int j = 0; j < size.height; ++j) {
        for (int i = 2 * size.width / 3 + TileGrid::tile_side; i < size.width; ++i) {
            flickering += changed[at(i, j)] != 0;
            kept_edges += before[at(i, j)] != before[at(i - 1, j)];
        }
    }
    EXPECT_EQ(flickering, 0u);
    EXPECT_GT(kept_edges, 100u);
    EXPECT_GT(std::count(changed.begin(), changed.end(), 1), 100);
}

TEST_F(Session, AnotherNumberOfSamplesTracesNothingAnewAndComesBack) {
    const auto scene = std::make_shared<const Scene>(two_blobs());
    show(scene);
    ASSERT_TRUE(wait_final());
    const std::vector<Rgba8> sharp = session.shown().color;
    const std::uint64_t traced = session.totals().tiles_traced;
    samples = 4;
    show(scene);
    ASSERT_TRUE(wait_final());
    EXPECT_NE(session.shown().color, sharp);
    samples = 1;
    show(scene);
    ASSERT_TRUE(wait_final());
    EXPECT_EQ(session.totals().tiles_traced, traced);
    expect_as_render(*scene);
}

// An edit that comes while samples are being taken leaves nothing of the old picture.
TEST_F(Session, AnEditWhileSamplesComeEndsAsItWould) {
    samples = 16;
    for (int round = 0; round < 4; ++round) {
        show(with_left_blob_at(-1.2 + 0.1 * round));
        ASSERT_TRUE(wait_first());
        const Clock::time_point until = Clock::now() + std::chrono::milliseconds(110 + 3 * round);
        ASSERT_TRUE(wait_until([&] {
            session.poll();
            return Clock::now() > until || session.state().final;
        }));
    }
    ASSERT_TRUE(wait_final());
    const std::vector<Rgba8> after = session.shown().color;
    samples = 1;
    show(with_left_blob_at(-0.9));
    ASSERT_TRUE(wait_final());
    samples = 16;
    show(with_left_blob_at(-0.9));
    ASSERT_TRUE(wait_final());
    EXPECT_TRUE(session.shown().color == after);
}

TEST_F(Session, TheOldPictureStaysUntilTheNewOneIsComplete) {
    const SceneValue first = with_left_blob_at(-1.2), second = with_left_blob_at(-0.4);
    show(first);
    ASSERT_TRUE(wait_final());
    const std::vector<Rgba8> before = session.shown().color;
    show(second);
    while (!showable()) {
        session.poll();
        if (session.state().scene != first) break;
        ASSERT_EQ(session.shown().color, before);
        ASSERT_EQ(session.state().fine, 1);
    }
    ASSERT_TRUE(wait_final());
    EXPECT_EQ(session.state().scene, second);
}

TEST_F(Session, ACompletePictureIsShownThoughTheNextHasBegun) {
    const SceneValue first = with_left_blob_at(-1.2);
    show(first);
    ASSERT_TRUE(wait_final());
    for (int i = 1; i <= 20; ++i) {
        const SceneValue overtaken = with_left_blob_at(-1.2 + 0.05 * i);
        const SceneValue next = with_left_blob_at(1.2 - 0.05 * i);
        show(overtaken);
        ASSERT_TRUE(wait_first());
        show(next);
        std::this_thread::sleep_for(std::chrono::milliseconds(i));
        EXPECT_TRUE(session.poll().replaced);
        const SceneValue shown = session.state().scene;
        EXPECT_TRUE(shown == overtaken || shown == next);
    }
}

TEST_F(Session, AnEditCancelsRefinement) {
    // so large that it is far from done when its first picture is
    constexpr WindowSize large{3000, 2400};
    budget = std::chrono::milliseconds(0);
    show(with_left_blob_at(-1.2), camera(), large);
    ASSERT_TRUE(wait_until([&] {
        session.poll();
        return session.totals().tiles_traced > 0;
    }));
    Camera other = camera();
    other.position.y += 0.1;
    show(with_left_blob_at(-1.2), other, size);
    ASSERT_TRUE(wait_final());
    const SessionTotals totals = session.totals();
    EXPECT_EQ(totals.begun, 2u);
    EXPECT_EQ(totals.cancelled, 1u);
    EXPECT_LT(totals.pixels_traced, static_cast<std::uint64_t>(large.width * large.height));
    expect_as_render(*with_left_blob_at(-1.2), other);
}

TEST_F(Session, OnlyTheLastOfManyRequestsHasToBeDone) {
    for (int i = 0; i < 100; ++i) show(with_left_blob_at(-1.2 + 0.01 * i));
    ASSERT_TRUE(wait_final());
    EXPECT_LT(session.totals().begun, 100u);
    expect_as_render(*with_left_blob_at(-1.2 + 0.01 * 99), camera());
}

TEST_F(Session, AColourTracesNothing) {
    auto scene = std::make_shared<Scene>(two_blobs());
    show(scene);
    ASSERT_TRUE(wait_final());
    const SessionTotals before = session.totals();
    auto recoloured = std::make_shared<Scene>(*scene);
    recoloured->elements[0].color = {0.2, 0.9, 0.3};
    recoloured->background = {0.3, 0.1, 0.1};
    recoloured->lights = std::vector<Light>{Light{{0, 1, 1}}};
    show(recoloured);
    ASSERT_TRUE(wait_final());
    EXPECT_EQ(session.totals().tiles_traced, before.tiles_traced);
    EXPECT_EQ(session.totals().pixels_traced, before.pixels_traced);
    expect_as_render(*recoloured, camera());
    show(scene);
    ASSERT_TRUE(wait_final());
    expect_as_render(*scene, camera());
}

// Colours, lights and shapes that change faster than they can be shown: what was cut short is made
// up for, whatever comes next.
TEST_F(Session, EditsThatOvertakeEachOtherEndAsRender) {
    constexpr WindowSize large{900, 600};
    std::mt19937 random(tools::announced_seed(41));
    for (int round = 0; round < 6; ++round) {
        Scene scene = two_blobs();
        scene.elements.push_back(point({0, 1, 0.3}, KernelKind::blinn, 0.4, {0.2, 0.8, 0.2}));
        show(std::make_shared<const Scene>(scene), camera(), large);
        ASSERT_TRUE(wait_final());
        for (int edit = 0; edit < 6; ++edit) {
            const auto share = [&] { return static_cast<double>(random() % 100) / 100; };
            Element& element = scene.elements[random() % scene.elements.size()];
            switch (random() % 4) {
                case 0:
                    element.color = {share(), share(), share()};
                    break;
                case 1:
                    scene.background = {share(), share(), share()};
                    break;
                case 2:
                    scene.lights = {Light{{1, 2, 3}, {1, share(), 1}, 0.9, false}};
                    break;
                default:
                    std::get<PointSkeleton>(element.skeleton).position.y += 0.1 * share();
            }
            show(std::make_shared<const Scene>(scene), camera(), large);
            std::this_thread::sleep_for(std::chrono::microseconds(random() % 20'000));
            session.poll();
        }
        ASSERT_TRUE(wait_final());
        SCOPED_TRACE("round " + std::to_string(round));
        expect_as_render(scene, camera(), large);
    }
}

// Tiles that a moved element cannot be seen to change are traced when the hand rests. A colour that
// comes before shades them, and one that comes while they are traced leaves them to be traced.
TEST_F(Session, TilesLeftForLaterAreTracedThoughColoursComeBetween) {
    constexpr WindowSize large{900, 600};
    Scene scene = two_blobs();
    scene.elements.push_back(point({0, 1, 0.3}, KernelKind::blinn, 0.4, {0.2, 0.8, 0.2}));
    for (const std::uint64_t late : {2, 20, 200}) {
        SCOPED_TRACE(late);
        show(std::make_shared<const Scene>(scene), camera(), large);
        ASSERT_TRUE(wait_final());
        const std::uint64_t before = session.totals().tiles_traced;
        std::get<PointSkeleton>(scene.elements[2].skeleton).position.y += 0.07;
        show(std::make_shared<const Scene>(scene), camera(), large);
        ASSERT_TRUE(wait_first());
        scene.elements[0].color.x = 0.5 + 0.001 * static_cast<double>(late);
        show(std::make_shared<const Scene>(scene), camera(), large);
        const std::uint64_t by_the_move = session.totals().tiles_traced;
        ASSERT_TRUE(wait_until([&] {
            session.poll();
            return session.state().final || session.totals().tiles_traced >= by_the_move + late;
        }));
        scene.elements[1].color.y = 0.5 + 0.001 * static_cast<double>(late);
        show(std::make_shared<const Scene>(scene), camera(), large);
        ASSERT_TRUE(wait_final());
        EXPECT_GE(session.totals().tiles_traced, before + session.state().tiles);
        expect_as_render(scene, camera(), large);
    }
}

// Lists are forgotten when an element moves: a background that comes before they are made anew.
TEST_F(Session, ABackgroundAfterAMoveReachesEmptyTiles) {
    constexpr WindowSize large{900, 600};
    Scene scene = two_blobs();
    show(std::make_shared<const Scene>(scene), camera(), large);
    ASSERT_TRUE(wait_final());
    std::get<PointSkeleton>(scene.elements[0].skeleton).position.y += 0.07;
    show(std::make_shared<const Scene>(scene), camera(), large);
    ASSERT_TRUE(wait_first());
    scene.background = {0.7, 0.2, 0.4};
    show(std::make_shared<const Scene>(scene), camera(), large);
    ASSERT_TRUE(wait_final());
    expect_as_render(scene, camera(), large);
}

TEST_F(Session, AMovedElementTracesFirstWhatItTouches) {
    auto scene = std::make_shared<const Scene>(two_blobs());
    show(scene);
    ASSERT_TRUE(wait_final());
    const std::uint64_t all = session.totals().tiles_traced;
    auto moved = std::make_shared<Scene>(*scene);
    moved->elements[0].width = 1.3;
    show(moved);
    ASSERT_TRUE(wait_first());
    EXPECT_LT(session.totals().tiles_traced - all, all * 3 / 4);
    // and in the end everything, so that not a byte is an older scene's
    ASSERT_TRUE(wait_final());
    EXPECT_EQ(session.totals().tiles_traced, 2 * all);
    expect_as_render(*moved, camera());
}

TEST_F(Session, ADragEndsExactlyWhereverItWent) {
    show(with_left_blob_at(-1.2));
    ASSERT_TRUE(wait_final());
    for (int i = 0; i <= 25; ++i) {
        show(with_left_blob_at(-1.2 + 0.1 * i));
        if (i % 5 != 0) continue;
        ASSERT_TRUE(wait_first());
        session.poll();
    }
    show(with_left_blob_at(-1.2));
    ASSERT_TRUE(wait_final());
    expect_as_render(*with_left_blob_at(-1.2), camera());
}

// Of an edit that touches a few tiles here and there, and of its undoing: tiles are selected that
// are not the first of the squares which the first picture takes one of.
TEST_F(Session, AnEditAndItsUndoAreCountedToThePixel) {
    constexpr WindowSize large{1000, 620};
    std::mt19937 random(tools::announced_seed(19));
    Scene scene = two_blobs();
    for (int n = 0; n < 6; ++n) {
        const auto share = [&] { return static_cast<double>(random() % 1000) / 1000; };
        scene.elements.push_back(point({3 * share() - 1.5, 2 * share() - 1, share()},
                                       KernelKind::wyvill, 0.3 + 0.3 * share(), {0.2, 0.8, 0.2}));
    }
    show(std::make_shared<const Scene>(scene), camera(), large);
    ASSERT_TRUE(wait_final());
    expect_as_render(scene, camera(), large);
    for (int round = 0; round < 6; ++round) {
        SCOPED_TRACE("round " + std::to_string(round));
        Scene edited = scene;
        auto& place = std::get<PointSkeleton>(edited.elements[random() % 8].skeleton).position;
        place.x += 0.4;
        place.y += 0.2;
        for (const Scene& next : {edited, scene}) {
            show(std::make_shared<const Scene>(next), camera(), large);
            ASSERT_TRUE(wait_final());
            expect_as_render(next, camera(), large);
        }
    }
}

// A lower threshold lets the surface grow into tiles that a list had proved empty.
TEST_F(Session, AnotherThresholdEndsAsRender) {
    constexpr WindowSize large{800, 560};
    Scene scene = two_blobs();
    const double threshold = scene.threshold;
    for (const double share : {1.0, 0.52, 0.35, 0.65, 1.2}) {
        scene.threshold = share * threshold;
        show(std::make_shared<const Scene>(scene), camera(), large);
        ASSERT_TRUE(wait_final());
        expect_as_render(scene, camera(), large);
    }
}

// So many elements that they stand in clusters, which follow the element as long as it moves.
TEST_F(Session, ADragThroughACrowdEndsAsRender) {
    Scene scene;
    scene.threshold = 0.5;
    tools::Random random(5);
    for (int n = 0; n < 2200; ++n) {
        scene.elements.push_back({.skeleton = PointSkeleton{random.in_cube(1.2)},
                                  .color = {random.uniform(0, 1), random.uniform(0, 1), 0.5},
                                  .width = random.uniform(0.08, 0.12)});
    }
    show(std::make_shared<const Scene>(scene));
    ASSERT_TRUE(wait_final());
    for (int step = 0; step < 4; ++step) {
        std::get<PointSkeleton>(scene.elements[7].skeleton).position.x += 0.3;
        show(std::make_shared<const Scene>(scene));
        ASSERT_TRUE(wait_first());
    }
    ASSERT_TRUE(wait_final());
    expect_as_render(scene, camera());
    // The lists of the tiles outlast another threshold, and colours what was moved.
    for (const double threshold : {0.45, 0.6, 2.0, 0.5}) {
        scene.threshold = threshold;
        scene.elements[8].color = {threshold / 4, 1, 0};
        show(std::make_shared<const Scene>(scene));
        ASSERT_TRUE(wait_final());
        expect_as_render(scene, camera());
    }
}

TEST_F(Session, AnotherSizeReplacesThePictureAsAWhole) {
    const SceneValue scene = with_left_blob_at(-1.2);
    show(scene);
    ASSERT_TRUE(wait_final());
    for (const WindowSize other : {WindowSize{97, 61}, WindowSize{1, 1}, WindowSize{333, 17}}) {
        show(scene, camera(), other);
        bool replaced = false;
        ASSERT_TRUE(wait_until([&] {
            const PictureChange change = session.poll();
            replaced = replaced || change.all;
            return session.state().final;
        }));
        EXPECT_TRUE(replaced);
        EXPECT_EQ(session.shown().size, other);
        expect_as_render(*scene, camera(), other);
    }
}

TEST_F(Session, AnEmptySceneIsSaidToBeEmpty) {
    auto scene = std::make_shared<Scene>();
    scene->background = {0.2, 0.3, 0.4};
    show(scene);
    ASSERT_TRUE(wait_final());
    EXPECT_TRUE(session.state().surface_certainly_empty);
    EXPECT_EQ(session.state().hit, 0u);
    expect_as_render(*scene, camera());
}

TEST_F(Session, ACameraWithoutADirectionIsAFaultAndTheNextRequestWorks) {
    const SceneValue scene = with_left_blob_at(-1.2);
    show(scene);
    ASSERT_TRUE(wait_final());
    Camera broken = camera();
    broken.target = broken.position;
    show(scene, broken);
    ASSERT_TRUE(wait_until([&] {
        session.poll();
        return !session.state().fault.empty();
    }));
    EXPECT_EQ(session.shown().color, rendered(*scene, camera()));  // the old picture
    EXPECT_EQ(session.state().camera, camera());
    EXPECT_FALSE(session.state().final);
    show(scene, broken, {50, 300});
    ASSERT_TRUE(wait_first());
    EXPECT_FALSE(session.poll().any());
    show(scene, camera(), {50, 300});
    ASSERT_TRUE(wait_final());
    expect_as_render(*scene, camera(), {50, 300});
    show(scene);
    ASSERT_TRUE(wait_final());
    EXPECT_TRUE(session.state().fault.empty());
    expect_as_render(*scene, camera());
}

std::ptrdiff_t threads_of_this_process() {
    const std::filesystem::directory_iterator tasks("/proc/self/task");
    return std::distance(begin(tasks), end(tasks));
}

// However far it has come with a picture that is far from done: none of its threads outlives it, and
// nobody is woken any more.
TEST(RenderSessionLife, EndsWhileItWorks) {
    constexpr WindowSize large{3000, 2400};
    const std::ptrdiff_t threads = threads_of_this_process();
    int at_work = 0;
    for (int i = 0; i < 20; ++i) {
        SCOPED_TRACE(i);
        std::atomic<int> wakes = 0;
        {
            RenderSession session({2, tolerance, i % 2 == 0, [&] { ++wakes; }});
            const Clock::time_point now = Clock::now();
            session.show({with_left_blob_at(-1.2), camera(), large, std::nullopt, now,
                          now + std::chrono::milliseconds(33)});
            std::this_thread::sleep_for(std::chrono::milliseconds(i % 5));
            if (i % 4 == 0) {
                while (session.totals().tiles_traced == 0) std::this_thread::yield();
            }
            session.poll();
            EXPECT_FALSE(session.state().final);
            EXPECT_GT(threads_of_this_process(), threads);
            at_work += session.totals().begun == 1;
        }
        const int woken = wakes;
        // What has been joined may be listed for a moment more.
        for (int n = 0; n < 1000 && threads_of_this_process() != threads; ++n) {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        EXPECT_EQ(threads_of_this_process(), threads);
        EXPECT_EQ(wakes, woken);
    }
    EXPECT_GE(at_work, 5);
}

}  // namespace
}  // namespace ivory
