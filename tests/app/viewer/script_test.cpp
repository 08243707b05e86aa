// The script language: every step is read, and what is wrong is said with its line.
#include "app/viewer/script.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <variant>

#include "core/scene/error.h"
#include "tests/error_line.h"
#include "tests/temporary_folder.h"

namespace ivory {
namespace {

template <class Step>
Step only_step(const std::string& line) {
    const Script script = parse_script(line, "test");
    EXPECT_EQ(script.lines.size(), 1u) << line;
    return std::get<Step>(script.lines.at(0).step);
}

TEST(Script, CommentsAndBlankLinesAreCountedAndPassedOver) {
    const Script script = parse_script("# one\n\n  \t# three\r\n{\"wait\": \"final\"}\n", "test");
    ASSERT_EQ(script.lines.size(), 1u);
    EXPECT_EQ(script.lines[0].number, 4);
    EXPECT_TRUE(std::holds_alternative<step::WaitFinal>(script.lines[0].step));
}

TEST(Script, EveryStepOfTheContractIsRead) {
    EXPECT_EQ(only_step<step::Pace>(R"({"pace": 60})").per_second, 60);
    EXPECT_EQ(only_step<step::Pace>(R"({"pace": 0})").per_second, 0);
    EXPECT_EQ(only_step<step::Frames>(R"({"frames": 3})").count, 3);
    EXPECT_EQ(only_step<step::Mouse>(R"({"mouse": [10, 20.5]})").at, (WindowPoint{10, 20.5}));
    EXPECT_EQ(only_step<step::Press>(R"({"press": "left"})").button, MouseButton::left);
    EXPECT_EQ(only_step<step::Release>(R"({"release": "middle"})").button, MouseButton::middle);
    EXPECT_EQ(only_step<step::DoubleClick>(R"({"double_click": "right"})").button,
              MouseButton::right);
    EXPECT_EQ(only_step<step::Wheel>(R"({"wheel": -1})").steps, -1);
    EXPECT_EQ(only_step<step::Hold>(R"({"hold": "shift"})").key, Key::shift);
    EXPECT_EQ(only_step<step::Let>(R"({"let": "shift"})").key, Key::shift);
    EXPECT_EQ(only_step<step::Type>(R"({"type": "0.65"})").text, U"0.65");
    EXPECT_EQ(only_step<step::UseWidget>(R"({"widget": "threshold", "set": 0.7})").value, 0.7);
    EXPECT_FALSE(only_step<step::UseWidget>(R"({"widget": "edit.undo"})").value.has_value());
    EXPECT_EQ(only_step<step::Pick>(R"({"pick": [1, 2]})").at, (WindowPoint{1, 2}));
    EXPECT_EQ(only_step<step::Select>(R"({"select": "point 1"})").name, "point 1");
    const auto drag =
        only_step<step::Drag>(R"({"drag": {"element": "e", "handle": "position", "by": [3, -4]}})");
    EXPECT_EQ(drag.grab.element, "e");
    EXPECT_EQ(drag.grab.handle, "position");
    EXPECT_EQ(drag.by, (WindowPoint{3, -4}));
    EXPECT_EQ(only_step<step::Drag>(R"({"drag": {"element": "e", "handle": 2, "by": [0, 0]}})")
                  .grab.handle,
              "2");
    EXPECT_EQ(only_step<step::Grab>(R"({"grab": {"element": "e", "handle": "a"}})").handle, "a");
    EXPECT_EQ(only_step<step::Move>(R"({"move": [5, -6]})").by, (WindowPoint{5, -6}));
    EXPECT_EQ(only_step<step::MouseTo>(R"({"mouse": "threshold"})").widget, "threshold");
    EXPECT_EQ(only_step<step::Drop>(R"({"drop": "a.json"})").file, "a.json");
    EXPECT_EQ(only_step<step::Resize>(R"({"resize": "640x480"})").size, (WindowSize{640, 480}));
    EXPECT_EQ(only_step<step::Scale>(R"({"scale": 2})").scale, 2);
    EXPECT_EQ(only_step<step::SetTheme>(R"({"theme": "light"})").theme, Theme::light);
    const auto expect =
        only_step<step::Expect>(R"({"expect": {"threshold": 0.7}, "within": 1e-9})");
    ASSERT_EQ(expect.expectations.size(), 1u);
    EXPECT_EQ(expect.expectations[0].where, "threshold");
    EXPECT_EQ(expect.within, 1e-9);
    EXPECT_EQ(only_step<step::Save>(R"({"save": "s.json"})").file, "s.json");
    EXPECT_EQ(only_step<step::WriteState>(R"({"state": "s.json"})").file, "s.json");
    EXPECT_FALSE(only_step<step::Screenshot>(R"({"screenshot": "s.png"})").viewport);
    EXPECT_TRUE(
        only_step<step::Screenshot>(R"({"screenshot": "s.png", "viewport": true})").viewport);
}

TEST(Script, ChordsHaveModifiersAKeyAndItsCharacter) {
    const auto chord = [](const std::string& keys) {
        return only_step<step::KeyStroke>(R"({"key": ")" + keys + R"("})").chord;
    };
    EXPECT_EQ(chord("ctrl+shift+z").modifiers, (Modifiers{.shift = true, .control = true}));
    EXPECT_EQ(chord("ctrl+shift+z").key, Key::z);
    EXPECT_EQ(chord("ctrl+z").character, U'\0');
    EXPECT_EQ(chord("x").character, U'x');
    EXPECT_EQ(chord("shift+x").character, U'X');
    EXPECT_EQ(chord("?").character, U'?');
    EXPECT_EQ(chord("f12").key, Key::f12);
    EXPECT_EQ(chord("7").key, Key::digit7);
    EXPECT_EQ(chord("home").key, Key::home);
    EXPECT_EQ(chord("escape").character, U'\0');
}

TEST(Script, CharactersOfUtf8) {
    EXPECT_EQ(characters_of("a\xC3\xA4\xE2\x82\xAC\xF0\x9F\x98\x80"), U"a\u00E4\u20AC\U0001F600");
    EXPECT_THROW(static_cast<void>(characters_of("\xFF")), Error);
}

struct Wrong {
    const char* line;
    const char* message;
};

class WrongSteps : public testing::TestWithParam<Wrong> {};

TEST_P(WrongSteps, AreRefusedWithTheirLine) {
    try {
        static_cast<void>(parse_script(std::string("# first\n") + GetParam().line, "s.txt"));
        FAIL() << GetParam().line;
    } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()).find("s.txt, line 2: "), 0u) << error.what();
        EXPECT_NE(std::string(error.what()).find(GetParam().message), std::string::npos)
            << error.what();
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
}

// Deeper than any stack is high, wherever a step may hold a value.
TEST(Script, BracketsThatNestTooDeepAreRefused) {
    const std::string deep = std::string(200000, '[') + std::string(200000, ']');
    for (const std::string& line :
         {"{\"wait\": " + deep + "}", "{\"expect\": {\"threshold\": " + deep + "}}",
          "{\"widget\": \"threshold\", \"set\": " + deep + "}", std::string(200000, '[')}) {
        try {
            static_cast<void>(parse_script("\n" + line, "s.txt"));
            FAIL() << line.substr(0, 40);
        } catch (const Error& error) {
            const std::string what = error.what();
            EXPECT_TRUE(what.starts_with("s.txt, line 2: column ")) << what;
            EXPECT_NE(what.find("brackets nest deeper than"), std::string::npos) << what;
        }
    }
}

TEST(Script, NumbersKeepTheirValues) {
    const auto value = [](const std::string& number) {
        return *only_step<step::UseWidget>(R"({"widget": "w", "set": )" + number + "}").value;
    };
    EXPECT_EQ(value("7").dump(), "7");
    EXPECT_EQ(value("-7").dump(), "-7");
    EXPECT_EQ(value("0.1"), 0.1);
    EXPECT_EQ(value("1e300"), 1e300);
    EXPECT_TRUE(std::signbit(value("-0.0").get<double>()));
}

TEST(Script, AStepWritesOverNothingThatIsReadOrWrittenOtherwise) {
    const tests::TemporaryFolder folder;
    const auto path = [&](const std::string& name) { return (folder / name).string(); };
    std::ofstream(folder / "s.json") << "scene";
    std::ofstream(folder / "script.json") << "script";
    std::filesystem::create_symlink("s.json", folder / "link.json");
    const ScriptFiles files{path("script.json"), path("s.json"), path("end.png")};
    const auto check = [&](const std::string& steps) {
        check_files(parse_script(steps, "s.txt"), files);
    };
    const auto step = [&](const std::string& word, const std::string& name) {
        return "{\"" + word + "\": \"" + path(name) + "\"}\n";
    };
    EXPECT_NO_THROW(check(step("save", "s.json") + step("state", "a.json") +
                          step("state", "a.json") + step("screenshot", "a.png")));
    EXPECT_NE(tests::error_line([&] {
                  check("\n" + step("state", "link.json"));
              }).find("link.json\" is the scene itself"),
              std::string::npos);
    EXPECT_NE(
        tests::error_line([&] { check(step("save", "script.json")); }).find("is the script itself"),
        std::string::npos);
    EXPECT_NE(tests::error_line([&] {
                  check(step("screenshot", "./end.png"));
              }).find("is the file of --screenshot"),
              std::string::npos);
    EXPECT_NE(tests::error_line([&] {
                  check(step("save", "b.json") + step("state", "b.json"));
              }).find("s.txt, line 2: "),
              std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(
    Script, WrongSteps,
    testing::Values(
        Wrong{R"({"wait": "fnal"})", R"(wait has to be "final")"},
        Wrong{R"({"waits": "final"})", R"("waits" is no step; "wait" is)"},
        Wrong{R"({"xyzzy": 1})", "steps are wait, pace, frames"}, Wrong{R"({})", "is no step"},
        Wrong{R"([1])", "a step is an object"},
        Wrong{R"({"wait": "final")", "column 17: the text ends inside"},
        Wrong{R"({"pace": -1})", "pace has to be 0, or from 1 to 1000 frames a second"},
        Wrong{R"({"pace": "slow"})", "pace"},
        Wrong{R"({"frames": -1})", "frames has to be a whole number"},
        Wrong{R"({"frames": 1.5})", "frames has to be a whole number"},
        Wrong{R"({"mouse": [1]})", "mouse has to be [x, y]"},
        Wrong{R"({"mouse": [1, "a"]})", "mouse has to be [x, y]"},
        Wrong{R"({"press": "up"})", R"(press has to be "left", "middle" or "right")"},
        Wrong{R"({"hold": "hyper"})", "is no key"},
        Wrong{R"({"key": "meta+x"})", R"("meta" is no modifier)"},
        Wrong{R"({"key": "ctrl+"})", "is no key"}, Wrong{R"({"key": ""})", "has to be a text"},
        Wrong{R"({"wheel": 1e400})", "the number \"1e400\" is not finite as a double"},
        Wrong{R"({"wheel": 1e300})", "wheel has to be from -1000 to 1000, not 1e+300"},
        Wrong{R"({"mouse": [1e300, 0]})", "mouse has to be from -1000000 to 1000000"},
        Wrong{R"({"pick": [0, -1e7]})", "pick has to be from -1000000 to 1000000"},
        Wrong{R"({"frames": 1, "frames": 2})", "stands here for the second time"},
        Wrong{R"({"wait": nul})", "not JSON: invalid literal"},
        Wrong{R"({"screenshot": "a.jpg"})", "screenshot has to be a file that ends in .png"},
        Wrong{R"({"save": "a"})", "save has to be a file that ends in .json"},
        Wrong{R"({"state": "a.png"})", "state has to be a file that ends in .json or .txt"},
        Wrong{R"({"wheel": "1"})", "wheel has to be a number"},
        Wrong{R"({"drag": {"element": "e", "handle": "a"}})", "drag has to be"},
        Wrong{R"({"drag": {"element": "e", "handle": "a", "by": [1, 2], "x": 1}})",
              "drag has to be"},
        Wrong{R"({"grab": {"element": "e"}})", "grab has to be"},
        Wrong{R"({"move": 3})", "move has to be [x, y]"},
        Wrong{R"({"resize": "640"})", R"(resize has to be "WIDTHxHEIGHT")"},
        Wrong{R"({"resize": "0x5"})", R"(resize has to be "WIDTHxHEIGHT")"},
        Wrong{R"({"scale": 0})", "scale has to be from 0.5 to 8"},
        Wrong{R"({"theme": "blue"})", R"(theme has to be "light" or "dark")"},
        Wrong{R"({"expect": {}})", "expect has to be an object"},
        Wrong{R"({"expect": {"/a~2": 1}})", "is no JSON pointer"},
        Wrong{R"({"expect": {"a": 1}, "within": -1})", "within has to be 0 or more"},
        Wrong{R"({"screenshot": "a.png", "viewport": 1})", "viewport has to be true or false"},
        Wrong{R"({"press": "left", "mouse": [1, 2]})", "do not belong to the step"},
        Wrong{R"({"widget": "a", "to": 2})", "do not belong to the step"}));

}  // namespace
}  // namespace ivory
