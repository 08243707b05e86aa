#include "app/platform/fonts.h"

#include <imgui.h>

#include <cmath>
#include <string_view>

#include "app/platform/embedded.h"

namespace ivory {

namespace {

constexpr double text_size = 15;  // pixels at scale 1

// Latin with its extensions, Greek, Cyrillic, and the punctuation and signs that the panels use.
constexpr ImWchar glyph_ranges[] = {0x0020, 0x00FF, 0x0100, 0x024F, 0x0370, 0x03FF, 0x0400, 0x04FF,
                                    0x2010, 0x2027, 0x2030, 0x203A, 0x2070, 0x209F, 0x20A0, 0x20BF,
                                    0x2120, 0x2122, 0x2190, 0x2193, 0x2202, 0x2265, 0};

ImFont* add_font(ImFontAtlas& atlas, std::string_view file, float size) {
    ImFontConfig config;
    config.FontDataOwnedByAtlas = false;  // it is part of the executable
    config.OversampleH = 2;
    config.OversampleV = 1;
    config.PixelSnapH = true;  // stems fall on whole pixels: the same text looks the same everywhere
    // ImGui reads it and no more
    void* const bytes = const_cast<char*>(file.data());
    return atlas.AddFontFromMemoryTTF(bytes, static_cast<int>(file.size()), size, &config,
                                      glyph_ranges);
}

}  // namespace

Fonts load_fonts(double scale) {
    ImGuiIO& io = ImGui::GetIO();
    io.Fonts->Clear();
    // no cursors of ImGui's own
    io.Fonts->Flags |= ImFontAtlasFlags_NoMouseCursors;
    const auto size = static_cast<float>(std::round(text_size * scale));
    Fonts fonts;
    fonts.text = add_font(*io.Fonts, embedded_file("assets/fonts/Roboto-Regular.ttf"), size);
    fonts.strong = add_font(*io.Fonts, embedded_file("assets/fonts/Roboto-Medium.ttf"), size);
    io.FontDefault = fonts.text;
    return fonts;
}

}  // namespace ivory
