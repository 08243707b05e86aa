#include "app/document/file_stamp.h"

#include <cerrno>
#include <functional>

#include "core/scene/error.h"
#include "core/scene/read_file.h"

namespace ivory {

namespace {

std::size_t hash_of(std::string_view bytes) { return std::hash<std::string_view>()(bytes); }

bool same_time(const timespec& a, const timespec& b) {
    return a.tv_sec == b.tv_sec && a.tv_nsec == b.tv_nsec;
}

bool same_file(const FileStamp& a, const FileStamp& b) {
    return a.device == b.device && a.number == b.number && a.size == b.size &&
           same_time(a.modified, b.modified) && same_time(a.changed, b.changed);
}

}  // namespace

std::optional<FileStamp> FileStamp::of(const std::filesystem::path& path) {
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) return std::nullopt;
    return FileStamp{status.st_dev,  status.st_ino,  status.st_size,
                     status.st_mtim, status.st_ctim, std::nullopt};
}

void FileStamp::set_contents(std::string_view bytes) { contents = hash_of(bytes); }

OnDisk compare_with_disk(const std::filesystem::path& path, const FileStamp& before) {
    const std::optional<FileStamp> now = FileStamp::of(path);
    // Where one may not even look, writing says why.
    if (!now) return errno == ENOENT || errno == ENOTDIR ? OnDisk::gone : OnDisk::same;
    if (same_file(*now, before)) return OnDisk::same;
    std::error_code ignored;
    if (!before.contents || now->size != before.size ||
        !std::filesystem::is_regular_file(path, ignored))
        return OnDisk::changed;
    try {
        return hash_of(read_file(path)) == *before.contents ? OnDisk::same : OnDisk::changed;
    } catch (const Error&) {
        return OnDisk::changed;  // nobody can tell
    }
}

}  // namespace ivory
