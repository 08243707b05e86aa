// Plays a script on a viewer in memory, as a person would: every step goes through the input.
#pragma once

#include <functional>
#include <string>

#include "app/platform/context.h"
#include "app/platform/input.h"
#include "app/viewer/control_hand.h"
#include "app/viewer/hand.h"
#include "app/viewer/script.h"
#include "app/viewer/state_file.h"
#include "app/viewer/viewer.h"
#include "app/viewer/wake_up.h"

namespace ivory {

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
    void take(const step::WaitFinal&) { wait_final(); }
    void take(const step::Pace& step) { hand_.set_pace(step.per_second); }
    void take(const step::Frames& step) { hand_.turns(step.count); }
    void take(const step::Mouse& step) { hand_.move_to(step.at); }
    void take(const step::MouseTo& step);
    void take(const step::Move& step);
    void take(const step::Press& step) { hand_.turn(MouseButtonChanged{step.button, true}); }
    void take(const step::Release& step) { hand_.turn(MouseButtonChanged{step.button, false}); }
    void take(const step::DoubleClick& step);
    void take(const step::Wheel& step) { hand_.turn(WheelTurned{0, step.steps}); }
    void take(const step::Hold& step) { hand_.turn(KeyChanged{step.key, true, false}); }
    void take(const step::Let& step) { hand_.turn(KeyChanged{step.key, false, false}); }
    void take(const step::KeyStroke& step);
    void take(const step::Type& step) { hand_.type(step.text); }
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
    Hand hand_;
    ControlHand controls_;
    WakeUp& wake_up_;
    StateBefore at_last_state_;
};

}  // namespace ivory
