// The viewer's state and the scene as JSON: what scripts write and expect (scene-format.md of the
// file format names the keys).
#pragma once

#include <cstdint>
#include <string>

#include <nlohmann/json.hpp>

#include "app/viewer/viewer.h"

namespace ivory {

// `viewport`, `selection`, `camera`, `handles`, `widgets`, `tiles`, `pixels`, `final`,
// `milliseconds`, and beyond the contract `message`, `dirty`, `undo`, `redo`, `path`, `theme`,
// `scale`. `tiles_before`: SessionTotals::tiles_traced at the last state; `traced` counts from
// there.
[[nodiscard]] nlohmann::json state_json(Viewer& viewer, std::uint64_t tiles_before);

// As text for people: objects of objects one key a line, the rest on that line. A newline at the
// end.
[[nodiscard]] std::string state_text(const nlohmann::json& state);

// The scene as `write_scene` would have it, with the camera of the view and every default filled
// in.
[[nodiscard]] nlohmann::json whole_scene_json(const ViewerState& state);

}  // namespace ivory
