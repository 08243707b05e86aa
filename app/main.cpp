// Command line or viewer, and the one place that catches.
#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <system_error>
#include <variant>

#include "app/cli/arguments.h"
#include "app/cli/commands.h"
#include "app/cli/interrupt.h"

namespace {

enum ExitStatus { done = 0, failed = 1, wrong_usage = 2 };

int complain(const char* line, ExitStatus status) {
    std::fprintf(stderr, "ivory: %s\n", line);
    return status;
}

// Where we are started without standard input, output or error, the next file that is opened would
// take the place and get what is meant for them. What stands there instead fails when it is used.
void occupy_standard_descriptors() {
    for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (::fcntl(descriptor, F_GETFD) != -1) continue;
        // The lowest free one is taken, and those below are in use by now.
        static_cast<void>(::open("/dev/null", descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY));
    }
}

}  // namespace

int main(int count, char** words) {
    occupy_standard_descriptors();
    ivory::watch_interrupts();
    try {
        std::visit([](const auto& arguments) { ivory::run(arguments); },
                   ivory::parse_arguments(count, words));
        return done;
    } catch (const ivory::Interrupted&) {
        return ivory::interrupted_status;
    } catch (const ivory::UsageError& error) {
        return complain(error.what(), wrong_usage);
    } catch (const std::bad_alloc&) {
        return complain("out of memory; take a smaller picture or scene", failed);
    } catch (const std::system_error& error) {
        if (ivory::interrupted()) return ivory::interrupted_status;
        return complain(("the system refuses: " + error.code().message() +
                         "; end other programs, or allow more memory and processes (ulimit)")
                            .c_str(),
                        failed);
    } catch (const std::exception& error) {
        // A system call that the interrupt woke may have been taken for a failure.
        return ivory::interrupted() ? ivory::interrupted_status : complain(error.what(), failed);
    }
}
