// Tracing while a person works: scenes go in at any time, finished tiles come out, nobody waits.
//
//   show(request) -> director: compile, start a job -> workers: tiles -> board -> poll() -> shown()
//
// The picture shown is always all of one scene and camera, and while these change of one resolution:
// as fine as can be made until the request's `due`. When they have not changed for a moment the final
// picture takes the place of a coarse one tile by tile, from the pointer outwards.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>

#include "app/panels/picture_state.h"
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
        // no more often than is worth a frame, for a first and for a final picture at once.
        std::function<void()> wake;
    };

    // Throws Error where no thread can be started.
    explicit RenderSession(Settings settings);
    ~RenderSession();
    RenderSession(const RenderSession&) = delete;
    RenderSession& operator=(const RenderSession&) = delete;

    // From now on this picture is wanted. Never waits. Refinement of the one before is cancelled at
    // once (each worker ends after at most one tile more); its first picture still is finished, if
    // that takes no more than twice the time that it was given, or someone who drags without a pause
    // would see nothing.
    void show(PictureRequest request);
    // It still is: all input has been looked at, and none wants another one. Nothing is refined before
    // that has been said after a moment without a request.
    void stays();

    // Takes over what is finished.
    PictureChange poll();

    // Until the wanted picture can be shown, has a fault, or that time has come. Whether it is so.
    [[nodiscard]] bool wait_until_showable(std::chrono::steady_clock::time_point time) const;

    [[nodiscard]] const ShownPicture& shown() const { return shown_; }
    // When the edit was made of which that is the picture.
    [[nodiscard]] std::chrono::steady_clock::time_point shown_since() const { return shown_since_; }
    // As of the last poll. Its `depth` is that of shown().
    [[nodiscard]] const PictureState& state() const { return state_; }

    [[nodiscard]] SessionTotals totals() const;

  private:
    class Director;

    ShownPicture shown_;
    PictureState state_;
    std::chrono::steady_clock::time_point shown_since_;
    std::unique_ptr<Director> director_;
};

}  // namespace ivory
