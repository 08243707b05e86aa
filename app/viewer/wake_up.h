// What ends a sleep: the memory's counterpart of a window system's events.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>

namespace ivory {

class WakeUp {
  public:
    void wake() {
        const std::lock_guard lock(mutex_);
        woken_ = true;
        condition_.notify_all();
    }
    // Until `wake` has been called since the last wait, or so many seconds have passed.
    void wait(double seconds) {
        std::unique_lock lock(mutex_);
        condition_.wait_for(lock, std::chrono::duration<double>(seconds),
                            [this] { return woken_; });
        woken_ = false;
    }

  private:
    std::mutex mutex_;
    std::condition_variable condition_;
    bool woken_ = false;
};

}  // namespace ivory
