// What a file was when it was read or written, to tell later whether another program has changed
// it.
#pragma once

#include <sys/stat.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

namespace ivory {

struct FileStamp {
    dev_t device = 0;
    ino_t number = 0;
    std::int64_t size = 0;                // bytes
    timespec modified{}, changed{};       // its contents; its contents, name or permissions
    std::optional<std::size_t> contents;  // a hash of its bytes, where they are known

    // Of the file as it stands, links followed, `contents` not looked at; nothing where there is
    // none.
    [[nodiscard]] static std::optional<FileStamp> of(const std::filesystem::path& path);
    void set_contents(std::string_view bytes);
};

enum class OnDisk : std::uint8_t {
    same,     // another time alone makes no difference
    changed,  // or replaced
    gone,
};

// The file as it stands compared with what it was. Its bytes are read where all else does not show
// that it is the same and `before` knows what they were.
[[nodiscard]] OnDisk compare_with_disk(const std::filesystem::path& path, const FileStamp& before);

}  // namespace ivory
