#include "app/document/elements.h"

#include <algorithm>
#include <cstddef>
#include <set>
#include <string_view>
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

Box3 box_around(const Element& element) {
    return with_shape(shape_of_skeleton(element.skeleton), [&]<class S>() {
        const SkeletonColumns columns = std::get<S>(element.skeleton).columns();
        Box3 box;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            Vec3d up;
            up[axis] = 1;
            box.lo[axis] = S::farthest(columns, {}, -up)[axis] - element.width;
            box.hi[axis] = S::farthest(columns, {}, up)[axis] + element.width;
        }
        return box;
    });
}

}  // namespace ivory
