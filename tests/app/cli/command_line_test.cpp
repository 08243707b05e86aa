// The executable, run: what goes where, what stays on the disk, and how it ends.
#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "core/math/instruction_sets.h"
#include "core/math/vec3.h"
#include "tests/app/cli/run_ivory.h"
#include "tests/ordinary_user.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using tests::bytes_of;
using tests::Finished;
using tests::Ivory;
using tests::put_bytes;
using tests::run_ivory;
using tests::TemporaryFolder;

const std::string figure_1 = tests::scene_path("figure-1");
const std::string columns = "status,t_lo,t_hi,nx,ny,nz,r,g,b\n";

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

std::size_t files_in(const fs::path& folder) {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

// Exit status, nothing on standard output, one line on standard error that holds `part`.
void expect_failure(const Finished& run, int status, const std::string& part) {
    EXPECT_EQ(run.status, status) << run.err;
    EXPECT_EQ(run.out, "");
    EXPECT_TRUE(run.err.starts_with("ivory: ")) << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_NE(run.err.find(part), std::string::npos) << run.err;
}

void wait_until(const std::function<bool()>& happened) {
    for (int n = 0; n < 2000 && !happened(); ++n) {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    EXPECT_TRUE(happened());
}

// RGB, row by row.
std::vector<std::uint8_t> pixels_of(const fs::path& path) {
    png_image image;
    std::memset(&image, 0, sizeof image);
    image.version = PNG_IMAGE_VERSION;
    EXPECT_NE(png_image_begin_read_from_file(&image, path.c_str()), 0);
    image.format = PNG_FORMAT_RGB;
    std::vector<std::uint8_t> pixels(PNG_IMAGE_SIZE(image));
    EXPECT_NE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr), 0);
    return pixels;
}

// Of linear light 0..1, by the formula of IEC 61966-2-1.
double light_of(std::uint8_t byte) {
    const double s = byte / 255.0;
    return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}
double byte_of(double light) {
    return 255 * (light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055);
}

TEST(CommandLine, HelpAndVersionGoToStandardOutput) {
    const std::vector<std::vector<std::string>> calls{
        {"--help"}, {"render", "--help"}, {"trace", "--help"}, {"info", "--help"}, {"--version"}};
    for (const std::vector<std::string>& words : calls) {
        const Finished run = run_ivory(words);
        EXPECT_EQ(run.status, 0);
        EXPECT_NE(run.out.find("ivory"), std::string::npos);
        EXPECT_EQ(run.err, "");
    }
}

TEST(CommandLine, WrongUsageIsTwo) {
    expect_failure(run_ivory({"render", figure_1}), 2, "-o OUT.png");
    expect_failure(run_ivory({"render", figure_1, "-o", "x.png", "--method", "magic"}), 2,
                   "proved");
    expect_failure(run_ivory({"--no-such-option"}), 2, "--no-such-option");
}

TEST(CommandLine, ABrokenSceneIsOne) {
    const TemporaryFolder folder;
    put_bytes(folder / "bad.ivory.json", "{\"ivory\": 1, \"elements\": []}");
    for (const char* call : {"render", "trace", "info"}) {
        std::vector<std::string> words{call, (folder / "bad.ivory.json").string()};
        if (words[0] == "render") words.insert(words.end(), {"-o", (folder / "a.png").string()});
        expect_failure(run_ivory(words), 1, "threshold");
    }
    EXPECT_EQ(files_in(folder.path()), 1u);
    expect_failure(run_ivory({"info", (folder / "none").string()}), 1, "No such file");
}

TEST(CommandLine, RenderWritesAllThatIsAskedFor) {
    const TemporaryFolder folder;
    const std::string out = folder.path().string() + "/";
    const Finished run = run_ivory({"render", figure_1, "-o", out + "a.png", "--size", "40x30",
                                    "--depth", out + "a.pfm", "--answers", out + "a.csv", "--stats",
                                    out + "a.json", "--threads", "2"});
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(run.err, "");  // no terminal, no progress
    EXPECT_EQ(files_in(folder.path()), 4u);
    EXPECT_TRUE(bytes_of(out + "a.png").starts_with("\x89PNG"));
    EXPECT_TRUE(bytes_of(out + "a.pfm").starts_with("Pf\n40 30\n-1.0\n"));

    const std::vector<std::string> answers = lines_of(bytes_of(out + "a.csv"));
    ASSERT_EQ(answers.size(), 1200u);
    std::map<std::string, int> statuses;
    for (const std::string& line : answers) {
        EXPECT_EQ(std::count(line.begin(), line.end(), ','), 14) << line;
        std::istringstream fields(line);
        std::string status;
        for (int n = 0; n < 7; ++n) std::getline(fields, status, ',');
        ++statuses[status];
    }
    const Json statistics = Json::parse(bytes_of(out + "a.json"));
    EXPECT_EQ(statistics.at("width"), 40);
    EXPECT_EQ(statistics.at("threads"), 2);
    EXPECT_GT(statuses["hit"], 50);
    for (const auto& [status, count] : statistics.at("pixels").items()) {
        EXPECT_EQ(count, statuses[status]) << status;
    }
}

// The answers are those of the larger picture, of which the picture has the mean; without the answers it is
// the same but for a byte.
TEST(CommandLine, SamplesAreThoseOfTheLargerPicture) {
    const TemporaryFolder folder;
    const std::string out = folder.path().string() + "/";
    ASSERT_EQ(
        run_ivory({"render", figure_1, "-o", out + "a.png", "--size", "40x30", "--samples", "4",
                   "--depth", out + "a.pfm", "--answers", out + "a.csv", "--stats", out + "a.json"})
            .status,
        0);
    ASSERT_EQ(run_ivory({"render", figure_1, "-o", out + "b.png", "--size", "80x60", "--answers",
                         out + "b.csv"})
                  .status,
              0);
    ASSERT_EQ(
        run_ivory({"render", figure_1, "-o", out + "c.png", "--size", "40x30", "--samples", "4"})
            .status,
        0);
    const std::vector<std::uint8_t> all = pixels_of(out + "a.png"),
                                    larger = pixels_of(out + "b.png"),
                                    few = pixels_of(out + "c.png");
    ASSERT_EQ(all.size(), 3u * 40 * 30);
    ASSERT_EQ(larger.size(), 4 * all.size());
    ASSERT_EQ(few.size(), all.size());
    int smoothed = 0;
    for (std::size_t k = 0; k < all.size(); ++k) {
        const std::size_t i = k / 3 % 40, j = k / 120, first = 3 * (2 * j * 80 + 2 * i) + k % 3;
        const auto [least, most] = std::minmax(
            {larger[first], larger[first + 3], larger[first + 240], larger[first + 243]});
        const double mean = (light_of(larger[first]) + light_of(larger[first + 3]) +
                             light_of(larger[first + 240]) + light_of(larger[first + 243])) /
                            4;
        // half a byte of its own, and as much as the four were rounded by
        EXPECT_NEAR(all[k], byte_of(mean), 1.01) << i << ", " << j;
        EXPECT_NEAR(few[k], all[k], 1) << i << ", " << j;
        smoothed += all[k] > least + 2 && all[k] + 2 < most;
    }
    EXPECT_GT(smoothed, 100);
    EXPECT_EQ(bytes_of(out + "a.csv"), bytes_of(out + "b.csv"));
    EXPECT_TRUE(bytes_of(out + "a.pfm").starts_with("Pf\n40 30\n"));
    const Json statistics = Json::parse(bytes_of(out + "a.json"));
    EXPECT_EQ(statistics.at("samples"), 4);
    int pixels = 0;
    for (const auto& [status, count] : statistics.at("pixels").items()) pixels += count.get<int>();
    EXPECT_EQ(pixels, 1200);
}

TEST(CommandLine, StereoPicturesAreThoseOfBothEyes) {
    const TemporaryFolder folder;
    const std::string out = folder.path().string() + "/";
    const auto render = [&](std::vector<std::string> more) {
        std::vector<std::string> words{"render", figure_1, "--size", "40x30"};
        words.insert(words.end(), more.begin(), more.end());
        return run_ivory(words);
    };
    ASSERT_EQ(render({"-o", out + "a.png", "--stereo", "side-by-side", "--eyes", "0.8", "--depth",
                      out + "a.pfm", "--answers", out + "a.csv"})
                  .status,
              0);
    ASSERT_EQ(render({"-o", out + "b.png", "--stereo", "red-cyan", "--eyes", "0.8"}).status, 0);
    EXPECT_TRUE(bytes_of(out + "a.pfm").starts_with("Pf\n80 30\n"));
    const std::vector<std::string> answers = lines_of(bytes_of(out + "a.csv"));
    ASSERT_EQ(answers.size(), 2400u);
    // The left eye's rays come first, all from one place, so far from the right one's.
    const auto origin_of = [&](std::size_t line) {
        Vec3d origin;
        std::istringstream fields(answers[line]);
        for (const std::size_t axis : {0, 1, 2}) {
            std::string field;
            std::getline(fields, field, ',');
            origin[axis] = std::strtod(field.c_str(), nullptr);
        }
        return origin;
    };
    EXPECT_EQ(origin_of(0), origin_of(1199));
    EXPECT_EQ(origin_of(1200), origin_of(2399));
    const Vec3d apart = origin_of(1200) - origin_of(0);
    EXPECT_NEAR(std::sqrt(dot(apart, apart)), 0.8, 1e-14);

    const std::vector<std::uint8_t> both = pixels_of(out + "a.png"),
                                    grey = pixels_of(out + "b.png");
    ASSERT_EQ(both.size(), 3u * 80 * 30);
    ASSERT_EQ(grey.size(), 3u * 40 * 30);
    const auto pixel = [](const std::vector<std::uint8_t>& pixels, std::size_t p) {
        return std::array{pixels[3 * p], pixels[3 * p + 1], pixels[3 * p + 2]};
    };
    const auto luminance = [](const std::array<std::uint8_t, 3>& rgb) {
        return byte_of(0.2126 * light_of(rgb[0]) + 0.7152 * light_of(rgb[1]) +
                       0.0722 * light_of(rgb[2]));
    };
    int differing = 0;
    for (std::size_t j = 0; j < 30; ++j) {
        for (std::size_t i = 0; i < 40; ++i) {
            const auto left = pixel(both, 80 * j + i), right = pixel(both, 80 * j + 40 + i);
            const bool left_misses = answers[40 * j + i].find(",miss,") != std::string::npos;
            const bool right_misses =
                answers[1200 + 40 * j + i].find(",miss,") != std::string::npos;
            EXPECT_EQ(left == pixel(both, 0), left_misses) << i << ", " << j;
            EXPECT_EQ(right == pixel(both, 0), right_misses) << i << ", " << j;
            differing += left_misses != right_misses;
            const auto seen = pixel(grey, 40 * j + i);
            EXPECT_NEAR(seen[0], luminance(left), 0.51);
            EXPECT_NEAR(seen[1], luminance(right), 0.51);
            EXPECT_EQ(seen[1], seen[2]);
        }
    }
    EXPECT_GT(differing, 5);
}

TEST(CommandLine, AnOrthographicCameraHasNoTwoEyes) {
    const TemporaryFolder folder;
    const std::string out = folder.path().string() + "/";
    Json scene = Json::parse(bytes_of(figure_1));
    scene["camera"]["projection"] = "orthographic";
    std::ofstream(out + "a.ivory.json") << scene.dump();
    const Finished run =
        run_ivory({"render", out + "a.ivory.json", "-o", out + "a.png", "--stereo", "red-cyan"});
    EXPECT_EQ(run.status, 1);
    EXPECT_NE(run.err.find("/camera: an orthographic camera has no two eyes"), std::string::npos)
        << run.err;
}

// The rays of the answers, traced on their own, are answered the same.
TEST(CommandLine, AnswersAreThoseOfTrace) {
    const TemporaryFolder folder;
    const std::string out = folder.path().string() + "/";
    ASSERT_EQ(run_ivory({"render", figure_1, "--size", "32x18", "--answers", out + "a.csv"}).status,
              0);
    std::string rays, expected = columns;
    for (const std::string& line : lines_of(bytes_of(out + "a.csv"))) {
        std::size_t at = 0;
        for (int n = 0; n < 6; ++n) at = line.find(',', at) + 1;
        rays += line.substr(0, at - 1) + "\n";
        expected += line.substr(at, line.find(',', line.find(',', at) + 1) - at) + "\n";
    }
    put_bytes(out + "rays", rays);
    const Finished run =
        run_ivory({"trace", figure_1, "--rays", out + "rays", "--tolerance", "1e-6"});
    ASSERT_EQ(run.status, 0) << run.err;
    std::string statuses_and_t_lo = columns;
    const std::vector<std::string> lines = lines_of(run.out);
    for (std::size_t k = 1; k < lines.size(); ++k) {
        statuses_and_t_lo += lines[k].substr(0, lines[k].find(',', lines[k].find(',') + 1)) + "\n";
    }
    EXPECT_EQ(statuses_and_t_lo, expected);
}

TEST(CommandLine, AnyNumberOfThreadsGivesTheSameBytes) {
    const TemporaryFolder folder;
    std::string first_png, first_csv;
    for (const char* threads : {"1", "2", "5"}) {
        const std::string out = folder.path().string() + "/";
        ASSERT_EQ(run_ivory({"render", tests::scene_path("figure-2"), "--size", "90x60", "-o",
                             out + "a.png", "--answers", out + "a.csv", "--threads", threads})
                      .status,
                  0);
        const std::string png = bytes_of(out + "a.png"), csv = bytes_of(out + "a.csv");
        if (first_png.empty()) first_png = png, first_csv = csv;
        EXPECT_TRUE(png == first_png && csv == first_csv) << threads;
    }
}

// On another instruction set a hit is never a miss, enclosures overlap, and pixels of equal status
// differ by 1/255 at most.
TEST(CommandLine, InstructionSetsAgree) {
    const TemporaryFolder folder;
    const std::string mixed = IVORY_SOURCE_DIR "/assets/scenes/molecule.ivory.json";
    std::vector<std::string> expected_answers;
    std::vector<std::uint8_t> expected_pixels;
    for (const std::string_view name : instruction_sets()) {
        SCOPED_TRACE(std::string(name));
        const Finished run =
            run_ivory({"render", mixed, "-o", (folder / "a.png").string(), "--answers",
                       (folder / "a.csv").string(), "--size", "160x120", "--instructions",
                       std::string(name), "--stats", "-", "--quiet"});
        ASSERT_EQ(run.status, 0) << run.err;
        EXPECT_NE(run.out.find("\"target\": \"" + std::string(name) + "\""), std::string::npos);
        const std::vector<std::string> answers = lines_of(bytes_of(folder / "a.csv"));
        const std::vector<std::uint8_t> pixels = pixels_of(folder / "a.png");
        if (expected_answers.empty()) {
            expected_answers = answers;
            expected_pixels = pixels;
        }
        ASSERT_EQ(answers.size(), expected_answers.size());
        ASSERT_EQ(pixels.size(), expected_pixels.size());
        for (std::size_t n = 1; n < answers.size(); ++n) {
            const auto column = [](const std::string& line, int index) {
                std::size_t begin = 0;
                for (; index > 0; --index) begin = line.find(',', begin) + 1;
                return line.substr(begin, line.find(',', begin) - begin);
            };
            const std::string status = column(answers[n], 6);
            ASSERT_EQ(status, column(expected_answers[n], 6)) << n;
            if (status == "hit") {
                const auto t = [&](const std::string& line, int index) {
                    return std::strtod(column(line, index).c_str(), nullptr);
                };
                ASSERT_LE(t(answers[n], 7), t(expected_answers[n], 8));
                ASSERT_GE(t(answers[n], 8), t(expected_answers[n], 7));
            }
            for (std::size_t k = 3 * (n - 1); k < 3 * n; ++k) {
                ASSERT_LE(std::abs(pixels[k] - expected_pixels[k]), 1) << n;
            }
        }
    }
    expect_failure(run_ivory({"render", mixed, "--stats", "-", "--instructions", "Z80"}), 2,
                   "not an instruction set that this machine has");
}

TEST(CommandLine, ADashIsStandardInputAndOutput) {
    const Finished png = run_ivory({"render", "-", "-o", "-", "--size", "8x8"}, {figure_1, ""});
    EXPECT_EQ(png.status, 0) << png.err;
    EXPECT_TRUE(png.out.starts_with("\x89PNG"));
    const Finished json = run_ivory({"render", figure_1, "--stats", "-", "--size", "8x8"});
    EXPECT_EQ(Json::parse(json.out).at("height"), 8);
    EXPECT_EQ(run_ivory({"info", "-", "--json"}, {figure_1, ""}).status, 0);
}

TEST(CommandLine, RepeatedRendersGiveTheMediansOfOne) {
    const Finished run =
        run_ivory({"render", figure_1, "--stats", "-", "--size", "8x8", "--repeat", "4"});
    const Json json = Json::parse(run.out);
    EXPECT_EQ(json.at("repeats"), 4);
    EXPECT_EQ(json.at("pixels").at("hit").get<int>() + json.at("pixels").at("miss").get<int>(), 64);
    for (const char* part : {"load", "compile", "trace", "shade", "write", "total"}) {
        EXPECT_GE(json.at("seconds").at(part).get<double>(), 0) << part;
    }
}

TEST(CommandLine, WhatCannotBeWrittenLeavesNothing) {
    const TemporaryFolder folder;
    const std::string out = folder.path().string() + "/";
    expect_failure(run_ivory({"render", figure_1, "-o", out + "none/a.png", "--size", "8x8"}), 1,
                   "none/a.png: cannot be written");
    expect_failure(run_ivory({"render", figure_1, "-o", out, "--size", "8x8"}), 1,
                   "cannot be written");
    // The second of two outputs fails: the first is not there either.
    expect_failure(run_ivory({"render", figure_1, "-o", out + "a.png", "--stats",
                              out + "none/s.json", "--size", "8x8"}),
                   1, "none/s");
    EXPECT_EQ(files_in(folder.path()), 0u);
    if (fs::exists("/dev/full")) {
        expect_failure(run_ivory({"render", figure_1, "-o", "/dev/full", "--size", "64x64"}), 1,
                       "No space left");
        expect_failure(run_ivory({"render", figure_1, "-o", out + "a.png", "--answers", "/dev/full",
                                  "--size", "64x64"}),
                       1, "No space left");
    }
    EXPECT_EQ(files_in(folder.path()), 0u);
}

TEST(CommandLine, WhatStoodThereStaysUntilTheNewFileIsWhole) {
    const TemporaryFolder folder;
    const std::string picture = (folder / "a.png").string();
    put_bytes(picture, "old");
    expect_failure(run_ivory({"render", figure_1, "-o", picture, "--stats",
                              folder.path().string() + "/none/s.json", "--size", "8x8"}),
                   1, "none/s");
    EXPECT_EQ(bytes_of(picture), "old");
    EXPECT_EQ(run_ivory({"render", figure_1, "-o", picture, "--size", "8x8"}).status, 0);
    EXPECT_TRUE(bytes_of(picture).starts_with("\x89PNG"));
}

TEST(CommandLine, TheSceneIsNotOverwritten) {
    const TemporaryFolder folder;
    const std::string scene = (folder / "s.ivory.json").string();
    fs::copy_file(figure_1, scene);
    expect_failure(run_ivory({"render", scene, "-o", scene}), 1, "is the scene itself");
    EXPECT_EQ(bytes_of(scene), bytes_of(figure_1));
}

TEST(CommandLine, AStandardOutputThatTakesNothingIsOne) {
    for (const std::vector<std::string>& words :
         std::vector<std::vector<std::string>>{{"--help"},
                                               {"info", figure_1},
                                               {"trace", figure_1},
                                               {"render", figure_1, "-o", "-", "--size", "8x8"}}) {
        expect_failure(run_ivory(words, {"/dev/null", "closed"}), 1, "standard output");
        if (!fs::exists("/dev/full")) continue;
        expect_failure(run_ivory(words, {"/dev/null", "/dev/full"}), 1, "No space left");
    }
}

TEST(CommandLine, AReaderThatLeavesIsNoCrash) {
    const TemporaryFolder folder;
    std::string rays;
    for (int n = 0; n < 20000; ++n) rays += "0 0 8 0 0 -1\n";
    put_bytes(folder / "rays", rays);
    const std::string call = "{ '" IVORY_EXECUTABLE "' trace '" + figure_1 + "' --rays '" +
                             (folder / "rays").string() + "' 2>'" + (folder / "err").string() +
                             "'; echo $? >'" + (folder / "status").string() +
                             "'; } | head -1 >/dev/null";
    ASSERT_EQ(std::system(call.c_str()), 0);
    EXPECT_EQ(bytes_of(folder / "status"), "1\n");
    EXPECT_EQ(lines_of(bytes_of(folder / "err")).size(), 1u);
}

// A terminal that is closed, a quit key, a shutdown, a time limit: interrupted, all of them.
TEST(CommandLine, ASignalEndsARenderInOrderAndLeavesNothing) {
    for (const int signal : {SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGXCPU, SIGUSR1, SIGUSR2}) {
        const TemporaryFolder folder;
        const Ivory ivory({"render", figure_1, "-o", (folder / "a.png").string(), "--size",
                           "400x300", "--repeat", "1000000", "--threads", "1"});
        wait_until([&] { return ivory.catches(signal); });
        ivory.send(signal);
        const Finished run = ivory.wait();
        EXPECT_EQ(run.status, 130) << signal << run.err;
        EXPECT_FALSE(run.was_killed) << signal;
        EXPECT_EQ(run.err, "");
        EXPECT_EQ(files_in(folder.path()), 0u);
    }
}

TEST(CommandLine, AKilledRenderLeavesNothing) {
    const TemporaryFolder folder;
    const Ivory ivory({"render", figure_1, "-o", (folder / "a.png").string(), "--answers",
                       (folder / "a.csv").string(), "--size", "400x300", "--repeat", "1000000"});
    wait_until([&] { return ivory.catches(SIGINT); });
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    ivory.send(SIGKILL);
    EXPECT_TRUE(ivory.wait().was_killed);
    EXPECT_EQ(files_in(folder.path()), 0u);
}

// nohup
TEST(CommandLine, AHangupThatIsIgnoredStaysSo) {
    const auto before = ::signal(SIGHUP, SIG_IGN);
    const Ivory ivory({"render", figure_1, "--stats", "-", "--size", "64x64", "--repeat", "200"});
    ::signal(SIGHUP, before);
    wait_until([&] { return ivory.catches(SIGINT); });
    ivory.send(SIGHUP);
    EXPECT_EQ(ivory.wait().status, 0);
}

// Files are compared, not the names that they go by.
TEST(CommandLine, NoTwoOutputsAreTheSameFile) {
    const TemporaryFolder folder;
    const std::string out = folder.path().string() + "/";
    const auto refused = [&](const std::string& picture, const std::string& depth) {
        const std::size_t before = files_in(folder.path());
        expect_failure(
            run_ivory({"render", figure_1, "--size", "8x8", "-o", picture, "--depth", depth}), 2,
            "is named for two outputs, -o and --depth");
        EXPECT_EQ(files_in(folder.path()), before);
    };
    fs::create_symlink("a.png", folder / "there later.pfm");
    refused(out + "a.png", out + "there later.pfm");
    put_bytes(folder / "a.png", "old");
    refused(out + "a.png", out + "there later.pfm");
    fs::create_hard_link(folder / "a.png", folder / "hard.pfm");
    refused(out + "a.png", out + "hard.pfm");
    EXPECT_EQ(bytes_of(out + "a.png"), "old");
    fs::create_directory_symlink(".", folder / "here");
    expect_failure(run_ivory({"render", figure_1, "--size", "8x8", "--answers", out + "a.txt",
                              "--stats", out + "here/./a.txt"}),
                   2, "is named for two outputs, --answers and --stats");
    expect_failure(
        run_ivory({"render", figure_1, "--size", "8x8", "-o", "-", "--depth", "/dev/stdout"}), 2,
        "is named for two outputs");
}

TEST(CommandLine, NoOutputIsAnInput) {
    const TemporaryFolder folder;
    const std::string scene = (folder / "s.ivory.json").string();
    fs::copy_file(figure_1, scene);
    fs::create_symlink("s.ivory.json", folder / "soft.png");
    fs::create_hard_link(scene, folder / "hard.png");
    for (const char* name : {"soft.png", "hard.png"}) {
        expect_failure(run_ivory({"render", scene, "-o", (folder / name).string()}), 1,
                       std::string(name) + ": is the scene itself; name another file");
        expect_failure(run_ivory({"render", "-", "-o", (folder / name).string()}, {scene, ""}), 1,
                       "is the scene itself");
    }
    EXPECT_EQ(bytes_of(scene), bytes_of(figure_1));
    put_bytes(folder / "rays", "0 0 8 0 0 -1\n");
    const std::string rays = (folder / "rays").string();
    const Finished run = run_ivory({"trace", scene, "--rays", rays}, {"/dev/null", rays});
    EXPECT_EQ(run.status, 1);
    EXPECT_NE(run.err.find("standard output: is the rays itself"), std::string::npos) << run.err;
    EXPECT_EQ(bytes_of(rays), "0 0 8 0 0 -1\n");
}

// The way to be without threads that every system knows: no memory for their stacks.
TEST(CommandLine, WithoutThreadsTheWorkIsDoneAllTheSame) {
    const TemporaryFolder folder;
    put_bytes(folder / "rays", [] {
        std::string rays;
        for (int n = 0; n < 1000; ++n) rays += "0 0 8 0 0 -1\n";
        return rays;
    }());
    const std::string ivory = "'" IVORY_EXECUTABLE "' ", scene = "'" + figure_1 + "' ";
    for (const char* threads : {"1", "4"}) {
        const std::string call =
            "cd '" + folder.path().string() + "' && { " + ivory + "render " + scene +
            "-o a.png --answers a.csv --size 200x150 --threads 2 && ulimit -s 4000000 && " + ivory +
            "trace " + scene + "--rays rays --threads 2 >free && ulimit -v 400000 && " + ivory +
            "render " + scene + "-o b.png --answers b.csv --size 200x150 --threads " + threads +
            " && " + ivory + "trace " + scene + "--rays rays --threads " + threads +
            " >bound; } 2>err";
        EXPECT_EQ(std::system(call.c_str()), 0) << bytes_of(folder / "err");
        EXPECT_EQ(bytes_of(folder / "a.png"), bytes_of(folder / "b.png"));
        EXPECT_EQ(bytes_of(folder / "a.csv"), bytes_of(folder / "b.csv"));
        EXPECT_EQ(bytes_of(folder / "free"), bytes_of(folder / "bound"));
    }
}

TEST(CommandLine, AnInterruptedTraceIs130) {
    const TemporaryFolder folder;
    const std::string pipe = (folder / "pipe").string();
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    const Ivory ivory({"trace", figure_1, "--rays", pipe});
    const int writer = ::open(pipe.c_str(), O_WRONLY);  // waits for the reader
    ASSERT_EQ(::write(writer, "0 0 8 0 0 -1\n", 13), 13);
    // What is there is answered before more is waited for.
    wait_until([&] { return lines_of(ivory.out_so_far()).size() == 2; });
    ivory.send(SIGINT);
    const Finished run = ivory.wait();
    ::close(writer);
    EXPECT_EQ(run.status, 130);
    EXPECT_EQ(lines_of(run.out).size(), 2u);
}

TEST(CommandLine, TraceAnswersInOrderForAnyNumberOfThreads) {
    const TemporaryFolder folder;
    std::string rays = "# hits and misses by turns\n\n";
    for (int n = 0; n < 3000; ++n) {
        rays +=
            std::to_string(n % 7 * 0.4 - 1.2) + (n % 2 == 0 ? " 0 8 0 0 -1\n" : ",0,8,0,0,-1\r\n");
    }
    put_bytes(folder / "rays", rays);
    std::string first;
    for (const char* threads : {"1", "2", "6"}) {
        const Finished run = run_ivory(
            {"trace", figure_1, "--threads", threads, "--rays", (folder / "rays").string()});
        EXPECT_EQ(run.status, 0) << run.err;
        EXPECT_EQ(run.err, "");
        EXPECT_EQ(lines_of(run.out).size(), 3001u);
        if (first.empty()) first = run.out;
        EXPECT_TRUE(run.out == first) << threads;
    }
    const std::vector<std::string> lines = lines_of(first);
    for (std::size_t k = 8; k < lines.size(); ++k) ASSERT_EQ(lines[k], lines[k - 7]);
}

TEST(CommandLine, AnswersBeforeABrokenRayStandForAnyNumberOfThreads) {
    const TemporaryFolder folder;
    std::string rays;
    for (int n = 0; n < 5000; ++n) rays += std::to_string(n % 7 * 0.4 - 1.2) + " 0 8 0 0 -1\n";
    put_bytes(folder / "whole", rays);
    put_bytes(folder / "broken", rays + "0 0 8 0 0 0\n0 0 8 0 0\n0 0 8 0 0 -1\n");
    const Finished whole = run_ivory({"trace", figure_1, "--rays", (folder / "whole").string()});
    EXPECT_EQ(lines_of(whole.out).size(), 5001u);
    for (const char* threads : {"1", "2", "6"}) {
        const Finished run = run_ivory({"trace", figure_1, "--threads", threads},
                                       {(folder / "broken").string(), ""});
        EXPECT_EQ(run.status, 1);
        EXPECT_TRUE(run.out == whole.out) << threads;
        EXPECT_EQ(run.err,
                  "ivory: standard input: line 5001: the direction is 0, 0, 0 and points nowhere; "
                  "one of the last three numbers must not be 0\n");
    }
}

TEST(CommandLine, TheLastLineNeedsNoNewline) {
    const TemporaryFolder folder;
    put_bytes(folder / "rays", "0 0 8 0 0 -1\n0 0 8 0 0 -1");
    const Finished run = run_ivory({"trace", figure_1}, {(folder / "rays").string(), ""});
    EXPECT_EQ(run.status, 0);
    EXPECT_EQ(lines_of(run.out).size(), 3u);
}

TEST(CommandLine, NoRaysAreNoError) {
    const Finished run = run_ivory({"trace", figure_1});
    EXPECT_EQ(run.status, 0);
    EXPECT_EQ(run.out, columns);
}

TEST(CommandLine, AnEndlessLineIsRefused) {
    const TemporaryFolder folder;
    put_bytes(folder / "rays", "0 0 8 0 0 -1\n" + std::string(3 << 20, ' '));
    const Finished run = run_ivory({"trace", figure_1, "--rays", (folder / "rays").string()});
    EXPECT_EQ(run.status, 1);
    EXPECT_NE(run.err.find("line 2: is longer than 1 MiB"), std::string::npos) << run.err;
    EXPECT_EQ(lines_of(run.out).size(), 2u);
}

TEST(CommandLine, RaysThatCannotBeReadAreOne) {
    const TemporaryFolder folder;
    for (const std::string& path : {folder.path().string(), (folder / "none").string()}) {
        const Finished run = run_ivory({"trace", figure_1, "--rays", path});
        EXPECT_EQ(run.status, 1);
        EXPECT_NE(run.err.find("cannot be read"), std::string::npos) << run.err;
    }
}

TEST(CommandLine, InfoTellsWhatIsSkippedAndWhy) {
    const TemporaryFolder folder;
    put_bytes(folder / "s.json", R"({"ivory": 1, "threshold": 0.5, "elements": [
        {"shape": "point", "position": [0, 0, 0]},
        {"shape": "point", "position": [1, 0, 0], "visible": false},
        {"shape": "point", "position": [0, 1, 0], "strength": -1, "name": "bite"},
        {"shape": "segment", "a": [0, 0, 0], "b": [1, 0, 0], "strength": 0.1}]})");
    const Finished json = run_ivory({"info", "--json", (folder / "s.json").string()});
    ASSERT_EQ(json.status, 0) << json.err;
    const Json info = Json::parse(json.out);
    EXPECT_EQ(info.at("elements").at("total"), 4);
    EXPECT_EQ(info.at("elements").at("visible"), 3);
    EXPECT_EQ(info.at("elements").at("shapes"), Json::parse(R"({"point": 3, "segment": 1})"));
    ASSERT_EQ(info.at("skipped").size(), 3u);
    EXPECT_EQ(info.at("skipped")[0].at("name"), "point 2");
    EXPECT_EQ(info.at("skipped")[0].at("from"), "field");
    EXPECT_EQ(info.at("skipped")[1].at("name"), "bite");
    EXPECT_EQ(info.at("skipped")[2].at("element"), 3);
    EXPECT_EQ(info.at("camera").at("framed"), true);
    EXPECT_TRUE(info.at("box").contains("lo"));

    const Finished text = run_ivory({"info", (folder / "s.json").string()});
    EXPECT_EQ(text.status, 0);
    EXPECT_NE(text.out.find("1 from the field: not visible (point 2)"), std::string::npos);
    EXPECT_NE(text.out.find("(bite)"), std::string::npos);
    EXPECT_NE(text.out.find("(segment 1)"), std::string::npos);
}

// The camera that `info` prints is the one that `render` takes at its own size.
TEST(CommandLine, InfoAndRenderAgreeOnTheCamera) {
    const TemporaryFolder folder;
    put_bytes(folder / "s.json",
              R"({"ivory": 1, "threshold": 0.5,
                  "elements": [{"shape": "point", "position": [1, 2, 3]}]})");
    const std::string scene = (folder / "s.json").string();
    Json info = Json::parse(run_ivory({"info", "--json", scene}).out).at("camera");
    info.erase("framed");
    EXPECT_EQ(info, Json::parse(run_ivory({"render", scene, "--stats", "-", "--size", "16x9"}).out)
                        .at("camera"));
}

// For a program the path is the path, whatever a terminal would make of it.
TEST(CommandLine, InfoGivesThePathAsJson) {
    const TemporaryFolder folder;
    for (const std::string name : {"a\nb \"\xC3\xA4\".json", "\xFF.json"}) {
        fs::copy_file(figure_1, folder / name);
        const Finished run = run_ivory({"info", "--json", (folder / name).string()});
        ASSERT_EQ(run.status, 0) << run.err;
        const std::string path = Json::parse(run.out).at("scene");
        EXPECT_EQ(path, (folder / (name[0] == 'a' ? name : "\xEF\xBF\xBD.json")).string());
    }
}

TEST(CommandLine, ASceneThatNoCameraCanShowIsNamedWithThePlace) {
    const TemporaryFolder folder;
    const std::string path = (folder / "s.json").string();
    put_bytes(path, R"({"ivory": 1, "threshold": 0.5, "elements": [
        {"shape": "segment", "a": [-1.7e308, 0, 0], "b": [1.7e308, 1.7e308, 1.7e308]}]})");
    const std::vector<std::vector<std::string>> calls{
        {"render", path, "--stats", "-", "--size", "8x8"}, {"info", path}};
    for (const std::vector<std::string>& words : calls) {
        expect_failure(run_ivory(words), 1, path + ": /elements: ");
    }
}

TEST(CommandLine, InfoListsTheMethods) {
    const Finished run = run_ivory({"info", "--methods"});
    EXPECT_EQ(run.status, 0);
    EXPECT_TRUE(run.out.starts_with("proved "));
    EXPECT_NE(run.out.find("bisection "), std::string::npos);
}

TEST(CommandLine, TheLocaleChangesNothing) {
    // Where this locale is not installed the test says less, and nothing wrong.
    ::setenv("LC_ALL", "de_DE.UTF-8", 1);
    const Finished run =
        run_ivory({"render", figure_1, "--stats", "-", "--size", "8x8", "--tolerance", "1e-3"});
    ::unsetenv("LC_ALL");
    EXPECT_EQ(Json::parse(run.out).at("tolerance"), 1e-3);
}

}  // namespace
}  // namespace ivory
