#include "app/viewer/patience.h"

namespace ivory {

namespace {

using std::chrono::milliseconds;

// Between the frames that show refinement: more would only take time from the tracer.
constexpr milliseconds refinement_interval{40};
// A first picture of fine blocks is shown this long after the edit at the earliest, if more is
// coming, and one of coarser blocks.
constexpr milliseconds hold_back{12}, hold_back_coarse{20};
// How long an edit leaves the picture before it to become fine, or to become complete at all when
// the one before that was cut short too: someone who drags without a pause sees the surface follow.
constexpr milliseconds grace{15}, grace_when_starved{100};
// After the last edit, before what nobody can tell from the final picture is made final.
constexpr milliseconds rest{150};

}  // namespace

void Patience::supersede(Time now) {
    if (!superseded_) superseded_ = now;
}

bool Patience::enough(Readiness ready, Time now) const {
    if (!superseded_) return false;
    const auto waited = now - *superseded_;
    return ready == Readiness::fine || waited >= grace_when_starved ||
           (waited >= grace && (ready != Readiness::partial || !starved_));
}

bool Patience::worth_a_frame(bool better, Time now) {
    // of a picture that is about to be replaced, refinement is not worth a frame
    const bool worth = better || (!superseded_ && now - last_frame_ >= refinement_interval);
    if (worth) last_frame_ = now;
    return worth;
}

Patience::Time first_picture_due(FirstPicture first, Readiness ready, bool certain,
                                 Patience::Time since) {
    const bool is_fine = ready == Readiness::fine;
    const bool at_once =
        certain || first == FirstPicture::any || (first == FirstPicture::fine && is_fine);
    if (at_once) return since;
    return since + (is_fine ? hold_back : hold_back_coarse);
}

Patience::Time hand_rests_at(Patience::Time since) { return since + rest; }

}  // namespace ivory
