#include "app/cli/interrupt.h"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <system_error>
#include <utility>

namespace ivory {
namespace {

// What a person, a terminal, a time limit or a system that shuts down sends.
constexpr std::array stopping{SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGXCPU, SIGUSR1, SIGUSR2};

std::atomic<bool> flag{false};
std::atomic<int> bell{-1};  // the end of a pipe that the signal writes to; < 0: none
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<bool>::is_always_lock_free,
              "else a signal handler must not touch it");

extern "C" void note_signal(int) {
    const int error = errno;
    flag.store(true, std::memory_order_relaxed);
    const int pipe = bell.load(std::memory_order_relaxed);
    if (pipe >= 0) static_cast<void>(!::write(pipe, "", 1));
    errno = error;
}

}  // namespace

void watch_interrupts() {
    ::signal(SIGPIPE, SIG_IGN);  // a reader that has gone is an error of the write
    ::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is too
    struct sigaction action {};
    action.sa_handler = note_signal;
    action.sa_flags = SA_RESETHAND;  // and no SA_RESTART
    sigemptyset(&action.sa_mask);
    for (const int signal : stopping) {
        struct sigaction before {};
        ::sigaction(signal, nullptr, &before);
        // nohup means it
        if (signal == SIGHUP && before.sa_handler == SIG_IGN) continue;
        ::sigaction(signal, &action, nullptr);
    }
}

bool interrupted() noexcept { return flag.load(std::memory_order_relaxed); }

const std::atomic<bool>& interruption() noexcept { return flag; }

void stop_if_interrupted() {
    if (interrupted()) throw Interrupted();
}

InterruptBell::InterruptBell(std::function<void()> ring) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) return;
    read_end_ = ends[0];
    write_end_ = ends[1];
    try {
        listener_ = std::jthread([this, ring = std::move(ring)] {
            char byte = 0;
            ssize_t count = 0;
            do {
                count = ::read(read_end_, &byte, 1);
            } while (count < 0 && errno == EINTR);
            if (interrupted()) ring();
        });
    } catch (const std::system_error&) {
        return;  // then whoever sleeps hears of it at the next event
    }
    bell.store(write_end_, std::memory_order_relaxed);
    if (interrupted()) static_cast<void>(!::write(write_end_, "", 1));
}

InterruptBell::~InterruptBell() {
    bell.store(-1, std::memory_order_relaxed);
    if (listener_.joinable()) {
        static_cast<void>(!::write(write_end_, "", 1));
        listener_.join();
    }
    if (read_end_ < 0) return;
    ::close(read_end_);
    ::close(write_end_);
}

}  // namespace ivory
