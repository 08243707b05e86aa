#include "app/cli/arguments.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>
#include <thread>
#include <vector>

#include "app/cli/output_names.h"
#include "core/math/instruction_sets.h"
#include "core/render/answers_file.h"
#include "core/render/sampled_picture.h"
#include "core/scene/text.h"

namespace ivory {
namespace {

constexpr int largest_side = 32768;         // pixels
constexpr long largest_picture = 1L << 28;  // pixels; 21 bytes each
constexpr int most_threads = 1024;
constexpr int most_repeats = 1000000;
constexpr double least_tolerance = 1e-15, greatest_tolerance = 0.1;

// All of `text` as a number of its type; false where it is none or does not fit.
template <class Number>
bool read(std::string_view text, Number& value) {
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    return result.ec == std::errc() && result.ptr == text.data() + text.size();
}

UsageError wrong_value(std::string_view option, std::string_view text, std::string_view rule) {
    return UsageError(std::string(option) + ": " + in_quotes(text) + " is not " +
                      std::string(rule));
}

int read_count(std::string_view option, std::string_view text, int most) {
    int value = 0;
    if (!read(text, value) || value < 1 || value > most) {
        throw wrong_value(option, text, "a whole number from 1 to " + std::to_string(most));
    }
    return value;
}

int read_samples(std::string_view text) {
    int value = 0;
    const bool is_number = read(text, value);
    for (int side = 1; is_number && side <= most_samples_a_side; ++side)
        if (side * side == value) return side;
    throw wrong_value("--samples", text, "one of 1, 4, 9, 16, 25, 36, 49, 64");
}

Stereo read_stereo(std::string_view text) {
    for (std::size_t kind = 0; kind < stereo_words.size(); ++kind)
        if (text == stereo_words[kind]) return static_cast<Stereo>(kind + 1);
    throw wrong_value("--stereo", text, "side-by-side or red-cyan");
}

double read_eyes(std::string_view text) {
    double value = 0;
    if (!read(text, value) || !(value > 0 && std::isfinite(value))) {
        throw wrong_value("--eyes", text, "a distance greater than 0, and finite");
    }
    return value;
}

void read_size(std::string_view text, int& width, int& height) {
    const std::size_t cross = text.find('x');
    const bool both = cross != std::string_view::npos && read(text.substr(0, cross), width) &&
                      read(text.substr(cross + 1), height);
    if (!both || width < 1 || height < 1 || width > largest_side || height > largest_side) {
        throw wrong_value("--size", text,
                          "WIDTHxHEIGHT in pixels, each from 1 to " + std::to_string(largest_side) +
                              ", as 1280x720");
    }
    if (static_cast<long>(width) * height > largest_picture) {
        throw wrong_value("--size", text,
                          "a size of at most " + std::to_string(largest_picture) + " pixels");
    }
}

double read_tolerance(std::string_view text) {
    double value = 0;
    if (!read(text, value) || !(value >= least_tolerance && value <= greatest_tolerance)) {
        throw wrong_value("--tolerance", text, "a number from 1e-15 to 0.1");
    }
    return value;
}

double read_delta(std::string_view text) {
    double value = 0;
    if (!read(text, value) || !(value > 0 && std::isfinite(value))) {
        throw wrong_value("--delta", text, "a number greater than 0");
    }
    return value;
}

const Method* read_method(std::string_view text) {
    if (const Method* method = find_method(text)) return method;
    std::vector<std::string_view> names;
    for (const Method* method : methods()) names.push_back(method->name());
    throw wrong_value("--method", text, "a method; take " + listed(names, "or"));
}

// An option with one value that `take` reads, or throws UsageError.
template <class Take>
CLI::Option* add_value(CLI::App& app, const std::string& name, const std::string& value_name,
                       const std::string& help, Take take) {
    return app
        .add_option_function<std::string>(
            name, [take](const std::string& text) { take(text); }, help)
        ->type_name(value_name);
}

void add_work_options(CLI::App& call, WorkArguments& work, const std::string& tolerance) {
    add_value(call, "--tolerance", "E",
              "how far the ends of a root's enclosure may lie apart, in widths of the nearest "
              "element: 1e-15 to 0.1; default " +
                  tolerance,
              [&work](const std::string& text) { work.options.tolerance = read_tolerance(text); });
    add_value(call, "--method", "NAME",
              "how rays are intersected; `ivory info --methods` lists them; default proved",
              [&work](const std::string& text) { work.method = read_method(text); });
    add_value(
        call, "--delta", "D",
        "step of the central differences that some methods take for the normal, in units of "
        "the least width; default 1e-5",
        [&work](const std::string& text) { work.options.difference_delta = read_delta(text); });
    add_value(call, "--threads", "N", "worker threads; default: one for each processor",
              [&work](const std::string& text) {
                  work.threads = read_count("--threads", text, most_threads);
              });
    call.add_flag("--quiet", work.quiet, "no progress on standard error");
}

constexpr std::array<std::string_view, 1> picture_suffixes{".png"};
constexpr std::array<std::string_view, 1> depth_suffixes{".pfm"};
constexpr std::array<std::string_view, 2> answers_suffixes{".csv", ".txt"};
constexpr std::array<std::string_view, 2> statistics_suffixes{".json", ".txt"};

bool Skipping::*read_skipping(std::string_view text) {
    std::vector<std::string_view> names;
    for (const SkippingName& kind : skipping_names) {
        if (kind.name == text) return kind.member;
        names.push_back(kind.name);
    }
    throw wrong_value("--without", text, "a kind of skipping; take " + listed(names, "or"));
}

void limit_instructions(const std::string& name) {
    if (limit_instruction_set(name)) return;
    throw wrong_value(
        "--instructions", name,
        "an instruction set that this machine has; take " + listed(instruction_sets(), "or"));
}

void add_render_options(CLI::App& call, RenderArguments& render) {
    call.add_option("SCENE", render.scene, "scene file, - for standard input")
        ->required()
        ->type_name("");
    call.add_option("-o,--output", render.picture, "the picture, sRGB")->type_name("OUT.png");
    add_value(call, "--size", "WxH", "width and height in pixels; default 1280x720",
              [&render](const std::string& text) { read_size(text, render.width, render.height); });
    call.add_option("--depth", render.depth, "distance along each pixel's ray, +inf on a miss")
        ->type_name("OUT.pfm");
    call.add_option("--answers", render.answers, "each pixel's ray and answer, one a line")
        ->type_name("OUT.csv");
    call.add_option("--stats", render.statistics, "times and counts")->type_name("OUT.json");
    add_value(call, "--samples", "N",
              "the mean of so many samples a pixel, a square of 1 to 8; default 1. --answers and "
              "--depth have all of them traced, and --answers is of the larger picture",
              [&render](const std::string& text) { render.samples_a_side = read_samples(text); });
    add_value(
        call, "--stereo", "KIND",
        "for two eyes: side-by-side, twice as wide, or red-cyan. --answers has the left eye's "
        "picture first, --depth both side by side",
        [&render](const std::string& text) { render.stereo = read_stereo(text); });
    add_value(call, "--eyes", "D",
              "how far apart the eyes are, with --stereo; default: a thirtieth of the target's "
              "distance",
              [&render](const std::string& text) { render.eyes = read_eyes(text); });
    add_value(call, "--repeat", "N",
              "render N times, everything built anew; --stats gives the medians",
              [&render](const std::string& text) {
                  render.repeat = read_count("--repeat", text, most_repeats);
              });
    call.add_option_function<std::vector<std::string>>(
            "--without",
            [&render](const std::vector<std::string>& kinds) {
                for (const std::string& kind : kinds) {
                    render.work.options.skipping.*read_skipping(kind) = false;
                }
            },
            "turns a kind of skipping off, to see what it saves: lists, windows, parts, coarse "
            "(float before double) or packets; several with commas")
        ->delimiter(',')
        ->type_name("KIND");
    add_value(call, "--instructions", "NAME",
              "none better than these, to compare: " + listed(instruction_sets(), "or") +
                  "; default: the best that this machine has",
              limit_instructions);
    add_work_options(call, render.work, "1e-6");
}

void add_trace_options(CLI::App& call, TraceArguments& trace) {
    call.add_option("SCENE", trace.scene, "scene file, - for standard input")
        ->required()
        ->type_name("");
    call.add_option("--rays", trace.rays,
                    "rays, one a line: ox oy oz dx dy dz; default: standard input")
        ->type_name("FILE");
    add_work_options(call, trace.work, "1e-9");
}

void add_info_options(CLI::App& call, InfoArguments& info) {
    call.add_option("SCENE", info.scene, "scene file, - for standard input")->type_name("");
    call.add_flag("--json", info.json, "as JSON");
    call.add_flag("--methods", info.methods,
                  "lists the methods of --method and what each proves; takes no scene");
}

void add_viewer_options(CLI::App& app, ViewerArguments& viewer) {
    app.add_option("SCENE", viewer.scene, "scene file to open in the viewer")->type_name("");
    app.add_flag("--headless", viewer.headless,
                 "runs the viewer in memory, without a window or a display");
    app.add_option("--script", viewer.script,
                   "with --headless: what a person does, one JSON object a line; - for standard "
                   "input; default: wait until the picture is final")
        ->type_name("FILE");
    app.add_option("--screenshot", viewer.screenshot,
                   "with --headless: the whole window at the end")
        ->type_name("OUT.png");
    add_value(app, "--size", "WxH",
              "of the window in pixels; default 1280x720, or as the window was left",
              [&viewer](const std::string& text) {
                  read_size(text, viewer.width, viewer.height);
                  viewer.size_given = true;
              });
    app.add_flag("--no-settings", viewer.no_settings,
                 "neither reads nor writes the user's settings; implied by --headless");
    add_value(app, "--threads", "N", "worker threads; default: one for each processor",
              [&viewer](const std::string& text) {
                  viewer.threads = read_count("--threads", text, most_threads);
              });
}

void check(const ViewerArguments& viewer) {
    if (viewer.headless) {
        check_files(std::array{NamedFile{"the scene", viewer.scene.value_or(""), {}},
                               NamedFile{"the script", viewer.script.value_or(""), {}}},
                    std::array{NamedFile{"--screenshot", viewer.screenshot.value_or(""),
                                         picture_suffixes}});
        return;
    }
    if (viewer.script) throw UsageError("--script needs --headless");
    if (viewer.screenshot) {
        throw UsageError("--screenshot needs --headless; in the window F12 takes one");
    }
}

void check(const RenderArguments& render) {
    if ((render.picture + render.depth + render.answers + render.statistics).empty()) {
        throw UsageError(
            "nowhere to write to; name the picture with -o OUT.png, or --depth, "
            "--answers or --stats");
    }
    if (render.eyes && render.stereo == Stereo::none) {
        throw UsageError(
            "--eyes says nothing without --stereo; add --stereo side-by-side or red-cyan");
    }
    const long all = static_cast<long>(render.width) * render.height * render.samples_a_side *
                     render.samples_a_side;
    if (!render.answers.empty() && all > largest_picture) {
        throw UsageError("--answers would be of " + std::to_string(all) +
                         " samples; take fewer, at most " + std::to_string(largest_picture));
    }
    check_files(std::array{NamedFile{"the scene", render.scene, {}}},
                std::array{NamedFile{"-o", render.picture, picture_suffixes},
                           NamedFile{"--depth", render.depth, depth_suffixes},
                           NamedFile{"--answers", render.answers, answers_suffixes},
                           NamedFile{"--stats", render.statistics, statistics_suffixes}});
}

void check(const TraceArguments& trace) {
    check_files(
        std::array{NamedFile{"the scene", trace.scene, {}}, NamedFile{"the rays", trace.rays, {}}},
        std::array{NamedFile{"standard output", "-", {}}});
}

void check(const InfoArguments& info) {
    if (info.methods && !info.scene.empty()) {
        throw UsageError("--methods takes no scene; leave one of them out");
    }
    if (!info.methods && info.scene.empty()) {
        throw UsageError("SCENE is missing; name a scene file");
    }
}

// CLI11's words on one line, with where to read on.
std::string usage_line(const CLI::App& app, std::string_view what) {
    std::string line;
    for (const char c : what) line += c == '\n' ? ' ' : c;
    while (line.ends_with(' ') || line.ends_with('.')) line.pop_back();
    std::string call = "ivory";
    for (const CLI::App* parsed : app.get_subcommands()) call += " " + parsed->get_name();
    return printable(line) + " (see " + call + " --help)";
}

}  // namespace

Arguments parse_arguments(int count, const char* const* words) {
    const int processors =
        std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, most_threads);
    RenderArguments render;
    TraceArguments trace;
    render.work.options.tolerance = 1e-6;
    trace.work.options.tolerance = 1e-9;
    for (WorkArguments* work : {&render.work, &trace.work}) {
        work->method = methods().front();
        work->threads = processors;
    }
    InfoArguments info;
    ViewerArguments viewer;
    viewer.threads = processors;

    CLI::App app{"Draws implicit surfaces with skeletons, and proves every pixel.", "ivory"};
    app.set_version_flag("--version", "ivory " IVORY_VERSION);
    app.require_subcommand(0, 1);
    add_viewer_options(app, viewer);
    CLI::App& render_call =
        *app.add_subcommand("render", "Draws a picture, without a display or OpenGL.");
    CLI::App& trace_call =
        *app.add_subcommand("trace", "Traces rays: after the line " + std::string(answer_columns) +
                                         " one answer a line on standard output.");
    CLI::App& info_call = *app.add_subcommand(
        "info", "What a scene holds: elements, box, camera, what is skipped and why.");
    add_render_options(render_call, render);
    add_trace_options(trace_call, trace);
    add_info_options(info_call, info);

    try {
        app.parse(count, words);
        if (render_call.parsed()) {
            check(render);
            return render;
        }
        if (trace_call.parsed()) {
            check(trace);
            return trace;
        }
        if (info_call.parsed()) {
            check(info);
            return info;
        }
        check(viewer);
        return viewer;
    } catch (const CLI::CallForHelp&) {
        return HelpText{app.help()};
    } catch (const CLI::CallForAllHelp&) {
        return HelpText{app.help("", CLI::AppFormatMode::All)};
    } catch (const CLI::CallForVersion& version) {
        return HelpText{std::string(version.what()) + "\n"};
    } catch (const CLI::ParseError& error) {
        throw UsageError(usage_line(app, error.what()));
    } catch (const UsageError& error) {
        throw UsageError(usage_line(app, error.what()));
    }
}

}  // namespace ivory
