#include "core/render/canvas.h"

namespace ivory {

Picture make_picture(const Scene& scene, int width, int height, const Method& method,
                     const MethodOptions& options, int threads) {
    Picture picture;
    picture.field = std::make_shared<const Field>(compile(scene, threads));
    picture.view = make_view(camera_of(scene, *picture.field, width, height));
    picture.lighting = make_lighting(scene, picture.view);
    picture.method = &method;
    picture.options = options;
    return picture;
}

}  // namespace ivory
