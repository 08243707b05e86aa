#include "core/render/image_file.h"

#include <png.h>

#include <bit>
#include <csetjmp>
#include <cstdint>
#include <limits>
#include <new>
#include <vector>

#include "core/scene/error.h"

namespace ivory {
namespace {

// Filled by libpng, which is C and must not see an exception.
struct PngOutput {
    std::string bytes;
    bool out_of_memory = false;
};

void append(png_structp png, png_bytep data, std::size_t size) {
    auto& output = *static_cast<PngOutput*>(png_get_io_ptr(png));
    try {
        output.bytes.append(reinterpret_cast<const char*>(data), size);
    } catch (const std::bad_alloc&) {
        output.out_of_memory = true;
    }
}

void flush(png_structp) {}

void silent(png_structp, png_const_charp) {}

// False: libpng gave up. Holds nothing that a longjmp would leave undestroyed.
bool write_png(const Frame& frame, png_byte* row, PngOutput& output) {
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, silent);
    if (png == nullptr) return false;
    png_infop info = png_create_info_struct(png);
    if (info == nullptr || setjmp(png_jmpbuf(png)) != 0) {
        png_destroy_write_struct(&png, &info);
        return false;
    }
    png_set_write_fn(png, &output, append, flush);
    png_set_compression_level(png, 1);
    png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
    png_set_IHDR(png, info, static_cast<png_uint_32>(frame.width),
                 static_cast<png_uint_32>(frame.height), 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_write_info(png, info);
    for (int j = 0; j < frame.height; ++j) {
        png_byte* out = row;
        for (int i = 0; i < frame.width; ++i) {
            const Rgba8 color = frame.color[frame.at(i, j)];
            *out++ = color.r;
            *out++ = color.g;
            *out++ = color.b;
        }
        png_write_row(png, row);
    }
    png_write_end(png, nullptr);
    png_destroy_write_struct(&png, &info);
    return true;
}

void append_little_endian(std::string& bytes, float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(bits >> shift & 0xFF);
}

// What does not fit is as far as a miss.
float nearest_float(double value) {
    constexpr double largest = std::numeric_limits<float>::max();
    return value <= largest ? static_cast<float>(value) : std::numeric_limits<float>::infinity();
}

}  // namespace

std::string png_bytes(const Frame& frame) {
    std::vector<png_byte> row(3 * static_cast<std::size_t>(frame.width));
    PngOutput output;
    const bool written = write_png(frame, row.data(), output);
    if (output.out_of_memory) throw std::bad_alloc();
    if (!written) throw Error("the picture cannot be made into a PNG; try a smaller one");
    return std::move(output.bytes);
}

std::string depth_bytes(const Frame& frame) {
    std::string bytes =
        "Pf\n" + std::to_string(frame.width) + " " + std::to_string(frame.height) + "\n-1.0\n";
    bytes.reserve(bytes.size() + 4 * frame.size());
    for (int j = frame.height - 1; j >= 0; --j) {
        for (int i = 0; i < frame.width; ++i) {
            const std::size_t p = frame.at(i, j);
            append_little_endian(bytes, possibly_hit(frame.status[p])
                                            ? nearest_float(midpoint(frame.t(p)))
                                            : std::numeric_limits<float>::infinity());
        }
    }
    return bytes;
}

}  // namespace ivory
