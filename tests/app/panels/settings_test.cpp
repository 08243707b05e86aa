#include "app/panels/settings.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include "core/scene/read_file.h"
#include "tests/temporary_folder.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;

class Settings : public testing::Test {
  protected:
    tests::TemporaryFolder folder;
    const fs::path path = folder / "config" / "ivory" / "settings.json";
    SettingsFile file{path};

    void put(const std::string& text) {
        fs::create_directories(path.parent_path());
        std::ofstream(path) << text;
    }
    [[nodiscard]] std::string text() const { return read_file(path); }
    static UserSettings others() { return {Theme::light, false, false, 800, 600, true, 4}; }
};

// The environment as it was, afterwards.
class Environment {
  public:
    Environment(const char* name, const char* value) : name_(name) {
        if (const char* const before = std::getenv(name)) before_ = before;
        if (value != nullptr)
            ::setenv(name, value, 1);
        else
            ::unsetenv(name);
    }
    ~Environment() {
        if (before_)
            ::setenv(name_, before_->c_str(), 1);
        else
            ::unsetenv(name_);
    }
    Environment(const Environment&) = delete;
    Environment& operator=(const Environment&) = delete;

  private:
    const char* name_;
    std::optional<std::string> before_;
};

TEST(SettingsPath, IsWhereTheXdgSpecificationHasIt) {
    const auto path = [](const char* config, const char* home) {
        const Environment a("XDG_CONFIG_HOME", config), b("HOME", home);
        return settings_path().value_or("none");
    };
    EXPECT_EQ(path("/config", "/home/ann"), "/config/ivory/settings.json");
    EXPECT_EQ(path(nullptr, "/home/ann"), "/home/ann/.config/ivory/settings.json");
    EXPECT_EQ(path("", "/home/ann"), "/home/ann/.config/ivory/settings.json");
    EXPECT_EQ(path("config", "/home/ann"), "/home/ann/.config/ivory/settings.json");
    EXPECT_EQ(path(nullptr, nullptr), "none");
    EXPECT_EQ(path("config", "ann"), "none");
}

TEST_F(Settings, WhatIsKeptIsReadAgain) {
    EXPECT_EQ(file.read(), UserSettings{});
    EXPECT_FALSE(fs::exists(path));  // nothing is written that nobody set
    file.keep(UserSettings{});
    EXPECT_FALSE(fs::exists(path));
    file.keep(others());
    SettingsFile again(path);
    EXPECT_EQ(again.read(), others());
    EXPECT_EQ(file.take_complaint(), "");
    EXPECT_EQ(again.take_complaint(), "");
    struct stat status {};
    ASSERT_EQ(::stat(path.parent_path().c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, 0700u);
}

TEST_F(Settings, WithoutAFileNothingHappens) {
    SettingsFile none(std::nullopt);
    EXPECT_EQ(none.read(), UserSettings{});
    none.keep(others());
    EXPECT_EQ(none.take_complaint(), "");
}

TEST_F(Settings, TheSameAgainIsNotWritten) {
    file.read();
    file.keep(others());
    fs::remove(path);
    file.keep(others());
    EXPECT_FALSE(fs::exists(path));
}

TEST_F(Settings, WhatIsNotOnTheListStays) {
    put(R"({"later": {"list": [1, 2.5, null, "ä\n"], "on": true}, "theme": "dark"})");
    file.read();
    EXPECT_EQ(file.take_complaint(), "");
    file.keep({.theme = Theme::light});
    EXPECT_EQ(text(),
              "{\n  \"later\": {\"list\": [1, 2.5, null, \"ä\\n\"], \"on\": true},\n"
              "  \"theme\": \"light\"\n}\n");
}

TEST_F(Settings, AValueThatMayNotBeIsPassedOverWithAWord) {
    for (const std::string member :
         {R"("theme": "blue")", R"("theme": 1)", R"("panels": 1)", R"("window_width": 1e9)",
          R"("window_width": 100.5)", R"("window_height": "tall")", R"("samples": 9)"}) {
        SCOPED_TRACE(member);
        put("{" + member + R"(, "skeleton": false})");
        EXPECT_EQ(file.read(), (UserSettings{.skeleton_shown = false}));
        const std::string complaint = file.take_complaint();
        EXPECT_NE(complaint.find("settings.json: /"), std::string::npos) << complaint;
        EXPECT_NE(complaint.find("it must be"), std::string::npos) << complaint;
        EXPECT_EQ(complaint.find('\n'), std::string::npos);
    }
}

TEST_F(Settings, ABrokenFileIsSetAsideAndNoneIsReplacedByIt) {
    for (const std::string broken : {"{\"theme\": ", "[]", "", "\xFF"}) {
        put(broken);
        EXPECT_EQ(file.read(), UserSettings{});
        EXPECT_NE(file.take_complaint().find("set aside as settings.json.broken"),
                  std::string::npos);
        EXPECT_FALSE(fs::exists(path));
    }
    EXPECT_EQ(read_file(path.parent_path() / "settings.json.broken"), "{\"theme\": ");
    EXPECT_EQ(read_file(path.parent_path() / "settings.json.broken-2"), "[]");
    EXPECT_EQ(read_file(path.parent_path() / "settings.json.broken-4"), "\xFF");
    file.keep(others());
    EXPECT_EQ(SettingsFile(path).read(), others());
}

TEST_F(Settings, TwoViewersKeepOneAnothersValues) {
    SettingsFile other(path);
    file.read();
    other.read();
    file.keep({.theme = Theme::light});
    other.keep({.skeleton_shown = false});
    EXPECT_EQ(SettingsFile(path).read(),
              (UserSettings{.theme = Theme::light, .skeleton_shown = false}));
}

TEST_F(Settings, WhereItCannotBeWrittenThatIsSaidOnce) {
    fs::create_directories(path.parent_path());
    put("{}");
    file.read();
    // a folder in the place of the file
    fs::remove(path);
    fs::create_directory(path);
    file.keep({.theme = Theme::light});
    EXPECT_NE(file.take_complaint(), "");
    file.keep({.theme = Theme::light, .skeleton_shown = false});
    EXPECT_EQ(file.take_complaint(), "");
    fs::remove(path);
    file.keep({.skeleton_shown = false});  // it goes on where it can
    EXPECT_EQ(SettingsFile(path).read(), (UserSettings{.skeleton_shown = false}));
}

TEST_F(Settings, WhatIsNoFileIsLeftAlone) {
    fs::create_directories(path.parent_path());
    ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
    EXPECT_EQ(file.read(), UserSettings{});  // and does not wait for a writer
    EXPECT_NE(file.take_complaint(), "");
    file.keep(others());
    EXPECT_TRUE(fs::is_fifo(path));
    EXPECT_EQ(file.take_complaint(), "");
}

TEST_F(Settings, ALinkStaysOne) {
    fs::create_directories(path.parent_path());
    std::ofstream(folder / "kept.json") << "{}";
    fs::create_symlink(folder / "kept.json", path);
    file.read();
    file.keep(others());
    EXPECT_TRUE(fs::is_symlink(path));
    EXPECT_EQ(SettingsFile(folder / "kept.json").read(), others());
}

}  // namespace
}  // namespace ivory
