#include "app/document/elements.h"

#include <algorithm>
#include <cstddef>
#include <set>
#include <string_view>
#include <type_traits>
#include <unordered_map>
#include <utility>
#include <variant>
#include <vector>

#include "core/scene/error.h"
#include "core/scene/text.h"

namespace ivory {

namespace {

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

}  // namespace

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

namespace {

// visit(member, list) of the lists of places of the element's skeleton.
template <class Visit>
void for_places(Element& element, const Visit& visit) {
    std::visit(
        [&]<class S>(S& skeleton) {
            for_members<S>([&]<class Value>(const Member<S, Value>& member) {
                if constexpr (std::is_same_v<Value, std::vector<Vec3d>>) {
                    visit(member, skeleton.*member.value);
                }
            });
        },
        element.skeleton);
}

std::ptrdiff_t after(std::size_t i) { return static_cast<std::ptrdiff_t>(i) + 1; }

}  // namespace

void insert_place(Element& element, std::size_t i) {
    for_places(element, [&](const auto&, std::vector<Vec3d>& places) {
        if (i >= places.size()) return;
        const bool closes = std::holds_alternative<PolygonSkeleton>(element.skeleton);
        const bool is_last = i + 1 == places.size() && !closes;
        const Vec3d& here = places[i];
        const Vec3d& other = places[is_last ? i - 1 : (i + 1) % places.size()];
        const Vec3d place = is_last ? here + (here - other) : 0.5 * here + 0.5 * other;
        std::vector<double>& widths = element.widths;
        if (widths.size() == places.size()) {
            const double width = is_last ? widths[i] : 0.5 * (widths[i] + widths[i + 1]);
            widths.insert(widths.begin() + after(i), width);
        }
        places.insert(places.begin() + after(i), place);
    });
}

void remove_place(Element& element, std::size_t i) {
    for_places(element, [&](const auto& member, std::vector<Vec3d>& places) {
        if (i >= places.size() || places.size() <= member.least) return;
        std::vector<double>& widths = element.widths;
        if (widths.size() == places.size()) {
            widths.erase(widths.begin() + after(i) - 1);
            element.width = *std::min_element(widths.begin(), widths.end());
        }
        places.erase(places.begin() + after(i) - 1);
    });
}

Box3 box_around(const Element& element) {
    return with_shape(shape_of_skeleton(element.skeleton), [&]<class S>() {
        const S& skeleton = std::get<S>(element.skeleton);
        const double width = element.widths.empty()
                                 ? element.width
                                 : *std::max_element(element.widths.begin(), element.widths.end());
        Box3 box;
        for (const SkeletonPart& part : parts_of(skeleton)) {
            const SkeletonColumns columns = part.seen();
            for (std::size_t axis = 0; axis < 3; ++axis) {
                Vec3d up;
                up[axis] = 1;
                box.lo[axis] = std::min(box.lo[axis], S::farthest(columns, {}, -up)[axis] - width);
                box.hi[axis] = std::max(box.hi[axis], S::farthest(columns, {}, up)[axis] + width);
            }
        }
        return box;
    });
}

}  // namespace ivory
