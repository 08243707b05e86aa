// The command line, taken apart and checked.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <variant>

#include "core/render/stereo.h"
#include "core/trace/methods/method.h"

namespace ivory {

// Wrong usage, exit status 2. what() is one line: what is wrong, what would be right.
class UsageError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

// What every call that traces rays takes.
struct WorkArguments {
    const Method* method = nullptr;
    MethodOptions options;
    int threads = 1;
    bool quiet = false;
};

// In every file name "-" is standard input or output; empty: not asked for.
struct RenderArguments {
    std::string scene;
    std::string picture, depth, answers, statistics;
    int width = 1280, height = 720;  // pixels
    int repeat = 1;
    int samples_a_side = 1;  // of a pixel
    Stereo stereo = Stereo::none;
    std::optional<double> eyes;  // how far apart; without: core/render/camera.h
    WorkArguments work;
};

struct TraceArguments {
    std::string scene;
    std::string rays = "-";
    WorkArguments work;
};

struct InfoArguments {
    std::string scene;  // empty with `methods`
    bool json = false;
    bool methods = false;
};

struct ViewerArguments {
    std::optional<std::string> scene;
    bool headless = false;                          // in memory: no window, no display
    std::optional<std::string> script, screenshot;  // headless only
    int width = 1280, height = 720;                 // frame-buffer pixels
    bool size_given = false;                        // otherwise a window is as large as it was left
    bool no_settings = false;  // leaves the user's settings alone; implied by `headless`
    int threads = 1;
};

// Asked for by --help or --version, to be printed.
struct HelpText {
    std::string text;
};

using Arguments =
    std::variant<ViewerArguments, RenderArguments, TraceArguments, InfoArguments, HelpText>;

// Throws UsageError.
[[nodiscard]] Arguments parse_arguments(int count, const char* const* words);

}  // namespace ivory
