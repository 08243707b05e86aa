// Whether an edit changes the picture at all: a name does not, nor does what is hidden.
#pragma once

#include "core/scene/scene.h"

namespace ivory {

// All but their names; of hidden elements nothing is looked at.
[[nodiscard]] bool looks_the_same(const Element& a, const Element& b);

// Whether `ivory render` draws the same bytes of both from any camera: threshold, background,
// lights and the visible elements in their order. Order counts: sums of several fields depend on it
// in their last bits. The scenes' own cameras are not looked at.
[[nodiscard]] bool same_picture(const Scene& a, const Scene& b);

}  // namespace ivory
