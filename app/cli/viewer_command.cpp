#include "app/cli/commands.h"

#ifdef IVORY_VIEWER
#include <functional>
#include <memory>
#include <utility>

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
    WindowSettings settings;
    settings.scene = arguments.scene;
    if (arguments.size_given) settings.size = size;
    settings.threads = arguments.threads;
    if (!arguments.no_settings) settings.user_settings = settings_path();
    settings.stop = stop_if_interrupted;
    settings.listen = [](std::function<void()> wake) {
        return std::make_shared<InterruptBell>(std::move(wake));
    };
    run_window(settings);
}

#else

void run(const ViewerArguments&) {
    throw Error(
        "this build has no viewer; draw with `ivory render SCENE -o OUT.png`, or see `ivory "
        "--help`");
}

#endif

}  // namespace ivory
