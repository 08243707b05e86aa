#include "core/scene/write_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <optional>
#include <system_error>
#include <utility>

#include "core/scene/error.h"
#include "core/scene/read_file.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;

// Where a renamed file would have to be put so that `path` names it, or nothing where `path` goes
// by way of the processes' open files (/dev/stdout -> /proc/self/fd/1 -> ...): what is open there
// would not be the renamed file.
std::optional<fs::path> behind_links(fs::path path) {
    constexpr int most_links = 40;  // as Linux
    for (int links = 0; links < most_links; ++links) {
        std::error_code error;
        const fs::path folder =
            fs::canonical(path.has_parent_path() ? path.parent_path() : ".", error);
        if (error) return path;  // no such folder: creating the file there says so
        if (folder.native().starts_with("/proc/")) return std::nullopt;
        path = folder / path.filename();
        const fs::path pointed_to = fs::read_symlink(path, error);
        if (error) return path;
        path = folder / pointed_to;
    }
    return path;
}

const char* remedy_for(int error) {
    switch (error) {
        case ENOENT:
        case ENOTDIR:
            return "create the folder first or name another";
        case EISDIR:
            return "name a file in it";
        case EACCES:
        case EPERM:
        case EROFS:
            return "name a place where you may write";
        case ENOSPC:
        case EDQUOT:
            return "make room or name another place";
        default:
            return "name another place";
    }
}

}  // namespace

AtomicFile::AtomicFile(const fs::path& target) : label_(file_label(target)) {
    if (!target.has_filename()) fail(target.empty() ? ENOENT : EISDIR);
    struct stat status {};
    const bool exists = ::stat(target.c_str(), &status) == 0;
    if (!exists && errno != ENOENT) fail(errno);
    if (exists && S_ISDIR(status.st_mode)) fail(EISDIR);

    const std::optional<fs::path> resolved = behind_links(target);
    if (!resolved || (exists && !S_ISREG(status.st_mode))) {
        descriptor_ = ::open(target.c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC);
        if (descriptor_ < 0) fail(errno);
        return;
    }
    // To rename over a file takes no permission to write to it; who took that away meant it.
    if (exists && ::faccessat(AT_FDCWD, target.c_str(), W_OK, AT_EACCESS) != 0) fail(errno);

    // A short name of our own, since the target's may be as long as names can be.
    target_ = *resolved;
    static std::atomic<unsigned> count{0};
    do {
        temporary_ = target_.parent_path() / (".ivory-" + std::to_string(::getpid()) + "-" +
                                              std::to_string(count++) + ".tmp");
        descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    } while (descriptor_ < 0 && errno == EEXIST);
    if (descriptor_ < 0) fail(errno);
    // Where the system refuses (another owner's group, say) the file is no less written.
    if (exists) static_cast<void>(::fchmod(descriptor_, status.st_mode & 07777));
}

AtomicFile::~AtomicFile() {
    if (descriptor_ < 0) return;
    ::close(descriptor_);
    if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void AtomicFile::write(std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
        if (written >= 0) {
            bytes.remove_prefix(static_cast<std::size_t>(written));
        } else if (errno != EINTR) {
            fail(errno);
        }
    }
}

void AtomicFile::close_written() {
    // Some file systems report a failed write only here.
    const int descriptor = std::exchange(descriptor_, -1);
    if (::close(descriptor) != 0 && errno != EINTR) give_up(errno);
}

void AtomicFile::give_up(int error) {
    if (!temporary_.empty()) ::unlink(temporary_.c_str());
    fail(error);
}

void AtomicFile::commit() {
    close_written();
    if (temporary_.empty()) return;
    if (::rename(temporary_.c_str(), target_.c_str()) != 0) give_up(errno);
}

bool AtomicFile::commit_new() {
    close_written();
    if (temporary_.empty()) return true;
    // Unlike a rename, a second name for a file never replaces another.
    if (::link(temporary_.c_str(), target_.c_str()) == 0) {
        ::unlink(temporary_.c_str());
        return true;
    }
    if (errno != EEXIST) {
        // A file system without second names: look, then rename.
        struct stat status {};
        if (::lstat(target_.c_str(), &status) != 0) {
            if (::rename(temporary_.c_str(), target_.c_str()) != 0) give_up(errno);
            return true;
        }
    }
    ::unlink(temporary_.c_str());
    return false;
}

void AtomicFile::fail(int error) const {
    throw Error(label_ + ": cannot be written: " + std::generic_category().message(error) + "; " +
                remedy_for(error));
}

void write_file(const fs::path& target, std::string_view bytes) {
    AtomicFile file(target);
    file.write(bytes);
    file.commit();
}

bool write_new_file(const fs::path& target, std::string_view bytes) {
    struct stat status {};
    if (::stat(target.c_str(), &status) == 0) return false;
    AtomicFile file(target);
    file.write(bytes);
    return file.commit_new();
}

}  // namespace ivory
