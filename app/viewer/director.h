// The director: edits in, jobs started, notices out. It knows who runs when and under which lock;
// what is to be done of a picture, how fine it can be in time and what is seen of it are decided by
// EditedCanvas, Resolution and PictureBoard.
//
//   the window's thread   show, poll         never waits for the tracer
//   the director's        direct             one picture after the other
//   the workers           deliver            one tile after the other
//
// A picture goes through stages, each of which a newer request ends:
//
//   first_picture   every pixel, or fewer if these would not come in time; all of it is seen at once
//   hand_rests      nothing is done
//   refine          every pixel, where they are fewer, tile by tile
//   make_exact      what of an edit nobody can tell, until every byte is the final picture's
//   sample          several samples a pixel, where they are wanted: 4, and then more
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "app/viewer/edited_canvas.h"
#include "app/viewer/picture_board.h"
#include "app/viewer/render_session.h"
#include "app/viewer/resolution.h"
#include "app/viewer/shown_picture.h"
#include "core/render/render.h"
#include "core/scene/scene.h"

namespace ivory {

class RenderSession::Director {
  public:
    using Time = std::chrono::steady_clock::time_point;

    explicit Director(Settings settings);
    ~Director();
    Director(const Director&) = delete;
    Director& operator=(const Director&) = delete;

    // As those of RenderSession.
    void show(PictureRequest request);
    void stays();
    PictureChange poll(ShownPicture& shown, PictureState& state, Time& shown_since);
    [[nodiscard]] bool wait_until_showable(Time time) const;
    [[nodiscard]] SessionTotals totals() const;

  private:
    // A picture that the next one overtook before anyone had looked.
    struct Overtaken {
        std::uint64_t number;
        PictureRequest request;
        ShownPicture picture;
    };
    // When a job ends before it is done.
    struct Patience {
        bool yields;              // as soon as another picture is wanted
        Time until{Time::max()};  // and then in any case
    };

    // Under the lock, in the window's thread.
    void take_overtaken(ShownPicture& shown, PictureChange& change);
    void now_shown(std::uint64_t number, const PictureRequest& request, PictureState& state,
                   Time now);
    void report(const ShownPicture& shown, PictureState& state, Time now) const;

    void direct();
    void work(std::uint64_t number, const PictureRequest& request);
    void begin(std::uint64_t number, const PictureRequest& request, const CanvasWork& work);
    void end(bool complete);
    void fail(std::uint64_t number, const std::string& fault);
    [[nodiscard]] bool first_picture(const PictureRequest& request, CanvasWork work, double budget);
    [[nodiscard]] bool fine_picture(const PictureRequest& request, const CanvasWork& work,
                                    Patience patience);
    [[nodiscard]] bool coarse_picture(const PictureRequest& request, double step,
                                      Patience patience);
    [[nodiscard]] bool hand_rests(std::uint64_t number, const PictureRequest& request);
    [[nodiscard]] bool refine(const PictureRequest& request);
    [[nodiscard]] bool make_exact(const PictureRequest& request);
    [[nodiscard]] bool sample(const PictureRequest& request);
    [[nodiscard]] bool take_samples(const PictureRequest& request, int samples,
                                    std::vector<std::uint8_t> selected);
    [[nodiscard]] JobSettings job_settings(const PictureRequest& request) const;
    [[nodiscard]] bool run_on_canvas(const CanvasWork& work, Order order,
                                     const PictureRequest& request, Patience patience);
    [[nodiscard]] bool run(FrameJob& job, Patience patience);
    [[nodiscard]] FineWork fine_work(const CanvasWork& work) const;
    void finish_tiles(const CanvasWork& work, bool complete);

    void deliver(const TileNotice& notice);
    bool wakes_again(Time now, bool in_any_case);
    void deliver_samples(const TileNotice& notice, const SampledPicture& sampled);

    Settings settings_;

    mutable std::mutex mutex_;  // guards all down to the next comment
    mutable std::condition_variable condition_;
    bool stop_ = false;
    std::optional<PictureRequest> wanted_;  // not yet begun
    PictureRequest in_work_;
    std::uint64_t wanted_number_ = 0;
    FrameJob* job_ = nullptr;
    bool job_yields_ = false;
    PictureBoard board_;
    std::optional<Overtaken> overtaken_;
    SessionTotals totals_;
    Time last_wake_;
    std::uint64_t shown_number_ = 0;
    std::shared_ptr<const Scene> shown_scene_;
    Camera shown_camera_;
    Time shown_since_;           // when it was asked for
    Time shown_at_;              // when it was first polled
    bool stays_wanted_ = false;  // what is in work, as the window has said since it seemed to

    // The director's thread alone, and what a job's notices let the workers read.
    EditedCanvas canvas_;
    std::unique_ptr<Canvas> coarse_canvas_;  // of the last coarse picture's size
    Resolution resolution_;
    double share_done_ = 0;  // by the last job, 0..1
    bool rested_ = true;     // the hand, since the picture before

    std::jthread thread_;  // last: joined before what it uses is gone
};

}  // namespace ivory
