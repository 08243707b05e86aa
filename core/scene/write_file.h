// Files that are whole or not there: written without a name, or where the file system cannot do
// that under a temporary one beside the target, then put in its place, so that a run that stops or
// fails leaves no half file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace ivory {

// A file being written. What is not committed is thrown away.
//
// A target that is not a regular file (/dev/null, a pipe) or that stands for an open one
// (/dev/stdout) cannot be renamed over and is written straight. A symbolic link stays one: what it
// points to is written. A file that stood there before keeps its permissions.
// Nothing is made before there is something to write, and what is being written has no name where
// the file system knows files without one (O_TMPFILE): even a run that is killed leaves nothing.
// Where a file stood before, the new one has a temporary name between two system calls.
// Safe against a stopped run, not against a power failure: nothing is forced to the disk.
class AtomicFile {
  public:
    // Leaves the folder as it is. Throws Error where the target cannot be written: no such folder,
    // no permission, a folder.
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
    void make();
    // False: this file system, or this system without /proc, has no files without a name.
    [[nodiscard]] bool make_without_name();
    void make_with_temporary_name();
    // A name for the file that has none; 0, or the error, EEXIST where something has it.
    [[nodiscard]] int give_name(const std::filesystem::path& name) const;

    std::string label_;                    // what messages call the target
    std::filesystem::path target_;         // symbolic links resolved; empty where written straight
    std::filesystem::path temporary_;      // empty where the file being written has no name
    std::optional<unsigned> permissions_;  // of the file that stood there
    int descriptor_ = -1;                  // < 0: nothing is made yet, or no longer open
};

// Which file a name stands for, so that two names can be compared: by symbolic and hard links and
// other spellings, one that is not there yet by its folder and name.
struct FileIdentity {
    std::uintmax_t device = 0, number = 0;  // of the file, or of the folder where it would be
    std::string name;                       // in that folder; empty where the file is there
    friend bool operator==(const FileIdentity&, const FileIdentity&) = default;
};

enum class FileUse { input, output };

// "-" is standard input or output. Nothing for what may be named as often as one likes: devices as
// /dev/null or a terminal, sockets, and what is in no folder that could be looked into.
[[nodiscard]] std::optional<FileIdentity> file_identity(const std::filesystem::path& path,
                                                        FileUse use);

// Whether `path` is there and no regular file, or stands for an open one (/dev/stdout): its name
// says nothing about what is in it.
[[nodiscard]] bool is_written_straight(const std::filesystem::path& path);

// All of `bytes` as the file `target`. Throws Error and leaves the target as it was.
void write_file(const std::filesystem::path& target, std::string_view bytes);

// The same, but nothing is ever replaced: false where something has that name by now. A link to a
// file that does not exist makes that file.
[[nodiscard]] bool write_new_file(const std::filesystem::path& target, std::string_view bytes);

}  // namespace ivory
