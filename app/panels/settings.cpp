#include "app/panels/settings.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <system_error>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "core/scene/error.h"
#include "core/scene/json_reader.h"
#include "core/scene/read_file.h"
#include "core/scene/text.h"
#include "core/scene/write_file.h"

namespace ivory {

namespace {

namespace fs = std::filesystem;

// Kinds of settings: where the value stands in UserSettings, and what it may be.
struct Switch {
    bool UserSettings::*value;
};
struct Whole {
    int UserSettings::*value;
    int least, greatest;
};
struct Look {
    Theme UserSettings::*value;
};
struct Samples {
    int UserSettings::*value;
};

constexpr std::array<std::string_view, 2> theme_words{"dark", "light"};  // in the order of Theme

// The defaults are those of UserSettings.
struct Setting {
    std::string_view key;
    std::variant<Switch, Whole, Look, Samples> kind;
};

constexpr std::array settings = {
    Setting{"theme", Look{&UserSettings::theme}},
    Setting{"panels", Switch{&UserSettings::panels_shown}},
    Setting{"skeleton", Switch{&UserSettings::skeleton_shown}},
    Setting{"samples", Samples{&UserSettings::samples}},
    Setting{"window_width",
            Whole{&UserSettings::window_width, least_window_side, largest_window_side}},
    Setting{"window_height",
            Whole{&UserSettings::window_height, least_window_side, largest_window_side}},
    Setting{"window_maximised", Switch{&UserSettings::window_maximised}},
};

// Takes the value over; otherwise what it would have to be. Text of JSON of the value that stands.
struct Access {
    UserSettings& all;

    std::string take(const Switch& setting, const JsonValue& value) const {
        if (value.kind() != JsonKind::boolean) return "true or false";
        all.*setting.value = value.boolean();
        return "";
    }
    std::string take(const Whole& setting, const JsonValue& value) const {
        const double number = value.kind() == JsonKind::number ? value.number() : NAN;
        if (!(number >= setting.least && number <= setting.greatest) ||
            std::floor(number) != number)
            return "a whole number from " + std::to_string(setting.least) + " to " +
                   std::to_string(setting.greatest);
        all.*setting.value = static_cast<int>(number);
        return "";
    }
    std::string take(const Look& setting, const JsonValue& value) const {
        for (std::size_t i = 0; i < theme_words.size(); ++i) {
            if (value.kind() != JsonKind::text || !value.is_word(theme_words[i])) continue;
            all.*setting.value = static_cast<Theme>(i);
            return "";
        }
        return listed(theme_words, "or");
    }

    std::string take(const Samples& setting, const JsonValue& value) const {
        for (const int number : samples_to_choose) {
            if (value.kind() != JsonKind::number || value.number() != number) continue;
            all.*setting.value = number;
            return "";
        }
        return "1, 4 or 16";
    }

    std::string text(const Samples& setting) const { return std::to_string(all.*setting.value); }
    std::string text(const Switch& setting) const { return all.*setting.value ? "true" : "false"; }
    std::string text(const Whole& setting) const { return std::to_string(all.*setting.value); }
    std::string text(const Look& setting) const {
        return "\"" + std::string(theme_words[static_cast<std::size_t>(all.*setting.value)]) + "\"";
    }
};

std::string text_of(const Setting& setting, UserSettings all) {
    return std::visit([&](const auto& kind) { return Access{all}.text(kind); }, setting.kind);
}

std::string quoted(const std::string& text) {
    return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

// A value of a member that is not ours.
std::string text_of(const JsonValue& value) {
    std::string all;
    switch (value.kind()) {
        case JsonKind::null:
            break;
        case JsonKind::boolean:
            return value.boolean() ? "true" : "false";
        case JsonKind::number:
            return number_text(value.number());
        case JsonKind::text:
            return quoted(value.text());
        case JsonKind::list:
            for (const JsonValue item : value.items())
                all += (all.empty() ? "" : ", ") + text_of(item);
            return "[" + all + "]";
        case JsonKind::object:
            for (const JsonMember member : value.members())
                all += (all.empty() ? "" : ", ") + quoted(member.key.text()) + ": " +
                       text_of(member.value);
            return "{" + all + "}";
    }
    return "null";
}

// Nothing where there is no file. Throws Error where it is none that could be read.
std::optional<std::string> bytes_of(const fs::path& file) {
    std::error_code error;
    const fs::file_status status = fs::status(file, error);
    if (status.type() == fs::file_type::not_found) return std::nullopt;
    // A pipe would be waited for.
    if (!error && status.type() != fs::file_type::regular)
        throw Error(file_label(file) + ": is not a file; settings are not kept");
    return read_file(file);
}

// The root, which is an object. Throws Error where it is none.
JsonValue settings_of(const SourceText& source, const JsonDocument& document) {
    const JsonValue root = document.root();
    if (root.kind() != JsonKind::object)
        throw source.fault(root.offset(), "",
                           root.description() + " stands here; it must be an object");
    return root;
}

// The folder and those above it, where they are missing, for nobody else's eyes: as the XDG
// specification wants it. Failures show when the file is written.
void make_folder(const fs::path& folder) {
    std::error_code ignored;
    if (folder.empty() || fs::exists(folder, ignored)) return;
    make_folder(folder.parent_path());
    static_cast<void>(::mkdir(folder.c_str(), 0700));
}

// Keeps other viewers from writing between our reading and our writing, for a while: where a lock
// is not to be had, the file still is whole whoever writes it last.
class FolderLock {
  public:
    explicit FolderLock(const fs::path& folder)
        : descriptor_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
        constexpr int most_tries = 40;
        for (int tries = 0; descriptor_ >= 0 && tries < most_tries; ++tries) {
            if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
    }
    ~FolderLock() {
        if (descriptor_ >= 0) ::close(descriptor_);
    }
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;

  private:
    int descriptor_;
};

}  // namespace

std::optional<fs::path> settings_path() {
    const auto folder_in = [](const char* variable) -> std::optional<fs::path> {
        const char* const value = std::getenv(variable);
        if (value == nullptr || !fs::path(value).is_absolute()) return std::nullopt;
        return fs::path(value);
    };
    std::optional<fs::path> folder = folder_in("XDG_CONFIG_HOME");
    if (!folder) {
        folder = folder_in("HOME");
        if (!folder) return std::nullopt;
        *folder /= ".config";
    }
    return *folder / "ivory" / "settings.json";
}

void SettingsFile::complain(const std::string& line) {
    if (complaint_.empty()) complaint_ = line;
}

std::string SettingsFile::take_complaint() { return std::exchange(complaint_, ""); }

UserSettings SettingsFile::read() {
    last_ = {};
    if (!file_) return last_;
    std::optional<std::string> bytes;
    try {
        bytes = bytes_of(*file_);
    } catch (const Error& error) {
        complain(error.what());
        file_.reset();  // nor is it written over
    }
    if (!bytes) return last_;
    const SourceText source(*bytes, file_label(*file_));
    try {
        const JsonDocument document = parse_json(source);
        const JsonValue root = settings_of(source, document);
        for (const Setting& setting : settings) {
            const std::optional<JsonValue> value = find_member(root, setting.key);
            if (!value) continue;
            const std::string expected = std::visit(
                [&](const auto& kind) { return Access{last_}.take(kind, *value); }, setting.kind);
            if (expected.empty()) continue;
            complain(source
                         .fault(value->offset(), pointer_into("", setting.key),
                                value->description() + " stands here; it must be " + expected +
                                    "; taken as " + text_of(setting, last_))
                         .what());
        }
    } catch (const Error& error) {
        if (!set_aside(error.what())) file_.reset();
    }
    return last_;
}

// True where nothing has the file's name any more.
bool SettingsFile::set_aside(const std::string& why) {
    constexpr int most = 100;  // of them
    for (int i = 1; i <= most; ++i) {
        fs::path aside = *file_;
        aside += i == 1 ? ".broken" : ".broken-" + std::to_string(i);
        // unlike a rename this replaces nothing
        if (::link(file_->c_str(), aside.c_str()) != 0) {
            if (errno == EEXIST) continue;
            break;
        }
        if (::unlink(file_->c_str()) != 0) {
            ::unlink(aside.c_str());
            break;
        }
        complain(why + "; set aside as " + printable(aside.filename().string()));
        return true;
    }
    complain(why + "; settings are not kept");
    return false;
}

// The file's members with the values that were changed here. Throws Error where it cannot be read.
std::string SettingsFile::new_text(const UserSettings& now) {
    std::vector<std::pair<std::string, std::string>> members;
    if (const std::optional<std::string> bytes = bytes_of(*file_)) {
        const SourceText source(*bytes, file_label(*file_));
        try {
            const JsonDocument document = parse_json(source);
            for (const JsonMember member : settings_of(source, document).members())
                members.emplace_back(member.key.text(), text_of(member.value));
        } catch (const Error& error) {
            if (!set_aside(error.what())) throw;
        }
    }
    for (const Setting& setting : settings) {
        const std::string text = text_of(setting, now);
        if (text == text_of(setting, last_)) continue;
        const auto member = std::find_if(members.begin(), members.end(),
                                         [&](const auto& m) { return m.first == setting.key; });
        if (member == members.end())
            members.emplace_back(setting.key, text);
        else
            member->second = text;
    }
    std::string all;
    for (const auto& [key, text] : members)
        all += (all.empty() ? "\n  " : ",\n  ") + quoted(key) + ": " + text;
    return "{" + all + "\n}\n";
}

void SettingsFile::keep(const UserSettings& now) {
    if (!file_ || now == last_) return;
    try {
        make_folder(file_->parent_path());
        const FolderLock lock(file_->parent_path());
        write_file(*file_, new_text(now));
        last_ = now;
    } catch (const Error& error) {
        if (!std::exchange(has_failed_, true)) complain(error.what());
    }
}

}  // namespace ivory
