#include "core/scene/scene_json.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <limits>
#include <random>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/scene/json_reader.h"
#include "core/scene/scene_fault.h"
#include "tests/error_line.h"
#include "tests/temporary_folder.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;
using tests::error_line;
using tests::TemporaryFolder;

// The file format's own example.
constexpr std::string_view example = R"({
  "ivory": 1,
  "threshold": 0.55,
  "background": [0.05, 0.06, 0.08],
  "camera": {"position": [0, 0, 8], "target": [0, 0, 0], "up": [0, 1, 0], "fov": 40},
  "lights": [{"direction": [-0.4, 0.6, 0.7], "color": [1, 1, 1], "intensity": 0.8, "attached": "camera"}],
  "elements": [
    {"shape": "point",   "position": [0, 0, 0],                                  "color": [0.9, 0.2, 0.1]},
    {"shape": "segment", "a": [-1, 0, 0], "b": [1, 0, 0],                        "color": [0.1, 0.5, 0.9]},
    {"shape": "circle",  "center": [0, 0, 0], "normal": [0, 0, 1], "radius": 1.5, "color": [0.2, 0.8, 0.3]}
  ]
}
)";

Scene example_scene() {
    Scene scene;
    scene.threshold = 0.55;
    scene.background = {0.05, 0.06, 0.08};
    scene.camera = Camera{{0, 0, 8}, {0, 0, 0}, {0, 1, 0}, 40};
    scene.lights = {Light{{-0.4, 0.6, 0.7}, {1, 1, 1}, 0.8, true}};
    scene.elements = {
        {.skeleton = PointSkeleton{{0, 0, 0}}, .color = {0.9, 0.2, 0.1}},
        {.skeleton = SegmentSkeleton{{-1, 0, 0}, {1, 0, 0}}, .color = {0.1, 0.5, 0.9}},
        {.skeleton = CircleSkeleton{{0, 0, 0}, {0, 0, 1}, 1.5}, .color = {0.2, 0.8, 0.3}}};
    return scene;
}

TEST(ParseScene, ReadsAndWritesCamerasAndViews) {
    Scene scene = example_scene();
    scene.camera->projection = Camera::Projection::orthographic;
    scene.camera->height = 2.5;
    scene.views = {{"from \"above\"", {{0, 9, 0}, {0, 0, 0}, {1, 0, 0}, 30}},
                   {"side", *scene.camera}};
    EXPECT_EQ(parse_scene(write_scene(scene), "x"), scene);
    const std::string text = write_scene(scene);
    EXPECT_NE(text.find("\"projection\": \"orthographic\", \"height\": 2.5"), std::string::npos);
    // What is usual is not written.
    EXPECT_EQ(write_scene(example_scene()).find("projection"), std::string::npos);
    EXPECT_EQ(write_scene(example_scene()).find("views"), std::string::npos);
}

TEST(ParseScene, ReadsTheExampleOfTheFormat) {
    EXPECT_EQ(parse_scene(example, "x"), example_scene());
}

TEST(ParseScene, FillsInTheDefaults) {
    const Scene scene = parse_scene(
        R"({"ivory": 1.0, "threshold": 2, "elements": [{"shape": "point", "position": [1, 2, 3]}],
            "camera": {"position": [1, 2, 3], "target": [4, 5, 6]}, "lights": [{"direction": [1, 0, 0]}]})",
        "x");
    EXPECT_EQ(scene.background, (Color{0.05, 0.06, 0.08}));
    ASSERT_TRUE(scene.camera.has_value());
    EXPECT_EQ(scene.camera->up, (Vec3d{0, 1, 0}));
    EXPECT_EQ(scene.camera->fov, 40);
    ASSERT_TRUE(scene.lights.has_value());
    EXPECT_EQ(scene.lights->at(0), (Light{{1, 0, 0}, {1, 1, 1}, 1, false}));
    const Element& element = scene.elements.at(0);
    EXPECT_FALSE(element.name.has_value());
    EXPECT_EQ(element.color, (Color{0.8, 0.8, 0.8}));
    EXPECT_EQ(element.kernel, KernelKind::blinn);
    EXPECT_EQ(element.strength, 1);
    EXPECT_EQ(element.width, 1);
    EXPECT_TRUE(element.visible);
}

TEST(ParseScene, ReadsEveryKeyThatIsNotADefault) {
    const Scene scene = parse_scene(
        R"({"elements": [
              {"shape": "circle", "center": [1, 2, 3], "normal": [0, -2, 0], "radius": 0, "name": "ring",
               "kernel": "wyvill", "strength": -0.5, "width": 0.25, "visible": false, "color": [0, 0.5, 1]},
              {"shape": "segment", "a": [1, 1, 1], "b": [1, 1, 1], "kernel": "nishimura"},
              {"shape": "point", "position": [0, 0, 0], "kernel": "blinn", "visible": true}],
            "threshold": 1e-300, "ivory": 1, "background": [1, 0, 1], "lights": [
              {"direction": [0, 3, 0], "attached": "scene", "intensity": 0, "color": [0, 0, 0]}],
            "camera": {"up": [1, 0, 0], "fov": 179.9, "position": [0, 1, 0], "target": [0, 0, 0]}})",
        "x");
    EXPECT_EQ(scene.threshold, 1e-300);
    EXPECT_EQ(scene.background, (Color{1, 0, 1}));
    EXPECT_EQ(scene.camera, (Camera{{0, 1, 0}, {0, 0, 0}, {1, 0, 0}, 179.9}));
    EXPECT_EQ(scene.lights, (std::vector<Light>{{{0, 3, 0}, {0, 0, 0}, 0, false}}));
    ASSERT_EQ(scene.elements.size(), 3U);
    EXPECT_EQ(scene.elements[0], (Element{CircleSkeleton{{1, 2, 3}, {0, -2, 0}, 0},
                                          "ring",
                                          {0, 0.5, 1},
                                          KernelKind::wyvill,
                                          -0.5,
                                          0.25,
                                          {},
                                          false}));
    EXPECT_EQ(scene.elements[1].kernel, KernelKind::nishimura);
    EXPECT_EQ(scene.elements[2].kernel, KernelKind::blinn);
}

TEST(ParseScene, TheWidthOfASegmentMayTaper) {
    const auto scene_with = [](const std::string& shape, const std::string& width) {
        return R"({"ivory": 1, "threshold": 0.5, "elements": [{"shape": )" + shape +
               R"(, "width": )" + width + "}]}";
    };
    const std::string segment = R"("segment", "a": [0, 0, 0], "b": [1, 0, 0])";
    const Scene scene = parse_scene(scene_with(segment, "[0.5, 0.25]"), "scene");
    EXPECT_EQ(scene.elements[0].widths, (std::vector{0.5, 0.25}));
    EXPECT_EQ(scene.elements[0].width, 0.25);
    EXPECT_EQ(parse_scene(write_scene(scene), "scene"), scene);
    EXPECT_TRUE(parse_scene(scene_with(segment, "0.5"), "scene").elements[0].widths.empty());
    for (const char* const wrong :
         {"[0.5]", "[0.5, 0.25, 1]", "[0.5, 0]", "[0.5, -1]", "[0.5, []]", "[]", "{}"}) {
        EXPECT_THROW(static_cast<void>(parse_scene(scene_with(segment, wrong), "scene")), Error)
            << wrong;
    }
    EXPECT_THROW(static_cast<void>(parse_scene(
                     scene_with(R"("point", "position": [0, 0, 0])", "[0.5, 0.25]"), "scene")),
                 Error);
}

TEST(ParseScene, AnEmptySceneIsAScene) {
    const Scene scene =
        parse_scene(R"({"ivory": 1, "threshold": 1, "elements": [], "lights": []})", "x");
    EXPECT_TRUE(scene.elements.empty());
    EXPECT_FALSE(scene.camera.has_value());
    ASSERT_TRUE(scene.lights.has_value());  // none, which is not the default
    EXPECT_TRUE(scene.lights->empty());
}

TEST(WriteScene, PutsOneElementOnEachLine) {
    EXPECT_EQ(write_scene(example_scene()), R"({
  "ivory": 1,
  "threshold": 0.55,
  "background": [0.05, 0.06, 0.08],
  "camera": {"position": [0, 0, 8], "target": [0, 0, 0], "up": [0, 1, 0], "fov": 40},
  "lights": [
    {"direction": [-0.4, 0.6, 0.7], "color": [1, 1, 1], "intensity": 0.8, "attached": "camera"}
  ],
  "elements": [
    {"shape": "point", "position": [0, 0, 0], "color": [0.9, 0.2, 0.1]},
    {"shape": "segment", "a": [-1, 0, 0], "b": [1, 0, 0], "color": [0.1, 0.5, 0.9]},
    {"shape": "circle", "center": [0, 0, 0], "normal": [0, 0, 1], "radius": 1.5, "color": [0.2, 0.8, 0.3]}
  ]
}
)");
}

TEST(WriteScene, LeavesOutWhatIsAbsentOrTheDefault) {
    Scene scene;
    EXPECT_EQ(write_scene(scene), R"({
  "ivory": 1,
  "threshold": 0.5,
  "background": [0.05, 0.06, 0.08],
  "elements": []
}
)");
    scene.lights.emplace();
    scene.elements = {{.skeleton = PointSkeleton{},
                       .name = "a \"b\"\n",
                       .kernel = KernelKind::nishimura,
                       .strength = -2,
                       .width = 0.5,
                       .visible = false}};
    EXPECT_EQ(write_scene(scene), R"({
  "ivory": 1,
  "threshold": 0.5,
  "background": [0.05, 0.06, 0.08],
  "lights": [],
  "elements": [
    {"shape": "point", "name": "a \"b\"\n", "position": [0, 0, 0], "color": [0.8, 0.8, 0.8], "kernel": "nishimura", "strength": -2, "width": 0.5, "visible": false}
  ]
}
)");
}

TEST(WriteScene, RefusesWhatCouldNotBeReadAgain) {
    Scene scene = example_scene();
    scene.elements[2].width = std::numeric_limits<double>::infinity();
    EXPECT_EQ(
        error_line([&] { static_cast<void>(write_scene(scene)); }),
        "the scene: /elements/2/width: the width is inf; it must be greater than 0, and finite");
    const TemporaryFolder folder;
    const fs::path path = folder / "scene.ivory.json";
    EXPECT_EQ(error_line([&] { save_scene(scene, path); }),
              path.string() +
                  ": /elements/2/width: the width is inf; it must be greater than 0, and finite");
    EXPECT_TRUE(fs::is_empty(folder.path()));
}

// Every number of the scene, in order: == takes -0.0 for 0.0, bits do not.
std::vector<std::uint64_t> all_bits(const Scene& scene) {
    std::vector<std::uint64_t> bits;
    const auto number = [&](double value) { bits.push_back(std::bit_cast<std::uint64_t>(value)); };
    const auto vector = [&](const Vec3d& v) { number(v.x), number(v.y), number(v.z); };
    number(scene.threshold);
    vector(scene.background);
    if (scene.camera) {
        vector(scene.camera->position), vector(scene.camera->target), vector(scene.camera->up);
        number(scene.camera->fov);
    }
    for (const Light& light : scene.lights.value_or(std::vector<Light>{})) {
        vector(light.direction), vector(light.color), number(light.intensity);
    }
    for (const Element& element : scene.elements) {
        if (const auto* const point = std::get_if<PointSkeleton>(&element.skeleton)) {
            vector(point->position);
        } else if (const auto* const segment = std::get_if<SegmentSkeleton>(&element.skeleton)) {
            vector(segment->a), vector(segment->b);
        } else if (const auto* const circle = std::get_if<CircleSkeleton>(&element.skeleton)) {
            vector(circle->center), vector(circle->normal), number(circle->radius);
        } else if (const auto* const disc = std::get_if<DiscSkeleton>(&element.skeleton)) {
            vector(disc->center), vector(disc->normal), number(disc->radius);
        }
        vector(element.color), number(element.strength), number(element.width);
    }
    return bits;
}

// Scenes of every key, present and absent, with numbers of every size.
class RandomScenes {
  public:
    explicit RandomScenes(unsigned seed) : random_(seed) {}

    Scene next() {
        Scene scene;
        scene.threshold = positive();
        if (chance()) scene.background = color();
        if (chance()) scene.camera = camera();
        if (chance()) {
            scene.lights.emplace(random_() % 4);
            for (Light& light : *scene.lights) {
                light = {direction(), color(), std::abs(any()), chance()};
            }
        }
        scene.elements.resize(random_() % 6);
        for (std::size_t i = 0; i < scene.elements.size(); ++i) scene.elements[i] = element(i);
        return scene;
    }

  private:
    bool chance() { return random_() % 2 == 0; }

    double any() {
        switch (random_() % 6) {
            case 0:
                return chance() ? -0.0 : 0.0;
            case 1:
                return static_cast<double>(static_cast<int>(random_() % 2001) - 1000);
            case 2:
                return static_cast<double>(random_());  // beyond 2^53
            case 3:                                     // subnormal
                return std::bit_cast<double>(random_() >> 12 | (chance() ? 1ULL << 63 : 0));
            default:
                while (true) {
                    const auto value = std::bit_cast<double>(random_());
                    if (std::abs(value) < 1e300) return value;
                }
        }
    }
    double positive() {
        const double value = std::abs(any());
        return value > 0 ? value : 1;
    }
    double unit() {
        const double value = std::abs(any());
        return value <= 1 ? value : std::ldexp(static_cast<double>(random_() >> 11), -53);
    }
    Vec3d vector() { return {any(), any(), any()}; }
    Vec3d direction() {
        const Vec3d v = vector();
        return v == Vec3d{} ? Vec3d{0, -0.0, -1} : v;
    }
    Color color() { return {unit(), unit(), unit()}; }

    Camera camera() {
        while (true) {
            const Camera camera{vector(), vector(), direction(), std::min(positive(), 179.5)};
            Scene scene;
            scene.camera = camera;
            try {
                static_cast<void>(write_scene(scene));
                return camera;
            } catch (const Error&) {  // the view along `up`, most often: try another
            }
        }
    }

    std::string name(std::size_t i) {
        // The number keeps it unique.
        constexpr const char* pieces[] = {"\"",   "\\", "/",    "\n",    "\x01",
                                          "\x7f", "é",  "🦣", "\u2028"};
        std::string text = std::to_string(i);
        for (int k = 0; k < 4; ++k) text += pieces[random_() % std::size(pieces)];
        return chance() ? text : text + '\0';
    }

    Element element(std::size_t i) {
        Element element;
        switch (random_() % 4) {
            case 0:
                element.skeleton = PointSkeleton{vector()};
                break;
            case 1:
                element.skeleton = SegmentSkeleton{vector(), vector()};
                break;
            case 2:
                element.skeleton = CircleSkeleton{vector(), direction(), std::abs(any())};
                break;
            default:
                element.skeleton = DiscSkeleton{vector(), direction(), std::abs(any())};
        }
        if (chance()) element.name = name(i);
        if (chance()) element.color = color();
        element.kernel = static_cast<KernelKind>(random_() % kernel_count);
        if (chance()) element.strength = chance() ? positive() : -positive();
        if (chance()) element.width = positive();
        element.visible = chance();
        return element;
    }

    std::mt19937_64 random_;
};

TEST(SceneJson, WritingAndReadingGivesTheSameSceneToTheLastBit) {
    const unsigned seed = std::random_device{}();
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomScenes scenes(seed);
    for (int i = 0; i < 1500; ++i) {
        const Scene scene = scenes.next();
        const std::string text = write_scene(scene);
        const Scene again = parse_scene(text, "x");
        ASSERT_EQ(again, scene) << text;
        ASSERT_EQ(all_bits(again), all_bits(scene)) << text;
        ASSERT_EQ(write_scene(again), text);
    }
}

TEST(SceneJson, SavingAndReadingAFileGivesTheSameScene) {
    const TemporaryFolder folder;
    const fs::path path = folder / "scène 1.ivory.json";
    save_scene(example_scene(), path);
    EXPECT_EQ(read_scene(path), example_scene());
    save_scene(Scene{}, path);
    EXPECT_EQ(read_scene(path), Scene{});
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1);
}

TEST(SceneJson, EveryShippedSceneReadsAndRoundTrips) {
    for (const auto& entry :
         fs::directory_iterator(fs::path(IVORY_SOURCE_DIR) / "assets" / "scenes")) {
        if (!entry.path().string().ends_with(".ivory.json")) continue;
        SCOPED_TRACE(entry.path().filename().string());
        const Scene scene = read_scene(entry.path());
        EXPECT_EQ(parse_scene(write_scene(scene), "x"), scene);
    }
}

// A run with standard input from a file, then put back.
template <class Call>
void with_standard_input(const fs::path& path, Call&& call) {
    const int saved = ::dup(STDIN_FILENO);
    ASSERT_NE(std::freopen(path.c_str(), "rb", stdin), nullptr);
    call();
    ASSERT_GE(::dup2(saved, STDIN_FILENO), 0);
    ::close(saved);
    std::clearerr(stdin);
}

TEST(ParseCamera, ReadsWhatWriteCameraWritesBitForBit) {
    Camera camera{{0.1, -1.0 / 3, 1e300}, {5e-324, 0, 2}, {0, 0.3, 1}, 179.9};
    for (const auto projection :
         {Camera::Projection::perspective, Camera::Projection::orthographic}) {
        camera.projection = projection;
        const std::string text = write_camera(camera);
        EXPECT_EQ(parse_camera(text, "text"), camera);
        EXPECT_EQ(text.find('\n'), std::string::npos);
        // as it stands in a scene
        Scene scene;
        scene.camera = camera;
        EXPECT_NE(write_scene(scene).find("\"camera\": " + text), std::string::npos);
        camera.height = 0.1;
    }
    EXPECT_EQ(write_camera({{0, 0, 8}, {0, 0, 0}}),
              R"({"position": [0, 0, 8], "target": [0, 0, 0], "up": [0, 1, 0], "fov": 40})");
}

TEST(ParseCamera, SaysWhatIsWrongAndWhere) {
    const auto said = [](const char* text) {
        return tests::error_line([&] { static_cast<void>(parse_camera(text, "it")); });
    };
    EXPECT_TRUE(said("").starts_with("it: "));
    EXPECT_NE(said("[1]").find("an object with position and target"), std::string::npos);
    EXPECT_NE(said(R"({"position": [0, 0, 1]})").find("target"), std::string::npos);
    EXPECT_NE(said(R"({"position": [0, 0, 1], "target": [0, 0, 0], "fov": 200})").find("/fov"),
              std::string::npos);
    EXPECT_NE(tests::error_line([] {
                  static_cast<void>(write_camera({{1, 1, 1}, {1, 1, 1}}));
              }).find("the camera"),
              std::string::npos);
}

TEST(ReadScene, ADashIsStandardInput) {
    const TemporaryFolder folder;
    std::ofstream(folder / "good") << example;
    std::ofstream(folder / "bad") << "{\"ivory\": 1}";
    with_standard_input(folder / "good", [] { EXPECT_EQ(read_scene("-"), example_scene()); });
    with_standard_input(folder / "bad", [] {
        EXPECT_EQ(
            error_line([] { static_cast<void>(read_scene("-")); }),
            "standard input: line 1, column 1: the key \"threshold\" is missing; a scene needs "
            "ivory, threshold and elements");
    });
}

TEST(ReadScene, MessagesShowTheFileNameOnOneLine) {
    EXPECT_EQ(
        error_line([] { static_cast<void>(parse_scene("", "a\nb\x1b[31m")); }),
        "a\\nb\\x1b[31m: line 1, column 1: the file is empty; the least scene is {\"ivory\": 1, "
        "\"threshold\": 0.5, \"elements\": []}");
    const TemporaryFolder folder;
    const fs::path path = folder / "two\nlines";
    std::ofstream(path) << "nonsense";
    EXPECT_TRUE(
        error_line([&] {
            static_cast<void>(read_scene(path));
        }).starts_with(folder.path().string() + "/two\\nlines: line 1, column 2: not JSON"));
}

TEST(ParseScene, TenThousandElementsWithNamesTakeNoQuadraticTime) {
    Scene scene;
    for (int i = 0; i < 10'000; ++i) {
        scene.elements.push_back(
            {.skeleton = PointSkeleton{{double(i), 0, 0}}, .name = "atom " + std::to_string(i)});
    }
    EXPECT_EQ(parse_scene(write_scene(scene), "x"), scene);
    scene.elements.back().name = "atom 5";
    EXPECT_EQ(
        error_line([&] { static_cast<void>(write_scene(scene)); }),
        "the scene: /elements/9999/name: the name \"atom 5\" is also that of /elements/5; each "
        "element must have a name of its own");
}

TEST(ParseScene, LooksAtTheStopWhileElementsAreTaken) {
    constexpr std::size_t pieces = 5;
    Scene scene;
    scene.elements.resize(pieces * values_between_looks);
    const std::string text = write_scene(scene);
    const auto looks_of = [](const auto& job) {
        std::size_t looks = 0;
        job([&] { ++looks; });
        return looks;
    };
    const std::size_t parsing = looks_of(
        [&](const Stop& stop) { static_cast<void>(parse_json(SourceText(text, "x"), stop)); });
    const std::size_t checking =
        looks_of([&](const Stop& stop) { static_cast<void>(find_fault(scene, stop)); });
    const std::size_t all =
        looks_of([&](const Stop& stop) { static_cast<void>(parse_scene(text, "x", stop)); });
    EXPECT_GE(all, parsing + pieces + checking);
}

}  // namespace
}  // namespace ivory
