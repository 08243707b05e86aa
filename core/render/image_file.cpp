#include "core/render/image_file.h"

#include <png.h>
#include <zlib.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <csetjmp>
#include <cstdint>
#include <limits>
#include <new>
#include <system_error>
#include <thread>
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

// Rows of the picture, packed on their own: libpng would pack all of them on one processor.
struct Strip {
    static constexpr int rows = 64;

    int begin = 0, end = 0;  // rows
    std::vector<unsigned char> packed;
    uLong adler = 0;     // of the filtered bytes
    z_off_t length = 0;  // their number
};

// Each byte less that of the pixel to the left (the filter `Sub`), then deflated as a part of a
// stream that the next strip goes on with at a whole byte. False: out of memory.
bool pack(const PictureBytes& picture, Strip& strip, bool last) {
    const auto width = static_cast<std::size_t>(picture.width);
    std::vector<unsigned char> filtered(static_cast<std::size_t>(strip.end - strip.begin) *
                                        (3 * width + 1));
    unsigned char* out = filtered.data();
    for (int j = strip.begin; j < strip.end; ++j) {
        const Rgba8* const row = picture.color + static_cast<std::size_t>(j) * width;
        *out++ = PNG_FILTER_VALUE_SUB;
        Rgba8 left{0, 0, 0, 0};
        for (std::size_t i = 0; i < width; ++i) {
            const Rgba8 color = row[i];
            out[0] = static_cast<unsigned char>(color.r - left.r);
            out[1] = static_cast<unsigned char>(color.g - left.g);
            out[2] = static_cast<unsigned char>(color.b - left.b);
            out += 3;
            left = color;
        }
    }
    strip.length = static_cast<z_off_t>(filtered.size());
    strip.adler = adler32_z(adler32(0, nullptr, 0), filtered.data(), filtered.size());

    z_stream stream{};
    constexpr int raw_window = -15, memory = 9;
    if (deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, raw_window, memory, Z_DEFAULT_STRATEGY) !=
        Z_OK) {
        return false;
    }
    constexpr uLong flush_room = 64;
    strip.packed.resize(deflateBound(&stream, static_cast<uLong>(filtered.size())) + flush_room);
    stream.next_in = filtered.data();
    stream.avail_in = static_cast<uInt>(filtered.size());
    stream.next_out = strip.packed.data();
    stream.avail_out = static_cast<uInt>(strip.packed.size());
    const int result = deflate(&stream, last ? Z_FINISH : Z_SYNC_FLUSH);
    strip.packed.resize(stream.total_out);
    deflateEnd(&stream);
    return result == (last ? Z_STREAM_END : Z_OK) && stream.avail_in == 0;
}

// The strips do not depend on the number of workers.
std::vector<Strip> packed_strips(const PictureBytes& picture) {
    std::vector<Strip> strips;
    for (int j = 0; j < picture.height; j += Strip::rows) {
        Strip& strip = strips.emplace_back();
        strip.begin = j;
        strip.end = std::min(j + Strip::rows, picture.height);
    }
    std::atomic<std::size_t> next{0};
    std::atomic<bool> failed{false};
    const auto work = [&] {
        try {
            for (std::size_t k = next++; k < strips.size(); k = next++) {
                if (!pack(picture, strips[k], k + 1 == strips.size())) failed = true;
            }
        } catch (const std::bad_alloc&) {
            failed = true;
        }
    };
    {
        std::vector<std::jthread> others;
        const std::size_t workers =
            std::min<std::size_t>(std::max(1U, std::thread::hardware_concurrency()), strips.size());
        try {
            while (others.size() + 1 < workers) others.emplace_back(work);
        } catch (const std::system_error&) {
            // Fewer workers do the same work.
        }
        work();
    }
    if (failed) throw std::bad_alloc();
    // The stream's head: deflate, 32 KiB, quick; and its end, the check sum of all of it.
    strips.front().packed.insert(strips.front().packed.begin(), {0x78, 0x01});
    uLong adler = strips.front().adler;
    for (std::size_t k = 1; k < strips.size(); ++k) {
        adler = adler32_combine(adler, strips[k].adler, strips[k].length);
    }
    for (int shift = 24; shift >= 0; shift -= 8) {
        strips.back().packed.push_back(static_cast<unsigned char>(adler >> shift & 0xFF));
    }
    return strips;
}

// False: libpng gave up. Holds nothing that a longjmp would leave undestroyed.
bool write_png(const PictureBytes& picture, const std::vector<Strip>& strips, PngOutput& output) {
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, silent);
    if (png == nullptr) return false;
    png_infop info = png_create_info_struct(png);
    if (info == nullptr || setjmp(png_jmpbuf(png)) != 0) {
        png_destroy_write_struct(&png, &info);
        return false;
    }
    png_set_write_fn(png, &output, append, flush);
    png_set_IHDR(png, info, static_cast<png_uint_32>(picture.width),
                 static_cast<png_uint_32>(picture.height), 8, PNG_COLOR_TYPE_RGB,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_write_info(png, info);
    for (const Strip& strip : strips) {
        png_write_chunk(png, reinterpret_cast<png_const_bytep>("IDAT"), strip.packed.data(),
                        strip.packed.size());
    }
    png_write_chunk(png, reinterpret_cast<png_const_bytep>("IEND"), nullptr, 0);
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

std::string png_bytes(const PictureBytes& picture) {
    const std::vector<Strip> strips = packed_strips(picture);
    PngOutput output;
    const bool written = write_png(picture, strips, output);
    if (output.out_of_memory) throw std::bad_alloc();
    if (!written) throw Error("the picture cannot be made into a PNG; try a smaller one");
    return std::move(output.bytes);
}

std::string png_bytes(const Frame& frame) {
    return png_bytes(PictureBytes{frame.width, frame.height, &frame.color[0]});
}

std::vector<double> depth_of(const Frame& frame) {
    std::vector<double> depth(frame.size());
    for (std::size_t p = 0; p < depth.size(); ++p) {
        depth[p] = possibly_hit(frame.status[p]) ? midpoint(frame.t(p)) : infinity<double>;
    }
    return depth;
}

std::string depth_bytes(int width, int height, const double* depth) {
    const auto across = static_cast<std::size_t>(width), down = static_cast<std::size_t>(height);
    std::string bytes = "Pf\n" + std::to_string(width) + " " + std::to_string(height) + "\n-1.0\n";
    bytes.reserve(bytes.size() + 4 * across * down);
    for (std::size_t j = down; j-- > 0;) {
        for (std::size_t i = 0; i < across; ++i) {
            append_little_endian(bytes, nearest_float(depth[j * across + i]));
        }
    }
    return bytes;
}

std::string depth_bytes(const Frame& frame) {
    const std::vector<double> depth = depth_of(frame);
    return depth_bytes(frame.width, frame.height, depth.data());
}

}  // namespace ivory
