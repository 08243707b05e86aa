// measure_edits: how long after an edit its first picture is on the screen, and how long cancelled
// workers go on. In memory, at a real size, with edits that come at any moment of the refinement.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "app/document/orbit.h"
#include "app/panels/panels.h"
#include "app/platform/context.h"
#include "app/viewer/viewer.h"
#include "app/viewer/wake_up.h"
#include "core/render/camera.h"
#include "core/render/canvas.h"
#include "core/render/render.h"
#include "tests/tools/kinds.h"
#include "tests/tools/random_scene.h"
#include "tests/tools/run_tool.h"

namespace {

using namespace ivory;
using Clock = std::chrono::steady_clock;
using Milliseconds = std::chrono::duration<double, std::milli>;

double milliseconds_since(Clock::time_point start) {
    return Milliseconds(Clock::now() - start).count();
}

struct Options {
    std::vector<std::string> scenes;
    int width = 1280, height = 720, edits = 100, threads = 2;
    std::uint64_t seed = 1;
};

// Of times in milliseconds, which are sorted for it.
struct Summary {
    explicit Summary(std::vector<double>& times) {
        std::sort(times.begin(), times.end());
        if (times.empty()) return;
        median = times[times.size() / 2];
        most_of_them = times[times.size() * 95 / 100];
        worst = times.back();
    }
    double median = 0, most_of_them = 0, worst = 0;
};

Vec3d shifted(const Vec3d& p, const Vec3d& by) { return {p.x + by.x, p.y + by.y, p.z + by.z}; }

void move_element(Element& element, const Vec3d& by) {
    Vec3d& place = *tools::Members(element.skeleton).places.back();
    place = shifted(place, by);
}

// A viewer in memory, its loop turned as in a window: a frame for an edit, one whenever the
// renderer has something to show.
class Bench {
  public:
    explicit Bench(const Options& options)
        : options_(options),
          size_{options.width, options.height},
          random_(options.seed),
          context_(open_memory_context(size_)),
          events_(size_),
          viewer_(*context_, settings(options, wake_up_)) {
        viewer_.state().panels_hidden = true;  // the picture is all of the window
        frame();
    }

    void measure(const std::string& file) {
        open_scene(viewer_.state(), file);
        threshold_ = viewer_.state().document.scene().threshold;
        const double opened = edit([] {});
        std::vector<double> edits;
        double worst_of[3] = {};
        for (int i = 0; i < options_.edits; ++i) {
            const int kind = i % 3;
            const double took = edit([&] { change(kind); });
            edits.push_back(took);
            worst_of[kind] = std::max(worst_of[kind], took);
            refine(random_.uniform(0, 80));
        }
        std::vector<double> cancels = time_cancels();
        const Summary edit(edits), cancel(cancels);
        const std::string name = std::filesystem::path(file).filename().string();
        std::printf("%-24s %7.1f %9.1f %7.1f %7.1f %8.1f %7.1f %7.1f %9.1f %7.1f\n", name.c_str(),
                    opened, edit.median, edit.most_of_them, edit.worst, worst_of[0], worst_of[1],
                    worst_of[2], cancel.median, cancel.worst);
        std::fflush(stdout);
    }

    static void print_head() {
        std::printf("%-24s %7s %9s %7s %7s %8s %7s %7s %9s %7s\n", "milliseconds", "opened",
                    "edit: med", "95 %", "worst", "w. move", "thresh.", "orbit", "cancel: m",
                    "worst");
    }

  private:
    static ViewerSettings settings(const Options& options, WakeUp& wake_up) {
        ViewerSettings settings;
        settings.threads = options.threads;
        settings.wake = [&wake_up] { wake_up.wake(); };
        settings.renderer_yields = true;
        return settings;
    }

    void frame() { viewer_.frame(events_.next_frame(1.0 / 60)); }

    void wait(double most) {
        const double wanted = viewer_.next_frame_wanted();
        wake_up_.wait(wanted < 0 ? most : std::min(wanted, most));
        frame();
    }

    // From before the frame that takes the edit to the end of the one that shows its picture.
    double edit(const std::function<void()>& change) {
        change();
        const Clock::time_point start = Clock::now();
        frame();
        while (viewer_.state().picture.scene != viewer_.state().document.scene_value() ||
               viewer_.state().picture.camera != viewer_.state().view.camera)
            wait(0.5);
        return milliseconds_since(start);
    }

    void refine(double milliseconds) {
        const Clock::time_point start = Clock::now();
        while (milliseconds_since(start) < milliseconds)
            wait((milliseconds - milliseconds_since(start)) / 1000);
    }

    void change(int kind) {
        ViewerState& state = viewer_.state();
        if (kind == 2) {
            state.view.camera =
                orbited(state.projection(), random_.uniform(-60, 60), random_.uniform(-20, 20));
            return;
        }
        Scene scene = state.document.scene();
        if (kind == 0) {
            move_element(scene.elements[random_.below(scene.elements.size())],
                         random_.in_cube(0.1));
            state.document.edit("Move", std::move(scene));
        } else {
            scene.threshold = threshold_ * random_.uniform(0.8, 1.25);
            state.document.edit("Threshold", std::move(scene));
        }
    }

    // From the order to stop until all workers have.
    std::vector<double> time_cancels() {
        const Scene scene = viewer_.state().scene_with_view();
        const Picture picture =
            make_picture(scene, size_.width, size_.height, *methods().front(), {.tolerance = 1e-6});
        std::vector<double> times;
        for (int i = 0; i < options_.edits; ++i) {
            Canvas canvas(size_.width, size_.height, false);
            JobSettings job_settings;
            job_settings.threads = options_.threads;
            job_settings.order = Order::from_focus;
            FrameJob job(picture, canvas, job_settings);
            const auto before = std::chrono::duration_cast<std::chrono::milliseconds>(
                Milliseconds(random_.uniform(0, 80)));
            if (job.wait_for(before)) continue;
            const Clock::time_point start = Clock::now();
            job.cancel();
            job.finish();
            times.push_back(milliseconds_since(start));
        }
        return times;
    }

    const Options& options_;
    WindowSize size_;
    tools::Random random_;
    std::unique_ptr<MemoryContext> context_;
    EventQueue events_;
    WakeUp wake_up_;
    Viewer viewer_;
    double threshold_ = 0;  // of the scene as it was opened
};

int run(int argc, char** argv) {
    Options options;
    CLI::App app("Times from an edit to its first picture.", "measure_edits");
    app.add_option("scenes", options.scenes, "scene files")->required();
    app.add_option("--width", options.width, "of the picture");
    app.add_option("--height", options.height, "of the picture");
    app.add_option("--edits", options.edits, "of each scene");
    app.add_option("--threads", options.threads, "of the renderer");
    app.add_option("--seed", options.seed, "same seed, same edits");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    }
    Bench bench(options);
    Bench::print_head();
    for (const std::string& scene : options.scenes) bench.measure(scene);
    return 0;
}

}  // namespace

int main(int argc, char** argv) { return ivory::tools::run_tool("measure_edits", run, argc, argv); }
