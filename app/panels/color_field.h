// A colour of the scene, to choose or to type in: linear within, sRGB to the eye.
#pragma once

#include <functional>
#include <string>

#include "app/panels/viewer_state.h"

namespace ivory {

// A swatch; a click opens a picker of sRGB, its digits ID.hex and the linear numbers ID.r, ID.g and
// ID.b.
void color_field(ViewerState& state, const std::string& id, const std::string& what,
                 const Color& value, float width,
                 const std::function<void(Scene&, const Color&)>& set);

}  // namespace ivory
