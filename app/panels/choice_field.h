// One of a few words, all of them in sight.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "app/panels/viewer_state.h"

namespace ivory {

struct Choice {
    std::string word;   // ID.WORD is its control
    const char* label;  // there
};

// Over the rest of the line, in as many rows as they need. The one that was clicked, if one was;
// `now` stands out.
[[nodiscard]] std::optional<std::size_t> choice_field(ViewerState& state, const std::string& id,
                                                      std::span<const Choice> choices,
                                                      std::size_t now);

}  // namespace ivory
