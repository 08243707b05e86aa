// Patience: how long an edit waits for the picture before it, how long a coarse picture waits for a
// better one, and what is worth a frame. Every moment that a person would feel is decided here, and
// from nothing but times and how far the picture in work is; nothing is started or cut here.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

namespace ivory {

// Which first pictures `poll` takes over. Coarse blocks that are about to be refined only flicker,
// unless that takes long enough to be waited for.
enum class FirstPicture : std::uint8_t {
    any,      // whatever is there of the whole picture
    fine,     // fine blocks at once: the next edit is about to replace them
    settled,  // and these after a moment, since the final picture may be there before anyone sees it
};

// How far a picture in the making is, from worse to better.
enum class Readiness : std::uint8_t {
    partial,  // some of it shows nothing, or what another picture showed
    coarse,   // all of it is there
    fine,     // and can be worked with
};

// Of one picture in work after the other. Used under the session's lock.
class Patience {
  public:
    using Time = std::chrono::steady_clock::time_point;

    void begin() { superseded_.reset(); }
    // Another picture than that in work is wanted; the first of such calls counts.
    void supersede(Time now);
    // So far it was when its first pass had ended.
    void end(Readiness ready) { starved_ = ready == Readiness::partial; }

    // Nothing more is to be done for the picture in work, since there is another to be made.
    [[nodiscard]] bool enough(Readiness ready, Time now) const;
    // Something more of a whole picture is there: whether the window should look at once.
    // `better`: it has become ready, or fine.
    [[nodiscard]] bool worth_a_frame(bool better, Time now);

  private:
    std::optional<Time> superseded_;  // when there was first another than that in work
    bool starved_ = false;            // the one before that was cut short with nothing to show
    Time last_frame_;
};

// A complete picture of the edit made at `since` is shown from then on. `certain`: it is final, or
// there is no other to be seen.
[[nodiscard]] Patience::Time first_picture_due(FirstPicture first, Readiness ready, bool certain,
                                               Patience::Time since);

// When tiles are traced again that nobody can tell from what they are, unless there is a newer edit.
[[nodiscard]] Patience::Time hand_rests_at(Patience::Time since);

}  // namespace ivory
