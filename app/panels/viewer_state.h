// All that the viewer knows and shows: what panels, overlay and bindings read and change.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <set>
#include <string>

#include "app/document/document.h"
#include "app/document/document_view.h"
#include "app/document/orbit.h"
#include "app/panels/panel_memory.h"
#include "app/panels/picture_state.h"
#include "app/panels/widgets.h"
#include "app/platform/fonts.h"
#include "app/platform/input.h"
#include "app/platform/window_rect.h"
#include "core/scene/stop.h"

namespace ivory {

struct Message {
    std::string text;  // one line; empty: none
    bool error = false;
    double seconds_left = 0;  // until it goes
};

// A normal as a drag left it, and the length that its handle's arrow goes by: with its own the tip
// would leap when it is let go.
struct KeptArrow {
    std::size_t element = 0;
    Vec3d normal;
    double length = 1;
};

struct ViewerState {
    Document document;
    DocumentView view;
    PictureState picture;  // read only, but for app/viewer
    Widgets widgets;
    Fonts fonts;
    std::set<char16_t> glyphs;  // beyond ASCII, that names need; Viewer loads fonts for them

    // Layout of this frame, frame-buffer pixels; `viewport` is set by draw_panels.
    WindowSize window;
    double scale = 1;
    WindowRect viewport;

    Theme theme = Theme::dark;
    bool panels_hidden = false;  // Tab
    bool help_shown = false;     // ?
    bool skeleton_shown = true;  // the overlay as a whole
    int samples = 1;             // a pixel, of the final picture: one of samples_to_choose
    Message message;
    std::optional<KeptArrow> arrow;  // of the last normal that was dragged
    PanelMemory panels;
    Stop stop;  // asked while a file is read; empty where a signal ends the process by itself

    // Wishes, fulfilled by Viewer at the end of the frame.
    std::optional<std::filesystem::path> screenshot_wanted;  // F12
    bool quit = false;                                       // set only when nothing is left to ask

    // The scene as it would be saved: the document's with the camera of the view.
    [[nodiscard]] Scene scene_with_view() const;
    [[nodiscard]] Projection projection() const { return {view.camera, viewport.size()}; }
    void say(std::string text) { message = {std::move(text), false, 4}; }
    void say_error(std::string text) { message = {std::move(text), true, 20}; }
};

}  // namespace ivory
