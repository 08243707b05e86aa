// Run time against error: every method at every tolerance on one scene, as CSV on standard output.
//
// What is timed is what `ivory render` times: compile, trace and shade in memory, all structures
// built anew. The methods are interleaved, round after round, so that a busy machine hits all alike;
// the median counts, with the least beside it. What is compared with the reference is the answer of
// the very same picture, traced once more with its surface kept.
//
// The reference is `proved` at 1e-12, half of which is the least error of t that can be told; its
// answers on a seeded sample of the pixels are checked here by the tests' own reference of 256 bits.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <ctime>
#include <memory>
#include <mutex>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/field/surface.h"
#include "core/render/render.h"
#include "core/scene/error.h"
#include "core/scene/scene_json.h"
#include "tests/reference/verdict.h"

namespace ivory {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

// Of all threads of the process: what other processes do does not count.
double processor_seconds() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

struct Options {
    std::string scene;
    std::string name;
    std::vector<std::string> methods;
    std::vector<double> tolerances;
    std::vector<double> deltas;
    int width = 480, height = 270, threads = 1, repeats = 3;
    int sample = 48;
    double limit = 10;  // seconds for one picture
};

Picture picture_of(const Scene& scene, const Options& options, const Method* method,
                   double tolerance) {
    return make_picture(scene, options.width, options.height, *method, {.tolerance = tolerance});
}

// A picture within the limit of time; its report is not complete where it was stopped.
JobReport paint(const Picture& picture, Canvas& canvas, const Options& options, bool keep_lists) {
    JobSettings settings;
    settings.threads = options.threads;
    settings.keep_lists = keep_lists;
    FrameJob job(picture, canvas, settings);
    const auto limit = std::chrono::milliseconds(static_cast<long>(1000 * options.limit));
    // Where the job has no threads it works within wait_for, which looks at the time between tiles alone.
    std::jthread clock([&](const std::stop_token& done) {
        std::mutex mutex;
        std::unique_lock lock(mutex);
        std::condition_variable_any bell;
        bell.wait_for(lock, done, limit, [] { return false; });
        if (!done.stop_requested()) job.cancel();
    });
    if (!job.wait_for(limit)) job.cancel();
    clock.request_stop();
    clock.join();
    return job.finish();
}

struct Run {
    const Method* method = nullptr;
    double tolerance = 0;
    bool stopped = false;  // by the limit of time
    std::vector<double> seconds{}, processor{};
    Counts counts{};
};

void time_once(const Scene& scene, const Options& options, Run& run) {
    const double processor = processor_seconds();
    const Clock::time_point start = Clock::now();
    const Picture picture = picture_of(scene, options, run.method, run.tolerance);
    Canvas canvas(options.width, options.height, false);
    const JobReport report = paint(picture, canvas, options, false);
    run.seconds.push_back(seconds_since(start));
    run.processor.push_back(processor_seconds() - processor);
    run.counts = report.counts;
    run.stopped = !report.complete;
}

double median(std::vector<double> values) {
    if (values.empty()) return 0;
    std::sort(values.begin(), values.end());
    const std::size_t half = values.size() / 2;
    return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

double least(const std::vector<double>& values) {
    return values.empty() ? 0 : *std::min_element(values.begin(), values.end());
}

struct Worst {
    double greatest = 0, squares = 0;
    std::size_t count = 0;
    void add(double error) {
        greatest = std::max(greatest, error);
        squares += error * error;
        ++count;
    }
    double rms() const { return count > 0 ? std::sqrt(squares / static_cast<double>(count)) : 0; }
};

struct Errors {
    std::size_t hits = 0, wrong = 0, unresolved = 0, claimed = 0;
    Worst t, normal, color;  // scene units, radians, linear RGB
};

double angle(const Vec3d& a, const Vec3d& b) {
    const Vec3d c = cross(a, b);
    return std::atan2(std::sqrt(dot(c, c)), dot(a, b));
}

double greatest_difference(const Color& a, const Color& b) {
    return std::max(std::abs(a.x - b.x), std::max(std::abs(a.y - b.y), std::abs(a.z - b.z)));
}

Errors compare(const Frame& frame, const Frame& reference) {
    Errors errors;
    for (std::size_t p = 0; p < frame.size(); ++p) {
        const Status status = frame.status[p], truth = reference.status[p];
        errors.unresolved += status == Status::unresolved;
        errors.claimed += status == Status::claimed_hit || status == Status::claimed_miss;
        if (truth == Status::unresolved) continue;
        errors.hits += truth == Status::hit;
        if (status == Status::unresolved) continue;
        const bool is_hit = truth == Status::hit;
        if (possibly_hit(status) != is_hit) {
            ++errors.wrong;
            continue;
        }
        if (!is_hit) continue;
        // Primary rays have length 1.
        errors.t.add(std::abs(midpoint(frame.t(p)) - midpoint(reference.t(p))));
        errors.normal.add(angle(frame.surface[p].normal, reference.surface[p].normal));
        errors.color.add(greatest_difference(frame.surface[p].color, reference.surface[p].color));
    }
    return errors;
}

void print_header() {
    std::puts(
        "scene,width,height,threads,method,tolerance,delta,seconds,seconds_least,"
        "processor_seconds,repeats,complete,evaluations,element_evaluations,pixels,hits,wrong,"
        "unresolved,claimed,t_max,t_rms,normal_max,normal_rms,color_max,color_rms,least_width");
}

void print_row(const Options& options, const char* method, double tolerance, double delta,
               const Run& run, const Errors& errors, double least_width) {
    std::printf(
        "%s,%d,%d,%d,%s,%.3g,%.3g,%.6g,%.6g,%.6g,%zu,%d,%llu,%llu,%d,%zu,%zu,%zu,%zu,%.4g,%.4g,"
        "%.4g,%.4g,%.4g,%.4g,%.6g\n",
        options.name.c_str(), options.width, options.height, options.threads, method, tolerance,
        delta, median(run.seconds), least(run.seconds), median(run.processor), run.seconds.size(),
        run.stopped ? 0 : 1, static_cast<unsigned long long>(run.counts.evaluations),
        static_cast<unsigned long long>(run.counts.element_evaluations),
        options.width * options.height, errors.hits, errors.wrong, errors.unresolved,
        errors.claimed, errors.t.greatest, errors.t.rms(), errors.normal.greatest,
        errors.normal.rms(), errors.color.greatest, errors.color.rms(), least_width);
    std::fflush(stdout);
}

// The reference against 256 bits on some pixels that are not proved misses by their tile.
void check_reference(const Scene& scene, const Picture& picture, const Frame& frame,
                     const Options& options) {
    const reference::ReferenceField exact(scene);
    std::mt19937_64 bits(20260);
    double worst_t = 0, worst_normal = 0, worst_color = 0;
    int faults = 0, undecided = 0;
    for (int n = 0; n < options.sample; ++n) {
        // Every other one is a hit, where there are any.
        std::size_t p = bits() % frame.size();
        for (int tries = 0; n % 2 == 0 && tries < 1000; ++tries) {
            if (frame.status[p] == Status::hit) break;
            p = bits() % frame.size();
        }
        const int i = static_cast<int>(p) % frame.width, j = static_cast<int>(p) / frame.width;
        const Ray ray = primary_ray(picture.view, frame.width, frame.height, i, j);
        Answer answer{{frame.status[p], Interval<double>::empty_set()}, {}};
        if (possibly_hit(frame.status[p])) {
            answer = {{frame.status[p], frame.t(p)}, frame.surface[p]};
        }
        const reference::Verdict verdict = check(exact, ray, picture.options.tolerance, answer);
        faults += verdict.fault != reference::Fault::none;
        undecided += verdict.undecided;
        worst_t = std::fmax(worst_t, verdict.root_error);
        worst_normal = std::fmax(worst_normal, verdict.normal_error);
        worst_color = std::fmax(worst_color, verdict.color_error);
    }
    std::fprintf(
        stderr,
        "%s: the reference on %d pixels against 256 bits: %d faults, %d undecided, greatest "
        "error of t %.1e, normal %.1e, colour %.1e\n",
        options.name.c_str(), options.sample, faults, undecided, worst_t, worst_normal,
        worst_color);
    if (faults > 0) throw Error("the reference is wrong: nothing can be compared with it");
}

// The normal by central differences at the reference's own points: what delta alone does.
void sweep_differences(const Picture& picture, const Canvas& canvas, const Options& options) {
    const Method& bisection = *find_method("bisection");
    const ElementList list = all_elements(*picture.field);
    const Frame& frame = canvas.frame;
    for (const double delta : options.deltas) {
        Errors errors;
        Run run;
        run.method = &bisection;
        const MethodOptions method_options{.tolerance = picture.options.tolerance,
                                           .difference_delta = delta};
        const Clock::time_point start = Clock::now();
        const double processor = processor_seconds();
        // Every seventh pixel is enough, and keeps many elements affordable.
        for (std::size_t p = 0; p < frame.size(); p += 7) {
            if (frame.status[p] != Status::hit) continue;
            ++errors.hits;
            const int i = static_cast<int>(p) % frame.width, j = static_cast<int>(p) / frame.width;
            const SurfacePoint point = bisection.surface(
                *picture.field, list, primary_ray(picture.view, frame.width, frame.height, i, j),
                midpoint(frame.t(p)), method_options);
            errors.normal.add(angle(point.normal, frame.surface[p].normal));
            errors.color.add(greatest_difference(point.color, frame.surface[p].color));
        }
        run.seconds.push_back(seconds_since(start));
        run.processor.push_back(processor_seconds() - processor);
        print_row(options, "central differences", picture.options.tolerance, delta, run, errors,
                  picture.field->least_width);
    }
}

// "Field, gradient, colour, light once" at every pixel that is hit, in the same SIMD as the picture:
// what is left of the work when every t is known.
void look_once(const Picture& picture, const Options& options) {
    Canvas canvas(options.width, options.height, false);
    paint(picture, canvas, options, true);
    Run run;
    for (int repeat = 0; repeat < options.repeats; ++repeat) {
        const Clock::time_point start = Clock::now();
        const double processor = processor_seconds();
        JobSettings settings;
        settings.threads = options.threads;
        settings.task = Task::shade;
        settings.keep_lists = true;
        render(picture, canvas, settings);
        run.seconds.push_back(seconds_since(start));
        run.processor.push_back(processor_seconds() - processor);
    }
    print_row(options, "one look", 0, 0, run, {}, picture.field->least_width);
}

void measure(const Options& options) {
    const Scene scene = read_scene(options.scene);
    std::vector<Run> runs;
    for (const std::string& name : options.methods) {
        const Method* method = find_method(name);
        if (method == nullptr) throw Error("no method " + name);
        for (const double tolerance : options.tolerances) runs.push_back({method, tolerance});
    }

    // The reference, with all the time it takes.
    Options patient = options;
    patient.limit = 600;
    const Picture truth = picture_of(scene, options, find_method("proved"), 1e-12);
    Canvas reference(options.width, options.height, true);
    if (!paint(truth, reference, patient, true).complete)
        throw Error("the reference takes too long");
    check_reference(scene, truth, reference.frame, options);

    print_header();
    look_once(truth, options);
    for (int repeat = 0; repeat < options.repeats; ++repeat) {
        for (Run& run : runs) {
            if (!run.stopped) time_once(scene, options, run);
        }
    }
    for (const Run& run : runs) {
        Errors errors;
        const Picture picture = picture_of(scene, options, run.method, run.tolerance);
        if (!run.stopped) {
            Canvas canvas(options.width, options.height, true);
            if (paint(picture, canvas, patient, false).complete) {
                errors = compare(canvas.frame, reference.frame);
            }
        }
        print_row(options, std::string(run.method->name()).c_str(), run.tolerance,
                  run.method->name() == "bisection" ? picture.options.difference_delta : 0, run,
                  errors, picture.field->least_width);
    }
    sweep_differences(truth, reference, options);
}

}  // namespace
}  // namespace ivory

int main(int argc, char** argv) {
    ivory::Options options;
    CLI::App app("Run time against error of every method on one scene; CSV on standard output");
    app.add_option("scene", options.scene, "scene file")->required();
    app.add_option("--name", options.name, "of the scene in the table");
    app.add_option("--methods", options.methods)->delimiter(',');
    app.add_option("--tolerances", options.tolerances)->delimiter(',');
    app.add_option("--deltas", options.deltas, "of central differences, in least widths")
        ->delimiter(',');
    app.add_option("--width", options.width);
    app.add_option("--height", options.height);
    app.add_option("--threads", options.threads);
    app.add_option("--repeats", options.repeats);
    app.add_option("--sample", options.sample, "pixels that are checked with 256 bits");
    app.add_option("--limit", options.limit, "seconds for one picture; slower ones are stopped");
    CLI11_PARSE(app, argc, argv);
    if (options.name.empty()) options.name = options.scene;
    if (options.methods.empty()) {
        for (const ivory::Method* method : ivory::methods()) {
            options.methods.emplace_back(method->name());
        }
    }
    if (options.tolerances.empty()) {
        for (int n = 2; n <= 12; ++n) options.tolerances.push_back(std::pow(10.0, -n));
    }
    if (options.deltas.empty()) {
        for (int n = 1; n <= 10; ++n) options.deltas.push_back(std::pow(10.0, -n));
    }
    try {
        ivory::measure(options);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "error_against_time: %s\n", error.what());
        return 1;
    }
    return 0;
}
