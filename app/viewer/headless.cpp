#include "app/viewer/headless.h"

#include <memory>

#include "app/panels/panels.h"
#include "app/platform/context.h"
#include "app/viewer/script.h"
#include "app/viewer/script_player.h"
#include "app/viewer/viewer.h"

namespace ivory {

void run_headless(const HeadlessSettings& settings) {
    // what can be wrong without a frame is said before there is one
    const std::optional<Script> script =
        settings.script ? std::optional(read_script(*settings.script)) : std::nullopt;
    if (script)
        check_files(*script, {*settings.script, settings.scene.value_or(""),
                              settings.screenshot.value_or("")});

    const std::unique_ptr<MemoryContext> context = open_memory_context(settings.size);
    EventQueue events(settings.size);
    WakeUp wake_up;
    ViewerSettings viewer_settings;
    viewer_settings.threads = settings.threads;
    viewer_settings.wake = [&] { wake_up.wake(); };
    Viewer viewer(*context, std::move(viewer_settings));
    viewer.state().stop = settings.stop;
    if (settings.scene) open_scene(viewer.state(), *settings.scene);

    ScriptPlayer player(viewer, *context, events, wake_up, settings.stop);
    if (script)
        player.play(*script);
    else
        player.wait_final();
    if (settings.screenshot) player.screenshot(*settings.screenshot, false);
}

}  // namespace ivory
