// Changes of the list of elements, each a scene in and a scene out that is valid again: no two
// elements share a name, defaults included.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "core/math/box3.h"
#include "core/scene/scene.h"

namespace ivory {

enum class ElementShape : std::uint8_t { point, segment, circle };

// A new element around a place of the scene, `size` being its width: a segment of twice that
// length, a circle of 1.5 times that radius. Its coordinates are multiples of a power of ten near
// size / 50, and its colour differs from those of the elements before it.
[[nodiscard]] Element new_element(ElementShape shape, Vec3d place, double size,
                                  std::size_t elements_before);

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

// The skeleton and one width around it.
[[nodiscard]] Box3 box_around(const Element& element);

}  // namespace ivory
