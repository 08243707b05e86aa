// What a picture is a function of, and what it is painted on.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "core/field/element_filter.h"
#include "core/field/field.h"
#include "core/field/support.h"
#include "core/render/camera.h"
#include "core/render/frame.h"
#include "core/render/shade.h"
#include "core/render/tiles.h"
#include "core/scene/error.h"
#include "core/trace/bundle_surfaces.h"
#include "core/trace/methods/method.h"

namespace ivory {

// Together with the size of the canvas this decides every byte: nothing else leaves a trace.
struct Picture {
    std::shared_ptr<const Field> field;
    View view;
    Lighting lighting;
    const Method* method = nullptr;
    MethodOptions options;
};

// The picture of a scene through its camera, or the one that frames it (core/render/framing.h), in that
// many pixels, compiled by so many threads. Throws Error as make_view and default_camera do.
[[nodiscard]] Picture make_picture(const Scene& scene, int width, int height, const Method& method,
                                   const MethodOptions& options, int threads = 1);

// What make_picture, make_view or a default camera finds wrong with a scene, with its file and the
// place: the camera, or the elements where that is the one that frames them.
[[nodiscard]] Error camera_fault(const Scene& scene, const std::filesystem::path& file,
                                 const Error& fault);

// A tile as the last job left it.
struct TileState {
    bool traced = false;    // all of its pixels; else nothing of it is
    bool empty = false;     // a list proved f < 0 on all its rays: every pixel is a miss
    bool has_list = false;  // `list` is valid on the tile's rays
    ElementList list;
    std::array<std::uint16_t, 5> pixels{};  // how many of them have each Status
    double enclosure_width_max = 0;         // the widest t of a hit, as a length in the scene
    double unresolved_width_max = 0;        // and of an unresolved pixel
    ElementFilter looked_at;                // those that the canvas' looks were mixed of
};

// Not to be touched while a job works on it, but for what the job's notices allow.
struct Canvas {
    TileGrid grid;
    Frame frame;
    std::vector<TileState> tiles;
    Plane<Looks> looks;  // by tile, of its pixels row by row; unless it is empty. None: not kept

    // Throws std::bad_alloc. `keep_looks`: shading again needs no surface but where colours change.
    Canvas(int width, int height, bool keep_surface, bool keep_looks = false)
        : grid(width, height),
          frame(width, height, keep_surface),
          tiles(grid.tiles.size()),
          looks(keep_looks ? tiles.size() : 0) {}

    // For a field or a view that has changed: lists of the old one prove nothing of the new one.
    // Colours, lights and background leave them valid.
    void forget_lists() {
        for (TileState& tile : tiles) {
            tile.has_list = false;
            tile.list = {};
        }
    }

    // The tile is without a surface, and painted so before that background.
    [[nodiscard]] bool stands_empty(std::size_t tile, Rgba8 background) const {
        const PixelRect rect = grid.tiles.rect(tile);
        return tiles[tile].empty && frame.color[frame.at(rect.x0, rect.y0)] == background;
    }

    // As if nothing had been painted on it.
    void forget() { tiles.assign(tiles.size(), {}); }

    // For another threshold alone: what the others enclose, the sum of the F_i, is what it was.
    void forget_empty_lists() {
        for (TileState& tile : tiles) {
            if (!tile.list.certainly_empty) continue;
            tile.has_list = false;
            tile.list = {};
        }
    }
};

}  // namespace ivory
