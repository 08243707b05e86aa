#include "app/viewer/script.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <span>
#include <utility>
#include <variant>

#include "core/scene/error.h"
#include "core/scene/json_reader.h"
#include "core/scene/read_file.h"
#include "core/scene/text.h"
#include "core/scene/write_file.h"

namespace ivory {

namespace {

using nlohmann::json;

constexpr int largest_side = 16384;  // pixels
constexpr int most_frames = 100000;
constexpr double fastest_pace = 1000;   // frames a second
constexpr double farthest_pixel = 1e6;  // no window reaches there
constexpr double most_wheel_turns = 1000;

using Words = std::span<const std::string_view>;

constexpr std::array<std::string_view, 1> scene_suffixes{".json"};
constexpr std::array<std::string_view, 2> state_suffixes{".json", ".txt"};
constexpr std::array<std::string_view, 1> picture_suffixes{".png"};

struct KeyWord {
    std::string_view word;
    Key key;
    char32_t character = 0;  // without modifiers
};

// Beside the letters, the digits and f1 .. f12.
constexpr std::array key_words = {
    KeyWord{"escape", Key::escape},   KeyWord{"enter", Key::enter},
    KeyWord{"tab", Key::tab},         KeyWord{"backspace", Key::backspace},
    KeyWord{"insert", Key::insert},   KeyWord{"delete", Key::del},
    KeyWord{"del", Key::del},         KeyWord{"space", Key::space, U' '},
    KeyWord{"left", Key::left},       KeyWord{"right", Key::right},
    KeyWord{"up", Key::up},           KeyWord{"down", Key::down},
    KeyWord{"home", Key::home},       KeyWord{"end", Key::end},
    KeyWord{"page_up", Key::page_up}, KeyWord{"page_down", Key::page_down},
    KeyWord{"-", Key::minus, U'-'},   KeyWord{"=", Key::equal, U'='},
    KeyWord{",", Key::comma, U','},   KeyWord{".", Key::period, U'.'},
    KeyWord{"/", Key::slash, U'/'},   KeyWord{"?", Key::slash, U'?'},
    KeyWord{"shift", Key::shift},     KeyWord{"ctrl", Key::control},
    KeyWord{"alt", Key::alt},         KeyWord{"super", Key::super},
};

std::optional<KeyWord> find_key(std::string_view word) {
    if (word.size() == 1 && word[0] >= 'a' && word[0] <= 'z')
        return KeyWord{word, static_cast<Key>(static_cast<int>(Key::a) + word[0] - 'a'),
                       static_cast<char32_t>(word[0])};
    if (word.size() == 1 && word[0] >= '0' && word[0] <= '9')
        return KeyWord{word, static_cast<Key>(static_cast<int>(Key::digit0) + word[0] - '0'),
                       static_cast<char32_t>(word[0])};
    int number = 0;
    if (word.starts_with('f')) {
        const auto read = std::from_chars(word.data() + 1, word.data() + word.size(), number);
        if (read.ec == std::errc() && read.ptr == word.data() + word.size() && number >= 1 &&
            number <= 12)
            return KeyWord{word, static_cast<Key>(static_cast<int>(Key::f1) + number - 1)};
    }
    const auto found = std::find_if(key_words.begin(), key_words.end(),
                                    [&](const KeyWord& key) { return key.word == word; });
    if (found == key_words.end()) return std::nullopt;
    return *found;
}

std::string shown(const json& value) {
    return printable(value.dump(-1, ' ', false, json::error_handler_t::replace), 80);
}

[[noreturn]] void refuse(const std::string& what) { throw Error(what); }

const std::string& text_of(const json& value, const char* what) {
    if (!value.is_string() || value.get_ref<const std::string&>().empty())
        refuse(std::string(what) + " has to be a text, not " + shown(value));
    return value.get_ref<const std::string&>();
}

double number_of(const json& value, const char* what) {
    if (!value.is_number() || !std::isfinite(value.get<double>()))
        refuse(std::string(what) + " has to be a number, not " + shown(value));
    return value.get<double>();
}

double number_within(const json& value, const char* what, double most) {
    const double number = number_of(value, what);
    if (!(std::abs(number) <= most))
        refuse(std::string(what) + " has to be from " + number_text(-most) + " to " +
               number_text(most) + ", not " + shown(value));
    return number;
}

WindowPoint point_of(const json& value, const char* what) {
    if (!value.is_array() || value.size() != 2 || !value[0].is_number() || !value[1].is_number())
        refuse(std::string(what) + " has to be [x, y] in pixels, not " + shown(value));
    return {number_within(value[0], what, farthest_pixel),
            number_within(value[1], what, farthest_pixel)};
}

std::string file_of(const json& value, const char* what, Words suffixes) {
    const std::string& file = text_of(value, what);
    std::string suffix = std::filesystem::path(file).extension().string();
    for (char& c : suffix) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    if (std::find(suffixes.begin(), suffixes.end(), suffix) == suffixes.end() &&
        !is_written_straight(file))
        refuse(std::string(what) + " has to be a file that ends in " + listed(suffixes, "or") +
               ", not " + shown(value));
    return file;
}

MouseButton button_of(const json& value, const char* what) {
    if (value == "left") return MouseButton::left;
    if (value == "middle") return MouseButton::middle;
    if (value == "right") return MouseButton::right;
    refuse(std::string(what) + " has to be \"left\", \"middle\" or \"right\", not " + shown(value));
}

Key key_of(const json& value, const char* what) {
    const std::optional<KeyWord> key = find_key(text_of(value, what));
    if (!key) refuse(shown(value) + " is no key; try \"shift\", \"ctrl\", \"alt\" or \"x\"");
    return key->key;
}

Chord chord_of(const json& value) {
    const std::string& text = text_of(value, "a key");
    Chord chord;
    std::string_view rest = text;
    for (std::size_t plus = rest.find('+');
         plus != std::string_view::npos && plus + 1 < rest.size(); plus = rest.find('+')) {
        const std::string_view word = rest.substr(0, plus);
        if (word == "ctrl")
            chord.modifiers.control = true;
        else if (word == "shift")
            chord.modifiers.shift = true;
        else if (word == "alt")
            chord.modifiers.alt = true;
        else if (word == "super")
            chord.modifiers.super = true;
        else
            refuse(in_quotes(word) + " is no modifier; ctrl, shift, alt and super are");
        rest.remove_prefix(plus + 1);
    }
    const std::optional<KeyWord> key = find_key(rest);
    if (!key)
        refuse(in_quotes(rest) +
               " is no key; letters, digits, f1 to f12, ? and names as \"escape\" are");
    chord.key = key->key;
    const Modifiers& modifiers = chord.modifiers;
    if (!modifiers.control && !modifiers.alt && !modifiers.super) chord.character = key->character;
    if (modifiers.shift && chord.character >= U'a' && chord.character <= U'z')
        chord.character -= U'a' - U'A';
    if (key->character == U'?') chord.modifiers.shift = true;
    return chord;
}

WindowSize size_of(const json& value) {
    const std::string& text = text_of(value, "resize");
    WindowSize size;
    const char* const end = text.data() + text.size();
    const auto width = std::from_chars(text.data(), end, size.width);
    const bool cross = width.ec == std::errc() && width.ptr != end && *width.ptr == 'x';
    const auto height = cross ? std::from_chars(width.ptr + 1, end, size.height) : width;
    if (!cross || height.ec != std::errc() || height.ptr != end || size.width < 1 ||
        size.height < 1 || size.width > largest_side || size.height > largest_side)
        refuse("resize has to be \"WIDTHxHEIGHT\", each 1 to " + std::to_string(largest_side) +
               ", not " + shown(value));
    return size;
}

// The keys of a step's object, each of which has to be asked for.
class StepKeys {
  public:
    explicit StepKeys(const json& object) : object_(object) {}

    [[nodiscard]] const json* take(const char* key) {
        const auto found = object_.find(key);
        if (found == object_.end()) return nullptr;
        ++taken_;
        return &*found;
    }
    [[nodiscard]] bool all_taken() const { return taken_ == object_.size(); }

  private:
    const json& object_;
    std::size_t taken_ = 0;
};

// With `by` a drag, without one a grab.
step::Drag drag_of(const json& value, const char* what, bool has_by) {
    const auto wrong = [&] {
        refuse(std::string(what) + " has to be {\"element\": ..., \"handle\": ..." +
               (has_by ? ", \"by\": [dx, dy]" : "") + "}, not " + shown(value));
    };
    if (!value.is_object()) wrong();
    StepKeys keys(value);
    const json* const element = keys.take("element");
    const json* const handle = keys.take("handle");
    const json* const by = has_by ? keys.take("by") : nullptr;
    if (element == nullptr || handle == nullptr || (has_by && by == nullptr) || !keys.all_taken())
        wrong();
    // a vertex or control point goes by its number
    const std::string name = handle->is_number_unsigned()
                                 ? std::to_string(handle->get<std::uint64_t>())
                                 : text_of(*handle, "handle");
    return {{text_of(*element, "element"), name}, has_by ? point_of(*by, "by") : WindowPoint{}};
}

step::Expect expect_of(const json& value, const json* within) {
    if (!value.is_object() || value.empty())
        refuse("expect has to be an object of values, as {\"threshold\": 0.7}, not " +
               shown(value));
    step::Expect expect{{}, within == nullptr ? 0 : number_of(*within, "within")};
    if (expect.within < 0) refuse("within has to be 0 or more, not " + shown(*within));
    for (const auto& [where, expected] : value.items()) {
        if (where.starts_with('/')) {
            try {
                static_cast<void>(json::json_pointer(where));
            } catch (const json::exception&) {
                refuse(in_quotes(where) + " is no JSON pointer");
            }
        }
        expect.expectations.push_back({where, expected});
    }
    return expect;
}

constexpr std::array<std::string_view, 26> step_words = {
    "wait", "pace",   "frames", "mouse", "move",   "press", "release", "double_click", "wheel",
    "hold", "let",    "key",    "type",  "widget", "pick",  "select",  "grab",         "drag",
    "drop", "resize", "scale",  "theme", "expect", "save",  "state",   "screenshot",
};

step::Any step_of(const json& object, StepKeys& keys) {
    if (const json* value = keys.take("wait")) {
        if (*value != "final") refuse("wait has to be \"final\", not " + shown(*value));
        return step::WaitFinal{};
    }
    if (const json* value = keys.take("pace")) {
        const double pace = number_of(*value, "pace");
        if (!(pace == 0 || (pace >= 1 && pace <= fastest_pace)))
            refuse("pace has to be 0, or from 1 to " +
                   std::to_string(static_cast<int>(fastest_pace)) + " frames a second, not " +
                   shown(*value));
        return step::Pace{pace};
    }
    if (const json* value = keys.take("frames")) {
        if (!value->is_number_unsigned() || value->get<std::uint64_t>() > most_frames)
            refuse("frames has to be a whole number from 0 to " + std::to_string(most_frames) +
                   ", not " + shown(*value));
        return step::Frames{value->get<int>()};
    }
    if (const json* value = keys.take("mouse")) {
        if (value->is_string()) return step::MouseTo{text_of(*value, "mouse")};
        return step::Mouse{point_of(*value, "mouse")};
    }
    if (const json* value = keys.take("move")) return step::Move{point_of(*value, "move")};
    if (const json* value = keys.take("press")) return step::Press{button_of(*value, "press")};
    if (const json* value = keys.take("release"))
        return step::Release{button_of(*value, "release")};
    if (const json* value = keys.take("double_click"))
        return step::DoubleClick{button_of(*value, "double_click")};
    if (const json* value = keys.take("wheel"))
        return step::Wheel{number_within(*value, "wheel", most_wheel_turns)};
    if (const json* value = keys.take("hold")) return step::Hold{key_of(*value, "hold")};
    if (const json* value = keys.take("let")) return step::Let{key_of(*value, "let")};
    if (const json* value = keys.take("key")) return step::KeyStroke{chord_of(*value)};
    if (const json* value = keys.take("type"))
        return step::Type{characters_of(text_of(*value, "type"))};
    if (const json* value = keys.take("widget")) {
        step::UseWidget use{text_of(*value, "widget"), std::nullopt};
        if (const json* set = keys.take("set")) use.value = *set;
        return use;
    }
    if (const json* value = keys.take("pick")) return step::Pick{point_of(*value, "pick")};
    if (const json* value = keys.take("select")) return step::Select{text_of(*value, "select")};
    if (const json* value = keys.take("grab")) return drag_of(*value, "grab", false).grab;
    if (const json* value = keys.take("drag")) return drag_of(*value, "drag", true);
    if (const json* value = keys.take("drop")) return step::Drop{text_of(*value, "drop")};
    if (const json* value = keys.take("resize")) return step::Resize{size_of(*value)};
    if (const json* value = keys.take("scale")) {
        const double scale = number_of(*value, "scale");
        if (!(scale >= 0.5 && scale <= 8))
            refuse("scale has to be from 0.5 to 8, not " + shown(*value));
        return step::Scale{scale};
    }
    if (const json* value = keys.take("theme")) {
        if (*value != "light" && *value != "dark")
            refuse("theme has to be \"light\" or \"dark\", not " + shown(*value));
        return step::SetTheme{*value == "light" ? Theme::light : Theme::dark};
    }
    if (const json* value = keys.take("expect")) return expect_of(*value, keys.take("within"));
    if (const json* value = keys.take("save"))
        return step::Save{file_of(*value, "save", scene_suffixes)};
    if (const json* value = keys.take("state"))
        return step::WriteState{file_of(*value, "state", state_suffixes)};
    if (const json* value = keys.take("screenshot")) {
        step::Screenshot screenshot{file_of(*value, "screenshot", picture_suffixes), false};
        if (const json* viewport = keys.take("viewport")) {
            if (!viewport->is_boolean())
                refuse("viewport has to be true or false, not " + shown(*viewport));
            screenshot.viewport = viewport->get<bool>();
        }
        return screenshot;
    }
    const std::string word = object.empty() ? "" : object.begin().key();
    const auto meant = nearest_word(word, step_words);
    refuse(in_quotes(word) + " is no step" +
           (meant ? "; \"" + std::string(*meant) + "\" is" : "; steps are " + listed(step_words)));
}

// As a whole number where it is one, which a count has to be.
json number_json(double number) {
    constexpr double exact = 0x1p53;
    const bool is_whole = number == std::floor(number) && std::abs(number) <= exact &&
                          !(number == 0 && std::signbit(number));
    if (!is_whole) return number;
    if (number < 0) return static_cast<std::int64_t>(number);
    return static_cast<std::uint64_t>(number);
}

// Of nesting that the reader has bounded.
json json_of(const JsonValue& value) {
    switch (value.kind()) {
        case JsonKind::null:
            break;
        case JsonKind::boolean:
            return value.boolean();
        case JsonKind::number:
            return number_json(value.number());
        case JsonKind::text:
            return value.text();
        case JsonKind::list: {
            json list = json::array();
            for (const JsonValue item : value.items()) list.push_back(json_of(item));
            return list;
        }
        case JsonKind::object: {
            json object = json::object();
            for (const JsonMember member : value.members())
                object[member.key.text()] = json_of(member.value);
            return object;
        }
    }
    return nullptr;
}

// What the reader says of a text without a name and of one line: ": line 1, column 3: WHAT" or
// ": POINTER (line 1, column 3): WHAT", without what the caller knows better.
std::string without_line(std::string what) {
    what.erase(0, std::string_view(": ").size());
    constexpr std::string_view line = "line 1, ";
    const std::size_t at = what.find(line);
    return at == std::string::npos ? what : what.erase(at, line.size());
}

json read_line(std::string_view line) {
    try {
        const SourceText source(line, "");
        return json_of(parse_json(source).root());
    } catch (const Error& error) {
        refuse(without_line(error.what()));
    }
}

step::Any parse_line(std::string_view line) {
    const json object = read_line(line);
    if (!object.is_object())
        refuse("a step is an object, as {\"wait\": \"final\"}, not " + shown(object));
    StepKeys keys(object);
    step::Any any = step_of(object, keys);
    if (!keys.all_taken())
        refuse("there are keys in " + shown(object) + " that do not belong to the step");
    return any;
}

}  // namespace

std::u32string characters_of(std::string_view utf8) {
    if (first_invalid_utf8(utf8)) throw Error(in_quotes(utf8) + " is not UTF-8");
    std::u32string characters;
    for (std::size_t i = 0; i < utf8.size();) {
        const auto lead = static_cast<unsigned char>(utf8[i]);
        const std::size_t length = lead < 0x80 ? 1 : lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
        char32_t character = length == 1 ? lead : lead & (0x7Fu >> length);
        for (std::size_t k = 1; k < length; ++k)
            character = character << 6 | (static_cast<unsigned char>(utf8[i + k]) & 0x3Fu);
        characters += character;
        i += length;
    }
    return characters;
}

Script parse_script(std::string_view text, const std::string& name) {
    Script script{name, {}};
    int number = 0;
    while (!text.empty()) {
        ++number;
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        const std::size_t first = line.find_first_not_of(" \t\r");
        if (first == std::string_view::npos || line[first] == '#') continue;
        try {
            script.lines.push_back({number, parse_line(line)});
        } catch (const Error& error) {
            throw Error(name + ", line " + std::to_string(number) + ": " + error.what());
        }
    }
    return script;
}

void check_files(const Script& script, const ScriptFiles& others) {
    enum class Kind { played, opened, final_picture, state, picture, saved };
    struct Use {
        Kind kind;
        int line;  // 0: of the command line
        FileIdentity file;
    };
    std::vector<Use> uses;
    const auto note = [&](Kind kind, int line, const std::string& path, FileUse how) {
        if (const auto file = file_identity(path, how)) uses.push_back({kind, line, *file});
    };
    note(Kind::played, 0, others.script, FileUse::input);
    note(Kind::opened, 0, others.scene, FileUse::input);
    note(Kind::final_picture, 0, others.screenshot, FileUse::output);
    for (const ScriptLine& line : script.lines) {
        const std::size_t before = uses.size();
        std::string path;
        if (const auto* const save = std::get_if<step::Save>(&line.step)) {
            path = save->file;
            note(Kind::saved, line.number, path, FileUse::output);
        } else if (const auto* const state = std::get_if<step::WriteState>(&line.step)) {
            path = state->file;
            note(Kind::state, line.number, path, FileUse::output);
        } else if (const auto* const picture = std::get_if<step::Screenshot>(&line.step)) {
            path = picture->file;
            note(Kind::picture, line.number, path, FileUse::output);
        }
        if (uses.size() == before) continue;
        const Use& use = uses.back();
        for (std::size_t i = 0; i < before; ++i) {
            const Use& other = uses[i];
            // as a person saves over what was opened, and anything anew
            const bool meant =
                use.kind == other.kind || (use.kind == Kind::saved && other.kind == Kind::opened);
            if (meant || use.file != other.file) continue;
            const std::string what = other.kind == Kind::played   ? "the script itself"
                                     : other.kind == Kind::opened ? "the scene itself"
                                     : other.kind == Kind::final_picture
                                         ? "the file of --screenshot"
                                         : "what line " + std::to_string(other.line) + " writes";
            throw Error(script.name + ", line " + std::to_string(use.line) + ": " +
                        in_quotes(path) + " is " + what + "; name another file");
        }
    }
}

Script read_script(const std::filesystem::path& path) {
    return parse_script(read_file(path), file_label(path));
}

}  // namespace ivory
