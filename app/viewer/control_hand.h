// The hand on the viewer's controls, by their names: a person scrolls to them, opens their menus, clicks and
// types.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "app/panels/widgets.h"
#include "app/viewer/hand.h"
#include "app/viewer/viewer.h"

namespace ivory {

// What fails throws Error: which control, what is wrong, what would be right.
class ControlHand {
  public:
    ControlHand(Hand& hand, Viewer& viewer) : hand_(hand), viewer_(viewer) {}

    void point_at(const std::string& id);
    void click(const std::string& id);
    // What a person does to give it exactly that value.
    void set(const std::string& id, const nlohmann::json& value);

  private:
    // The widget with that id in sight, scrolled to and its menu opened if need be.
    const Widget& bring_into_sight(const std::string& id);
    void set_number(const std::string& id, const nlohmann::json& value);
    void set_color(const std::string& id, const nlohmann::json& value);
    void choose(const std::string& id, const nlohmann::json& value);
    // Into the text field that has just been opened, in place of all that stands there.
    void enter_text(const std::string& text);
    [[nodiscard]] const Widgets& widgets() const { return viewer_.state().widgets; }

    Hand& hand_;
    Viewer& viewer_;
};

}  // namespace ivory
