// The executable as a user starts it: words in, bytes and exit status out.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/temporary_folder.h"

extern char** environ;

namespace ivory::tests {

inline std::string bytes_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream bytes;
    bytes << file.rdbuf();
    return bytes.str();
}

inline void put_bytes(const std::filesystem::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

// How a run ended. 128 + n: by signal n.
struct Finished {
    int status = -1;
    std::string out, err;
    bool was_killed = false;  // by a signal
};

struct Streams {
    std::string in = "/dev/null";
    std::string out;  // empty: kept in Finished::out; "closed": no standard output at all
};

// A started ivory, its standard streams in files.
class Ivory {
  public:
    explicit Ivory(std::vector<std::string> words, Streams streams = {}) {
        words.insert(words.begin(), IVORY_EXECUTABLE);
        std::vector<char*> pointers;
        for (std::string& word : words) pointers.push_back(word.data());
        pointers.push_back(nullptr);
        out_ = (folder_ / "out").string();
        err_ = (folder_ / "err").string();

        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_addopen(&actions, 0, streams.in.c_str(), O_RDONLY, 0);
        if (streams.out == "closed") {
            posix_spawn_file_actions_addclose(&actions, 1);
        } else {
            const std::string& target = streams.out.empty() ? out_ : streams.out;
            posix_spawn_file_actions_addopen(&actions, 1, target.c_str(), O_WRONLY | O_CREAT, 0600);
        }
        posix_spawn_file_actions_addopen(&actions, 2, err_.c_str(), O_WRONLY | O_CREAT, 0600);
        const int error =
            ::posix_spawn(&process_, IVORY_EXECUTABLE, &actions, nullptr, pointers.data(), environ);
        posix_spawn_file_actions_destroy(&actions);
        EXPECT_EQ(error, 0) << IVORY_EXECUTABLE;
    }

    void send(int signal) const { ::kill(process_, signal); }

    // Whether it has begun to look out for that signal, as /proc says.
    [[nodiscard]] bool catches(int signal) const {
        std::ifstream status("/proc/" + std::to_string(process_) + "/status");
        for (std::string line; std::getline(status, line);) {
            if (!line.starts_with("SigCgt:")) continue;
            return (std::stoull(line.substr(7), nullptr, 16) >> (signal - 1) & 1) != 0;
        }
        return false;
    }

    [[nodiscard]] std::string out_so_far() const { return bytes_of(out_); }

    Finished wait() const {
        int status = 0;
        while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
        }
        return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), bytes_of(out_),
                bytes_of(err_), WIFSIGNALED(status)};
    }

  private:
    TemporaryFolder folder_;
    std::string out_, err_;
    pid_t process_ = 0;
};

inline Finished run_ivory(std::vector<std::string> words, Streams streams = {}) {
    return Ivory(std::move(words), std::move(streams)).wait();
}

inline std::string scene_path(const std::string& name) {
    return std::string(IVORY_SOURCE_DIR) + "/assets/scenes/" + name + ".ivory.json";
}

}  // namespace ivory::tests
