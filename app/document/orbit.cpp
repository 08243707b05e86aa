#include "app/document/orbit.h"

#define GLM_FORCE_EXPLICIT_CTOR
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/math/direction.h"
#include "core/render/camera.h"
#include "core/scene/scene_fault.h"

namespace ivory {

namespace {

constexpr double zoom_per_step = 0.88;  // of the distance, by one notch of the wheel
constexpr double pole_margin = 0.1;     // degrees that an orbit keeps from `up`
constexpr double frame_margin = 1.1;    // as core/render/camera.h

glm::dvec3 to_glm(const Vec3d& v) { return glm::dvec3(v.x, v.y, v.z); }

Vec3d from_glm(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

double distance(const Camera& camera) { return length_of(camera.position - camera.target); }

// Half of what a perspective camera sees from top to bottom at distance 1.
double slope(const Camera& camera) { return std::tan(glm::radians(camera.fov) / 2); }

// Unit, from the target to the camera.
Vec3d back_of(const Camera& camera) { return unit(camera.position - camera.target); }

// How far the box reaches from the target towards the camera.
double reach_towards(const Camera& camera, const Box3& box) {
    const Vec3d back = back_of(camera);
    double reach = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double farther = back[axis] > 0 ? box.hi[axis] : box.lo[axis];
        reach += back[axis] * (farther - camera.target[axis]);
    }
    return reach;
}

// What the camera of an edit of the view may become; where numbers run out the view stays as it
// was.
Camera unless_lost(const Camera& next, const Camera& now) { return find_fault(next) ? now : next; }

// The view as turntable: elevation above the plane across `up`, and the level direction towards the
// camera.
struct Turntable {
    bool from_pole;  // straight along y, where the camera's `up` lies across it
    glm::dvec3 up;
    glm::dvec3 level;  // unit, across `up`
    double elevation;  // radians
};

Turntable turntable_of(const Projection& view) {
    const glm::dvec3 back = to_glm(view.back()), top = to_glm(view.top());
    const bool from_pole = std::hypot(view.back().x, view.back().z) < 1e-9;
    const glm::dvec3 up = from_pole ? glm::dvec3(0, 1, 0) : to_glm(unit(view.camera().up));
    const double sine = glm::clamp(glm::dot(back, up), -1.0, 1.0);
    // Near the poles `top` says where level is better than `back` does: both are combinations of it
    // and `up`, with cos and -sin of the elevation.
    const glm::dvec3 level = std::abs(sine) < 0.9 ? back - sine * up
                             : sine > 0           ? glm::dot(top, up) * up - top
                                                  : top - glm::dot(top, up) * up;
    return {from_pole, up, glm::normalize(level), std::asin(sine)};
}

}  // namespace

Projection::Projection(const Camera& camera, WindowSize size) : camera_(camera), size_(size) {
    const glm::dvec3 forward = to_glm(unit(camera.target - camera.position));
    const glm::dvec3 right = glm::normalize(glm::cross(forward, to_glm(unit(camera.up))));
    right_ = from_glm(right);
    top_ = from_glm(glm::cross(right, forward));
    back_ = from_glm(-forward);
    pixels_per_length_ = size.height / (is_orthographic() ? height_of(camera) : 2 * slope(camera));
}

std::optional<WindowPoint> Projection::project(Vec3d place) const {
    const Vec3d from_camera = place - camera_.position;
    double scale = pixels_per_length_;
    if (!is_orthographic()) {
        const double depth = -dot(from_camera, back_);
        if (!(depth > 0)) return std::nullopt;
        scale /= depth;
    }
    return WindowPoint{0.5 * size_.width + scale * dot(from_camera, right_),
                       0.5 * size_.height - scale * dot(from_camera, top_)};
}

Ray Projection::line_of_sight(WindowPoint at) const {
    const double across = (at.x - 0.5 * size_.width) / pixels_per_length_;
    const double upward = (0.5 * size_.height - at.y) / pixels_per_length_;
    const Vec3d from_middle = across * right_ + upward * top_;
    if (is_orthographic()) return {camera_.position + from_middle, -back_};
    return {camera_.position, unit(from_middle - back_)};
}

double Projection::distance_to(Vec3d place) const {
    const Vec3d from_camera = place - camera_.position;
    return is_orthographic() ? -dot(from_camera, back_) : length_of(from_camera);
}

Vec3d Projection::towards_eye(Vec3d place) const {
    return is_orthographic() || place == camera_.position ? back_ : unit(camera_.position - place);
}

double Projection::length_of_pixel(Vec3d place) const {
    if (is_orthographic()) return 1 / pixels_per_length_;
    const double depth = std::abs(dot(place - camera_.position, back_));
    return std::max(depth, 1e-9 * distance(camera_)) / pixels_per_length_;
}

Vec3d Projection::moved(Vec3d place, double dx, double dy) const {
    const double length = length_of_pixel(place);
    return place + (dx * length) * right_ - (dy * length) * top_;
}

Camera orbited(const Projection& view, double dx, double dy) {
    if (dx == 0 && dy == 0) return view.camera();
    const Turntable from = turntable_of(view);
    const double per_pixel = glm::pi<double>() / view.size().height;
    const glm::dquat turn = glm::angleAxis(-dx * per_pixel, from.up);
    const double pole = glm::radians(90 - pole_margin);
    const double elevation = glm::clamp(from.elevation + dy * per_pixel, -pole, pole);
    const glm::dvec3 back =
        std::cos(elevation) * (turn * from.level) + std::sin(elevation) * from.up;

    Camera camera = view.camera();
    if (from.from_pole) camera.up = from_glm(from.up);
    camera.position = camera.target + distance(camera) * unit(from_glm(back));
    return unless_lost(camera, view.camera());
}

Camera panned(const Projection& view, double dx, double dy) {
    return centred(view, view.moved(view.camera().target, -dx, -dy));
}

// A scaling about the place under the pointer moves camera and target but turns nothing, so that
// the place itself, and everything on its line of sight, stays where it is seen. An orthographic
// camera's height is scaled in place of its distance.
Camera zoomed(const Projection& view, WindowPoint at, double steps) {
    Camera camera = view.camera();
    const double factor = std::pow(zoom_per_step, steps);
    const Ray sight = view.line_of_sight(at);
    double seen = distance(camera);
    if (view.is_orthographic()) {
        const Vec3d across = (1 - factor) * (sight.origin - camera.position);
        camera.position = camera.position + across;
        camera.target = camera.target + across;
        seen = factor * height_of(camera);
        camera.height = seen;
    } else {
        const double reach = seen / -dot(sight.direction, view.back());
        const Vec3d still = camera.position + reach * sight.direction;
        camera.position = still + factor * (camera.position - still);
        camera.target = still + factor * (camera.target - still);
        seen = distance(camera);
    }
    // nearer than that, the places of the scene run out of doubles
    const double size = std::max(
        {std::abs(camera.target.x), std::abs(camera.target.y), std::abs(camera.target.z), 1e-100});
    if (steps > 0 && seen < 1e-9 * size) return view.camera();
    return unless_lost(camera, view.camera());
}

Camera framed(const Projection& view, const Box3& given) {
    const Box3 box = given.empty() ? Box3{{-1, -1, -1}, {1, 1, 1}} : given;
    Camera camera = view.camera();
    camera.target = 0.5 * box.lo + 0.5 * box.hi;
    const Vec3d half = 0.5 * box.hi - 0.5 * box.lo;
    const double radius = frame_margin * std::max(length_of(half), 1e-100);
    const double vertical = glm::radians(camera.fov) / 2;
    const double aspect = static_cast<double>(view.size().width) / view.size().height;
    const double horizontal = std::atan(std::tan(vertical) * aspect);
    const double away = radius / std::sin(std::min(vertical, horizontal));
    camera.position = camera.target + away * view.back();
    if (view.is_orthographic()) camera.height = 2 * radius / std::min(1.0, aspect);
    return unless_lost(camera, view.camera());
}

Camera centred(const Projection& view, Vec3d target) {
    Camera camera = view.camera();
    camera.position = target + (camera.position - camera.target);
    camera.target = target;
    return unless_lost(camera, view.camera());
}

Camera along_axis(const Projection& view, int axis, bool opposite) {
    Camera camera = view.camera();
    const double side = opposite ? -1 : 1;
    Vec3d back;
    back[static_cast<std::size_t>(axis)] = side;
    camera.up = axis == 1 ? Vec3d{0, 0, -side} : Vec3d{0, 1, 0};
    camera.position = camera.target + distance(camera) * back;
    return unless_lost(camera, view.camera());
}

Camera in_projection(const Camera& camera, Camera::Projection projection) {
    if (camera.projection == projection) return camera;
    Camera other = camera;
    other.projection = projection;
    if (other.is_orthographic()) {
        other.height = seen_height(camera);
    } else {
        const double away = height_of(camera) / (2 * slope(camera));
        other.position = camera.target + away * back_of(camera);
        other.height.reset();
    }
    return unless_lost(other, camera);
}

double seen_height(const Camera& camera) {
    return camera.is_orthographic() ? height_of(camera) : 2 * distance(camera) * slope(camera);
}

bool plane_is_before(const Camera& camera, const Box3& box) {
    return box.empty() || reach_towards(camera, box) < distance(camera);
}

// The room before the box is what a hand moves an element by at most before this is asked again, and
// more: a plane that moved at every step would have the picture drawn anew as often.
Camera with_plane_before(const Camera& camera, const Box3& box) {
    if (!camera.is_orthographic() || plane_is_before(camera, box)) return camera;
    const Vec3d size = box.hi - box.lo;
    const double room = std::max(length_of(size), height_of(camera));
    Camera farther = with_height(camera);
    farther.position = camera.target + (reach_towards(camera, box) + room) * back_of(camera);
    return unless_lost(farther, camera);
}

}  // namespace ivory
