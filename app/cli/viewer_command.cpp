#include "app/cli/commands.h"

#ifdef IVORY_VIEWER
#include <signal.h>

#include "app/cli/interrupt.h"
#include "app/panels/settings.h"
#include "app/viewer/headless.h"
#include "app/viewer/window_loop.h"
#else
#include "core/scene/error.h"
#endif

namespace ivory {

#ifdef IVORY_VIEWER

void run(const ViewerArguments& arguments) {
    const WindowSize size{arguments.width, arguments.height};
    if (arguments.headless) {
        run_headless({arguments.scene, arguments.script, arguments.screenshot, size,
                      arguments.threads, stop_if_interrupted});
        return;
    }
    // The loop sleeps until the window has something to say: let the signal end the process as it would.
    for (const int number : {SIGINT, SIGTERM}) ::signal(number, SIG_DFL);
    run_window({arguments.scene, arguments.size_given ? std::optional(size) : std::nullopt,
                arguments.threads, arguments.no_settings ? std::nullopt : settings_path()});
}

#else

void run(const ViewerArguments&) {
    throw Error(
        "this build has no viewer; draw with `ivory render SCENE -o OUT.png`, or see `ivory "
        "--help`");
}

#endif

}  // namespace ivory
