#include "core/scene/scene_fault.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <string_view>
#include <variant>
#include <vector>

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

template <class Skeleton>
Fault find_fault(const Member<Skeleton, Vec3d>& member, const Vec3d& value) {
    return member.kind == MemberKind::direction ? unless_direction(member.key, value)
                                                : unless_finite(member.key, value);
}

template <class Skeleton>
Fault find_fault(const Member<Skeleton, double>& member, double length) {
    if (length >= 0 && std::isfinite(length)) return std::nullopt;
    return wrong("/" + std::string(member.key), "the " + std::string(member.key), length,
                 "0 or greater, and finite");
}

template <class Skeleton>
Fault find_fault(const Member<Skeleton, std::vector<Vec3d>>& member,
                 const std::vector<Vec3d>& places) {
    const std::string key(member.key);
    if (places.size() < member.least || places.size() > member.most) {
        const bool has_end = member.most < std::numeric_limits<std::size_t>::max();
        const std::string more = has_end ? " or " + std::to_string(member.most) : " or more";
        return SceneFault{"/" + key, "the list of " + key + " has " +
                                         std::to_string(places.size()) + "; it must have " +
                                         std::to_string(member.least) + more};
    }
    for (std::size_t i = 0; i < places.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            if (std::isfinite(places[i][k])) continue;
            return wrong(
                pointer_to(key, i) + "/" + std::to_string(k),
                std::string(axes[k]) + " of number " + std::to_string(i + 1) + " of the " + key,
                places[i][k], "a finite number");
        }
    }
    return std::nullopt;
}

template <class S>
Fault find_fault(const S& skeleton) {
    Fault fault;
    for_members<S>([&](const auto& member) {
        if (!fault) fault = find_fault(member, skeleton.*member.value);
    });
    // What is right by itself may not go together.
    if constexpr (requires { skeleton.fault(); }) {
        const auto first = std::get<0>(S::members());
        if (const auto wrong = fault ? std::nullopt : skeleton.fault()) {
            fault = SceneFault{"/" + std::string(first.key),
                               "the " + std::string(first.key) + " " + *wrong};
        }
    }
    return fault;
}

// So many widths as the skeleton has places for them, if it has a list.
Fault unless_widths_fit(const Element& element) {
    if (element.widths.empty()) return std::nullopt;
    return std::visit(
        [&]<class S>(const S& skeleton) -> Fault {
            std::size_t places = 0;
            if constexpr (S::may_taper) places = skeleton.width_places();
            if (element.widths.size() == places) return std::nullopt;
            return SceneFault{"/width", "the list of widths has " +
                                            std::to_string(element.widths.size()) +
                                            "; it must have " + std::to_string(places) +
                                            ", or be a single number"};
        },
        element.skeleton);
}

SceneFault within(const std::string& part, SceneFault fault) {
    fault.pointer.insert(0, part);
    return fault;
}

std::string element_pointer(std::size_t i) { return "/elements/" + std::to_string(i); }

// The written names of a scene's first elements and whose each is.
class WrittenNames {
  public:
    explicit WrittenNames(const std::vector<Element>& elements)
        : elements_(elements), slots_(std::bit_ceil(2 * elements.size() + 1), none) {}

    static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

    // Whose the name is, or `none`.
    std::size_t owner(std::string_view name) const { return slots_[slot_of(name)]; }

    // Adds a written name that is nobody's yet.
    void add(std::size_t element) { slots_[slot_of(*elements_[element].name)] = element; }

  private:
    // Where the name is, or is to be put.
    std::size_t slot_of(std::string_view name) const {
        const std::size_t mask = slots_.size() - 1;
        std::size_t at = std::hash<std::string_view>()(name) & mask;
        while (slots_[at] != none && *elements_[slots_[at]].name != name) at = (at + 1) & mask;
        return at;
    }

    const std::vector<Element>& elements_;
    std::vector<std::size_t> slots_;
};

// Two elements of one name.
struct Namesakes {
    std::size_t later, earlier;
};

// Those whose later one comes first. Defaults count as names: whoever says "point 2" means one
// element. But two defaults never agree.
std::optional<Namesakes> first_namesakes(const std::vector<Element>& elements, const Stop& stop) {
    const auto is_named = [](const Element& element) { return element.name.has_value(); };
    if (std::none_of(elements.begin(), elements.end(), is_named)) return std::nullopt;

    std::optional<Namesakes> found;
    WrittenNames written(elements);
    for (std::size_t i = 0; i < elements.size() && !found; ++i) {
        if (i % values_between_looks == 0) look_at(stop);
        if (!is_named(elements[i])) continue;
        const std::size_t owner = written.owner(*elements[i].name);
        if (owner == WrittenNames::none) {
            written.add(i);
        } else {
            found = {i, owner};
        }
    }
    DefaultNames defaults;
    for (std::size_t i = 0; i < elements.size() && !(found && found->later < i); ++i) {
        if (i % values_between_looks == 0) look_at(stop);
        const std::string by_default = defaults.next(elements[i].skeleton);
        if (is_named(elements[i])) continue;
        const std::size_t owner = written.owner(by_default);
        if (owner == WrittenNames::none) continue;
        const Namesakes namesakes{std::max(i, owner), std::min(i, owner)};
        if (!found || namesakes.later < found->later) found = namesakes;
    }
    return found;
}

Fault unless_name(const std::string& pointer, const std::string& name) {
    if (name.empty()) return SceneFault{pointer, "the name is empty; give it a letter at least"};
    if (first_invalid_utf8(name)) {
        return SceneFault{pointer,
                          "the name " + in_quotes(name) + " is not valid UTF-8; write it in UTF-8"};
    }
    return std::nullopt;
}

Fault unless_names_are_unique(const std::vector<Element>& elements, const Stop& stop) {
    const std::optional<Namesakes> found = first_namesakes(elements, stop);
    if (!found) return std::nullopt;
    const bool later_is_written = elements[found->later].name.has_value();
    const std::size_t culprit = later_is_written ? found->later : found->earlier;
    const std::size_t other = later_is_written ? found->earlier : found->later;
    return SceneFault{element_pointer(culprit) + "/name",
                      "the name " + in_quotes(*elements[culprit].name) + " is also that of " +
                          element_pointer(other) +
                          (elements[other].name ? "" : " (its default name)") +
                          "; each element must have a name of its own"};
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
    if (camera.height && !(*camera.height > 0 && std::isfinite(*camera.height))) {
        return wrong("/height", "the height", *camera.height, "greater than 0, and finite");
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

std::optional<SceneFault> find_fault(const std::vector<SavedView>& views) {
    std::map<std::string_view, std::size_t> place_of;
    for (std::size_t i = 0; i < views.size(); ++i) {
        const std::string place = "/" + std::to_string(i);
        if (Fault fault = unless_name("/name", views[i].name)) return within(place, *fault);
        const auto [earlier, is_new] = place_of.emplace(views[i].name, i);
        if (!is_new) {
            return SceneFault{place + "/name", "the name " + in_quotes(views[i].name) +
                                                   " is also that of /views/" +
                                                   std::to_string(earlier->second) +
                                                   "; each view must have a name of its own"};
        }
        if (Fault fault = find_fault(views[i].camera)) return within(place + "/camera", *fault);
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
    if (element.name) {
        if (Fault fault = unless_name("/name", *element.name)) return fault;
    }
    const auto skeleton_fault = [](const auto& skeleton) { return find_fault(skeleton); };
    if (Fault fault = std::visit(skeleton_fault, element.skeleton)) return fault;
    if (Fault fault = unless_color("color", element.color)) return fault;
    if (!std::isfinite(element.strength) || element.strength == 0) {
        return wrong("/strength", "the strength", element.strength,
                     "finite and not 0 (below 0 it carves; \"visible\": false leaves the element "
                     "out)");
    }
    if (Fault fault = unless_widths_fit(element)) return fault;
    for (std::size_t i = 0; i < element.widths.size(); ++i) {
        if (!(element.widths[i] > 0 && std::isfinite(element.widths[i]))) {
            return wrong(pointer_to("width", i), "the width", element.widths[i],
                         "greater than 0, and finite");
        }
    }
    if (!(element.width > 0 && std::isfinite(element.width))) {
        return wrong("/width", "the width", element.width, "greater than 0, and finite");
    }
    return std::nullopt;
}

std::optional<SceneFault> find_fault(const Scene& scene, const Stop& stop) {
    if (!(scene.threshold > 0 && std::isfinite(scene.threshold))) {
        return wrong("/threshold", "the threshold", scene.threshold, "greater than 0, and finite");
    }
    if (Fault fault = unless_color("background", scene.background)) return fault;
    if (scene.camera) {
        if (Fault fault = find_fault(*scene.camera)) return within("/camera", *fault);
    }
    if (Fault fault = find_fault(scene.views)) return within("/views", *fault);
    if (scene.lights) {
        for (std::size_t i = 0; i < scene.lights->size(); ++i) {
            if (Fault fault = find_fault((*scene.lights)[i])) {
                return within("/lights/" + std::to_string(i), *fault);
            }
        }
    }
    for (std::size_t i = 0; i < scene.elements.size(); ++i) {
        if (i % values_between_looks == 0) look_at(stop);
        if (Fault fault = find_fault(scene.elements[i])) {
            return within(element_pointer(i), *fault);
        }
    }
    return unless_names_are_unique(scene.elements, stop);
}

}  // namespace ivory
