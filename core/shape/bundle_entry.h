// One element as the inner loops of packets want it.
#pragma once

#include <cstring>

namespace ivory {

// c: the skeleton's first place, relative to the window's. `away` is what leads from the skeleton's
// nearest point to p; m and parameter are what the shape's file says of them.
template <class Real>
struct BundleEntry {
    Real cx, cy, cz;
    Real inverse_square;  // 1 / w^2, times the kernel's argument_scale
    Real strength;        // b
    // 2 b / w^2, with the kernel's slope_sign: F' = slope dk away . d; 0 where it counts as an error
    // instead
    Real slope;
    Real taper_rate;             // of tapers (core/shape/taper.h); else `proof`
    Real joins;                  // not 0: the next entry is another part of the same element
    Real mx, my, mz, parameter;  // not of points

    // Not 0 where nothing is known of the feet on the window, and each ray's has to be proved by itself: at
    // least 2 |b k'| / w^2 there (core/shape/shape_lanes.inl, ProvedFoot).
    [[nodiscard]] Real proof() const { return taper_rate; }

    // Of what has numbers: where they are, in the place of m.
    [[nodiscard]] const Real* numbers() const {
        const Real* at = nullptr;
        std::memcpy(&at, &mx, sizeof at);
        return at;
    }
    void set_numbers(const Real* at) { std::memcpy(&mx, &at, sizeof at); }
};

}  // namespace ivory
