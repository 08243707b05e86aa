#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "app/cli/commands.h"
#include "app/cli/interrupt.h"
#include "app/cli/output.h"
#include "app/cli/progress.h"
#include "core/render/answers_file.h"
#include "core/render/image_file.h"
#include "core/render/render.h"
#include "core/render/statistics.h"
#include "core/render/stereo.h"
#include "core/scene/error.h"
#include "core/scene/scene_json.h"
#include "core/scene/text.h"

namespace ivory {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const std::size_t half = values.size() / 2;
    return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

// Looked at before the work begins: what cannot be written is said at once.
struct Outputs {
    std::optional<Output> picture, depth, answers, statistics;

    explicit Outputs(const RenderArguments& arguments) {
        open(picture, arguments.picture);
        open(depth, arguments.depth);
        open(answers, arguments.answers);
        open(statistics, arguments.statistics);
    }

    void commit() {
        for (std::optional<Output>* output : {&picture, &depth, &answers, &statistics}) {
            if (*output) (*output)->commit();
        }
    }

  private:
    static void open(std::optional<Output>& output, const std::string& target) {
        if (!target.empty()) output.emplace(target);
    }
};

// One eye's picture, or the only one's.
struct Rendering {
    Picture picture;
    // Of samples all of which are traced, the larger picture's.
    std::unique_ptr<Canvas> canvas;
    std::unique_ptr<SampledPicture> sampled;  // of several samples a pixel
    std::unique_ptr<GrowingPng> png;          // packed while it is painted: see `grows_png`
    JobReport report;

    [[nodiscard]] const Rgba8* color() const {
        return sampled ? &sampled->color[0] : &canvas->frame.color[0];
    }
    [[nodiscard]] std::vector<double> depth() const {
        if (!sampled) return depth_of(canvas->frame);
        return {&sampled->depth[0], &sampled->depth[0] + sampled->depth.size()};
    }
};

// A picture from its scene, of one eye or two, with what it took.
struct Run {
    std::vector<Rendering> eyes;
    // compile, trace, shade and their total; write: what was packed meanwhile
    Seconds seconds;
};

// What --answers writes is of the larger picture: all of it is traced.
bool traces_larger(const RenderArguments& arguments) {
    return arguments.samples_a_side > 1 && !arguments.answers.empty();
}

// What is painted is what is written.
bool grows_png(const RenderArguments& arguments) {
    return !arguments.picture.empty() && arguments.stereo == Stereo::none &&
           !traces_larger(arguments);
}

// On the canvases of the rendering before, where there are any. `last`: its picture is written.
void render_eye(Rendering& eye, const RenderArguments& arguments, Task task, bool last,
                const std::string& label, Progress& progress) {
    const int times = traces_larger(arguments) ? arguments.samples_a_side : 1;
    if (!eye.canvas) {
        eye.canvas = std::make_unique<Canvas>(arguments.width * times, arguments.height * times,
                                              !arguments.answers.empty());
    }
    eye.canvas->forget();
    JobSettings settings;
    settings.threads = arguments.work.threads;
    settings.task = task;
    if (arguments.samples_a_side > 1 && times == 1) {
        if (!eye.sampled) {
            eye.sampled = std::make_unique<SampledPicture>(*eye.canvas, arguments.samples_a_side,
                                                           !arguments.depth.empty());
        }
        settings.task = Task::sample;
        settings.sampled = eye.sampled.get();
    }
    if (last && grows_png(arguments)) {
        eye.png = std::make_unique<GrowingPng>(
            PictureBytes{arguments.width, arguments.height, eye.color()});
        settings.on_tile = [png = eye.png.get()](const TileNotice& notice) {
            png->painted(notice.rect);
        };
    }
    FrameJob job(eye.picture, *eye.canvas, settings);
    // One thread works here itself, and a tile may take long.
    std::optional<InterruptBell> bell;
    try {
        bell.emplace([&job] { job.cancel(); });
    } catch (const std::system_error&) {
        // then a signal is seen between tiles
    }
    while (!job.wait_for(std::chrono::milliseconds(50))) {
        stop_if_interrupted();  // the job cancels itself on the way out
        progress.show(label + std::to_string(static_cast<int>(100 * job.progress())) + " %");
    }
    eye.report = job.finish();
    if (!eye.report.complete) stop_if_interrupted();
    if (times > 1) {
        eye.sampled = std::make_unique<SampledPicture>(
            mean_of(eye.picture, *eye.canvas, arguments.samples_a_side));
    }
}

Run render_once(const Scene& scene, const RenderArguments& arguments, Task task, bool last,
                std::vector<Rendering> eyes, const std::string& label, Progress& progress) {
    const Clock::time_point start = Clock::now();
    Run run{std::move(eyes), {}};
    run.eyes.resize(arguments.stereo == Stereo::none ? 1 : 2);
    try {
        const Picture picture =
            make_picture(scene, arguments.width, arguments.height, *arguments.work.method,
                         arguments.work.options, arguments.work.threads);
        for (Rendering& eye : run.eyes) eye.picture = picture;
        if (arguments.stereo != Stereo::none) {
            const double apart = arguments.eyes.value_or(usual_eye_distance(picture.view.camera));
            run.eyes[0].picture.view = eye_of(picture.view, Eye::left, apart);
            run.eyes[1].picture.view = eye_of(picture.view, Eye::right, apart);
        }
    } catch (const Error& fault) {
        throw camera_fault(scene, arguments.scene, fault);
    }
    run.seconds.compile = seconds_since(start);

    for (std::size_t k = 0; k < run.eyes.size(); ++k) {
        const Clock::time_point compiled = Clock::now();
        const std::string eye_label =
            run.eyes.size() == 1 ? label : label + (k == 0 ? "left eye: " : "right eye: ");
        render_eye(run.eyes[k], arguments, task, last, eye_label, progress);
        const double worked = seconds_since(compiled);
        const double shading = worked * run.eyes[k].report.shade_share;
        const double packing =
            run.eyes[k].png ? run.eyes[k].png->seconds() / arguments.work.threads : 0;
        run.seconds.shade += shading;
        run.seconds.trace += std::max(worked - shading - packing, 0.0);
        run.seconds.write += packing;
    }
    run.seconds.total = seconds_since(start) - run.seconds.write;
    return run;
}

std::string picture_bytes(const Run& run, const RenderArguments& arguments) {
    if (run.eyes[0].png) return run.eyes[0].png->bytes();
    const int width = arguments.width, height = arguments.height;
    const Rgba8* const left = run.eyes[0].color();
    switch (arguments.stereo) {
        case Stereo::none:
            return png_bytes(PictureBytes{width, height, left});
        case Stereo::side_by_side:
            return png_bytes(PictureBytes{
                2 * width, height, side_by_side(left, run.eyes[1].color(), width, height).data()});
        case Stereo::red_cyan:
            return png_bytes(PictureBytes{
                width, height, red_cyan(left, run.eyes[1].color(), width, height).data()});
    }
    return {};
}

// Of two eyes side by side.
std::string depth_file(const Run& run, const RenderArguments& arguments) {
    const auto width = static_cast<std::size_t>(arguments.width),
               height = static_cast<std::size_t>(arguments.height);
    std::vector<double> all(run.eyes.size() * width * height);
    for (std::size_t k = 0; k < run.eyes.size(); ++k) {
        const std::vector<double> depth = run.eyes[k].depth();
        for (std::size_t j = 0; j < height; ++j) {
            std::copy_n(&depth[j * width], width, &all[(j * run.eyes.size() + k) * width]);
        }
    }
    return depth_bytes(static_cast<int>(run.eyes.size() * width), arguments.height, all.data());
}

Seconds medians_of(const std::vector<Seconds>& runs) {
    const auto of = [&](double Seconds::*part) {
        std::vector<double> values;
        for (const Seconds& run : runs) values.push_back(run.*part);
        return median(std::move(values));
    };
    Seconds medians;
    medians.compile = of(&Seconds::compile);
    medians.trace = of(&Seconds::trace);
    medians.shade = of(&Seconds::shade);
    medians.total = of(&Seconds::total);
    return medians;
}

void write_answers(Output& output, const Rendering& rendering, Progress& progress) {
    constexpr std::size_t piece = std::size_t{1} << 20;
    const Frame& frame = rendering.canvas->frame;
    std::string text;
    for (int j = 0; j < frame.height; ++j) {
        append_row(text, rendering.picture, frame, j);
        if (text.size() < piece && j + 1 < frame.height) continue;
        output.write(text);
        text.clear();
        progress.show("answers " + std::to_string(100L * j / frame.height) + " %");
    }
}

std::string summary(const RenderStatistics& statistics) {
    const auto count = [&](Status status) {
        return std::to_string(statistics.pixels.pixels[static_cast<std::size_t>(status)]);
    };
    char seconds[32];
    std::snprintf(seconds, sizeof seconds, "%.3f s", statistics.seconds.total);
    std::string line = std::to_string(statistics.width) + "x" + std::to_string(statistics.height) +
                       " in " + seconds;
    for (const Status status : {Status::hit, Status::miss, Status::unresolved, Status::claimed_hit,
                                Status::claimed_miss}) {
        if (count(status) != "0")
            line += ", " + count(status) + " " + std::string(status_word(status));
    }
    return line;
}

}  // namespace

void run(const RenderArguments& arguments) {
    const Clock::time_point start = Clock::now();
    const Scene scene = read_scene(arguments.scene, stop_if_interrupted);
    const double load_seconds = seconds_since(start);
    stop_if_interrupted();
    Outputs outputs(arguments);
    Progress progress(arguments.work.quiet);

    // Where only depth or answers are asked for, nothing is shaded.
    const bool shaded = outputs.picture || !(outputs.depth || outputs.answers);
    const Task task = shaded ? Task::trace_and_shade : Task::trace;
    std::vector<Seconds> runs;
    Run run;
    for (int number = 1; number <= arguments.repeat; ++number) {
        const std::string label =
            arguments.repeat == 1
                ? ""
                : std::to_string(number) + "/" + std::to_string(arguments.repeat) + ": ";
        stop_if_interrupted();  // a picture may be done before it is looked for again
        run = render_once(scene, arguments, task, number == arguments.repeat, std::move(run.eyes),
                          label, progress);
        runs.push_back(run.seconds);
    }

    const Clock::time_point rendered = Clock::now();
    if (outputs.picture) outputs.picture->write(picture_bytes(run, arguments));
    if (outputs.depth) outputs.depth->write(depth_file(run, arguments));
    if (outputs.answers) {
        for (const Rendering& eye : run.eyes) write_answers(*outputs.answers, eye, progress);
    }

    RenderStatistics statistics;
    statistics.width = arguments.width;
    statistics.height = arguments.height;
    statistics.threads = arguments.work.threads;
    statistics.method = arguments.work.method->name();
    statistics.options = arguments.work.options;
    statistics.camera = run.eyes[0].picture.view.camera;
    statistics.samples = arguments.samples_a_side * arguments.samples_a_side;
    statistics.seconds = medians_of(runs);
    statistics.seconds.load = load_seconds;
    statistics.seconds.write = run.seconds.write + seconds_since(rendered);
    statistics.seconds.total += load_seconds + statistics.seconds.write;
    statistics.repeats = arguments.repeat;
    statistics.elements = scene.elements.size();
    statistics.visible_elements = run.eyes[0].picture.field->size();
    for (const Rendering& eye : run.eyes) {
        statistics.pixels += eye.sampled ? pixel_statistics(*eye.canvas, *eye.sampled)
                                         : pixel_statistics(*eye.canvas);
        statistics.counts += eye.report.counts;
        statistics.reached_elements =
            std::max(statistics.reached_elements, eye.report.elements_reached);
    }
    if (outputs.statistics) outputs.statistics->write(statistics_json(statistics));
    outputs.commit();
    progress.leave(summary(statistics));
}

}  // namespace ivory
