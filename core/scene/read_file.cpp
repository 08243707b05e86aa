#include "core/scene/read_file.h"

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <system_error>
#include <vector>

#include "core/scene/error.h"
#include "core/scene/text.h"

namespace ivory {
namespace {

Error cannot_be_read(const std::filesystem::path& path, int error) {
    const char* const remedy = error == ENOENT || error == ENOTDIR ? "name a file that exists"
                               : error == EISDIR                   ? "name a file in it"
                               : error == EACCES                   ? "name a file that you may read"
                                                                   : "name a file that can be read";
    return Error(file_label(path) + ": cannot be read: " + std::generic_category().message(error) +
                 "; " + remedy);
}

}  // namespace

std::string file_label(const std::filesystem::path& path) {
    if (path == "-") return "standard input";
    return path.empty() ? "\"\"" : printable(path.string());
}

std::string read_file(const std::filesystem::path& path, const Stop& stop) {
    struct Close {
        void operator()(std::FILE* file) const {
            if (file != stdin) std::fclose(file);
        }
    };
    std::unique_ptr<std::FILE, Close> file(path == "-" ? stdin : nullptr);
    while (!file) {
        errno = 0;
        file.reset(std::fopen(path.c_str(), "rb"));
        if (file) break;
        if (errno != EINTR) throw cannot_be_read(path, errno);
        look_at(stop);
    }

    // In pieces up to the end, not by the size that the system says: a pipe has none.
    std::string bytes;
    std::error_code ignored;
    if (std::filesystem::is_regular_file(path, ignored)) {
        const std::uintmax_t size = std::filesystem::file_size(path, ignored);
        if (!ignored && size <= largest_file) bytes.reserve(size);
    }
    std::vector<char> piece(std::size_t{1} << 16);
    static_assert(bytes_between_looks >= std::size_t{1} << 16);
    while (true) {
        look_at(stop);
        errno = 0;
        const std::size_t count = std::fread(piece.data(), 1, piece.size(), file.get());
        bytes.append(piece.data(), count);
        if (bytes.size() > largest_file) {
            throw Error(file_label(path) + ": is larger than " +
                        std::to_string(largest_file >> 20) +
                        " MiB, the most that is read; name a smaller file");
        }
        if (count == piece.size()) continue;
        if (std::ferror(file.get()) == 0) return bytes;
        if (errno != EINTR) throw cannot_be_read(path, errno);
        std::clearerr(file.get());
    }
}

}  // namespace ivory
