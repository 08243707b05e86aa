// Plays a script on a viewer in memory, as a person would: every step goes through the input, one
// change a frame. Without a pace a frame waits for the picture of its input, however long that takes
// within reason, so that what it shows does not depend on time.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>

#include "app/platform/context.h"
#include "app/platform/input.h"
#include "app/viewer/script.h"
#include "app/viewer/state_file.h"
#include "app/viewer/viewer.h"

namespace ivory {

// What ends a sleep of the loop: the memory's counterpart of a window system's events.
class WakeUp {
  public:
    void wake();
    // Until `wake` has been called since the last wait, or so many seconds have passed.
    void wait(double seconds);

  private:
    std::mutex mutex_;
    std::condition_variable condition_;
    bool woken_ = false;
};

class ScriptPlayer {
  public:
    // `wake_up` is what the viewer's ViewerSettings::wake wakes. `stop` is asked in every frame and
    // may throw (an interrupt).
    ScriptPlayer(Viewer& viewer, MemoryContext& context, EventQueue& events, WakeUp& wake_up,
                 std::function<void()> stop);

    // Throws Error: file, line, what failed.
    void play(const Script& script);

    // The steps that a call without a script needs.
    void wait_final();
    void screenshot(const std::string& file, bool viewport);

  private:
    void turn();
    void turn(Event event);
    void turns(int count);
    void settle();
    double wait_for_turn();
    void move_to(WindowPoint at);
    void click();
    void stroke(const Chord& chord);
    void type(const std::u32string& text);

    // The widget with that id in sight, scrolled to and its menu opened if need be.
    const Widget& bring_into_sight(const std::string& id);
    void click_widget(const std::string& id);
    void set_number(const std::string& id, const nlohmann::json& value);
    void set_color(const std::string& id, const nlohmann::json& value);
    void choose(const std::string& id, const nlohmann::json& value);
    // Into the text field that has just been opened, in place of all that stands there.
    void enter_text(const std::string& text);

    void take(const step::WaitFinal&) { wait_final(); }
    void take(const step::Pace& step);
    void take(const step::Frames& step) { turns(step.count); }
    void take(const step::Mouse& step) { move_to(step.at); }
    void take(const step::MouseTo& step);
    void take(const step::Move& step);
    void take(const step::Press& step) { turn(MouseButtonChanged{step.button, true}); }
    void take(const step::Release& step) { turn(MouseButtonChanged{step.button, false}); }
    void take(const step::DoubleClick& step);
    void take(const step::Wheel& step) { turn(WheelTurned{0, step.steps}); }
    void take(const step::Hold& step) { turn(KeyChanged{step.key, true, false}); }
    void take(const step::Let& step) { turn(KeyChanged{step.key, false, false}); }
    void take(const step::KeyStroke& step);
    void take(const step::Type& step) { type(step.text); }
    void take(const step::UseWidget& step);
    void take(const step::Pick& step);
    void take(const step::Select& step);
    void take(const step::Grab& step);
    void take(const step::Drag& step);
    void take(const step::Drop& step);
    void take(const step::Resize& step);
    void take(const step::Scale& step);
    void take(const step::SetTheme& step);
    void take(const step::Expect& step);
    void take(const step::Save& step);
    void take(const step::WriteState& step);
    void take(const step::Screenshot& step) { screenshot(step.file, step.viewport); }

    Viewer& viewer_;
    MemoryContext& context_;
    EventQueue& events_;
    WakeUp& wake_up_;
    std::function<void()> stop_;
    // Frames and steps of input a second; 0: each as soon as the one before is done with.
    double pace_ = 0;
    std::chrono::steady_clock::time_point turned_;  // when the last frame began, at a pace
    StateBefore at_last_state_;
};

}  // namespace ivory
