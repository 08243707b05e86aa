// Changes of the list of elements, each a scene in and a scene out that is valid again: no two
// elements share a name, defaults included.
#pragma once

#include <cstddef>
#include <string>

#include "core/math/box3.h"
#include "core/scene/scene.h"

namespace ivory {

// At the end of the list.
[[nodiscard]] Scene with_element(Scene scene, Element element);
[[nodiscard]] Scene without_element(Scene scene, std::size_t element);
// The copy comes after the original and is the same but for its name.
[[nodiscard]] Scene with_copy(Scene scene, std::size_t element);
// `element` goes to place `to` of the list, the others close up.
[[nodiscard]] Scene with_element_moved(Scene scene, std::size_t element, std::size_t to);

// An empty name, or the default one, stands for the default. Throws Error, one line, where another
// element has that name.
[[nodiscard]] Scene with_name(Scene scene, std::size_t element, const std::string& name);

// A place more in the element's list of them, after number i: half way to the next, or as far beyond the
// last one as the one before it is from there; with a width between its neighbours'. And one less.
// Elements without such a list stay as they are.
void insert_place(Element& element, std::size_t i);
void remove_place(Element& element, std::size_t i);

// The skeleton and one width around it.
[[nodiscard]] Box3 box_around(const Element& element);

}  // namespace ivory
