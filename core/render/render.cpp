#include "core/render/render.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <condition_variable>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <mutex>
#include <optional>
#include <span>
#include <system_error>
#include <thread>
#include <utility>

#include "core/render/camera_lanes.h"
#include "core/render/shade_lanes.h"
#include "core/trace/descent.h"
#include "core/trace/trace.h"

namespace ivory {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int tile_side = TileGrid::tile_side;
constexpr std::size_t pixels_in_tile = tile_side * tile_side;

// The pixels of a tile between tracing and the frame: nothing of a tile is written before all of it
// is known, so that a cancelled tile stays what it was.
struct TracedTile {
    RayBundle rays;
    std::array<std::uint32_t, pixels_in_tile> pixel;  // in the frame
    std::array<std::uint16_t, pixels_in_tile> place;  // in the tile, row by row
    BundleIsolations isolations;
    BundleSurfaces surfaces;
    alignas(64) std::array<Rgba8, pixels_in_tile> colors;

    [[nodiscard]] std::size_t size() const { return rays.size(); }
};

// Where the columns and rows of a tile pass the plane before the camera.
struct TilePlane {
    std::array<double, tile_side> u, v;

    TilePlane(const View& view, const Frame& frame, const PixelRect& rect) {
        for (int i = rect.x0; i < rect.x1; ++i)
            u[static_cast<std::size_t>(i - rect.x0)] = plane_u(view, frame.width, frame.height, i);
        for (int j = rect.y0; j < rect.y1; ++j)
            v[static_cast<std::size_t>(j - rect.y0)] = plane_v(view, frame.height, j);
    }
};

// What a worker works on and adds up for itself, and the report gets at its end; in cache lines of
// its own.
struct alignas(128) Tally {
    Counts counts;
    CommonBundle common;  // of the block that is being worked on; number 0: nobody has asked yet
    Clock::duration tracing{}, shading{};
    std::size_t tiles = 0;
    std::vector<std::uint8_t> reached;  // by element
    std::unique_ptr<TracedTile> traced;
};

// The first pass has at least so many pixels, where a tile's share of them is no more than 4.
constexpr std::size_t least_first_pixels = 128;

std::vector<int> strides_of(const JobSettings& settings, std::size_t tiles) {
    if (settings.order != Order::coarse_to_fine || settings.task == Task::shade) return {1};
    int stride = TileGrid::block_side;
    for (std::size_t squares = tiles / 16; stride > 8 && squares < least_first_pixels;
         squares *= 4) {
        stride /= 2;
    }
    // Each pass bounds the field on its windows anew: more passes between would cost more than they
    // show.
    if (stride > tile_side) return {stride, 8, 1};
    return {stride, 1};
}

// Whether column and row, counted from the picture's corner, fall on the stride: those of a tile do
// so alike, its corner being a multiple of 16.
bool on_stride(int i, int j, int stride) { return i % stride == 0 && j % stride == 0; }
int first_on(int stride, int from) { return (from + stride - 1) / stride * stride; }

// Calls visit(square) for the squares of that side that a rectangle of twice the side consists of.
template <class Visit>
void for_quarters(const PixelRect& rect, int side, const Visit& visit) {
    for (int y = rect.y0; y < rect.y1; y += side)
        for (int x = rect.x0; x < rect.x1; x += side)
            visit(PixelRect{x, y, std::min(x + side, rect.x1), std::min(y + side, rect.y1)});
}

}  // namespace

// The work is a sequence of steps, dealt out by one atomic number:
//
//   step 0 ..                the lists of the regions that hold a block without lists
//   then, for each stride    the blocks, first those around the focus
//
// A step waits for the one that it builds on: a block of the first pass for its region, one of a
// later pass for the same block in the pass before. That one has a smaller number and so is being
// done already; by induction somebody always gets on.
class FrameJob::Work {
  public:
    Work(Picture picture, Canvas& canvas, JobSettings settings)
        : picture_(std::move(picture)),
          canvas_(canvas),
          settings_(std::move(settings)),
          all_(all_elements(*picture_.field)),
          all_clusters_(picture_.options.skipping.lists ? all_clusters(*picture_.field) : all_),
          region_lists_(canvas.grid.regions.size()),
          region_done_(canvas.grid.regions.size()),
          block_lists_(canvas.grid.blocks.size()),
          tile_begun_(canvas.grid.tiles.size()),
          passes_done_(canvas.grid.blocks.size()) {
        recolored_.add(settings_.recolored);
        plan();
    }

    void start() {
        started_ = Clock::now();
        const int threads = std::max(settings_.threads, 1);
        tallies_.resize(static_cast<std::size_t>(threads));
        running_ = threads;
        for (Tally& tally : tallies_) {
            try {
                if (threads > 1) {
                    workers_.emplace_back([this, &tally] { work(tally, std::nullopt); });
                    continue;
                }
            } catch (const std::system_error&) {
                // Fewer workers do the same work.
            }
            if (workers_.empty() && &tally == &tallies_.back()) {
                own_ = &tally;
            } else {
                leave();
            }
        }
    }

    void cancel() noexcept { stop_.store(true, std::memory_order_relaxed); }

    bool finished() const {
        const std::lock_guard lock(mutex_);
        return running_ == 0;
    }

    bool wait_for(std::chrono::milliseconds time) {
        if (own_ != nullptr) do_own_work(Clock::now() + time);
        if (own_ != nullptr) return false;
        std::unique_lock lock(mutex_);
        return ended_.wait_for(lock, time, [this] { return running_ == 0; });
    }

    JobReport finish() {
        if (own_ != nullptr) do_own_work(std::nullopt);
        workers_.clear();  // joins
        if (failure_) std::rethrow_exception(failure_);
        JobReport report;
        report.complete = !cut_short_.load();
        report.seconds = std::chrono::duration<double>(finished_ - started_).count();
        Clock::duration tracing{}, shading{};
        std::vector<std::uint8_t> reached(picture_.field->size());
        for (const Tally& tally : tallies_) {
            report.counts += tally.counts;
            report.tiles_traced += tally.tiles;
            tracing += tally.tracing;
            shading += tally.shading;
            for (std::size_t e = 0; e < tally.reached.size(); ++e) reached[e] |= tally.reached[e];
        }
        const auto both = static_cast<double>((tracing + shading).count());
        report.shade_share = both > 0 ? static_cast<double>(shading.count()) / both : 0;
        report.elements_reached =
            static_cast<std::size_t>(std::count(reached.begin(), reached.end(), 1));
        return report;
    }

    double progress() const noexcept {
        const std::size_t dealt = std::min(next_.load(std::memory_order_relaxed), steps_);
        return steps_ == 0 ? 1 : static_cast<double>(dealt) / static_cast<double>(steps_);
    }

  private:
    const Squares& tiles() const { return canvas_.grid.tiles; }
    const Squares& blocks() const { return canvas_.grid.blocks; }
    const Squares& regions() const { return canvas_.grid.regions; }
    bool selected(std::size_t tile) const {
        return settings_.selected.empty() || settings_.selected[tile] != 0;
    }

    void plan() {
        std::vector<std::uint8_t> needed(regions().size());
        for (std::size_t block = 0; block < blocks().size(); ++block) {
            const PixelRect rect = blocks().rect(block);
            bool any = false;
            bool wants_list = false;  // to trace, one for all that the block's tiles share
            for_squares_in(tiles(), rect, [&](std::size_t tile) {
                if (!selected(tile)) return;
                any = true;
                wants_list =
                    wants_list || settings_.task != Task::shade || !canvas_.tiles[tile].has_list;
            });
            if (any) block_order_.push_back(block);
            if (wants_list) needed[regions().at(rect.x0, rect.y0)] = 1;
        }
        if (settings_.order == Order::coarse_to_fine) begin_at_focus();

        region_is_planned_ = needed;
        // The regions in the order in which the blocks will ask for them.
        for (const std::size_t block : block_order_) {
            const std::size_t region = region_of(block);
            if (needed[region] == 0) continue;
            needed[region] = 0;
            region_order_.push_back(region);
        }
        std::size_t tile_count = 0;
        for (std::size_t tile = 0; tile < tiles().size(); ++tile) tile_count += selected(tile);
        strides_ = strides_of(settings_, tile_count);
        steps_ = region_order_.size() + strides_.size() * block_order_.size();
    }

    void begin_at_focus() {
        const bool given = settings_.focus_i >= 0 && settings_.focus_j >= 0;
        const long focus_i = given ? settings_.focus_i : canvas_.frame.width / 2;
        const long focus_j = given ? settings_.focus_j : canvas_.frame.height / 2;
        const auto distance = [&](std::size_t block) {
            const PixelRect rect = blocks().rect(block);
            const long i = (rect.x0 + rect.x1) / 2 - focus_i;
            const long j = (rect.y0 + rect.y1) / 2 - focus_j;
            return i * i + j * j;
        };
        std::stable_sort(block_order_.begin(), block_order_.end(),
                         [&](std::size_t a, std::size_t b) { return distance(a) < distance(b); });
    }

    std::size_t region_of(std::size_t block) const {
        const PixelRect rect = blocks().rect(block);
        return regions().at(rect.x0, rect.y0);
    }

    bool stopped() const { return stop_.load(std::memory_order_relaxed); }

    // Until there is nothing left to do, or for at least one step that time has come. Whether this
    // worker has left.
    bool work(Tally& tally, std::optional<Clock::time_point> until) {
        try {
            const Clock::time_point start = Clock::now();
            const Clock::duration shading_before = tally.shading;
            if (tally.traced == nullptr) prepare(tally);
            bool in_time = true;
            while (in_time && !stopped()) {
                const std::size_t step = next_.fetch_add(1, std::memory_order_relaxed);
                if (step >= steps_) break;
                if (!take(step, tally)) cut_short_ = true;
                in_time = !until || Clock::now() < *until;
            }
            tally.tracing += Clock::now() - start - (tally.shading - shading_before);
            if (!in_time) return false;
            if (next_.load(std::memory_order_relaxed) < steps_) cut_short_ = true;
        } catch (...) {
            const std::lock_guard lock(mutex_);
            if (!failure_) failure_ = std::current_exception();
            cancel();
        }
        leave();
        return true;
    }

    void prepare(Tally& tally) const {
        if (settings_.task != Task::shade) tally.reached.resize(picture_.field->size());
        tally.counts.stop = Cancellation(stop_);
        tally.traced = std::make_unique<TracedTile>();
        tally.traced->surfaces.wants_elements = !canvas_.looks.empty();
    }

    void do_own_work(std::optional<Clock::time_point> until) {
        if (work(*own_, until)) own_ = nullptr;
    }

    void leave() {
        const std::lock_guard lock(mutex_);
        if (--running_ > 0) return;
        finished_ = Clock::now();
        ended_.notify_all();
    }

    // False: cancelled on the way.
    bool take(std::size_t step, Tally& tally) {
        if (step < region_order_.size()) {
            const std::size_t region = region_order_[step];
            region_lists_[region] = narrowed(all_clusters_, regions().rect(region), tally);
            region_done_[region].store(1, std::memory_order_release);
            return true;
        }
        step -= region_order_.size();
        const std::size_t pass = step / block_order_.size();
        const std::size_t block = block_order_[step % block_order_.size()];
        if (pass > 0 && !wait_until(passes_done_[block], static_cast<int>(pass))) return false;
        if (!take_block(block, pass, tally)) return false;
        passes_done_[block].store(static_cast<int>(pass) + 1, std::memory_order_release);
        return true;
    }

    // Short: whoever is at it has at most the rest of one step to do.
    bool wait_until(const std::atomic<int>& done, int least) const {
        while (done.load(std::memory_order_acquire) < least) {
            if (stopped()) return false;
            std::this_thread::yield();
        }
        return true;
    }

    ElementList narrowed(const ElementList& parent, const PixelRect& rect, Tally& tally) const {
        if (parent.certainly_empty || !picture_.options.skipping.lists) return parent;
        const Frame& frame = canvas_.frame;
        ElementList list = reaching_clusters(
            *picture_.field, parent, cone_around(picture_.view, frame.width, frame.height, rect));
        tally.counts.skipping.list_elements += parent.size();
        tally.counts.skipping.list_left_out += parent.size() - list.size();
        return list;
    }

    bool take_block(std::size_t block, std::size_t pass, Tally& tally) {
        const PixelRect rect = blocks().rect(block);
        tally.common.number = 0;
        if (pass == 0 && !list_tiles_of(block, tally)) return false;
        // Of a square larger than a tile the first tile alone, unless all are done at once.
        const bool sparse = strides_[pass] > tile_side && !is_listed_empty(block);
        const int square = sparse ? strides_[pass] : tile_side;
        std::uint32_t begun = 0;  // squares, one bit each
        bool done = true;
        const bool painted = paints_at_once(block, pass);
        if (painted) paint_empty(rect);
        for_squares_in(tiles(), rect, [&](std::size_t tile) {
            if (!done || !selected(tile)) return;
            const PixelRect corner = tiles().rect(tile);
            const int column = (corner.x0 - rect.x0) / square;
            const int row = (corner.y0 - rect.y0) / square;
            const std::uint32_t bit = 1u << (row * (TileGrid::block_side / square) + column);
            if (sparse && (begun & bit) != 0) return;
            begun |= bit;
            done = take_tile(tile, block, pass, square, painted, tally);
        });
        if (strides_[pass] <= tile_side) block_lists_[block].reset();  // each tile has its own
        return done;
    }

    bool is_listed_empty(std::size_t block) const {
        return block_lists_[block] && block_lists_[block]->certainly_empty;
    }

    // Whether all tiles of the block are empty, and this job's, and not all painted so already.
    bool paints_at_once(std::size_t block, std::size_t pass) const {
        // Shading tells by what a tile shows whether it is to be painted.
        if (pass > 0 || settings_.task == Task::shade) return false;
        if (!is_listed_empty(block)) return false;
        bool all = true, all_stand = true;
        for_squares_in(tiles(), blocks().rect(block), [&](std::size_t tile) {
            all = all && selected(tile) && !canvas_.tiles[tile].has_list;
            all_stand = all_stand && stands_empty(tile);
        });
        return all && !all_stand;
    }

    bool stands_empty(std::size_t index) const {
        return canvas_.stands_empty(index, picture_.lighting.background);
    }

    // The block's list, where one of its tiles will need it for its own. False: cancelled on the
    // way.
    bool list_tiles_of(std::size_t block, Tally& tally) {
        bool needed = false;
        for_squares_in(tiles(), blocks().rect(block), [&](std::size_t tile) {
            needed = needed || (selected(tile) && !canvas_.tiles[tile].has_list);
        });
        return !needed || list_block(block, tally);
    }

    bool list_block(std::size_t block, Tally& tally) {
        if (block_lists_[block]) return true;
        // The same from either, so that it does not matter who else asks for the region's.
        const std::size_t region = region_of(block);
        const bool planned = region_is_planned_[region] != 0;
        if (planned && !wait_until(region_done_[region], 1)) return false;
        block_lists_[block] =
            narrowed(planned ? region_lists_[region]
                             : narrowed(all_clusters_, regions().rect(region), tally),
                     blocks().rect(block), tally);
        return true;
    }

    // Sets what the tiles of a block share. False: cancelled on the way.
    bool share(std::size_t tile, Tally& tally) {
        static std::atomic<std::uint64_t> numbers{0};
        CommonBundle& common = tally.common;
        if (common.number == 0) {
            const PixelRect corner = tiles().rect(tile);
            const std::size_t block = blocks().at(corner.x0, corner.y0);
            if (!list_block(block, tally)) return false;
            common.bundle = bundle_around(picture_.view, canvas_.frame.width, canvas_.frame.height,
                                          blocks().rect(block));
            common.list = &*block_lists_[block];
            common.number = numbers.fetch_add(1, std::memory_order_relaxed) + 1;
        }
        tally.traced->rays.common = common.list->certainly_empty ? nullptr : &common;
        return true;
    }

    // `painted`: where it is empty it has its colour already.
    bool take_tile(std::size_t index, std::size_t block, std::size_t pass, int square, bool painted,
                   Tally& tally) {
        if (stopped()) return false;
        TileState& tile = canvas_.tiles[index];
        const bool first = tile_begun_[index] == 0;
        const bool last = pass + 1 == strides_.size();
        if (!first && strides_[pass] >= tile_side) return true;  // it has its one pixel
        tile_begun_[index] = 1;
        if (first) {
            if (!tile.has_list) {
                tile.list = narrowed(*block_lists_[block], tiles().rect(index), tally);
                tile.has_list = true;
            }
            ++tally.tiles;
            if (settings_.task != Task::shade && !tile.list.certainly_empty) {
                mark_reached(tile.list, tally);
            }
        }
        bool done = true, same = false;
        if (settings_.task == Task::shade) {
            same = stands_empty(index);
            done = same || shade_again(index, tally);
        } else if (!tile.list.certainly_empty) {
            // Of a larger square the one pixel of the first tile that is selected, wherever that is.
            done = trace_tile(index, std::min(strides_[pass], tile_side), first, tally);
        } else if (first) {
            same = !painted && stands_empty(index);
            if (!painted && !same) paint_empty(tiles().rect(index));
            leave_empty(index);
        }
        const bool has_new = first || !tile.list.certainly_empty;
        if (done && has_new) notify(index, square, same);
        if (done && last && !settings_.keep_lists) {
            tile.has_list = false;
            tile.list = {};
        }
        return done;
    }

    void notify(std::size_t tile, int square, bool same) const {
        if (settings_.on_tile) {
            settings_.on_tile({tile, tiles().rect(tile), canvas_.tiles[tile].stride, square, same});
        }
    }

    // Misses, all over the rectangle.
    void paint_empty(const PixelRect& rect) const {
        Frame& frame = canvas_.frame;
        std::array<Rgba8, TileGrid::block_side> row;
        row.fill(picture_.lighting.background);
        for (int j = rect.y0; j < rect.y1; ++j) {
            const std::size_t p = frame.at(rect.x0, j);
            std::fill_n(&frame.status[p], rect.width(), Status::miss);
            std::copy_n(row.begin(), rect.width(), &frame.color[p]);
        }
    }

    void leave_empty(std::size_t index) const {
        TileState& tile = canvas_.tiles[index];
        tile.stride = 1;
        tile.empty = true;
        tile.pixels = {};
        tile.pixels[static_cast<std::size_t>(Status::miss)] =
            static_cast<std::uint16_t>(tiles().rect(index).area());
        tile.enclosure_width_max = 0;
        tile.unresolved_width_max = 0;
    }

    bool trace_tile(std::size_t index, int stride, bool first, Tally& tally) {
        const TileState& tile = canvas_.tiles[index];
        TracedTile& traced = *tally.traced;
        if (!share(index, tally)) return false;
        gather(traced, index, stride, first ? 0 : tile.stride);
        BundleIsolations& isolations = traced.isolations;
        const Field& field = *picture_.field;
        traced.surfaces.exact = !canvas_.frame.surface.empty();
        trace_bundle(field, tile.list, all_, traced.rays, *picture_.method, picture_.options,
                     isolations, wants_surface() ? &traced.surfaces : nullptr, tally.counts);
        if (stopped()) return false;
        const Clock::time_point traced_at = Clock::now();
        paint(traced);
        commit(index, stride, first, traced);
        tally.shading += Clock::now() - traced_at;
        return true;
    }

    // The rays of the tile's pixels on `stride` but not on `coarser` (0: none is left out), in
    // groups of 4 x 4 pixels within groups of 8 x 8, since neighbours walk alike.
    void gather(TracedTile& traced, std::size_t index, int stride, int coarser,
                bool with_parts = true) const {
        const Frame& frame = canvas_.frame;
        const PixelRect rect = tiles().rect(index);
        RayBundle& rays = traced.rays;
        rays.part_count = 0;
        const bool in_parts =
            with_parts && canvas_.tiles[index].list.most_elements() >= Descent::parts_elements;
        const bool is_whole = rect.width() == tile_side && rect.height() == tile_side;
        TileBundles bundles;
        if (in_parts && is_whole) {
            bundles = tile_bundles(picture_.view, frame.width, frame.height, rect.x0, rect.y0);
        }
        // The one of that number, or of that rectangle where the tile is cut off.
        const auto bundle = [&](std::size_t number, const PixelRect& part_of_tile) {
            return in_parts && is_whole
                       ? bundles[number]
                       : bundle_around(picture_.view, frame.width, frame.height, part_of_tile);
        };
        const auto add_part = [&](std::size_t number, const PixelRect& part_of_tile) {
            const Bundle of_part = bundle(number, part_of_tile);
            rays.add_part({.axis = of_part.axis, .spread = of_part.spread});
        };
        rays.bundle = bundle(0, rect);
        if (in_parts) {
            rays.add_part({.axis = rays.bundle.axis, .spread = rays.bundle.spread});
            rays.parts[0].first_part = 1;
            std::size_t number = 1;
            for_quarters(rect, 8, [&](const PixelRect& quarter) { add_part(number++, quarter); });
            rays.parts[0].end_of_parts = static_cast<std::uint32_t>(rays.part_count);
        }
        std::size_t count = 0, part = 1, square_number = 5;
        alignas(64) std::array<double, pixels_in_tile> u, v;
        const TilePlane plane(picture_.view, frame, rect);
        for_quarters(rect, 8, [&](const PixelRect& quarter) {
            BundlePart& of_quarter = rays.parts[part++];
            of_quarter.first = static_cast<std::uint32_t>(count);
            of_quarter.first_part = static_cast<std::uint32_t>(rays.part_count);
            for_quarters(quarter, 4, [&](const PixelRect& square) {
                const auto first = static_cast<std::uint32_t>(count);
                for (int j = first_on(stride, square.y0); j < square.y1; j += stride) {
                    for (int i = first_on(stride, square.x0); i < square.x1; i += stride) {
                        if (coarser > 0 && on_stride(i, j, coarser)) continue;
                        u[count] = plane.u[static_cast<std::size_t>(i - rect.x0)];
                        v[count] = plane.v[static_cast<std::size_t>(j - rect.y0)];
                        traced.place[count] =
                            static_cast<std::uint16_t>((j - rect.y0) * rect.width() + i - rect.x0);
                        traced.pixel[count++] = static_cast<std::uint32_t>(frame.at(i, j));
                    }
                }
                const std::size_t number = square_number++;
                if (!in_parts || first == count) return;
                add_part(number, square);
                rays.parts[rays.part_count - 1].first = first;
                rays.parts[rays.part_count - 1].end = static_cast<std::uint32_t>(count);
            });
            of_quarter.end = static_cast<std::uint32_t>(count);
            of_quarter.end_of_parts = static_cast<std::uint32_t>(rays.part_count);
        });
        rays.count = count;
        primary_directions(picture_.view, count, u.data(), v.data(), rays.dx.data(), rays.dy.data(),
                           rays.dz.data());
    }

    bool shaded() const { return settings_.task != Task::trace; }
    bool wants_surface() const {
        return shaded() || !canvas_.frame.surface.empty() || !canvas_.looks.empty();
    }

    // The surface at those m that are finite; the others keep theirs.
    void find_surface(TracedTile& traced, const ElementList& list,
                      const std::array<double, pixels_in_tile>& m, Cancellation& stop) const {
        picture_.method->surface_bundle(*picture_.field, list, traced.rays, picture_.options,
                                        {m.data(), traced.size()}, traced.surfaces, stop);
    }

    // The colours of the surface in the light.
    void paint(TracedTile& traced) const {
        if (!shaded()) return;
        shade_lanes(picture_.lighting, traced.rays, traced.surfaces,
                    {traced.colors.data(), traced.size()});
    }

    void commit(std::size_t index, int stride, bool first, const TracedTile& traced) {
        TileState& tile = canvas_.tiles[index];
        if (first) {
            tile.empty = false;
            tile.pixels = {};
            tile.enclosure_width_max = 0;
            tile.unresolved_width_max = 0;
        }
        const bool colored = settings_.task != Task::trace;
        Looks* const looks = canvas_.looks.empty() ? nullptr : &canvas_.looks[index];
        if (looks != nullptr) {
            if (first) {
                looks->forget_all(pixels_in_tile);
                tile.looked_at = {};
            }
            tile.looked_at.add(traced.surfaces.elements);
        }
        const BundleIsolations& isolations = traced.isolations;
        for_runs(traced, [&]<std::size_t count>(std::size_t k, std::size_t p) {
            commit_run<count>(traced, k, p, colored, looks);
        });
        const BundleTally tally = tally_of(isolations, traced.size());
        for (std::size_t status = 0; status < tile.pixels.size(); ++status) {
            tile.pixels[status] += static_cast<std::uint16_t>(tally.rays[status]);
        }
        // Primary rays have length 1, so that a span of t is a length.
        tile.enclosure_width_max = std::max(tile.enclosure_width_max, tally.widest);
        tile.unresolved_width_max = std::max(tile.unresolved_width_max, tally.widest_unresolved);
        tile.stride = stride;
    }

    // Calls visit.operator()<count>(k, p) for runs of rays, from k on, whose pixels stand side by
    // side in a row of the frame, from p on.
    template <class Visit>
    static void for_runs(const TracedTile& traced, const Visit& visit) {
        for (std::size_t k = 0; k < traced.size();) {
            const std::size_t p = traced.pixel[k];
            if (k + 4 <= traced.size() && traced.pixel[k + 3] == p + 3) {
                visit.template operator()<4>(k, p);
                k += 4;
            } else {
                visit.template operator()<1>(k, p);
                k += 1;
            }
        }
    }

    // One of those runs.
    template <std::size_t count>
    void commit_run(const TracedTile& traced, std::size_t k, std::size_t p, bool colored,
                    Looks* looks) const {
        Frame& frame = canvas_.frame;
        const BundleIsolations& isolations = traced.isolations;
        // Of a size that the compiler knows: no call.
        const auto copy = [](const auto& from, std::size_t at, auto& plane, std::size_t to) {
            std::memcpy(&plane[to], &from[at], count * sizeof(plane[to]));
        };
        copy(isolations.status, k, frame.status, p);
        if (colored) copy(traced.colors, k, frame.color, p);
        const auto hit = [](Status status) { return possibly_hit(status); };
        if (std::none_of(&isolations.status[k], &isolations.status[k] + count, hit)) return;
        copy(isolations.t_lo, k, frame.t_lo, p);
        copy(isolations.t_hi, k, frame.t_hi, p);
        if (looks != nullptr) looks->take<count>(traced.place[k], traced.surfaces, k);
        if (!frame.surface.empty()) copy(traced.surfaces.points, k, frame.surface, p);
    }

    // Whether an element with another colour than before is in the list.
    bool reached_by_recolored(const ElementList& list) const {
        const bool in_clusters = !list.clusters.empty();
        const std::vector<std::uint32_t>& indices = in_clusters ? list.clusters : list.elements;
        auto from = indices.begin();
        for (const std::uint32_t element : settings_.recolored) {
            const std::uint32_t wanted =
                in_clusters ? picture_.field->clusters.of(element) : element;
            from = std::lower_bound(from, indices.end(), wanted);
            if (from == indices.end()) return false;
            if (*from == wanted) return true;
        }
        return false;
    }

    // Whether such an element may have had a share in what the tile looks like.
    bool is_recolored(const TileState& tile) const {
        return tile.looked_at.meets(recolored_) &&
               (!tile.has_list || reached_by_recolored(tile.list));
    }

    void mark_reached(const ElementList& list, Tally& tally) const {
        for (const std::uint32_t element : list.elements) tally.reached[element] = 1;
        const std::vector<std::uint32_t>& first = picture_.field->clusters.first;
        for (const std::uint32_t cluster : list.clusters) {
            std::fill_n(&tally.reached[first[cluster]], first[cluster + 1] - first[cluster],
                        std::uint8_t{1});
        }
    }

    // Colours, lights and background anew, from the t that stand in the frame.
    bool shade_again(std::size_t index, Tally& tally) {
        Frame& frame = canvas_.frame;
        const TileState& tile = canvas_.tiles[index];
        const Clock::time_point start = Clock::now();
        if (tile.empty) {
            paint_empty(tiles().rect(index));
            leave_empty(index);
        } else if (tile.stride != 0) {  // else nothing is traced
            if (stopped()) return false;
            const bool looks_hold =
                !canvas_.looks.empty() && frame.surface.empty() && !is_recolored(tile);
            if (looks_hold && tile.stride == 1) {
                paint_looks(index, *tally.traced);
            } else {
                if (!looks_hold && !share(index, tally)) return false;
                if (!look_again(index, looks_hold, tally)) return false;
            }
        }
        tally.shading += Clock::now() - start;
        return true;
    }

    // A whole tile from what is known of its surface.
    void paint_looks(std::size_t index, TracedTile& traced) {
        Frame& frame = canvas_.frame;
        const PixelRect rect = tiles().rect(index);
        const Looks& looks = canvas_.looks[index];
        const auto width = static_cast<std::size_t>(rect.width());
        const std::size_t count = rect.area();
        // Directions are not needed where vectors of pixels have no surface.
        constexpr std::size_t together = 16;
        const TilePlane plane(picture_.view, frame, rect);
        alignas(64) std::array<double, together> u, v;
        RayBundle& rays = traced.rays;
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
        shade_lanes(picture_.lighting, rays, looks, {traced.colors.data(), count});
        for (int j = rect.y0; j < rect.y1; ++j) {
            const auto* const from = &traced.colors[static_cast<std::size_t>(j - rect.y0) * width];
            std::copy_n(from, width, &frame.color[frame.at(rect.x0, j)]);
        }
    }

    // The surface and its colours at the t that stand in the frame, unless they are known. False:
    // cancelled on the way.
    bool look_again(std::size_t index, bool looks_hold, Tally& tally) {
        TracedTile& traced = *tally.traced;
        Frame& frame = canvas_.frame;
        TileState& tile = canvas_.tiles[index];
        Looks* const looks = canvas_.looks.empty() ? nullptr : &canvas_.looks[index];
        gather(traced, index, tile.stride, 0, !looks_hold);
        traced.surfaces.exact = !frame.surface.empty();
        traced.surfaces.clear(traced.size());
        std::array<double, pixels_in_tile> m;
        for_runs(traced, [&]<std::size_t count>(std::size_t k, std::size_t p) {
            for (std::size_t i = 0; i < count; ++i) {
                const bool hit = possibly_hit(frame.status[p + i]);
                m[k + i] = hit ? midpoint(frame.t(p + i)) : infinity<double>;
            }
            if (looks_hold) traced.surfaces.take<count>(k, *looks, traced.place[k]);
        });
        if (!looks_hold) {
            find_surface(traced, tile.list, m, tally.counts.stop);
            if (stopped()) return false;
            tile.looked_at = traced.surfaces.elements;
        }
        paint(traced);
        for_runs(traced, [&]<std::size_t count>(std::size_t k, std::size_t p) {
            std::copy_n(&traced.colors[k], count, &frame.color[p]);
            if (looks != nullptr && !looks_hold) {
                looks->take<count>(traced.place[k], traced.surfaces, k);
            }
            if (frame.surface.empty()) return;
            for (std::size_t i = 0; i < count; ++i) {
                if (!possibly_hit(frame.status[p + i])) continue;
                frame.surface[p + i] = traced.surfaces.points[k + i];
            }
        });
        return true;
    }

    const Picture picture_;
    Canvas& canvas_;
    const JobSettings settings_;
    std::vector<int> strides_;  // pass by pass
    const ElementList all_, all_clusters_;
    ElementFilter recolored_;

    std::vector<std::size_t> region_order_, block_order_;
    std::size_t steps_ = 0;
    std::atomic<std::size_t> next_{0};
    std::vector<ElementList> region_lists_;
    std::vector<std::atomic<int>> region_done_;
    std::vector<std::uint8_t> region_is_planned_;
    std::vector<std::optional<ElementList>> block_lists_;  // while somebody is at the block's tiles
    std::vector<std::uint8_t> tile_begun_;  // by this job; whoever is at the tile's block uses it
    std::vector<std::atomic<int>> passes_done_;  // by block

    std::atomic<bool> stop_{false};
    std::atomic<bool> cut_short_{false};
    Clock::time_point started_, finished_;

    mutable std::mutex mutex_;
    mutable std::condition_variable ended_;
    int running_ = 0;
    std::exception_ptr failure_;
    std::vector<Tally> tallies_;
    Tally* own_ = nullptr;  // the caller's, who works where no workers do; null: none, or done
    std::vector<std::jthread> workers_;  // last: joined before anything that they use is gone
};

FrameJob::FrameJob(Picture picture, Canvas& canvas, JobSettings settings)
    : work_(std::make_unique<Work>(std::move(picture), canvas, std::move(settings))) {
    work_->start();
}

FrameJob::~FrameJob() { cancel(); }

void FrameJob::cancel() noexcept { work_->cancel(); }

bool FrameJob::finished() const { return work_->finished(); }

bool FrameJob::wait_for(std::chrono::milliseconds time) { return work_->wait_for(time); }

JobReport FrameJob::finish() { return work_->finish(); }

double FrameJob::progress() const noexcept { return work_->progress(); }

JobReport render(const Picture& picture, Canvas& canvas, const JobSettings& settings) {
    return FrameJob(picture, canvas, settings).finish();
}

}  // namespace ivory
