#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "app/cli/commands.h"
#include "app/cli/interrupt.h"
#include "app/cli/output.h"
#include "core/field/field.h"
#include "core/render/camera.h"
#include "core/render/canvas.h"
#include "core/render/framing.h"
#include "core/scene/error.h"
#include "core/scene/scene_json.h"
#include "core/scene/text.h"

namespace ivory {
namespace {

using Json = nlohmann::ordered_json;

// The camera of a scene without one depends on the picture; this is the size that `render` takes.
constexpr int default_width = 1280, default_height = 720;

// Why an element is left out of the field, or of the box around the solid. With n visible elements
// of positive strength, every inside point has some F_i >= T / n.
enum class Skip { none, invisible, negative, weak };

struct SkipWords {
    std::string_view from, why;
};

SkipWords words_for(Skip skip) {
    switch (skip) {
        case Skip::none:
            break;
        case Skip::invisible:
            return {"field", "not visible"};
        case Skip::negative:
            return {"box", "negative strength: it only carves"};
        case Skip::weak:
            return {"box", "n b < T: nowhere inside is it the strongest of the n"};
    }
    return {"", ""};
}

std::vector<Skip> skips_of(const Scene& scene) {
    const auto positive = static_cast<double>(
        std::count_if(scene.elements.begin(), scene.elements.end(),
                      [](const Element& e) { return e.visible && e.strength > 0; }));
    std::vector<Skip> skips;
    skips.reserve(scene.elements.size());
    for (const Element& e : scene.elements) {
        skips.push_back(!e.visible                                ? Skip::invisible
                        : e.strength < 0                          ? Skip::negative
                        : positive * e.strength < scene.threshold ? Skip::weak
                                                                  : Skip::none);
    }
    return skips;
}

struct Census {
    std::map<std::string, std::size_t> shapes, kernels;
    std::size_t visible = 0;
};

Census census_of(const Scene& scene) {
    Census census;
    for (const Element& e : scene.elements) {
        ++census.shapes[shape_word(e.skeleton)];
        ++census.kernels[kernel_word(e.kernel)];
        if (e.visible) ++census.visible;
    }
    return census;
}

std::string text_of(const Vec3d& v) {
    return number_text(v.x) + " " + number_text(v.y) + " " + number_text(v.z);
}

std::string text_of(const Box3& box) {
    return box.empty() ? "none: the surface is empty" : text_of(box.lo) + " .. " + text_of(box.hi);
}

std::string text_of(const std::map<std::string, std::size_t>& counts) {
    std::string text;
    for (const auto& [word, count] : counts) {
        text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + word;
    }
    return text.empty() ? "none" : text;
}

// "3 from the field: not visible (point 1, point 2, segment 1)", one line a reason.
std::string text_of_skips(const Scene& scene) {
    constexpr std::size_t most_names = 6;
    const std::vector<Skip> skips = skips_of(scene);
    const std::vector<std::string> names = element_names(scene);
    std::string text;
    for (const Skip kind : {Skip::invisible, Skip::negative, Skip::weak}) {
        std::string list;
        std::size_t count = 0;
        for (std::size_t i = 0; i < skips.size(); ++i) {
            if (skips[i] != kind) continue;
            if (++count <= most_names) list += (count == 1 ? "" : ", ") + printable(names[i], 40);
        }
        if (count == 0) continue;
        if (count > most_names) list += ", " + std::to_string(count - most_names) + " more";
        const SkipWords words = words_for(kind);
        text += "skipped    " + std::to_string(count) + " from the " + std::string(words.from) +
                ": " + std::string(words.why) + " (" + list + ")\n";
    }
    return text.empty() ? "skipped    nothing\n" : text;
}

std::string text_of(const std::string& file, const Scene& scene, const Field& field,
                    const Camera& camera) {
    const Census census = census_of(scene);
    std::string text;
    text += "scene      " + printable(file) + "\n";
    text += "elements   " + std::to_string(scene.elements.size()) + ", " +
            std::to_string(census.visible) + " visible: " + text_of(census.shapes) + "\n";
    text += "kernels    " + text_of(census.kernels) + "\n";
    text += "threshold  " + number_text(scene.threshold) + "\n";
    text += "box        " + text_of(field.box) + "\n";
    text += "camera     position " + text_of(camera.position) + ", target " +
            text_of(camera.target) + ", up " + text_of(camera.up) +
            (camera.is_orthographic() ? ", orthographic, height " + number_text(height_of(camera))
                                      : ", fov " + number_text(camera.fov)) +
            (scene.camera ? "" : " (framed for 1280x720)") + "\n";
    for (const SavedView& view : scene.views) text += "view       " + printable(view.name) + "\n";
    text += "lights     " +
            std::to_string(scene.lights ? scene.lights->size() : default_lights().size()) +
            (scene.lights ? "" : " (the default ones)") + "\n";
    return text + text_of_skips(scene);
}

Json json_of(const Vec3d& v) { return Json::array({v.x, v.y, v.z}); }

Json json_of(const Box3& box) {
    if (box.empty()) return nullptr;
    return {{"lo", json_of(box.lo)}, {"hi", json_of(box.hi)}};
}

Json json_of_skips(const Scene& scene) {
    const std::vector<Skip> skips = skips_of(scene);
    const std::vector<std::string> names = element_names(scene);
    Json list = Json::array();
    for (std::size_t i = 0; i < skips.size(); ++i) {
        if (skips[i] == Skip::none) continue;
        const SkipWords words = words_for(skips[i]);
        list.push_back(
            {{"element", i}, {"name", names[i]}, {"from", words.from}, {"why", words.why}});
    }
    return list;
}

std::string json_of(const std::string& file, const Scene& scene, const Field& field,
                    const Camera& camera) {
    const Census census = census_of(scene);
    Json json;
    json["scene"] = file;
    json["threshold"] = scene.threshold;
    json["elements"] = {{"total", scene.elements.size()},
                        {"visible", census.visible},
                        {"shapes", census.shapes},
                        {"kernels", census.kernels}};
    json["box"] = json_of(field.box);
    json["reach_box"] = json_of(field.reach_box);
    json["camera"] = Json::parse(write_camera(with_height(camera)));
    json["camera"]["framed"] = !scene.camera;
    json["views"] = scene.views.size();
    json["lights"] = scene.lights ? scene.lights->size() : default_lights().size();
    json["skipped"] = json_of_skips(scene);
    // The bytes of a path need not be UTF-8, which JSON is.
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

// `proved: what it proves`, aligned.
std::string text_of_methods() {
    std::size_t longest = 0;
    for (const Method* method : methods()) longest = std::max(longest, method->name().size());
    std::string text;
    for (const Method* method : methods()) {
        std::string name(method->name());
        name.resize(longest + 2, ' ');
        text += name + std::string(method->proves()) + "\n";
    }
    return text;
}

std::string json_of_methods() {
    Json list = Json::array();
    for (const Method* method : methods()) {
        list.push_back({{"name", method->name()}, {"proves", method->proves()}});
    }
    return list.dump(2) + "\n";
}

}  // namespace

void run(const InfoArguments& arguments) {
    Output output("-");
    if (arguments.methods) {
        output.write(arguments.json ? json_of_methods() : text_of_methods());
        return;
    }
    const Scene scene = read_scene(arguments.scene, stop_if_interrupted);
    const Field field = compile(scene);
    const Camera camera = [&] {
        try {
            return camera_of(scene, field, default_width, default_height);
        } catch (const Error& fault) {
            throw camera_fault(scene, arguments.scene, fault);
        }
    }();
    output.write(arguments.json ? json_of(arguments.scene, scene, field, camera)
                                : text_of(arguments.scene, scene, field, camera));
}

}  // namespace ivory
