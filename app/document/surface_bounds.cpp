#include "app/document/surface_bounds.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "core/field/field.h"

namespace ivory {

namespace {

constexpr std::size_t most_changed = 32;

std::size_t count_positive(const Scene& scene) {
    return static_cast<std::size_t>(std::count_if(
        scene.elements.begin(), scene.elements.end(),
        [](const Element& element) { return element.visible && element.strength > 0; }));
}

// The elements of `after` that are others; nothing where there are too many, or where what the rest
// reaches may have become more: T/n is less.
std::optional<std::vector<Element>> changed_elements(const Scene& before, const Scene& after) {
    if (before.elements.size() != after.elements.size() || after.threshold < before.threshold ||
        count_positive(after) > count_positive(before))
        return std::nullopt;
    std::vector<Element> changed;
    for (std::size_t i = 0; i < after.elements.size(); ++i) {
        if (after.elements[i] == before.elements[i]) continue;
        if (changed.size() == most_changed) return std::nullopt;
        changed.push_back(after.elements[i]);
    }
    return changed;
}

// Around what these elements of a scene reach alone: where n elements are positive, all of {f >= 0} is
// where some F_i >= T/n (core/field/bounding_box.h). As a scene of their own, m of them positive, they
// get a threshold of at most T m/n, so that T/n is the same or less.
Box3 reach_of(std::vector<Element> elements, const Scene& of) {
    Scene part;
    part.elements = std::move(elements);
    const auto m = static_cast<double>(count_positive(part));
    if (m == 0) return {};
    constexpr double rounded_down = 1 - 0x1p-48;
    part.threshold = of.threshold * m / static_cast<double>(count_positive(of)) * rounded_down;
    return compile(part).reach_box;
}

}  // namespace

const Box3* SurfaceBounds::quickly_around(const SceneValue& scene) {
    if (!scene_) return nullptr;
    if (scene_ == scene) return &box_;
    auto changed = changed_elements(*scene_, *scene);
    if (!changed) return nullptr;
    scene_ = scene;
    if (!changed->empty()) reach_.include(reach_of(std::move(*changed), *scene));
    box_ = reach_;
    return &box_;
}

const Box3& SurfaceBounds::around(const SceneValue& scene) {
    if (const Box3* const box = quickly_around(scene)) return *box;
    const Field field = compile(*scene);
    scene_ = scene;
    box_ = field.box;
    reach_ = field.reach_box;
    return box_;
}

}  // namespace ivory
