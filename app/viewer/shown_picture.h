// What is asked of the session and what it gives: a request, what is on the screen, and what of it
// has changed.
#pragma once

#include <chrono>
#include <cstdint>
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
    // When a first picture is wanted: one of every pixel if that can be done until then, else one of
    // so many that it can.
    std::chrono::steady_clock::time_point due;
    int samples = 1;  // a pixel, of the final picture: 1, 4, 9 ..
};

// All of a picture in fewer pixels, as `ivory render` draws it in that size, rows from the top. It
// is as high as the window's picture and as wide or, by less than one of its own pixels, wider.
struct CoarsePicture {
    double step = 1;  // an entry of resolution_steps
    WindowSize size;  // 0 x 0: there is none
    std::vector<Rgba8> color;
    std::vector<float> depth;  // see PictureState

    [[nodiscard]] bool empty() const { return size.width == 0; }
};

// So that it covers a picture of that size.
[[nodiscard]] inline WindowSize coarse_size(WindowSize size, double step) {
    const auto up = [](double pixels) {
        const int whole = static_cast<int>(pixels);
        return whole < pixels ? whole + 1 : whole;
    };
    const int height = up(size.height / step);
    return {up(static_cast<double>(size.width) * height / size.height), height};
}

// What is on the screen, all of it of one scene and camera: rows from the top. Either every tile is
// fine, or none is, or, when the hand rests, more and more of them are.
struct ShownPicture {
    WindowSize size;
    // Of the tiles that are fine; elsewhere of an earlier picture, and not to be seen.
    std::vector<Rgba8> color;
    std::vector<float> depth;
    std::vector<std::uint8_t> fine;  // by tile: 1, or 0 where `coarse` is seen
    CoarsePicture coarse;            // empty where every tile is fine from the first moment
};

// What `poll` changed in the shown picture.
struct PictureChange {
    bool replaced = false;         // the picture of another scene, camera or size than before
    bool all = false;              // another size: every pixel
    bool coarse = false;           // another coarse picture, or another set of fine tiles
    std::vector<PixelRect> tiles;  // unless `all`: of these tiles the pixels, and of no other
    [[nodiscard]] bool any() const { return replaced || all || coarse || !tiles.empty(); }
};

}  // namespace ivory
