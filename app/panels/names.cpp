#include "app/panels/names.h"

#include "app/panels/shown_text.h"
#include "core/scene/scene.h"

namespace ivory {

const std::vector<std::string>& names_of(ViewerState& state) {
    PanelMemory& memory = state.panels;
    if (memory.named == state.document.scene_value()) return memory.names;
    // a drag renames nothing; when it has ended, the scene is looked at once
    const bool same = memory.named && state.document.dragging() &&
                      memory.names.size() == state.document.scene().elements.size();
    if (same) return memory.names;
    memory.named = state.document.scene_value();
    memory.names = element_names(*memory.named);
    memory.places.clear();
    for (const std::string& name : memory.names) want_glyphs(state, name);
    return memory.names;
}

std::optional<std::size_t> place_of(ViewerState& state, const std::string& name) {
    const std::vector<std::string>& names = names_of(state);
    auto& places = state.panels.places;
    if (places.empty())
        for (std::size_t i = 0; i < names.size(); ++i) places.emplace(names[i], i);
    const auto found = places.find(name);
    if (found == places.end()) return std::nullopt;
    return found->second;
}

}  // namespace ivory
