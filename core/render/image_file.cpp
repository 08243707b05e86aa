#include "core/render/image_file.h"

#include <png.h>
#include <zlib.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <chrono>
#include <csetjmp>
#include <cstdint>
#include <limits>
#include <memory>
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

// Rows of the picture, packed on their own: libpng would pack all of them on one processor. As many
// as those of a block, so that no tile lies in two.
struct Strip {
    static constexpr int rows = TileGrid::block_side;

    int begin = 0, end = 0;           // rows
    std::atomic<std::size_t> left{};  // pixels to be painted
    bool is_packed = false;
    std::unique_ptr<unsigned char[]> packed;
    std::size_t packed_size = 0;
    uLong adler = 0;     // of the filtered bytes
    z_off_t length = 0;  // their number
};

// Each byte less that of the pixel to the left (the filter `Sub`), then deflated as a part of a
// stream that the next strip goes on with at a whole byte. Only runs of one byte are looked for: of
// pictures so filtered that is quicker than all repetitions, and no longer. False: out of memory.
bool pack(const PictureBytes& picture, Strip& strip, bool last) {
    const auto width = static_cast<std::size_t>(picture.width);
    const std::size_t size = static_cast<std::size_t>(strip.end - strip.begin) * (3 * width + 1);
    const auto filtered = std::make_unique_for_overwrite<unsigned char[]>(size);
    unsigned char* out = filtered.get();
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
    strip.length = static_cast<z_off_t>(size);
    strip.adler = adler32_z(adler32(0, nullptr, 0), filtered.get(), size);

    z_stream stream{};
    // Of the memory that more would take most is a table of places, moved on with every 32 KiB.
    constexpr int raw_window = -15, memory = 7;
    if (deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, raw_window, memory, Z_RLE) != Z_OK) {
        return false;
    }
    constexpr uLong flush_room = 64;
    // Of this only the pages that are written are memory.
    const uLong room = deflateBound(&stream, static_cast<uLong>(size)) + flush_room;
    try {
        strip.packed = std::make_unique_for_overwrite<unsigned char[]>(room);
    } catch (const std::bad_alloc&) {
        deflateEnd(&stream);
        return false;
    }
    stream.next_in = filtered.get();
    stream.avail_in = static_cast<uInt>(size);
    stream.next_out = strip.packed.get();
    stream.avail_out = static_cast<uInt>(room);
    const int result = deflate(&stream, last ? Z_FINISH : Z_SYNC_FLUSH);
    strip.packed_size = stream.total_out;
    deflateEnd(&stream);
    strip.is_packed = result == (last ? Z_STREAM_END : Z_OK) && stream.avail_in == 0;
    return strip.is_packed;
}

// False: libpng gave up. Holds nothing that a longjmp would leave undestroyed.
bool write_png(const PictureBytes& picture, const std::vector<Strip>& strips, uLong adler,
               PngOutput& output) {
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
    // The stream's head says deflate, 32 KiB, quick; its end is the check sum of all of it.
    const png_byte head[] = {0x78, 0x01};
    png_byte end[4];
    png_save_uint_32(end, static_cast<png_uint_32>(adler));
    for (const Strip& strip : strips) {
        const bool first = &strip == &strips.front(), last = &strip == &strips.back();
        const std::size_t more = (first ? sizeof head : 0) + (last ? sizeof end : 0);
        png_write_chunk_start(png, reinterpret_cast<png_const_bytep>("IDAT"),
                              static_cast<png_uint_32>(strip.packed_size + more));
        if (first) png_write_chunk_data(png, head, sizeof head);
        png_write_chunk_data(png, strip.packed.get(), strip.packed_size);
        if (last) png_write_chunk_data(png, end, sizeof end);
        png_write_chunk_end(png);
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

// The strips do not depend on who packs them, or when.
class GrowingPng::Strips {
  public:
    explicit Strips(const PictureBytes& picture)
        : picture_(picture),
          strips_(static_cast<std::size_t>((picture.height + Strip::rows - 1) / Strip::rows)) {
        for (std::size_t k = 0; k < strips_.size(); ++k) {
            Strip& strip = strips_[k];
            strip.begin = static_cast<int>(k) * Strip::rows;
            strip.end = std::min(strip.begin + Strip::rows, picture.height);
            strip.left = static_cast<std::size_t>(strip.end - strip.begin) *
                         static_cast<std::size_t>(picture.width);
        }
    }

    void painted(const PixelRect& tile) noexcept {
        const auto k = static_cast<std::size_t>(tile.y0 / Strip::rows);
        // What others have painted of the strip is seen by the one that packs it.
        if (strips_[k].left.fetch_sub(tile.area(), std::memory_order_acq_rel) != tile.area())
            return;
        const Clock::time_point start = Clock::now();
        take(k);
        spent_ += (Clock::now() - start).count();
    }

    double seconds() const {
        return std::chrono::duration<double>(Clock::duration(spent_.load())).count();
    }

    std::string bytes() {
        pack_the_rest();
        if (failed_) throw std::bad_alloc();
        uLong adler = strips_.front().adler;
        for (std::size_t k = 1; k < strips_.size(); ++k) {
            adler = adler32_combine(adler, strips_[k].adler, strips_[k].length);
        }
        PngOutput output;
        const bool written = write_png(picture_, strips_, adler, output);
        if (output.out_of_memory) throw std::bad_alloc();
        if (!written) throw Error("the picture cannot be made into a PNG; try a smaller one");
        return std::move(output.bytes);
    }

  private:
    using Clock = std::chrono::steady_clock;

    void take(std::size_t k) noexcept {
        try {
            if (!pack(picture_, strips_[k], k + 1 == strips_.size())) failed_ = true;
        } catch (const std::bad_alloc&) {
            failed_ = true;
        }
    }

    void pack_the_rest() {
        std::vector<std::size_t> rest;
        for (std::size_t k = 0; k < strips_.size(); ++k) {
            if (!strips_[k].is_packed) rest.push_back(k);
        }
        if (rest.empty()) return;
        std::atomic<std::size_t> next{0};
        const auto work = [&] {
            for (std::size_t i = next++; i < rest.size(); i = next++) take(rest[i]);
        };
        std::vector<std::jthread> others;
        const std::size_t workers =
            std::min<std::size_t>(std::max(1U, std::thread::hardware_concurrency()), rest.size());
        try {
            while (others.size() + 1 < workers) others.emplace_back(work);
        } catch (const std::system_error&) {
            // Fewer workers do the same work.
        }
        work();
    }

    const PictureBytes picture_;
    std::vector<Strip> strips_;
    std::atomic<bool> failed_{false};
    std::atomic<Clock::rep> spent_{0};
};

GrowingPng::GrowingPng(const PictureBytes& picture) : strips_(std::make_unique<Strips>(picture)) {}

GrowingPng::~GrowingPng() = default;

void GrowingPng::painted(const PixelRect& tile) noexcept { strips_->painted(tile); }

double GrowingPng::seconds() const { return strips_->seconds(); }

std::string GrowingPng::bytes() { return strips_->bytes(); }

std::string png_bytes(const PictureBytes& picture) { return GrowingPng(picture).bytes(); }

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
