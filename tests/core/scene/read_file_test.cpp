#include "core/scene/read_file.h"

#include <gtest/gtest.h>
#include <pthread.h>
#include <signal.h>
#include <sys/stat.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <string>
#include <thread>

#include "tests/error_line.h"
#include "tests/ordinary_user.h"
#include "tests/temporary_folder.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;
using tests::TemporaryFolder;

std::string error_of(const fs::path& path) {
    return tests::error_line([&] { static_cast<void>(read_file(path)); });
}

TEST(ReadFile, GivesEveryByte) {
    const TemporaryFolder folder;
    std::string bytes;
    for (int i = 0; i < 300'000; ++i) bytes += static_cast<char>(i * 31 % 256);
    std::ofstream(folder / "file", std::ios::binary) << bytes;
    EXPECT_EQ(read_file(folder / "file"), bytes);
    std::ofstream(folder / "empty");
    EXPECT_EQ(read_file(folder / "empty"), "");
}

TEST(ReadFile, ReadsAPipeToItsEnd) {
    const TemporaryFolder folder;
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    std::thread writer([&] { std::ofstream(folder / "pipe") << std::string(200'000, 'x'); });
    EXPECT_EQ(read_file(folder / "pipe").size(), 200'000U);
    writer.join();
}

TEST(ReadFile, SaysWhatIsWrongWithThePath) {
    const TemporaryFolder folder;
    const std::string missing = (folder / "missing").string();
    EXPECT_EQ(error_of(missing),
              missing +
                  ": cannot be read: No such file or directory; name a file that "
                  "exists");
    EXPECT_EQ(error_of(folder.path()),
              folder.path().string() + ": cannot be read: Is a directory; name a file in it");
    EXPECT_EQ(error_of(""),
              "\"\": cannot be read: No such file or directory; name a file that exists");
    std::ofstream(folder / "file") << "x";
    EXPECT_EQ(error_of(folder / "file/x"),
              (folder / "file/x").string() +
                  ": cannot be read: Not a directory; name a file that exists");
    EXPECT_EQ(error_of(folder / "a\nb"), folder.path().string() +
                                             "/a\\nb: cannot be read: No such file or directory; "
                                             "name a file that exists");
}

TEST(ReadFile, SaysThatAFileMayNotBeRead) {
    const TemporaryFolder folder;
    fs::permissions(folder.path(), fs::perms::all);
    std::ofstream(folder / "secret") << "x";
    fs::permissions(folder / "secret", fs::perms::none);
    const tests::OrdinaryUser user;
    if (!user.holds()) GTEST_SKIP() << "root may read every file";
    EXPECT_EQ(error_of(folder / "secret"),
              (folder / "secret").string() +
                  ": cannot be read: Permission denied; name a file that you may read");
}

TEST(ReadFile, SaysThatReadingFailsAfterOpening) {
    if (!fs::exists("/proc/self/mem")) GTEST_SKIP() << "no file that opens and cannot be read";
    EXPECT_EQ(error_of("/proc/self/mem"),
              "/proc/self/mem: cannot be read: Input/output error; name a file that can be read");
}

TEST(ReadFile, EndsWhereAFileDoesNot) {
    EXPECT_EQ(error_of("/dev/zero"),
              "/dev/zero: is larger than 256 MiB, the most that is read; name a smaller file");
}

TEST(ReadFile, LooksAtTheStopOnceInAMegabyte) {
    const TemporaryFolder folder;
    std::ofstream(folder / "file") << std::string(5 * bytes_between_looks, 'x');
    std::size_t looks = 0;
    EXPECT_EQ(read_file(folder / "file", [&] { ++looks; }).size(), 5 * bytes_between_looks);
    EXPECT_GE(looks, 5U);
    struct Stopped {};
    const auto stop_at_the_last = [&] {
        if (--looks == 0) throw Stopped();
    };
    EXPECT_THROW(static_cast<void>(read_file(folder / "file", stop_at_the_last)), Stopped);
}

TEST(ReadFile, ASignalEndsTheWaitForBytesOnlyWhereItIsAStop) {
    const TemporaryFolder folder;
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    struct sigaction before {
    }, action{};
    action.sa_handler = [](int) {};  // and no SA_RESTART
    ASSERT_EQ(::sigaction(SIGUSR1, &action, &before), 0);
    const pthread_t reader = ::pthread_self();
    std::atomic<int> signals{0};
    std::atomic<bool> enough{false};
    std::thread writer([&] {
        std::ofstream pipe(folder / "pipe");  // waits until the reader has opened
        while (!enough) {
            ::pthread_kill(reader, SIGUSR1);
            ++signals;
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        pipe << "bytes";
    });
    // The file's end comes only after looks that nothing but a signal can have brought about.
    int looks = 0;
    EXPECT_EQ(read_file(folder / "pipe", [&] { enough = ++looks >= 5; }), "bytes");
    writer.join();
    EXPECT_GE(signals, 1);
    EXPECT_GE(looks, 5);
    ::sigaction(SIGUSR1, &before, nullptr);
}

}  // namespace
}  // namespace ivory
