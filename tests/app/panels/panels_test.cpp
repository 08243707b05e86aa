#include "app/panels/panels.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "app/panels/shown_text.h"
#include "app/panels/typed_number.h"
#include "core/scene/scene_fault.h"
#include "core/scene/scene_json.h"
#include "core/scene/text.h"
#include "tests/app/panels/viewer_bench.h"
#include "tests/temporary_folder.h"

namespace ivory {
namespace {

using tests::ViewerBench;

Scene figure() {
    Scene scene;
    Element point, segment, circle;
    point.skeleton = PointSkeleton{{0.5, 1.25, -0.5}};
    segment.skeleton = SegmentSkeleton{{-1.5, -0.25, 0.25}, {1, -1, 0}};
    circle.skeleton = CircleSkeleton{{0, 0.25, 0}, {0.5, 0.5, 1}, 1.25};
    scene.elements = {point, segment, circle};
    scene.camera = Camera{{3, 2, 7}, {0, 0, 0}};
    return scene;
}

Scene points(std::size_t count) {
    Scene scene;
    for (std::size_t i = 0; i < count; ++i) {
        Element element;
        element.skeleton = PointSkeleton{{0.01 * static_cast<double>(i), 0, 0}};
        scene.elements.push_back(element);
    }
    return scene;
}

// By more than the pixel that rectangles of fractions of a pixel are rounded outward by.
bool overlap(const WindowRect& a, const WindowRect& b) {
    return a.x + 1 < b.x + b.width && b.x + 1 < a.x + a.width && a.y + 1 < b.y + b.height &&
           b.y + 1 < a.y + a.height;
}

// A choice lies under its options, a list's row beside its eye.
bool may_overlap(const std::string& a, const std::string& b) {
    for (const char* choice : {"element.kernel", "camera.projection", "view.samples"})
        if (a.starts_with(choice) && b.starts_with(choice)) return true;
    return false;
}

TEST(Layout, NothingOverlapsAndNothingIsCutOff) {
    struct Case {
        WindowSize size;
        double scale;
    };
    for (const auto& [size, scale] : {Case{{1280, 720}, 1}, Case{{2560, 1440}, 2},
                                      Case{{1920, 1080}, 1.25}, Case{{1920, 1080}, 1}}) {
        for (std::size_t selected = 0; selected < 4; ++selected) {
            SCOPED_TRACE(std::to_string(size.width) + " at " + number_text(scale) + ", " +
                         std::to_string(selected));
            ViewerBench bench(figure(), size, scale);
            if (selected < 3) bench.state.document.select(selected);
            bench.turns(3);
            const auto& all = bench.state.widgets.all();
            const WindowRect window{0, 0, size.width, size.height};
            EXPECT_GT(bench.state.viewport.width, size.width / 2);
            for (auto a = all.begin(); a != all.end(); ++a) {
                const auto part = a->second.visible_part();
                if (!part) continue;
                EXPECT_TRUE(
                    window.contains({part->x + 0.5, part->y + 0.5}) &&
                    window.contains({part->x + part->width - 0.5, part->y + part->height - 0.5}))
                    << a->first;
                EXPECT_GE(part->width, a->second.rect.width - 1) << a->first << " is cut off";
                EXPECT_FALSE(overlap(*part, bench.state.viewport)) << a->first;
                for (auto b = std::next(a); b != all.end(); ++b) {
                    const auto other = b->second.visible_part();
                    if (!other || may_overlap(a->first, b->first)) continue;
                    EXPECT_FALSE(overlap(*part, *other)) << a->first << " and " << b->first;
                }
            }
        }
    }
}

TEST(Layout, ScaledByTwoItIsTheSameTwiceAsLarge) {
    WindowRect viewport, threshold;
    {
        ViewerBench small(figure());
        viewport = small.state.viewport;
        threshold = small.state.widgets.find("threshold")->rect;
    }
    ViewerBench large(figure(), {2560, 1440}, 2);
    EXPECT_EQ(large.state.viewport, (WindowRect{2 * viewport.x, 2 * viewport.y, 2 * viewport.width,
                                                2 * viewport.height}));
    EXPECT_NEAR(large.state.widgets.find("threshold")->rect.y, 2 * threshold.y, 8);
    EXPECT_NEAR(large.state.widgets.find("threshold")->rect.width, 2 * threshold.width, 4);
}

TEST(Layout, TheSmallestWindowsStillHaveAViewport) {
    for (const WindowSize size :
         {WindowSize{1, 1}, WindowSize{40, 30}, WindowSize{320, 200}, WindowSize{3000, 50}}) {
        ViewerBench bench(figure(), size);
        bench.state.document.select(2);
        bench.turns(3);
        EXPECT_GE(bench.state.viewport.width, 1);
        EXPECT_GE(bench.state.viewport.height, 1);
    }
}

TEST(Layout, TabGivesThePictureTheWholeWindow) {
    ViewerBench bench(figure());
    const WindowRect before = bench.state.viewport;
    bench.key(Key::tab);
    EXPECT_EQ(bench.state.viewport, (WindowRect{0, 0, 1280, 720}));
    EXPECT_TRUE(bench.state.widgets.all().empty());
    bench.key(Key::tab);
    EXPECT_EQ(bench.state.viewport, before);
}

TEST(Number, WhatIsTypedIsExactlyThatDouble) {
    ViewerBench bench(figure());
    bench.state.document.select(0);
    bench.turn();
    for (const double value :
         {0.1, 1.0 / 3, 0.30000000000000004, -1e-17, 123456789.12345678, 5e-324, 1e300}) {
        bench.enter("element.position.y", number_text(value));
        EXPECT_EQ(std::get<PointSkeleton>(bench.element(0).skeleton).position.y, value);
    }
    bench.enter("threshold", "0.65");
    EXPECT_EQ(bench.scene().threshold, 0.65);
}

TEST(Number, OpenedAndLeftItKeepsEveryDigit) {
    Scene scene = figure();
    scene.threshold = 0.1234567890123456;
    ViewerBench bench(scene);
    const auto before = bench.state.document.scene_value();
    bench.hold(Key::control);
    bench.click("threshold");
    bench.let(Key::control);
    bench.key(Key::enter);
    EXPECT_EQ(bench.state.document.scene_value(), before);
    EXPECT_EQ(bench.state.document.undo_name(), "Open");
}

TEST(Number, AClickOpensItAndEscapeLeavesItAsItWas) {
    ViewerBench bench(figure());
    const auto before = bench.state.document.scene_value();
    bench.click("threshold");
    bench.type("7");
    bench.key(Key::escape);
    EXPECT_EQ(bench.state.document.scene_value(), before);
    bench.click("threshold");
    bench.type("7");
    bench.key(Key::enter);
    EXPECT_EQ(bench.scene().threshold, 7);
}

TEST(Number, TheSameNumberInOtherWordsIsNoChange) {
    ViewerBench bench(figure());
    const auto before = bench.state.document.scene_value();
    // the lights are the default ones, not written out
    bench.enter("light.0.intensity", number_text(default_lights()[0].intensity) + "e0");
    EXPECT_EQ(bench.state.document.scene_value(), before);
    EXPECT_EQ(bench.state.document.undo_name(), "Open");
}

TEST(Number, FarFromTheOriginEveryDigitIsShown) {
    Scene scene = figure();
    scene.elements[0].skeleton = PointSkeleton{{4500000.5, 5100000, 300}};
    scene.camera = Camera{{4500000, 5100000, 310}, {4500000, 5100000, 300}};
    ViewerBench bench(scene);
    bench.state.document.select(0);
    bench.turns(3);
    const WindowRect x = bench.state.widgets.find("element.position.x")->rect;
    const WindowRect y = bench.state.widgets.find("element.position.y")->rect;
    EXPECT_GT(y.y, x.y);  // one below the other, each with room for
    EXPECT_GT(x.width, ImGui::CalcTextSize("-4500000.123456789").x + 14);
}

TEST(Text, WhatHasNoRoomEndsInAnEllipsis) {
    ViewerBench bench;
    const std::string text =
        "Gr\xC3\xB6\xC3\x9F"
        "e of the first ring";
    ImGui::NewFrame();
    const float whole = ImGui::CalcTextSize(text.c_str()).x;
    EXPECT_EQ(fitted_text(text, whole), text);
    for (float width = 0; width < whole; width += 3) {
        const std::string cut = fitted_text(text, width);
        EXPECT_TRUE(cut.ends_with("\xE2\x80\xA6"));
        EXPECT_FALSE(first_invalid_utf8(cut));
        if (width > 20) {
            EXPECT_LE(ImGui::CalcTextSize(cut.c_str()).x, width);
        }
    }
    ImGui::EndFrame();
}

TEST(Text, WhatNoFontDrawsIsToldApart) {
    ViewerBench bench;
    const std::string text = "C\xCE\xB1 \xF0\x9F\xA7\xAC \xE5\x8E\x9F";
    const std::string other = "C\xCE\xB1 \xF0\x9F\xA7\xAD \xE5\x8E\x9F";
    const std::string shown = shown_text(bench.state, text);
    EXPECT_EQ(shown, "C\xCE\xB1 \\u{1F9EC} \\u{539F}");
    EXPECT_NE(shown, shown_text(bench.state, other));
    EXPECT_EQ(meant_text(shown), text);
    for (const char* plain :
         {"", "\\u{", "\\u{}", "\\u{zz}", "\\u{D800}", "\\u{110000}", "\\u{41}"})
        EXPECT_EQ(meant_text(plain), plain);
}

TEST(Text, ANameThatTheFieldCannotShowIsKeptThroughEnter) {
    Scene scene = figure();
    scene.elements[0].name = "helix \xF0\x9F\xA7\xAC";
    ViewerBench bench(scene);
    bench.state.document.select(0);
    bench.turns(3);
    const auto before = bench.state.document.scene_value();
    bench.click("element.name");
    bench.key(Key::enter);
    EXPECT_EQ(bench.state.document.scene_value(), before);
    bench.click("element.name");
    bench.key(Key::end);
    bench.type(" 2");
    bench.key(Key::enter);
    EXPECT_EQ(bench.element(0).name, "helix \xF0\x9F\xA7\xAC 2");
}

TEST(Text, LettersOfOtherScriptsComeFromTheSystemsFonts) {
    ViewerBench bench;
    const std::vector<char16_t> letters = {0x05D0, 0x539F, 0x0414, 0x03B1};
    const Fonts fonts = load_fonts(1, letters);
    ASSERT_TRUE(ImGui::GetIO().Fonts->Build());
    EXPECT_TRUE(fonts.have(0x0414));
    EXPECT_TRUE(fonts.have(0x03B1));
    std::size_t from_files = 0;
    for (const FontFile& file : *fonts.files)
        for (const char16_t c : file.characters) {
            EXPECT_TRUE(fonts.have(c));
            ++from_files;
        }
    EXPECT_LE(from_files, 2u);  // of those two that the built-in typeface lacks
    EXPECT_FALSE(fonts.have(U'\U0001F9EC'));
}

TEST(Number, TabGoesToTheNext) {
    ViewerBench bench(figure());
    bench.state.document.select(0);
    bench.turn();
    bench.click("element.position.x");
    bench.type("1.5");
    bench.key(Key::tab);
    bench.type("2.5");
    bench.key(Key::tab);
    bench.type("3.5");
    bench.key(Key::enter);
    EXPECT_EQ(std::get<PointSkeleton>(bench.element(0).skeleton).position, (Vec3d{1.5, 2.5, 3.5}));
    EXPECT_FALSE(bench.state.panels_hidden);
}

TEST(Number, AClickElsewhereTakesWhatWasTyped) {
    ViewerBench bench(figure());
    bench.state.document.select(0);
    bench.turn();
    bench.click("element.position.x");
    bench.type("1.5");
    // onto a handle of the same element, which then is dragged from the new place
    const Handle handle = bench.handle("position");
    bench.move_to(handle.at);
    bench.press();
    bench.move_to({handle.at.x + 4, handle.at.y});
    bench.release();
    bench.turns(2);
    EXPECT_NEAR(std::get<PointSkeleton>(bench.element(0).skeleton).position.x, 1.5, 0.1);
    EXPECT_EQ(bench.state.document.undo_name(), "Move point 1");
}

TEST(Number, WhatNoSceneMayHoldIsRefusedWithAMessage) {
    ViewerBench bench(figure());
    bench.state.document.select(2);
    bench.turn();
    const auto before = bench.state.document.scene_value();
    for (const auto& [id, text] :
         std::vector<std::pair<std::string, std::string>>{{"threshold", "0"},
                                                          {"threshold", "-1"},
                                                          {"threshold", "nonsense"},
                                                          {"threshold", "1e999"},
                                                          {"element.strength", "0"},
                                                          {"element.width", "0"},
                                                          {"element.radius", "-1"},
                                                          {"light.0.intensity", "-0.5"}}) {
        SCOPED_TRACE(id + " " + text);
        bench.state.message = {};
        bench.enter(id, text);
        EXPECT_EQ(bench.state.document.scene_value(), before);
        EXPECT_TRUE(bench.state.message.error);
        EXPECT_FALSE(bench.state.message.text.empty());
    }
    // the next good number puts it right
    bench.enter("element.radius", "2");
    EXPECT_FALSE(bench.state.message.error);
}

TEST(Number, ItCanBeChangedByAnAmount) {
    ViewerBench bench(figure());
    bench.state.document.select(1);
    bench.turn();
    bench.enter("element.a.x", "+=1");
    EXPECT_EQ(std::get<SegmentSkeleton>(bench.element(1).skeleton).a.x, -0.5);
    bench.enter("element.a.x", "*= 3");
    EXPECT_EQ(std::get<SegmentSkeleton>(bench.element(1).skeleton).a.x, -1.5);
}

TEST(Number, ParsesWhatPeopleType) {
    EXPECT_EQ(parse_number(" 0.65 ", 0), 0.65);
    EXPECT_EQ(parse_number("0,65", 0), 0.65);
    EXPECT_EQ(parse_number("+2", 0), 2);
    EXPECT_EQ(parse_number("1e-3", 0), 1e-3);
    EXPECT_EQ(parse_number("-=0.5", 2), 1.5);
    EXPECT_EQ(parse_number("/=4", 2), 0.5);
    for (const char* text :
         {"", " ", "abc", "1.2.3", "1,2,3", "nan", "inf", "/=0", "1e999", "0.5x", "+="})
        EXPECT_EQ(parse_number(text, 1), std::nullopt) << text;
}

TEST(Number, ADragIsOneEntryAndEscapeCancelsIt) {
    ViewerBench bench(figure());
    bench.state.document.select(2);
    bench.turn();
    const auto before = bench.state.document.scene_value();
    bench.drag(bench.at("element.radius"), 50, 0);
    const double radius = std::get<CircleSkeleton>(bench.element(2).skeleton).radius;
    EXPECT_GT(radius, 1.25);
    EXPECT_EQ(bench.state.document.undo_name(), "Change radius of circle 1");
    bench.state.document.undo();
    EXPECT_EQ(bench.state.document.scene_value(), before);

    const WindowPoint at = bench.at("element.radius");
    bench.move_to(at);
    bench.press();
    bench.move_to({at.x + 30, at.y});
    EXPECT_NE(bench.state.document.scene_value(), before);
    bench.key(Key::escape);
    EXPECT_EQ(bench.state.document.scene_value(), before);
    bench.move_to({at.x + 60, at.y});
    bench.release();
    bench.turns(2);
    EXPECT_EQ(bench.state.document.scene_value(), before);
}

TEST(Threshold, TheSliderReachesFromAThousandthToBeyondTheField) {
    ViewerBench bench(figure());
    const WindowRect rect = bench.state.widgets.find("threshold.slider")->rect;
    const double y = rect.y + 0.4 * rect.height;
    const auto set_to = [&](double share) {
        bench.click(WindowPoint{rect.x + share * rect.width, y});
        return bench.scene().threshold;
    };
    EXPECT_EQ(set_to(0), 0.001);
    double before = 0;
    for (const double share : {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9}) {
        const double now = set_to(share);
        EXPECT_GT(now, before);
        before = now;
    }
    EXPECT_GE(set_to(1), 1);  // the field's greatest value is more than 1
    EXPECT_EQ(bench.state.document.undo_name(), "Change threshold");
}

TEST(Threshold, TheSliderRunsOverWhatManyElementsAddUpTo) {
    Scene scene;
    for (int i = 0; i < 3001; ++i) {
        Element element;
        element.skeleton = PointSkeleton{{0, 0, 0}};
        element.strength = 0.01;
        scene.elements.push_back(element);
    }
    scene.threshold = 10;
    ViewerBench bench(scene);
    const WindowRect rect = bench.state.widgets.find("threshold.slider")->rect;
    const double y = rect.y + 0.4 * rect.height;
    // wherever it is pressed, a pixel makes no leap
    for (double x = rect.x + 10; x < rect.x + rect.width - 10; x += 7) {
        bench.click(WindowPoint{x, y});
        const double before = bench.scene().threshold;
        bench.move_to({x, y});
        bench.press();
        EXPECT_EQ(bench.scene().threshold, before) << "a press on the knob moves nothing";
        bench.move_to({x + 1, y});
        EXPECT_GT(bench.scene().threshold, before);
        EXPECT_LT(bench.scene().threshold, 1.15 * before);
        bench.release();
    }
    bench.click(WindowPoint{rect.x + rect.width - 1.0, y});
    EXPECT_GE(bench.scene().threshold, 30);
    EXPECT_LE(bench.scene().threshold, 60);
}

TEST(Threshold, TheSliderHoldsTheThresholdThatStands) {
    for (const double threshold : {1e-9, 1e-4, 0.5, 7.0, 1e6}) {
        ViewerBench bench(figure());
        bench.enter("threshold", number_text(threshold));
        bench.turns(2);
        EXPECT_LE(bench.state.panels.thresholds.least, threshold);
        EXPECT_GE(bench.state.panels.thresholds.most, threshold);
    }
}

TEST(Threshold, TheSlidersEndsStayWhileItIsDragged) {
    ViewerBench bench(figure());
    const WindowRect rect = bench.state.widgets.find("threshold.slider")->rect;
    const ThresholdRange before = bench.state.panels.thresholds;
    bench.move_to({rect.x + 40.0, rect.y + 8.0});
    bench.press();
    for (double x = rect.x; x < rect.x + rect.width; x += 9) {
        bench.move_to({x, rect.y + 8.0});
        EXPECT_EQ(bench.state.panels.thresholds.least, before.least);
        EXPECT_EQ(bench.state.panels.thresholds.most, before.most);
    }
    bench.release();
}

TEST(Elements, EachShapeIsAddedSelectedAndValid) {
    ViewerBench bench;
    for (const char* shape : {"point", "segment", "circle", "disc"}) {
        bench.click(std::string("add.") + shape);
        ASSERT_EQ(bench.state.document.selected(), bench.scene().elements.size() - 1);
        EXPECT_EQ(std::string(shape_word(bench.scene().elements.back().skeleton)), shape);
        EXPECT_FALSE(find_fault(bench.scene()));
    }
    for (int i = 0; i < 4; ++i) bench.key(Key::z, {.control = true});
    EXPECT_TRUE(bench.scene().elements.empty());
}

TEST(Elements, ANewCirclesRadiusHasFewDigits) {
    Scene scene = figure();
    for (Element& element : scene.elements) element.width = 0.38;
    ViewerBench bench(scene);
    bench.click("add.circle");
    const std::string radius =
        number_text(std::get<CircleSkeleton>(bench.scene().elements.back().skeleton).radius);
    EXPECT_LE(radius.size(), 6u) << radius;
}

TEST(Elements, RowsSelectHideAndReorder) {
    ViewerBench bench(figure());
    bench.click("row.segment 1");
    EXPECT_EQ(bench.state.document.selected(), 1u);
    bench.click("row.segment 1.visible");
    EXPECT_FALSE(bench.element(1).visible);
    EXPECT_FALSE(bench.state.widgets.find("row.segment 1.visible")->on);
    bench.click("element.up");
    EXPECT_EQ(bench.state.document.selected(), 0u);
    EXPECT_TRUE(std::holds_alternative<SegmentSkeleton>(bench.element(0).skeleton));
    // dragged below the last one
    bench.drag(bench.at("row.segment 1"), 0,
               bench.at("row.circle 1").y - bench.at("row.segment 1").y + 4, 8);
    EXPECT_TRUE(std::holds_alternative<SegmentSkeleton>(bench.element(2).skeleton));
    EXPECT_EQ(bench.state.document.selected(), 2u);
}

TEST(Elements, RenamedByTypingButNeverToAnothersName) {
    ViewerBench bench(figure());
    bench.state.document.select(0);
    bench.turn();
    const auto rename = [&](std::string_view name) {
        bench.click("element.name");
        bench.key(Key::a, {.control = true});
        bench.type(name);
        bench.key(Key::enter);
        bench.turns(2);
    };
    rename("heart");
    EXPECT_EQ(bench.element(0).name, "heart");
    EXPECT_NE(bench.state.widgets.find("row.heart"), nullptr);
    rename("circle 1");
    EXPECT_EQ(bench.element(0).name, "heart");
    EXPECT_TRUE(bench.state.message.error);
    rename("point 1");
    EXPECT_EQ(bench.element(0).name, std::nullopt);
}

TEST(Elements, AThousandRowsAreFoundThoughFewAreDrawn) {
    ViewerBench bench(points(1000));
    std::size_t rows = 0;
    for (const auto& [id, widget] : bench.state.widgets.all()) rows += id.starts_with("row.");
    EXPECT_LE(rows, 60u);  // two controls each, as many as have room
    EXPECT_NE(bench.state.widgets.find("row.point 1000.visible"), nullptr);
    EXPECT_NE(bench.state.widgets.find("row.point 1000"), nullptr);
    EXPECT_FALSE(bench.state.widgets.find("row.point 1000")->visible_part());
    bench.state.document.select(999);
    bench.turns(3);
    EXPECT_TRUE(bench.state.widgets.find("row.point 1000")->visible_part());
}

TEST(Inspector, KernelColorAndVisibility) {
    ViewerBench bench(figure());
    bench.state.document.select(0);
    bench.turn();
    bench.click("element.kernel.wyvill");
    EXPECT_EQ(bench.element(0).kernel, KernelKind::wyvill);
    bench.click("element.visible");
    EXPECT_FALSE(bench.element(0).visible);
    bench.click("element.color");
    bench.enter("element.color.g", "0.123456789");
    EXPECT_EQ(bench.element(0).color, (Color{0.8, 0.123456789, 0.8}));
    bench.enter("element.color.r", "1.5");
    EXPECT_EQ(bench.element(0).color.x, 0.8);
    bench.key(Key::z, {.control = true});
    EXPECT_EQ(bench.element(0).color, (Color{0.8, 0.8, 0.8}));
    bench.key(Key::h);  // but plain keys are the popup's
    EXPECT_FALSE(bench.element(0).visible);
    bench.key(Key::y, {.control = true});
    EXPECT_EQ(bench.element(0).color.y, 0.123456789);
    bench.key(Key::escape);
    EXPECT_EQ(bench.state.widgets.find("element.color.r"), nullptr);
    EXPECT_EQ(bench.state.document.selected(), 0u);  // Escape was the popup's
}

TEST(Inspector, AColourTypedInHexReplacesTheOldOneOrIsRefused) {
    Scene scene = figure();
    scene.elements[0].color = {0.123456789, 0.3, 0.7000001};  // no bytes are exactly that
    ViewerBench bench(scene);
    bench.state.document.select(0);
    bench.turn();
    bench.enter("threshold", "0.6");
    bench.key(Key::z, {.control = true});
    const auto before = bench.state.document.scene_value();
    bench.click("element.color");
    bench.turns(3);
    const auto is_untouched = [&] {
        EXPECT_EQ(bench.state.document.scene_value(), before);
        EXPECT_EQ(bench.state.document.undo_name(), "Open");
        EXPECT_EQ(bench.state.document.redo_name(), "Change threshold");
    };
    bench.click("element.color.hex");
    bench.key(Key::enter);
    is_untouched();
    for (const char* wrong : {"#3366c", "red", "#3366cg", "-1-1-1", ""}) {
        SCOPED_TRACE(wrong);
        bench.state.message = {};
        bench.click("element.color.hex");
        if (*wrong == '\0') bench.key(Key::del);
        bench.type(wrong);
        bench.key(Key::enter);
        is_untouched();
        EXPECT_TRUE(bench.state.message.error);
    }
    // a click selects what stands there
    bench.click("element.color.hex");
    bench.type("#3366cc");
    bench.key(Key::enter);
    EXPECT_NEAR(bench.element(0).color.x, 0.0331, 1e-4);
    EXPECT_NEAR(bench.element(0).color.y, 0.1329, 1e-4);
    EXPECT_NEAR(bench.element(0).color.z, 0.6038, 1e-4);
    EXPECT_EQ(bench.state.document.undo_name(), "Change colour of point 1");
}

TEST(Messages, GoAfterAWhileAndGiveWayToAHint) {
    ViewerBench bench(figure());
    bench.state.say("Screenshot: figure-1.png");
    bench.turns(3 * 60);
    EXPECT_FALSE(bench.state.message.text.empty());
    bench.turns(2 * 60);
    EXPECT_TRUE(bench.state.message.text.empty());
    bench.state.say_error("it is wrong");
    bench.turns(5 * 60);
    EXPECT_FALSE(bench.state.message.text.empty());
    age_message(bench.state, 20);  // a sleep of the window's loop
    EXPECT_TRUE(bench.state.message.text.empty());
}

TEST(Lights, TheDefaultOnesAreWrittenOutWhenOneChanges) {
    ViewerBench bench(figure());
    EXPECT_FALSE(bench.scene().lights);
    bench.enter("light.1.intensity", "0.25");
    ASSERT_TRUE(bench.scene().lights);
    EXPECT_EQ((*bench.scene().lights)[1].intensity, 0.25);
    EXPECT_EQ((*bench.scene().lights)[0], default_lights()[0]);
    bench.click("light.0.delete");
    EXPECT_EQ(bench.scene().lights->size(), 1u);
    bench.click("lights.add");
    EXPECT_EQ(bench.scene().lights->size(), 2u);
    bench.click("light.1.attached");
    EXPECT_TRUE((*bench.scene().lights)[1].attached_to_camera);
}

TEST(Keys, DoWhatTheTableSays) {
    ViewerBench bench(figure());
    bench.state.document.select(0);
    bench.key(Key::h);
    EXPECT_FALSE(bench.element(0).visible);
    bench.key(Key::d, {.control = true});
    EXPECT_EQ(bench.scene().elements.size(), 4u);
    EXPECT_EQ(bench.state.document.selected(), 1u);
    bench.key(Key::del);
    EXPECT_EQ(bench.scene().elements.size(), 3u);
    bench.key(Key::z, {.control = true});
    EXPECT_EQ(bench.scene().elements.size(), 4u);
    bench.key(Key::y, {.control = true});
    EXPECT_EQ(bench.scene().elements.size(), 3u);
    bench.key(Key::z, {.control = true});
    bench.key(Key::z, {.shift = true, .control = true});
    EXPECT_EQ(bench.scene().elements.size(), 3u);

    bench.key(Key::digit3);
    EXPECT_EQ(bench.state.projection().back(), (Vec3d{1, 0, 0}));
    bench.key(Key::digit3, {.control = true});
    EXPECT_EQ(bench.state.projection().back(), (Vec3d{-1, 0, 0}));
    bench.key(Key::f);
    EXPECT_EQ(bench.state.view.camera.target,
              (Vec3d{-0.25, -0.625, 0.125}));  // the segment's middle
    bench.key(Key::f12);
    EXPECT_TRUE(bench.state.screenshot_wanted);
    bench.type("?");
    EXPECT_TRUE(bench.state.help_shown);
    bench.key(Key::escape);
    EXPECT_FALSE(bench.state.help_shown);
    EXPECT_TRUE(bench.state.document.selected());
    bench.key(Key::escape);
    EXPECT_FALSE(bench.state.document.selected());
}

TEST(Keys, WithAModifierMoreAreOtherKeys) {
    const auto press = [](ViewerBench& bench, Key modifier, Key key) {
        bench.hold(modifier);
        bench.hold(key);
        bench.let(key);
        bench.let(modifier);
        bench.turns(2);
    };
    for (const Key modifier : {Key::alt, Key::super}) {
        for (const Key key : {Key::h, Key::f, Key::s, Key::tab, Key::del, Key::escape, Key::home,
                              Key::digit1, Key::digit3, Key::digit7, Key::f12}) {
            SCOPED_TRACE(static_cast<int>(key));
            ViewerBench bench(figure());
            bench.state.document.select(0);
            bench.turn();
            const auto before = bench.state.document.scene_value();
            const Camera camera = bench.state.view.camera;
            press(bench, modifier, key);
            EXPECT_EQ(bench.state.document.scene_value(), before);
            EXPECT_EQ(bench.state.document.selected(), 0u);
            EXPECT_EQ(bench.state.view.camera, camera);
            EXPECT_TRUE(bench.state.skeleton_shown);
            EXPECT_FALSE(bench.state.panels_hidden);
            EXPECT_FALSE(bench.state.screenshot_wanted);
        }
        ViewerBench bench(figure());
        bench.hold(modifier);
        bench.type("?");
        bench.let(modifier);
        EXPECT_FALSE(bench.state.help_shown);
    }
}

TEST(Keys, BelongToATextFieldWhileItIsTypedInto) {
    ViewerBench bench(figure());
    bench.state.document.select(0);
    bench.turn();
    bench.click("element.name");
    bench.key(Key::h);
    bench.key(Key::del);
    bench.key(Key::f);
    EXPECT_TRUE(bench.element(0).visible);
    EXPECT_EQ(bench.scene().elements.size(), 3u);
}

TEST(Menus, EveryEntryCanBeReachedUnderItsMenu) {
    ViewerBench bench(figure());
    for (const char* menu : {"file", "edit", "view", "help"}) {
        bench.click(menu);
        bool any = false;
        for (const auto& [id, widget] : bench.state.widgets.all())
            any = any || (id.starts_with(std::string(menu) + ".") && widget.visible_part());
        EXPECT_TRUE(any) << menu;
        bench.click(WindowPoint{640, 600});
    }
}

TEST(Files, OpenEditSaveAndOpenAgain) {
    tests::TemporaryFolder folder;
    save_scene(figure(), folder / "figure.ivory.json");
    ViewerBench bench;
    request_open(bench.state, folder / "figure.ivory.json");
    bench.turns(3);
    EXPECT_EQ(bench.scene(), figure());
    EXPECT_EQ(bench.state.view.camera, *figure().camera);
    EXPECT_FALSE(bench.state.view.automatic);

    bench.enter("threshold", "0.75");
    bench.key(Key::s, {.control = true});
    EXPECT_FALSE(bench.state.document.dirty());
    EXPECT_EQ(read_scene(folder / "figure.ivory.json").threshold, 0.75);
}

TEST(Files, ABrokenOneChangesNothingButTheMessage) {
    tests::TemporaryFolder folder;
    std::ofstream(folder / "broken.ivory.json") << "{\"ivory\": 1, \"threshold\": }";
    ViewerBench bench(figure());
    const auto before = bench.state.document.scene_value();
    const WindowRect viewport = bench.state.viewport;
    request_open(bench.state, folder / "broken.ivory.json");
    bench.turns(3);
    EXPECT_EQ(bench.state.document.scene_value(), before);
    EXPECT_TRUE(bench.state.message.error);
    EXPECT_NE(bench.state.message.text.find("broken.ivory.json"), std::string::npos);
    EXPECT_EQ(bench.state.viewport, viewport);  // the picture stays where it is
    bench.click("error.close");
    EXPECT_TRUE(bench.state.message.text.empty());
}

TEST(Files, UnsavedChangesAreAskedAbout) {
    tests::TemporaryFolder folder;
    const auto path = folder / "figure.ivory.json";
    save_scene(figure(), path);
    ViewerBench bench;
    open_scene(bench.state, path);
    bench.turns(2);
    request_quit(bench.state);
    EXPECT_TRUE(bench.state.quit);  // nothing to ask
    bench.state.quit = false;

    bench.enter("threshold", "0.75");
    request_quit(bench.state);
    bench.turns(3);
    EXPECT_FALSE(bench.state.quit);
    bench.click("unsaved.cancel");
    EXPECT_FALSE(bench.state.quit);
    EXPECT_EQ(bench.state.widgets.find("unsaved.save"), nullptr);

    bench.key(Key::q, {.control = true});
    bench.turns(3);
    bench.click("unsaved.save");
    EXPECT_TRUE(bench.state.quit);
    EXPECT_EQ(read_scene(path).threshold, 0.75);
    bench.state.quit = false;

    bench.enter("threshold", "0.85");
    bench.key(Key::n, {.control = true});
    bench.turns(3);
    bench.click("unsaved.discard");
    EXPECT_TRUE(bench.scene().elements.empty());
    EXPECT_EQ(read_scene(path).threshold, 0.75);
    EXPECT_FALSE(bench.state.document.path());
}

TEST(Files, TheBrowserSavesUnderANewNameAndOpensAnother) {
    tests::TemporaryFolder folder;
    std::filesystem::create_directory(folder / "deeper");
    save_scene(figure(), folder / "deeper" / "figure.ivory.json");
    save_scene(points(2), folder / "points.ivory.json");
    ViewerBench bench;
    open_scene(bench.state, folder / "points.ivory.json");
    bench.turns(2);

    bench.key(Key::s, {.shift = true, .control = true});
    bench.turns(3);
    bench.type("copy");
    bench.key(Key::enter);
    bench.turns(3);
    EXPECT_EQ(bench.state.document.path(), folder / "copy.ivory.json");
    EXPECT_EQ(read_scene(folder / "copy.ivory.json").elements, points(2).elements);
    EXPECT_EQ(bench.state.widgets.find("browser.ok"), nullptr);

    bench.key(Key::o, {.control = true});
    bench.turns(3);
    EXPECT_NE(bench.state.widgets.find("browser.entry.copy.ivory.json"), nullptr);
    bench.click("browser.entry.deeper");
    bench.click("browser.ok");
    bench.click("browser.entry.figure.ivory.json");
    bench.click("browser.ok");
    EXPECT_EQ(bench.scene(), figure());
    EXPECT_EQ(bench.state.widgets.find("browser.ok"), nullptr);

    // as a script does it: the name, then the button
    bench.key(Key::s, {.shift = true, .control = true});
    bench.turns(3);
    bench.click("browser.name");
    bench.key(Key::a, {.control = true});
    bench.type("third.ivory.json");
    bench.key(Key::enter);
    bench.turns(2);
    bench.click("browser.ok");
    EXPECT_EQ(bench.state.document.path(), folder / "deeper" / "third.ivory.json");
}

// An untitled scene of two points, to be saved into a folder where other.ivory.json is another one.
class SaveAs : public testing::Test {
  protected:
    tests::TemporaryFolder folder;
    const std::filesystem::path other = folder / "other.ivory.json";
    const std::filesystem::path before_test = std::filesystem::current_path();
    std::optional<ViewerBench> kept;

    SaveAs() {
        std::filesystem::create_directory(folder / "deeper");
        save_scene(figure(), other);
        std::filesystem::current_path(folder.path());
        kept.emplace(points(2));
    }
    ~SaveAs() override { std::filesystem::current_path(before_test); }

    ViewerBench& bench() { return *kept; }
    void begin() {
        bench().key(Key::s, {.shift = true, .control = true});
        bench().turns(3);
    }
    void type_name(std::string_view name) {
        bench().type(name);
        bench().key(Key::enter);
        bench().turns(3);
    }
    [[nodiscard]] bool asked() const {
        return kept->state.widgets.find("replace.replace") != nullptr;
    }
    [[nodiscard]] bool other_stands() const {
        return read_scene(other).elements == figure().elements;
    }
    [[nodiscard]] bool replaced() const { return read_scene(other).elements == points(2).elements; }
};

TEST_F(SaveAs, EveryWayToNameAFileThatExistsAsksFirst) {
    std::filesystem::create_symlink("other.ivory.json", folder / "link.ivory.json");
    for (const std::string name :
         {"other.ivory.json", "other", "deeper/../other", "link", "link.ivory.json"}) {
        SCOPED_TRACE(name);
        begin();
        type_name(name);
        EXPECT_TRUE(asked());
        EXPECT_TRUE(other_stands());
        bench().key(Key::enter);  // which is no consent
        EXPECT_FALSE(asked());
        EXPECT_TRUE(other_stands());
        bench().key(Key::escape);
        bench().key(Key::escape);
        EXPECT_EQ(bench().state.widgets.find("browser.ok"), nullptr);
    }
    begin();
    type_name(other.string());
    EXPECT_TRUE(asked());
    bench().key(Key::escape);
    EXPECT_NE(bench().state.widgets.find("browser.ok"), nullptr);
    // the list, by button and by double click
    bench().click("browser.entry.other.ivory.json");
    bench().click("browser.ok");
    EXPECT_TRUE(asked());
    bench().click("replace.cancel");
    const WindowPoint entry = bench().at("browser.entry.other.ivory.json");
    bench().turns(60);
    bench().move_to(entry);
    for (int i = 0; i < 2; ++i) {
        bench().press();
        bench().release();
    }
    bench().turns(3);
    EXPECT_TRUE(asked());
    EXPECT_TRUE(other_stands());
    EXPECT_FALSE(bench().state.document.path());
    bench().click("replace.replace");
    EXPECT_TRUE(replaced());
    EXPECT_EQ(bench().state.document.path(), other);
    EXPECT_FALSE(bench().state.document.dirty());
    EXPECT_EQ(bench().state.widgets.find("browser.ok"), nullptr);
}

TEST_F(SaveAs, TheKeysCanReplaceToo) {
    begin();
    type_name("other");
    ASSERT_TRUE(asked());
    bench().key(Key::left);
    bench().key(Key::enter);
    EXPECT_TRUE(replaced());
    EXPECT_FALSE(bench().state.panels.dialog_open());
}

TEST_F(SaveAs, ASecondTimeTheWholeNameIsSelectedToo) {
    begin();
    type_name("first");
    EXPECT_TRUE(std::filesystem::exists(folder / "first.ivory.json"));
    begin();
    type_name("second");
    EXPECT_EQ(bench().state.document.path(), folder / "second.ivory.json");
    begin();
    type_name("other");
    ASSERT_TRUE(asked());
    bench().key(Key::escape);
    type_name("third");
    EXPECT_EQ(bench().state.document.path(), folder / "third.ivory.json");
    EXPECT_TRUE(other_stands());
}

TEST_F(SaveAs, WhatChangedWhileOneWasAskedIsAskedAboutAgain) {
    begin();
    type_name("other");
    ASSERT_TRUE(asked());
    save_scene(points(5), other);
    bench().click("replace.replace");
    EXPECT_TRUE(asked());
    EXPECT_EQ(read_scene(other).elements.size(), 5u);
    bench().click("replace.replace");
    EXPECT_TRUE(replaced());
}

TEST_F(SaveAs, FoldersAndWhatIsNoFileAreNotReplaced) {
    begin();
    type_name("deeper");
    EXPECT_EQ(bench().state.panels.browser.folder.filename(), "deeper");
    bench().key(Key::escape);
    bench().key(Key::escape);
    std::filesystem::create_directory(folder / "taken.ivory.json");
    begin();
    type_name("taken");
    EXPECT_NE(bench().state.panels.browser.fault.find("taken.ivory.json"), std::string::npos);
    EXPECT_FALSE(asked());
    EXPECT_TRUE(std::filesystem::is_directory(folder / "taken.ivory.json"));
}

TEST_F(SaveAs, TheEnterThatAnswersAQuestionNamesNoFile) {
    request_quit(bench().state);
    bench().turns(3);
    bench().key(Key::enter);  // Save: the name is asked for
    bench().turns(3);
    EXPECT_NE(bench().state.widgets.find("browser.ok"), nullptr);
    EXPECT_FALSE(bench().state.quit);
    EXPECT_FALSE(std::filesystem::exists(folder / "untitled.ivory.json"));
    bench().key(Key::enter);
    EXPECT_TRUE(std::filesystem::exists(folder / "untitled.ivory.json"));
    EXPECT_TRUE(bench().state.quit);
}

// A document of a file that another program writes to.
class Disk : public testing::Test {
  protected:
    tests::TemporaryFolder folder;
    const std::filesystem::path file = folder / "scene.ivory.json";
    ViewerBench bench;

    Disk() {
        Scene scene = figure();
        save_scene(scene, file);
        open_scene(bench.state, file);
        bench.turns(2);
        bench.enter("threshold", "0.75");
    }
    void save() {
        bench.key(Key::s, {.control = true});
        bench.turns(3);
    }
    [[nodiscard]] bool asked() const {
        return bench.state.widgets.find("changed.overwrite") != nullptr;
    }
    [[nodiscard]] double threshold() const { return read_scene(file).threshold; }
    void changed_by_another(double to) {
        Scene scene = figure();
        scene.threshold = to;
        save_scene(scene, file);
    }
};

TEST_F(Disk, WhatAnotherProgramWroteIsNotOverwrittenUnasked) {
    changed_by_another(0.25);
    save();
    EXPECT_TRUE(asked());
    EXPECT_EQ(threshold(), 0.25);
    bench.key(Key::escape);
    EXPECT_FALSE(asked());
    EXPECT_TRUE(bench.state.document.dirty());
    EXPECT_EQ(threshold(), 0.25);

    save();
    changed_by_another(0.125);  // while one is asked
    bench.click("changed.overwrite");
    EXPECT_TRUE(asked());
    EXPECT_EQ(threshold(), 0.125);
    bench.click("changed.overwrite");
    EXPECT_FALSE(asked());
    EXPECT_EQ(threshold(), 0.75);
    EXPECT_FALSE(bench.state.document.dirty());
    bench.enter("threshold", "0.5");
    save();
    EXPECT_EQ(threshold(), 0.5);  // it is one's own again
}

TEST_F(Disk, ReloadedTheEditsComeBackByUndo) {
    changed_by_another(0.25);
    save();
    bench.click("changed.reload");
    EXPECT_EQ(bench.scene().threshold, 0.25);
    EXPECT_FALSE(bench.state.document.dirty());
    bench.key(Key::z, {.control = true});
    EXPECT_EQ(bench.scene().threshold, 0.75);
    EXPECT_TRUE(bench.state.document.dirty());
    save();
    EXPECT_FALSE(asked());
    EXPECT_EQ(threshold(), 0.75);
}

TEST_F(Disk, ABrokenFileIsNotReloaded) {
    std::ofstream(file) << "{\"ivory\": 1,";
    save();
    bench.click("changed.reload");
    EXPECT_TRUE(bench.state.message.error);
    EXPECT_EQ(bench.scene().threshold, 0.75);
    EXPECT_TRUE(bench.state.document.dirty());
}

TEST_F(Disk, SavedAsAnotherTheFileStands) {
    changed_by_another(0.25);
    save();
    bench.click("changed.save_as");
    bench.turns(3);
    bench.type("mine");
    bench.key(Key::enter);
    bench.turns(3);
    EXPECT_EQ(threshold(), 0.25);
    EXPECT_EQ(read_scene(folder / "mine.ivory.json").threshold, 0.75);
    EXPECT_EQ(bench.state.document.path(), folder / "mine.ivory.json");
}

TEST_F(Disk, AnotherTimeAloneIsNoChange) {
    std::filesystem::last_write_time(
        file, std::filesystem::last_write_time(file) + std::chrono::seconds(5));
    save();
    EXPECT_FALSE(asked());
    EXPECT_EQ(threshold(), 0.75);
    // nor is the same written anew
    const Scene now = read_scene(file);
    std::filesystem::remove(file);
    save_scene(now, file);
    bench.enter("threshold", "0.5");
    save();
    EXPECT_FALSE(asked());
    EXPECT_EQ(threshold(), 0.5);
}

TEST_F(Disk, ADeletedFileIsSavedAnewWithAWord) {
    std::filesystem::remove(file);
    save();
    EXPECT_EQ(threshold(), 0.75);
    EXPECT_NE(bench.state.message.text.find("deleted"), std::string::npos);
    std::filesystem::remove_all(folder.path());
    bench.enter("threshold", "0.5");
    save();
    EXPECT_TRUE(bench.state.message.error);
    EXPECT_TRUE(bench.state.document.dirty());
}

TEST_F(Disk, OnTheWayOutItIsAskedAboutToo) {
    changed_by_another(0.25);
    request_quit(bench.state);
    bench.turns(3);
    bench.click("unsaved.save");
    EXPECT_TRUE(asked());
    EXPECT_FALSE(bench.state.quit);
    bench.click("changed.overwrite");
    EXPECT_TRUE(bench.state.quit);
    EXPECT_EQ(threshold(), 0.75);
}

TEST_F(Disk, AnotherDocumentEndsTheQuestion) {
    save();
    changed_by_another(0.25);
    save();
    ASSERT_TRUE(asked());
    save_scene(points(2), folder / "points.ivory.json");
    request_open(bench.state, folder / "points.ivory.json");
    bench.turns(3);
    EXPECT_FALSE(asked());
    EXPECT_FALSE(bench.state.panels.dialog_open());
    bench.enter("threshold", "0.5");  // nothing lies over the panels
    EXPECT_EQ(bench.scene().threshold, 0.5);
    EXPECT_EQ(threshold(), 0.25);
}

}  // namespace
}  // namespace ivory
