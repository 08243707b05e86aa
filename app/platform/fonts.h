// The typefaces of the viewer, built into the executable: assets/fonts, licence beside them.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "app/platform/system_fonts.h"

struct ImFont;

namespace ivory {

struct Fonts {
    ImFont* text = nullptr;    // 15 pixels at scale 1; its figures have one width
    ImFont* strong = nullptr;  // headings: the same size, heavier
    // What the atlas reads when it is built.
    std::shared_ptr<const std::vector<FontFile>> files;
    std::vector<std::vector<unsigned short>> ranges;

    // Both draw it themselves, not with a sign that stands for all that is missing.
    [[nodiscard]] bool have(char32_t character) const;
};

// Fills the current ImGui context's atlas anew for that scale, crisp at every one. The renderer has
// to take up the new atlas (ImguiRenderer::upload_fonts) as long as the Fonts live. Those of `more`
// that the typefaces lack are taken from the fonts of the system, where it has them.
Fonts load_fonts(double scale, std::span<const char16_t> more = {});

}  // namespace ivory
