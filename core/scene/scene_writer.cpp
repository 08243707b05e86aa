#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/scene/read_file.h"
#include "core/scene/scene_fault.h"
#include "core/scene/scene_json.h"
#include "core/scene/text.h"
#include "core/scene/write_file.h"

namespace ivory {
namespace {

// `"key": value` for each member, in order. Keys are plain words that need no escape.
class Members {
  public:
    Members& add(std::string_view key, const std::string& value) {
        members_.push_back("\"" + std::string(key) + "\": " + value);
        return *this;
    }
    Members& add(std::string_view key, double value) { return add(key, number_text(value)); }
    Members& add(std::string_view key, const Vec3d& v) {
        return add(
            key, "[" + number_text(v.x) + ", " + number_text(v.y) + ", " + number_text(v.z) + "]");
    }
    Members& add_text(std::string_view key, std::string_view value) {
        return add(key, nlohmann::json(value).dump());
    }

    std::string on_one_line() const { return "{" + joined(", ") + "}"; }
    std::string one_per_line() const { return "{\n  " + joined(",\n  ") + "\n}"; }

  private:
    std::string joined(std::string_view separator) const {
        std::string all;
        for (const std::string& member : members_) {
            if (!all.empty()) all += separator;
            all += member;
        }
        return all;
    }

    std::vector<std::string> members_;
};

std::string text_of(const Camera& camera) {
    return Members()
        .add("position", camera.position)
        .add("target", camera.target)
        .add("up", camera.up)
        .add("fov", camera.fov)
        .on_one_line();
}

std::string text_of(const Light& light) {
    return Members()
        .add("direction", light.direction)
        .add("color", light.color)
        .add("intensity", light.intensity)
        .add_text("attached", light.attached_to_camera ? "camera" : "scene")
        .on_one_line();
}

void add_skeleton(Members& members, const PointSkeleton& point) {
    members.add("position", point.position);
}

void add_skeleton(Members& members, const SegmentSkeleton& segment) {
    members.add("a", segment.a).add("b", segment.b);
}

void add_skeleton(Members& members, const CircleSkeleton& circle) {
    members.add("center", circle.center).add("normal", circle.normal).add("radius", circle.radius);
}

std::string text_of(const Element& element) {
    const Element defaults;
    Members members;
    members.add_text("shape", shape_word(element.skeleton));
    if (element.name) members.add_text("name", *element.name);
    std::visit([&](const auto& skeleton) { add_skeleton(members, skeleton); }, element.skeleton);
    members.add("color", element.color);
    if (element.kernel != defaults.kernel) {
        members.add_text("kernel", kernel_word(element.kernel));
    }
    if (element.strength != defaults.strength) members.add("strength", element.strength);
    if (element.width != defaults.width) members.add("width", element.width);
    if (!element.visible) members.add("visible", "false");
    return members.on_one_line();
}

template <class Item>
std::string list_of(const std::vector<Item>& items) {
    std::string list;
    for (const Item& item : items) {
        list += list.empty() ? "\n    " : ",\n    ";
        list += text_of(item);
    }
    return list.empty() ? "[]" : "[" + list + "\n  ]";
}

// `label` is what a message calls the scene.
std::string checked_text(const Scene& scene, const std::string& label) {
    if (const std::optional<SceneFault> fault = find_fault(scene)) {
        throw Error(label + ": " + fault->pointer + ": " + fault->message);
    }
    Members members;
    members.add("ivory", 1).add("threshold", scene.threshold).add("background", scene.background);
    if (scene.camera) members.add("camera", text_of(*scene.camera));
    if (scene.lights) members.add("lights", list_of(*scene.lights));
    members.add("elements", list_of(scene.elements));
    return members.one_per_line() + "\n";
}

}  // namespace

std::string write_scene(const Scene& scene) { return checked_text(scene, "the scene"); }

void save_scene(const Scene& scene, const std::filesystem::path& path) {
    write_file(path, checked_text(scene, file_label(path)));
}

}  // namespace ivory
