#include "core/render/tile_work.h"

#include <algorithm>
#include <cstring>

#include "core/render/camera_lanes.h"
#include "core/render/shade_lanes.h"
#include "core/trace/descent.h"
#include "core/trace/trace.h"

namespace ivory {

TileWorker::TileWorker(const Picture& picture, Canvas& canvas, const JobSettings& settings,
                       TileLists& lists, const std::atomic<bool>& stop)
    : picture_(picture), canvas_(canvas), settings_(settings), lists_(lists), stop_(stop) {
    recolored_.add(settings.recolored);
    if (settings.task != Task::shade) reached.resize(picture.field->size());
    counts.stop = Cancellation(stop);
    surfaces_.wants_elements = !canvas.looks.empty();
}

SampleWorker& TileWorker::sampler(SampledPicture& sampled) {
    if (sampler_ == nullptr) {
        sampler_ =
            std::make_unique<SampleWorker>(picture_, canvas_, sampled, lists_, stop_, counts);
    }
    return *sampler_;
}

void TileWorker::paint_empty(const PixelRect& rect) const {
    Frame& frame = canvas_.frame;
    std::array<Rgba8, TileGrid::block_side> row;
    row.fill(picture_.lighting.background);
    for (int j = rect.y0; j < rect.y1; ++j) {
        const std::size_t p = frame.at(rect.x0, j);
        std::fill_n(&frame.status[p], rect.width(), Status::miss);
        std::copy_n(row.begin(), rect.width(), &frame.color[p]);
    }
}

void TileWorker::leave_empty(std::size_t index) const {
    TileState& tile = canvas_.tiles[index];
    tile.traced = true;
    tile.empty = true;
    tile.pixels = {};
    tile.pixels[static_cast<std::size_t>(Status::miss)] =
        static_cast<std::uint16_t>(canvas_.grid.tiles.rect(index).area());
    tile.enclosure_width_max = 0;
    tile.unresolved_width_max = 0;
}

void TileWorker::mark_reached(const ElementList& list) {
    for (const std::uint32_t element : list.elements) reached[element] = 1;
    const std::vector<std::uint32_t>& first = picture_.field->clusters.first;
    for (const std::uint32_t cluster : list.clusters) {
        std::fill_n(&reached[first[cluster]], first[cluster + 1] - first[cluster], std::uint8_t{1});
    }
}

bool TileWorker::trace(std::size_t index) {
    if (!share(index)) return false;
    gather(index);
    const Field& field = *picture_.field;
    surfaces_.exact = !canvas_.frame.surface.empty();
    trace_bundle(field, canvas_.tiles[index].list, lists_.all(), tile_.rays, *picture_.method,
                 picture_.options, isolations_, wants_surface() ? &surfaces_ : nullptr, counts);
    if (stopped()) return false;
    const Clock::time_point traced_at = Clock::now();
    paint();
    commit(index);
    shading += Clock::now() - traced_at;
    return true;
}

// Sets what the tiles of a block share. False: cancelled on the way.
bool TileWorker::share(std::size_t tile) {
    if (common_.number == 0) {
        const std::size_t block = lists_.block_of(tile);
        if (!lists_.make_block(block, counts)) return false;
        common_ = lists_.common(block);
    }
    tile_.rays.common = common_.list->certainly_empty ? nullptr : &common_;
    return true;
}

void TileWorker::gather(std::size_t tile) {
    tile_.gather(picture_.view, canvas_.frame.width, canvas_.frame.height,
                 canvas_.grid.tiles.rect(tile),
                 canvas_.tiles[tile].list.most_elements() >= Descent::parts_elements,
                 [](int, int) { return true; });
}

// The surface at those m that are finite; the others keep theirs.
void TileWorker::find_surface(const ElementList& list,
                              const std::array<double, pixels_in_tile>& m) {
    picture_.method->surface_bundle(*picture_.field, list, tile_.rays, picture_.options,
                                    {m.data(), tile_.size()}, surfaces_, counts.stop);
}

// The colours of the surface in the light.
void TileWorker::paint() {
    if (!shaded()) return;
    shade_lanes(picture_.lighting, tile_.rays, surfaces_, {colors_.data(), tile_.size()});
}

// One of those runs.
template <std::size_t count>
void TileWorker::commit_run(std::size_t k, std::size_t p, bool colored, Looks* looks) const {
    Frame& frame = canvas_.frame;
    // Of a size that the compiler knows: no call.
    const auto copy = [](const auto& from, std::size_t at, auto& plane, std::size_t to) {
        std::memcpy(&plane[to], &from[at], count * sizeof(plane[to]));
    };
    copy(isolations_.status, k, frame.status, p);
    if (colored) copy(colors_, k, frame.color, p);
    const auto hit = [](Status status) { return possibly_hit(status); };
    if (std::none_of(&isolations_.status[k], &isolations_.status[k] + count, hit)) return;
    copy(isolations_.t_lo, k, frame.t_lo, p);
    copy(isolations_.t_hi, k, frame.t_hi, p);
    if (looks != nullptr) looks->take<count>(tile_.place[k], surfaces_, k);
    if (!frame.surface.empty()) copy(surfaces_.points, k, frame.surface, p);
}

void TileWorker::commit(std::size_t index) {
    TileState& tile = canvas_.tiles[index];
    const bool colored = settings_.task != Task::trace;
    Looks* const looks = canvas_.looks.empty() ? nullptr : &canvas_.looks[index];
    if (looks != nullptr) {
        looks->forget_all(pixels_in_tile);
        tile.looked_at = surfaces_.elements;
    }
    tile_.for_runs([&]<std::size_t count>(std::size_t k, std::size_t p) {
        commit_run<count>(k, p, colored, looks);
    });
    const BundleTally tally = tally_of(isolations_, tile_.size());
    for (std::size_t status = 0; status < tile.pixels.size(); ++status) {
        tile.pixels[status] = static_cast<std::uint16_t>(tally.rays[status]);
    }
    // Primary rays have length 1, so that a span of t is a length.
    tile.enclosure_width_max = tally.widest;
    tile.unresolved_width_max = tally.widest_unresolved;
    tile.traced = true;
    tile.empty = false;
}

// Whether an element with another colour than before is in the list.
bool TileWorker::reached_by_recolored(const ElementList& list) const {
    const bool in_clusters = !list.clusters.empty();
    const std::vector<std::uint32_t>& indices = in_clusters ? list.clusters : list.elements;
    auto from = indices.begin();
    for (const std::uint32_t element : settings_.recolored) {
        const std::uint32_t wanted = in_clusters ? picture_.field->clusters.of(element) : element;
        from = std::lower_bound(from, indices.end(), wanted);
        if (from == indices.end()) return false;
        if (*from == wanted) return true;
    }
    return false;
}

// Whether such an element may have had a share in what the tile looks like.
bool TileWorker::is_recolored(const TileState& tile) const {
    return tile.looked_at.meets(recolored_) && (!tile.has_list || reached_by_recolored(tile.list));
}

bool TileWorker::shade_again(std::size_t index) {
    Frame& frame = canvas_.frame;
    const TileState& tile = canvas_.tiles[index];
    const Clock::time_point start = Clock::now();
    if (tile.empty) {
        paint_empty(canvas_.grid.tiles.rect(index));
        leave_empty(index);
    } else if (tile.traced) {
        if (stopped()) return false;
        const bool looks_hold =
            !canvas_.looks.empty() && frame.surface.empty() && !is_recolored(tile);
        if (looks_hold) {
            paint_looks(index);
        } else if (!share(index) || !look_again(index)) {
            return false;
        }
    }
    shading += Clock::now() - start;
    return true;
}

// A whole tile from what is known of its surface.
void TileWorker::paint_looks(std::size_t index) {
    Frame& frame = canvas_.frame;
    const PixelRect rect = canvas_.grid.tiles.rect(index);
    const Looks& looks = canvas_.looks[index];
    const auto width = static_cast<std::size_t>(rect.width());
    const std::size_t count = rect.area();
    // Directions are not needed where vectors of pixels have no surface.
    constexpr std::size_t together = 16;
    const TilePlane plane(picture_.view, frame.width, frame.height, rect);
    alignas(64) std::array<double, together> u, v;
    RayBundle& rays = tile_.rays;
    for (std::size_t first = 0; first < count; first += together) {
        const std::size_t end = std::min(first + together, count);
        if (!looks.any(first, end)) continue;
        for (std::size_t k = first; k < end; ++k) {
            u[k - first] = plane.u[k % width];
            v[k - first] = plane.v[k / width];
        }
        primary_directions(picture_.view, end - first, u.data(), v.data(), &rays.dx[first],
                           &rays.dy[first], &rays.dz[first]);
    }
    shade_lanes(picture_.lighting, rays, looks, {colors_.data(), count});
    for (int j = rect.y0; j < rect.y1; ++j) {
        const auto* const from = &colors_[static_cast<std::size_t>(j - rect.y0) * width];
        std::copy_n(from, width, &frame.color[frame.at(rect.x0, j)]);
    }
}

// The surface and its colours at the t that stand in the frame. False: cancelled on the way.
bool TileWorker::look_again(std::size_t index) {
    Frame& frame = canvas_.frame;
    TileState& tile = canvas_.tiles[index];
    Looks* const looks = canvas_.looks.empty() ? nullptr : &canvas_.looks[index];
    gather(index);
    surfaces_.exact = !frame.surface.empty();
    surfaces_.clear(tile_.size());
    std::array<double, pixels_in_tile> m;
    tile_.for_runs([&]<std::size_t count>(std::size_t k, std::size_t p) {
        for (std::size_t i = 0; i < count; ++i) {
            const bool hit = possibly_hit(frame.status[p + i]);
            m[k + i] = hit ? midpoint(frame.t(p + i)) : infinity<double>;
        }
    });
    find_surface(tile.list, m);
    if (stopped()) return false;
    tile.looked_at = surfaces_.elements;
    paint();
    tile_.for_runs([&]<std::size_t count>(std::size_t k, std::size_t p) {
        std::copy_n(&colors_[k], count, &frame.color[p]);
        if (looks != nullptr) looks->take<count>(tile_.place[k], surfaces_, k);
        if (frame.surface.empty()) return;
        for (std::size_t i = 0; i < count; ++i) {
            if (!possibly_hit(frame.status[p + i])) continue;
            frame.surface[p + i] = surfaces_.points[k + i];
        }
    });
    return true;
}

}  // namespace ivory
