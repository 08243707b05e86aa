#include "app/viewer/hand.h"

#include <thread>
#include <utility>

namespace ivory {

namespace {

using Clock = std::chrono::steady_clock;

constexpr double frame_seconds = 1.0 / 60;  // of the script's own time, whatever a frame takes
// A person waits for the surface to follow before moving on; no longer than that for a heavy scene.
constexpr double patience = 2 * IVORY_PATIENCE;  // seconds
constexpr double frames_until_shown = 2;         // at a pace: at 60 a second as in a window
constexpr int frames_to_settle = 3;

}  // namespace

Hand::Hand(Viewer& viewer, EventQueue& events, std::function<void()> stop)
    : viewer_(viewer), events_(events), stop_(std::move(stop)) {
    viewer_.set_frame_budget(patience);
}

void Hand::set_pace(double per_second) {
    pace_ = per_second;
    turned_ = Clock::now();
    viewer_.set_frame_budget(pace_ == 0 ? patience : frames_until_shown / pace_);
}

void Hand::turn() {
    do {
        stop_();
        viewer_.frame(events_.next_frame(wait_for_turn()));
    } while (!events_.empty());
}

// Until the next frame is to begin. Seconds since the last one did: of the script's own time, or at a
// pace of real time.
double Hand::wait_for_turn() {
    if (pace_ == 0) return frame_seconds;
    const std::chrono::duration<double> between(1 / pace_);
    const Clock::time_point due = turned_ + std::chrono::duration_cast<Clock::duration>(between);
    std::this_thread::sleep_until(due);
    const Clock::time_point now = Clock::now();
    return std::chrono::duration<double>(now - std::exchange(turned_, now)).count();
}

void Hand::turn(Event event) {
    events_.push(std::move(event));
    turn();
}

void Hand::turns(int count) {
    for (int i = 0; i < count; ++i) turn();
}

void Hand::settle() { turns(frames_to_settle); }

void Hand::move_to(WindowPoint at) { turn(MouseMoved{at}); }

void Hand::click() {
    turn(MouseButtonChanged{MouseButton::left, true});
    turn(MouseButtonChanged{MouseButton::left, false});
}

void Hand::stroke(const Chord& chord) {
    const auto modifiers = [&](bool down) {
        if (chord.modifiers.control) events_.push(KeyChanged{Key::control, down, false});
        if (chord.modifiers.shift) events_.push(KeyChanged{Key::shift, down, false});
        if (chord.modifiers.alt) events_.push(KeyChanged{Key::alt, down, false});
        if (chord.modifiers.super) events_.push(KeyChanged{Key::super, down, false});
    };
    modifiers(true);
    events_.push(KeyChanged{chord.key, true, false});
    if (chord.character != 0) events_.push(TextTyped{chord.character});
    turn();
    events_.push(KeyChanged{chord.key, false, false});
    modifiers(false);
    turn();
}

void Hand::type(const std::u32string& text) {
    for (const char32_t character : text) events_.push(TextTyped{character});
    turn();
}

}  // namespace ivory
