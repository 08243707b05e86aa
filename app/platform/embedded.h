// Shaders and typefaces, built into the executable (app/platform/embed_files.cmake).
#pragma once

#include <string_view>

namespace ivory {

// The bytes of a file, by its path from the repository's root ("shaders/frame.vert"); a zero byte
// follows them. The file has to be in the list of app/CMakeLists.txt: throws std::logic_error otherwise.
[[nodiscard]] std::string_view embedded_file(std::string_view path);

}  // namespace ivory
