// Ctrl+C: a flag that long work looks at.
#pragma once

namespace ivory {

// Thrown where the user's wish to stop is seen. Exit status 130.
struct Interrupted {};

// From now on SIGINT and SIGTERM raise the flag instead of ending the process; a second one ends it
// at once. System calls that wait are woken (EINTR).
void watch_interrupts();

[[nodiscard]] bool interrupted() noexcept;

// Throws Interrupted where the flag is up.
void stop_if_interrupted();

}  // namespace ivory
