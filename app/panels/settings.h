// What a user sets for himself, kept from one day to the next.
//
// A JSON object, one member a setting, in $XDG_CONFIG_HOME/ivory/settings.json or
// ~/.config/ivory/settings.json. The list of settings stands in settings.cpp; members that are not
// on it are kept as they are.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "app/platform/input.h"
#include "app/platform/window_rect.h"

namespace ivory {

// Points of the screen.
inline constexpr int least_window_side = 64, largest_window_side = 32768;

// A pixel, of the final picture.
inline constexpr std::array samples_to_choose{1, 4, 16};

struct UserSettings {
    Theme theme = Theme::dark;
    bool panels_shown = true, skeleton_shown = true;
    int window_width = 1280, window_height = 720;  // points, where it is not maximised
    bool window_maximised = false;
    int samples = samples_to_choose.back();
    friend bool operator==(const UserSettings&, const UserSettings&) = default;
};

// Where the settings are kept, as the XDG base directory specification has it: relative paths in
// the environment do not count. Nothing where the environment names no folder.
[[nodiscard]] std::optional<std::filesystem::path> settings_path();

// The settings' file, which other viewers write too.
class SettingsFile {
  public:
    // Without a file nothing is read or written.
    explicit SettingsFile(std::optional<std::filesystem::path> file) : file_(std::move(file)) {}

    // The defaults, and what the file says instead. A file that is not JSON is set aside as
    // settings.json.broken, a value that may not be is passed over; take_complaint() says so.
    UserSettings read();

    // Writes the values that are not what was last read or written here, and no other one of the
    // file. Nothing is done where there are none, nor where the file could not be read. Failures
    // are said once.
    void keep(const UserSettings& now);

    // What went wrong since it was last asked for: one line. Empty: nothing.
    [[nodiscard]] std::string take_complaint();

  private:
    void complain(const std::string& line);
    bool set_aside(const std::string& why);
    std::string new_text(const UserSettings& now);

    std::optional<std::filesystem::path> file_;
    UserSettings last_;  // as last read or written
    std::string complaint_;
    bool has_failed_ = false;
};

}  // namespace ivory
