// The fonts of the system, for names in scripts that the viewer's own typeface lacks.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace ivory {

// A file of fonts and which of the asked characters its first font draws.
struct FontFile {
    std::shared_ptr<const std::string> bytes;
    std::vector<char16_t> characters;  // ascending
};

// For as many of `characters` as any font of the system has: the files to draw them from, each
// character in one of them. Looks through the well-known folders, the same order every time; files
// that are no fonts are passed over. Within an ImGui context.
[[nodiscard]] std::vector<FontFile> system_fonts_for(std::span<const char16_t> characters);

}  // namespace ivory
