// make_degenerate: a seeded scene of a degenerate family, or its rays, on standard output.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "tests/tools/degenerate_scenes.h"
#include "tests/tools/run_tool.h"

namespace {

using namespace ivory;

int run(int argc, char** argv) {
    std::string word;
    std::uint64_t seed = 1;
    bool rays = false;
    const std::vector<std::string> words(tools::family_words.begin(), tools::family_words.end());
    CLI::App app("A scene of one shape in a degenerate position.", "make_degenerate");
    app.add_option("--family", word, "which position")->required()->check(CLI::IsMember(words));
    app.add_option("--seed", seed, "same seed, same scene and rays");
    app.add_flag("--rays", rays, "the rays in the scene's place");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    }
    const auto place = std::find(words.begin(), words.end(), word) - words.begin();
    const auto made = tools::degenerate_case(static_cast<tools::Family>(place), seed);
    std::fputs((rays ? tools::rays_text(made.rays) : tools::scene_text(made.scene)).c_str(),
               stdout);
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    return ivory::tools::run_tool("make_degenerate", run, argc, argv);
}
