#include "core/scene/write_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "core/scene/read_file.h"
#include "tests/error_line.h"
#include "tests/ordinary_user.h"
#include "tests/temporary_folder.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;
using tests::TemporaryFolder;

std::string error_of(const fs::path& path) {
    return tests::error_line([&] { write_file(path, "new"); });
}

std::set<std::string> names_in(const fs::path& folder) {
    std::set<std::string> names;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
        names.insert(entry.path().filename().string());
    }
    return names;
}

TEST(WriteFile, WritesEveryByteAndLeavesNothingBeside) {
    const TemporaryFolder folder;
    std::string bytes;
    for (int i = 0; i < 1'000'000; ++i) bytes += static_cast<char>(i * 31 % 256);
    write_file(folder / "file", bytes);
    EXPECT_EQ(read_file(folder / "file"), bytes);
    write_file(folder / "file", "");
    EXPECT_EQ(read_file(folder / "file"), "");
    EXPECT_EQ(names_in(folder.path()), std::set<std::string>{"file"});
}

TEST(WriteFile, WritesIntoTheCurrentFolder) {
    const TemporaryFolder folder;
    const fs::path before = fs::current_path();
    fs::current_path(folder.path());
    write_file("plain", "text");
    fs::current_path(before);
    EXPECT_EQ(read_file(folder / "plain"), "text");
}

TEST(WriteFile, TakesTheLongestName) {
    const TemporaryFolder folder;
    const fs::path path = folder / std::string(255, 'n');
    write_file(path, "text");
    EXPECT_EQ(read_file(path), "text");
    EXPECT_NE(error_of(folder / std::string(256, 'n')).find("File name too long; name another"),
              std::string::npos);
}

TEST(AtomicFile, ShowsNothingBeforeTheCommitAndAllOfItAfter) {
    const TemporaryFolder folder;
    std::ofstream(folder / "file") << "old";
    {
        AtomicFile file(folder / "file");
        file.write("new ");
        file.write("text");
        EXPECT_EQ(read_file(folder / "file"), "old");
        file.commit();
        EXPECT_EQ(read_file(folder / "file"), "new text");
    }
    EXPECT_EQ(names_in(folder.path()), std::set<std::string>{"file"});
}

TEST(WriteNewFile, ReplacesNothing) {
    const TemporaryFolder folder;
    EXPECT_TRUE(write_new_file(folder / "file", "first"));
    EXPECT_FALSE(write_new_file(folder / "file", "second"));
    EXPECT_EQ(read_file(folder / "file"), "first");
    fs::create_directory(folder / "taken");
    EXPECT_FALSE(write_new_file(folder / "taken", "text"));
    fs::create_symlink("file", folder / "link");
    EXPECT_FALSE(write_new_file(folder / "link", "text"));
    fs::create_symlink("pointed to", folder / "link to nothing");
    EXPECT_TRUE(write_new_file(folder / "link to nothing", "text"));
    EXPECT_EQ(read_file(folder / "pointed to"), "text");
    EXPECT_EQ(names_in(folder.path()),
              (std::set<std::string>{"file", "link", "link to nothing", "pointed to", "taken"}));
}

TEST(WriteNewFile, NotEvenWhatCameWhileItWasWritten) {
    const TemporaryFolder folder;
    AtomicFile file(folder / "file");
    file.write("mine");
    std::ofstream(folder / "file") << "another's";
    EXPECT_FALSE(file.commit_new());
    EXPECT_EQ(read_file(folder / "file"), "another's");
    EXPECT_EQ(names_in(folder.path()), std::set<std::string>{"file"});
}

TEST(AtomicFile, WithoutACommitIsThrownAway) {
    const TemporaryFolder folder;
    std::ofstream(folder / "file") << "old";
    {
        AtomicFile there(folder / "file");
        AtomicFile not_there(folder / "other");
        there.write("half");
        not_there.write("half");
    }
    EXPECT_EQ(read_file(folder / "file"), "old");
    EXPECT_EQ(names_in(folder.path()), std::set<std::string>{"file"});
}

TEST(AtomicFile, AKilledRunLeavesTheTargetAsItWas) {
    const TemporaryFolder folder;
    std::ofstream(folder / "file") << "old";
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        AtomicFile file(folder / "file");
        file.write("half");
        ::kill(::getpid(), SIGKILL);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFSIGNALED(status));
    EXPECT_EQ(read_file(folder / "file"), "old");
}

TEST(AtomicFile, ManyAtOnceDoNotMeet) {
    const TemporaryFolder folder;
    std::vector<std::thread> threads;
    threads.reserve(4);
    for (int t = 0; t < 4; ++t) {
        threads.emplace_back([&folder, t] {
            for (int i = 0; i < 50; ++i) {
                write_file(folder / "shared", std::string(5000, static_cast<char>('a' + t)));
            }
        });
    }
    for (std::thread& thread : threads) thread.join();
    const std::string text = read_file(folder / "shared");
    EXPECT_EQ(text, std::string(5000, text.at(0)));
    EXPECT_EQ(names_in(folder.path()), std::set<std::string>{"shared"});
}

TEST(WriteFile, KeepsThePermissionsOfTheFileThatStoodThere) {
    const TemporaryFolder folder;
    std::ofstream(folder / "file") << "old";
    fs::permissions(folder / "file", fs::perms(0640));
    write_file(folder / "file", "new");
    EXPECT_EQ(fs::status(folder / "file").permissions(), fs::perms(0640));
    const mode_t mask = ::umask(0027);
    write_file(folder / "fresh", "new");
    ::umask(mask);
    EXPECT_EQ(fs::status(folder / "fresh").permissions(), fs::perms(0640));
}

TEST(WriteFile, RefusesAFileThatMayNotBeWritten) {
    const TemporaryFolder folder;
    std::ofstream(folder / "file") << "old";
    fs::permissions(folder / "file", fs::perms(0444));
    fs::create_directory(folder / "locked");
    fs::permissions(folder / "locked", fs::perms(0555));
    fs::permissions(folder.path(), fs::perms::all);
    {
        const tests::OrdinaryUser user;
        if (!user.holds()) GTEST_SKIP() << "root may write every file";
        // A read-only file in a folder where it could be replaced; a new one in a read-only folder.
        for (const fs::path& path : {folder / "file", folder / "locked/new"}) {
            EXPECT_EQ(
                error_of(path),
                path.string() +
                    ": cannot be written: Permission denied; name a place where you may write");
        }
    }
    EXPECT_EQ(read_file(folder / "file"), "old");
    EXPECT_TRUE(fs::is_empty(folder / "locked"));
    EXPECT_EQ(names_in(folder.path()), (std::set<std::string>{"file", "locked"}));
}

TEST(WriteFile, FollowsSymbolicLinks) {
    const TemporaryFolder folder;
    fs::create_directory(folder / "deep");
    std::ofstream(folder / "deep/file") << "old";
    fs::create_symlink("deep/file", folder / "link");
    fs::create_symlink("link", folder / "link to link");
    write_file(folder / "link to link", "new");
    EXPECT_TRUE(fs::is_symlink(folder / "link"));
    EXPECT_TRUE(fs::is_symlink(folder / "link to link"));
    EXPECT_EQ(read_file(folder / "deep/file"), "new");

    fs::create_symlink("deep/not there yet", folder / "dangling");
    write_file(folder / "dangling", "new");
    EXPECT_TRUE(fs::is_symlink(folder / "dangling"));
    EXPECT_EQ(read_file(folder / "deep/not there yet"), "new");

    fs::create_symlink("circle 2", folder / "circle 1");
    fs::create_symlink("circle 1", folder / "circle 2");
    EXPECT_NE(error_of(folder / "circle 1").find("Too many levels of symbolic links; name another"),
              std::string::npos);
}

TEST(WriteFile, WritesDevicesPipesAndOpenFilesStraight) {
    write_file("/dev/null", "text");
    EXPECT_TRUE(fs::is_character_file("/dev/null"));

    const TemporaryFolder folder;
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    std::string received;
    std::thread reader([&] { received = read_file(folder / "pipe"); });
    write_file(folder / "pipe", std::string(200'000, 'x'));
    reader.join();
    EXPECT_EQ(received.size(), 200'000U);
    EXPECT_TRUE(fs::is_fifo(folder / "pipe"));

    // As /dev/stdout does: what is open is written, not put in its place.
    const int open_file = ::open((folder / "open").c_str(), O_RDWR | O_CREAT, 0600);
    ASSERT_GE(open_file, 0);
    fs::create_symlink("/proc/self/fd/" + std::to_string(open_file), folder / "link to open");
    for (const fs::path& path :
         {fs::path("/dev/fd") / std::to_string(open_file), folder / "link to open"}) {
        write_file(path, "text");
        char text[5] = {};
        EXPECT_EQ(::pread(open_file, text, 4, 0), 4) << path;
        EXPECT_STREQ(text, "text");
        EXPECT_EQ(::ftruncate(open_file, 0), 0);
    }
    ::close(open_file);
}

TEST(WriteFile, SaysWhatIsWrongWithThePath) {
    const TemporaryFolder folder;
    const std::string below = (folder / "missing/file").string();
    EXPECT_EQ(error_of(below), below +
                                   ": cannot be written: No such file or directory; create the "
                                   "folder first or name another");
    const std::string is_folder = ": cannot be written: Is a directory; name a file in it";
    EXPECT_EQ(error_of(folder.path()), folder.path().string() + is_folder);
    EXPECT_EQ(error_of(folder.path().string() + "/"), folder.path().string() + "/" + is_folder);
    EXPECT_EQ(error_of(""),
              "\"\": cannot be written: No such file or directory; create the folder first or name "
              "another");
    std::ofstream(folder / "file") << "x";
    EXPECT_EQ(error_of(folder / "file/x"), (folder / "file/x").string() +
                                               ": cannot be written: Not a directory; create the "
                                               "folder first or name another");
    EXPECT_EQ(names_in(folder.path()), std::set<std::string>{"file"});
}

TEST(WriteFile, SaysThatTheDiskIsFullAndLeavesTheTargetAsItWas) {
    EXPECT_EQ(error_of("/dev/full"),
              "/dev/full: cannot be written: No space left on device; make room or name another "
              "place");

    // A limit on the size of files stands for a disk that fills up half-way.
    const TemporaryFolder folder;
    std::ofstream(folder / "file") << "old";
    rlimit before{};
    ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
    rlimit small = before;
    small.rlim_cur = 100'000;
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
    const std::string line =
        tests::error_line([&] { write_file(folder / "file", std::string(200'000, 'x')); });
    ::setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    EXPECT_EQ(line, (folder / "file").string() +
                        ": cannot be written: File too large; name another place");
    EXPECT_EQ(read_file(folder / "file"), "old");
    EXPECT_EQ(names_in(folder.path()), std::set<std::string>{"file"});
}

}  // namespace
}  // namespace ivory
