#include "app/panels/viewer_state.h"

namespace ivory {

Scene ViewerState::scene_with_view() const {
    Scene scene = document.scene();
    scene.camera = view.camera;
    return scene;
}

}  // namespace ivory
