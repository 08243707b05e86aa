// Files that are whole or not there: written under a temporary name beside the target, then
// renamed over it, so that a run that stops or fails leaves no half file.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace ivory {

// A file being written. What is not committed is thrown away.
//
// A target that is not a regular file (/dev/null, a pipe) or that stands for an open one
// (/dev/stdout) cannot be renamed over and is written straight. A symbolic link stays one: what it
// points to is written. A file that stood there before keeps its permissions.
// Safe against a stopped run, not against a power failure: nothing is forced to the disk.
class AtomicFile {
  public:
    // Throws Error where the target cannot be written: no such folder, no permission, a folder.
    explicit AtomicFile(const std::filesystem::path& target);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    // Appends. Large pieces are better than small ones: nothing is buffered. Throws Error.
    void write(std::string_view bytes);

    // Puts the file in its place; the last call. Throws Error.
    void commit();
    // The same where nothing has the target's name yet, or a last call that throws all away: false.
    [[nodiscard]] bool commit_new();

  private:
    void close_written();
    void give_up(int error);
    [[noreturn]] void fail(int error) const;

    std::string label_;                // what messages call the target
    std::filesystem::path target_;     // symbolic links resolved
    std::filesystem::path temporary_;  // empty where the target is written straight
    int descriptor_ = -1;
};

// All of `bytes` as the file `target`. Throws Error and leaves the target as it was.
void write_file(const std::filesystem::path& target, std::string_view bytes);

// The same, but nothing is ever replaced: false where something has that name by now. A link to a
// file that does not exist makes that file.
[[nodiscard]] bool write_new_file(const std::filesystem::path& target, std::string_view bytes);

}  // namespace ivory
