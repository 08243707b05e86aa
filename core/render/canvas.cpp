#include "core/render/canvas.h"

#include <string>
#include <string_view>

#include "core/render/framing.h"
#include "core/scene/read_file.h"

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

Error camera_fault(const Scene& scene, const std::filesystem::path& file, const Error& fault) {
    std::string_view what = fault.what();
    constexpr std::string_view said_already = "camera: ";
    if (what.starts_with(said_already)) what.remove_prefix(said_already.size());
    return Error(file_label(file) + ": " + (scene.camera ? "/camera" : "/elements") + ": " +
                 std::string(what));
}

}  // namespace ivory
