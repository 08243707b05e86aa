// Every file of tests/malformed/rays is refused with the line that stands in its table, and the
// answers to the rays before that line stand.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "tests/app/cli/run_ivory.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;

fs::path folder() { return fs::path(IVORY_SOURCE_DIR) / "tests" / "malformed" / "rays"; }

// File -> what is said of it.
std::map<std::string, std::string> table() {
    std::map<std::string, std::string> lines;
    std::ifstream file(folder() / "expected.txt");
    for (std::string line; std::getline(file, line);) {
        const std::size_t colon = line.find(": ");
        if (line.starts_with('#') || colon == std::string::npos) continue;
        lines[line.substr(0, colon)] = line.substr(colon);
    }
    return lines;
}

std::vector<std::string> files() {
    std::vector<std::string> names;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder())) {
        if (entry.path().filename() != "expected.txt")
            names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
}

// Of the lines before number `bad`, those that hold a ray.
std::ptrdiff_t rays_before(const fs::path& path, int bad) {
    std::ifstream file(path);
    std::ptrdiff_t rays = 0;
    std::string line;
    for (int number = 1; number < bad && std::getline(file, line); ++number) {
        if (!line.empty() && line[0] != '#') ++rays;
    }
    return rays;
}

class MalformedRayFile : public testing::TestWithParam<std::string> {};

TEST_P(MalformedRayFile, IsRefusedWithItsLine) {
    const std::map<std::string, std::string> lines = table();
    const auto expected = lines.find(GetParam());
    ASSERT_NE(expected, lines.end()) << "no line in expected.txt";
    const fs::path path = folder() / GetParam();
    const tests::Finished run =
        tests::run_ivory({"trace", tests::scene_path("figure-1"), "--rays", path.string()});
    EXPECT_EQ(run.status, 1);
    EXPECT_EQ(run.err, "ivory: " + path.string() + expected->second + "\n");
    const int bad = std::stoi(expected->second.substr(std::string(": line ").size()));
    EXPECT_EQ(std::count(run.out.begin(), run.out.end(), '\n'), 1 + rays_before(path, bad));
}

std::string test_name(const testing::TestParamInfo<std::string>& file) {
    return file.param.substr(0, file.param.find('.'));
}

INSTANTIATE_TEST_SUITE_P(, MalformedRayFile, testing::ValuesIn(files()), test_name);

TEST(MalformedRays, EveryLineOfTheTableHasItsFile) {
    const std::vector<std::string> names = files();
    EXPECT_GE(names.size(), 20u);
    for (const auto& [name, line] : table()) {
        EXPECT_TRUE(std::binary_search(names.begin(), names.end(), name)) << name;
    }
}

}  // namespace
}  // namespace ivory
