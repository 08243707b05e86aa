// What may stand in a scene beyond what its types say: the ranges of the file format, one by one.
// A reader, a writer and an editor ask the same question here.
#pragma once

#include <optional>
#include <string>

#include "core/scene/scene.h"
#include "core/scene/stop.h"

namespace ivory {

struct SceneFault {
    std::string pointer;  // JSON pointer (RFC 6901) of the value, as "/elements/3/radius"
    std::string message;  // "the radius is -1; it must be 0 or more", one line
};

// The first fault in the order of the format's keys, names last; nothing for a scene that may be
// rendered and written. Looks at `stop` at least once in `values_between_looks` elements.
[[nodiscard]] std::optional<SceneFault> find_fault(const Scene& scene, const Stop& stop = {});

// Faults of one part, their pointers relative to it ("/radius"): for an editor that checks what it
// is about to change.
[[nodiscard]] std::optional<SceneFault> find_fault(const Camera& camera);
[[nodiscard]] std::optional<SceneFault> find_fault(const std::vector<SavedView>& views);
[[nodiscard]] std::optional<SceneFault> find_fault(const Light& light);
[[nodiscard]] std::optional<SceneFault> find_fault(const Element& element);

// Whether `up` fixes no horizon: its angle with the line of sight, or with the opposite direction,
// is at most 1e-12. Every exactly parallel pair is found, none whose angle exceeds 1.01e-12.
// Both vectors finite and not 0; of any length.
[[nodiscard]] bool along(const Vec3d& up, const Vec3d& line_of_sight);

}  // namespace ivory
