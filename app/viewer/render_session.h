// Tracing while a person works: scenes go in at any time, finished tiles come out, nobody waits.
//
//   show(request) -> director: compile, start a job -> workers: tiles -> board -> poll() -> shown()
//
// The picture shown is always all of one scene: a new one gathers on the board and replaces the old
// one as blocks, coarse enough to come in time; then it is refined in place.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "app/panels/picture_state.h"
#include "app/platform/window_rect.h"
#include "core/render/frame.h"
#include "core/render/tiles.h"
#include "core/scene/scene.h"

namespace ivory {

// Which first pictures `poll` takes over. Coarse blocks that are about to be refined only flicker,
// unless that takes long enough to be waited for.
enum class FirstPicture : std::uint8_t {
    any,      // whatever is there of the whole picture
    fine,     // fine blocks at once: the next edit is about to replace them
    settled,  // and these after a moment, since the final picture may be there before anyone sees it
};

struct PictureRequest {
    std::shared_ptr<const Scene> scene;  // its own camera is not looked at
    Camera camera;
    WindowSize size;                   // at least 1 x 1
    std::optional<WindowPoint> focus;  // in the picture: what is refined first; none: the middle
    std::chrono::steady_clock::time_point since;  // when the edit was made
};

// The bytes on the screen, row by row from the top.
struct ShownPicture {
    WindowSize size;
    std::vector<Rgba8> color;
    std::vector<float> depth;  // see PictureState
};

// What `poll` changed in the shown picture.
struct PictureChange {
    bool replaced = false;         // the picture of another scene, camera or size than before
    bool all = false;              // another size: everything
    std::vector<PixelRect> tiles;  // otherwise: these tiles and no other pixel
    [[nodiscard]] bool any() const { return all || !tiles.empty(); }
};

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
