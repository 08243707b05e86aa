#include "app/viewer/render_session.h"

#ifdef __linux__
#include <sys/resource.h>
#endif

#include <algorithm>
#include <array>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <iterator>
#include <limits>
#include <mutex>
#include <new>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

#include "app/viewer/touched_tiles.h"
#include "core/field/field.h"
#include "core/render/camera.h"
#include "core/render/canvas.h"
#include "core/render/render.h"
#include "core/render/shade.h"
#include "core/scene/error.h"
#include "core/trace/methods/method.h"

namespace ivory {

namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

// Between the frames that show refinement: more would only take time from the tracer.
constexpr milliseconds refinement_interval{40};
// Blocks of so many pixels are fine enough to be worked with.
constexpr int fine_blocks = 8;
// A first picture of fine blocks is shown this long after the edit at the earliest, if more is
// coming, and one of coarser blocks.
constexpr milliseconds hold_back{12}, hold_back_coarse{20};
// How long an edit leaves the picture before it to become fine, or to become complete at all when
// the one before that was cut short too: someone who drags without a pause sees the surface follow.
constexpr milliseconds grace{15}, grace_when_starved{100};
// After the last edit, before tiles are traced again that nobody can tell from what they are.
constexpr milliseconds rest{150};

// This thread and those that it starts get a processor after the one that draws the window.
void yield_to_other_threads() {
#ifdef __linux__
    // on Linux a thread has a priority of its own; without the right to it all goes on as it is
    static_cast<void>(setpriority(PRIO_PROCESS, 0, 5));
#endif
}

double milliseconds_between(Clock::time_point from, Clock::time_point to) {
    return std::chrono::duration<double, std::milli>(to - from).count();
}

// Whether nothing but colours, lights, background and threshold tells the two scenes apart.
bool same_elements(const Scene& a, const Scene& b) {
    if (a.elements.size() != b.elements.size()) return false;
    for (std::size_t i = 0; i < a.elements.size(); ++i) {
        const Element &p = a.elements[i], &q = b.elements[i];
        if (!(p.skeleton == q.skeleton && p.kernel == q.kernel && p.strength == q.strength &&
              p.width == q.width && p.visible == q.visible))
            return false;
    }
    return true;
}

// A picture in the making, or made: what the workers have delivered of it.
struct Board {
    static constexpr std::uint8_t nothing = 255;  // coarser than all blocks

    std::uint64_t number = 0;  // of its request; 0: none yet
    PictureRequest request;
    WindowSize laid_out;  // what all that follows is of
    std::vector<Rgba8> color;
    std::vector<float> depth;
    std::vector<std::uint8_t> blocks;      // by tile: of how many pixels a side it is made
    std::vector<std::uint16_t> done;       // by tile: its pixels that are this picture's
    std::vector<std::size_t> changed;      // tiles since the last poll, each once
    std::vector<std::uint8_t> is_changed;  // by tile: 1: its colours, 3: its depth too
    std::vector<std::uint8_t> is_covered;  // by tile: with another one's pixels, now or before
    std::vector<std::array<std::uint16_t, 5>> tile_pixels;
    std::array<std::uint64_t, 5> pixels{};            // by Status, of all tiles
    std::size_t tiles_missing = 0, tiles_coarse = 0;  // those that show nothing; no fine blocks
    std::uint64_t pixels_done = 0;
    std::uint64_t tiles_traced = 0;
    bool tracing = false;  // false: only shaded anew
    bool certainly_empty = false;
    bool final = false;
    Clock::time_point ended;  // when the last tile came that anyone can tell from the one before
    std::string fault;

    [[nodiscard]] bool complete() const {
        return number != 0 && tiles_missing == 0 && fault.empty();
    }
    [[nodiscard]] bool fine() const { return complete() && tiles_coarse == 0; }

    // Another picture. It has nothing yet of the tiles in `missing`; the others stand as they are.
    void begin(std::uint64_t new_number, const PictureRequest& new_request,
               const std::vector<std::uint8_t>& missing, bool surface_empty) {
        number = new_number;
        request = new_request;
        if (laid_out != request.size) {
            laid_out = {};  // until all of it is there
            const auto size = static_cast<std::size_t>(request.size.width) *
                              static_cast<std::size_t>(request.size.height);
            color.resize(size);
            depth.resize(size);
            changed.clear();
            is_changed.assign(missing.size(), 0);
            is_covered.assign(missing.size(), 0);
            done.assign(missing.size(), 0);
            tile_pixels.assign(missing.size(), {});
            pixels = {};
            laid_out = request.size;
        }
        blocks.assign(missing.size(), 1);
        tiles_missing = 0;
        for (std::size_t tile = 0; tile < missing.size(); ++tile) {
            if (missing[tile] == 0) continue;
            blocks[tile] = nothing;
            ++tiles_missing;
        }
        tiles_coarse = tiles_missing;
        tiles_traced = 0;
        certainly_empty = surface_empty;
        final = false;
        fault.clear();
    }

    // A job begins that makes these tiles anew; those of `kept` show what is not this picture's.
    void expect(const std::vector<std::uint8_t>& selected, const std::vector<std::uint8_t>& kept,
                bool job_traces) {
        tracing = job_traces;
        pixels_done = 0;
        for (std::size_t tile = 0; tile < selected.size(); ++tile) {
            if (selected[tile] != 0 || kept[tile] != 0) done[tile] = 0;
            pixels_done += done[tile];
        }
    }

    // Pixels from the frame, those that are not traced yet as blocks of the nearest one above and
    // to the left that is. How many more of the tile are there now.
    std::uint64_t take(const TileNotice& notice, const Canvas& canvas) {
        const Frame& frame = canvas.frame;
        const TileState& tile = canvas.tiles[notice.tile];
        const PixelRect& rect = notice.rect;
        const bool same = notice.same && is_covered[notice.tile] == 0;
        is_covered[notice.tile] = 0;
        for (int j = rect.y0; j < rect.y1 && !same; ++j) {
            if (notice.stride == 1) {
                copy_row(frame, frame.at(rect.x0, j), rect.width(), tile.empty);
                continue;
            }
            for (int i = rect.x0; i < rect.x1; ++i)
                copy(frame, frame.at(i - i % notice.stride, j - j % notice.stride), frame.at(i, j));
        }
        const bool stands_for_others = notice.square > TileGrid::tile_side;
        shows(notice.tile, stands_for_others ? notice.square : notice.stride, !same);
        if (stands_for_others) spread(notice, canvas);
        if (tracing && done[notice.tile] == 0) ++tiles_traced;
        int sum = 0;
        for (std::size_t status = 0; status < pixels.size(); ++status) {
            pixels[status] += tile.pixels[status];
            pixels[status] -= tile_pixels[notice.tile][status];
            sum += tile.pixels[status];
        }
        tile_pixels[notice.tile] = tile.pixels;
        const auto more = static_cast<std::uint64_t>(sum - done[notice.tile]);
        done[notice.tile] = static_cast<std::uint16_t>(sum);
        pixels_done += more;
        return more;
    }

  private:
    void copy(const Frame& frame, std::size_t from, std::size_t to) {
        color[to] = frame.color[from];
        depth[to] = possibly_hit(frame.status[from]) ? static_cast<float>(midpoint(frame.t(from)))
                                                     : std::numeric_limits<float>::infinity();
    }

    void copy_row(const Frame& frame, std::size_t first, int count, bool misses) {
        const auto columns = static_cast<std::size_t>(count);
        std::copy_n(&frame.color[first], columns, &color[first]);
        if (!tracing) return;  // the depth is what it was
        std::fill_n(&depth[first], columns, std::numeric_limits<float>::infinity());
        if (misses) return;
        for (std::size_t p = first; p < first + columns; ++p)
            if (possibly_hit(frame.status[p])) depth[p] = static_cast<float>(midpoint(frame.t(p)));
    }

    void shows(std::size_t tile, int pixels_a_side, bool differs = true) {
        std::uint8_t& before = blocks[tile];
        if (before == nothing) --tiles_missing;
        if (before > fine_blocks && pixels_a_side <= fine_blocks) --tiles_coarse;
        before = static_cast<std::uint8_t>(pixels_a_side);
        if (!differs) return;
        if (is_changed[tile] == 0) changed.push_back(tile);
        is_changed[tile] |= tracing ? 3 : 1;
    }

    // The first pixel of the tile over the others of its square that have nothing finer.
    void spread(const TileNotice& notice, const Canvas& canvas) {
        const Squares& tiles = canvas.grid.tiles;
        const std::size_t from = canvas.frame.at(notice.rect.x0, notice.rect.y0);
        const int x0 = notice.rect.x0 - notice.rect.x0 % notice.square;
        const int y0 = notice.rect.y0 - notice.rect.y0 % notice.square;
        const PixelRect square{x0, y0, std::min(x0 + notice.square, canvas.frame.width),
                               std::min(y0 + notice.square, canvas.frame.height)};
        for_squares_in(tiles, square, [&](std::size_t tile) {
            if (blocks[tile] <= notice.square) return;
            const PixelRect rect = tiles.rect(tile);
            for (int j = rect.y0; j < rect.y1; ++j)
                for (int i = rect.x0; i < rect.x1; ++i)
                    copy(canvas.frame, from, canvas.frame.at(i, j));
            is_covered[tile] = 1;
            shows(tile, notice.square);
        });
    }
};

// A complete picture that the next one overtook before anyone had looked.
struct Overtaken {
    std::uint64_t number;
    PictureRequest request;
    std::vector<Rgba8> color;
    std::vector<float> depth;
};

// Copies the tile; whether that changed a byte of its colours.
bool copy_tile(const PixelRect& rect, const Board& board, bool with_depth, ShownPicture& shown) {
    bool differs = false;
    const auto columns = static_cast<std::size_t>(rect.width());
    for (int j = rect.y0; j < rect.y1; ++j) {
        const std::size_t row =
            static_cast<std::size_t>(j) * static_cast<std::size_t>(shown.size.width) +
            static_cast<std::size_t>(rect.x0);
        if (std::memcmp(&shown.color[row], &board.color[row], columns * sizeof(Rgba8)) != 0) {
            differs = true;
            std::copy_n(&board.color[row], columns, &shown.color[row]);
        }
        if (with_depth) std::copy_n(&board.depth[row], columns, &shown.depth[row]);
    }
    return differs;
}

}  // namespace

// The thread that turns requests into jobs, and the board between it, the workers and `poll`.
class RenderSession::Director {
  public:
    explicit Director(Settings settings) : settings_(std::move(settings)) {
        settings_.threads = std::max(settings_.threads, 1);
        try {
            thread_ = std::jthread([this] { direct(); });
        } catch (const std::system_error& error) {
            throw Error("the viewer needs a thread besides its own, and none can be started: " +
                        error.code().message() +
                        "; end other programs, or allow more processes or memory (ulimit)");
        }
    }

    ~Director() {
        const std::lock_guard lock(mutex_);
        stop_ = true;
        if (job_ != nullptr) job_->cancel();
        condition_.notify_all();
    }

    void show(PictureRequest request) {
        const std::lock_guard lock(mutex_);
        wanted_ = std::move(request);
        ++wanted_number_;
        if (job_ != nullptr) {
            if (!superseded_) superseded_ = Clock::now();
            if (enough()) job_->cancel();
        }
        condition_.notify_all();
    }

    PictureChange poll(FirstPicture first, ShownPicture& shown, PictureState& state,
                       double& until_due) {
        const std::lock_guard lock(mutex_);
        const Clock::time_point now = Clock::now();
        PictureChange change;
        until_due = -1;
        if (board_.complete()) {
            if (board_.number == shown_number_) {
                take_changed_tiles(shown, change);
            } else {
                const Clock::time_point due = when_due(first);
                if (now >= due) {
                    replace(shown, change);
                    now_shown(board_.number, board_.request, state, now);
                } else {
                    until_due = milliseconds_between(now, due) / 1000;
                }
            }
        }
        if (overtaken_ && overtaken_->number > shown_number_) {
            shown = {overtaken_->request.size, std::move(overtaken_->color),
                     std::move(overtaken_->depth)};
            change.all = change.replaced = true;
            now_shown(overtaken_->number, overtaken_->request, state, now);
        }
        overtaken_.reset();
        report(shown, state, now);
        return change;
    }

    bool first_picture_ready() const {
        const std::lock_guard lock(mutex_);
        return board_.number == wanted_number_ && (board_.complete() || !board_.fault.empty());
    }

    SessionTotals totals() const {
        const std::lock_guard lock(mutex_);
        return totals_;
    }

  private:
    // Under the lock: nothing more is to be done for the picture in work, since there is another
    // to be made.
    bool enough() const {
        if (!superseded_) return false;
        const Clock::duration waited = Clock::now() - *superseded_;
        return board_.fine() || waited >= grace_when_starved ||
               (waited >= grace && (board_.complete() || !starved_));
    }

    // --- poll, under the lock ---

    // The board's picture is complete and not shown yet.
    Clock::time_point when_due(FirstPicture first) const {
        const bool at_once = first == FirstPicture::any || board_.final || shown_number_ == 0;
        if (at_once || (first == FirstPicture::fine && board_.fine())) return board_.request.since;
        return board_.request.since + (board_.fine() ? hold_back : hold_back_coarse);
    }

    void take_changed_tiles(ShownPicture& shown, PictureChange& change) {
        const Squares& tiles = TileGrid(shown.size.width, shown.size.height).tiles;
        for (const std::size_t tile : board_.changed) {
            const PixelRect rect = tiles.rect(tile);
            const bool with_depth = (board_.is_changed[tile] & 2) != 0;
            if (copy_tile(rect, board_, with_depth, shown)) change.tiles.push_back(rect);
            board_.is_changed[tile] = 0;
        }
        board_.changed.clear();
    }

    void replace(ShownPicture& shown, PictureChange& change) {
        if (shown.size != board_.request.size) {
            shown.size = board_.request.size;
            shown.color = board_.color;
            shown.depth = board_.depth;
            change.all = true;
            std::fill(board_.is_changed.begin(), board_.is_changed.end(), std::uint8_t{0});
            board_.changed.clear();
        } else {
            take_changed_tiles(shown, change);
        }
        change.replaced = true;
    }

    void now_shown(std::uint64_t number, const PictureRequest& request, PictureState& state,
                   Clock::time_point now) {
        state.first_milliseconds = milliseconds_between(request.since, now);
        shown_number_ = number;
        shown_scene_ = request.scene;
        shown_camera_ = request.camera;
    }

    void report(const ShownPicture& shown, PictureState& state, Clock::time_point now) const {
        const bool current = board_.number == wanted_number_;
        state.scene = shown_scene_;
        state.camera = shown_camera_;
        state.size = shown.size;
        state.depth = shown.depth;
        state.threads = settings_.threads;
        state.final = current && shown_number_ == wanted_number_ && board_.final;
        const auto pixels = static_cast<double>(board_.color.size());
        state.progress =
            current && pixels > 0 ? static_cast<double>(board_.pixels_done) / pixels : 0;
        const PictureRequest& wanted = wanted_ ? *wanted_ : in_work_;
        state.milliseconds =
            wanted_number_ == 0
                ? 0
                : milliseconds_between(wanted.since, current && board_.final ? board_.ended : now);
        const auto count = [&](Status status) {
            return board_.pixels[static_cast<std::size_t>(status)];
        };
        state.hit = count(Status::hit);
        state.miss = count(Status::miss);
        state.unresolved = count(Status::unresolved);
        state.tiles = board_.blocks.size();
        state.tiles_traced = current ? board_.tiles_traced : 0;
        state.surface_certainly_empty = current && board_.certainly_empty;
        state.fault = current ? board_.fault : "";
    }

    // --- the director's thread ---

    void direct() {
        if (settings_.yields) yield_to_other_threads();  // and the workers, which it starts
        std::unique_lock lock(mutex_);
        while (true) {
            condition_.wait(lock, [this] { return stop_ || wanted_; });
            if (stop_) return;
            in_work_ = *std::exchange(wanted_, std::nullopt);
            const PictureRequest request = in_work_;
            const std::uint64_t number = wanted_number_;
            superseded_.reset();
            lock.unlock();
            std::string fault;
            try {
                work(number, request);
            } catch (const std::bad_alloc&) {
                fault = "out of memory for a picture of this size";
            } catch (const std::exception& error) {
                fault = error.what();
            }
            lock.lock();
            job_ = nullptr;
            if (!fault.empty()) {
                canvas_.reset();  // whatever state it is in
                tiles_.clear();
                field_.reset();
                board_.number = number;
                board_.final = false;
                board_.fault = fault;
                lock.unlock();
                settings_.wake();
                lock.lock();
            }
        }
    }

    // One picture, from its scene to its last tile or until it is cancelled.
    void work(std::uint64_t number, const PictureRequest& request) {
        const Task task = prepare(request);
        std::vector<std::uint8_t> selected(tiles_.size()), kept(tiles_.size());
        for (std::size_t tile = 0; tile < tiles_.size(); ++tile) {
            selected[tile] = task == Task::shade
                                 ? !canvas_->stands_empty(tile, picture_.lighting.background)
                                 : tiles_[tile] == Tile::outdated;
            kept[tile] = tiles_[tile] == Tile::kept;
        }
        {
            const std::lock_guard lock(mutex_);
            if (board_.complete() && board_.number > shown_number_)
                overtaken_ = {board_.number, board_.request, board_.color, board_.depth};
            board_.begin(number, request, selected, picture_.field->box.empty());
            board_.expect(selected, kept, task != Task::shade);
            ++totals_.begun;
        }
        bool going_on = run(task, Order::coarse_to_fine, request, selected);
        {
            const std::lock_guard lock(mutex_);
            starved_ = !board_.complete();
            board_.ended = Clock::now();
        }
        if (task != Task::shade) {
            settle(selected);
        } else if (going_on) {
            recolored_.clear();
            is_shaded_ = true;
        }
        if (going_on && (is_stretched_ || std::find(kept.begin(), kept.end(), 1) != kept.end())) {
            settings_.wake();
            going_on = hand_rests(request);
            if (going_on && is_stretched_) {
                compile_anew(*request.scene);
                canvas_->forget_lists();
                kept.assign(kept.size(), 1);
            }
            if (going_on) {
                {
                    const std::lock_guard lock(mutex_);
                    // Shading may have shown them all.
                    board_.expect(kept, kept, true);
                }
                // in plain order: no tile is shown coarser than it is
                going_on = run(Task::trace_and_shade, Order::plain, request, kept);
                settle(kept);
            }
        }
        {
            const std::lock_guard lock(mutex_);
            board_.final = going_on;
            if (!going_on) ++totals_.cancelled;
        }
        if (going_on) settings_.wake();
    }

    // False: cancelled.
    bool run(Task task, Order order, const PictureRequest& request,
             std::vector<std::uint8_t> selected) {
        if (std::find(selected.begin(), selected.end(), 1) == selected.end()) return true;
        JobSettings job;
        job.threads = settings_.threads;
        job.task = task;
        job.order = order;
        job.keep_lists = true;
        if (task == Task::shade) job.recolored = recolored_;
        job.selected = std::move(selected);
        if (request.focus) {
            job.focus_i = static_cast<int>(request.focus->x);
            job.focus_j = static_cast<int>(request.focus->y);
        }
        job.on_tile = [this](const TileNotice& notice) { deliver(notice); };
        FrameJob frame_job(picture_, *canvas_, std::move(job));

        std::unique_lock lock(mutex_);
        job_ = &frame_job;
        if (stop_) frame_job.cancel();
        if (wanted_ && !superseded_) superseded_ = Clock::now();  // asked for since then
        lock.unlock();
        // `show` and `deliver` cancel what is fine; here the grace of the others ends.
        while (!frame_job.wait_for(milliseconds(5))) {
            lock.lock();
            if (enough()) frame_job.cancel();
            lock.unlock();
        }
        lock.lock();
        job_ = nullptr;
        lock.unlock();
        return frame_job.finish().complete;
    }

    // The selected tiles of which all pixels have come are the picture's own now, or nearly so: its
    // colours in float may be off by one where the hierarchy is another.
    void settle(const std::vector<std::uint8_t>& selected) {
        const std::lock_guard lock(mutex_);
        for (std::size_t tile = 0; tile < selected.size(); ++tile)
            if (selected[tile] != 0 && board_.done[tile] == canvas_->grid.tiles.rect(tile).area())
                tiles_[tile] = is_stretched_ ? Tile::kept : Tile::exact;
    }

    // False: something else is wanted before.
    bool hand_rests(const PictureRequest& request) {
        std::unique_lock lock(mutex_);
        return !condition_.wait_until(lock, request.since + rest,
                                      [this] { return stop_ || wanted_; });
    }

    // Makes field_ that of the scene; whether the tiles' lists, which are of the scene `before`
    // (null: none), still hold. `same_view`; `same_places`: so are the elements.
    bool take_scene(const Scene* before, const Scene& scene, bool same_view, bool same_places) {
        const bool has_field = field_ != nullptr && before != nullptr;
        // A whole picture would have to be made anew when the hand rests.
        const bool spares_rebuilding = same_view || !is_stretched_;
        const Refit refitted =
            has_field && spares_rebuilding ? refit(*field_, *before, scene) : Refit::impossible;
        if (refitted == Refit::impossible) {
            compile_anew(scene);
            return false;
        }
        is_stretched_ = is_stretched_ || refitted == Refit::stretched;
        const double share = scene.threshold / lists_threshold_;
        if (same_view && same_places && share > 0.5 && share < 2) {
            canvas_->forget_empty_lists();
            return true;
        }
        lists_threshold_ = scene.threshold;
        return false;
    }

    void compile_anew(const Scene& scene) {
        field_.reset();
        field_ = std::make_shared<Field>(compile(scene, settings_.threads));
        picture_.field = field_;
        is_stretched_ = false;
        lists_threshold_ = scene.threshold;
    }

    // Makes picture_, canvas_ and tiles_ ready for the request; what there is to do.
    Task prepare(const PictureRequest& request) {
        const PictureRequest before = std::exchange(traced_, request);
        const bool same_size = canvas_ != nullptr && before.size == request.size;
        const bool same_view = same_size && before.camera == request.camera;
        const bool whole = std::find(tiles_.begin(), tiles_.end(), Tile::outdated) == tiles_.end();
        const bool same_places =
            before.scene != nullptr && same_elements(*before.scene, *request.scene);
        if (same_view && whole && same_places &&
            before.scene->threshold == request.scene->threshold) {
            const std::vector<std::uint32_t> changed = recolor(*field_, *request.scene);
            std::vector<std::uint32_t> all;
            std::set_union(recolored_.begin(), recolored_.end(), changed.begin(), changed.end(),
                           std::back_inserter(all));
            recolored_ = std::move(all);
            is_shaded_ = false;
            picture_.lighting = make_lighting(*request.scene, picture_.view);
            return Task::shade;
        }
        const bool keeps_lists =
            take_scene(before.scene.get(), *request.scene, same_view, same_places);
        if (!same_view) {
            picture_.view = make_view(request.camera);
            directions_.clear();
        }
        const bool same_light = before.scene && before.scene->lights == request.scene->lights &&
                                before.scene->background == request.scene->background;
        picture_.lighting = make_lighting(*request.scene, picture_.view);
        picture_.method = methods().front();
        picture_.options.tolerance = settings_.tolerance;
        if (!same_size) {
            canvas_.reset();  // the memory of one is enough
            canvas_ =
                std::make_unique<Canvas>(request.size.width, request.size.height, false, true);
            tiles_.resize(canvas_->grid.tiles.size());
        }
        if (!keeps_lists) canvas_->forget_lists();

        std::optional<std::vector<std::uint8_t>> touched;
        // where the shading of new colours was cut short, tiles show old ones
        if (same_view && same_light && is_shaded_) {
            if (directions_.empty()) directions_ = tile_directions(picture_.view, request.size);
            touched =
                touched_tiles(*before.scene, *request.scene, request.camera.position, directions_);
        }
        recolored_.clear();
        is_shaded_ = true;
        for (std::size_t tile = 0; tile < tiles_.size(); ++tile) {
            if (!touched || (*touched)[tile] != 0)
                tiles_[tile] = Tile::outdated;
            else if (tiles_[tile] == Tile::exact)
                tiles_[tile] = Tile::kept;
        }
        return Task::trace_and_shade;
    }

    // --- the workers ---

    void deliver(const TileNotice& notice) {
        bool wake = false;
        {
            const std::lock_guard lock(mutex_);
            const bool was_complete = board_.complete(), was_fine = board_.fine();
            const std::uint64_t tiles_before = board_.tiles_traced;
            const std::uint64_t more = board_.take(notice, *canvas_);
            totals_.tiles_traced += board_.tiles_traced - tiles_before;
            if (board_.tracing) totals_.pixels_traced += more;
            if (!board_.complete()) return;
            const Clock::time_point now = Clock::now();
            const bool is_better = !was_complete || (!was_fine && board_.fine());
            if (is_better && job_ != nullptr && enough()) job_->cancel();
            // of a picture that is about to be replaced, refinement is not worth a frame
            wake = is_better || (!superseded_ && now - last_wake_ >= refinement_interval);
            if (wake) last_wake_ = now;
        }
        if (wake) settings_.wake();
    }

    // What a tile of the canvas shows.
    enum class Tile : std::uint8_t {
        outdated,  // something else, or not all of it
        kept,      // pixels of an earlier scene that nobody can tell from this one's
        exact,     // this scene
    };

    Settings settings_;

    mutable std::mutex mutex_;  // guards all down to the next comment
    std::condition_variable condition_;
    bool stop_ = false;
    std::optional<PictureRequest> wanted_;  // not yet begun
    PictureRequest in_work_;
    std::uint64_t wanted_number_ = 0;
    FrameJob* job_ = nullptr;
    std::optional<Clock::time_point> superseded_;  // when there was first another than that in work
    bool starved_ = false;  // the one before that was cut short with nothing to show
    Board board_;
    std::optional<Overtaken> overtaken_;
    SessionTotals totals_;
    Clock::time_point last_wake_;
    std::uint64_t shown_number_ = 0;
    std::shared_ptr<const Scene> shown_scene_;
    Camera shown_camera_;

    // The director's thread alone; the canvas is the job's while there is one.
    std::unique_ptr<Canvas> canvas_;
    std::shared_ptr<Field> field_;  // that of picture_; changed while there is no job
    // Its hierarchy is not what compile would make of the scene: pictures are not final yet.
    bool is_stretched_ = false;
    double lists_threshold_ = 0;  // T for which the canvas' lists are
    Picture picture_;
    PictureRequest traced_;  // what picture_, canvas_ and tiles_ are of
    std::vector<Tile> tiles_;
    std::vector<TileDirection> directions_;  // of picture_.view; empty: not made yet
    // Elements of picture_.field whose new colours have not come to all tiles yet, and whether
    // those and lights and background have.
    std::vector<std::uint32_t> recolored_;
    bool is_shaded_ = true;

    std::jthread thread_;  // last: joined before what it uses is gone
};

RenderSession::RenderSession(Settings settings)
    : director_(std::make_unique<Director>(std::move(settings))) {}

RenderSession::~RenderSession() = default;

void RenderSession::show(PictureRequest request) { director_->show(std::move(request)); }

PictureChange RenderSession::poll(FirstPicture first) {
    return director_->poll(first, shown_, state_, seconds_until_due_);
}

bool RenderSession::first_picture_ready() const { return director_->first_picture_ready(); }

SessionTotals RenderSession::totals() const { return director_->totals(); }

}  // namespace ivory
