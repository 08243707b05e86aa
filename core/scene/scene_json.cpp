#include "core/scene/scene_json.h"

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "core/scene/json_reader.h"
#include "core/scene/read_file.h"
#include "core/scene/scene_fault.h"
#include "core/scene/text.h"

namespace ivory {
namespace {

using Words = std::span<const std::string_view>;

constexpr std::array<std::string_view, 6> scene_keys{"ivory",  "threshold", "background",
                                                     "camera", "lights",    "elements"};
constexpr std::array<std::string_view, 4> camera_keys{"position", "target", "up", "fov"};
constexpr std::array<std::string_view, 4> light_keys{"direction", "color", "intensity", "attached"};
constexpr std::array<std::string_view, 7> element_keys{"shape",    "name",  "color",  "kernel",
                                                       "strength", "width", "visible"};
constexpr std::array<std::string_view, 1> point_keys{"position"};
constexpr std::array<std::string_view, 2> segment_keys{"a", "b"};
constexpr std::array<std::string_view, 3> circle_keys{"center", "normal", "radius"};

constexpr std::array<std::string_view, 3> built_shapes{"point", "segment", "circle"};
constexpr std::array<std::string_view, 6> shapes{"point", "segment", "circle",
                                                 "disc",  "polygon", "curve"};
constexpr std::array<std::string_view, 3> kernels{"blinn", "nishimura", "wyvill"};
constexpr std::array<std::string_view, 2> attachments{"camera", "scene"};

bool contains(Words words, std::string_view word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

// A value of the tree and the way to it, which becomes a JSON pointer only in a message. Lives on
// the stack, above the nodes that it came through.
struct Node {
    const SourceText& source;
    const JsonValue& value;
    const Node* parent = nullptr;
    std::string_view key = {};  // in an object
    std::size_t index = 0;      // in a list

    std::string pointer() const {
        if (parent == nullptr) return "";
        return parent->holds<JsonValue::Object>() ? pointer_into(parent->pointer(), key)
                                                  : parent->pointer() + "/" + std::to_string(index);
    }

    Error fault(const std::string& message) const {
        return source.fault(value.offset, pointer(), message);
    }

    Error wrong_kind(std::string_view expected) const {
        return fault(value.description() + " stands here; it must be " + std::string(expected));
    }

    template <class Content>
    bool holds() const {
        return std::holds_alternative<Content>(value.content);
    }

    template <class Content>
    const Content& as(std::string_view expected) const {
        if (const auto* const content = std::get_if<Content>(&value.content)) return *content;
        throw wrong_kind(expected);
    }

    Node item(std::size_t i) const {
        return {source, std::get<JsonValue::Array>(value.content)[i], this, {}, i};
    }

    // Of a node that is known to be an object.
    std::optional<Node> optional(std::string_view name) const {
        const JsonValue* const member =
            find_member(std::get<JsonValue::Object>(value.content), name);
        if (member == nullptr) return std::nullopt;
        return Node{source, *member, this, name};
    }

    Node required(std::string_view name, std::string_view owner, Words needed) const {
        if (std::optional<Node> member = optional(name)) return *member;
        throw fault("the key " + in_quotes(name) + " is missing; " + std::string(owner) +
                    " needs " + listed(needed));
    }

    // `owner` has the keys of both lists and no others.
    void refuse_unknown_keys(std::string_view owner, Words first, Words second = {}) const {
        for (const JsonMember& member : std::get<JsonValue::Object>(value.content)) {
            if (contains(first, member.key) || contains(second, member.key)) continue;
            std::vector<std::string_view> known(first.begin(), first.end());
            known.insert(known.end(), second.begin(), second.end());
            const std::optional<std::string_view> meant = nearest_word(member.key, known);
            throw source.fault(member.offset, pointer_into(pointer(), member.key),
                               std::string(owner) + " has no key " + in_quotes(member.key) + "; " +
                                   (meant ? "did you mean " + in_quotes(*meant) + "? " : "") +
                                   "it may have " + listed(known));
        }
    }
};

double number(const Node& node) { return node.as<double>("a number"); }

// One of `words`, by its place among them.
std::size_t one_of(const Node& node, Words words) {
    const auto& word = node.as<std::string>(listed(words, "or"));
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (words[i] == word) return i;
    }
    throw node.wrong_kind(listed(words, "or"));
}

Vec3d three_numbers(const Node& node) {
    constexpr std::string_view expected = "a list of three numbers";
    if (node.as<JsonValue::Array>(expected).size() != 3) throw node.wrong_kind(expected);
    return {number(node.item(0)), number(node.item(1)), number(node.item(2))};
}

Camera camera(const Node& node) {
    node.as<JsonValue::Object>("an object with position and target");
    node.refuse_unknown_keys("a camera", camera_keys);
    const Words needed = Words(camera_keys).first(2);
    Camera camera;
    camera.position = three_numbers(node.required("position", "a camera", needed));
    camera.target = three_numbers(node.required("target", "a camera", needed));
    if (const auto up = node.optional("up")) camera.up = three_numbers(*up);
    if (const auto fov = node.optional("fov")) camera.fov = number(*fov);
    return camera;
}

Light light(const Node& node) {
    node.as<JsonValue::Object>("an object with a direction");
    node.refuse_unknown_keys("a light", light_keys);
    Light light;
    light.direction =
        three_numbers(node.required("direction", "a light", Words(light_keys).first(1)));
    if (const auto color = node.optional("color")) light.color = three_numbers(*color);
    if (const auto intensity = node.optional("intensity")) light.intensity = number(*intensity);
    if (const auto attached = node.optional("attached")) {
        light.attached_to_camera = one_of(*attached, attachments) == 0;
    }
    return light;
}

// What the keys of the element's shape say; refuses those of other shapes.
Skeleton skeleton(const Node& node) {
    const Node shape = node.required("shape", "an element", Words(element_keys).first(1));
    switch (one_of(shape, shapes)) {
        case 0: {
            node.refuse_unknown_keys("a point", point_keys, element_keys);
            return PointSkeleton{three_numbers(node.required("position", "a point", point_keys))};
        }
        case 1: {
            node.refuse_unknown_keys("a segment", segment_keys, element_keys);
            return SegmentSkeleton{three_numbers(node.required("a", "a segment", segment_keys)),
                                   three_numbers(node.required("b", "a segment", segment_keys))};
        }
        case 2: {
            node.refuse_unknown_keys("a circle", circle_keys, element_keys);
            return CircleSkeleton{three_numbers(node.required("center", "a circle", circle_keys)),
                                  three_numbers(node.required("normal", "a circle", circle_keys)),
                                  number(node.required("radius", "a circle", circle_keys))};
        }
        default:
            throw shape.fault("the shape " + in_quotes(std::get<std::string>(shape.value.content)) +
                              " belongs to the format but is not built yet; use " +
                              listed(built_shapes, "or"));
    }
}

Element element(const Node& node) {
    node.as<JsonValue::Object>("an object with a shape");
    Element element;
    element.skeleton = skeleton(node);
    if (const auto name = node.optional("name")) element.name = name->as<std::string>("text");
    if (const auto color = node.optional("color")) element.color = three_numbers(*color);
    if (const auto kernel = node.optional("kernel")) {
        element.kernel = static_cast<KernelKind>(one_of(*kernel, kernels));
    }
    if (const auto strength = node.optional("strength")) element.strength = number(*strength);
    if (const auto width = node.optional("width")) element.width = number(*width);
    if (const auto visible = node.optional("visible")) {
        element.visible = visible->as<bool>("true or false");
    }
    return element;
}

Scene scene(const Node& node) {
    node.as<JsonValue::Object>("an object with ivory, threshold and elements");
    constexpr std::array<std::string_view, 3> needed{"ivory", "threshold", "elements"};

    // Before the keys: another version may have others.
    const Node version = node.required("ivory", "a scene", needed);
    if (number(version) != 1) {
        throw version.fault("the version of the format is " + version.value.description() +
                            "; it must be 1, the only one there is");
    }
    node.refuse_unknown_keys("a scene", scene_keys);

    Scene scene;
    scene.threshold = number(node.required("threshold", "a scene", needed));
    if (const auto background = node.optional("background")) {
        scene.background = three_numbers(*background);
    }
    if (const auto member = node.optional("camera")) scene.camera = camera(*member);
    if (const auto lights = node.optional("lights")) {
        const std::size_t count = lights->as<JsonValue::Array>("a list of lights").size();
        scene.lights.emplace();
        for (std::size_t i = 0; i < count; ++i) scene.lights->push_back(light(lights->item(i)));
    }
    const Node elements = node.required("elements", "a scene", needed);
    const std::size_t count = elements.as<JsonValue::Array>("a list of elements").size();
    scene.elements.reserve(count);
    for (std::size_t i = 0; i < count; ++i) scene.elements.push_back(element(elements.item(i)));
    return scene;
}

}  // namespace

Scene read_scene(const std::filesystem::path& path) {
    return parse_scene(read_file(path), file_label(path));
}

Scene parse_scene(std::string_view text, const std::string& name) {
    const SourceText source(text, name);
    if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) {
        throw source.fault(0, "",
                           "the file is empty; the least scene is {\"ivory\": 1, \"threshold\": "
                           "0.5, \"elements\": []}");
    }
    const JsonValue root = parse_json(source);
    Scene result = scene({source, root});
    if (const std::optional<SceneFault> fault = find_fault(result)) {
        throw source.fault(nearest_to(root, fault->pointer).offset, fault->pointer, fault->message);
    }
    return result;
}

}  // namespace ivory
