#include "core/scene/scene_json.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "core/scene/json_reader.h"
#include "core/scene/read_file.h"
#include "core/scene/scene_fault.h"
#include "core/scene/text.h"

namespace ivory {
namespace {

using Words = std::span<const std::string_view>;

template <std::size_t A, std::size_t B>
constexpr std::array<std::string_view, A + B> joined(const std::array<std::string_view, A>& a,
                                                     const std::array<std::string_view, B>& b) {
    std::array<std::string_view, A + B> all;
    std::copy(b.begin(), b.end(), std::copy(a.begin(), a.end(), all.begin()));
    return all;
}

constexpr std::array<std::string_view, 7> scene_keys{"ivory", "threshold", "background", "camera",
                                                     "views", "lights",    "elements"};
constexpr std::array<std::string_view, 3> scene_needs{"ivory", "threshold", "elements"};
constexpr std::array<std::string_view, 6> camera_keys{"position", "target",     "up",
                                                      "fov",      "projection", "height"};
constexpr std::array<std::string_view, 2> view_keys{"name", "camera"};
constexpr std::array<std::string_view, 4> light_keys{"direction", "color", "intensity", "attached"};
constexpr std::array<std::string_view, 7> element_keys{"shape",    "name",  "color",  "kernel",
                                                       "strength", "width", "visible"};
template <class S>
constexpr auto skeleton_keys = std::apply(
    [](const auto&... member) {
        return std::array<std::string_view, sizeof...(member)>{member.key...};
    },
    S::members());
template <class S>
constexpr auto keys_of_element = joined(skeleton_keys<S>, element_keys);
constexpr std::size_t most_keys = 16;  // more than any kind of object has

// "a point"; no shape's word begins with a vowel.
template <class S>
constexpr auto characters_with_article = [] {
    static_assert(std::string_view("aeiou").find(S::word.front()) == std::string_view::npos);
    std::array<char, 2 + S::word.size()> text{'a', ' '};
    std::copy(S::word.begin(), S::word.end(), text.begin() + 2);
    return text;
}();
template <class S>
constexpr std::string_view word_with_article{characters_with_article<S>.data(),
                                             characters_with_article<S>.size()};

constexpr std::array<std::string_view, 2> attachments{"camera", "scene"};

// The kinds of objects that a scene is made of.
struct ObjectFormat {
    std::string_view name;  // "a scene"
    Words keys;             // all that it may have
    Words needs;            // those that it must have
};

constexpr ObjectFormat scene_format{"a scene", scene_keys, scene_needs};
constexpr ObjectFormat camera_format{"a camera", camera_keys, Words(camera_keys).first(2)};
constexpr ObjectFormat view_format{"a view", view_keys, view_keys};
constexpr ObjectFormat light_format{"a light", light_keys, Words(light_keys).first(1)};
// Of an element whose shape is not known yet.
constexpr ObjectFormat element_format{"an element", element_keys, Words(element_keys).first(1)};

// Looks at a `Stop` once in so many steps.
class Steps {
  public:
    explicit Steps(const Stop& stop) : stop_(stop) {}
    void take_one() {
        if (++count_ % values_between_looks == 0) look_at(stop_);
    }

  private:
    const Stop& stop_;
    std::size_t count_ = 0;
};

// What the nodes of a scene have in common.
struct Reading {
    const SourceText& source;
    Steps steps;
    // Where the first, second ... key of an object stands in its format: as in the last such.
    std::array<std::size_t, most_keys> places{};
};

// A value of the document and the way to it, which becomes a JSON pointer only in a message. Lives
// on the stack, above the nodes that it came through.
struct Node {
    Reading& reading;
    JsonValue value;
    const Node* parent = nullptr;
    std::string_view key = {};  // in an object
    std::size_t index = 0;      // in a list

    std::string pointer() const {
        if (parent == nullptr) return "";
        return parent->value.kind() == JsonKind::object
                   ? pointer_into(parent->pointer(), key)
                   : parent->pointer() + "/" + std::to_string(index);
    }

    Error fault(const std::string& message) const {
        return reading.source.fault(value.offset(), pointer(), message);
    }

    Error wrong_kind(std::string_view expected) const {
        return fault(value.description() + " stands here; it must be " + std::string(expected));
    }

    void must_be(JsonKind kind, std::string_view expected) const {
        if (value.kind() != kind) throw wrong_kind(expected);
    }

    // Of an object.
    Node required(std::string_view name, const ObjectFormat& format) const {
        const std::optional<JsonValue> member = find_member(value, name);
        if (!member) throw missing(name, format);
        return {reading, *member, this, name};
    }

    Error missing(std::string_view name, const ObjectFormat& format) const {
        return fault("the key " + in_quotes(name) + " is missing; " + std::string(format.name) +
                     " needs " + listed(format.needs));
    }
};

// The members of an object, found in one walk. Refuses keys that the format does not know.
class Members {
  public:
    Members(const Node& object, const ObjectFormat& format) : object_(object), format_(format) {
        std::size_t count = 0;
        for (const JsonMember member : object.value.members()) {
            object.reading.steps.take_one();
            // Most objects of a file have the same keys in the same order.
            std::size_t& place = object.reading.places[count++];
            if (place >= format.keys.size() || !member.key.is_word(format.keys[place])) {
                place = place_of(member.key);
            }
            values_[place] = member.value;
        }
    }

    std::optional<Node> optional(std::string_view key) const {
        while (format_.keys[next_] != key) next_ = (next_ + 1) % format_.keys.size();
        const std::optional<JsonValue>& value = values_[next_];
        if (!value) return std::nullopt;
        return Node{object_.reading, *value, &object_, key};
    }

    Node required(std::string_view key) const {
        if (const std::optional<Node> member = optional(key)) return *member;
        throw object_.missing(key, format_);
    }

  private:
    std::size_t place_of(const JsonValue& key) const {
        std::string buffer;
        const std::string_view written = key.text(buffer);
        const auto place = std::find(format_.keys.begin(), format_.keys.end(), written);
        if (place == format_.keys.end()) throw unknown_key(key.offset(), written);
        return static_cast<std::size_t>(place - format_.keys.begin());
    }

    Error unknown_key(std::size_t offset, std::string_view key) const {
        const std::optional<std::string_view> meant = nearest_word(key, format_.keys);
        return object_.reading.source.fault(
            offset, pointer_into(object_.pointer(), key),
            std::string(format_.name) + " has no key " + in_quotes(key) + "; " +
                (meant ? "did you mean " + in_quotes(*meant) + "? " : "") + "it may have " +
                listed(format_.keys));
    }

    const Node& object_;
    const ObjectFormat& format_;
    // In the order of the format's keys.
    std::array<std::optional<JsonValue>, most_keys> values_;
    mutable std::size_t next_ = 0;  // the key that was asked for last; others follow in that order
};

// Leaves the value as it is where the key is missing.
template <class Value>
void read_if_there(const Members& members, std::string_view key, Value& value) {
    if (const std::optional<Node> member = members.optional(key)) read(*member, value);
}

// One of `words`, by its place among them; a message offers the first `offered` of them.
std::size_t one_of(const Node& node, Words words, std::size_t offered) {
    if (node.value.kind() == JsonKind::text) {
        std::string buffer;
        const auto word = std::find(words.begin(), words.end(), node.value.text(buffer));
        if (word != words.end()) return static_cast<std::size_t>(word - words.begin());
    }
    throw node.wrong_kind(listed(words.first(offered), "or"));
}

std::size_t one_of(const Node& node, Words words) { return one_of(node, words, words.size()); }

void read(const Node& node, double& number) {
    node.must_be(JsonKind::number, "a number");
    number = node.value.number();
}

void read(const Node& node, bool& flag) {
    node.must_be(JsonKind::boolean, "true or false");
    flag = node.value.boolean();
}

void read(const Node& node, std::string& text) {
    node.must_be(JsonKind::text, "a text");
    text = node.value.text();
}

void read(const Node& node, std::optional<std::string>& text) {
    node.must_be(JsonKind::text, "text");
    text = node.value.text();
}

void read(const Node& node, Vec3d& v) {
    constexpr std::string_view expected = "a list of three numbers";
    node.must_be(JsonKind::list, expected);
    if (node.value.items().size() != 3) throw node.wrong_kind(expected);
    std::size_t i = 0;
    for (const JsonValue item : node.value.items()) {
        read(Node{node.reading, item, &node, {}, i}, v[i]);
        ++i;
    }
}

template <class Item>
void read_list(const Node& node, std::string_view expected, std::vector<Item>& items) {
    node.must_be(JsonKind::list, expected);
    items.clear();
    items.reserve(node.value.items().size());
    for (const JsonValue item : node.value.items()) {
        node.reading.steps.take_one();
        const std::size_t i = items.size();
        read(Node{node.reading, item, &node, {}, i}, items.emplace_back());
    }
}

template <class Skeleton, class Value>
void read(const Node& node, const Member<Skeleton, Value>& member, Skeleton& skeleton) {
    if constexpr (std::is_same_v<Value, std::vector<Vec3d>>) {
        read_list(node, "a list of points, each a list of three numbers", skeleton.*member.value);
    } else {
        read(node, skeleton.*member.value);
    }
}

void read(const Node& node, KernelKind& kernel) {
    kernel = static_cast<KernelKind>(one_of(node, kernel_words));
}

void read(const Node& node, Camera& camera) {
    node.must_be(JsonKind::object, "an object with position and target");
    const Members members(node, camera_format);
    read(members.required("position"), camera.position);
    read(members.required("target"), camera.target);
    read_if_there(members, "up", camera.up);
    read_if_there(members, "fov", camera.fov);
    if (const auto projection = members.optional("projection")) {
        camera.projection = static_cast<Camera::Projection>(one_of(*projection, projection_words));
    }
    if (const auto height = members.optional("height")) read(*height, camera.height.emplace());
}

void read(const Node& node, std::optional<Camera>& camera) { read(node, camera.emplace()); }

void read(const Node& node, SavedView& view) {
    node.must_be(JsonKind::object, "an object with name and camera");
    const Members members(node, view_format);
    read(members.required("name"), view.name);
    read(members.required("camera"), view.camera);
}

void read(const Node& node, Light& light) {
    node.must_be(JsonKind::object, "an object with a direction");
    const Members members(node, light_format);
    read(members.required("direction"), light.direction);
    read_if_there(members, "color", light.color);
    read_if_there(members, "intensity", light.intensity);
    if (const auto attached = members.optional("attached")) {
        light.attached_to_camera = one_of(*attached, attachments) == 0;
    }
}

// One for all of it, or a list of one for each of so many places.
void read_widths(const Node& node, std::size_t places, Element& element) {
    const std::string expected = "a number or a list of " + std::to_string(places) + " numbers";
    if (node.value.kind() != JsonKind::list) {
        node.must_be(JsonKind::number, expected);
        element.width = node.value.number();
        return;
    }
    if (node.value.items().size() != places) throw node.wrong_kind(expected);
    std::size_t i = 0;
    for (const JsonValue item : node.value.items()) {
        read(Node{node.reading, item, &node, {}, i++}, element.widths.emplace_back());
    }
    element.width = *std::min_element(element.widths.begin(), element.widths.end());
}

template <class S>
void read_element(const Node& node, Element& element) {
    static_assert(keys_of_element<S>.size() < most_keys);
    const ObjectFormat format{word_with_article<S>, keys_of_element<S>, skeleton_keys<S>};
    const Members members(node, format);
    S& skeleton = element.skeleton.emplace<S>();
    for_members<S>(
        [&](const auto& member) { read(members.required(member.key), member, skeleton); });
    read_if_there(members, "name", element.name);
    read_if_there(members, "color", element.color);
    read_if_there(members, "kernel", element.kernel);
    read_if_there(members, "strength", element.strength);
    if constexpr (S::may_taper) {
        if (const auto width = members.optional("width"))
            read_widths(*width, skeleton.width_places(), element);
    } else {
        read_if_there(members, "width", element.width);
    }
    read_if_there(members, "visible", element.visible);
}

void read(const Node& node, Element& element) {
    node.must_be(JsonKind::object, "an object with a shape");
    const auto shape =
        static_cast<Shape>(one_of(node.required("shape", element_format), shape_words));
    with_shape(shape, [&]<class S>() { read_element<S>(node, element); });
}

void read(const Node& node, Scene& scene) {
    node.must_be(JsonKind::object, "an object with ivory, threshold and elements");

    // Before the keys: another version may have others.
    const Node version = node.required("ivory", scene_format);
    double number = 0;
    read(version, number);
    if (number != 1) {
        throw version.fault("the version of the format is " + version.value.description() +
                            "; it must be 1, the only one there is");
    }

    const Members members(node, scene_format);
    read(members.required("threshold"), scene.threshold);
    read_if_there(members, "background", scene.background);
    read_if_there(members, "camera", scene.camera);
    if (const auto views = members.optional("views")) {
        read_list(*views, "a list of views", scene.views);
    }
    if (const auto lights = members.optional("lights")) {
        read_list(*lights, "a list of lights", scene.lights.emplace());
    }
    read_list(members.required("elements"), "a list of elements", scene.elements);
}

// What the values say though each of them is what it has to be.
void throw_fault(const SourceText& source, const JsonDocument& document,
                 const std::optional<SceneFault>& fault) {
    if (!fault) return;
    const JsonValue value = nearest_to(document.root(), fault->pointer);
    throw source.fault(value.offset(), fault->pointer, fault->message);
}

}  // namespace

Scene read_scene(const std::filesystem::path& path, const Stop& stop) {
    return parse_scene(read_file(path, stop), file_label(path), stop);
}

Scene parse_scene(std::string_view text, const std::string& name, const Stop& stop) {
    const SourceText source(text, name);
    if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) {
        throw source.fault(0, "",
                           "the file is empty; the least scene is {\"ivory\": 1, \"threshold\": "
                           "0.5, \"elements\": []}");
    }
    const JsonDocument document = parse_json(source, stop);
    Reading reading{source, Steps(stop)};
    Scene scene;
    read(Node{reading, document.root()}, scene);
    throw_fault(source, document, find_fault(scene, stop));
    return scene;
}

Camera parse_camera(std::string_view text, const std::string& name) {
    const SourceText source(text, name);
    const JsonDocument document = parse_json(source);
    const Stop never;
    Reading reading{source, Steps(never)};
    Camera camera;
    read(Node{reading, document.root()}, camera);
    throw_fault(source, document, find_fault(camera));
    return camera;
}

}  // namespace ivory
