#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <exception>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
#include <vector>

#include "app/cli/commands.h"
#include "app/cli/interrupt.h"
#include "app/cli/output.h"
#include "app/cli/progress.h"
#include "core/render/answers_file.h"
#include "core/scene/error.h"
#include "core/scene/read_file.h"
#include "core/scene/scene_json.h"
#include "core/trace/trace.h"

namespace ivory {
namespace {

// The rays as they come: from a pipe, what is there is answered before more is waited for.
class RayInput {
  public:
    explicit RayInput(const std::string& path) : label_(file_label(path)) {
        if (path != "-") descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
        if (descriptor_ < 0) fail();
    }
    ~RayInput() {
        if (descriptor_ > STDIN_FILENO) ::close(descriptor_);
    }
    RayInput(const RayInput&) = delete;
    RayInput& operator=(const RayInput&) = delete;

    // Appends up to `most` bytes to `text`; false: there are no more.
    bool read_more(std::string& text, std::size_t most) const {
        const std::size_t before = text.size();
        text.resize(before + most);
        while (true) {
            stop_if_interrupted();
            const ssize_t count = ::read(descriptor_, text.data() + before, most);
            if (count < 0 && errno == EINTR) continue;
            if (count < 0) fail();
            text.resize(before + static_cast<std::size_t>(count));
            return count > 0;
        }
    }

    [[nodiscard]] const std::string& label() const { return label_; }

  private:
    [[noreturn]] void fail() const {
        throw Error(label_ + ": cannot be read: " + std::generic_category().message(errno) +
                    "; name a file that can be read");
    }

    std::string label_;
    int descriptor_ = STDIN_FILENO;
};

// Some lines, and their answers up to the first line that is no ray.
struct Chunk {
    std::size_t begin = 0, end = 0;  // lines of the batch
    std::string answers;
    std::optional<std::size_t> bad_line;
    std::string fault;
};

class Tracer {
  public:
    Tracer(const Scene& scene, const WorkArguments& work)
        : work_(work), field_(compile(scene)), list_(all_elements(field_)) {}

    // Each chunk is one worker's; the order of the answers is that of the lines.
    std::vector<Chunk> answer(const std::vector<std::string_view>& lines) const {
        std::vector<Chunk> chunks;
        for (std::size_t begin = 0; begin < lines.size(); begin += lines_in_chunk) {
            chunks.emplace_back();
            chunks.back().begin = begin;
            chunks.back().end = std::min(begin + lines_in_chunk, lines.size());
        }
        std::atomic<std::size_t> next{0};
        std::mutex mutex;
        std::exception_ptr failure;
        const auto worker = [&] {
            try {
                for (std::size_t c; !interrupted() && (c = next++) < chunks.size();) {
                    answer(lines, chunks[c]);
                }
            } catch (...) {
                const std::lock_guard lock(mutex);
                if (!failure) failure = std::current_exception();
            }
        };
        {
            const std::size_t threads =
                std::min(static_cast<std::size_t>(work_.threads), chunks.size());
            std::vector<std::jthread> helpers;
            try {
                while (helpers.size() + 1 < threads) helpers.emplace_back(worker);
            } catch (const std::system_error&) {
                // Fewer threads do the same work.
            }
            worker();
        }
        if (failure) std::rethrow_exception(failure);
        stop_if_interrupted();
        return chunks;
    }

  private:
    static constexpr std::size_t lines_in_chunk = 64;

    void answer(const std::vector<std::string_view>& lines, Chunk& chunk) const {
        Counts counts;
        counts.stop = Cancellation(interruption());
        for (std::size_t line = chunk.begin; line < chunk.end && !interrupted(); ++line) {
            std::optional<Ray> ray;
            try {
                ray = parse_ray(lines[line]);
            } catch (const Error& error) {
                chunk.bad_line = line;
                chunk.fault = error.what();
                return;
            }
            if (!ray) continue;
            append_answer(chunk.answers,
                          trace(field_, list_, *ray, *work_.method, work_.options, counts));
            chunk.answers += '\n';
        }
    }

    const WorkArguments& work_;
    Field field_;
    ElementList list_;
};

// Takes the whole lines off `text`, and at the end of the file what is left of it too.
std::vector<std::string_view> whole_lines(std::string_view& text, bool at_end) {
    std::vector<std::string_view> lines;
    while (!text.empty()) {
        const std::size_t newline = text.find('\n');
        if (newline == std::string_view::npos && !at_end) break;
        lines.push_back(text.substr(0, newline));
        text.remove_prefix(std::min(lines.back().size() + 1, text.size()));
    }
    return lines;
}

}  // namespace

void run(const TraceArguments& arguments) {
    constexpr std::size_t longest_line = std::size_t{1} << 20;
    const Tracer tracer(read_scene(arguments.scene, stop_if_interrupted), arguments.work);
    const RayInput input(arguments.rays);
    Output output("-");
    // Answers on the same terminal are progress enough.
    Progress progress(arguments.work.quiet || ::isatty(STDOUT_FILENO) == 1);
    output.write(std::string(answer_columns) + "\n");

    const std::size_t piece = std::min(arguments.work.threads, 16) * (std::size_t{1} << 16);
    std::string text;
    std::size_t lines_before = 0;
    for (bool more = true; more;) {
        more = input.read_more(text, piece);
        std::string_view rest = text;
        const std::vector<std::string_view> lines = whole_lines(rest, !more);
        for (const Chunk& chunk : tracer.answer(lines)) {
            output.write(chunk.answers);
            if (chunk.bad_line) {
                throw Error(input.label() + ": line " +
                            std::to_string(lines_before + *chunk.bad_line + 1) + ": " +
                            chunk.fault);
            }
        }
        lines_before += lines.size();
        if (rest.size() > longest_line) {
            throw Error(input.label() + ": line " + std::to_string(lines_before + 1) +
                        ": is longer than 1 MiB; a ray is six numbers: ox oy oz dx dy dz");
        }
        text.erase(0, text.size() - rest.size());
        progress.show(std::to_string(lines_before) + " lines");
    }
}

}  // namespace ivory
