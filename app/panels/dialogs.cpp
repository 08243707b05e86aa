#include <imgui.h>

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "app/panels/buttons.h"
#include "app/panels/files.h"
#include "app/panels/layout.h"
#include "app/panels/scene_edits.h"
#include "core/scene/text.h"

namespace ivory {

namespace {

constexpr const char* question_id = "Unsaved changes";
constexpr const char* file_question_id = "File question";

struct Answer {
    const char* id;
    const char* label;
};

void draw_text(const ViewerState& state, const std::string& strong, const std::string& quiet) {
    ImGui::PushFont(state.fonts.strong);
    ImGui::TextUnformatted(strong.c_str());
    ImGui::PopFont();
    ImGui::Dummy({px(state, 380), px(state, 2)});
    ImGui::TextDisabled("%s", quiet.c_str());
    ImGui::Dummy({0, px(state, 10)});
}

// A row of buttons; the answer that is given. Arrows and Tab go from one to the next, Enter gives
// the one that stands out (at first `first`), Escape the last one. Keys that were pressed before
// the question was seen are no answer to it.
std::optional<std::size_t> draw_answers(ViewerState& state, std::span<const Answer> answers,
                                        std::size_t first) {
    const auto pressed = [](ImGuiKey key) {
        return ImGui::IsKeyPressed(ImGui::GetKeyIndex(key), true);
    };
    std::optional<std::size_t>& chosen = state.panels.answer;
    std::optional<std::size_t> given;
    if (chosen) {
        if (pressed(ImGuiKey_RightArrow) || pressed(ImGuiKey_Tab))
            chosen = (*chosen + 1) % answers.size();
        if (pressed(ImGuiKey_LeftArrow)) chosen = (*chosen + answers.size() - 1) % answers.size();
        if (plain_key_pressed(ImGuiKey_Enter)) given = chosen;
        if (plain_key_pressed(ImGuiKey_Escape)) given = answers.size() - 1;
    } else {
        chosen = first;
    }
    for (std::size_t i = 0; i < answers.size(); ++i) {
        if (i > 0) ImGui::SameLine();
        if (text_button(state, answers[i].id, answers[i].label, px(state, 120), true, i == chosen))
            given = i;
    }
    return given;
}

// The popup of a question, opened or closed as that stands; where true, it is to be drawn and
// ImGui::EndPopup follows.
bool begin_question(const ViewerState& state, const char* id, bool stands) {
    if (stands && !ImGui::IsPopupOpen(id)) ImGui::OpenPopup(id);
    if (!begin_dialog(state, id)) return false;
    if (stands) return true;
    ImGui::CloseCurrentPopup();
    ImGui::EndPopup();
    return false;
}

void draw_question(ViewerState& state) {
    PanelMemory& memory = state.panels;
    if (!begin_question(state, question_id, memory.question.has_value())) return;
    const auto& path = state.document.path();
    const std::string name = path ? printable(path->filename().string(), 60) : "the untitled scene";
    draw_text(state, "Save the changes to " + name + "?", "Without saving they are lost.");
    constexpr std::array answers = {Answer{"unsaved.save", "Save"},
                                    Answer{"unsaved.discard", "Don't save"},
                                    Answer{"unsaved.cancel", "Cancel"}};
    const std::optional<std::size_t> given = draw_answers(state, answers, 0);
    if (given) ImGui::CloseCurrentPopup();
    ImGui::EndPopup();
    if (!given) return;
    Pending pending = *std::exchange(memory.question, std::nullopt);
    if (given == 0u)
        save_or_ask(state, std::move(pending));
    else if (given == 1u)
        perform(state, pending);
}

void draw_replace(ViewerState& state) {
    const FileQuestion& question = *state.panels.file_question;
    const std::string name = printable(question.path.filename().string(), 60);
    const std::string folder = printable(question.path.parent_path().string(), 60);
    draw_text(state, "Replace " + name + "?",
              question.again
                  ? "Another program has just changed it. What it holds will be lost."
                  : "There is such a file in " + folder + ". What it holds will be lost.");
    constexpr std::array answers = {Answer{"replace.replace", "Replace"},
                                    Answer{"replace.cancel", "Cancel"}};
    const std::optional<std::size_t> given = draw_answers(state, answers, 1);
    if (given == 0u) {
        FileBrowser& browser = state.panels.browser;
        if (overwrite(state))
            browser.mode = FileBrowser::Mode::closed;
        else if (!state.panels.file_question)
            browser.fault = state.message.text;
    } else if (given == 1u) {
        state.panels.file_question.reset();
        state.panels.browser.name_wanted = true;
    }
}

void draw_changed(ViewerState& state) {
    const FileQuestion& question = *state.panels.file_question;
    const std::string name = printable(question.path.filename().string(), 60);
    draw_text(state, "Another program has changed " + name + ".",
              question.again ? "It has just been changed once more."
                             : "It is not what was opened or last saved here.");
    constexpr std::array answers = {
        Answer{"changed.overwrite", "Overwrite"}, Answer{"changed.save_as", "Save as\xE2\x80\xA6"},
        Answer{"changed.reload", "Reload"}, Answer{"changed.cancel", "Cancel"}};
    const std::optional<std::size_t> given = draw_answers(state, answers, 3);
    if (given == 0u) {
        overwrite(state);
    } else if (given == 1u) {
        const FileQuestion asked = *std::exchange(state.panels.file_question, std::nullopt);
        browse_to_save(state, asked.after);
    } else if (given == 2u) {
        reload(state);
    } else if (given == 3u) {
        state.panels.file_question.reset();
    }
}

}  // namespace

void draw_file_question(ViewerState& state) {
    const std::optional<FileQuestion>& question = state.panels.file_question;
    if (!begin_question(state, file_question_id, question.has_value())) return;
    if (question->kind == FileQuestion::Kind::replace)
        draw_replace(state);
    else
        draw_changed(state);
    if (!question) ImGui::CloseCurrentPopup();
    ImGui::EndPopup();
}

void draw_dialogs(ViewerState& state) {
    draw_question(state);
    draw_file_browser(state);
    if (state.panels.browser.mode == FileBrowser::Mode::closed) draw_file_question(state);
}

}  // namespace ivory
