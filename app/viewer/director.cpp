#include "app/viewer/director.h"

#ifdef __linux__
#include <sys/resource.h>
#endif

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <exception>
#include <new>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "core/render/render.h"
#include "core/scene/error.h"

namespace ivory {

namespace {

using Clock = std::chrono::steady_clock;

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

}  // namespace

RenderSession::Director::Director(Settings settings)
    : settings_(std::move(settings)), canvas_(std::max(settings_.threads, 1), settings_.tolerance) {
    settings_.threads = std::max(settings_.threads, 1);
    try {
        thread_ = std::jthread([this] { direct(); });
    } catch (const std::system_error& error) {
        throw Error("the viewer needs a thread besides its own, and none can be started: " +
                    error.code().message() +
                    "; end other programs, or allow more processes or memory (ulimit)");
    }
}

RenderSession::Director::~Director() {
    const std::lock_guard lock(mutex_);
    stop_ = true;
    if (job_ != nullptr) job_->cancel();
    condition_.notify_all();
}

bool RenderSession::Director::first_picture_ready() const {
    const std::lock_guard lock(mutex_);
    return board_.number == wanted_number_ &&
           (board_.readiness() != Readiness::partial || !board_.fault.empty());
}

SessionTotals RenderSession::Director::totals() const {
    const std::lock_guard lock(mutex_);
    return totals_;
}

// Under the lock.
bool RenderSession::Director::enough() const {
    return patience_.enough(board_.readiness(), Clock::now());
}

// --- the window's thread ---

void RenderSession::Director::show(PictureRequest request) {
    const std::lock_guard lock(mutex_);
    wanted_ = std::move(request);
    ++wanted_number_;
    if (job_ != nullptr) {
        patience_.supersede(Clock::now());
        if (enough()) job_->cancel();
    }
    condition_.notify_all();
}

PictureChange RenderSession::Director::poll(FirstPicture first, ShownPicture& shown,
                                            PictureState& state, double& until_due) {
    const std::lock_guard lock(mutex_);
    const Clock::time_point now = Clock::now();
    PictureChange change;
    until_due = -1;
    if (board_.readiness() != Readiness::partial)
        until_due = take_board(first, shown, change, state, now);
    if (overtaken_ && overtaken_->number > shown_number_) {
        shown = std::move(overtaken_->picture);
        change.all = change.replaced = true;
        now_shown(overtaken_->number, overtaken_->request, state, now);
    }
    overtaken_.reset();
    report(shown, state, now);
    return change;
}

// What is new on the board, or in how many seconds its picture is due; < 0: it is shown.
double RenderSession::Director::take_board(FirstPicture first, ShownPicture& shown,
                                           PictureChange& change, PictureState& state,
                                           Clock::time_point now) {
    const bool is_new = board_.number != shown_number_;
    if (is_new) {
        const bool certain = board_.final || shown_number_ == 0;
        const Clock::time_point due =
            first_picture_due(first, board_.readiness(), certain, board_.request.since);
        if (now < due) return milliseconds_between(now, due) / 1000;
    }
    board_.hand_over(shown, change);
    if (is_new) {
        change.replaced = true;
        now_shown(board_.number, board_.request, state, now);
    }
    return -1;
}

void RenderSession::Director::now_shown(std::uint64_t number, const PictureRequest& request,
                                        PictureState& state, Clock::time_point now) {
    state.first_milliseconds = milliseconds_between(request.since, now);
    shown_number_ = number;
    shown_scene_ = request.scene;
    shown_camera_ = request.camera;
}

void RenderSession::Director::report(const ShownPicture& shown, PictureState& state,
                                     Clock::time_point now) const {
    const bool current = board_.number == wanted_number_;
    state.scene = shown_scene_;
    state.camera = shown_camera_;
    state.size = shown.size;
    state.depth = shown.depth;
    state.threads = settings_.threads;
    state.final = current && shown_number_ == wanted_number_ && board_.final;
    const auto pixels = static_cast<double>(board_.pixels());
    state.progress =
        current && pixels > 0 ? static_cast<double>(board_.tally.pixels()) / pixels : 0;
    const PictureRequest& wanted = wanted_ ? *wanted_ : in_work_;
    state.milliseconds =
        wanted_number_ == 0
            ? 0
            : milliseconds_between(wanted.since, current && board_.final ? board_.ended : now);
    state.hit = board_.tally.count(Status::hit);
    state.miss = board_.tally.count(Status::miss);
    state.unresolved = board_.tally.count(Status::unresolved);
    state.tiles = board_.tiles();
    state.tiles_traced = current ? board_.tally.tiles_traced() : 0;
    state.surface_certainly_empty = current && board_.certainly_empty;
    state.fault = current ? board_.fault : "";
}

// --- the director's thread ---

void RenderSession::Director::direct() {
    if (settings_.yields) yield_to_other_threads();  // and the workers, which it starts
    std::unique_lock lock(mutex_);
    while (true) {
        condition_.wait(lock, [this] { return stop_ || wanted_; });
        if (stop_) return;
        in_work_ = *std::exchange(wanted_, std::nullopt);
        const PictureRequest request = in_work_;
        const std::uint64_t number = wanted_number_;
        patience_.begin();
        lock.unlock();
        std::string fault;
        try {
            work(number, request);
        } catch (const std::bad_alloc&) {
            fault = "out of memory for a picture of this size";
        } catch (const std::exception& error) {
            fault = error.what();
        }
        if (!fault.empty()) fail(number, fault);
        lock.lock();
    }
}

void RenderSession::Director::fail(std::uint64_t number, const std::string& fault) {
    {
        const std::lock_guard lock(mutex_);
        job_ = nullptr;
        canvas_.abandon();
        board_.number = number;
        board_.final = false;
        board_.fault = fault;
    }
    settings_.wake();
}

// One picture, from its scene to its last tile or until it is cancelled.
void RenderSession::Director::work(std::uint64_t number, const PictureRequest& request) {
    const CanvasWork first = canvas_.follow(request);
    begin(number, request, first);
    bool going_on = first_pass(request, first);
    if (going_on && canvas_.is_inexact()) {
        settings_.wake();
        going_on = hand_rests(request) && pass_at_rest(request);
    }
    end(going_on);
    if (going_on) settings_.wake();
}

void RenderSession::Director::begin(std::uint64_t number, const PictureRequest& request,
                                    const CanvasWork& work) {
    const std::lock_guard lock(mutex_);
    if (board_.readiness() != Readiness::partial && board_.number > shown_number_)
        overtaken_ = {board_.number, board_.request, board_.copy()};
    board_.begin(number, request, work.selected, canvas_.picture().field->box.empty());
    board_.expect(work.selected, work.kept, work.task != Task::shade);
    ++totals_.begun;
}

void RenderSession::Director::end(bool complete) {
    const std::lock_guard lock(mutex_);
    board_.final = complete;
    if (!complete) ++totals_.cancelled;
}

// Until the picture is what anyone would take for the final one. False: cancelled.
bool RenderSession::Director::first_pass(const PictureRequest& request, const CanvasWork& work) {
    const bool complete = run(work, Order::coarse_to_fine, request);
    {
        const std::lock_guard lock(mutex_);
        patience_.end(board_.readiness());
        board_.ended = Clock::now();
    }
    if (work.task != Task::shade) {
        settle(work.selected);
    } else if (complete) {
        canvas_.finish_shading();
    }
    return complete;
}

// False: something else is wanted before.
bool RenderSession::Director::hand_rests(const PictureRequest& request) {
    std::unique_lock lock(mutex_);
    return !condition_.wait_until(lock, hand_rests_at(request.since),
                                  [this] { return stop_ || wanted_; });
}

// Until every byte is the final picture's. False: cancelled.
bool RenderSession::Director::pass_at_rest(const PictureRequest& request) {
    const CanvasWork rest = canvas_.work_at_rest();
    {
        const std::lock_guard lock(mutex_);
        // Shading may have shown them all.
        board_.expect(rest.selected, rest.kept, true);
    }
    // in plain order: no tile is shown coarser than it is
    const bool complete = run(rest, Order::plain, request);
    settle(rest.selected);
    return complete;
}

// False: cancelled.
bool RenderSession::Director::run(const CanvasWork& work, Order order,
                                  const PictureRequest& request) {
    if (std::find(work.selected.begin(), work.selected.end(), 1) == work.selected.end())
        return true;
    JobSettings job;
    job.threads = settings_.threads;
    job.task = work.task;
    job.order = order;
    job.keep_lists = true;
    if (work.task == Task::shade) job.recolored = canvas_.recolored();
    job.selected = work.selected;
    if (request.focus) {
        job.focus_i = static_cast<int>(request.focus->x);
        job.focus_j = static_cast<int>(request.focus->y);
    }
    job.on_tile = [this](const TileNotice& notice) { deliver(notice); };
    FrameJob frame_job(canvas_.picture(), canvas_.canvas(), std::move(job));

    std::unique_lock lock(mutex_);
    job_ = &frame_job;
    if (stop_) frame_job.cancel();
    if (wanted_) patience_.supersede(Clock::now());  // asked for since then
    lock.unlock();
    // `show` and `deliver` cancel what is fine; here the grace of the others ends.
    while (!frame_job.wait_for(std::chrono::milliseconds(5))) {
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
void RenderSession::Director::settle(const std::vector<std::uint8_t>& selected) {
    const std::lock_guard lock(mutex_);
    const Squares& tiles = canvas_.canvas().grid.tiles;
    for (std::size_t tile = 0; tile < selected.size(); ++tile)
        if (selected[tile] != 0 && board_.tally.own(tile) == tiles.rect(tile).area())
            canvas_.finish(tile);
}

// --- the workers ---

void RenderSession::Director::deliver(const TileNotice& notice) {
    bool wake = false;
    {
        const std::lock_guard lock(mutex_);
        const Readiness before = board_.readiness();
        const std::uint64_t tiles_before = board_.tally.tiles_traced();
        const std::uint64_t more = board_.take(notice, canvas_.canvas());
        totals_.tiles_traced += board_.tally.tiles_traced() - tiles_before;
        if (board_.tracing()) totals_.pixels_traced += more;
        const Readiness ready = board_.readiness();
        if (ready == Readiness::partial) return;
        const bool is_better = ready > before;
        if (is_better && job_ != nullptr && enough()) job_->cancel();
        wake = patience_.worth_a_frame(is_better, Clock::now());
    }
    if (wake) settings_.wake();
}

}  // namespace ivory
