// The tiles that an edit can visibly change.
#include "app/viewer/touched_tiles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "app/document/orbit.h"
#include "app/viewer/same_picture.h"
#include "core/render/canvas.h"
#include "core/render/render.h"
#include "tests/app/each_projection.h"

namespace ivory {
namespace {

constexpr WindowSize size{240, 160};

Camera camera() {
    Camera c;
    c.position = {0, 0, 8};
    c.target = {0, 0, 0};
    return c;
}

Element element_of(Skeleton skeleton, KernelKind kernel, double width) {
    Element element;
    element.skeleton = std::move(skeleton);
    element.kernel = kernel;
    element.width = width;
    return element;
}

Scene three_elements() {
    Scene scene;
    scene.threshold = 0.4;
    scene.elements = {
        element_of(PointSkeleton{{-2, 0.5, 0}}, KernelKind::wyvill, 1),
        element_of(SegmentSkeleton{{-1, -1, 0}, {1.5, -0.5, 0.5}}, KernelKind::blinn, 0.4),
        element_of(CircleSkeleton{{2, 0.6, 0}, {0.3, 0.2, 1}, 0.7}, KernelKind::nishimura, 0.6)};
    return scene;
}

std::vector<Rgba8> rendered(const Scene& scene, const Camera& camera) {
    Scene seen = scene;
    seen.camera = camera;
    const Picture picture =
        make_picture(seen, size.width, size.height, *methods().front(), {.tolerance = 1e-6});
    Canvas canvas(size.width, size.height, false);
    JobSettings settings;
    settings.threads = 2;
    render(picture, canvas, settings);
    return {&canvas.frame.color[0], &canvas.frame.color[0] + canvas.frame.size()};
}

TEST(TouchedTiles, AnotherThresholdTouchesAll) {
    const Scene before = three_elements();
    Scene after = before;
    after.threshold = 0.5;
    const auto directions = tile_directions(make_view(camera()), size);
    EXPECT_FALSE(touched_tiles(before, after, camera().position, directions).has_value());
}

TEST(TouchedTiles, TheSameSceneTouchesNone) {
    const Scene scene = three_elements();
    const auto directions = tile_directions(make_view(camera()), size);
    const auto touched = touched_tiles(scene, scene, camera().position, directions);
    ASSERT_TRUE(touched.has_value());
    EXPECT_EQ(std::count(touched->begin(), touched->end(), 1), 0);
}

TEST(TouchedTiles, ANameOrAnotherPlaceInTheListTouchesNone) {
    const auto directions = tile_directions(make_view(camera()), size);
    const auto touches = [&](const Scene& before, const Scene& after) {
        const auto touched = touched_tiles(before, after, camera().position, directions);
        return !touched || std::count(touched->begin(), touched->end(), 1) > 0;
    };
    Scene scene = three_elements();
    for (int i = 0; i < 20; ++i) scene.elements.push_back(scene.elements[0]);
    for (std::size_t i = 0; i < scene.elements.size(); ++i)
        scene.elements[i].width = 1 + 0.01 * static_cast<double>(i);
    Scene after = scene;
    after.elements[1].name = "heart";
    EXPECT_FALSE(touches(scene, after));
    std::rotate(after.elements.begin(), after.elements.begin() + 1, after.elements.end());
    EXPECT_FALSE(touches(scene, after));
    EXPECT_FALSE(touches(after, scene));
    after.elements[4].width = 3;
    EXPECT_TRUE(touches(scene, after));
}

TEST(SamePicture, OnlyWhatIsSeenInOrderCounts) {
    const Scene scene = three_elements();
    const auto with = [&](auto change) {
        Scene changed = scene;
        change(changed);
        return same_picture(scene, changed);
    };
    EXPECT_TRUE(with([](Scene&) {}));
    EXPECT_TRUE(with([](Scene& s) { s.elements[0].name = "heart"; }));
    EXPECT_TRUE(with([](Scene& s) { s.camera = camera(); }));
    EXPECT_TRUE(with([](Scene& s) { s.lights = default_lights(); }));
    EXPECT_TRUE(with([](Scene& s) {
        Element hidden = s.elements[0];
        hidden.visible = false;
        s.elements.insert(s.elements.begin() + 1, hidden);
        s.elements.push_back(hidden);
    }));
    EXPECT_FALSE(with([](Scene& s) { s.threshold = 0.125; }));
    EXPECT_FALSE(with([](Scene& s) { s.background.x = 0.5; }));
    EXPECT_FALSE(with([](Scene& s) { s.lights.emplace(); }));
    EXPECT_FALSE(with([](Scene& s) { s.elements[1].visible = false; }));
    EXPECT_FALSE(with([](Scene& s) { s.elements[1].color.x = 0.125; }));
    EXPECT_FALSE(with([](Scene& s) { s.elements[1].strength = 2; }));
    EXPECT_FALSE(with([](Scene& s) { s.elements[1].widths = {0.4, 0.7}; }));
    EXPECT_FALSE(with([](Scene& s) { s.elements.pop_back(); }));
    EXPECT_FALSE(with([](Scene& s) { std::swap(s.elements[0], s.elements[1]); }));
}

TEST(TouchedTiles, AnElementAroundTheEyeTouchesAll) {
    Scene before = three_elements();
    std::get<PointSkeleton>(before.elements[0].skeleton).position = camera().position;
    Scene after = before;
    after.elements[0].width = 2;
    const auto directions = tile_directions(make_view(camera()), size);
    EXPECT_FALSE(touched_tiles(before, after, camera().position, directions).has_value());
}

TEST(TouchedTiles, AHiddenElementTouchesNone) {
    Scene before = three_elements();
    before.elements[0].visible = false;
    Scene after = before;
    after.elements[0].width = 2;
    const auto directions = tile_directions(make_view(camera()), size);
    const auto touched = touched_tiles(before, after, camera().position, directions);
    ASSERT_TRUE(touched.has_value());
    EXPECT_EQ(std::count(touched->begin(), touched->end(), 1), 0);
}

// Whatever is moved, added, taken away or changed: no pixel of another tile changes by more than
// 1/255.
class NothingElse : public tests::InEachProjection {};
INSTANTIATE_TEST_SUITE_P(, NothingElse, NothingElse::all(), NothingElse::name);

TEST_P(NothingElse, ChangesVisibly) {
    const Camera camera = in_projection(ivory::camera(), GetParam());
    constexpr unsigned seed = 20240611;
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> shift(-0.6, 0.6);
    const TileGrid grid(size.width, size.height);
    const auto directions = tile_directions(make_view(camera), size);
    Scene before = three_elements();
    std::vector<Rgba8> old_picture = rendered(before, camera);
    std::size_t left_alone = 0;
    for (int i = 0; i < 12; ++i) {
        Scene after = before;
        switch (i % 4) {
            case 0:
                std::get<PointSkeleton>(after.elements[0].skeleton).position.y += shift(random);
                break;
            case 1:
                std::get<SegmentSkeleton>(after.elements[1].skeleton).b.x += shift(random);
                break;
            case 2:
                std::get<CircleSkeleton>(after.elements[2].skeleton).normal.x += shift(random);
                break;
            case 3:
                after.elements.insert(
                    after.elements.begin() + 1,
                    element_of(PointSkeleton{{shift(random), 1, 0}}, KernelKind::blinn, 0.5));
                if (i % 8 == 3) std::swap(before, after);  // taken away
                break;
        }
        if (i % 8 == 3) old_picture = rendered(before, camera);
        const auto touched = touched_tiles(before, after, camera.position, directions);
        ASSERT_TRUE(touched.has_value());
        const std::vector<Rgba8> picture = rendered(after, camera);
        for (std::size_t tile = 0; tile < touched->size(); ++tile) {
            if ((*touched)[tile] != 0) continue;
            ++left_alone;
            const PixelRect rect = grid.tiles.rect(tile);
            for (int y = rect.y0; y < rect.y1; ++y) {
                for (int x = rect.x0; x < rect.x1; ++x) {
                    const Rgba8 a = old_picture[static_cast<std::size_t>(y * size.width + x)];
                    const Rgba8 b = picture[static_cast<std::size_t>(y * size.width + x)];
                    ASSERT_LE(std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b), 1)
                        << "seed " << seed << ", edit " << i << ", pixel " << x << ", " << y;
                }
            }
        }
        before = i % 8 == 7 ? before : after;
        old_picture = rendered(before, camera);
    }
    EXPECT_GT(left_alone, 12u * grid.tiles.size() / 4);
}

}  // namespace
}  // namespace ivory
