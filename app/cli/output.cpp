#include "app/cli/output.h"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <system_error>

#include "app/cli/interrupt.h"
#include "core/scene/error.h"

namespace ivory {
namespace {

void write_to_standard_output(std::string_view bytes) {
    while (!bytes.empty()) {
        stop_if_interrupted();
        const ssize_t written = ::write(STDOUT_FILENO, bytes.data(), bytes.size());
        if (written >= 0) {
            bytes.remove_prefix(static_cast<std::size_t>(written));
        } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
            // Somebody else has set the pipe not to wait.
            pollfd ready{STDOUT_FILENO, POLLOUT, 0};
            static_cast<void>(::poll(&ready, 1, -1));
        } else if (errno != EINTR) {
            throw Error(
                "standard output: cannot be written: " + std::generic_category().message(errno) +
                "; name a file or a reader that takes it all");
        }
    }
}

}  // namespace

Output::Output(const std::string& target) {
    if (target != "-") file_.emplace(target);
}

void Output::write(std::string_view bytes) {
    if (!file_) {
        write_to_standard_output(bytes);
        return;
    }
    constexpr std::size_t piece = std::size_t{1} << 22;  // so that the user is heard between them
    while (!bytes.empty()) {
        stop_if_interrupted();
        file_->write(bytes.substr(0, piece));
        bytes.remove_prefix(std::min(piece, bytes.size()));
    }
}

void Output::commit() {
    if (file_) file_->commit();
}

}  // namespace ivory
