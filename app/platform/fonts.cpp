#include "app/platform/fonts.h"

#include <imgui.h>

#include <cmath>
#include <cstddef>
#include <string>
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
    config.PixelSnapH =
        true;  // stems fall on whole pixels: the same text looks the same everywhere
    // ImGui reads it and no more
    void* const bytes = const_cast<char*>(file.data());
    return atlas.AddFontFromMemoryTTF(bytes, static_cast<int>(file.size()), size, &config,
                                      glyph_ranges);
}

// Into the font that was added last.
void add_more(ImFontAtlas& atlas, const Fonts& fonts, float size) {
    for (std::size_t i = 0; i < fonts.files->size(); ++i) {
        const std::string& bytes = *(*fonts.files)[i].bytes;
        ImFontConfig config;
        config.FontDataOwnedByAtlas = false;
        config.MergeMode = true;
        config.PixelSnapH = true;
        void* const data = const_cast<char*>(bytes.data());
        atlas.AddFontFromMemoryTTF(data, static_cast<int>(bytes.size()), size, &config,
                                   fonts.ranges[i].data());
    }
}

// Those of `characters` that the typeface does not draw.
std::vector<char16_t> lacking(std::string_view file, std::span<const char16_t> characters) {
    std::vector<char16_t> missing;
    if (characters.empty()) return missing;
    ImFontAtlas atlas;
    const ImFont* const font = add_font(atlas, file, 10);
    atlas.Build();
    for (const char16_t c : characters)
        if (font->FindGlyphNoFallback(static_cast<ImWchar>(c)) == nullptr) missing.push_back(c);
    return missing;
}

}  // namespace

bool Fonts::have(char32_t character) const {
    return character <= 0xFFFF &&
           text->FindGlyphNoFallback(static_cast<ImWchar>(character)) != nullptr;
}

Fonts load_fonts(double scale, std::span<const char16_t> more) {
    ImGuiIO& io = ImGui::GetIO();
    io.Fonts->Clear();
    // no cursors of ImGui's own
    io.Fonts->Flags |= ImFontAtlasFlags_NoMouseCursors;
    const auto size = static_cast<float>(std::round(text_size * scale));
    const std::string_view regular = embedded_file("assets/fonts/Roboto-Regular.ttf");
    const std::string_view medium = embedded_file("assets/fonts/Roboto-Medium.ttf");
    Fonts fonts;
    fonts.files =
        std::make_shared<const std::vector<FontFile>>(system_fonts_for(lacking(regular, more)));
    for (const FontFile& file : *fonts.files) {
        std::vector<unsigned short>& ranges = fonts.ranges.emplace_back();
        for (const char16_t c : file.characters)
            ranges.insert(ranges.end(),
                          {static_cast<unsigned short>(c), static_cast<unsigned short>(c)});
        ranges.push_back(0);
    }
    fonts.text = add_font(*io.Fonts, regular, size);
    add_more(*io.Fonts, fonts, size);
    fonts.strong = add_font(*io.Fonts, medium, size);
    add_more(*io.Fonts, fonts, size);
    io.FontDefault = fonts.text;
    return fonts;
}

}  // namespace ivory
