#include "tests/reference/scene.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

namespace ivory::reference {

namespace {

using Json = nlohmann::json;

[[noreturn]] void fail(const std::string& what) { throw std::runtime_error(what); }

// The members of one element, each of which has to be asked for.
class Members {
  public:
    explicit Members(const Json& object) : object_(object) {
        if (!object.is_object()) fail("not an object");
    }

    const Json* find(const char* key) {
        asked_.emplace_back(key);
        const auto found = object_.find(key);
        return found == object_.end() ? nullptr : &*found;
    }
    const Json& at(const char* key) {
        const Json* found = find(key);
        if (found == nullptr) fail(std::string(key) + ": missing");
        return *found;
    }
    void expect_no_others() const {
        for (const auto& [key, value] : object_.items()) {
            if (std::find(asked_.begin(), asked_.end(), key) == asked_.end()) {
                fail(key + ": unknown key");
            }
        }
    }

  private:
    const Json& object_;
    std::vector<std::string> asked_;
};

double number(const Json& json) {
    if (!json.is_number()) fail(json.dump() + ": not a number");
    const auto x = json.get<double>();
    if (!std::isfinite(x)) fail("not a finite number");
    return x;
}

double positive(const Json& json) {
    const double x = number(json);
    if (!(x > 0)) fail(json.dump() + ": not greater than 0");
    return x;
}

Vec3d vector(const Json& json) {
    if (!json.is_array() || json.size() != 3) fail(json.dump() + ": not three numbers");
    return {number(json[0]), number(json[1]), number(json[2])};
}

std::vector<Vec3d> vectors(const Json& json, std::size_t least, std::size_t most) {
    if (!json.is_array() || json.size() < least || json.size() > most) {
        fail("not the right number of points");
    }
    std::vector<Vec3d> all;
    for (const Json& one : json) all.push_back(vector(one));
    return all;
}

double radius(const Json& json) {
    const double x = number(json);
    if (x < 0) fail(json.dump() + ": less than 0");
    return x;
}

Vec3d normal(const Json& json) {
    const Vec3d n = vector(json);
    if (n == Vec3d{0, 0, 0}) fail("normal: no direction");
    return n;
}

constexpr std::size_t any_number = static_cast<std::size_t>(-1);

Skeleton skeleton_of(Members& members) {
    const Json& shape = members.at("shape");
    if (shape == "point") return Point{vector(members.at("position"))};
    if (shape == "segment") return Segment{vector(members.at("a")), vector(members.at("b"))};
    if (shape == "polygon") return Polygon{vectors(members.at("vertices"), 3, any_number)};
    if (shape == "curve") return Curve{vectors(members.at("control_points"), 3, 4)};
    if (shape == "polyline") return Polyline{vectors(members.at("points"), 2, any_number)};
    if (shape != "circle" && shape != "disc") fail(shape.dump() + ": not a shape");
    const Vec3d center = vector(members.at("center")), axis = normal(members.at("normal"));
    const double r = radius(members.at("radius"));
    if (shape == "circle") return Circle{center, axis, r};
    return Disc{center, axis, r};
}

Kernel kernel_of(const Json& json) {
    if (json == "blinn") return Kernel::blinn;
    if (json == "nishimura") return Kernel::nishimura;
    if (json == "wyvill") return Kernel::wyvill;
    if (json == "murakami") return Kernel::murakami;
    if (json == "blobtree") return Kernel::blobtree;
    fail(json.dump() + ": not a kernel");
}

void read_width(const Json& json, Element& element) {
    if (!json.is_array()) {
        element.width = positive(json);
        return;
    }
    std::size_t places = 0;
    if (std::holds_alternative<Segment>(element.skeleton)) places = 2;
    if (const auto* chain = std::get_if<Polyline>(&element.skeleton)) places = chain->points.size();
    if (places == 0 || json.size() != places) fail("width: not one number for each point");
    for (const Json& one : json) element.widths.push_back(positive(one));
    element.width = *std::min_element(element.widths.begin(), element.widths.end());
}

Element element_of(const Json& json) {
    Members members(json);
    Element element;
    element.skeleton = skeleton_of(members);
    if (const Json* kernel = members.find("kernel")) element.kernel = kernel_of(*kernel);
    if (const Json* strength = members.find("strength")) element.strength = number(*strength);
    if (element.strength == 0) fail("strength: 0");
    if (const Json* width = members.find("width")) read_width(*width, element);
    if (const Json* color = members.find("color")) element.color = vector(*color);
    if (const Json* visible = members.find("visible")) element.visible = visible->get<bool>();
    members.find("name");
    members.expect_no_others();
    return element;
}

}  // namespace

const Vec3d& first_place(const Skeleton& skeleton) {
    struct Visit {
        const Vec3d& operator()(const Point& s) const { return s.position; }
        const Vec3d& operator()(const Segment& s) const { return s.a; }
        const Vec3d& operator()(const Circle& s) const { return s.center; }
        const Vec3d& operator()(const Disc& s) const { return s.center; }
        const Vec3d& operator()(const Polygon& s) const { return s.vertices.front(); }
        const Vec3d& operator()(const Curve& s) const { return s.control_points.front(); }
        const Vec3d& operator()(const Polyline& s) const { return s.points.front(); }
    };
    return std::visit(Visit{}, skeleton);
}

double Element::greatest_width() const {
    return widths.empty() ? width : *std::max_element(widths.begin(), widths.end());
}

ReferenceScene parse_reference_scene(std::string_view text) {
    ReferenceScene scene;
    std::string place = "scene";
    try {
        const Json json = Json::parse(text);
        if (json.at("ivory") != 1) fail("ivory: not 1");
        scene.threshold = positive(json.at("threshold"));
        const Json& elements = json.at("elements");
        if (!elements.is_array()) fail("elements: not a list");
        for (const Json& element : elements) {
            place = "elements[" + std::to_string(scene.elements.size()) + "]";
            scene.elements.push_back(element_of(element));
        }
    } catch (const std::exception& error) {
        fail(place + ": " + error.what());
    }
    return scene;
}

ReferenceScene read_reference_scene(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    if (!in) fail(path.string() + ": cannot be read");
    try {
        return parse_reference_scene(text);
    } catch (const std::runtime_error& error) {
        fail(path.string() + ": " + error.what());
    }
}

}  // namespace ivory::reference
