// The typefaces of the viewer, built into the executable: assets/fonts, licence beside them.
#pragma once

struct ImFont;

namespace ivory {

struct Fonts {
    ImFont* text = nullptr;    // 15 pixels at scale 1; its figures have one width
    ImFont* strong = nullptr;  // headings: the same size, heavier
};

// Fills the current ImGui context's atlas anew for that scale, crisp at every one. The renderer has
// to take up the new atlas (ImguiRenderer::upload_fonts).
Fonts load_fonts(double scale);

}  // namespace ivory
