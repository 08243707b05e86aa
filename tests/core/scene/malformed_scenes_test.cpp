// Every file of tests/malformed/scenes is refused with the line that stands in its table.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "core/scene/scene_json.h"
#include "tests/error_line.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;

fs::path folder() { return fs::path(IVORY_SOURCE_DIR) / "tests" / "malformed" / "scenes"; }

// File, below the folder -> what is said of it.
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
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder())) {
        if (entry.is_regular_file() && entry.path().filename() != "expected.txt") {
            names.push_back(entry.path().lexically_relative(folder()).generic_string());
        }
    }
    std::sort(names.begin(), names.end());
    return names;
}

class MalformedScene : public testing::TestWithParam<std::string> {};

TEST_P(MalformedScene, IsRefusedWithItsLine) {
    const std::map<std::string, std::string> lines = table();
    const auto expected = lines.find(GetParam());
    ASSERT_NE(expected, lines.end()) << "no line in expected.txt";
    const fs::path path = folder() / GetParam();
    EXPECT_EQ(tests::error_line([&] { static_cast<void>(read_scene(path)); }),
              path.string() + expected->second);
}

std::string test_name(const testing::TestParamInfo<std::string>& file) {
    std::string name = file.param.substr(0, file.param.find('.'));
    std::replace(name.begin(), name.end(), '/', '_');
    return name;
}

INSTANTIATE_TEST_SUITE_P(, MalformedScene, testing::ValuesIn(files()), test_name);

TEST(MalformedScenes, AreManyAndEachLineOfTheTableHasItsFile) {
    const std::vector<std::string> names = files();
    EXPECT_GE(names.size(), 64U);
    for (const auto& [name, line] : table()) {
        EXPECT_TRUE(std::binary_search(names.begin(), names.end(), name)) << name;
        EXPECT_TRUE(line.find("; ") != std::string::npos ||
                    line.find(" must ") != std::string::npos)
            << name << " has no remedy" << line;
    }
}

}  // namespace
}  // namespace ivory
