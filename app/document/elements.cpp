#include "app/document/elements.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <set>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <variant>
#include <vector>

#include "app/document/tidy.h"
#include "core/math/direction.h"
#include "core/scene/error.h"
#include "core/scene/text.h"

namespace ivory {

namespace {

// Linear; told apart by hue and by lightness, so that neighbours in the list differ to every eye.
constexpr std::array<Color, 8> palette = {{
    {0.90, 0.30, 0.05},
    {0.08, 0.38, 0.85},
    {0.93, 0.68, 0.10},
    {0.05, 0.55, 0.35},
    {0.75, 0.12, 0.35},
    {0.35, 0.75, 0.90},
    {0.40, 0.20, 0.70},
    {0.62, 0.78, 0.18},
}};

// "ring 2" -> "ring": the part before a number at its end.
std::string_view stem(std::string_view name) {
    std::size_t end = name.size();
    while (end > 0 && name[end - 1] >= '0' && name[end - 1] <= '9') --end;
    if (end == name.size() || end < 2 || name[end - 1] != ' ') return name;
    return name.substr(0, end - 1);
}

// The first of "STEM n", n = first, first + 1, ... that no element has.
std::string free_name(const std::vector<std::string>& names, std::string_view stem,
                      std::size_t first) {
    const std::set<std::string_view> taken(names.begin(), names.end());
    for (std::size_t n = first;; ++n) {
        std::string name = std::string(stem) + " " + std::to_string(n);
        if (!taken.contains(name)) return name;
    }
}

// Defaults follow the order of the list, so one may come to be what another element is called: that
// default is then written, with the next free number.
Scene with_distinct_names(Scene scene) {
    const std::vector<std::string> names = element_names(scene);
    std::unordered_map<std::string_view, int> uses;
    for (const std::string& name : names) ++uses[name];
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (scene.elements[i].name || uses[names[i]] < 2) continue;
        scene.elements[i].name =
            free_name(element_names(scene), shape_word(scene.elements[i].skeleton), 2);
    }
    return scene;
}

void include(Box3& box, const Vec3d& place, double margin) {
    const Vec3d all{margin, margin, margin};
    box.include({place - all, place + all});
}

}  // namespace

Element new_element(ElementShape shape, Vec3d place, double size, std::size_t elements_before) {
    const int exponent = exponent_above(size / 100);
    const Vec3d at{tidy(place.x, exponent), tidy(place.y, exponent), tidy(place.z, exponent)};
    Element element;
    switch (shape) {
        case ElementShape::point:
            element.skeleton = PointSkeleton{at};
            break;
        case ElementShape::segment:
            element.skeleton = SegmentSkeleton{{tidy(at.x - size, exponent), at.y, at.z},
                                               {tidy(at.x + size, exponent), at.y, at.z}};
            break;
        case ElementShape::circle:
            element.skeleton = CircleSkeleton{at, {0, 0, 1}, tidy(1.5 * size, exponent)};
            break;
    }
    element.color = palette[elements_before % palette.size()];
    element.width = size;
    return element;
}

Scene with_element(Scene scene, Element element) {
    scene.elements.push_back(std::move(element));
    return with_distinct_names(std::move(scene));
}

Scene without_element(Scene scene, std::size_t element) {
    scene.elements.erase(scene.elements.begin() + static_cast<std::ptrdiff_t>(element));
    return with_distinct_names(std::move(scene));
}

Scene with_copy(Scene scene, std::size_t element) {
    Element copy = scene.elements[element];
    if (copy.name) {
        const std::string_view base = stem(*copy.name);
        copy.name = free_name(element_names(scene), base, 2);
    }
    scene.elements.insert(scene.elements.begin() + static_cast<std::ptrdiff_t>(element) + 1,
                          std::move(copy));
    return with_distinct_names(std::move(scene));
}

Scene with_element_moved(Scene scene, std::size_t element, std::size_t to) {
    const auto at = [&](std::size_t i) {
        return scene.elements.begin() + static_cast<std::ptrdiff_t>(i);
    };
    if (element < to) std::rotate(at(element), at(element) + 1, at(to) + 1);
    if (to < element) std::rotate(at(to), at(element), at(element) + 1);
    return with_distinct_names(std::move(scene));
}

Scene with_name(Scene scene, std::size_t element, const std::string& name) {
    scene.elements[element].name.reset();
    if (name.empty()) return with_distinct_names(std::move(scene));
    const std::vector<std::string> names = element_names(scene);
    if (name == names[element]) return with_distinct_names(std::move(scene));
    if (std::find(names.begin(), names.end(), name) != names.end())
        throw Error("another element is called " + in_quotes(name) +
                    "; each element must have a name of its own");
    scene.elements[element].name = name;
    return scene;
}

Box3 box_around(const Element& element) {
    Box3 box;
    if (const auto* point = std::get_if<PointSkeleton>(&element.skeleton))
        include(box, point->position, element.width);
    if (const auto* segment = std::get_if<SegmentSkeleton>(&element.skeleton)) {
        include(box, segment->a, element.width);
        include(box, segment->b, element.width);
    }
    if (const auto* circle = std::get_if<CircleSkeleton>(&element.skeleton)) {
        // A circle of unit normal n reaches r sqrt(1 - n_k^2) along axis k.
        const Vec3d n = unit(circle->normal);
        const auto extent = [&](double n_k) {
            return circle->radius * std::sqrt(std::max(0.0, 1 - n_k * n_k)) + element.width;
        };
        const Vec3d half{extent(n.x), extent(n.y), extent(n.z)};
        box.include({circle->center - half, circle->center + half});
    }
    return box;
}

}  // namespace ivory
