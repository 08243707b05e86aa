// Scene files: JSON in, a checked Scene out, and back again to the last bit.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/scene/error.h"
#include "core/scene/scene.h"
#include "core/scene/stop.h"

namespace ivory {

// The scene in the file, or on standard input where the path is "-". Throws Error, one line: file,
// JSON pointer with line and column, what is wrong, what would be right. Looks at `stop` at least
// once in a megabyte and once in `values_between_looks` (core/scene/stop.h).
[[nodiscard]] Scene read_scene(const std::filesystem::path& path, const Stop& stop = {});

// The same for a text in memory; `name` stands for the file in messages.
[[nodiscard]] Scene parse_scene(std::string_view text, const std::string& name,
                                const Stop& stop = {});

// A text that parse_scene reads back to the same scene, bit for bit: one line per element, light
// and top-level key, a newline at the end. Kernel, strength, width and visible are left out where
// they are the default, camera, lights and names where the scene has none. Throws Error where
// `find_fault` (core/scene/scene_fault.h) finds one, for that text could not be read again.
[[nodiscard]] std::string write_scene(const Scene& scene);

// A camera alone, as it stands in a scene: the object on one line, and back again bit for bit.
// Throw Error as parse_scene and write_scene do.
[[nodiscard]] Camera parse_camera(std::string_view text, const std::string& name);
[[nodiscard]] std::string write_camera(const Camera& camera);

// Writes the file as core/scene/write_file.h does: whole, or not at all. Throws Error.
void save_scene(const Scene& scene, const std::filesystem::path& path);

}  // namespace ivory
