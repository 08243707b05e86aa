// The controls on the screen, by name: where each is and how a person gives it a value. The panels
// write it as they draw, the headless script reads it. Ids are lower-case words with dots.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "app/platform/window_rect.h"

namespace ivory {

// How `{"widget": ID, "set": V}` gives the control exactly the value V, through the input alone.
enum class WidgetKind : std::uint8_t {
    button,  // a click; cannot be set
    toggle,  // V is true or false: a click where it stands otherwise
    number,  // Ctrl+click, the shortest decimal that reads back to V, Enter
    text,    // a click, Ctrl+A, the text, Enter
    choice,  // V is a word: a click on ID unless `ID.V` is on the screen, then one on `ID.V`
    color,  // V is [r, g, b], linear: a click on ID, which opens numbers `ID.r` `ID.g` `ID.b`; these;
            // Escape
    menu,  // a click opens it, and its entries are `ID.ENTRY`
    row,   // of a list: a click selects it
};

struct Widget {
    WidgetKind kind = WidgetKind::button;
    WindowRect rect;      // whole, even where it is scrolled out of sight
    WindowRect clip;      // the part of the window that its panel shows
    bool on = false;      // toggle: how it stands
    bool enabled = true;  // a greyed control cannot be used

    // The part that can be seen; nothing where there is none.
    [[nodiscard]] std::optional<WindowRect> visible_part() const;
};

class Widgets {
  public:
    // At the start of each frame.
    void clear() {
        widgets_.clear();
        found_.clear();
        out_of_sight_ = nullptr;
    }
    // Directly after the ImGui item, whose rectangle it takes. Ids are unique in a frame: the first of
    // two with the same one stays.
    void add(const std::string& id, WidgetKind kind, bool on = false);
    // The same for what is not an ImGui item; within the ImGui window that it belongs to.
    void add(const std::string& id, WidgetKind kind, const WindowRect& rect, bool on = false);

    // What is asked, until the frame's end and the next one's start, for widgets that were left out
    // because they cannot be seen: rows of a list that is scrolled. They are not in `all`.
    using Search = std::function<std::optional<Widget>(const std::string& id)>;
    void set_out_of_sight(Search search) { out_of_sight_ = std::move(search); }

    [[nodiscard]] const Widget* find(const std::string& id) const;
    [[nodiscard]] const std::map<std::string, Widget>& all() const { return widgets_; }

  private:
    std::map<std::string, Widget> widgets_;
    Search out_of_sight_;
    mutable std::map<std::string, Widget> found_;  // by it
};

}  // namespace ivory
