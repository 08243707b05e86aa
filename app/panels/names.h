// The names of the elements, and the elements by their names.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "app/panels/viewer_state.h"

namespace ivory {

// element_names of the document's scene, kept from frame to frame.
[[nodiscard]] const std::vector<std::string>& names_of(ViewerState& state);
// The element that has that name, by its place in the list.
[[nodiscard]] std::optional<std::size_t> place_of(ViewerState& state, const std::string& name);

}  // namespace ivory
