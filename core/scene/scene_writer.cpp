#include <cstddef>
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

// Appends `"key": value` for each member, in order. Keys and words need no escape.
class Members {
  public:
    Members(std::string& text, std::string_view separator) : text_(text), separator_(separator) {}

    // Appends the key; the value is to follow.
    std::string& add(std::string_view key) {
        if (!first_) text_ += separator_;
        first_ = false;
        text_.append("\"").append(key).append("\": ");
        return text_;
    }
    Members& add(std::string_view key, double value) {
        append_number(add(key), value);
        return *this;
    }
    Members& add(std::string_view key, const Vec3d& v) {
        add(key);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            text_ += axis == 0 ? "[" : ", ";
            append_number(text_, v[axis]);
        }
        text_ += "]";
        return *this;
    }
    Members& add(std::string_view key, const std::vector<Vec3d>& places) {
        add(key);
        for (std::size_t i = 0; i < places.size(); ++i) {
            text_ += i == 0 ? "[" : ", ";
            for (std::size_t axis = 0; axis < 3; ++axis) {
                text_ += axis == 0 ? "[" : ", ";
                append_number(text_, places[i][axis]);
            }
            text_ += "]";
        }
        text_ += "]";
        return *this;
    }
    Members& add(std::string_view key, const std::vector<double>& numbers) {
        add(key);
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            text_ += i == 0 ? "[" : ", ";
            append_number(text_, numbers[i]);
        }
        text_ += "]";
        return *this;
    }
    Members& add_word(std::string_view key, std::string_view word) {
        add(key).append("\"").append(word).append("\"");
        return *this;
    }

  private:
    std::string& text_;
    std::string_view separator_;
    bool first_ = true;
};

constexpr std::string_view on_one_line = ", ", one_per_line = ",\n  ";

void append_members(Members members, const Camera& camera) {
    members.add("position", camera.position)
        .add("target", camera.target)
        .add("up", camera.up)
        .add("fov", camera.fov);
    if (camera.is_orthographic()) {
        members.add_word("projection",
                         projection_words[static_cast<std::size_t>(camera.projection)]);
    }
    if (camera.height) members.add("height", *camera.height);
}

void append_members(Members members, const Light& light) {
    members.add("direction", light.direction)
        .add("color", light.color)
        .add("intensity", light.intensity)
        .add_word("attached", light.attached_to_camera ? "camera" : "scene");
}

void append_members(Members members, const Element& element) {
    static const Element defaults;
    members.add_word("shape", shape_word(element.skeleton));
    if (element.name) members.add("name") += nlohmann::json(*element.name).dump();
    std::visit(
        [&]<class S>(const S& skeleton) {
            for_members<S>(
                [&](const auto& member) { members.add(member.key, skeleton.*member.value); });
        },
        element.skeleton);
    members.add("color", element.color);
    if (element.kernel != defaults.kernel) {
        members.add_word("kernel", kernel_word(element.kernel));
    }
    if (element.strength != defaults.strength) members.add("strength", element.strength);
    if (!element.widths.empty()) {
        members.add("width", element.widths);
    } else if (element.width != defaults.width) {
        members.add("width", element.width);
    }
    if (!element.visible) members.add("visible") += "false";
}

template <class Part>
void append_object(std::string& text, const Part& part);

void append_members(Members members, const SavedView& view) {
    members.add("name") += nlohmann::json(view.name).dump();
    append_object(members.add("camera"), view.camera);
}

template <class Part>
void append_object(std::string& text, const Part& part) {
    text += "{";
    append_members(Members(text, on_one_line), part);
    text += "}";
}

template <class Item>
void append_list(std::string& text, const std::vector<Item>& items) {
    text += "[";
    for (std::size_t i = 0; i < items.size(); ++i) {
        text += i == 0 ? "\n    " : ",\n    ";
        append_object(text, items[i]);
    }
    text += items.empty() ? "]" : "\n  ]";
}

// `label` is what a message calls the scene, or the part of it.
template <class Part>
void refuse_faulty(const Part& part, const std::string& label) {
    if (const std::optional<SceneFault> fault = find_fault(part)) {
        throw Error(label + ": " + fault->pointer + ": " + fault->message);
    }
}

std::string checked_text(const Scene& scene, const std::string& label) {
    refuse_faulty(scene, label);
    std::string text = "{\n  ";
    Members members(text, one_per_line);
    members.add("ivory", 1).add("threshold", scene.threshold).add("background", scene.background);
    if (scene.camera) append_object(members.add("camera"), *scene.camera);
    if (!scene.views.empty()) append_list(members.add("views"), scene.views);
    if (scene.lights) append_list(members.add("lights"), *scene.lights);
    append_list(members.add("elements"), scene.elements);
    text += "\n}\n";
    return text;
}

}  // namespace

std::string write_scene(const Scene& scene) { return checked_text(scene, "the scene"); }

std::string write_camera(const Camera& camera) {
    refuse_faulty(camera, "the camera");
    std::string text;
    append_object(text, camera);
    return text;
}

void save_scene(const Scene& scene, const std::filesystem::path& path) {
    write_file(path, checked_text(scene, file_label(path)));
}

}  // namespace ivory
