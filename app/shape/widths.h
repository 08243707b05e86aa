// The widths of what tapers, in the hand: a handle stands one width away from each place.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "app/shape/shape_in_hand.h"
#include "core/math/vec3.h"
#include "core/scene/scene.h"

namespace ivory {

// Of the place with that number, from 0 on.
[[nodiscard]] double width_at(const Element& element, std::size_t place);

// One width for all of it becomes a list, or a list one width, the least: f is the same as before where
// they were all alike. Elements whose width cannot taper stay as they are.
void set_tapers(Element& element, bool tapers);
[[nodiscard]] bool can_taper(const Element& element);

// "1", "2", ... and their handles at these places; what a handle of that name is the number of.
[[nodiscard]] std::vector<std::string> numbers_of(std::size_t count);
[[nodiscard]] std::vector<Grip> numbered_grips(std::span<const Vec3d> places,
                                               std::string_view part_prefix);
[[nodiscard]] std::optional<std::size_t> number_named(std::string_view handle, std::size_t count);

// Of an element with a list of widths: `width 1` and so on, out of the handles `arms` at the places of
// the chain.
void add_width_grips(const Element& element, const HandView& view, std::span<const Vec3d> chain,
                     const std::vector<std::string>& arms, std::vector<Grip>& grips);
[[nodiscard]] std::optional<std::size_t> width_named(const Element& element,
                                                     std::string_view handle);
// False: the pointer meets nothing.
[[nodiscard]] bool move_width(Element& element, std::size_t place, const HandView& view,
                              std::span<const Vec3d> chain, const HandleMotion& motion);

}  // namespace ivory
