// A scene as its file says it: plain data, an immutable value to everything downstream.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/kernel/kernels.h"
#include "core/math/vec3.h"
#include "core/shape/shapes.h"

namespace ivory {

// Linear RGB, each 0..1.
using Color = Vec3d;

struct Element {
    Skeleton skeleton;
    std::optional<std::string> name{};  // as written; `element_names` gives the defaults too
    Color color{0.8, 0.8, 0.8};
    KernelKind kernel = KernelKind::blinn;
    double strength = 1;  // b, finite, not 0; negative carves
    double width = 1;     // w > 0, divides the distance; of a list the least
    // Where the width tapers: at a and at b of a segment, at each point of a polyline, each > 0.
    // Empty: `width` all along.
    std::vector<double> widths{};
    bool visible = true;  // false: not part of the field
    friend bool operator==(const Element&, const Element&) = default;
};

// What a field makes of it.
[[nodiscard]] inline Shape field_shape_of(const Element& element) {
    const Shape shape = shape_of_skeleton(element.skeleton);
    if (element.widths.empty()) return shape;
    return shape == Shape::polyline ? Shape::tapered_polyline : Shape::taper;
}

struct Camera {
    enum class Projection : std::uint8_t { perspective, orthographic };

    Vec3d position;
    Vec3d target;
    Vec3d up{0, 1, 0};
    double fov = 40;  // the full vertical angle in degrees, 0 < fov < 180
    Projection projection = Projection::perspective;
    // Of an orthographic picture, in scene units, > 0; without: what fov sees at the target. The
    // other projection keeps it, but does not use it.
    std::optional<double> height{};
    [[nodiscard]] bool is_orthographic() const { return projection == Projection::orthographic; }
    friend bool operator==(const Camera&, const Camera&) = default;
};

inline constexpr std::array<std::string_view, 2> projection_words{"perspective", "orthographic"};

// A camera to come back to.
struct SavedView {
    std::string name;  // not empty, unique in the scene
    Camera camera;
    friend bool operator==(const SavedView&, const SavedView&) = default;
};

struct Light {
    Vec3d direction;  // towards the light; any length but 0
    Color color{1, 1, 1};
    double intensity = 1;             // >= 0
    bool attached_to_camera = false;  // direction in camera axes (right, up, back)
    friend bool operator==(const Light&, const Light&) = default;
};

struct Scene {
    double threshold = 0.5;  // T > 0
    Color background{0.05, 0.06, 0.08};
    std::optional<Camera> camera;  // without one: core/render/camera.h frames the scene
    std::vector<SavedView> views;
    std::optional<std::vector<Light>> lights;  // without: `default_lights`
    std::vector<Element> elements;
    friend bool operator==(const Scene&, const Scene&) = default;
};

// The names that elements have without a written one, told in file order: shape and number among
// its shape ("point 1", "segment 2"). Named elements count too, so that naming one does not rename
// those after it.
class DefaultNames {
  public:
    // Of the next element.
    [[nodiscard]] std::string next(const Skeleton& skeleton);

  private:
    std::array<std::size_t, shape_count> count_{};
};

// One name per element, in file order: the written one or the default.
[[nodiscard]] std::vector<std::string> element_names(const Scene& scene);

// One head light along the view and one key light from the upper left, both attached to the camera.
[[nodiscard]] std::vector<Light> default_lights();

}  // namespace ivory
