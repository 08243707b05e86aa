// The views that a scene keeps: each change of the list is an edit of the scene, to choose one is a move
// of the camera.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "app/panels/viewer_state.h"

namespace ivory {

// Its place in the list.
[[nodiscard]] std::optional<std::size_t> find_view(const std::vector<SavedView>& views,
                                                   const std::string& name);

// The view that is seen, under a name that no other has; it is the chosen one then.
void keep_view(ViewerState& state);

// Nothing where no view has that name.
void choose_view(ViewerState& state, const std::string& name);
// A name that is empty, or another's, is refused with a message.
void rename_view(ViewerState& state, const std::string& name, const std::string& to);
// It becomes what is seen.
void replace_view(ViewerState& state, const std::string& name);
void delete_view(ViewerState& state, const std::string& name);

}  // namespace ivory
