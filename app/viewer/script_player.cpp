#include "app/viewer/script_player.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "app/viewer/handles.h"
#include "core/render/image_file.h"
#include "core/scene/error.h"
#include "core/scene/read_file.h"
#include "core/scene/scene_json.h"
#include "core/scene/text.h"
#include "core/scene/write_file.h"

namespace ivory {

namespace {

using Clock = std::chrono::steady_clock;
using nlohmann::json;

constexpr double frame_seconds = 1.0 / 60;  // of the script's own time, whatever a frame takes
constexpr int longest_wait = 60 * IVORY_PATIENCE;  // seconds for a final picture
// A person waits for the surface to follow before moving on; no longer than that for a heavy scene.
constexpr double patience = 2 * IVORY_PATIENCE;  // seconds
constexpr double frames_until_shown = 2;         // at a pace: at 60 a second as in a window
constexpr double between_looks = 0.05;           // seconds: whether somebody wants to stop
constexpr int frames_to_settle = 3;
constexpr int most_wheel_steps = 2000;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

WindowPoint middle(const WindowRect& rect) {
    return {rect.x + rect.width / 2.0, rect.y + rect.height / 2.0};
}

std::string shown(const json& value) {
    if (value.is_number_float()) return number_text(value.get<double>());
    return printable(value.dump(-1, ' ', false, json::error_handler_t::replace), 200);
}

bool equal_within(const json& is, const json& expected, double within) {
    if (is.is_number() && expected.is_number())
        return std::abs(is.get<double>() - expected.get<double>()) <= within;
    if (is.is_array() && expected.is_array() && is.size() == expected.size()) {
        for (std::size_t i = 0; i < is.size(); ++i)
            if (!equal_within(is[i], expected[i], within)) return false;
        return true;
    }
    return is == expected;
}

// A key in a JSON pointer, as RFC 6901 writes it.
std::string unescaped(std::string_view key) {
    std::string plain;
    for (std::size_t i = 0; i < key.size(); ++i) {
        const bool escape = key[i] == '~' && i + 1 < key.size();
        plain += !escape ? key[i] : key[++i] == '1' ? '/' : '~';
    }
    return plain;
}

// The value at a JSON pointer, or of a top-level key; nullptr where there is none.
const json* find_value(const json& document, const std::string& where) {
    if (!where.starts_with('/')) {
        const auto found = document.find(where);
        return found == document.end() ? nullptr : &*found;
    }
    const json* value = &document;
    for (std::string_view rest = where; !rest.empty();) {
        rest.remove_prefix(1);  // the slash
        const std::string_view escaped = rest.substr(0, rest.find('/'));
        rest.remove_prefix(escaped.size());
        const json* next = nullptr;
        if (value->is_object()) {
            const auto found = value->find(unescaped(escaped));
            if (found != value->end()) next = &*found;
        } else if (value->is_array()) {
            std::size_t index = 0;
            const char* const end = escaped.data() + escaped.size();
            const auto read = std::from_chars(escaped.data(), end, index);
            if (read.ec == std::errc() && read.ptr == end && index < value->size())
                next = &(*value)[index];
        }
        if (next == nullptr) return nullptr;
        value = next;
    }
    return value;
}

Frame cropped(const Frame& frame, const WindowRect& rect) {
    Frame part(rect.width, rect.height, false);
    for (int j = 0; j < rect.height; ++j)
        std::copy_n(&frame.color[frame.at(rect.x, rect.y + j)], rect.width,
                    &part.color[part.at(0, j)]);
    return part;
}

// `list` as words in quotes, the first few of them.
std::string some_of(const std::vector<std::string>& list) {
    constexpr std::size_t most = 8;
    std::vector<std::string> quoted;
    for (const std::string& word : list) {
        if (quoted.size() == most) break;
        quoted.push_back(in_quotes(word));
    }
    const std::vector<std::string_view> words(quoted.begin(), quoted.end());
    return listed(words) + (list.size() > most ? " and others" : "");
}

[[noreturn]] void no_such_widget(const Widgets& widgets, const std::string& id) {
    std::vector<std::string_view> ids;
    for (const auto& [other, widget] : widgets.all()) ids.push_back(other);
    const auto meant = nearest_word(id, ids);
    throw Error(
        "no control " + in_quotes(id) + " is on the screen" +
        (meant ? "; " + in_quotes(*meant) + " is" : "; the state file lists those that are"));
}

}  // namespace

void WakeUp::wake() {
    const std::lock_guard lock(mutex_);
    woken_ = true;
    condition_.notify_all();
}

void WakeUp::wait(double seconds) {
    std::unique_lock lock(mutex_);
    condition_.wait_for(lock, std::chrono::duration<double>(seconds), [this] { return woken_; });
    woken_ = false;
}

ScriptPlayer::ScriptPlayer(Viewer& viewer, MemoryContext& context, EventQueue& events,
                           WakeUp& wake_up, std::function<void()> stop)
    : viewer_(viewer),
      context_(context),
      events_(events),
      wake_up_(wake_up),
      stop_(std::move(stop)) {
    viewer_.set_frame_budget(patience);
}

void ScriptPlayer::play(const Script& script) {
    settle();  // nothing is on the screen before the first frames
    for (const ScriptLine& line : script.lines) {
        try {
            std::visit([this](const auto& step) { take(step); }, line.step);
        } catch (const Error& error) {
            throw Error(script.name + ", line " + std::to_string(line.number) + ": " +
                        error.what());
        }
    }
}

void ScriptPlayer::turn() {
    do {
        stop_();
        viewer_.frame(events_.next_frame(wait_for_turn()));
    } while (!events_.empty());
}

// Until the next frame is to begin. Seconds since the last one did: of the script's own time, or at a
// pace of real time.
double ScriptPlayer::wait_for_turn() {
    if (pace_ == 0) return frame_seconds;
    const std::chrono::duration<double> between(1 / pace_);
    const Clock::time_point due = turned_ + std::chrono::duration_cast<Clock::duration>(between);
    std::this_thread::sleep_until(due);
    const Clock::time_point now = Clock::now();
    return std::chrono::duration<double>(now - std::exchange(turned_, now)).count();
}

void ScriptPlayer::take(const step::Pace& step) {
    pace_ = step.per_second;
    turned_ = Clock::now();
    viewer_.set_frame_budget(pace_ == 0 ? patience : frames_until_shown / pace_);
}

void ScriptPlayer::turn(Event event) {
    events_.push(std::move(event));
    turn();
}

void ScriptPlayer::turns(int count) {
    for (int i = 0; i < count; ++i) turn();
}

void ScriptPlayer::settle() { turns(frames_to_settle); }

void ScriptPlayer::wait_final() {
    const Clock::time_point start = Clock::now();
    for (turn(); !viewer_.final() || viewer_.next_frame_wanted() == 0; turn()) {
        const PictureState& picture = viewer_.state().picture;
        if (!picture.fault.empty())
            throw Error("there is no picture of " +
                        file_label(viewer_.state().document.path().value_or("untitled")) + ": " +
                        picture.fault);
        if (seconds_since(start) > longest_wait)
            throw Error("the picture is not final after " + std::to_string(longest_wait) +
                        " seconds: " + std::to_string(static_cast<int>(100 * picture.progress)) +
                        " % of it is traced");
        if (viewer_.final() || pace_ != 0) continue;
        const double wanted = viewer_.next_frame_wanted();
        wake_up_.wait(wanted < 0 ? between_looks : std::min(wanted, between_looks));
    }
}

void ScriptPlayer::screenshot(const std::string& file, bool viewport) {
    viewer_.hide_overlay(viewport);
    turn();
    viewer_.hide_overlay(false);
    Frame frame = viewer_.read_back();
    if (viewport) frame = cropped(frame, viewer_.state().viewport);
    write_file(file, png_bytes(frame));
}

void ScriptPlayer::move_to(WindowPoint at) { turn(MouseMoved{at}); }

void ScriptPlayer::click() {
    turn(MouseButtonChanged{MouseButton::left, true});
    turn(MouseButtonChanged{MouseButton::left, false});
}

void ScriptPlayer::stroke(const Chord& chord) {
    const auto modifiers = [&](bool down) {
        if (chord.modifiers.control) events_.push(KeyChanged{Key::control, down, false});
        if (chord.modifiers.shift) events_.push(KeyChanged{Key::shift, down, false});
        if (chord.modifiers.alt) events_.push(KeyChanged{Key::alt, down, false});
        if (chord.modifiers.super) events_.push(KeyChanged{Key::super, down, false});
    };
    modifiers(true);
    events_.push(KeyChanged{chord.key, true, false});
    if (chord.character != 0) events_.push(TextTyped{chord.character});
    turn();
    events_.push(KeyChanged{chord.key, false, false});
    modifiers(false);
    turn();
}

void ScriptPlayer::type(const std::u32string& text) {
    for (const char32_t character : text) events_.push(TextTyped{character});
    turn();
}

void ScriptPlayer::take(const step::KeyStroke& step) {
    stroke(step.chord);
    turn();
}

void ScriptPlayer::take(const step::DoubleClick& step) {
    for (const bool down : {true, false, true, false}) turn(MouseButtonChanged{step.button, down});
}

const Widget& ScriptPlayer::bring_into_sight(const std::string& id) {
    const Widgets& widgets = viewer_.state().widgets;
    if (widgets.find(id) == nullptr) {
        // an entry of a menu that is closed
        const std::string menu = id.substr(0, id.rfind('.'));
        const Widget* const title = menu == id ? nullptr : widgets.find(menu);
        if (title == nullptr || title->kind != WidgetKind::menu) no_such_widget(widgets, id);
        move_to(middle(bring_into_sight(menu).rect));
        click();
        settle();
    }
    for (int step = 0; step < most_wheel_steps; ++step) {
        const Widget* const widget = widgets.find(id);
        if (widget == nullptr) no_such_widget(widgets, id);
        const WindowRect rect = widget->rect, clip = widget->clip;
        const std::optional<WindowRect> part = widget->visible_part();
        if (part && part->height >= std::min(rect.height, clip.height)) return *widget;
        move_to(middle(clip));
        turn(WheelTurned{0, rect.y < clip.y ? 1.0 : -1.0});
        turn();
        const Widget* const after = widgets.find(id);
        if (after == nullptr) no_such_widget(widgets, id);
        if (after->rect == rect) {  // it does not scroll any further
            if (part) return *after;
            break;
        }
    }
    throw Error("the control " + in_quotes(id) + " cannot be scrolled into sight");
}

void ScriptPlayer::click_widget(const std::string& id) {
    move_to(middle(*bring_into_sight(id).visible_part()));
    const Widget* const widget = viewer_.state().widgets.find(id);
    if (widget == nullptr) no_such_widget(viewer_.state().widgets, id);
    if (!widget->enabled) throw Error("the control " + in_quotes(id) + " is greyed");
    click();
    settle();
}

void ScriptPlayer::enter_text(const std::string& text) {
    stroke({{.control = true}, Key::a});
    type(characters_of(text));
    stroke({{}, Key::enter});
    settle();
}

void ScriptPlayer::set_number(const std::string& id, const json& value) {
    if (!value.is_number()) throw Error(in_quotes(id) + " takes a number, not " + shown(value));
    turn(KeyChanged{Key::control, true, false});
    click_widget(id);
    turn(KeyChanged{Key::control, false, false});
    enter_text(number_text(value.get<double>()));
}

void ScriptPlayer::set_color(const std::string& id, const json& value) {
    if (!value.is_array() || value.size() != 3)
        throw Error(in_quotes(id) + " takes a colour [r, g, b], linear, not " + shown(value));
    click_widget(id);
    set_number(id + ".r", value[0]);
    set_number(id + ".g", value[1]);
    set_number(id + ".b", value[2]);
    stroke({{}, Key::escape});
    settle();
}

void ScriptPlayer::choose(const std::string& id, const json& value) {
    if (!value.is_string() && !value.is_number_unsigned())
        throw Error(in_quotes(id) + " takes a word, not " + shown(value));
    // words may be whole numbers
    const std::string option =
        id + "." + (value.is_string() ? value.get<std::string>() : value.dump());
    const Widgets& widgets = viewer_.state().widgets;
    if (widgets.find(option) == nullptr) click_widget(id);
    if (widgets.find(option) == nullptr) {
        std::vector<std::string> options;
        for (const auto& [other, widget] : widgets.all())
            if (other.starts_with(id + ".")) options.push_back(other.substr(id.size() + 1));
        throw Error(in_quotes(id) + " has no choice " + shown(value) + "; it has " +
                    some_of(options));
    }
    click_widget(option);
}

void ScriptPlayer::take(const step::UseWidget& step) {
    const Message before = viewer_.state().message;
    if (!step.value) {
        click_widget(step.id);
        return;
    }
    const json& value = *step.value;
    const Widget widget = bring_into_sight(step.id);
    switch (widget.kind) {
        case WidgetKind::toggle:
            if (!value.is_boolean())
                throw Error(in_quotes(step.id) + " takes true or false, not " + shown(value));
            if (widget.on != value.get<bool>()) click_widget(step.id);
            break;
        case WidgetKind::number:
            set_number(step.id, value);
            break;
        case WidgetKind::color:
            set_color(step.id, value);
            break;
        case WidgetKind::choice:
            choose(step.id, value);
            break;
        case WidgetKind::text:
            if (!value.is_string())
                throw Error(in_quotes(step.id) + " takes a text, not " + shown(value));
            click_widget(step.id);
            enter_text(value.get<std::string>());
            break;
        case WidgetKind::button:
        case WidgetKind::menu:
        case WidgetKind::row:
            throw Error(in_quotes(step.id) + " can be clicked, not set; leave \"set\" out");
    }
    const Message& after = viewer_.state().message;
    if (after.error && !after.text.empty() && after.text != before.text)
        throw Error(in_quotes(step.id) + " is not set to " + shown(value) + ": " + after.text);
}

void ScriptPlayer::take(const step::Pick& step) {
    if (!viewer_.state().viewport.contains(step.at))
        throw Error("[" + number_text(step.at.x) + ", " + number_text(step.at.y) +
                    "] lies outside of the picture; the state file has its rectangle, `viewport`");
    move_to(step.at);
    click();
    turn();
}

void ScriptPlayer::take(const step::Select& step) {
    const std::vector<std::string> names = element_names(viewer_.state().document.scene());
    if (std::find(names.begin(), names.end(), step.name) == names.end())
        throw Error("no element is called " + in_quotes(step.name) +
                    (names.empty() ? "; there are none" : "; there are " + some_of(names)));
    click_widget("row." + step.name);
}

void ScriptPlayer::take(const step::MouseTo& step) {
    move_to(middle(*bring_into_sight(step.widget).visible_part()));
}

void ScriptPlayer::take(const step::Move& step) {
    const WindowPoint from = events_.last_frame().mouse;
    move_to({from.x + step.by.x, from.y + step.by.y});
}

void ScriptPlayer::take(const step::Grab& step) {
    const std::vector<std::string> names = element_names(viewer_.state().document.scene());
    const auto name = std::find(names.begin(), names.end(), step.element);
    const auto element = static_cast<std::size_t>(name - names.begin());
    if (name == names.end() || viewer_.state().document.selected() != element)
        take(step::Select{step.element});

    const std::vector<Handle> handles = handles_of(viewer_.state(), element);
    const auto handle = std::find_if(handles.begin(), handles.end(),
                                     [&](const Handle& h) { return h.name == step.handle; });
    if (handle == handles.end()) {
        std::vector<std::string> others;
        for (const Handle& other : handles) others.push_back(other.name);
        throw Error(in_quotes(step.element) + " has no handle " + in_quotes(step.handle) +
                    " in the picture" + (others.empty() ? "" : "; it has " + some_of(others)));
    }
    move_to(handle->at);
    turn(MouseButtonChanged{MouseButton::left, true});
    const std::optional<Handle>& grabbed = viewer_.mouse().grabbed();
    if (!grabbed || grabbed->element != element || grabbed->name != step.handle) {
        turn(MouseButtonChanged{MouseButton::left, false});
        throw Error("the handle " + in_quotes(step.handle) + " of " + in_quotes(step.element) +
                    " cannot be grabbed: something else lies over it");
    }
}

void ScriptPlayer::take(const step::Drag& step) {
    take(step.grab);
    const WindowPoint start = events_.last_frame().mouse;
    constexpr int steps = 10;
    for (int i = 1; i <= steps; ++i)
        move_to({start.x + step.by.x * i / steps, start.y + step.by.y * i / steps});
    turn(MouseButtonChanged{MouseButton::left, false});
    turn();
}

void ScriptPlayer::take(const step::Drop& step) {
    std::error_code ignored;
    const bool is_there = std::filesystem::exists(step.file, ignored);
    turn(FilesDropped{{step.file}});
    settle();
    if (!is_there)
        throw Error(in_quotes(step.file) + " is not there to be dropped; name a file that exists");
}

void ScriptPlayer::take(const step::Resize& step) {
    context_.resize(step.size);
    turn(Resized{step.size});
    settle();
}

void ScriptPlayer::take(const step::Scale& step) {
    turn(Rescaled{step.scale});
    settle();
}

void ScriptPlayer::take(const step::SetTheme& step) {
    turn(ThemeChanged{step.theme});
    settle();
}

void ScriptPlayer::take(const step::Expect& step) {
    const json scene = whole_scene_json(viewer_.state());
    const json state = state_json(viewer_, at_last_state_);
    for (const auto& [where, expected] : step.expectations) {
        const json* is = find_value(scene, where);
        if (is == nullptr) is = find_value(state, where);
        if (is == nullptr)
            throw Error("expected " + in_quotes(where) + " to be " + shown(expected) +
                        ", but neither the scene nor the state has it");
        if (!equal_within(*is, expected, step.within))
            throw Error("expected " + in_quotes(where) + " to be " + shown(expected) + ", it is " +
                        shown(*is));
    }
}

void ScriptPlayer::take(const step::Save& step) {
    save_scene(viewer_.state().scene_with_view(), step.file);
}

void ScriptPlayer::take(const step::WriteState& step) {
    const json state = state_json(viewer_, at_last_state_);
    at_last_state_ = {viewer_.totals().tiles_traced, viewer_.frame_count()};
    write_file(step.file, state_text(state));
}

}  // namespace ivory
