// What a rendering took and what came out, for people and as JSON.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/render/canvas.h"
#include "core/render/render.h"
#include "core/render/sampled_picture.h"

namespace ivory {

// Of all that is traced on a canvas, whichever job did it.
struct PixelStatistics {
    std::array<std::uint64_t, 5> pixels{};  // by Status
    std::size_t tiles = 0, empty_tiles = 0;
    double enclosure_width_max = 0;   // the widest t of a hit, in units of the scene
    double unresolved_width_max = 0;  // and of an unresolved pixel

    PixelStatistics& operator+=(const PixelStatistics& other);
};

[[nodiscard]] PixelStatistics pixel_statistics(const Canvas& canvas);
// Of several samples a pixel: the widths are those of the canvas, if anything is traced there.
[[nodiscard]] PixelStatistics pixel_statistics(const Canvas& canvas, const SampledPicture& sampled);

struct Seconds {
    double load = 0, compile = 0, trace = 0, shade = 0, write = 0, total = 0;
};

struct RenderStatistics {
    int width = 0, height = 0, threads = 0;
    std::string_view method;
    MethodOptions options;
    Camera camera;
    Seconds seconds;
    int repeats = 1;
    int samples = 1;  // a pixel
    PixelStatistics pixels;
    Counts counts;
    std::size_t elements = 0, visible_elements = 0, reached_elements = 0;
};

// One JSON object, the keys of `--stats`, a newline at the end. An unbounded width is null.
[[nodiscard]] std::string statistics_json(const RenderStatistics& statistics);

}  // namespace ivory
