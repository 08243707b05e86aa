// make_rays: seeded rays for a scene, ordinary and nasty ones, as ray lines in C hexadecimal on
// standard output.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "core/scene/scene_json.h"
#include "tests/tools/nasty_rays.h"
#include "tests/tools/run_tool.h"

namespace {

using namespace ivory;

int run(int argc, char** argv) {
    std::string scene_path;
    std::vector<std::string> words(tools::ray_kind_words.begin(), tools::ray_kind_words.end());
    std::size_t count = 100;
    std::uint64_t seed = 1;
    CLI::App app("Rays for a scene, ordinary and nasty ones.", "make_rays");
    app.add_option("scene", scene_path, "scene file")->required();
    app.add_option("--kinds", words, "all without it")->delimiter(',')->check(CLI::IsMember(words));
    app.add_option("--count", count, "rays of each kind");
    app.add_option("--seed", seed, "same seed, same rays");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    }
    const Scene scene = read_scene(scene_path);
    for (std::size_t i = 0; i < tools::ray_kind_words.size(); ++i) {
        const std::string word(tools::ray_kind_words[i]);
        if (std::find(words.begin(), words.end(), word) == words.end()) continue;
        const auto rays = tools::nasty_rays(scene, static_cast<tools::RayKind>(i), count, seed + i);
        std::printf("# %s: %zu\n", word.c_str(), rays.size());
        for (const Ray& ray : rays) {
            std::printf("%a %a %a %a %a %a\n", ray.origin.x, ray.origin.y, ray.origin.z,
                        ray.direction.x, ray.direction.y, ray.direction.z);
        }
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) { return ivory::tools::run_tool("make_rays", run, argc, argv); }
