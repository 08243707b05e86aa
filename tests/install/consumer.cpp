// Uses the installed library from reading a scene to the bytes of a picture.
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>

#include "core/field/field.h"
#include "core/render/camera.h"
#include "core/render/image_file.h"
#include "core/render/render.h"
#include "core/render/shade.h"
#include "core/scene/scene_json.h"
#include "core/trace/methods/method.h"
#include "core/trace/trace.h"

namespace {

// A sphere: exp(-r^2) = 0.5 at r^2 = ln 2.
constexpr const char* sphere = R"({
    "ivory": 1, "threshold": 0.5,
    "elements": [{"shape": "point", "position": [0, 0, 0]}]
})";

int fail(const char* what) {
    std::fprintf(stderr, "consumer: %s\n", what);
    return 1;
}

}  // namespace

int main() {
    const ivory::Scene scene = ivory::parse_scene(sphere, "sphere");
    const auto field = std::make_shared<const ivory::Field>(ivory::compile(scene));
    const ivory::Method* const proved = ivory::find_method("proved");
    if (proved == nullptr) return fail("no method `proved`");

    ivory::Counts counts;
    const ivory::Answer answer =
        ivory::trace(*field, ivory::all_elements(*field), {{0, 0, 4}, {0, 0, -1}}, *proved,
                     {.tolerance = 1e-12}, counts);
    const ivory::Interval<double> t = answer.isolation.t;
    if (answer.isolation.status != ivory::Status::hit) return fail("the ray is no hit");
    if (std::abs(t.lo + (t.hi - t.lo) / 2 - (4 - std::sqrt(std::log(2.0)))) > 1e-11)
        return fail("the hit is in the wrong place");

    constexpr int size = 64;
    ivory::Canvas canvas(size, size, false);
    ivory::render(ivory::make_picture(scene, size, size, *proved, {}), canvas, {});
    if (canvas.frame.status[canvas.frame.at(size / 2, size / 2)] != ivory::Status::hit)
        return fail("the picture is empty");
    if (!ivory::png_bytes(canvas.frame).starts_with("\x89PNG")) return fail("this is no PNG");
    return 0;
}
