// Ctrl+C, a closed terminal and the like: a flag that long work looks at.
#pragma once

#include <atomic>
#include <functional>
#include <thread>

namespace ivory {

// Thrown where the wish to stop is seen. Exit status: interrupted_status.
struct Interrupted {};

// From now on the signals that ask a program to end (SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGXCPU,
// SIGUSR1, SIGUSR2) raise the flag instead of ending the process; a second of a kind ends it at
// once. System calls that wait are woken (EINTR). A SIGHUP that is ignored (nohup) stays so. What a
// write could raise (SIGPIPE, SIGXFSZ) is ignored: the write says what is wrong.
void watch_interrupts();

[[nodiscard]] bool interrupted() noexcept;

// The flag itself, for those who look at it on their own.
[[nodiscard]] const std::atomic<bool>& interruption() noexcept;

// Throws Interrupted where the flag is up.
void stop_if_interrupted();

// The exit status of a run that a signal has stopped, whichever.
inline constexpr int interrupted_status = 130;

// For a loop that sleeps where no signal wakes it. One at a time.
class InterruptBell {
  public:
    // `ring` is called once, on another thread, when the flag goes up or is up already.
    explicit InterruptBell(std::function<void()> ring);
    ~InterruptBell();
    InterruptBell(const InterruptBell&) = delete;
    InterruptBell& operator=(const InterruptBell&) = delete;

  private:
    int read_end_ = -1, write_end_ = -1;
    std::jthread listener_;
};

}  // namespace ivory
