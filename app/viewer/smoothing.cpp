#include "app/viewer/smoothing.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "core/render/srgb.h"

namespace ivory {

namespace {

constexpr double fine_enough = 3;  // pixels of the window a side

struct LinearPixel {
    float r, g, b;
    friend LinearPixel operator+(const LinearPixel& p, const LinearPixel& q) {
        return {p.r + q.r, p.g + q.g, p.b + q.b};
    }
    friend LinearPixel operator*(float share, const LinearPixel& p) {
        return {share * p.r, share * p.g, share * p.b};
    }
};

struct LinearPicture {
    std::size_t width, height;
    std::vector<LinearPixel> pixels;
};

LinearPicture linear_of(const CoarsePicture& picture) {
    const auto light = [&table = linear_of_bytes()](std::uint8_t byte) {
        return static_cast<float>(table[byte]);
    };
    LinearPicture result{static_cast<std::size_t>(picture.size.width),
                         static_cast<std::size_t>(picture.size.height),
                         {}};
    result.pixels.reserve(picture.color.size());
    for (const Rgba8& c : picture.color)
        result.pixels.push_back({light(c.r), light(c.g), light(c.b)});
    return result;
}

LinearPicture doubled(const LinearPicture& from) {
    LinearPicture to{2 * from.width, 2 * from.height, {}};
    to.pixels.resize(to.width * to.height);
    // the nearer of two neighbours and the other one; at the edge both are the same
    const auto pair = [](std::size_t at, std::size_t count) {
        const std::size_t near = at / 2;
        const std::size_t beside =
            at % 2 == 0 ? std::max<std::size_t>(near, 1) - 1 : std::min(near + 1, count - 1);
        return std::pair(near, beside);
    };
    std::vector<LinearPixel> row(from.width);
    for (std::size_t j = 0; j < to.height; ++j) {
        const auto [near, beside] = pair(j, from.height);
        for (std::size_t i = 0; i < from.width; ++i)
            row[i] = 0.75f * from.pixels[near * from.width + i] +
                     0.25f * from.pixels[beside * from.width + i];
        LinearPixel* const out = &to.pixels[j * to.width];
        for (std::size_t i = 0; i < to.width; ++i) {
            const auto [left, right] = pair(i, from.width);
            out[i] = 0.75f * row[left] + 0.25f * row[right];
        }
    }
    return to;
}

}  // namespace

SmoothPicture smoothed(const CoarsePicture& picture) {
    if (picture.step <= fine_enough) return {picture.size, picture.color};
    LinearPicture light = linear_of(picture);
    for (double step = picture.step; step > fine_enough; step /= 2) light = doubled(light);
    const SrgbTable& table = srgb_table();
    SmoothPicture result{{static_cast<int>(light.width), static_cast<int>(light.height)}, {}};
    result.color.reserve(light.pixels.size());
    for (const LinearPixel& p : light.pixels)
        result.color.push_back({table.byte(p.r), table.byte(p.g), table.byte(p.b), 255});
    return result;
}

}  // namespace ivory
