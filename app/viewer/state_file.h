// The viewer's state and the scene as JSON: what scripts write and expect (scene-format.md of the
// file format names the keys).
#pragma once

#include <cstdint>
#include <string>

#include <nlohmann/json.hpp>

#include "app/viewer/viewer.h"

namespace ivory {

// How much there was of what a state counts from the one before.
struct StateBefore {
    std::uint64_t tiles = 0;   // SessionTotals::tiles_traced
    std::uint64_t frames = 0;  // Viewer::frame_count
};

// `viewport`, `selection`, `camera` (its `height` in a perspective view what is seen at the target),
// `handles`, `widgets`, `tiles`, `pixels`, `final`, `milliseconds`, and beyond the contract `message`,
// `dirty`, `undo`, `redo`, `path`, `theme`, `scale`, `view` (`undo`, `redo` whether there are moves of
// the camera to be, `saved` whether the camera is the file's or automatic, `chosen` the saved view that
// was chosen last), and `frames`: of the frames since the state before, the last 2048 of them, a list
// for each member of FrameRecord.
[[nodiscard]] nlohmann::json state_json(Viewer& viewer, const StateBefore& before);

// As text for people: objects of objects one key a line, the rest on that line. A newline at the
// end.
[[nodiscard]] std::string state_text(const nlohmann::json& state);

// The scene as `write_scene` would have it, with the camera of the view and every default filled
// in.
[[nodiscard]] nlohmann::json whole_scene_json(const ViewerState& state);

}  // namespace ivory
