// Core's scenes as the reference's own: the one place that knows both.
#pragma once

#include "core/scene/scene.h"
#include "tests/reference/scene.h"

namespace ivory::reference {

[[nodiscard]] Kernel from_core(KernelKind kind);
[[nodiscard]] Element from_core(const ivory::Element& element);
[[nodiscard]] ReferenceScene from_core(const Scene& scene);

}  // namespace ivory::reference
