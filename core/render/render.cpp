#include "core/render/render.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>

#include "core/render/tile_work.h"

namespace ivory {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

// The work is a sequence of steps, dealt out by one atomic number:
//
//   step 0 ..   the lists of the regions that hold a block without lists
//   then        the blocks, first those around the focus if they are wanted so
//
// A block waits for its region's list. That step has a smaller number and so is being done already.
class FrameJob::Work {
  public:
    Work(Picture picture, Canvas& canvas, JobSettings settings)
        : picture_(std::move(picture)),
          canvas_(canvas),
          settings_(std::move(settings)),
          lists_(picture_, canvas, stop_,
                 settings_.task == Task::sample ? settings_.sampled->samples_a_side : 1) {
        plan();
    }

    void start() {
        started_ = Clock::now();
        const int threads = std::max(settings_.threads, 1);
        workers_.resize(static_cast<std::size_t>(threads));
        running_ = threads;
        for (std::unique_ptr<TileWorker>& worker : workers_) {
            try {
                if (threads > 1) {
                    threads_.emplace_back([this, &worker] { work(worker, std::nullopt); });
                    continue;
                }
            } catch (const std::system_error&) {
                // Fewer workers do the same work.
            }
            if (threads_.empty() && &worker == &workers_.back()) {
                own_ = &worker;
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
        threads_.clear();  // joins
        if (failure_) std::rethrow_exception(failure_);
        JobReport report;
        report.complete = !cut_short_.load();
        report.seconds = std::chrono::duration<double>(finished_ - started_).count();
        Clock::duration tracing{}, shading{};
        std::vector<std::uint8_t> reached(picture_.field->size());
        for (const std::unique_ptr<TileWorker>& worker : workers_) {
            if (worker == nullptr) continue;
            report.counts += worker->counts;
            report.tiles_traced += worker->tiles;
            tracing += worker->tracing;
            shading += worker->shading;
            for (std::size_t e = 0; e < worker->reached.size(); ++e)
                reached[e] |= worker->reached[e];
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
        if (settings_.order != Order::plain) begin_at_focus();

        lists_.plan(needed);
        // The regions in the order in which the blocks will ask for them.
        for (const std::size_t block : block_order_) {
            const std::size_t region = lists_.region_of(block);
            if (needed[region] == 0) continue;
            needed[region] = 0;
            region_order_.push_back(region);
        }
        steps_ = region_order_.size() + block_order_.size();
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

    bool stopped() const { return stop_.load(std::memory_order_relaxed); }

    // Until there is nothing left to do, or for at least one step that time has come. Whether this
    // worker has left.
    bool work(std::unique_ptr<TileWorker>& own, std::optional<Clock::time_point> until) {
        try {
            const Clock::time_point start = Clock::now();
            if (own == nullptr) {
                own = std::make_unique<TileWorker>(picture_, canvas_, settings_, lists_, stop_);
            }
            TileWorker& worker = *own;
            const Clock::duration shading_before = worker.shading;
            bool in_time = true;
            while (in_time && !stopped()) {
                const std::size_t step = next_.fetch_add(1, std::memory_order_relaxed);
                if (step >= steps_) break;
                if (!take(step, worker)) cut_short_ = true;
                in_time = !until || Clock::now() < *until;
            }
            worker.tracing += Clock::now() - start - (worker.shading - shading_before);
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
    bool take(std::size_t step, TileWorker& worker) {
        if (step < region_order_.size()) {
            const std::size_t region = region_order_[step];
            lists_.make_region(region, worker.counts);
            return true;
        }
        const std::size_t block = block_order_[step - region_order_.size()];
        return settings_.task == Task::sample ? sample_block(block, worker)
                                              : take_block(block, worker);
    }

    bool sample_block(std::size_t block, TileWorker& worker) {
        if (!lists_.make_block(block, worker.counts)) return false;
        SampleWorker& sampler = worker.sampler(*settings_.sampled);
        sampler.enter_block(block);
        bool done = true;
        for_squares_in(tiles(), blocks().rect(block), [&](std::size_t tile) {
            if (!done || !selected(tile)) return;
            const ElementList list = lists_.of_tile(tile, worker.counts);
            done = !stopped() && sampler.sample(tile, list);
            if (!done) return;
            ++worker.tiles;
            if (!list.certainly_empty) worker.mark_reached(list);
            if (settings_.on_tile) settings_.on_tile({tile, tiles().rect(tile)});
        });
        lists_.forget_block(block);
        return done;
    }

    bool take_block(std::size_t block, TileWorker& worker) {
        const PixelRect rect = blocks().rect(block);
        worker.leave_block();
        if (!list_tiles_of(block, worker)) return false;
        bool done = true;
        const bool painted = paints_at_once(block);
        if (painted) worker.paint_empty(rect);
        for_squares_in(tiles(), rect, [&](std::size_t tile) {
            if (done && selected(tile)) done = take_tile(tile, painted, worker);
        });
        lists_.forget_block(block);  // each tile has its own
        return done;
    }

    // Whether all tiles of the block are empty, and this job's, and not all painted so already.
    bool paints_at_once(std::size_t block) const {
        // Shading tells by what a tile shows whether it is to be painted.
        if (settings_.task == Task::shade) return false;
        const ElementList* const list = lists_.of_block(block);
        if (list == nullptr || !list->certainly_empty) return false;
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
    bool list_tiles_of(std::size_t block, TileWorker& worker) {
        bool needed = false;
        for_squares_in(tiles(), blocks().rect(block), [&](std::size_t tile) {
            needed = needed || (selected(tile) && !canvas_.tiles[tile].has_list);
        });
        return !needed || lists_.make_block(block, worker.counts);
    }

    // `painted`: it is empty and has its colour already, so that nothing may come between.
    bool take_tile(std::size_t index, bool painted, TileWorker& worker) {
        if (!painted && stopped()) return false;
        TileState& tile = canvas_.tiles[index];
        if (!tile.has_list) {
            tile.list = lists_.of_tile(index, worker.counts);
            tile.has_list = true;
        }
        ++worker.tiles;
        if (settings_.task != Task::shade && !tile.list.certainly_empty) {
            worker.mark_reached(tile.list);
        }
        bool done = true, same = false;
        if (settings_.task == Task::shade) {
            same = stands_empty(index);
            done = same || worker.shade_again(index);
        } else if (!tile.list.certainly_empty) {
            done = worker.trace(index);
        } else {
            same = !painted && stands_empty(index);
            if (!painted && !same) worker.paint_empty(tiles().rect(index));
            worker.leave_empty(index);
        }
        if (done && settings_.on_tile) settings_.on_tile({index, tiles().rect(index), same});
        if (done && !settings_.keep_lists) {
            tile.has_list = false;
            tile.list = {};
        }
        return done;
    }

    const Picture picture_;
    Canvas& canvas_;
    const JobSettings settings_;
    std::atomic<bool> stop_{false};
    TileLists lists_;

    std::vector<std::size_t> region_order_, block_order_;
    std::size_t steps_ = 0;
    std::atomic<std::size_t> next_{0};

    std::atomic<bool> cut_short_{false};
    Clock::time_point started_, finished_;

    mutable std::mutex mutex_;
    mutable std::condition_variable ended_;
    int running_ = 0;
    std::exception_ptr failure_;
    std::vector<std::unique_ptr<TileWorker>> workers_;  // one for each thread
    // The caller's, who works where no threads do; null: none, or done.
    std::unique_ptr<TileWorker>* own_ = nullptr;
    std::vector<std::jthread> threads_;  // last: joined before anything that they use is gone
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
