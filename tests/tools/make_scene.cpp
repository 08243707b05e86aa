// make_scene: a seeded random scene, on standard output.

#include <CLI/CLI.hpp>
#include <cstdio>

#include "core/scene/scene_json.h"
#include "tests/tools/random_scene.h"
#include "tests/tools/run_tool.h"

namespace {

int run(int argc, char** argv) {
    ivory::tools::SceneRecipe recipe;
    std::uint64_t seed = 1;
    bool mixed = false;
    CLI::App app("A random scene: all shapes, kernels and signs of strength.", "make_scene");
    app.add_option("--seed", seed, "same seed, same scene");
    app.add_option("--elements", recipe.elements, "how many");
    app.add_option("--scale", recipe.scale, "of all lengths");
    app.add_option("--shift", recipe.shift, "added to all coordinates, after the scale");
    app.add_flag("--critical", recipe.critical, "threshold next to a critical value of the field");
    app.add_flag("--mixed", mixed, "points, segments and circles in the unit ball, all alike");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    }
    const ivory::Scene scene = mixed ? ivory::tools::mixed_scene(recipe.elements, seed)
                                     : ivory::tools::random_scene(recipe, seed);
    std::fputs(ivory::write_scene(scene).c_str(), stdout);
    return 0;
}

}  // namespace

int main(int argc, char** argv) { return ivory::tools::run_tool("make_scene", run, argc, argv); }
