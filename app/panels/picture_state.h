// What the renderer says of the picture on the screen. Written by app/viewer, read by everyone.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>

#include "app/platform/window_rect.h"
#include "core/render/tiles.h"
#include "core/scene/scene.h"

namespace ivory {

// Distance from the camera's position along the unit primary ray, +inf where nothing is hit: as in
// ShownPicture, which it looks into.
struct DepthMap {
    std::span<const float> pixels;       // rows from the top
    std::span<const std::uint8_t> fine;  // by tile: 1, or 0 where `coarse` tells
    std::span<const float> coarse;       // of fewer pixels, rows from the top
    WindowSize coarse_size;

    // At a place in a picture of that size.
    [[nodiscard]] float at(WindowSize size, WindowPoint place) const {
        const int i = static_cast<int>(place.x), j = static_cast<int>(place.y);
        if (fine[TileGrid(size.width, size.height).tiles.at(i, j)] != 0)
            return pixels[static_cast<std::size_t>(j) * static_cast<std::size_t>(size.width) +
                          static_cast<std::size_t>(i)];
        // both pictures have the same middle and the same height
        const double share = static_cast<double>(coarse_size.height) / size.height;
        const auto clamped = [](double pixel, int count) {
            return static_cast<std::size_t>(std::clamp(static_cast<int>(pixel), 0, count - 1));
        };
        const std::size_t column = clamped(
            0.5 * coarse_size.width + share * (place.x - 0.5 * size.width), coarse_size.width);
        const std::size_t row = clamped(share * place.y, coarse_size.height);
        return coarse[row * static_cast<std::size_t>(coarse_size.width) + column];
    }
};

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
    double first_milliseconds = 0;  // from the edit until a picture of it was shown, fine or coarse
    int threads = 0;
    std::uint64_t hit = 0, miss = 0, unresolved = 0;  // pixels traced so far
    std::uint64_t tiles = 0, tiles_traced = 0;        // of the wanted picture
    bool surface_certainly_empty = false;             // proved: the wanted scene has no surface

    std::string
        fault;  // one line: why there is no final picture of the wanted scene; empty: there will be

    // So many of the window's pixels a side are covered by one of the picture that is shown, but for
    // the share of its tiles that show every pixel. 1 and 1: all of them do.
    double resolution = 1;
    double fine = 1;

    // Of the picture that is shown: distance along the unit primary ray, from the camera's position
    // or from an orthographic camera's plane; valid until the frame's end.
    DepthMap depth;
    // +inf outside of the picture too; `at` counts from the picture's top left.
    [[nodiscard]] float depth_at(WindowPoint at) const {
        if (!WindowRect{0, 0, size.width, size.height}.contains(at))
            return std::numeric_limits<float>::infinity();
        return depth.at(size, at);
    }
};

}  // namespace ivory
