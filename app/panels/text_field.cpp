#include "app/panels/text_field.h"

#include <cstddef>

#include "app/panels/layout.h"
#include "app/panels/shown_text.h"
#include "core/scene/text.h"

namespace ivory {

namespace {

constexpr std::size_t most_shown = 400;  // characters of a text in its tooltip

// Text fields for std::string, which grows as is typed.
int grow(ImGuiInputTextCallbackData* data) {
    auto& text = *static_cast<std::string*>(data->UserData);
    text.resize(static_cast<std::size_t>(data->BufTextLen));
    data->Buf = text.data();
    return 0;
}

}  // namespace

bool text_field(ViewerState& state, const std::string& id, std::string& text, float width,
                const char* hint, bool focus) {
    TypedText& typed = state.panels.text;
    ImGui::PushID(id.c_str());
    if (focus) ImGui::SetKeyboardFocusHere();
    ImGui::SetNextItemWidth(width);
    const std::string before = shown_text(state, text);
    std::string shown = typed.id == id ? typed.text : before;
    input_text("##text", hint, shown, ImGuiInputTextFlags_AutoSelectAll);
    state.widgets.add(id, WidgetKind::text);
    const float inside = width - 2 * ImGui::GetStyle().FramePadding.x;
    if (!ImGui::IsItemActive() && ImGui::CalcTextSize(shown.c_str()).x > inside)
        tooltip(printable(shown, most_shown).c_str());
    bool entered = false;
    if (ImGui::IsItemActive()) {
        typed = {id, shown};
    } else if (typed.id == id) {
        entered = ImGui::IsItemDeactivated() && shown != before;
        if (entered) text = meant_text(shown);
        typed = {};
    }
    ImGui::PopID();
    return entered;
}

bool input_text(const char* name, const char* hint, std::string& text, ImGuiInputTextFlags flags) {
    return ImGui::InputTextWithHint(name, hint, text.data(), text.capacity() + 1,
                                    flags | ImGuiInputTextFlags_CallbackResize, grow, &text);
}

}  // namespace ivory
