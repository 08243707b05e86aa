// A proved bounding box of the solid {f >= 0}.
// With n elements of positive strength, a point where every F_i < T/n is outside. So the solid lies
// in the union of the balls d_i <= reach_i, b_i k((reach_i / w_i)^2) <= T/n. Negative strengths
// only shrink it.
#pragma once

#include "core/field/field.h"
#include "core/math/box3.h"

namespace ivory {

// The reach of element i among `positive` elements of positive strength, in scene units, rounded
// up; below 0 where the element needs no ball: its field stays below T/n everywhere, or carves.
[[nodiscard]] double reach(const Field& field, std::size_t i, std::size_t positive);

// How many elements have positive strength.
[[nodiscard]] std::size_t count_positive(const Field& field);

// The box around the skeleton of element i, rounded outward.
[[nodiscard]] Box3 skeleton_box(const Field& field, std::size_t i);

// The box around all the balls; empty where there is none, and then so is the surface.
[[nodiscard]] Box3 box_of_reach(const Field& field);

// The part of `box` that is left when slabs along its faces where f < 0 certainly holds are taken
// away. `box` has to hold the solid. Does nothing for more than 512 elements: tiles skip empty
// space then.
[[nodiscard]] Box3 shrunk_box(const Field& field, const Box3& box);

}  // namespace ivory
