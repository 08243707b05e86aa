// What the renderer says of the picture on the screen. Written by app/viewer, read by everyone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>

#include "app/platform/window_rect.h"
#include "core/scene/scene.h"

namespace ivory {

struct PictureState {
    // The picture that is shown: one scene, one camera, one size; never a mixture. Null before the
    // first one. While an edit's picture is on its way this still is the old one.
    std::shared_ptr<const Scene> scene;
    Camera camera;
    WindowSize size;

    bool final =
        false;  // it is the wanted scene's, and no work is left: the bytes of `ivory render`
    double progress = 0;            // of the wanted picture: share of its pixels traced, 0..1
    double milliseconds = 0;        // from the edit until now, or until it was final
    double first_milliseconds = 0;  // from the edit to its first complete (coarse) picture
    int threads = 0;
    std::uint64_t hit = 0, miss = 0, unresolved = 0;  // pixels traced so far
    std::uint64_t tiles = 0, tiles_traced = 0;        // of the wanted picture
    bool surface_certainly_empty = false;             // proved: the wanted scene has no surface

    std::string
        fault;  // one line: why there is no picture of the wanted scene; empty: there is, or will be

    // Row by row from the top: distance along the unit primary ray, from the camera's position or
    // from an orthographic camera's plane, +inf where nothing is hit; blocks of equal values while it is coarse. Valid until the frame's end.
    std::span<const float> depth;
    // +inf outside of the picture too; `at` counts from the picture's top left.
    [[nodiscard]] float depth_at(WindowPoint at) const {
        if (!WindowRect{0, 0, size.width, size.height}.contains(at))
            return std::numeric_limits<float>::infinity();
        return depth[static_cast<std::size_t>(at.y) * static_cast<std::size_t>(size.width) +
                     static_cast<std::size_t>(at.x)];
    }
};

}  // namespace ivory
