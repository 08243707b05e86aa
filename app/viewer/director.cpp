#include "app/viewer/director.h"

#ifdef __linux__
#include <sys/resource.h>
#endif

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <exception>
#include <limits>
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

// Between the frames that show refinement: more would only take time from the tracer.
constexpr std::chrono::milliseconds refinement_interval{30};
// After the last edit, before a hand rests: fine tiles that come earlier would only flicker.
constexpr std::chrono::milliseconds rest{100};

double seconds_between(Clock::time_point from, Clock::time_point to) {
    return std::chrono::duration<double>(to - from).count();
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

bool RenderSession::Director::wait_until_showable(Time time) const {
    std::unique_lock lock(mutex_);
    return condition_.wait_until(lock, time, [this] {
        return board_.number == wanted_number_ && (board_.showable() || !board_.fault.empty());
    });
}

SessionTotals RenderSession::Director::totals() const {
    const std::lock_guard lock(mutex_);
    return totals_;
}

// --- the window's thread ---

void RenderSession::Director::show(PictureRequest request) {
    const std::lock_guard lock(mutex_);
    wanted_ = std::move(request);
    ++wanted_number_;
    if (job_ != nullptr && job_yields_) job_->cancel();
    condition_.notify_all();
}

void RenderSession::Director::stays() {
    const std::lock_guard lock(mutex_);
    if (std::exchange(stays_wanted_, true)) return;
    condition_.notify_all();
}

PictureChange RenderSession::Director::poll(ShownPicture& shown, PictureState& state,
                                            Time& shown_since) {
    const std::lock_guard lock(mutex_);
    const Clock::time_point now = Clock::now();
    PictureChange change;
    if (board_.showable()) {
        board_.hand_over(shown, change);
        if (board_.number != shown_number_) {
            change.replaced = true;
            now_shown(board_.number, board_.request, state, now);
        }
    } else if (overtaken_ && overtaken_->number > shown_number_) {
        take_overtaken(shown, change);
        now_shown(overtaken_->number, overtaken_->request, state, now);
    }
    overtaken_.reset();
    shown_since = shown_since_;
    report(shown, state, now);
    return change;
}

void RenderSession::Director::take_overtaken(ShownPicture& shown, PictureChange& change) {
    ShownPicture& picture = overtaken_->picture;
    change.replaced = change.coarse = true;
    change.all = !picture.color.empty() || shown.size != picture.size;
    if (picture.color.empty()) {  // no tile of it is seen
        const auto pixels = static_cast<std::size_t>(picture.size.width) *
                            static_cast<std::size_t>(picture.size.height);
        picture.color = std::move(shown.color);
        picture.depth = std::move(shown.depth);
        picture.color.resize(pixels);
        picture.depth.resize(pixels);
    }
    shown = std::move(picture);
}

void RenderSession::Director::now_shown(std::uint64_t number, const PictureRequest& request,
                                        PictureState& state, Clock::time_point now) {
    state.first_milliseconds = milliseconds_between(request.since, now);
    shown_number_ = number;
    shown_scene_ = request.scene;
    shown_camera_ = request.camera;
    shown_since_ = request.since;
    shown_at_ = now;
}

void RenderSession::Director::report(const ShownPicture& shown, PictureState& state,
                                     Clock::time_point now) const {
    const bool current = board_.number == wanted_number_;
    state.scene = shown_scene_;
    state.camera = shown_camera_;
    state.size = shown.size;
    const auto fine =
        static_cast<std::size_t>(std::count(shown.fine.begin(), shown.fine.end(), std::uint8_t{1}));
    const bool all = fine == shown.fine.size();
    state.fine = all ? 1 : static_cast<double>(fine) / static_cast<double>(shown.fine.size());
    state.resolution = all ? 1 : shown.coarse.step;
    state.depth = {shown.depth, shown.fine, shown.coarse.depth, shown.coarse.size};
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
        coarse_canvas_.reset();
        board_.fail(number, fault);
        condition_.notify_all();
    }
    settings_.wake();
}

// One picture, from its scene to its last tile or until it is cancelled.
void RenderSession::Director::work(std::uint64_t number, const PictureRequest& request) {
    const Time start = Clock::now();
    const CanvasWork first = canvas_.follow(request);
    begin(number, request, first);
    // How long it waited for the picture before it tells nothing of what this one takes; most of the
    // time may go into compiling, and still there has to be something to see.
    const double given = seconds_between(request.since, request.due);
    const double budget = std::max(given - seconds_between(start, Clock::now()), given / 2);
    bool going_on = first_picture(request, first, budget);
    const bool is_coarse = !canvas_.unfinished().empty();
    // Edges do not change from smooth to sharp and back while a hand moves.
    const bool goes_further = is_coarse || canvas_.is_inexact() || request.samples > 1;
    if (going_on && goes_further) going_on = hand_rests(number, request);
    if (going_on && is_coarse) going_on = refine(request);
    if (going_on && canvas_.is_inexact()) going_on = make_exact(request);
    if (going_on) going_on = sample(request);
    end(going_on);
    if (going_on) settings_.wake();
}

void RenderSession::Director::begin(std::uint64_t number, const PictureRequest& request,
                                    const CanvasWork& work) {
    const std::lock_guard lock(mutex_);
    if (board_.showable() && board_.number > shown_number_)
        overtaken_ = {board_.number, board_.request, board_.copy()};
    board_.begin(number, request, work.selected, canvas_.picture().field->box.empty());
    board_.expect(work.selected, work.kept, work.task != Task::shade);
    ++totals_.begun;
    if (board_.showable()) condition_.notify_all();
}

void RenderSession::Director::end(bool complete) {
    const std::lock_guard lock(mutex_);
    board_.final = complete;
    if (!complete) ++totals_.cancelled;
}

FineWork RenderSession::Director::fine_work(const CanvasWork& work) const {
    return {work.task == Task::shade, canvas_.effort(work.selected), canvas_.whole_effort()};
}

// Until there is a picture to be shown. False: another one is wanted, and this one would have come
// late.
bool RenderSession::Director::first_picture(const PictureRequest& request, CanvasWork work,
                                            double budget) {
    const bool goes_on = !std::exchange(rested_, false);
    const std::chrono::duration<double> longest(2 * budget);
    for (std::size_t least = 0; true; work = canvas_.unfinished()) {
        if (work.empty()) break;  // nothing of the edit is to be seen
        const std::size_t step = resolution_.choose(fine_work(work), budget, goes_on, least);
        Patience patience{.yields = false};
        const Time start = Clock::now();
        if (step + 1 < resolution_steps.size())
            patience.until = start + std::chrono::duration_cast<Clock::duration>(longest);
        const bool done = step == 0 ? fine_picture(request, work, patience)
                                    : coarse_picture(request, resolution_steps[step], patience);
        if (done || share_done_ > 0)
            resolution_.learn(step, fine_work(work),
                              seconds_between(start, Clock::now()) / (done ? 1 : share_done_));
        if (done) break;
        least = step + 1;
        const std::lock_guard lock(mutex_);
        if (stop_ || wanted_) return false;
    }
    const std::lock_guard lock(mutex_);
    board_.ended = Clock::now();
    return !stop_ && !wanted_;
}

bool RenderSession::Director::fine_picture(const PictureRequest& request, const CanvasWork& work,
                                           Patience patience) {
    const bool complete = run_on_canvas(work, Order::plain, request, patience);
    finish_tiles(work, complete);
    return complete;
}

bool RenderSession::Director::coarse_picture(const PictureRequest& request, double step,
                                             Patience patience) {
    CoarsePicture picture;
    picture.step = step;
    picture.size = coarse_size(request.size, step);
    const WindowSize size = picture.size;
    if (coarse_canvas_ == nullptr || coarse_canvas_->frame.width != size.width ||
        coarse_canvas_->frame.height != size.height) {
        coarse_canvas_.reset();
        coarse_canvas_ = std::make_unique<Canvas>(size.width, size.height, false);
    }
    JobSettings settings;
    settings.threads = settings_.threads;
    FrameJob job(canvas_.picture(), *coarse_canvas_, std::move(settings));
    if (!run(job, patience)) return false;
    const Frame& frame = coarse_canvas_->frame;
    picture.color.assign(&frame.color[0], &frame.color[0] + frame.size());
    picture.depth.resize(frame.size(), std::numeric_limits<float>::infinity());
    for (std::size_t p = 0; p < frame.size(); ++p)
        if (possibly_hit(frame.status[p]))
            picture.depth[p] = static_cast<float>(midpoint(frame.t(p)));
    {
        const std::lock_guard lock(mutex_);
        board_.take_coarse(std::move(picture));
        condition_.notify_all();
    }
    settings_.wake();
    return true;
}

// False: something else is wanted before. Where frames take long the hand may have moved on though
// nothing has come of it yet: the window has to have looked for input since.
bool RenderSession::Director::hand_rests(std::uint64_t number, const PictureRequest& request) {
    std::unique_lock lock(mutex_);
    const auto is_over = [this] { return stop_ || wanted_; };
    const auto rests_at = [&] {
        return std::max(request.since, shown_number_ == number ? shown_at_ : request.since) + rest;
    };
    while (!is_over() && Clock::now() < rests_at()) condition_.wait_until(lock, rests_at());
    if (!is_over()) {
        stays_wanted_ = false;
        lock.unlock();
        settings_.wake();
        lock.lock();
        condition_.wait(lock, [&] { return is_over() || stays_wanted_; });
    }
    rested_ = !is_over();
    return rested_;
}

// Until every pixel is one that anyone would take for the final picture's. False: cancelled.
bool RenderSession::Director::refine(const PictureRequest& request) {
    // what is traced now is not traced again
    if (canvas_.unfinished().task != Task::shade) canvas_.rest();
    const CanvasWork work = canvas_.unfinished();
    {
        const std::lock_guard lock(mutex_);
        board_.expect(work.selected, work.kept, work.task != Task::shade);
        board_.refine();
    }
    settings_.wake();
    const Time start = Clock::now();
    const bool complete = run_on_canvas(work, Order::from_focus, request, {.yields = true});
    const Time end = Clock::now();
    {
        const std::lock_guard lock(mutex_);
        board_.ended = end;
    }
    finish_tiles(work, complete);
    if (complete) resolution_.learn(0, fine_work(work), seconds_between(start, end));
    return complete;
}

// Until every byte is the final picture's. False: cancelled.
bool RenderSession::Director::make_exact(const PictureRequest& request) {
    canvas_.rest();
    const CanvasWork work = canvas_.kept();
    {
        const std::lock_guard lock(mutex_);
        board_.expect(work.selected, work.kept, true, false);
    }
    const bool complete = run_on_canvas(work, Order::plain, request, {.yields = true});
    finish_tiles(work, complete);
    return complete;
}

// As `ivory render --samples` has it. False: cancelled. Tiles that an edit did not touch may have their
// samples; whether they still are the final picture's is found out last.
bool RenderSession::Director::sample(const PictureRequest& request) {
    if (request.samples == 1) {
        const std::lock_guard lock(mutex_);
        board_.leave_samples(canvas_.canvas());
        return true;
    }
    std::vector<std::uint8_t> sharp;
    {
        const std::lock_guard lock(mutex_);
        sharp = board_.without_samples();
    }
    const bool in_steps =
        request.samples > 4 && std::find(sharp.begin(), sharp.end(), 1) != sharp.end();
    try {
        if (in_steps && !take_samples(request, 4, std::move(sharp))) return false;
        return take_samples(request, request.samples, {});
    } catch (const std::bad_alloc&) {
        const std::lock_guard lock(mutex_);
        board_.fault = "out of memory for " + std::to_string(request.samples) +
                       " samples a pixel; what is there stays";
    }
    settings_.wake();
    return false;
}

bool RenderSession::Director::take_samples(const PictureRequest& request, int samples,
                                           std::vector<std::uint8_t> selected) {
    const auto side = static_cast<int>(std::lround(std::sqrt(samples)));
    SampledPicture sampled(canvas_.canvas(), side, false);
    JobSettings settings = job_settings(request);
    settings.task = Task::sample;
    settings.order = Order::from_focus;
    settings.sampled = &sampled;
    settings.selected = std::move(selected);
    settings.on_tile = [&](const TileNotice& notice) { deliver_samples(notice, sampled); };
    FrameJob job(canvas_.picture(), canvas_.canvas(), std::move(settings));
    return run(job, {.yields = true});
}

JobSettings RenderSession::Director::job_settings(const PictureRequest& request) const {
    JobSettings settings;
    settings.threads = settings_.threads;
    if (request.focus) {
        settings.focus_i = static_cast<int>(request.focus->x);
        settings.focus_j = static_cast<int>(request.focus->y);
    }
    return settings;
}

// False: cancelled.
bool RenderSession::Director::run_on_canvas(const CanvasWork& work, Order order,
                                            const PictureRequest& request, Patience patience) {
    if (work.empty()) return true;
    JobSettings settings = job_settings(request);
    settings.task = work.task;
    settings.order = order;
    settings.keep_lists = true;
    if (work.task == Task::shade) settings.recolored = canvas_.recolored();
    settings.selected = work.selected;
    settings.on_tile = [this](const TileNotice& notice) { deliver(notice); };
    FrameJob job(canvas_.picture(), canvas_.canvas(), std::move(settings));
    return run(job, patience);
}

// False: cancelled.
bool RenderSession::Director::run(FrameJob& job, Patience patience) {
    {
        const std::lock_guard lock(mutex_);
        job_ = &job;
        job_yields_ = patience.yields;
        if (stop_ || (wanted_ && patience.yields)) job.cancel();
    }
    // `show` and the destructor cancel it; here its time ends.
    constexpr std::chrono::milliseconds longest_wait{20};
    while (true) {
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(
            std::min<Clock::duration>(patience.until - Clock::now(), longest_wait));
        if (job.wait_for(std::max(left, std::chrono::milliseconds(1)))) break;
        if (Clock::now() >= patience.until) job.cancel();
    }
    {
        const std::lock_guard lock(mutex_);
        job_ = nullptr;
    }
    share_done_ = job.progress();
    return job.finish().complete;
}

// The selected tiles of which all pixels have come are the picture's own now, or nearly so: its
// colours in float may be off by one where the hierarchy is another.
void RenderSession::Director::finish_tiles(const CanvasWork& work, bool complete) {
    if (work.task == Task::shade) {
        if (complete) canvas_.finish_shading();
        return;
    }
    const std::lock_guard lock(mutex_);
    const Squares& tiles = canvas_.canvas().grid.tiles;
    for (std::size_t tile = 0; tile < work.selected.size(); ++tile)
        if (work.selected[tile] != 0 && board_.tally.own(tile) == tiles.rect(tile).area())
            canvas_.finish(tile);
}

// --- the workers ---

void RenderSession::Director::deliver(const TileNotice& notice) {
    bool wake = false;
    {
        const std::lock_guard lock(mutex_);
        const bool before = board_.showable();
        const std::uint64_t tiles_before = board_.tally.tiles_traced();
        const std::uint64_t more = board_.take(notice, canvas_.canvas());
        totals_.tiles_traced += board_.tally.tiles_traced() - tiles_before;
        if (board_.tracing()) totals_.pixels_traced += more;
        if (!board_.showable()) return;
        wake = wakes_again(Clock::now(), !before);
        if (!before) condition_.notify_all();
    }
    if (wake) settings_.wake();
}

// Under the lock: whether it is time for the window to look again.
bool RenderSession::Director::wakes_again(Time now, bool in_any_case) {
    const bool wakes = in_any_case || now - last_wake_ >= refinement_interval;
    if (wakes) last_wake_ = now;
    return wakes;
}

void RenderSession::Director::deliver_samples(const TileNotice& notice,
                                              const SampledPicture& sampled) {
    bool wake = false;
    {
        const std::lock_guard lock(mutex_);
        board_.take_samples(notice, canvas_.canvas(), sampled);
        board_.ended = Clock::now();
        wake = wakes_again(board_.ended, false);
    }
    if (wake) settings_.wake();
}

}  // namespace ivory
