#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/cli/commands.h"
#include "app/cli/interrupt.h"
#include "app/cli/output.h"
#include "app/cli/progress.h"
#include "core/render/answers_file.h"
#include "core/render/image_file.h"
#include "core/render/render.h"
#include "core/render/statistics.h"
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

// SeenSurfaces at before the work begins: what cannot be written is said at once.
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

// A frame from its scene, with what it took.
struct Rendering {
    Picture picture;
    std::unique_ptr<Canvas> canvas;
    JobReport report;
    Seconds seconds;  // compile, trace, shade and total of this frame
};

// On the canvas of the frame before, where there is one.
Rendering render_once(const Scene& scene, const RenderArguments& arguments, Task task,
                      std::unique_ptr<Canvas> canvas, const std::string& label,
                      Progress& progress) {
    const Clock::time_point start = Clock::now();
    Rendering rendering;
    try {
        rendering.picture =
            make_picture(scene, arguments.width, arguments.height, *arguments.work.method,
                         arguments.work.options, arguments.work.threads);
    } catch (const Error& fault) {
        throw camera_fault(scene, arguments.scene, fault);
    }
    rendering.seconds.compile = seconds_since(start);

    const Clock::time_point compiled = Clock::now();
    rendering.canvas = canvas ? std::move(canvas)
                              : std::make_unique<Canvas>(arguments.width, arguments.height,
                                                         !arguments.answers.empty());
    rendering.canvas->forget();
    JobSettings settings;
    settings.threads = arguments.work.threads;
    settings.task = task;
    FrameJob job(rendering.picture, *rendering.canvas, settings);
    while (!job.wait_for(std::chrono::milliseconds(50))) {
        stop_if_interrupted();  // the job cancels itself on the way out
        progress.show(label + std::to_string(static_cast<int>(100 * job.progress())) + " %");
    }
    rendering.report = job.finish();
    const double worked = seconds_since(compiled);
    rendering.seconds.shade = worked * rendering.report.shade_share;
    rendering.seconds.trace = worked - rendering.seconds.shade;
    rendering.seconds.total = seconds_since(start);
    return rendering;
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
    Rendering rendering;
    for (int run = 1; run <= arguments.repeat; ++run) {
        const std::string label =
            arguments.repeat == 1
                ? ""
                : std::to_string(run) + "/" + std::to_string(arguments.repeat) + ": ";
        stop_if_interrupted();  // a picture may be done before it is looked for again
        rendering =
            render_once(scene, arguments, task, std::move(rendering.canvas), label, progress);
        runs.push_back(rendering.seconds);
    }

    const Clock::time_point rendered = Clock::now();
    if (outputs.picture) outputs.picture->write(png_bytes(rendering.canvas->frame));
    if (outputs.depth) outputs.depth->write(depth_bytes(rendering.canvas->frame));
    if (outputs.answers) write_answers(*outputs.answers, rendering, progress);

    RenderStatistics statistics;
    statistics.width = arguments.width;
    statistics.height = arguments.height;
    statistics.threads = arguments.work.threads;
    statistics.method = arguments.work.method->name();
    statistics.options = arguments.work.options;
    statistics.camera = rendering.picture.view.camera;
    statistics.seconds = medians_of(runs);
    statistics.seconds.load = load_seconds;
    statistics.seconds.write = seconds_since(rendered);
    statistics.seconds.total += load_seconds + statistics.seconds.write;
    statistics.repeats = arguments.repeat;
    statistics.pixels = pixel_statistics(*rendering.canvas);
    statistics.counts = rendering.report.counts;
    statistics.elements = scene.elements.size();
    statistics.visible_elements = rendering.picture.field->size();
    statistics.reached_elements = rendering.report.elements_reached;
    if (outputs.statistics) outputs.statistics->write(statistics_json(statistics));
    outputs.commit();
    progress.leave(summary(statistics));
}

}  // namespace ivory
