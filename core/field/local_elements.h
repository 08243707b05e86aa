// Elements as floats: all that the bounds of core/field/bundle_steps.h ask for, side by side.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/field/groups.h"

namespace ivory {

// As structure of arrays sorted by group. Lengths in units (Field::unit), relative to a place
// nearby; strengths times Field::scale.
struct LocalElements {
    GroupStarts first{};
    std::vector<std::int32_t> element;  // indices into Field
    std::vector<std::int32_t> source;   // likewise of what is joined: Field::source
    // As Field and BundleEntry have them; the bounds as ActiveElements.
    std::vector<float> x, y, z, strength, inverse_square, mx, my, mz, parameter, length, taper_rate;
    std::vector<float> least, most, peak, whole, inverse;
    // No place is off by more than 2^-23 of this beside its own rounding.
    float magnitude = 0;
    PartNumbers<float> numbers;  // of the field's elements

    static constexpr std::size_t room = 32;  // vectors are read and written whole

    [[nodiscard]] std::size_t size() const { return first.size(); }
    void make_room(std::size_t count);
    friend bool operator==(const LocalElements&, const LocalElements&) = default;
};

}  // namespace ivory
