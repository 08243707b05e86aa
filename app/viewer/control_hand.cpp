#include "app/viewer/control_hand.h"

#include <algorithm>
#include <optional>
#include <string_view>
#include <vector>

#include "app/viewer/json_values.h"
#include "core/scene/error.h"
#include "core/scene/text.h"

namespace ivory {

using nlohmann::json;

namespace {

constexpr int most_wheel_steps = 2000;

WindowPoint middle(const WindowRect& rect) {
    return {rect.x + rect.width / 2.0, rect.y + rect.height / 2.0};
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

void ControlHand::point_at(const std::string& id) {
    hand_.move_to(middle(*bring_into_sight(id).visible_part()));
}

const Widget& ControlHand::bring_into_sight(const std::string& id) {
    const Widgets& widgets = this->widgets();
    if (widgets.find(id) == nullptr) {
        // an entry of a menu that is closed
        const std::string menu = id.substr(0, id.rfind('.'));
        const Widget* const title = menu == id ? nullptr : widgets.find(menu);
        if (title == nullptr || title->kind != WidgetKind::menu) no_such_widget(widgets, id);
        hand_.move_to(middle(bring_into_sight(menu).rect));
        hand_.click();
        hand_.settle();
    }
    for (int step = 0; step < most_wheel_steps; ++step) {
        const Widget* const widget = widgets.find(id);
        if (widget == nullptr) no_such_widget(widgets, id);
        const WindowRect rect = widget->rect, clip = widget->clip;
        const std::optional<WindowRect> part = widget->visible_part();
        if (part && part->height >= std::min(rect.height, clip.height)) return *widget;
        hand_.move_to(middle(clip));
        hand_.turn(WheelTurned{0, rect.y < clip.y ? 1.0 : -1.0});
        hand_.turn();
        const Widget* const after = widgets.find(id);
        if (after == nullptr) no_such_widget(widgets, id);
        if (after->rect == rect) {  // it does not scroll any further
            if (part) return *after;
            break;
        }
    }
    throw Error("the control " + in_quotes(id) + " cannot be scrolled into sight");
}

void ControlHand::click(const std::string& id) {
    hand_.move_to(middle(*bring_into_sight(id).visible_part()));
    const Widget* const widget = widgets().find(id);
    if (widget == nullptr) no_such_widget(widgets(), id);
    if (!widget->enabled) throw Error("the control " + in_quotes(id) + " is greyed");
    hand_.click();
    hand_.settle();
}

void ControlHand::enter_text(const std::string& text) {
    hand_.stroke({{.control = true}, Key::a});
    hand_.type(characters_of(text));
    hand_.stroke({{}, Key::enter});
    hand_.settle();
}

void ControlHand::set_number(const std::string& id, const json& value) {
    if (!value.is_number()) throw Error(in_quotes(id) + " takes a number, not " + shown(value));
    hand_.turn(KeyChanged{Key::control, true, false});
    click(id);
    hand_.turn(KeyChanged{Key::control, false, false});
    enter_text(number_text(value.get<double>()));
}

void ControlHand::set_color(const std::string& id, const json& value) {
    if (!value.is_array() || value.size() != 3)
        throw Error(in_quotes(id) + " takes a colour [r, g, b], linear, not " + shown(value));
    click(id);
    set_number(id + ".r", value[0]);
    set_number(id + ".g", value[1]);
    set_number(id + ".b", value[2]);
    hand_.stroke({{}, Key::escape});
    hand_.settle();
}

void ControlHand::choose(const std::string& id, const json& value) {
    if (!value.is_string() && !value.is_number_unsigned())
        throw Error(in_quotes(id) + " takes a word, not " + shown(value));
    // words may be whole numbers
    const std::string option =
        id + "." + (value.is_string() ? value.get<std::string>() : value.dump());
    const Widgets& widgets = this->widgets();
    if (widgets.find(option) == nullptr) click(id);
    if (widgets.find(option) == nullptr) {
        std::vector<std::string> options;
        for (const auto& [other, widget] : widgets.all())
            if (other.starts_with(id + ".")) options.push_back(other.substr(id.size() + 1));
        throw Error(in_quotes(id) + " has no choice " + shown(value) + "; it has " +
                    some_of(options));
    }
    click(option);
}

void ControlHand::set(const std::string& id, const json& value) {
    const Message before = viewer_.state().message;
    const Widget widget = bring_into_sight(id);
    switch (widget.kind) {
        case WidgetKind::toggle:
            if (!value.is_boolean())
                throw Error(in_quotes(id) + " takes true or false, not " + shown(value));
            if (widget.on != value.get<bool>()) click(id);
            break;
        case WidgetKind::number:
            set_number(id, value);
            break;
        case WidgetKind::color:
            set_color(id, value);
            break;
        case WidgetKind::choice:
            choose(id, value);
            break;
        case WidgetKind::text:
            if (!value.is_string())
                throw Error(in_quotes(id) + " takes a text, not " + shown(value));
            click(id);
            enter_text(value.get<std::string>());
            break;
        case WidgetKind::button:
        case WidgetKind::menu:
        case WidgetKind::row:
            throw Error(in_quotes(id) + " can be clicked, not set; leave \"set\" out");
    }
    const Message& after = viewer_.state().message;
    if (after.error && !after.text.empty() && after.text != before.text)
        throw Error(in_quotes(id) + " is not set to " + shown(value) + ": " + after.text);
}

}  // namespace ivory
