// The layers of the source tree, as its #includes and its CMake lists tell them: a folder includes
// itself and folders below it, core needs nothing but the standard library to be used, and every
// file is built.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace {

namespace fs = std::filesystem;

// From the lowest to the highest; "app" itself holds main.cpp.
constexpr std::array<std::string_view, 15> layers = {
    "core/math",  "core/interval", "core/kernel", "core/shape",   "core/scene",
    "core/field", "core/trace",    "core/render", "app/platform", "app/document",
    "app/shape",  "app/panels",    "app/viewer",  "app/cli",      "app",
};

struct Include {
    std::string path;
    bool quoted;
};

// Path from the repository's root -> what the file includes.
using Tree = std::map<std::string, std::vector<Include>>;
using Complaints = std::vector<std::string>;

bool is_header(const std::string& path) { return path.ends_with(".h"); }
bool is_source(const std::string& path) { return path.ends_with(".cpp"); }
// Included by sources alone, once for each instruction set.
bool is_part_of_sources(const std::string& path) { return path.ends_with(".inl"); }

const fs::path& root() {
    static const fs::path path = IVORY_SOURCE_DIR;
    return path;
}

std::vector<std::string> files_under(const std::string& folder) {
    std::vector<std::string> paths;
    for (const auto& entry : fs::recursive_directory_iterator(root() / folder))
        if (entry.is_regular_file())
            paths.push_back(entry.path().lexically_relative(root()).generic_string());
    std::sort(paths.begin(), paths.end());
    return paths;
}

// The lines `#include "path"` and `#include <path>`.
std::vector<Include> includes_in(std::istream& text) {
    static const std::regex directive(R"(^\s*#\s*include\s*(["<])([^">]+)[">])");
    std::vector<Include> includes;
    std::smatch match;
    for (std::string line; std::getline(text, line);)
        if (std::regex_search(line, match, directive))
            includes.push_back({match.str(2), match.str(1) == "\""});
    return includes;
}

const Tree& source_tree() {
    static const Tree tree = [] {
        Tree read;
        for (const char* folder : {"core", "app"})
            for (const std::string& path : files_under(folder))
                if (is_header(path) || is_source(path) || is_part_of_sources(path)) {
                    std::ifstream text(root() / path);
                    read[path] = includes_in(text);
                }
        return read;
    }();
    return tree;
}

// Place in `layers` of the file's first two folders; layers.size() for a folder that is not there.
std::size_t layer_of(const std::string& path) {
    const std::size_t first = path.find('/');
    const std::size_t second = path.find('/', first + 1);
    const std::string folder = path.substr(0, second == std::string::npos ? first : second);
    return static_cast<std::size_t>(std::find(layers.begin(), layers.end(), folder) -
                                    layers.begin());
}

Complaints outside_the_layers(const Tree& tree) {
    Complaints found;
    for (const auto& [file, includes] : tree)
        if (layer_of(file) == layers.size()) found.push_back(file + " is in no layer");
    return found;
}

Complaints upward_includes(const Tree& tree) {
    Complaints found;
    for (const auto& [file, includes] : tree)
        for (const Include& include : includes)
            if (include.quoted && tree.contains(include.path) &&
                layer_of(include.path) > layer_of(file))
                found.push_back(file + " includes " + include.path + " of a higher layer");
    return found;
}

// "core/..." and "app/..." are written in full and in quotes, and nothing else is in quotes.
Complaints unknown_includes(const Tree& tree) {
    Complaints found;
    for (const auto& [file, includes] : tree)
        for (const Include& include : includes) {
            if (include.quoted && !tree.contains(include.path))
                found.push_back(file + " includes \"" + include.path +
                                "\", which is no file of core or app");
            if (!include.quoted && tree.contains(include.path))
                found.push_back(file + " includes <" + include.path + "> without quotes");
        }
    return found;
}

// Whoever uses ivory::core needs its headers and the standard library's, whose names have no dot.
Complaints foreign_headers_in_core(const Tree& tree) {
    Complaints found;
    for (const auto& [file, includes] : tree)
        if (file.starts_with("core/") && is_header(file))
            for (const Include& include : includes)
                if (!include.quoted && include.path.find_first_of("./") != std::string::npos)
                    found.push_back(file + " includes <" + include.path +
                                    ">, which users of ivory::core may not have");
    return found;
}

// Depth first; `chain` holds the files from the start to here, `done` those that lead to no cycle.
void search_cycle(const Tree& tree, const std::string& file, std::vector<std::string>& chain,
                  std::set<std::string>& done, Complaints& found) {
    const auto seen = std::find(chain.begin(), chain.end(), file);
    if (seen != chain.end()) {
        std::string cycle;
        for (auto link = seen; link != chain.end(); ++link) cycle += *link + " -> ";
        found.push_back(cycle + file);
        return;
    }
    const auto node = tree.find(file);
    if (node == tree.end() || done.contains(file)) return;
    chain.push_back(file);
    for (const Include& include : node->second) {
        if (include.quoted) search_cycle(tree, include.path, chain, done, found);
    }
    chain.pop_back();
    done.insert(file);
}

Complaints include_cycles(const Tree& tree) {
    Complaints found;
    std::set<std::string> done;
    for (const auto& [file, includes] : tree) {
        std::vector<std::string> chain;
        search_cycle(tree, file, chain, done, found);
    }
    return found;
}

// Every path that a CMakeLists.txt below the folder names, from the repository's root.
std::set<std::string> listed_under(const std::string& folder) {
    std::set<std::string> listed;
    for (const std::string& path : files_under(folder)) {
        if (fs::path(path).filename() != "CMakeLists.txt") continue;
        std::ifstream text(root() / path);
        std::string word;
        while (text >> word) {
            word.erase(word.find_last_not_of(')') + 1);
            listed.insert(
                (fs::path(path).parent_path() / word).lexically_normal().generic_string());
        }
    }
    return listed;
}

std::string joined(const Complaints& complaints) {
    std::string lines;
    for (const std::string& complaint : complaints) lines += complaint + "\n";
    return lines;
}

TEST(Layering, EveryFileIsInALayer) { EXPECT_EQ(joined(outside_the_layers(source_tree())), ""); }

TEST(Layering, NoFileIncludesAHigherLayer) {
    EXPECT_EQ(joined(upward_includes(source_tree())), "");
}

TEST(Layering, QuotedIncludesArePathsFromTheRoot) {
    EXPECT_EQ(joined(unknown_includes(source_tree())), "");
}

TEST(Layering, HeadersOfCoreNeedOnlyTheStandardLibrary) {
    EXPECT_EQ(joined(foreign_headers_in_core(source_tree())), "");
}

// from_core.cpp, the tests and what they are made of know both.
TEST(Layering, TheRefereeHasNothingOfCoreButTheTypeOfThreeCoordinates) {
    for (const std::string& path : files_under("tests/reference")) {
        if (!is_header(path) && !is_source(path)) continue;
        if (path.ends_with("_test.cpp") || path.ends_with("/from_core.cpp")) continue;
        std::ifstream text(root() / path);
        for (const Include& include : includes_in(text)) {
            if (!include.quoted || include.path == "core/math/vec3.h") continue;
            EXPECT_TRUE(include.path.starts_with("tests/reference/")) << path << include.path;
        }
    }
}

TEST(Layering, IncludesHaveNoCycle) { EXPECT_EQ(joined(include_cycles(source_tree())), ""); }

// A source that is not listed is never built; a header of core that is not listed is not installed.
TEST(Layering, EveryFileIsListedInCMake) {
    Complaints found;
    for (const char* folder : {"core", "app", "tests"}) {
        const std::set<std::string> listed = listed_under(folder);
        for (const std::string& path : files_under(folder))
            if ((is_source(path) || (is_header(path) && path.starts_with("core/"))) &&
                !listed.contains(path))
                found.push_back(path + " is in no list of CMake");
    }
    EXPECT_EQ(joined(found), "");
}

TEST(Layering, IncludesAreReadInEverySpelling) {
    std::istringstream text(
        "#include \"core/math/vec3.h\"\n"
        "  #  include   <cmath>  // why\n"
        "#include<png.h>\n"
        "// #include \"core/no.h\"\n"
        "#define X \"core/no.h\"\n"
        "#include X\n");
    const std::vector<Include> includes = includes_in(text);
    ASSERT_EQ(includes.size(), 3u);
    EXPECT_EQ(includes[0].path, "core/math/vec3.h");
    EXPECT_TRUE(includes[0].quoted);
    EXPECT_EQ(includes[1].path, "cmath");
    EXPECT_FALSE(includes[1].quoted);
    EXPECT_EQ(includes[2].path, "png.h");
}

TEST(Layering, EveryKindOfViolationIsFound) {
    EXPECT_EQ(joined(outside_the_layers({{"core/util/x.h", {}}, {"core/x.h", {}}})),
              "core/util/x.h is in no layer\ncore/x.h is in no layer\n");
    const Tree upward = {
        {"app/cli/a.h", {}},
        {"app/main.cpp", {{"app/cli/a.h", true}}},
        {"core/field/f.h", {}},
        {"core/interval/i.h", {{"core/field/f.h", true}}},
        {"core/trace/methods/m.h", {{"core/trace/t.h", true}, {"app/cli/a.h", true}}},
        {"core/trace/t.h", {{"core/trace/methods/m.h", true}}},
    };
    EXPECT_EQ(joined(upward_includes(upward)),
              "core/interval/i.h includes core/field/f.h of a higher layer\n"
              "core/trace/methods/m.h includes app/cli/a.h of a higher layer\n");
    EXPECT_EQ(joined(include_cycles(upward)),
              "core/trace/methods/m.h -> core/trace/t.h -> core/trace/methods/m.h\n");
    EXPECT_EQ(joined(unknown_includes({{"core/math/a.h", {{"b.h", true}, {"core/math/b.h", false}}},
                                       {"core/math/b.h", {}}})),
              "core/math/a.h includes \"b.h\", which is no file of core or app\n"
              "core/math/a.h includes <core/math/b.h> without quotes\n");
    EXPECT_EQ(joined(foreign_headers_in_core({{"core/render/a.h", {{"png.h", false}}},
                                              {"core/render/b.cpp", {{"png.h", false}}},
                                              {"core/render/c.h", {{"vector", false}}}})),
              "core/render/a.h includes <png.h>, which users of ivory::core may not have\n");
}

}  // namespace
