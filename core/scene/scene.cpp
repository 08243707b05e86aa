#include "core/scene/scene.h"

#include <array>
#include <utility>

namespace ivory {

std::string DefaultNames::next(const Skeleton& skeleton) {
    const std::size_t number = ++count_[skeleton.index()];
    return shape_word(skeleton) + (" " + std::to_string(number));
}

std::vector<std::string> element_names(const Scene& scene) {
    std::vector<std::string> names;
    names.reserve(scene.elements.size());
    DefaultNames defaults;
    for (const Element& element : scene.elements) {
        std::string by_default = defaults.next(element.skeleton);
        names.push_back(element.name ? *element.name : std::move(by_default));
    }
    return names;
}

std::vector<Light> default_lights() {
    const Light head{
        .direction = {0, 0, 1}, .color = {1, 1, 1}, .intensity = 0.35, .attached_to_camera = true};
    const Light key{.direction = {-0.4, 0.6, 0.7},
                    .color = {1, 1, 1},
                    .intensity = 0.8,
                    .attached_to_camera = true};
    return {head, key};
}

}  // namespace ivory
