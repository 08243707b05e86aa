// From an edit to its picture, kind by kind, as CSV on standard output: the viewer's own session,
// which decides what an edit leaves valid, without a window to draw in.
//
// Each kind of edit is made and taken back, over and over, from a final picture each time. first:
// until a picture of the edited scene is complete, of every pixel or fewer; final: until the session says
// that no byte of it will change, at one sample a pixel. Medians, in milliseconds.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <semaphore>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "app/viewer/render_session.h"
#include "core/render/canvas.h"
#include "core/render/render.h"
#include "core/scene/error.h"
#include "core/scene/scene_json.h"
#include "tests/tools/move_element.h"

namespace ivory {
namespace {

using Clock = std::chrono::steady_clock;

struct Options {
    std::string scene, name, only;
    int width = 1920, height = 1080, threads = 1, repeats = 7;
};

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

// The first of the elements that are seen best: those whose skeletons are nearest to the camera.
std::size_t nearest_element(const Scene& scene, const Vec3d& camera) {
    std::size_t nearest = 0;
    double least = infinity<double>;
    for (std::size_t i = 0; i < scene.elements.size(); ++i) {
        const Skeleton& skeleton = scene.elements[i].skeleton;
        const auto* point = std::get_if<PointSkeleton>(&skeleton);
        const auto* segment = std::get_if<SegmentSkeleton>(&skeleton);
        const auto* circle = std::get_if<CircleSkeleton>(&skeleton);
        const Vec3d at = point != nullptr     ? point->position
                         : segment != nullptr ? segment->a
                                              : circle->center;
        const Vec3d to = at - camera;
        if (dot(to, to) >= least) continue;
        least = dot(to, to);
        nearest = i;
    }
    return nearest;
}

struct Edit {
    const char* name;
    std::function<void(Scene&, Camera&)> make;
};

std::vector<Edit> edits_of(const Scene& scene, const Camera& camera, int height) {
    const std::size_t element = nearest_element(scene, camera.position);
    const Vec3d view = camera.target - camera.position;
    const double pixel =
        2 * std::tan(camera.fov * 3.14159265358979 / 360) * std::sqrt(dot(view, view)) / height;
    return {{"colour",
             [=](Scene& s, Camera&) {
                 s.elements[element].color = {0.1, 0.9, 0.3};
             }},
            {"light",
             [](Scene& s, Camera&) {
                 s.lights = {Light{{1, 2, 3}, {1, 1, 1}, 0.9, true}};
             }},
            {"background",
             [](Scene& s, Camera&) {
                 s.background = {0.3, 0.2, 0.1};
             }},
            {"moved by 5 pixels",
             [=](Scene& s, Camera&) {
                 tools::move(s.elements[element], {5 * pixel, 0, 0});
             }},
            {"width", [=](Scene& s, Camera&) { s.elements[element].width *= 1.05; }},
            {"hidden", [=](Scene& s, Camera&) { s.elements[element].visible = false; }},
            {"threshold", [](Scene& s, Camera&) { s.threshold *= 1.02; }},
            {"camera", [=](Scene&, Camera& c) {
                 c.position = c.position + Vec3d{20 * pixel, 0, 0};
             }}};
}

struct Latency {
    double first, final;
    std::uint64_t tiles_traced;
};

// Of the picture of that scene, which is not the one shown. As a window does, it polls when there
// is something to be seen.
Latency show(RenderSession& session, std::counting_semaphore<>& woken, const Scene& scene,
             const Camera& camera, const Options& options) {
    const std::uint64_t traced = session.totals().tiles_traced;
    const Clock::time_point now = Clock::now();
    session.show({std::make_shared<const Scene>(scene),
                  camera,
                  {options.width, options.height},
                  {},
                  now,
                  now + std::chrono::milliseconds(33)});
    do {
        woken.acquire();
        session.poll();
        session.stays();
        if (!session.state().fault.empty()) throw Error(session.state().fault);
    } while (!session.state().final);
    return {session.state().first_milliseconds, session.state().milliseconds,
            session.totals().tiles_traced - traced};
}

void measure(const Options& options) {
    const Scene scene = read_scene(options.scene);
    if (scene.elements.empty()) throw Error("a scene without elements has nothing to edit");
    RenderSession::Settings settings;
    settings.threads = options.threads;
    std::counting_semaphore<> woken{0};
    settings.wake = [&] { woken.release(); };
    RenderSession session(settings);
    const Picture picture =
        make_picture(scene, options.width, options.height, *find_method("proved"), {});
    const Camera camera = picture.view.camera;
    show(session, woken, scene, camera, options);

    std::printf("scene,edit,width,height,threads,first_ms,final_ms,tiles_traced\n");
    for (const Edit& edit : edits_of(scene, camera, options.height)) {
        if (!options.only.empty() && options.only != edit.name) continue;
        std::vector<double> first, final;
        std::uint64_t tiles = 0;
        for (int repeat = 0; repeat < options.repeats; ++repeat) {
            Scene edited = scene;
            Camera moved = camera;
            edit.make(edited, moved);
            const Latency latency = show(session, woken, edited, moved, options);
            first.push_back(latency.first);
            final.push_back(latency.final);
            tiles = latency.tiles_traced;
            show(session, woken, scene, camera, options);
        }
        std::printf("%s,%s,%d,%d,%d,%.3f,%.3f,%llu\n", options.name.c_str(), edit.name,
                    options.width, options.height, options.threads, median(first), median(final),
                    static_cast<unsigned long long>(tiles));
        std::fflush(stdout);
    }
}

}  // namespace
}  // namespace ivory

int main(int argc, char** argv) {
    ivory::Options options;
    CLI::App app{"From an edit to its picture, kind by kind."};
    app.add_option("scene", options.scene, "scene file")->required();
    app.add_option("--name", options.name, "of the scene, in the table")->required();
    app.add_option("--only", options.only, "this kind of edit alone");
    app.add_option("--width", options.width)->check(CLI::Range(1, 16384));
    app.add_option("--height", options.height)->check(CLI::Range(1, 16384));
    app.add_option("--threads", options.threads)->check(CLI::Range(1, 1024));
    app.add_option("--repeats", options.repeats)->check(CLI::Range(1, 1000));
    CLI11_PARSE(app, argc, argv);
    try {
        ivory::measure(options);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "edit_latency: %s\n", error.what());
        return 1;
    }
    return 0;
}
