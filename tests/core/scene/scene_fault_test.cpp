#include "core/scene/scene_fault.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <vector>

namespace ivory {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Scene faultless() {
    Scene scene;
    scene.camera = Camera{.position = {0, 0, 8}, .target = {0, 0, 0}};
    scene.lights = default_lights();
    scene.elements = {
        {.skeleton = PointSkeleton{{1, 2, 3}}},
        {.skeleton = SegmentSkeleton{{0, 0, 0}, {1, 0, 0}}, .name = "arm"},
        {.skeleton = CircleSkeleton{{0, 0, 0}, {0, 0, 1}, 1}, .strength = -1, .width = 0.1}};
    return scene;
}

TEST(SceneFault, LeavesAGoodSceneAlone) {
    EXPECT_FALSE(find_fault(faultless()).has_value());
    EXPECT_FALSE(find_fault(Scene{}).has_value());
}

struct Damage {
    const char* pointer;
    std::function<void(Scene&)> apply;
};

TEST(SceneFault, IsFoundAtItsPlace) {
    const auto point = [](Scene& s) -> Vec3d& {
        return std::get<PointSkeleton>(s.elements[0].skeleton).position;
    };
    const auto segment = [](Scene& s) -> SegmentSkeleton& {
        return std::get<SegmentSkeleton>(s.elements[1].skeleton);
    };
    const auto circle = [](Scene& s) -> CircleSkeleton& {
        return std::get<CircleSkeleton>(s.elements[2].skeleton);
    };
    const std::vector<Damage> damages = {
        {"/threshold", [](Scene& s) { s.threshold = 0; }},
        {"/threshold", [](Scene& s) { s.threshold = nan; }},
        {"/threshold", [](Scene& s) { s.threshold = infinity; }},
        {"/background/0", [](Scene& s) { s.background.x = -1e-300; }},
        {"/background/2", [](Scene& s) { s.background.z = std::nextafter(1.0, 2.0); }},
        {"/background/1", [](Scene& s) { s.background.y = nan; }},
        {"/camera/position/2", [](Scene& s) { s.camera->position.z = infinity; }},
        {"/camera/height", [](Scene& s) { s.camera->height = 0; }},
        {"/camera/height", [](Scene& s) { s.camera->height = infinity; }},
        {"/views/1/name",
         [](Scene& s) {
             s.views = {{"a", *s.camera}, {"a", *s.camera}};
         }},
        {"/views/0/name",
         [](Scene& s) {
             s.views = {{"", *s.camera}};
         }},
        {"/views/0/camera/fov",
         [](Scene& s) {
             s.views = {{"a", *s.camera}};
             s.views[0].camera.fov = 180;
         }},
        {"/camera/target/0", [](Scene& s) { s.camera->target.x = nan; }},
        {"/camera/target", [](Scene& s) { s.camera->target = s.camera->position; }},
        {"/camera/target",
         [](Scene& s) { s.camera->position.z = 1e308, s.camera->target.z = -1e308; }},
        {"/camera/up",
         [](Scene& s) {
             s.camera->up = {0, -0.0, 0};
         }},
        {"/camera/up/1", [](Scene& s) { s.camera->up.y = nan; }},
        {"/camera/up",
         [](Scene& s) {
             s.camera->up = {0, 0, 3};
         }},
        {"/camera/fov", [](Scene& s) { s.camera->fov = 0; }},
        {"/camera/fov", [](Scene& s) { s.camera->fov = 180; }},
        {"/camera/fov", [](Scene& s) { s.camera->fov = nan; }},
        {"/lights/1/direction",
         [](Scene& s) {
             (*s.lights)[1].direction = {0, 0, 0};
         }},
        {"/lights/0/direction/1", [](Scene& s) { (*s.lights)[0].direction.y = infinity; }},
        {"/lights/0/color/0", [](Scene& s) { (*s.lights)[0].color.x = 1.5; }},
        {"/lights/1/intensity", [](Scene& s) { (*s.lights)[1].intensity = -0.1; }},
        {"/lights/1/intensity", [](Scene& s) { (*s.lights)[1].intensity = infinity; }},
        {"/elements/0/position/0", [&](Scene& s) { point(s).x = nan; }},
        {"/elements/1/a/1", [&](Scene& s) { segment(s).a.y = infinity; }},
        {"/elements/1/b/2", [&](Scene& s) { segment(s).b.z = -infinity; }},
        {"/elements/2/center/0", [&](Scene& s) { circle(s).center.x = nan; }},
        {"/elements/2/normal",
         [&](Scene& s) {
             circle(s).normal = {0, 0, 0};
         }},
        {"/elements/2/normal/2", [&](Scene& s) { circle(s).normal.z = nan; }},
        {"/elements/2/radius", [&](Scene& s) { circle(s).radius = -5e-324; }},
        {"/elements/2/radius", [&](Scene& s) { circle(s).radius = infinity; }},
        {"/elements/0/color/1", [](Scene& s) { s.elements[0].color.y = 2; }},
        {"/elements/0/strength", [](Scene& s) { s.elements[0].strength = -0.0; }},
        {"/elements/0/strength", [](Scene& s) { s.elements[0].strength = nan; }},
        {"/elements/0/width", [](Scene& s) { s.elements[0].width = 0; }},
        {"/elements/0/width", [](Scene& s) { s.elements[0].width = infinity; }},
        {"/elements/0/name", [](Scene& s) { s.elements[0].name = ""; }},
        {"/elements/0/name", [](Scene& s) { s.elements[0].name = "caf\xe9"; }},
        {"/elements/1/name", [](Scene& s) { s.elements[0].name = "arm"; }},
        {"/elements/1/name", [](Scene& s) { s.elements[1].name = "circle 1"; }},
        {"/elements/2/name", [](Scene& s) { s.elements[2].name = "point 1"; }},
    };
    for (const Damage& damage : damages) {
        Scene scene = faultless();
        damage.apply(scene);
        const std::optional<SceneFault> fault = find_fault(scene);
        ASSERT_TRUE(fault.has_value()) << damage.pointer;
        EXPECT_EQ(fault->pointer, damage.pointer) << fault->message;
        EXPECT_NE(fault->message.find("; "), std::string::npos) << fault->message;
    }
}

TEST(SceneFault, AcceptsTheEndsOfEachRange) {
    Scene scene = faultless();
    scene.threshold = 5e-324;
    scene.background = {0, 1, -0.0};
    scene.camera->fov = std::nextafter(180.0, 0.0);
    (*scene.lights)[0].intensity = 0;
    (*scene.lights)[0].direction = {0, 5e-324, 0};
    scene.elements[0].strength = 5e-324;
    scene.elements[0].width = 5e-324;
    scene.elements[1].skeleton = SegmentSkeleton{{1, 1, 1}, {1, 1, 1}};
    scene.elements[2].skeleton = CircleSkeleton{{1e308, 0, 0}, {0, -1e-320, 0}, 0};
    EXPECT_FALSE(find_fault(scene).has_value());
    scene.camera->fov = 5e-324;
    scene.elements[0].name = "point 1";  // its own default
    EXPECT_FALSE(find_fault(scene).has_value()) << find_fault(scene)->message;
}

// The up direction at `angle` from the line of sight.
Vec3d turned(const Vec3d& view, const Vec3d& across, double angle) {
    return std::cos(angle) * view + std::sin(angle) * across;
}

TEST(Along, FindsParallelVectorsOfAnyLengthAndNothingBeyondItsAngle) {
    const auto seed = std::random_device{}();
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> component(-1, 1);
    std::uniform_int_distribution<int> exponent(-1000, 1000);
    std::uniform_int_distribution<int> small(-20, 20);
    for (int i = 0; i < 20'000; ++i) {
        // Integers times powers of two are parallel without any rounding.
        const Vec3d whole{double(small(random)), double(small(random)), double(1 + i % 20)};
        const double factor = double(1 + i % 7) * (i % 2 == 0 ? 1 : -1);
        const Vec3d multiple = std::ldexp(factor, exponent(random)) * whole;
        ASSERT_TRUE(along(multiple, whole));
        ASSERT_TRUE(along(whole, multiple));

        const Vec3d view{component(random), component(random), component(random)};
        const double length = std::sqrt(dot(view, view));
        const Vec3d forward = (1 / length) * view;
        const Vec3d other = cross(forward, Vec3d{component(random), 1, component(random)});
        const Vec3d across = (1 / std::sqrt(dot(other, other))) * other;
        const double scale = std::ldexp(1.0, exponent(random));
        ASSERT_TRUE(along(scale * turned(forward, across, 0.9e-12), view));
        ASSERT_TRUE(along(scale * turned(-forward, across, 0.9e-12), view));
        ASSERT_FALSE(along(scale * turned(forward, across, 1.1e-12), view));
        ASSERT_FALSE(along(scale * turned(forward, across, 1e-9), view));
        ASSERT_FALSE(along(scale * across, view));
    }
    EXPECT_TRUE(along({0, 0, 5e-324}, {0, 0, -1.7e308}));
    EXPECT_FALSE(along({0, 5e-324, 0}, {0, 0, -1.7e308}));
}

// What `unless names are unique` means, taken literally.
std::optional<std::string> pointer_to_second_name(const Scene& scene) {
    const std::vector<std::string> names = element_names(scene);
    for (std::size_t i = 0; i < names.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            if (names[i] != names[j]) continue;
            return "/elements/" + std::to_string(scene.elements[i].name ? i : j) + "/name";
        }
    }
    return std::nullopt;
}

TEST(SceneFault, TheFirstNameThatIsThereAlreadyIsFound) {
    const auto seed = std::random_device{}();
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const std::vector<std::string> names{"point 1", "point 2",   "point 5",   "point 05", "a",
                                         "b",       "segment 1", "segment 3", "c",        "d"};
    int faults = 0;
    for (int trial = 0; trial < 3000; ++trial) {
        Scene scene;
        for (std::size_t count = random() % 8; count > 0; --count) {
            Element element;
            if (random() % 3 == 0) element.skeleton = SegmentSkeleton{};
            if (random() % 3 == 0) element.name = names[random() % names.size()];
            scene.elements.push_back(element);
        }
        const std::optional<SceneFault> fault = find_fault(scene);
        const std::optional<std::string> expected = pointer_to_second_name(scene);
        ASSERT_EQ(fault.has_value(), expected.has_value());
        if (!fault) continue;
        ++faults;
        ASSERT_EQ(fault->pointer, *expected);
    }
    EXPECT_GT(faults, 300);
}

TEST(SceneFault, LooksAtTheStopWhileElementsAndNamesAreChecked) {
    constexpr std::size_t pieces = 5;
    Scene scene;
    scene.elements.resize(pieces * values_between_looks);
    const auto looks = [&] {
        std::size_t count = 0;
        static_cast<void>(find_fault(scene, [&] { ++count; }));
        return count;
    };
    EXPECT_EQ(looks(), pieces);  // no name is written, so that none can be there twice
    scene.elements.front().name = "one";
    EXPECT_EQ(looks(), 3 * pieces);
    struct Stopped {};
    EXPECT_THROW(static_cast<void>(find_fault(scene, [] { throw Stopped(); })), Stopped);
}

}  // namespace
}  // namespace ivory
