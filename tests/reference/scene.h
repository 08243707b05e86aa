// What the reference knows of a scene: its field. Types and reader of its own, so that neither a new
// shape nor a slip in reading has to be right in core first.
#pragma once

#include <filesystem>
#include <string_view>
#include <variant>
#include <vector>

#include "core/math/vec3.h"

namespace ivory::reference {

struct Point {
    Vec3d position;
    friend bool operator==(const Point&, const Point&) = default;
};
struct Segment {
    Vec3d a, b;  // may coincide
    friend bool operator==(const Segment&, const Segment&) = default;
};
struct Circle {
    Vec3d center, normal;
    double radius = 0;
    friend bool operator==(const Circle&, const Circle&) = default;
};
struct Disc {
    Vec3d center, normal;
    double radius = 0;
    friend bool operator==(const Disc&, const Disc&) = default;
};
// Filled, in the plane through the first vertex with the Newell normal; the vertices are projected.
struct Polygon {
    std::vector<Vec3d> vertices;
    friend bool operator==(const Polygon&, const Polygon&) = default;
};
// A Bezier curve: 3 or 4 points.
struct Curve {
    std::vector<Vec3d> control_points;
    friend bool operator==(const Curve&, const Curve&) = default;
};
struct Polyline {
    std::vector<Vec3d> points;
    friend bool operator==(const Polyline&, const Polyline&) = default;
};
using Skeleton = std::variant<Point, Segment, Circle, Disc, Polygon, Curve, Polyline>;

// A point of the skeleton, from which its coordinates are counted: the first, or the centre.
[[nodiscard]] const Vec3d& first_place(const Skeleton& skeleton);

enum class Kernel { blinn, nishimura, wyvill, murakami, blobtree };

struct Element {
    Skeleton skeleton;
    Kernel kernel = Kernel::blinn;
    double strength = 1;
    double width = 1;              // the least of `widths` where there are any
    std::vector<double> widths{};  // of a segment's two ends, of a polyline's points; or empty
    Vec3d color{0.8, 0.8, 0.8};
    bool visible = true;

    [[nodiscard]] double greatest_width() const;
};

struct ReferenceScene {
    double threshold = 0.5;
    std::vector<Element> elements;
};

// Throw std::runtime_error, with what is wrong, for text that is not a scene of the contract or has
// an element with a key, a shape or a kernel that is not in it. What is not part of the field
// (camera, lights, ...) is passed over.
[[nodiscard]] ReferenceScene parse_reference_scene(std::string_view text);
[[nodiscard]] ReferenceScene read_reference_scene(const std::filesystem::path& path);

}  // namespace ivory::reference
