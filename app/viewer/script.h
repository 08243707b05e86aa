// A headless script: one step a line, each a JSON object, `#` begins a comment. Steps and their
// meaning: the file format's section "Driving the viewer without a display". Beyond it:
//   {"mouse": "ID"}                                  the pointer to the middle of that control
//   {"move": [dx, dy]}                               the pointer by so many pixels, one frame
//   {"grab": {"element": "NAME", "handle": "a"}}     the first half of `drag`: selects and presses
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "app/platform/input.h"
#include "app/platform/window_rect.h"

namespace ivory {

struct Chord {
    Modifiers modifiers;
    Key key = Key::none;
    char32_t character = 0;  // what typing it brings with it; 0: nothing
};

namespace step {

struct WaitFinal {};
struct Pace {
    double per_second;  // frames and steps of input, of real time; 0: as fast as they can
};
struct Frames {
    int count;
};
struct Mouse {
    WindowPoint at;
};
struct MouseTo {
    std::string widget;
};
struct Move {
    WindowPoint by;
};
struct Press {
    MouseButton button;
};
struct Release {
    MouseButton button;
};
struct DoubleClick {
    MouseButton button;
};
struct Wheel {
    double steps;
};
struct Hold {
    Key key;
};
struct Let {
    Key key;
};
struct KeyStroke {
    Chord chord;
};
struct Type {
    std::u32string text;
};
struct UseWidget {
    std::string id;
    std::optional<nlohmann::json> value;  // none: a click
};
struct Pick {
    WindowPoint at;
};
struct Select {
    std::string name;
};
struct Grab {
    std::string element, handle;
};
struct Drag {
    Grab grab;
    WindowPoint by;
};
struct Drop {
    std::string file;
};
struct Resize {
    WindowSize size;
};
struct Scale {
    double scale;
};
struct SetTheme {
    Theme theme;
};
struct Expectation {
    std::string where;  // a JSON pointer or top-level key
    nlohmann::json value;
};
struct Expect {
    std::vector<Expectation> expectations;
    double within;
};
struct Save {
    std::string file;
};
struct WriteState {
    std::string file;
};
struct Screenshot {
    std::string file;
    bool viewport;
};

using Any = std::variant<WaitFinal, Pace, Frames, Mouse, MouseTo, Move, Press, Release, DoubleClick,
                         Wheel, Hold, Let, KeyStroke, Type, UseWidget, Pick, Select, Grab, Drag,
                         Drop, Resize, Scale, SetTheme, Expect, Save, WriteState, Screenshot>;

}  // namespace step

struct ScriptLine {
    int number;  // counted from 1
    step::Any step;
};

struct Script {
    std::string name;  // of the file, for messages
    std::vector<ScriptLine> lines;
};

// The characters of a text in UTF-8. Throws Error where it is none.
[[nodiscard]] std::u32string characters_of(std::string_view utf8);

// Throws Error: file, line, what is wrong, what would be right. All of it is checked before a step
// is done.
[[nodiscard]] Script parse_script(std::string_view text, const std::string& name);
[[nodiscard]] Script read_script(const std::filesystem::path& path);

// The files of the call that plays a script; empty: none.
struct ScriptFiles {
    std::string script, scene, screenshot;
};

// Throws Error, with the line, where a step writes over the script, the scene (but to save it), the
// call's screenshot, or what a step of another kind writes. Links and other spellings are the same
// file.
void check_files(const Script& script, const ScriptFiles& others);

}  // namespace ivory
