#include "core/scene/scene_fault.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <unordered_map>
#include <variant>

#include "core/scene/text.h"

namespace ivory {
namespace {

using Fault = std::optional<SceneFault>;

constexpr std::string_view axes[3] = {"x", "y", "z"};

SceneFault wrong(std::string pointer, const std::string& what, double value,
                 const std::string& rule) {
    return {std::move(pointer), what + " is " + number_text(value) + "; it must be " + rule};
}

std::string pointer_to(std::string_view key, std::size_t i) {
    return "/" + std::string(key) + "/" + std::to_string(i);
}

bool finite(const Vec3d& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

Fault unless_finite(std::string_view key, const Vec3d& v) {
    for (std::size_t i = 0; i < 3; ++i) {
        if (!std::isfinite(v[i])) {
            return wrong(pointer_to(key, i), std::string(axes[i]) + " of the " + std::string(key),
                         v[i], "a finite number");
        }
    }
    return std::nullopt;
}

Fault unless_direction(std::string_view key, const Vec3d& v) {
    if (Fault fault = unless_finite(key, v)) return fault;
    if (v == Vec3d{0, 0, 0}) {
        return SceneFault{"/" + std::string(key), "the " + std::string(key) +
                                                      " is 0, 0, 0 and points nowhere; at least "
                                                      "one of its numbers must not be 0"};
    }
    return std::nullopt;
}

Fault unless_color(std::string_view key, const Color& color) {
    constexpr std::string_view parts[3] = {"red", "green", "blue"};
    for (std::size_t i = 0; i < 3; ++i) {
        if (!(color[i] >= 0 && color[i] <= 1)) {
            return wrong(pointer_to(key, i), std::string(parts[i]) + " of the " + std::string(key),
                         color[i], "from 0 to 1");
        }
    }
    return std::nullopt;
}

Fault find_fault(const PointSkeleton& point) { return unless_finite("position", point.position); }

Fault find_fault(const SegmentSkeleton& segment) {
    if (Fault fault = unless_finite("a", segment.a)) return fault;
    return unless_finite("b", segment.b);
}

Fault find_fault(const CircleSkeleton& circle) {
    if (Fault fault = unless_finite("center", circle.center)) return fault;
    if (Fault fault = unless_direction("normal", circle.normal)) return fault;
    if (!(circle.radius >= 0 && std::isfinite(circle.radius))) {
        return wrong("/radius", "the radius", circle.radius, "0 or greater, and finite");
    }
    return std::nullopt;
}

SceneFault within(const std::string& part, SceneFault fault) {
    fault.pointer.insert(0, part);
    return fault;
}

std::string element_pointer(std::size_t i) { return "/elements/" + std::to_string(i); }

// Defaults count as names: whoever says "point 2" means one element.
Fault unless_names_are_unique(const Scene& scene) {
    const std::vector<std::string> names = element_names(scene);
    std::unordered_map<std::string_view, std::size_t> first_with;
    first_with.reserve(names.size());
    for (std::size_t i = 0; i < names.size(); ++i) {
        const auto [entry, is_new] = first_with.try_emplace(names[i], i);
        if (is_new) continue;
        // Two defaults never agree, so at least one of the two names is written.
        const bool later_is_written = scene.elements[i].name.has_value();
        const std::size_t culprit = later_is_written ? i : entry->second;
        const std::size_t other = later_is_written ? entry->second : i;
        return SceneFault{element_pointer(culprit) + "/name",
                          "the name " + in_quotes(names[i]) + " is also that of " +
                              element_pointer(other) +
                              (scene.elements[other].name ? "" : " (its default name)") +
                              "; each element must have a name of its own"};
    }
    return std::nullopt;
}

// v times a power of two, so that its largest component lies in [1/2, 1): exact but for components
// that are 2^-1000 times smaller or less.
Vec3d scaled_to_one(const Vec3d& v) {
    int exponent = 0;
    std::frexp(std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}), &exponent);
    return {std::ldexp(v.x, -exponent), std::ldexp(v.y, -exponent), std::ldexp(v.z, -exponent)};
}

}  // namespace

bool along(const Vec3d& up, const Vec3d& line_of_sight) {
    // |u x v| = |u| |v| sin(angle). Scaled, both lengths lie in [1/2, sqrt 3): nothing over- or
    // underflows that matters. Each component of the cross product is off by at most
    // 2^-52 (|u_i v_j| + |u_j v_i|), so its length by less than 4 * 2^-52 |u| |v| < 1e-15 |u| |v|:
    // exactly parallel vectors pass the test, and an angle of 1.01e-12 does not.
    const Vec3d u = scaled_to_one(up);
    const Vec3d v = scaled_to_one(line_of_sight);
    const Vec3d c = cross(u, v);
    return dot(c, c) <= 1e-24 * (dot(u, u) * dot(v, v));
}

std::optional<SceneFault> find_fault(const Camera& camera) {
    if (Fault fault = unless_finite("position", camera.position)) return fault;
    if (Fault fault = unless_finite("target", camera.target)) return fault;
    if (Fault fault = unless_direction("up", camera.up)) return fault;
    if (!(camera.fov > 0 && camera.fov < 180)) {
        return wrong("/fov", "the fov", camera.fov, "greater than 0 and less than 180 degrees");
    }
    if (camera.position == camera.target) {
        return SceneFault{"/target",
                          "the target is the position itself; move one, so that the camera looks "
                          "somewhere"};
    }
    const Vec3d line_of_sight = camera.target - camera.position;
    if (!finite(line_of_sight)) {
        return SceneFault{"/target",
                          "the target is farther from the position than the largest double; move "
                          "one nearer"};
    }
    // Rounded, the difference has turned by 2e-16 at most.
    if (along(camera.up, line_of_sight)) {
        return SceneFault{"/up",
                          "the up direction lies along the view, from position to target; turn it "
                          "away from the view"};
    }
    return std::nullopt;
}

std::optional<SceneFault> find_fault(const Light& light) {
    if (Fault fault = unless_direction("direction", light.direction)) return fault;
    if (Fault fault = unless_color("color", light.color)) return fault;
    if (!(light.intensity >= 0 && std::isfinite(light.intensity))) {
        return wrong("/intensity", "the intensity", light.intensity, "0 or greater, and finite");
    }
    return std::nullopt;
}

std::optional<SceneFault> find_fault(const Element& element) {
    if (element.name && element.name->empty()) {
        return SceneFault{"/name",
                          "the name is empty; give it a letter at least, or leave the key out"};
    }
    if (element.name && first_invalid_utf8(*element.name)) {
        return SceneFault{"/name", "the name " + in_quotes(*element.name) +
                                       " is not valid UTF-8; write it in UTF-8"};
    }
    const auto skeleton_fault = [](const auto& skeleton) { return find_fault(skeleton); };
    if (Fault fault = std::visit(skeleton_fault, element.skeleton)) return fault;
    if (Fault fault = unless_color("color", element.color)) return fault;
    if (!std::isfinite(element.strength) || element.strength == 0) {
        return wrong("/strength", "the strength", element.strength,
                     "finite and not 0 (below 0 it carves; \"visible\": false leaves the element "
                     "out)");
    }
    if (!(element.width > 0 && std::isfinite(element.width))) {
        return wrong("/width", "the width", element.width, "greater than 0, and finite");
    }
    return std::nullopt;
}

std::optional<SceneFault> find_fault(const Scene& scene) {
    if (!(scene.threshold > 0 && std::isfinite(scene.threshold))) {
        return wrong("/threshold", "the threshold", scene.threshold, "greater than 0, and finite");
    }
    if (Fault fault = unless_color("background", scene.background)) return fault;
    if (scene.camera) {
        if (Fault fault = find_fault(*scene.camera)) return within("/camera", *fault);
    }
    if (scene.lights) {
        for (std::size_t i = 0; i < scene.lights->size(); ++i) {
            if (Fault fault = find_fault((*scene.lights)[i])) {
                return within("/lights/" + std::to_string(i), *fault);
            }
        }
    }
    for (std::size_t i = 0; i < scene.elements.size(); ++i) {
        if (Fault fault = find_fault(scene.elements[i])) {
            return within(element_pointer(i), *fault);
        }
    }
    return unless_names_are_unique(scene);
}

}  // namespace ivory
