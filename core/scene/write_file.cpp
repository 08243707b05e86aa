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

fs::path folder_of(const fs::path& path) {
    return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

bool may(const fs::path& path, int what) {
    return ::faccessat(AT_FDCWD, path.c_str(), what, AT_EACCESS) == 0;
}

// Whether the file may be written but not replaced: another's, in another's folder that is sticky
// as /tmp is.
bool belongs_to_others(const fs::path& folder, const struct stat& file) {
    struct stat status {};
    const uid_t user = ::geteuid();
    return ::stat(folder.c_str(), &status) == 0 && (status.st_mode & S_ISVTX) != 0 && user != 0 &&
           status.st_uid != user && file.st_uid != user;
}

// The way to what is open there that a link can be made from.
std::string open_file(int descriptor) { return "/proc/self/fd/" + std::to_string(descriptor); }

// A short name of our own, since the target's may be as long as names can be.
fs::path temporary_name(const fs::path& target) {
    static std::atomic<unsigned> count{0};
    return target.parent_path() /
           (".ivory-" + std::to_string(::getpid()) + "-" + std::to_string(count++) + ".tmp");
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
    if (exists && !may(target, W_OK)) fail(errno);
    target_ = *resolved;
    // What the system would say when the file is put there, after all the work.
    const fs::path folder = folder_of(target_);
    if (!may(folder, W_OK | X_OK)) fail(errno);
    if (exists && belongs_to_others(folder, status)) fail(EPERM);
    if (exists) permissions_ = status.st_mode & 07777;
}

AtomicFile::~AtomicFile() {
    if (descriptor_ < 0) return;
    ::close(descriptor_);
    if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void AtomicFile::make() {
    if (!make_without_name()) make_with_temporary_name();
    // Where the system refuses (another owner's group, say) the file is no less written.
    if (permissions_) static_cast<void>(::fchmod(descriptor_, *permissions_));
}

bool AtomicFile::make_without_name() {
#ifdef O_TMPFILE
    descriptor_ = ::open(folder_of(target_).c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
    if (descriptor_ < 0) return false;
    // By that way it gets its name.
    if (::access(open_file(descriptor_).c_str(), F_OK) == 0) return true;
    ::close(std::exchange(descriptor_, -1));
#endif
    return false;
}

void AtomicFile::make_with_temporary_name() {
    do {
        temporary_ = temporary_name(target_);
        descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    } while (descriptor_ < 0 && errno == EEXIST);
    if (descriptor_ < 0) fail(errno);
}

void AtomicFile::write(std::string_view bytes) {
    if (descriptor_ < 0) make();
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

int AtomicFile::give_name(const fs::path& name) const {
    const std::string open = open_file(descriptor_);
    return ::linkat(AT_FDCWD, open.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0 ? 0
                                                                                            : errno;
}

void AtomicFile::commit() {
    if (descriptor_ < 0) make();  // an empty file is one too
    bool stands = target_.empty();
    if (!stands && temporary_.empty()) {
        int error = give_name(target_);
        stands = error == 0;
        // A link replaces nothing, only a renamed file does.
        while (error == EEXIST) {
            const fs::path name = temporary_name(target_);
            error = give_name(name);
            if (error == 0) temporary_ = name;
        }
        if (error != 0) fail(error);
    }
    close_written();
    if (!stands && ::rename(temporary_.c_str(), target_.c_str()) != 0) give_up(errno);
}

bool AtomicFile::commit_new() {
    if (descriptor_ < 0) make();
    if (temporary_.empty()) {
        const int error = target_.empty() ? 0 : give_name(target_);
        if (error != 0 && error != EEXIST) fail(error);
        close_written();
        return error == 0;
    }
    close_written();
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

std::optional<FileIdentity> file_identity(const fs::path& path, FileUse use) {
    struct stat status {};
    const bool is_stream = path == "-";
    const bool exists =
        is_stream ? ::fstat(use == FileUse::input ? STDIN_FILENO : STDOUT_FILENO, &status) == 0
                  : ::stat(path.c_str(), &status) == 0;
    if (exists) {
        if (!S_ISREG(status.st_mode) && !S_ISFIFO(status.st_mode)) return std::nullopt;
        return FileIdentity{status.st_dev, status.st_ino, ""};
    }
    if (is_stream || path.empty()) return std::nullopt;
    const std::optional<fs::path> resolved = behind_links(path);
    if (!resolved || ::stat(folder_of(*resolved).c_str(), &status) != 0) return std::nullopt;
    return FileIdentity{status.st_dev, status.st_ino, resolved->filename().string()};
}

bool is_written_straight(const fs::path& path) {
    std::error_code ignored;
    return !behind_links(path) ||
           (fs::exists(path, ignored) && !fs::is_regular_file(path, ignored));
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
