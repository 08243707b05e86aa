// A box around the surface of a scene that is being edited, quick to follow.
#pragma once

#include <memory>

#include "core/math/box3.h"
#include "core/scene/scene.h"

namespace ivory {

class SurfaceBounds {
  public:
    using SceneValue = std::shared_ptr<const Scene>;  // never null

    // Proved to hold the surface of the scene; empty: it has none. As tight as the compiled field says
    // or, where a few elements are other than in the scene that was asked about before, larger by what
    // these reach: to compile a scene of 100,000 elements takes too long for every frame of a drag.
    [[nodiscard]] const Box3& around(const SceneValue& scene);
    // The same; null where the scene would have to be compiled.
    [[nodiscard]] const Box3* quickly_around(const SceneValue& scene);

  private:
    SceneValue scene_;  // null: nothing has been asked yet
    Box3 box_;          // around its surface
    Box3 reach_;        // around all that its elements reach, each alone
};

}  // namespace ivory
