// Tracing while a person works: scenes go in at any time, finished tiles come out, nobody waits.
//
//   show(request) -> director: compile, start a job -> workers: tiles -> board -> poll() -> shown()
//
// The picture shown is always all of one scene: a new one gathers on the board and replaces the old
// one as blocks, coarse enough to come in time; then it is refined in place.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "app/panels/picture_state.h"
#include "app/viewer/patience.h"
#include "app/viewer/shown_picture.h"

namespace ivory {

// How often, since the session began: for tests, which count rather than measure.
struct SessionTotals {
    std::uint64_t begun = 0;      // pictures
    std::uint64_t cancelled = 0;  // of these, before they were final
    std::uint64_t tiles_traced = 0, pixels_traced = 0;
};

class RenderSession {
  public:
    struct Settings {
        int threads = 1;
        double tolerance = 1e-6;  // E
        bool yields = false;  // its threads get a processor after others, where that is possible
        // Called by other threads when there is something to poll; must not throw. For refinement
        // no more often than is worth a frame, for a first complete and for a final picture at
        // once.
        std::function<void()> wake;
    };

    // Throws Error where no thread can be started.
    explicit RenderSession(Settings settings);
    ~RenderSession();
    RenderSession(const RenderSession&) = delete;
    RenderSession& operator=(const RenderSession&) = delete;

    // From now on this picture is wanted. Never waits. Refinement of the one before is cancelled at
    // once (each worker ends after at most one tile more); its first complete picture may still be
    // finished for a bounded time, or a drag over a heavy scene would show nothing.
    void show(PictureRequest request);

    // Takes over what is finished.
    PictureChange poll(FirstPicture first);

    [[nodiscard]] const ShownPicture& shown() const { return shown_; }
    // As of the last poll. Its `depth` is that of shown().
    [[nodiscard]] const PictureState& state() const { return state_; }
    // So many seconds from the last poll a picture that was held back is due; < 0: none was.
    [[nodiscard]] double seconds_until_due() const { return seconds_until_due_; }

    // Whether the wanted scene has its first complete picture, shown or waiting for a poll.
    [[nodiscard]] bool first_picture_ready() const;
    [[nodiscard]] SessionTotals totals() const;

  private:
    class Director;

    ShownPicture shown_;
    PictureState state_;
    double seconds_until_due_ = -1;
    std::unique_ptr<Director> director_;
};

}  // namespace ivory
