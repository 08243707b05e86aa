#include "app/cli/interrupt.h"

#include <signal.h>

#include <atomic>

namespace ivory {
namespace {

std::atomic<bool> flag{false};
static_assert(std::atomic<bool>::is_always_lock_free, "else a signal handler must not touch it");

extern "C" void raise_flag(int) { flag.store(true, std::memory_order_relaxed); }

}  // namespace

void watch_interrupts() {
    struct sigaction action {};
    action.sa_handler = raise_flag;
    action.sa_flags = SA_RESETHAND;  // and no SA_RESTART
    sigemptyset(&action.sa_mask);
    ::sigaction(SIGINT, &action, nullptr);
    ::sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() noexcept { return flag.load(std::memory_order_relaxed); }

void stop_if_interrupted() {
    if (interrupted()) throw Interrupted();
}

}  // namespace ivory
