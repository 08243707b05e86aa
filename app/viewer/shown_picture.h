// What is asked of the session and what it gives: a request, the bytes on the screen, and which of
// them have changed.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <vector>

#include "app/platform/window_rect.h"
#include "core/render/frame.h"
#include "core/render/tiles.h"
#include "core/scene/scene.h"

namespace ivory {

struct PictureRequest {
    std::shared_ptr<const Scene> scene;  // its own camera is not looked at
    Camera camera;
    WindowSize size;                   // at least 1 x 1
    std::optional<WindowPoint> focus;  // in the picture: what is refined first; none: the middle
    std::chrono::steady_clock::time_point since;  // when the edit was made
};

// The bytes on the screen, row by row from the top.
struct ShownPicture {
    WindowSize size;
    std::vector<Rgba8> color;
    std::vector<float> depth;  // see PictureState
};

// What `poll` changed in the shown picture.
struct PictureChange {
    bool replaced = false;         // the picture of another scene, camera or size than before
    bool all = false;              // another size: everything
    std::vector<PixelRect> tiles;  // otherwise: these tiles and no other pixel
    [[nodiscard]] bool any() const { return all || !tiles.empty(); }
};

}  // namespace ivory
