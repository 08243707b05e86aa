#include "core/scene/scene.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/scene/scene_fault.h"

namespace ivory {
namespace {

TEST(Scene, WordsAreThoseOfTheFormat) {
    EXPECT_STREQ(shape_word(PointSkeleton{}), "point");
    EXPECT_STREQ(shape_word(SegmentSkeleton{}), "segment");
    EXPECT_STREQ(shape_word(CircleSkeleton{}), "circle");
    EXPECT_STREQ(kernel_word(KernelKind::blinn), "blinn");
    EXPECT_STREQ(kernel_word(KernelKind::nishimura), "nishimura");
    EXPECT_STREQ(kernel_word(KernelKind::wyvill), "wyvill");
}

TEST(Scene, DefaultNamesCountTheShapeInFileOrderNamedOnesIncluded) {
    Scene scene;
    scene.elements = {{.skeleton = PointSkeleton{}},
                      {.skeleton = SegmentSkeleton{}},
                      {.skeleton = PointSkeleton{}, .name = "thumb"},
                      {.skeleton = CircleSkeleton{}},
                      {.skeleton = PointSkeleton{}, .visible = false},
                      {.skeleton = SegmentSkeleton{}}};
    EXPECT_EQ(element_names(scene), (std::vector<std::string>{"point 1", "segment 1", "thumb",
                                                              "circle 1", "point 3", "segment 2"}));
}

TEST(Scene, DefaultLightsAreAHeadLightAndAKeyLightOnTheCamera) {
    const std::vector<Light> lights = default_lights();
    ASSERT_EQ(lights.size(), 2U);
    EXPECT_EQ(lights[0].direction, (Vec3d{0, 0, 1}));
    EXPECT_EQ(lights[1].direction, (Vec3d{-0.4, 0.6, 0.7}));
    EXPECT_EQ(lights[1].intensity, 0.8);
    for (const Light& light : lights) {
        EXPECT_TRUE(light.attached_to_camera);
        EXPECT_FALSE(find_fault(light).has_value());
    }
}

}  // namespace
}  // namespace ivory
