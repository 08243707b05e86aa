#include "app/panels/widgets.h"

#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <cmath>

namespace ivory {

namespace {

WindowRect rect_between(const ImVec2& lo, const ImVec2& hi) {
    const int x = static_cast<int>(std::floor(lo.x)), y = static_cast<int>(std::floor(lo.y));
    return {x, y, static_cast<int>(std::ceil(hi.x)) - x, static_cast<int>(std::ceil(hi.y)) - y};
}

}  // namespace

std::optional<WindowRect> Widget::visible_part() const {
    const int x0 = std::max(rect.x, clip.x), y0 = std::max(rect.y, clip.y);
    const int x1 = std::min(rect.x + rect.width, clip.x + clip.width);
    const int y1 = std::min(rect.y + rect.height, clip.y + clip.height);
    if (x0 >= x1 || y0 >= y1) return std::nullopt;
    return WindowRect{x0, y0, x1 - x0, y1 - y0};
}

void Widgets::add(const std::string& id, WidgetKind kind, bool on) {
    add(id, kind, rect_between(ImGui::GetItemRectMin(), ImGui::GetItemRectMax()), on);
}

void Widgets::add(const std::string& id, WidgetKind kind, const WindowRect& rect, bool on) {
    const ImDrawList& list = *ImGui::GetWindowDrawList();
    const bool enabled = (ImGui::GetItemFlags() & ImGuiItemFlags_Disabled) == 0;
    widgets_.try_emplace(
        id, Widget{kind, rect, rect_between(list.GetClipRectMin(), list.GetClipRectMax()), on,
                   enabled});
}

const Widget* Widgets::find(const std::string& id) const {
    const auto found = widgets_.find(id);
    if (found != widgets_.end()) return &found->second;
    const auto widget = out_of_sight_ ? out_of_sight_(id) : std::nullopt;
    if (!widget) return nullptr;
    return &found_.insert_or_assign(id, *widget).first->second;
}

}  // namespace ivory
