// The directions of primary rays (core/render/camera.h) for many pixels at a time in SIMD. Nothing
// is fused: every instruction set gives the same doubles.
#pragma once

#include <cstddef>

#include "core/render/camera.h"

namespace ivory {

// primary_ray(view, width, height, i[k], j[k]).direction for k < count, to the bit. The arrays have
// room for the next multiple of 8.
void primary_directions(const View& view, int width, int height, std::size_t count, const double* i,
                        const double* j, double* dx, double* dy, double* dz);

}  // namespace ivory
