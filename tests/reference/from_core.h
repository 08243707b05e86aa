// Core's scenes and answers as the reference's own. Names of core's alone: from_core.cpp is the one place that
// knows both, and whoever does without core leaves it out.
#pragma once

#include <cstdint>

#include "tests/reference/claim.h"
#include "tests/reference/scene.h"

namespace ivory {
struct Answer;
struct Element;
struct Scene;
enum class KernelKind : std::uint8_t;
}  // namespace ivory

namespace ivory::reference {

[[nodiscard]] Kernel from_core(KernelKind kind);
[[nodiscard]] Element from_core(const ivory::Element& element);
[[nodiscard]] ReferenceScene from_core(const Scene& scene);
[[nodiscard]] Claim from_core(const Answer& answer);

}  // namespace ivory::reference
