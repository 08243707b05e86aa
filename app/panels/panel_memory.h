// What the panels remember from one frame to the next, and nobody else reads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "app/document/file_stamp.h"
#include "app/document/surface_bounds.h"
#include "core/scene/scene.h"

namespace ivory {

// The number that is being typed.
struct TypedNumber {
    std::string id;    // of its control
    std::string text;  // as it stands in the field
    std::string before;
    int frames = 0;  // since it was opened
    bool focused = false;
    bool drawn = true;  // in this frame
};

// The number, slider or colour that is being dragged.
struct DraggedField {
    std::string id;
    double start = 0;  // the number when the drag began
    double way = 0;    // pixels, fewer with Shift
    float last_x = 0;  // of the pointer
    bool begun = false, cancelled = false;
    bool of_camera = false;
};

struct TypedText {
    std::string id, text;
};

// What waits for the answer to the question about unsaved changes.
struct Pending {
    enum class Kind : std::uint8_t { open, start_anew, quit };
    Kind kind = Kind::quit;
    std::filesystem::path path;  // of open
};

// What waits for the answer to a question about the file that is to be written.
struct FileQuestion {
    enum class Kind : std::uint8_t {
        replace,  // there is a file of that name
        changed,  // the document's own, by another program
    };
    Kind kind = Kind::replace;
    std::filesystem::path path;
    std::optional<FileStamp> seen;  // the file that the question is about
    std::optional<Pending> after;   // when it has been saved
    bool again = false;             // the file has changed since it was asked about
};

struct FileBrowser {
    enum class Mode : std::uint8_t { closed, open, save };
    struct Entry {
        std::string name;
        bool folder = false;
    };
    Mode mode = Mode::closed;
    std::filesystem::path folder;
    std::vector<Entry> entries;  // folders first
    std::string folder_text, name;
    std::string fault;  // one line; empty: none
    bool just_opened = false, name_clicked = false;
    bool name_wanted = false;      // the name is to be typed, all of it selected
    std::optional<Pending> after;  // when it has been saved
};

struct ThresholdRange {
    double least = 1e-3, most = 1;
};

struct PanelMemory {
    std::optional<TypedNumber> number;
    bool type_next = false;  // Tab: the next number field is to be typed into
    DraggedField dragged;
    TypedText text;
    bool name_wanted = false;  // the name of the selected element is to be typed

    std::optional<std::string> view;  // the name of the saved view that was chosen last
    bool view_name_wanted = false;    // is to be typed

    std::optional<Pending> question;
    std::optional<FileQuestion> file_question;
    // Of the question that is shown: one at a time.
    std::optional<std::size_t> answer;  // the one that Enter gives; none: not shown yet
    FileBrowser browser;

    // Something is asked for, and keys are its answer.
    [[nodiscard]] bool dialog_open() const {
        return question || file_question || browser.mode != FileBrowser::Mode::closed;
    }

    std::size_t place = 0;  // of a list of places: the one that buttons insert after and remove
    std::optional<std::size_t> row_shown;  // the selection that the list last scrolled to

    // Derived from a scene, kept until there is another one.
    std::shared_ptr<const Scene> named, ranged;
    std::vector<std::string> names;                            // element_names of `named`
    std::unordered_map<std::string_view, std::size_t> places;  // of `names`; empty: not asked for
    ThresholdRange thresholds;                                 // of `ranged`: the slider's ends
    SurfaceBounds surface;                                     // of the document's scene
};

}  // namespace ivory
