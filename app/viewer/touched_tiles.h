// Which tiles of a picture an edit can change so that anyone sees it: those that look through the
// reach of an element that was changed, before or after. What lies farther off keeps its pixels
// until the hand rests.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "app/platform/window_rect.h"
#include "core/render/camera.h"
#include "core/scene/scene.h"

namespace ivory {

// The bundle of rays of one tile: all within `angle` of `axis`. Of an orthographic picture they begin
// within `radius` > 0 of eye + from_eye instead, side by side.
struct TileDirection {
    Vec3d axis;  // unit length
    double angle = 0;
    Vec3d from_eye{};
    double radius = 0;
};

[[nodiscard]] std::vector<TileDirection> tile_directions(const View& view, WindowSize size);

// Not 0 for each tile that is touched, in the order of the tiles; nothing where every tile may be:
// another threshold, or many elements changed. Names, cameras, lights and background are not looked
// at, and one element that has gone to another place of the list touches none.
//
// Reach: where |F| > 1e-6 T. It is a matter of sight, not of proof: the session traces the other
// tiles too before it calls a picture final.
[[nodiscard]] std::optional<std::vector<std::uint8_t>> touched_tiles(
    const Scene& before, const Scene& after, const Vec3d& eye,  // the camera's position
    const std::vector<TileDirection>& tiles);

}  // namespace ivory
