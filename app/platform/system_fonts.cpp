#include "app/platform/system_fonts.h"

#include <imgui.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>
#include <system_error>
#include <utility>

namespace ivory {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_files = 80;  // that are looked into
constexpr std::uintmax_t largest_file = 64u << 20;
constexpr int deepest = 5;  // folders in folders

// First what covers much and looks like the panels' own typeface.
constexpr std::string_view favourites[] = {"DejaVuSans.", "NotoSans-Regular", "NotoSansCJK-Regular",
                                           "NotoSans",    "WenQuanYi",        "Droid",
                                           "Arial"};

std::vector<fs::path> folders() {
    std::vector<fs::path> all = {"/usr/share/fonts", "/usr/local/share/fonts",
                                 "/System/Library/Fonts", "/Library/Fonts"};
    if (const char* const home = std::getenv("HOME")) {
        all.push_back(fs::path(home) / ".local/share/fonts");
        all.push_back(fs::path(home) / ".fonts");
    }
    return all;
}

std::size_t rank_of(const fs::path& path) {
    const std::string name = path.filename().string();
    std::size_t rank = 0;
    while (rank < std::size(favourites) && !name.starts_with(favourites[rank])) ++rank;
    // upright and of usual weight before all else
    const bool styled = name.find("Bold") != std::string::npos ||
                        name.find("Italic") != std::string::npos ||
                        name.find("Oblique") != std::string::npos;
    return rank + (styled ? std::size(favourites) + 1 : 0);
}

std::vector<fs::path> font_paths() {
    std::vector<fs::path> paths;
    for (const fs::path& folder : folders()) {
        std::error_code error;
        fs::recursive_directory_iterator at(folder, fs::directory_options::skip_permission_denied,
                                            error);
        while (!error && at != fs::recursive_directory_iterator()) {
            const std::string type = at->path().extension().string();
            if (type == ".ttf" || type == ".otf" || type == ".ttc") paths.push_back(at->path());
            if (at.depth() >= deepest) at.disable_recursion_pending();
            at.increment(error);
        }
    }
    std::sort(paths.begin(), paths.end(), [](const fs::path& a, const fs::path& b) {
        const std::size_t rank_a = rank_of(a), rank_b = rank_of(b);
        return rank_a != rank_b ? rank_a < rank_b : a < b;
    });
    if (paths.size() > most_files) paths.resize(most_files);
    return paths;
}

// ImGui asserts on what does not begin as a font does.
bool begins_as_font(std::string_view bytes) {
    using namespace std::string_view_literals;
    if (bytes.size() < 64) return false;
    for (const std::string_view sign :
         {"\0\1\0\0"sv, "OTTO"sv, "true"sv, "ttcf\0\1\0\0"sv, "ttcf\0\2\0\0"sv})
        if (bytes.starts_with(sign)) return true;
    return false;
}

std::shared_ptr<const std::string> read_font(const fs::path& path) {
    std::error_code error;
    const std::uintmax_t size = fs::file_size(path, error);
    if (error || size > largest_file || !fs::is_regular_file(path, error)) return nullptr;
    std::ifstream file(path, std::ios::binary);
    std::string bytes(static_cast<std::size_t>(size), '\0');
    file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (!file || !begins_as_font(bytes)) return nullptr;
    return std::make_shared<const std::string>(std::move(bytes));
}

// Those of `characters` that the font has.
std::vector<char16_t> drawn_by(const std::string& bytes, std::span<const char16_t> characters) {
    std::vector<ImWchar> ranges;
    for (const char16_t c : characters)
        ranges.insert(ranges.end(), {static_cast<ImWchar>(c), static_cast<ImWchar>(c)});
    ranges.push_back(0);
    ImFontAtlas atlas;
    ImFontConfig config;
    config.FontDataOwnedByAtlas = false;
    // ImGui reads it and no more
    void* const data = const_cast<char*>(bytes.data());
    const ImFont* const font = atlas.AddFontFromMemoryTTF(data, static_cast<int>(bytes.size()), 10,
                                                          &config, ranges.data());
    std::vector<char16_t> drawn;
    if (font == nullptr || !atlas.Build()) return drawn;
    for (const char16_t c : characters)
        if (font->FindGlyphNoFallback(static_cast<ImWchar>(c)) != nullptr) drawn.push_back(c);
    return drawn;
}

}  // namespace

std::vector<FontFile> system_fonts_for(std::span<const char16_t> characters) {
    std::vector<char16_t> missing(characters.begin(), characters.end());
    std::sort(missing.begin(), missing.end());
    std::vector<FontFile> files;
    if (missing.empty()) return files;
    for (const fs::path& path : font_paths()) {
        auto bytes = read_font(path);
        if (!bytes) continue;
        std::vector<char16_t> drawn = drawn_by(*bytes, missing);
        if (drawn.empty()) continue;
        std::vector<char16_t> left;
        std::set_difference(missing.begin(), missing.end(), drawn.begin(), drawn.end(),
                            std::back_inserter(left));
        missing = std::move(left);
        files.push_back({std::move(bytes), std::move(drawn)});
        if (missing.empty()) break;
    }
    return files;
}

}  // namespace ivory
