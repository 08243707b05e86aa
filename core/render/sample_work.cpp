#include "core/render/sample_work.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/render/srgb.h"
#include "core/trace/descent.h"
#include "core/trace/trace.h"

namespace ivory {
namespace {

// A mean may be off by so many bytes where the middle stands for it. One byte is promised: what is left
// is for what the parabolas do not know.
constexpr double most_off = 0.3;

// How much brighter, in bytes of sRGB, a light that is a little brighter than `linear` is, for each unit
// that it is brighter: 255 times the slope of the curve of IEC 61966-2-1.
double bytes_per_light(double linear) {
    if (linear <= 0.0031308) return 255 * 12.92;
    return 255 * 1.055 / 2.4 * std::pow(linear, 1 / 2.4 - 1);
}

}  // namespace

SampleWorker::SampleWorker(const Picture& picture, Canvas& canvas, SampledPicture& sampled,
                           TileLists& lists, const std::atomic<bool>& stop, Counts& counts)
    : picture_(picture),
      canvas_(canvas),
      sampled_(sampled),
      lists_(lists),
      stop_(stop),
      counts_(counts) {}

// From a pixel's middle to its farthest sample, in the plane that the rays pass at distance 1; longer
// vectors turn by less.
Footprint SampleWorker::footprint() const {
    const double n = sampled_.samples;
    const double pixel = 2 * picture_.view.s / canvas_.frame.height;
    const double reach =
        0.5 * pixel * (n - 1) / n * std::sqrt(2.0) * (1 + 0x1p-20) + 0x1p-45 * (1 + pixel);
    if (picture_.view.is_orthographic()) {
        const Vec3d& o = picture_.view.origin;
        return {.spread = 0,
                .radius = reach + 0x1p-48 * (std::abs(o.x) + std::abs(o.y) + std::abs(o.z) +
                                             picture_.view.s * canvas_.frame.width)};
    }
    return {.spread = reach, .radius = 0};
}

bool SampleWorker::sample(std::size_t tile, const ElementList& list) {
    const PixelRect rect = canvas_.grid.tiles.rect(tile);
    if (list.certainly_empty) {
        write_empty(tile, rect);
        return true;
    }
    status_.fill(Status::unresolved);
    settled_.fill(0);
    depth_.fill(infinity<double>);
    sum_ = {};
    if (sampled_.depth.empty()) {
        certify(rect, list);
        if (stopped()) return false;
        judge(rect);
    }
    if (!trace_rest(rect, list)) return false;
    write(tile, rect);
    return true;
}

// The light in the middles of pixels, where the pixel has one status.
void SampleWorker::certify(const PixelRect& rect, const ElementList& list) {
    rays_.gather(
        picture_.view, canvas_.frame.width, canvas_.frame.height, rect,
        list.most_elements() >= Descent::parts_elements, [](int, int) { return true; },
        sampled_.samples);
    rays_.rays.common = common_.list->certainly_empty ? nullptr : &common_;
    surfaces_.exact = false;
    picture_.method->certify_bundle(*picture_.field, list, rays_.rays, footprint(),
                                    picture_.options, isolations_, surfaces_, counts_);
    const std::size_t size = rays_.size();
    light_lanes(picture_.lighting, rays_.rays, surfaces_, size, light_);
    for (std::size_t k = 0; k < size; ++k) {
        const std::size_t place = rays_.place[k];
        const Status status = isolations_.status[k];
        // A hit whose surface was not found has nothing to show.
        if (status == Status::hit && !surfaces_.seen(k)) continue;
        status_[place] = status;
        sum_.r[place] = light_.r[k];
        sum_.g[place] = light_.g[k];
        sum_.b[place] = light_.b[k];
    }
}

// Which of those are settled, and their means.
void SampleWorker::judge(const PixelRect& rect) {
    const int width = rect.width(), height = rect.height();
    const auto at = [&](int i, int j) { return static_cast<std::size_t>(j * width + i); };
    const auto is_hit = [&](int i, int j) {
        return i >= 0 && j >= 0 && i < width && j < height && status_[at(i, j)] == Status::hit;
    };
    // The middle one of three pixels in a row that are hit, this one among them, along (di, dj): the one
    // itself, if it may be.
    const auto triple = [&](int i, int j, int di, int dj) -> std::optional<int> {
        const auto fits = [&](int shift) {
            return is_hit(i + (shift - 1) * di, j + (shift - 1) * dj) &&
                   is_hit(i + shift * di, j + shift * dj) &&
                   is_hit(i + (shift + 1) * di, j + (shift + 1) * dj);
        };
        for (const int shift : {0, 1, -1})
            if (fits(shift)) return shift;
        return std::nullopt;
    };
    const double n = sampled_.samples;
    const double share = (n * n - 1) / (24 * n * n);
    Channels means = sum_;
    for (int j = 0; j < height; ++j) {
        for (int i = 0; i < width; ++i) {
            const std::size_t here = at(i, j);
            if (status_[here] == Status::miss) settled_[here] = 1;
            if (status_[here] != Status::hit) continue;
            const auto row = triple(i, j, 1, 0), column = triple(i, j, 0, 1);
            if (!row || !column) continue;
            bool is_settled = true;
            const auto mean_of = [&](const Pixels<double>& channel, Pixels<double>& mean) {
                const auto second = [&](int a, int b, int da, int db) {
                    return channel[at(a - da, b - db)] - 2 * channel[at(a, b)] +
                           channel[at(a + da, b + db)];
                };
                const double along_row = second(i + *row, j, 1, 0),
                             along_column = second(i, j + *column, 0, 1);
                const double off = share * (std::abs(along_row) + std::abs(along_column));
                const double light = channel[here] + share * (along_row + along_column);
                const double darker = std::max(std::min(light, channel[here]) - off, 0.0);
                is_settled = is_settled && off * bytes_per_light(darker) <= most_off;
                mean[here] = std::clamp(light, 0.0, 1.0);
            };
            mean_of(sum_.r, means.r);
            mean_of(sum_.g, means.g);
            mean_of(sum_.b, means.b);
            settled_[here] = is_settled ? 1 : 0;
        }
    }
    const std::size_t size = rect.area();
    for (std::size_t k = 0; k < size; ++k) {
        if (settled_[k] != 0) continue;
        means.r[k] = means.g[k] = means.b[k] = 0;
        status_[k] = Status::claimed_miss;  // whatever its first sample is
    }
    sum_ = means;
}

bool SampleWorker::trace_rest(const PixelRect& rect, const ElementList& list) {
    const std::size_t size = rect.area();
    if (std::count(settled_.begin(), settled_.begin() + static_cast<std::ptrdiff_t>(size), 1) ==
        static_cast<std::ptrdiff_t>(size)) {
        return true;
    }
    const PixelRect all = times(rect, sampled_.samples);
    for (int y = all.y0; y < all.y1; y += tile_side) {
        for (int x = all.x0; x < all.x1; x += tile_side) {
            const PixelRect part{x, y, std::min(x + tile_side, all.x1),
                                 std::min(y + tile_side, all.y1)};
            if (!trace_part(rect, part, list)) return false;
        }
    }
    return true;
}

// The samples of a tile of the larger picture, but those of settled pixels.
bool SampleWorker::trace_part(const PixelRect& rect, const PixelRect& part,
                              const ElementList& list) {
    const int n = sampled_.samples;
    const auto place_of = [&](int i, int j) {
        return static_cast<std::size_t>((j / n - rect.y0) * rect.width() + i / n - rect.x0);
    };
    bool any = false;
    for (int j = part.y0 / n; j <= (part.y1 - 1) / n; ++j)
        for (int i = part.x0 / n; i <= (part.x1 - 1) / n; ++i)
            any = any || settled_[place_of(i * n, j * n)] == 0;
    if (!any) return true;

    const int width = canvas_.frame.width * n, height = canvas_.frame.height * n;
    rays_.gather(picture_.view, width, height, part,
                 list.most_elements() >= Descent::parts_elements,
                 [&](int i, int j) { return settled_[place_of(i, j)] == 0; });
    rays_.rays.common = common_.list->certainly_empty ? nullptr : &common_;
    surfaces_.exact = false;
    trace_bundle(*picture_.field, list, lists_.all(), rays_.rays, *picture_.method,
                 picture_.options, isolations_, &surfaces_, counts_);
    if (stopped()) return false;
    const std::size_t size = rays_.size();
    light_lanes(picture_.lighting, rays_.rays, surfaces_, size, light_);
    for (std::size_t k = 0; k < size; ++k) {
        const int i = part.x0 + rays_.place[k] % part.width(),
                  j = part.y0 + rays_.place[k] / part.width();
        const std::size_t place = place_of(i, j);
        sum_.r[place] += light_.r[k];
        sum_.g[place] += light_.g[k];
        sum_.b[place] += light_.b[k];
        const Status status = isolations_.status[k];
        status_[place] = named_after(status_[place], status);
        if (possibly_hit(status)) {
            depth_[place] = std::min(depth_[place], midpoint(isolations_[k].t));
        }
    }
    return true;
}

void SampleWorker::write(std::size_t tile, const PixelRect& rect) {
    const SrgbTable& table = srgb_table();
    const double each = 1.0 / (sampled_.samples * sampled_.samples);
    std::array<std::uint16_t, 5>& count = sampled_.pixels[tile];
    count = {};
    for (int j = rect.y0; j < rect.y1; ++j) {
        for (int i = rect.x0; i < rect.x1; ++i) {
            const auto place =
                static_cast<std::size_t>((j - rect.y0) * rect.width() + i - rect.x0);
            const std::size_t pixel = canvas_.frame.at(i, j);
            const Status status = status_[place];
            ++count[static_cast<std::size_t>(status)];
            if (!sampled_.depth.empty()) sampled_.depth[pixel] = depth_[place];
            if (settled_[place] != 0 && status == Status::miss) {
                sampled_.color[pixel] = picture_.lighting.background;
                continue;
            }
            const double share = settled_[place] != 0 ? 1 : each;
            const auto byte = [&](double sum) {
                return table.byte(static_cast<float>(sum * share));
            };
            sampled_.color[pixel] = {byte(sum_.r[place]), byte(sum_.g[place]),
                                     byte(sum_.b[place]), 255};
        }
    }
}

void SampleWorker::write_empty(std::size_t tile, const PixelRect& rect) {
    sampled_.pixels[tile] = {};
    sampled_.pixels[tile][static_cast<std::size_t>(Status::miss)] =
        static_cast<std::uint16_t>(rect.area());
    for (int j = rect.y0; j < rect.y1; ++j) {
        const std::size_t first = canvas_.frame.at(rect.x0, j);
        std::fill_n(&sampled_.color[first], rect.width(), picture_.lighting.background);
        if (!sampled_.depth.empty()) {
            std::fill_n(&sampled_.depth[first], rect.width(), infinity<double>);
        }
    }
}

}  // namespace ivory
