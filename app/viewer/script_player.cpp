#include "app/viewer/script_player.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include "app/viewer/handles.h"
#include "app/viewer/json_values.h"
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

constexpr int longest_wait = 60 * IVORY_PATIENCE;  // seconds for a final picture
constexpr double between_looks = 0.05;             // seconds: whether somebody wants to stop

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

Frame cropped(const Frame& frame, const WindowRect& rect) {
    Frame part(rect.width, rect.height, false);
    for (int j = 0; j < rect.height; ++j)
        std::copy_n(&frame.color[frame.at(rect.x, rect.y + j)], rect.width,
                    &part.color[part.at(0, j)]);
    return part;
}

}  // namespace

ScriptPlayer::ScriptPlayer(Viewer& viewer, MemoryContext& context, EventQueue& events,
                           WakeUp& wake_up, std::function<void()> stop)
    : viewer_(viewer),
      context_(context),
      hand_(viewer, events, std::move(stop)),
      controls_(hand_, viewer),
      wake_up_(wake_up) {}

void ScriptPlayer::play(const Script& script) {
    hand_.settle();  // nothing is on the screen before the first frames
    for (const ScriptLine& line : script.lines) {
        try {
            std::visit([this](const auto& step) { take(step); }, line.step);
        } catch (const Error& error) {
            throw Error(script.name + ", line " + std::to_string(line.number) + ": " +
                        error.what());
        }
    }
}

void ScriptPlayer::wait_final() {
    const Clock::time_point start = Clock::now();
    for (hand_.turn(); !viewer_.final() || viewer_.next_frame_wanted() == 0; hand_.turn()) {
        const PictureState& picture = viewer_.state().picture;
        if (!picture.fault.empty())
            throw Error("there is no final picture of " +
                        file_label(viewer_.state().document.path().value_or("untitled")) + ": " +
                        picture.fault);
        if (seconds_since(start) > longest_wait)
            throw Error("the picture is not final after " + std::to_string(longest_wait) +
                        " seconds: " + std::to_string(static_cast<int>(100 * picture.progress)) +
                        " % of it is traced");
        if (viewer_.final() || hand_.has_pace()) continue;
        const double wanted = viewer_.next_frame_wanted();
        wake_up_.wait(wanted < 0 ? between_looks : std::min(wanted, between_looks));
    }
}

void ScriptPlayer::screenshot(const std::string& file, bool viewport) {
    viewer_.hide_overlay(viewport);
    hand_.turn();
    viewer_.hide_overlay(false);
    Frame frame = viewer_.read_back();
    if (viewport) frame = cropped(frame, viewer_.state().viewport);
    write_file(file, png_bytes(frame));
}

void ScriptPlayer::take(const step::KeyStroke& step) {
    hand_.stroke(step.chord);
    hand_.turn();
}

void ScriptPlayer::take(const step::DoubleClick& step) {
    for (const bool down : {true, false, true, false})
        hand_.turn(MouseButtonChanged{step.button, down});
}

void ScriptPlayer::take(const step::UseWidget& step) {
    if (step.value)
        controls_.set(step.id, *step.value);
    else
        controls_.click(step.id);
}

void ScriptPlayer::take(const step::Pick& step) {
    if (!viewer_.state().viewport.contains(step.at))
        throw Error("[" + number_text(step.at.x) + ", " + number_text(step.at.y) +
                    "] lies outside of the picture; the state file has its rectangle, `viewport`");
    hand_.move_to(step.at);
    hand_.click();
    hand_.turn();
}

void ScriptPlayer::take(const step::Select& step) {
    const std::vector<std::string> names = element_names(viewer_.state().document.scene());
    if (std::find(names.begin(), names.end(), step.name) == names.end())
        throw Error("no element is called " + in_quotes(step.name) +
                    (names.empty() ? "; there are none" : "; there are " + some_of(names)));
    controls_.click("row." + step.name);
}

void ScriptPlayer::take(const step::MouseTo& step) { controls_.point_at(step.widget); }

void ScriptPlayer::take(const step::Move& step) {
    const WindowPoint from = hand_.at();
    hand_.move_to({from.x + step.by.x, from.y + step.by.y});
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
    hand_.move_to(handle->at);
    hand_.turn(MouseButtonChanged{MouseButton::left, true});
    const std::optional<Handle>& grabbed = viewer_.mouse().grabbed();
    if (!grabbed || grabbed->element != element || grabbed->name != step.handle) {
        hand_.turn(MouseButtonChanged{MouseButton::left, false});
        throw Error("the handle " + in_quotes(step.handle) + " of " + in_quotes(step.element) +
                    " cannot be grabbed: something else lies over it");
    }
}

void ScriptPlayer::take(const step::Drag& step) {
    take(step.grab);
    const WindowPoint start = hand_.at();
    constexpr int steps = 10;
    for (int i = 1; i <= steps; ++i)
        hand_.move_to({start.x + step.by.x * i / steps, start.y + step.by.y * i / steps});
    hand_.turn(MouseButtonChanged{MouseButton::left, false});
    hand_.turn();
}

void ScriptPlayer::take(const step::Drop& step) {
    std::error_code ignored;
    const bool is_there = std::filesystem::exists(step.file, ignored);
    hand_.turn(FilesDropped{{step.file}});
    hand_.settle();
    if (!is_there)
        throw Error(in_quotes(step.file) + " is not there to be dropped; name a file that exists");
}

void ScriptPlayer::take(const step::Resize& step) {
    context_.resize(step.size);
    hand_.turn(Resized{step.size});
    hand_.settle();
}

void ScriptPlayer::take(const step::Scale& step) {
    hand_.turn(Rescaled{step.scale});
    hand_.settle();
}

void ScriptPlayer::take(const step::SetTheme& step) {
    hand_.turn(ThemeChanged{step.theme});
    hand_.settle();
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
