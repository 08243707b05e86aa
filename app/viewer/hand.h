// A person's hand on a viewer in memory: input through the same queue as a window's, one change a frame.
// Without a pace a frame waits for the picture of its input, however long that takes within reason, so
// that what it shows does not depend on time.
#pragma once

#include <chrono>
#include <functional>
#include <string>

#include "app/platform/input.h"
#include "app/viewer/script.h"
#include "app/viewer/viewer.h"

namespace ivory {

class Hand {
  public:
    // `stop` is asked in every frame and may throw (an interrupt).
    Hand(Viewer& viewer, EventQueue& events, std::function<void()> stop);

    // From here on so many frames and changes of input a second of real time; 0: each as soon as the one
    // before is done with.
    void set_pace(double per_second);
    [[nodiscard]] bool has_pace() const { return pace_ != 0; }

    // A frame, and more while there is input that they have not taken.
    void turn();
    void turn(Event event);
    void turns(int count);
    // Until what was done shows: menus open, windows stand.
    void settle();

    void move_to(WindowPoint at);
    void click();
    void stroke(const Chord& chord);
    void type(const std::u32string& text);
    // Where the pointer is.
    [[nodiscard]] WindowPoint at() const { return events_.last_frame().mouse; }

  private:
    double wait_for_turn();

    Viewer& viewer_;
    EventQueue& events_;
    std::function<void()> stop_;
    double pace_ = 0;
    std::chrono::steady_clock::time_point turned_;  // when the last frame began, at a pace
};

}  // namespace ivory
