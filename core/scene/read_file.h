// The bytes of a file, or of standard input where the path is "-".
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "core/scene/stop.h"

namespace ivory {

// Larger than any file that a person or a program would hand us on purpose; keeps a mistyped
// /dev/zero from filling the memory.
inline constexpr std::size_t largest_file = std::size_t{256} << 20;  // bytes

// What messages call the file: its path on one line, or "standard input" for "-".
[[nodiscard]] std::string file_label(const std::filesystem::path& path);

// Throws Error where the file is missing, a directory, not readable, or larger than `largest_file`.
// Looks at `stop` at least once in `bytes_between_looks`, and where a signal ends a wait for bytes.
[[nodiscard]] std::string read_file(const std::filesystem::path& path, const Stop& stop = {});

}  // namespace ivory
