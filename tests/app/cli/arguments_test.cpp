// What the command line accepts, and how it refuses the rest: one line that says what would be
// right.
#include "app/cli/arguments.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace ivory {
namespace {

Arguments parse(const std::vector<const char*>& words) {
    std::vector<const char*> all{"ivory"};
    all.insert(all.end(), words.begin(), words.end());
    return parse_arguments(static_cast<int>(all.size()), all.data());
}

TEST(Arguments, RenderHasTheDefaultsOfTheContract) {
    const auto render = std::get<RenderArguments>(parse({"render", "a.json", "-o", "a.png"}));
    EXPECT_EQ(render.scene, "a.json");
    EXPECT_EQ(render.picture, "a.png");
    EXPECT_EQ(render.depth + render.answers + render.statistics, "");
    EXPECT_EQ(render.width, 1280);
    EXPECT_EQ(render.height, 720);
    EXPECT_EQ(render.repeat, 1);
    EXPECT_EQ(render.work.options.tolerance, 1e-6);
    EXPECT_EQ(render.work.method->name(), "proved");
    EXPECT_GE(render.work.threads, 1);
    EXPECT_FALSE(render.work.quiet);
}

TEST(Arguments, RenderTakesAllItsOptions) {
    const auto render = std::get<RenderArguments>(parse(
        {"render",  "--size",   "640x48",    "-",       "--depth",     "d.pfm",  "--answers=-",
         "--stats", "s.json",   "--repeat",  "5",       "--tolerance", "1e-12",  "--threads",
         "3",       "--method", "bisection", "--delta", "0.001",       "--quiet"}));
    EXPECT_EQ(render.scene, "-");
    EXPECT_EQ(render.picture, "");
    EXPECT_EQ(render.depth, "d.pfm");
    EXPECT_EQ(render.answers, "-");
    EXPECT_EQ(render.statistics, "s.json");
    EXPECT_EQ(render.width, 640);
    EXPECT_EQ(render.height, 48);
    EXPECT_EQ(render.repeat, 5);
    EXPECT_EQ(render.work.options.tolerance, 1e-12);
    EXPECT_EQ(render.work.options.difference_delta, 0.001);
    EXPECT_EQ(render.work.method->name(), "bisection");
    EXPECT_EQ(render.work.threads, 3);
    EXPECT_TRUE(render.work.quiet);
}

TEST(Arguments, TheEndsOfTheRangesAreInside) {
    for (const char* tolerance : {"1e-15", "0.1", ".1", "1E-3"}) {
        EXPECT_NO_THROW(parse({"trace", "a", "--tolerance", tolerance})) << tolerance;
    }
    for (const char* size : {"1x1", "32768x1", "8192x32768"}) {
        EXPECT_NO_THROW(parse({"render", "a", "-o", "b.png", "--size", size})) << size;
    }
}

// Case does not matter, and what is not a file of its own needs no suffix.
TEST(Arguments, SuffixesThatSayWhatIsWrittenAreTaken) {
    for (const char* name : {"a.png", "a.b.PNG", "-", "/dev/null", "/dev/stdout"}) {
        EXPECT_NO_THROW(parse({"render", "a", "-o", name})) << name;
    }
    for (const char* name : {"a.csv", "a.txt", "/dev/null"}) {
        EXPECT_NO_THROW(parse({"render", "a", "--answers", name})) << name;
    }
    EXPECT_NO_THROW(parse({"render", "a", "--depth", "/dev/null", "--answers", "/dev/null"}));
}

TEST(Arguments, TraceReadsStandardInputByDefault) {
    const auto trace = std::get<TraceArguments>(parse({"trace", "a.json"}));
    EXPECT_EQ(trace.scene, "a.json");
    EXPECT_EQ(trace.rays, "-");
    EXPECT_EQ(trace.work.options.tolerance, 1e-9);
    EXPECT_EQ(std::get<TraceArguments>(parse({"trace", "-", "--rays", "r.txt"})).rays, "r.txt");
}

TEST(Arguments, InfoTakesASceneOrListsMethods) {
    EXPECT_TRUE(std::get<InfoArguments>(parse({"info", "a.json", "--json"})).json);
    EXPECT_TRUE(std::get<InfoArguments>(parse({"info", "--methods"})).methods);
}

TEST(Arguments, WithoutACallTheViewerOpens) {
    EXPECT_FALSE(std::get<ViewerArguments>(parse({})).scene);
    EXPECT_EQ(std::get<ViewerArguments>(parse({"a.json"})).scene, "a.json");
}

TEST(Arguments, HelpAndVersionAreTexts) {
    for (const char* call : {"render", "trace", "info"}) {
        const std::string help = std::get<HelpText>(parse({call, "--help"})).text;
        EXPECT_NE(help.find(std::string("ivory ") + call), std::string::npos) << help;
    }
    EXPECT_NE(std::get<HelpText>(parse({"--help"})).text.find("render"), std::string::npos);
    EXPECT_EQ(std::get<HelpText>(parse({"--version"})).text.find("ivory "), 0u);
    // Help wins over what else is wrong.
    EXPECT_NO_THROW(parse({"render", "--help"}));
}

struct Wrong {
    std::vector<const char*> words;
    const char* part;  // of the line
};

class WrongUsage : public testing::TestWithParam<Wrong> {};

TEST_P(WrongUsage, IsRefusedWithOneLine) {
    try {
        parse(GetParam().words);
        FAIL() << "accepted";
    } catch (const UsageError& error) {
        const std::string line = error.what();
        EXPECT_NE(line.find(GetParam().part), std::string::npos) << line;
        EXPECT_NE(line.find("--help)"), std::string::npos) << line;
        EXPECT_EQ(line.find('\n'), std::string::npos) << line;
    }
}

INSTANTIATE_TEST_SUITE_P(
    Arguments, WrongUsage,
    testing::Values(
        Wrong{{"render"}, "SCENE is required"}, Wrong{{"trace"}, "SCENE is required"},
        Wrong{{"info"}, "SCENE is missing"}, Wrong{{"render", "a"}, "nowhere to write to"},
        Wrong{{"render", "a", "-o"}, "-o"}, Wrong{{"render", "a", "b", "-o", "c.png"}, "b"},
        Wrong{{"render", "a", "-o", "b.png", "--sise", "1x1"}, "--sise"},
        Wrong{{"render", "a", "-o", "b.png", "--samples", "8"},
              "\"8\" is not one of 1, 4, 9, 16, 25, 36, 49, 64"},
        Wrong{{"render", "a", "-o", "b.png", "--samples", "81"}, "is not one of"},
        Wrong{{"render", "a", "-o", "b.png", "--stereo", "both"}, "side-by-side or red-cyan"},
        Wrong{{"render", "a", "-o", "b.png", "--eyes", "0"}, "a distance greater than 0"},
        Wrong{{"render", "a", "-o", "b.png", "--eyes", "0.1"}, "--stereo"},
        Wrong{{"render", "a", "-o", "b.png", "--size", "10"}, "\"10\" is not WIDTHxHEIGHT"},
        Wrong{{"render", "a", "-o", "b.png", "--size", "10x"}, "WIDTHxHEIGHT"},
        Wrong{{"render", "a", "-o", "b.png", "--size", "x10"}, "WIDTHxHEIGHT"},
        Wrong{{"render", "a", "-o", "b.png", "--size", "0x10"}, "from 1 to 32768"},
        Wrong{{"render", "a", "-o", "b.png", "--size", "-1x10"}, "from 1 to 32768"},
        Wrong{{"render", "a", "-o", "b.png", "--size", "10x10x10"}, "WIDTHxHEIGHT"},
        Wrong{{"render", "a", "-o", "b.png", "--size", "32769x1"}, "from 1 to 32768"},
        Wrong{{"render", "a", "-o", "b.png", "--size", "99999999999x1"}, "WIDTHxHEIGHT"},
        Wrong{{"render", "a", "-o", "b.png", "--size", "32768x32768"}, "at most 268435456 pixels"},
        Wrong{{"render", "a", "-o", "b.png", "--tolerance", "0"}, "from 1e-15 to 0.1"},
        Wrong{{"render", "a", "-o", "b.png", "--tolerance", "0.11"}, "from 1e-15 to 0.1"},
        Wrong{{"render", "a", "-o", "b.png", "--tolerance", "9e-16"}, "from 1e-15 to 0.1"},
        Wrong{{"render", "a", "-o", "b.png", "--tolerance", "nan"}, "from 1e-15 to 0.1"},
        Wrong{{"render", "a", "-o", "b.png", "--tolerance", "1e-6m"}, "from 1e-15 to 0.1"},
        Wrong{{"render", "a", "-o", "b.png", "--tolerance", ""}, "from 1e-15 to 0.1"},
        Wrong{{"render", "a", "-o", "b.png", "--threads", "0"}, "from 1 to"},
        Wrong{{"render", "a", "-o", "b.png", "--threads", "-2"}, "from 1 to"},
        Wrong{{"render", "a", "-o", "b.png", "--threads", "2.5"}, "whole number"},
        Wrong{{"render", "a", "-o", "b.png", "--repeat", "0"}, "from 1 to"},
        Wrong{{"render", "a", "-o", "b.png", "--delta", "0"}, "greater than 0"},
        Wrong{{"render", "a", "-o", "b.png", "--delta", "inf"}, "greater than 0"},
        Wrong{{"render", "a", "-o", "b.png", "--method", "magic"}, "take proved"},
        Wrong{{"trace", "a", "--method", "magic"}, "bisection"},
        Wrong{{"render", "a", "-o", "-", "--answers", "-"}, "standard output is named for two"},
        Wrong{{"trace", "-"}, "standard input cannot be the scene and the rays"},
        Wrong{{"trace", "a", "-o", "b.png"}, "-o"},
        Wrong{{"info", "a", "--methods"}, "takes no scene"},
        Wrong{
            {"render", "a", "-o", "b.jpg"},
            "-o: \"b.jpg\" has the suffix \".jpg\", which is not written; name a file that ends in "
            ".png"},
        Wrong{{"render", "a", "-o", "b"}, "has no suffix; name a file that ends in .png"},
        Wrong{{"render", "a", "-o", "b.png.bak"}, "ends in .png"},
        Wrong{{"render", "a", "--depth", "b.exr"}, "ends in .pfm"},
        Wrong{{"render", "a", "--answers", "b.json"}, "ends in .csv or .txt"},
        Wrong{{"render", "a", "--stats", "b.csv"}, "ends in .json or .txt"},
        Wrong{{"a", "--headless", "--screenshot", "b.jpg"},
              "--screenshot: \"b.jpg\" has the suffix"},
        Wrong{{"render", "a", "--answers", "b.txt", "--stats", "./b.txt"},
              "b.txt is named for two outputs, --answers and --stats"},
        Wrong{{"-", "--headless", "--script", "-"},
              "standard input cannot be the scene and the script"},
        Wrong{{"a", "b"}, "b"}, Wrong{{"--bogus"}, "--bogus"},
        Wrong{{"render", "a", "-o", "b\n", "-o", "c.png"}, "--output"}));

}  // namespace
}  // namespace ivory
