// What is left out of the work because it is proved not to matter. Each kind can be turned off, to
// see what it saves and that no answer rests on it.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace ivory {

struct Skipping {
    bool lists = true;    // of elements, for each region, block and tile; with them empty tiles
    bool windows = true;  // stretches of t on which the peaks do not add up to T
    bool parts = true;    // shorter lists for 8 x 8 and 4 x 4 pixels of a tile
    bool coarse = true;   // float where float decides
    bool packets = true;  // many rays at a time
    friend bool operator==(const Skipping&, const Skipping&) = default;
};

struct SkippingName {
    std::string_view name;
    bool Skipping::*member;
};

inline constexpr std::array<SkippingName, 5> skipping_names{{{"lists", &Skipping::lists},
                                                             {"windows", &Skipping::windows},
                                                             {"parts", &Skipping::parts},
                                                             {"coarse", &Skipping::coarse},
                                                             {"packets", &Skipping::packets}}};

// How much of it there was.
struct SkippingCounts {
    std::uint64_t list_elements = 0, list_left_out = 0;  // tested for a list; of these, not in it
    std::uint64_t stretches = 0, stretches_ended = 0;    // bounded; ended by the sum of peaks
    std::uint64_t windows = 0;                           // in which rays were walked
    std::uint64_t rays = 0;                              // in packets
    std::uint64_t rays_alone = 0;  // traced one at a time, after a packet or without one

    SkippingCounts& operator+=(const SkippingCounts& other) {
        list_elements += other.list_elements;
        list_left_out += other.list_left_out;
        stretches += other.stretches;
        stretches_ended += other.stretches_ended;
        windows += other.windows;
        rays += other.rays;
        rays_alone += other.rays_alone;
        return *this;
    }
};

}  // namespace ivory
