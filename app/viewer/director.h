// The director: edits in, jobs started, notices out. It knows who runs when and under which lock;
// what is to be done of a picture, how long one waits and what is seen of it are decided by
// EditedCanvas, Patience and PictureBoard.
//
//   the window's thread   show, poll         never waits for the tracer
//   the director's        direct             one picture after the other
//   the workers           deliver            one tile after the other
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
#include "app/viewer/patience.h"
#include "app/viewer/picture_board.h"
#include "app/viewer/render_session.h"
#include "app/viewer/shown_picture.h"
#include "core/render/render.h"
#include "core/scene/scene.h"

namespace ivory {

class RenderSession::Director {
  public:
    explicit Director(Settings settings);
    ~Director();
    Director(const Director&) = delete;
    Director& operator=(const Director&) = delete;

    // As those of RenderSession.
    void show(PictureRequest request);
    PictureChange poll(FirstPicture first, ShownPicture& shown, PictureState& state,
                       double& until_due);
    [[nodiscard]] bool first_picture_ready() const;
    [[nodiscard]] SessionTotals totals() const;

  private:
    // A complete picture that the next one overtook before anyone had looked.
    struct Overtaken {
        std::uint64_t number;
        PictureRequest request;
        ShownPicture picture;
    };

    using Time = std::chrono::steady_clock::time_point;

    // Under the lock, in the window's thread.
    [[nodiscard]] double take_board(FirstPicture first, ShownPicture& shown, PictureChange& change,
                                    PictureState& state, Time now);
    void now_shown(std::uint64_t number, const PictureRequest& request, PictureState& state,
                   Time now);
    void report(const ShownPicture& shown, PictureState& state, Time now) const;

    void direct();
    void work(std::uint64_t number, const PictureRequest& request);
    void begin(std::uint64_t number, const PictureRequest& request, const CanvasWork& work);
    void end(bool complete);
    void fail(std::uint64_t number, const std::string& fault);
    [[nodiscard]] bool first_pass(const PictureRequest& request, const CanvasWork& work);
    [[nodiscard]] bool hand_rests(const PictureRequest& request);
    [[nodiscard]] bool pass_at_rest(const PictureRequest& request);
    [[nodiscard]] bool run(const CanvasWork& work, Order order, const PictureRequest& request);
    void settle(const std::vector<std::uint8_t>& selected);

    void deliver(const TileNotice& notice);

    [[nodiscard]] bool enough() const;

    Settings settings_;

    mutable std::mutex mutex_;  // guards all down to the next comment
    std::condition_variable condition_;
    bool stop_ = false;
    std::optional<PictureRequest> wanted_;  // not yet begun
    PictureRequest in_work_;
    std::uint64_t wanted_number_ = 0;
    FrameJob* job_ = nullptr;
    Patience patience_;
    PictureBoard board_;
    std::optional<Overtaken> overtaken_;
    SessionTotals totals_;
    std::uint64_t shown_number_ = 0;
    std::shared_ptr<const Scene> shown_scene_;
    Camera shown_camera_;

    // The director's thread alone, and what a job's notices let the workers read.
    EditedCanvas canvas_;

    std::jthread thread_;  // last: joined before what it uses is gone
};

}  // namespace ivory
