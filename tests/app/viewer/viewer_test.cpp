// The whole viewer in memory, on each context: what it draws, and the script that drives it.
#include "app/viewer/viewer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "app/panels/panels.h"
#include "app/viewer/frame_texture.h"
#include "app/viewer/script.h"
#include "app/viewer/script_player.h"
#include "app/viewer/smoothing.h"
#include "app/viewer/state_file.h"
#include "core/render/camera.h"
#include "core/render/canvas.h"
#include "core/render/render.h"
#include "core/render/sampled_picture.h"
#include "core/scene/error.h"
#include "core/scene/scene_json.h"
#include "tests/app/platform/memory_contexts.h"
#include "tests/error_line.h"
#include "tests/temporary_folder.h"
#include "tests/tools/random_scene.h"

namespace ivory {
namespace {

using nlohmann::json;

const std::string figure_1 = std::string(IVORY_SOURCE_DIR) + "/assets/scenes/figure-1.ivory.json";

// A viewer in memory with figure-1, driven by lines of script.
class Driven {
  public:
    Driven(MemoryContext& context, WindowSize size)
        : context_(context), events_(size), viewer_(context, settings(wake_up_)) {
        open_scene(viewer_.state(), figure_1);
    }

    void play(const std::string& lines) { player_.play(parse_script(lines, "test")); }
    // What the script's failure says; empty: it does not fail.
    std::string failure(const std::string& lines) {
        try {
            play(lines);
            return "";
        } catch (const Error& error) {
            return error.what();
        }
    }
    Viewer& viewer() { return viewer_; }
    ViewerState& state() { return viewer_.state(); }

  private:
    static ViewerSettings settings(WakeUp& wake_up) {
        ViewerSettings settings;
        settings.threads = 2;
        settings.wake = [&wake_up] { wake_up.wake(); };
        return settings;
    }

    MemoryContext& context_;
    EventQueue events_;
    WakeUp wake_up_;
    Viewer viewer_;
    ScriptPlayer player_{viewer_, context_, events_, wake_up_, [] {}};
};

std::vector<Rgba8> colors_of(const Frame& frame, const WindowRect& rect) {
    std::vector<Rgba8> colors;
    for (int j = 0; j < rect.height; ++j)
        for (int i = 0; i < rect.width; ++i)
            colors.push_back(frame.color[frame.at(rect.x + i, rect.y + j)]);
    return colors;
}

std::vector<Rgba8> rendered(const Scene& scene, WindowSize size) {
    const Picture picture =
        make_picture(scene, size.width, size.height, *methods().front(), {.tolerance = 1e-6});
    Canvas canvas(size.width, size.height, false);
    JobSettings settings;
    settings.threads = 2;
    render(picture, canvas, settings);
    return colors_of(canvas.frame, {0, 0, size.width, size.height});
}

class InMemory : public OnEachContext {
  protected:
    // Whether the viewport, without what is drawn over it, is what `ivory render` draws.
    static bool viewport_is_render(Driven& driven) {
        driven.viewer().hide_overlay(true);
        driven.play(R"({"wait": "final"})");
        driven.viewer().hide_overlay(false);
        const WindowRect viewport = driven.state().viewport;
        return colors_of(driven.viewer().read_back(), viewport) ==
               rendered(driven.state().scene_with_view(), viewport.size());
    }
};
IVORY_ON_EACH_CONTEXT(InMemory);

TEST_P(InMemory, TheViewportIsByteForByteWhatRenderDraws) {
    const auto context = context_or_skip({760, 420});
    if (!context) return;
    Driven driven(*context, {760, 420});
    EXPECT_TRUE(viewport_is_render(driven));
}

TEST_P(InMemory, AtOtherSizesAndScalesToo) {
    const auto context = context_or_skip({760, 420});
    if (!context) return;
    Driven driven(*context, {760, 420});
    driven.play(R"({"resize": "1400x800"}
                   {"scale": 2})");
    EXPECT_TRUE(viewport_is_render(driven));
    EXPECT_EQ(driven.state().scale, 2);
    driven.play(R"({"scale": 1}
                   {"resize": "641x377"})");
    EXPECT_TRUE(viewport_is_render(driven));
    EXPECT_EQ(driven.state().window, (WindowSize{641, 377}));
    driven.play(R"({"key": "tab"})");
    EXPECT_TRUE(viewport_is_render(driven));
}

// Byte for byte what `render --samples` of that number draws, after an edit too; and with one sample again
// what it was.
TEST_P(InMemory, SeveralSamplesAPixelAreThoseOfRender) {
    const auto context = context_or_skip({1100, 1000});
    if (!context) return;
    Driven driven(*context, {1100, 1000});
    const auto expect_samples = [&](int side) {
        driven.viewer().hide_overlay(true);
        driven.play(R"({"wait": "final"}
                       {"frames": 2})");
        driven.viewer().hide_overlay(false);
        const WindowRect viewport = driven.state().viewport;
        const WindowSize size = viewport.size();
        const Picture picture = make_picture(driven.state().scene_with_view(), size.width,
                                             size.height, *find_method("proved"), {});
        Canvas canvas(size.width, size.height, false);
        SampledPicture sampled(canvas, side, false);
        JobSettings settings;
        settings.task = Task::sample;
        settings.sampled = &sampled;
        static_cast<void>(render(picture, canvas, settings));
        const std::vector<Rgba8> shown = colors_of(driven.viewer().read_back(), viewport);
        std::size_t differing = 0;
        for (std::size_t p = 0; p < shown.size(); ++p) differing += shown[p] != sampled.color[p];
        EXPECT_EQ(differing, 0u);
        std::array<std::uint64_t, 5> pixels{};
        for (const auto& tile : sampled.pixels)
            for (std::size_t status = 0; status < tile.size(); ++status)
                pixels[status] += tile[status];
        const PictureState& told = driven.state().picture;
        EXPECT_EQ(told.hit, pixels[static_cast<std::size_t>(Status::hit)]);
        EXPECT_EQ(told.miss, pixels[static_cast<std::size_t>(Status::miss)]);
    };
    EXPECT_TRUE(viewport_is_render(driven));
    driven.play(R"({"widget": "view.samples", "set": 4})");
    expect_samples(2);
    driven.play(R"({"drag": {"element": "point 1", "handle": "position", "by": [40, 10]}})");
    expect_samples(2);
    driven.play(R"({"widget": "view.samples", "set": "16"})");
    expect_samples(4);
    driven.play(R"({"widget": "view.samples", "set": 1})");
    EXPECT_TRUE(viewport_is_render(driven));
}

TEST_P(InMemory, WhatNoPictureShowsStartsNone) {
    const auto context = context_or_skip({760, 420});
    if (!context) return;
    tests::TemporaryFolder folder;
    Driven driven(*context, {760, 420});
    driven.play(R"({"select": "point 2"}
                   {"widget": "element.visible"}
                   {"wait": "final"})");
    const SessionTotals before = driven.viewer().totals();
    const PictureState picture = driven.state().picture;
    const auto scene = [&] { return driven.state().document.scene_value(); };
    const auto starts_none = [&](const std::string& line) {
        SCOPED_TRACE(line);
        const auto scene_before = scene();
        driven.play(line);
        EXPECT_TRUE(driven.viewer().final());
        driven.play("{\"frames\": 4}");
        EXPECT_EQ(driven.viewer().totals().begun, before.begun);
        EXPECT_EQ(driven.state().picture.hit, picture.hit);
        EXPECT_EQ(driven.state().picture.miss, picture.miss);
        EXPECT_EQ(driven.state().picture.milliseconds, picture.milliseconds);
        return scene() != scene_before;
    };
    EXPECT_TRUE(starts_none(R"({"widget": "element.name", "set": "hidden"})"));
    EXPECT_TRUE(starts_none(R"({"widget": "element.position.x", "set": 0.125})"));
    EXPECT_TRUE(starts_none(R"({"key": "ctrl+d"})"));
    EXPECT_TRUE(starts_none(R"({"key": "delete"})"));
    EXPECT_FALSE(starts_none(R"({"select": "point 1"})"));
    EXPECT_TRUE(starts_none(R"({"widget": "element.name", "set": "first"})"));
    EXPECT_TRUE(starts_none(R"({"key": "ctrl+z"})"));
    EXPECT_FALSE(starts_none("{\"save\": \"" + (folder / "saved.ivory.json").string() + "\"}"));
    EXPECT_FALSE(starts_none(R"({"key": "s"})"));
    driven.play(R"({"widget": "element.width", "set": 0.9})");
    EXPECT_TRUE(viewport_is_render(driven));
    EXPECT_EQ(driven.viewer().totals().begun, before.begun + 1);
}

// The last bits of the sums may differ, so that all is traced anew; nothing of it is seen.
TEST_P(InMemory, AnotherOrderIsTracedAnewButShowsNothingElseMeanwhile) {
    const auto context = context_or_skip({760, 420});
    if (!context) return;
    Driven driven(*context, {760, 420});
    driven.play(R"({"wait": "final"}
                   {"select": "point 1"})");
    const WindowRect viewport = driven.state().viewport;
    driven.viewer().hide_overlay(true);
    driven.play("{\"frames\": 1}");
    const std::vector<Rgba8> before = colors_of(driven.viewer().read_back(), viewport);
    driven.play(R"({"widget": "element.down"})");
    for (int frame = 0; frame < 400 && !driven.viewer().final(); ++frame) {
        driven.play("{\"frames\": 1}");
        const std::vector<Rgba8> now = colors_of(driven.viewer().read_back(), viewport);
        for (std::size_t p = 0; p < now.size(); ++p) {
            ASSERT_LE(std::abs(now[p].r - before[p].r), 1);
            ASSERT_LE(std::abs(now[p].g - before[p].g), 1);
            ASSERT_LE(std::abs(now[p].b - before[p].b), 1);
        }
    }
    EXPECT_TRUE(viewport_is_render(driven));
}

TEST_P(InMemory, ATinyWindowIsNoAccident) {
    const auto context = context_or_skip({400, 300});
    if (!context) return;
    Driven driven(*context, {400, 300});
    EXPECT_EQ(driven.failure(R"({"resize": "1x1"}
                                {"frames": 3}
                                {"resize": "40x400"}
                                {"wait": "final"}
                                {"resize": "400x300"}
                                {"wait": "final"})"),
              "");
}

TEST_P(InMemory, OpenGlReportsNoError) {
    const auto context = context_or_skip({1000, 700});
    if (!context) return;
    Driven driven(*context, {1000, 700});
    driven.play(R"({"wait": "final"}
                   {"theme": "light"}
                   {"scale": 1.5}
                   {"widget": "threshold", "set": 0.4}
                   {"wait": "final"})");
    EXPECT_EQ(context->gl().GetError(), gl::no_error);
}

TEST_P(InMemory, AScriptSaysWhatFailsAndWhere) {
    const auto context = context_or_skip({900, 600});
    if (!context) return;
    Driven driven(*context, {900, 600});
    EXPECT_EQ(driven.failure(R"({"expect": {"threshold": 0.55}})"), "");
    EXPECT_EQ(driven.failure("\n{\"expect\": {\"threshold\": 0.5}}"),
              "test, line 2: expected \"threshold\" to be 0.5, it is 0.55");
    EXPECT_EQ(driven.failure(R"({"expect": {"threshold": 0.5}, "within": 0.06})"), "");
    EXPECT_EQ(
        driven.failure(R"({"expect": {"nonsense": 1}})"),
        "test, line 1: expected \"nonsense\" to be 1, but neither the scene nor the state has it");
    EXPECT_EQ(driven.failure(R"({"widget": "thresold", "set": 1})"),
              "test, line 1: no control \"thresold\" is on the screen; \"threshold\" is");
    EXPECT_EQ(driven.failure(R"({"widget": "threshold", "set": "high"})"),
              "test, line 1: \"threshold\" takes a number, not \"high\"");
    EXPECT_EQ(driven.failure(R"({"widget": "edit.undo"})"),
              "test, line 1: the control \"edit.undo\" is greyed");
    driven.play(R"({"key": "escape"})");
    EXPECT_EQ(driven.failure(R"({"widget": "add.point", "set": true})"),
              "test, line 1: \"add.point\" can be clicked, not set; leave \"set\" out");
    EXPECT_NE(driven.failure(R"({"select": "nobody"})")
                  .find("no element is called \"nobody\"; there are "),
              std::string::npos);
    EXPECT_NE(
        driven.failure(R"({"drag": {"element": "point 1", "handle": "radius", "by": [1, 1]}})")
            .find("\"point 1\" has no handle \"radius\""),
        std::string::npos);
    EXPECT_NE(driven.failure(R"({"pick": [2, 2]})").find("lies outside of the picture"),
              std::string::npos);
}

TEST_P(InMemory, ANumberIsSetToTheLastBit) {
    const auto context = context_or_skip({900, 600});
    if (!context) return;
    Driven driven(*context, {900, 600});
    driven.play(R"({"widget": "threshold", "set": 0.12345678901234567}
                   {"expect": {"threshold": 0.12345678901234567}}
                   {"select": "point 1"}
                   {"widget": "element.position.x", "set": -1e-7}
                   {"expect": {"/elements/0/position/0": -1e-7, "selection": "point 1"}})");
    EXPECT_EQ(driven.state().document.scene().threshold, 0.12345678901234567);
}

TEST_P(InMemory, WhatIsScrolledAwayIsScrolledTo) {
    const auto context = context_or_skip({900, 300});
    if (!context) return;
    Driven driven(*context, {900, 300});
    driven.play(R"({"select": "point 2"}
                   {"widget": "light.1.intensity", "set": 0.25}
                   {"expect": {"/lights/1/intensity": 0.25}}
                   {"widget": "element.name", "set": "a"}
                   {"expect": {"/elements/1/name": "a"}})");
}

TEST_P(InMemory, TheStateTellsWhatTheContractAsksFor) {
    const auto context = context_or_skip({900, 600});
    if (!context) return;
    Driven driven(*context, {900, 600});
    driven.play(R"({"wait": "final"}
                   {"select": "point 2"})");
    const json state = json::parse(state_text(state_json(driven.viewer(), {})));
    const WindowRect viewport = driven.state().viewport;
    EXPECT_EQ(state["viewport"], json({viewport.x, viewport.y, viewport.width, viewport.height}));
    EXPECT_EQ(state["selection"], "point 2");
    EXPECT_TRUE(state["final"].get<bool>());
    EXPECT_EQ(state["tiles"]["traced"], state["tiles"]["total"]);
    EXPECT_EQ(state["pixels"]["hit"].get<int>() + state["pixels"]["miss"].get<int>() +
                  state["pixels"]["unresolved"].get<int>(),
              viewport.width * viewport.height);
    EXPECT_TRUE(state["widgets"].contains("threshold"));
    EXPECT_TRUE(state["handles"]["point 2"].contains("position"));
    EXPECT_EQ(state["camera"]["position"].size(), 3u);
    EXPECT_FALSE(state["milliseconds"]["frames"].empty());
    EXPECT_FALSE(state["milliseconds"]["edits"].empty());
}

TEST_P(InMemory, ABrokenFileLeavesThePictureAndSaysWhy) {
    const auto context = context_or_skip({900, 600});
    if (!context) return;
    Driven driven(*context, {900, 600});
    driven.play(R"({"wait": "final"})");
    const WindowRect viewport = driven.state().viewport;
    driven.viewer().hide_overlay(true);
    driven.play(R"({"frames": 1})");
    const auto before = colors_of(driven.viewer().read_back(), viewport);
    const std::string line =
        tests::error_line([&] { driven.play(R"({"drop": "/nonexistent.ivory.json"})"); });
    EXPECT_NE(line.find("line 1: \"/nonexistent.ivory.json\" is not there"), std::string::npos);
    EXPECT_EQ(colors_of(driven.viewer().read_back(), viewport), before);
    EXPECT_NE(driven.state().message.text.find("/nonexistent.ivory.json"), std::string::npos);
    EXPECT_TRUE(driven.state().message.error);
    EXPECT_EQ(driven.state().document.path(), std::filesystem::path(figure_1));
}

TEST_P(InMemory, WhatIsExpectedWhereNothingIsFailsWithItsLine) {
    const auto context = context_or_skip({500, 400});
    if (!context) return;
    Driven driven(*context, {500, 400});
    for (const char* where : {"/elements/99999999999999999999", "/elements/-1", "/elements/a",
                              "/elements/00x", "/threshold/0", "nothing"}) {
        const std::string line = tests::error_line(
            [&] { driven.play(R"({"expect": {")" + std::string(where) + R"(": 1}})"); });
        EXPECT_NE(line.find("line 1: expected"), std::string::npos) << line;
        EXPECT_NE(line.find("neither the scene nor the state has it"), std::string::npos) << line;
    }
    driven.play(R"({"expect": {"/elements/0/shape": "point"}})");
}

TEST_P(InMemory, AFrameIsWantedOnlyWhileSomethingChanges) {
    const auto context = context_or_skip({500, 400});
    if (!context) return;
    Driven driven(*context, {500, 400});
    driven.play(R"({"wait": "final"}
                   {"frames": 5})");
    EXPECT_LT(driven.viewer().next_frame_wanted(), 0);
}

TEST_P(InMemory, EveryStepOfADragShowsThatStepsScene) {
    const auto context = context_or_skip({160, 120});
    if (!context) return;
    Driven driven(*context, {160, 120});
    const tests::TemporaryFolder folder;
    const std::string file = folder / "hundred.ivory.json";
    constexpr std::uint64_t seed = 100;
    const Scene scene = tools::mixed_scene(100, seed);
    save_scene(scene, file);
    // the foremost of the points, which are every third element
    std::size_t front = 0;
    const auto z = [&](std::size_t i) {
        return std::get<PointSkeleton>(scene.elements[i].skeleton).position.z;
    };
    for (std::size_t i = 3; i < scene.elements.size(); i += 3)
        if (z(i) > z(front)) front = i;
    const std::string name = element_names(scene)[front];
    driven.play(R"({"drop": ")" + file + R"("}
                   {"key": "tab"}
                   {"wait": "final"})");
    driven.state().document.select(front);
    driven.play(R"({"grab": {"element": ")" + name + R"(", "handle": "position"}})");
    const auto picture = [&] {
        driven.viewer().hide_overlay(true);
        driven.play(R"({"frames": 1})");
        driven.viewer().hide_overlay(false);
        return colors_of(driven.viewer().read_back(), driven.state().viewport);
    };
    std::vector<Rgba8> before = picture();
    auto scene_before = driven.state().document.scene_value();
    for (int step = 0; step < 60; ++step) {
        driven.play(step % 20 < 10 ? R"({"move": [3, -1]})" : R"({"move": [-2, 2]})");
        std::vector<Rgba8> now = picture();
        EXPECT_NE(driven.state().document.scene_value(), scene_before) << step;
        EXPECT_EQ(driven.state().picture.scene, driven.state().document.scene_value()) << step;
        EXPECT_FALSE(now == before) << step;
        before = std::move(now);
        scene_before = driven.state().document.scene_value();
    }
    driven.play(R"({"release": "left"})");
    EXPECT_TRUE(viewport_is_render(driven));
    EXPECT_EQ(driven.state().document.undo_name(), "Move " + name);
}

// At the pace of a person, in a window far too large for the time there is: frame after frame.
TEST_P(InMemory, WhatMovesIsCalmAndWhatIsDrawnOverItIsOfItsMoment) {
    const auto context = context_or_skip({1400, 1000});
    if (!context) return;
    Driven driven(*context, {1400, 1000});
    driven.play(R"({"select": "point 1"}
                   {"wait": "final"}
                   {"grab": {"element": "point 1", "handle": "position"}})");
    std::string moves = R"({"pace": 60})";
    for (int step = 0; step < 40; ++step)
        moves += step % 20 < 10 ? "\n{\"move\": [5, -1]}" : "\n{\"move\": [-5, 1]}";
    driven.play(moves);
    const std::size_t moving = 40;
    const std::uint64_t frames_before = driven.viewer().frame_count() - moving;
    driven.play(R"({"release": "left"}
                   {"wait": "final"})");
    const auto& frames = driven.viewer().frames();
    const std::size_t first = frames.size() - (driven.viewer().frame_count() - frames_before);
    std::size_t shown = 0, held = 0;
    ASSERT_LE(first + moving, frames.size());
    for (std::size_t i = first; i < first + moving; ++i) {
        EXPECT_TRUE(frames[i].fine == 0 || frames[i].fine == 1) << frames[i].fine;
        EXPECT_EQ(frames[i].fine == 1, frames[i].resolution == 1);
        if (frames[i].handle_to_surface) {
            EXPECT_LT(*frames[i].handle_to_surface, 0.01) << i;
        }
        held += frames[i].handle_to_surface.has_value();
        shown += frames[i].age.has_value();
    }
    EXPECT_EQ(held, moving);
    EXPECT_GT(shown, 5u);
    driven.play(R"({"pace": 0})");
    EXPECT_TRUE(viewport_is_render(driven));
}

// Without a pace a frame shows its own input, whatever else the machine is doing.
TEST_P(InMemory, WithoutAPaceEveryFrameShowsItsInputInFull) {
    const auto context = context_or_skip({900, 700});
    if (!context) return;
    Driven driven(*context, {900, 700});
    driven.play(R"({"wait": "final"}
                   {"mouse": [300, 600]}
                   {"press": "left"}
                   {"move": [9, 1]})");
    for (int step = 0; step < 20; ++step) {
        driven.play(R"({"move": [4, 1]})");
        EXPECT_EQ(driven.state().picture.camera, driven.state().view.camera);
        EXPECT_EQ(driven.viewer().frames().back().resolution, 1);
        EXPECT_TRUE(driven.viewer().frames().back().age.has_value());
    }
}

// Draws the texture alone, as the viewer does.
std::vector<Rgba8> drawn(const MemoryContext& context, const FrameTexture& texture,
                         const WindowRect& viewport) {
    const WindowSize size = context.size();
    const Gl& gl = context.gl();
    gl.BindFramebuffer(gl::framebuffer, context.framebuffer());
    texture.draw(viewport, size, {1, 2, 3, 255});
    Frame frame(size.width, size.height, false);
    gl.PixelStorei(gl::pack_alignment, 1);
    gl.ReadPixels(0, 0, size.width, size.height, gl::rgba, gl::unsigned_byte, &frame.color[0]);
    std::vector<Rgba8> colors;
    for (int j = viewport.y; j < viewport.y + viewport.height; ++j)
        for (int i = viewport.x; i < viewport.x + viewport.width; ++i)
            colors.push_back(frame.color[frame.at(i, size.height - 1 - j)]);
    return colors;
}

class FrameTextures : public OnEachContext {};
IVORY_ON_EACH_CONTEXT(FrameTextures);

TEST_P(FrameTextures, PixelForPixelAndOnlyWhatChanged) {
    const auto context = context_or_skip({90, 70});
    if (!context) return;
    FrameTexture texture(context->gl());
    ShownPicture picture{{50, 40}, std::vector<Rgba8>(50 * 40), {}, {}, {}};
    for (std::size_t p = 0; p < picture.color.size(); ++p)
        picture.color[p] = {static_cast<std::uint8_t>(p), static_cast<std::uint8_t>(p * 7),
                            static_cast<std::uint8_t>(p / 50), 255};
    texture.update(picture, {.replaced = true, .all = true, .coarse = false, .tiles = {}});
    const WindowRect viewport{11, 9, 50, 40};
    EXPECT_EQ(drawn(*context, texture, viewport), picture.color);

    std::vector<Rgba8> expected = picture.color;
    const std::vector<PixelRect> tiles = {{16, 16, 32, 32}, {48, 32, 50, 40}, {32, 16, 48, 32}};
    for (Rgba8& color : picture.color) color = {200, 100, 50, 255};
    for (const PixelRect& tile : tiles)
        for (int j = tile.y0; j < tile.y1; ++j)
            for (int i = tile.x0; i < tile.x1; ++i)
                expected[static_cast<std::size_t>(j * 50 + i)] = {200, 100, 50, 255};
    texture.update(picture, {.replaced = false, .all = false, .coarse = false, .tiles = tiles});
    EXPECT_EQ(drawn(*context, texture, viewport), expected);
}

TEST_P(FrameTextures, AnotherSizeThanTheViewportStandsInItsMiddle) {
    const auto context = context_or_skip({90, 70});
    if (!context) return;
    FrameTexture texture(context->gl());
    const ShownPicture picture{{20, 10}, std::vector<Rgba8>(200, Rgba8{9, 8, 7, 255}), {}, {}, {}};
    const WindowRect viewport{5, 5, 30, 20};
    EXPECT_EQ(drawn(*context, texture, viewport), std::vector<Rgba8>(600, Rgba8{1, 2, 3, 255}));
    texture.update(picture, {.replaced = true, .all = true, .coarse = false, .tiles = {}});
    const std::vector<Rgba8> colors = drawn(*context, texture, viewport);
    for (int j = 0; j < 20; ++j)
        for (int i = 0; i < 30; ++i) {
            const bool inside = i >= 5 && i < 25 && j >= 5 && j < 15;
            EXPECT_EQ(colors[static_cast<std::size_t>(j * 30 + i)],
                      (inside ? Rgba8{9, 8, 7, 255} : Rgba8{1, 2, 3, 255}))
                << i << ", " << j;
        }
}

// A coarse picture covers the window, filtered as light; tiles of the final one come to it little by little
// and are exact in the end.
TEST_P(FrameTextures, TilesFadeInOverACoarsePicture) {
    const auto context = context_or_skip({90, 70});
    if (!context) return;
    FrameTexture texture(context->gl());
    constexpr WindowSize size{48, 32};
    const auto pixels = static_cast<std::size_t>(size.width * size.height);
    ShownPicture picture{size, std::vector<Rgba8>(pixels, Rgba8{10, 20, 30, 255}), {}, {}, {}};
    picture.fine.assign(6, 0);
    picture.coarse.step = 2;
    picture.coarse.size = coarse_size(size, 2);
    picture.coarse.color.assign(24 * 16, Rgba8{0, 100, 200, 255});
    for (std::size_t p = 0; p < picture.coarse.color.size(); ++p)
        if (p % 24 >= 12) picture.coarse.color[p] = {255, 100, 200, 255};
    texture.update(picture, {.replaced = true, .all = true, .coarse = true, .tiles = {}});
    EXPECT_FALSE(texture.fading());
    const WindowRect viewport{7, 11, size.width, size.height};
    const auto at = [&](const std::vector<Rgba8>& colors, int i, int j) {
        return colors[static_cast<std::size_t>(j * size.width + i)];
    };
    const auto expect_near = [](Rgba8 is, Rgba8 expected) {
        EXPECT_NEAR(is.r, expected.r, 2);
        EXPECT_NEAR(is.g, expected.g, 2);
        EXPECT_NEAR(is.b, expected.b, 2);
    };
    std::vector<Rgba8> colors = drawn(*context, texture, viewport);
    expect_near(at(colors, 0, 0), {0, 100, 200, 255});
    expect_near(at(colors, 47, 31), {255, 100, 200, 255});
    // a quarter and three quarters of the light of 255
    expect_near(at(colors, 23, 16), {137, 100, 200, 255});
    expect_near(at(colors, 24, 16), {225, 100, 200, 255});

    picture.fine[4] = 1;  // the middle of the lower row
    texture.update(picture, {.replaced = false, .all = false, .coarse = true, .tiles = {}});
    EXPECT_TRUE(texture.fading());
    int before = at(drawn(*context, texture, viewport), 30, 20).r;
    expect_near({static_cast<std::uint8_t>(before), 100, 200, 255}, {255, 100, 200, 255});
    int frames = 0;
    while (texture.fading() && frames < 100) {
        texture.fade(1.0 / 60);
        colors = drawn(*context, texture, viewport);
        EXPECT_LE(at(colors, 30, 20).r, before);
        EXPECT_LT(before - at(colors, 30, 20).r, 60) << "it pops";
        before = at(colors, 30, 20).r;
        expect_near(at(colors, 0, 0), {0, 100, 200, 255});
        ++frames;
    }
    EXPECT_GE(frames, 5);
    EXPECT_LE(frames, 20);
    EXPECT_EQ(at(colors, 16, 16), (Rgba8{10, 20, 30, 255}));
    EXPECT_EQ(at(colors, 31, 31), (Rgba8{10, 20, 30, 255}));

    // the next picture has every pixel: nothing of the coarse one is left
    picture.fine.assign(6, 1);
    picture.coarse = {};
    texture.update(picture, {.replaced = true, .all = false, .coarse = true, .tiles = {}});
    EXPECT_FALSE(texture.fading());
    EXPECT_EQ(drawn(*context, texture, viewport), picture.color);
}

TEST(Smoothing, GrowsUntilItsPixelsAreSmallAndInventsNoLight) {
    CoarsePicture picture;
    picture.step = 12;
    picture.size = {5, 3};
    for (int p = 0; p < 15; ++p)
        picture.color.push_back(p == 7 ? Rgba8{255, 0, 90, 255} : Rgba8{0, 0, 90, 255});
    const SmoothPicture smooth = smoothed(picture);
    EXPECT_EQ(smooth.size, (WindowSize{20, 12}));
    ASSERT_EQ(smooth.color.size(), 240u);
    double light = 0;
    for (const Rgba8& color : smooth.color) {
        EXPECT_EQ(color.g, 0);
        EXPECT_EQ(color.b, 90);
        light += std::pow(color.r / 255.0, 2.2);
    }
    EXPECT_NEAR(light, 16, 0.5);  // that of one pixel, which are 16 now
    picture.step = 3;
    EXPECT_EQ(smoothed(picture).color, picture.color);
}

TEST(RowsOfTiles, NeighboursInARowBecomeOne) {
    EXPECT_TRUE(rows_of_tiles({}).empty());
    const std::vector<PixelRect> rows = rows_of_tiles(
        {{32, 0, 48, 16}, {0, 16, 16, 32}, {0, 0, 16, 16}, {16, 0, 32, 16}, {32, 16, 48, 32}});
    EXPECT_EQ(rows, (std::vector<PixelRect>{{0, 0, 48, 16}, {0, 16, 16, 32}, {32, 16, 48, 32}}));
}

}  // namespace
}  // namespace ivory
