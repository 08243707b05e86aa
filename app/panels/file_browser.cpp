#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include "app/panels/buttons.h"
#include "app/panels/files.h"
#include "app/panels/layout.h"
#include "app/panels/panels.h"
#include "app/panels/scene_edits.h"
#include "app/panels/text_field.h"
#include "app/panels/theme.h"
#include "core/scene/text.h"

namespace ivory {

namespace {

namespace fs = std::filesystem;

constexpr const char* browser_id = "Files";
constexpr const char* extension = ".ivory.json";
constexpr const char* replace_label = "Replace\xE2\x80\xA6";  // a question follows

bool is_scene_name(const std::string& name) { return name.ends_with(".json"); }

// Folders and scene files, without hidden ones, by name.
void read_folder(FileBrowser& browser, const fs::path& folder) {
    std::error_code error;
    fs::path whole = fs::weakly_canonical(folder, error);
    if (error) whole = folder;
    std::vector<FileBrowser::Entry> entries;
    fs::directory_iterator entry(whole, error);
    if (error) {
        browser.fault = printable(whole.string(), 120) + ": " + error.message();
        return;
    }
    for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
        std::error_code ignored;
        const std::string name = entry->path().filename().string();
        const bool is_folder = entry->is_directory(ignored);
        if (name.starts_with('.') || (!is_folder && !is_scene_name(name))) continue;
        entries.push_back({name, is_folder});
    }
    std::sort(entries.begin(), entries.end(), [](const auto& a, const auto& b) {
        return a.folder != b.folder ? a.folder : a.name < b.name;
    });
    browser.folder = whole;
    browser.folder_text = whole.string();
    browser.entries = std::move(entries);
    browser.fault.clear();
}

void begin(ViewerState& state, FileBrowser::Mode mode) {
    FileBrowser& browser = state.panels.browser;
    const auto& path = state.document.path();
    browser = {};
    browser.mode = mode;
    browser.just_opened = browser.name_wanted = true;
    std::error_code ignored;
    read_folder(browser,
                path && path->has_parent_path() ? path->parent_path() : fs::current_path(ignored));
    if (mode == FileBrowser::Mode::save)
        browser.name =
            path && *path != "-" ? path->filename().string() : std::string("untitled") + extension;
}

// As it stands in the field, entered or not.
std::string name_now(const ViewerState& state) {
    const TypedText& typed = state.panels.text;
    return typed.id == "browser.name" ? typed.text : state.panels.browser.name;
}

// What a name stands for in the folder, its ending added where it is to be saved.
fs::path chosen_path(const FileBrowser& browser, std::string name) {
    if (browser.mode == FileBrowser::Mode::save && !name.ends_with(".json")) name += extension;
    return browser.folder / name;
}

// Whether the entry is what the name names.
bool stands_for(const FileBrowser& browser, const std::string& name, const std::string& entry) {
    return name == entry || (!name.empty() && chosen_path(browser, name) == browser.folder / entry);
}

// Goes into a folder; opens or saves a file. True where the browser is done.
bool accept(ViewerState& state) {
    FileBrowser& browser = state.panels.browser;
    if (browser.name.empty()) return false;
    browser.fault.clear();
    std::error_code ignored;
    if (const fs::path folder = browser.folder / browser.name; fs::is_directory(folder, ignored)) {
        read_folder(browser, folder);
        browser.name.clear();
        return false;
    }
    const fs::path path = chosen_path(browser, browser.name);
    if (browser.mode == FileBrowser::Mode::save) {
        state.message = {};
        if (save_as(state, path, browser.after)) return true;
        browser.fault = state.message.text;
        return false;
    }
    if (!fs::exists(path, ignored)) {
        browser.fault = printable(path.filename().string(), 80) + " is not in this folder";
        return false;
    }
    request_open(state, path);
    return true;
}

// A line of the list; true where it was double-clicked.
bool draw_entry(ViewerState& state, const FileBrowser::Entry& entry) {
    FileBrowser& browser = state.panels.browser;
    const Palette& colors = palette(state.theme);
    const float height = ImGui::GetFrameHeight();
    ImGui::PushID(entry.name.c_str());
    const bool clicked = ImGui::Selectable(
        "##entry", stands_for(browser, name_now(state), entry.name),
        ImGuiSelectableFlags_AllowDoubleClick | ImGuiSelectableFlags_DontClosePopups, {0, height});
    state.widgets.add("browser.entry." + entry.name, WidgetKind::row);
    const ImVec2 lo = ImGui::GetItemRectMin();
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const float middle = lo.y + 0.5f * height;
    draw_icon(list, entry.folder ? Icon::folder : Icon::file, {lo.x + px(state, 14), middle},
              px(state, 14), packed(entry.folder ? colors.accent : colors.quiet));
    list.AddText({lo.x + px(state, 30), std::floor(middle - 0.5f * ImGui::GetFontSize())},
                 packed(colors.text), printable(entry.name, 100).c_str());
    ImGui::PopID();
    if (clicked) browser.name = entry.name;
    return clicked && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left);
}

// True where an entry was double-clicked.
bool draw_entries(ViewerState& state, float height) {
    FileBrowser& browser = state.panels.browser;
    const Palette& colors = palette(state.theme);
    ImGui::PushStyleColor(ImGuiCol_ChildBg, colors.field);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {px(state, 6), px(state, 6)});
    ImGui::BeginChild("entries", {0, height}, false,
                      ImGuiWindowFlags_NoNavInputs | ImGuiWindowFlags_AlwaysUseWindowPadding);
    ImGui::PopStyleVar();
    bool double_clicked = false;
    for (const FileBrowser::Entry& entry : browser.entries)
        double_clicked |= draw_entry(state, entry);
    if (browser.entries.empty()) ImGui::TextDisabled("no scenes and no folders here");
    ImGui::EndChild();
    ImGui::PopStyleColor();
    return double_clicked;
}

void draw_contents(ViewerState& state) {
    FileBrowser& browser = state.panels.browser;
    const bool saving = browser.mode == FileBrowser::Mode::save;
    const float button = px(state, 110), spacing = ImGui::GetStyle().ItemSpacing.x;
    const std::string was_typed = state.panels.text.id;

    ImGui::PushFont(state.fonts.strong);
    ImGui::TextUnformatted(saving ? "Save scene as" : "Open scene");
    ImGui::PopFont();
    ImGui::Dummy({0, px(state, 4)});
    if (text_button(state, "browser.up", "Up")) read_folder(browser, browser.folder.parent_path());
    ImGui::SameLine();
    if (text_field(state, "browser.path", browser.folder_text, field_width(), "folder"))
        read_folder(browser, browser.folder_text);

    const float below = 2 * ImGui::GetFrameHeightWithSpacing() +
                        ImGui::GetTextLineHeightWithSpacing() + px(state, 8);
    bool done = draw_entries(state, ImGui::GetContentRegionAvail().y - below);

    // Until the field has the keys: ImGui gives them a frame after they were asked for.
    const std::string& typed = state.panels.text.id;
    browser.name_wanted = browser.name_wanted && saving && typed != "browser.name";
    text_field(state, "browser.name", browser.name, field_width(), "file name",
               browser.name_wanted);
    // Who went on typing saves with Enter; who clicked into a field first leaves it with Enter.
    if (ImGui::IsItemClicked()) browser.name_clicked = true;
    // Keys that were pressed before the browser was seen, or that answer a question, are not its
    // own.
    const bool has_keys = !browser.just_opened && !state.panels.file_question;
    const bool enter = has_keys && plain_key_pressed(ImGuiKey_Enter);
    done |= enter && was_typed != "browser.path" &&
            !(was_typed == "browser.name" && browser.name_clicked);
    if (enter) browser.name_clicked = false;
    const std::string name = name_now(state);
    std::error_code ignored;
    const bool enters = !name.empty() && fs::is_directory(browser.folder / name, ignored);
    const bool replaces = saving && !name.empty() && !enters &&
                          fs::is_regular_file(chosen_path(browser, name), ignored);
    if (!browser.fault.empty()) {
        ImGui::PushStyleColor(ImGuiCol_Text, palette(state.theme).x);
        ImGui::TextUnformatted(browser.fault.c_str());
        ImGui::PopStyleColor();
    } else if (replaces) {
        ImGui::TextDisabled("There is such a file: it is replaced after a question.");
    } else {
        ImGui::TextUnformatted("");
    }

    ImGui::SetCursorPosX(ImGui::GetWindowContentRegionMax().x - 2 * button - spacing);
    const bool cancel =
        text_button(state, "browser.cancel", "Cancel", button) ||
        (has_keys && plain_key_pressed(ImGuiKey_Escape) && state.panels.text.id.empty());
    ImGui::SameLine();
    done |= text_button(state, "browser.ok",
                        replaces            ? replace_label
                        : saving && !enters ? "Save"
                                            : "Open",
                        button, !name.empty(), true);
    browser.just_opened = false;
    if (cancel || (done && accept(state))) browser.mode = FileBrowser::Mode::closed;
}

}  // namespace

void browse_to_open(ViewerState& state) { begin(state, FileBrowser::Mode::open); }

void browse_to_save(ViewerState& state, std::optional<Pending> after) {
    begin(state, FileBrowser::Mode::save);
    state.panels.browser.after = std::move(after);
}

void draw_file_browser(ViewerState& state) {
    FileBrowser& browser = state.panels.browser;
    if (browser.mode != FileBrowser::Mode::closed && browser.just_opened &&
        !ImGui::IsPopupOpen(browser_id))
        ImGui::OpenPopup(browser_id);
    if (!begin_dialog(state, browser_id, px(state, 640), px(state, 480))) return;
    if (browser.mode != FileBrowser::Mode::closed) draw_contents(state);
    if (browser.mode != FileBrowser::Mode::closed) draw_file_question(state);
    if (browser.mode == FileBrowser::Mode::closed) ImGui::CloseCurrentPopup();
    ImGui::EndPopup();
}

}  // namespace ivory
