#include "core/render/sample_work.h"

#include <algorithm>
#include <cmath>

#include "core/render/srgb.h"
#include "core/trace/descent.h"
#include "core/trace/trace.h"

namespace ivory {
namespace {

// A mean may be off by so many bytes where the middle stands for it. One byte is promised: what is left
// is for what the parabolas do not know.
constexpr double most_off = 0.4;
// Second differences count as those of a smooth function where their own are no more than such a share.
constexpr double smooth = 0.25;

// How much brighter, in bytes of sRGB, a light that is a little brighter than `linear` is, for each unit
// that it is brighter: 255 times the slope of the curve of IEC 61966-2-1, which falls; of light a little
// darker, from a table.
double bytes_per_light(double linear) {
    constexpr std::size_t steps = 1024;
    static const std::array<double, steps> table = [] {
        std::array<double, steps> slopes{};
        for (std::size_t k = 0; k < steps; ++k) {
            const double light = static_cast<double>(k) / steps;
            slopes[k] =
                light <= 0.0031308 ? 255 * 12.92 : 255 * 1.055 / 2.4 * std::pow(light, 1 / 2.4 - 1);
        }
        return slopes;
    }();
    return table[std::min(static_cast<std::size_t>(linear * steps), steps - 1)];
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
    const double n = sampled_.samples_a_side;
    const double pixel = 2 * picture_.view.s / canvas_.frame.height;
    const double reach =
        0.5 * pixel * (n - 1) / n * std::sqrt(2.0) * (1 + 0x1p-20) + 0x1p-45 * (1 + pixel);
    if (picture_.view.is_orthographic()) {
        const double farthest = picture_.view.s * canvas_.frame.width;
        return {.spread = 0, .radius = reach + origin_error(picture_.view, farthest)};
    }
    return {.spread = reach, .radius = 0};
}

bool SampleWorker::sample(std::size_t tile, const ElementList& list) {
    const PixelRect rect = canvas_.grid.tiles.rect(tile);
    if (list.certainly_empty) {
        write_empty(tile, rect);
        return true;
    }
    status_.fill(Status::claimed_miss);  // whatever its first sample is
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

// What is certain of the pixels whose middles have been gathered, and their light.
void SampleWorker::take_certain(const ElementList& list) {
    rays_.rays.common = common_.list->certainly_empty ? nullptr : &common_;
    surfaces_.exact = false;
    picture_.method->certify_bundle(*picture_.field, list, rays_.rays, footprint(),
                                    picture_.options, isolations_, surfaces_, counts_);
    const auto status = isolations_.status.begin();
    const auto end = status + static_cast<std::ptrdiff_t>(rays_.size());
    if (std::find(status, end, Status::hit) == end) return;
    light_lanes(picture_.lighting, rays_.rays, surfaces_, rays_.size(), light_);
}

void SampleWorker::certify(const PixelRect& rect, const ElementList& list) {
    const int width = rect.width() + 2;
    certain_.fill(Status::unresolved);
    bool any_hit = false;
    const auto take = [&](std::size_t place, std::size_t k) {
        const Status status = isolations_.status[k];
        // A hit whose surface was not found has nothing to show.
        if (status == Status::hit && !surfaces_.seen(k)) return;
        any_hit = any_hit || status == Status::hit;
        certain_[place] = status;
        middle_[place] = {light_.r[k], light_.g[k], light_.b[k]};
    };
    rays_.gather(
        picture_.view, canvas_.frame.width, canvas_.frame.height, rect,
        list.most_elements() >= Descent::parts_elements, [](int, int) { return true; },
        sampled_.samples_a_side);
    take_certain(list);
    for (std::size_t k = 0; k < rays_.size(); ++k) {
        const int i = rays_.place[k] % rect.width(), j = rays_.place[k] / rect.width();
        take(static_cast<std::size_t>((j + 1) * width + i + 1), k);
    }
    if (!any_hit) return;
    rays_.gather_ring(picture_.view, canvas_.frame.width, canvas_.frame.height, rect,
                      sampled_.samples_a_side);
    take_certain(list);
    for (std::size_t k = 0; k < rays_.size(); ++k) take(rays_.place[k], k);
}

// Which pixels are settled, and their means.
void SampleWorker::judge(const PixelRect& rect) {
    const std::ptrdiff_t row = rect.width() + 2;
    const double n = sampled_.samples_a_side;
    const double share = (n * n - 1) / (24 * n * n);
    for (int j = 0; j < rect.height(); ++j) {
        for (int i = 0; i < rect.width(); ++i) {
            const std::ptrdiff_t at = (j + 1) * row + i + 1;
            const auto place = static_cast<std::size_t>(j * rect.width() + i);
            const auto is_hit = [&](std::ptrdiff_t k) {
                return certain_[static_cast<std::size_t>(k)] == Status::hit;
            };
            if (certain_[static_cast<std::size_t>(at)] == Status::miss) {
                settled_[place] = 1;
                status_[place] = Status::miss;
            }
            if (!is_hit(at) || !is_hit(at - 1) || !is_hit(at + 1) || !is_hit(at - row) ||
                !is_hit(at + row)) {
                continue;
            }
            const bool before_in_row = i > 0 && is_hit(at - 2),
                       after_in_row = i + 1 < rect.width() && is_hit(at + 2),
                       before_in_column = j > 0 && is_hit(at - 2 * row),
                       after_in_column = j + 1 < rect.height() && is_hit(at + 2 * row);
            bool is_settled = true;
            const auto mean_of = [&](double Light::*channel) {
                const auto light = [&](std::ptrdiff_t k) {
                    return middle_[static_cast<std::size_t>(k)].*channel;
                };
                const auto second = [&](std::ptrdiff_t k, std::ptrdiff_t step) {
                    return light(k - step) - 2 * light(k) + light(k + step);
                };
                // What is left open along a row or a column, in `share`.
                const auto open = [&](std::ptrdiff_t step, bool has_before, bool has_after) {
                    const double here = second(at, step);
                    const double before = has_before ? second(at - step, step) : 0,
                                 after = has_after ? second(at + step, step) : 0;
                    const double most =
                        std::max({std::abs(before), std::abs(here), std::abs(after)});
                    if (!has_before || !has_after) return 4 * most;
                    const double change = std::abs(before - 2 * here + after);
                    return 2 * (change <= smooth * most ? change : most);
                };
                const double off = share * (open(1, before_in_row, after_in_row) +
                                            open(row, before_in_column, after_in_column));
                const double more = share * (second(at, 1) + second(at, row));
                const double mean = std::clamp(light(at) + more, 0.0, 1.0);
                const double darkest =
                    std::max(std::min(mean, light(at)) - std::abs(more) - off, 0.0);
                is_settled = is_settled && off * bytes_per_light(darkest) <= most_off;
                return mean;
            };
            const double r = mean_of(&Light::r), g = mean_of(&Light::g), b = mean_of(&Light::b);
            if (!is_settled) continue;
            settled_[place] = 1;
            status_[place] = Status::hit;
            sum_.r[place] = r;
            sum_.g[place] = g;
            sum_.b[place] = b;
        }
    }
}

bool SampleWorker::trace_rest(const PixelRect& rect, const ElementList& list) {
    const std::size_t size = rect.area();
    if (std::count(settled_.begin(), settled_.begin() + static_cast<std::ptrdiff_t>(size), 1) ==
        static_cast<std::ptrdiff_t>(size)) {
        return true;
    }
    const PixelRect all = times(rect, sampled_.samples_a_side);
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
    const int n = sampled_.samples_a_side;
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
    const double each = 1.0 / (sampled_.samples_a_side * sampled_.samples_a_side);
    std::array<std::uint16_t, 5>& count = sampled_.pixels[tile];
    count = {};
    for (int j = rect.y0; j < rect.y1; ++j) {
        for (int i = rect.x0; i < rect.x1; ++i) {
            const auto place = static_cast<std::size_t>((j - rect.y0) * rect.width() + i - rect.x0);
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
            sampled_.color[pixel] = {byte(sum_.r[place]), byte(sum_.g[place]), byte(sum_.b[place]),
                                     255};
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
