#include <imgui.h>

#include <string>
#include <utility>

#include "app/panels/fields.h"
#include "app/panels/files.h"
#include "core/scene/text.h"

namespace ivory {

namespace {

constexpr const char* question_id = "Unsaved changes";

void draw_question(ViewerState& state) {
    PanelMemory& memory = state.panels;
    if (memory.question && !memory.question_shown) {
        ImGui::OpenPopup(question_id);
        memory.question_shown = true;
    }
    if (!begin_dialog(state, question_id)) {
        memory.question_shown = false;
        return;
    }
    const auto& path = state.document.path();
    const std::string name = path ? printable(path->filename().string(), 60) : "the untitled scene";
    ImGui::PushFont(state.fonts.strong);
    ImGui::TextUnformatted(("Save the changes to " + name + "?").c_str());
    ImGui::PopFont();
    ImGui::Dummy({px(state, 380), px(state, 2)});
    ImGui::TextDisabled("Without saving they are lost.");
    ImGui::Dummy({0, px(state, 10)});

    const float width = px(state, 120);
    const bool save = text_button(state, "unsaved.save", "Save", width, true, true) ||
                      ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Enter), false);
    ImGui::SameLine();
    const bool discard = text_button(state, "unsaved.discard", "Don't save", width);
    ImGui::SameLine();
    const bool cancel = text_button(state, "unsaved.cancel", "Cancel", width) ||
                        ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape), false);
    if (!memory.question || save || discard || cancel) {
        ImGui::CloseCurrentPopup();
        memory.question_shown = false;
    }
    ImGui::EndPopup();
    if (!memory.question || !(save || discard || cancel)) return;
    Pending pending = *std::exchange(memory.question, std::nullopt);
    if (save)
        save_or_ask(state, std::move(pending));
    else if (discard)
        perform(state, pending);
}

}  // namespace

void draw_dialogs(ViewerState& state) {
    draw_question(state);
    draw_file_browser(state);
}

}  // namespace ivory
