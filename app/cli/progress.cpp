#include "app/cli/progress.h"

#include <unistd.h>

#include <cstdio>

namespace ivory {
namespace {

constexpr const char* wipe = "\r\x1b[K";  // to the beginning of the line, and clear it

}  // namespace

Progress::Progress(bool quiet) : visible_(!quiet && ::isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
    if (shown_) std::fputs(wipe, stderr);
}

void Progress::show(const std::string& line) {
    if (!visible_) return;
    std::fprintf(stderr, "%s%s", wipe, line.c_str());
    shown_ = true;
}

void Progress::leave(const std::string& line) {
    if (!visible_) return;
    std::fprintf(stderr, "%s%s\n", wipe, line.c_str());
    shown_ = false;
}

}  // namespace ivory
