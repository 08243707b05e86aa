// ivory-referee: says of each answer of `ivory trace` or `ivory render --answers` whether it is proved
// right, proved wrong, or beyond its precision, in arithmetic of its own. Exit 1 where one is wrong.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <fstream>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/reference/answer_lines.h"
#include "tests/reference/referee.h"

namespace {

using namespace ivory::reference;

std::ifstream open(const std::string& path) {
    std::ifstream in(path);
    if (!in) throw std::runtime_error(path + ": cannot be read");
    return in;
}

// Of all lines, in their order.
std::vector<Decision> decide(const Referee& referee, const std::vector<CheckedLine>& lines,
                             double tolerance, unsigned threads) {
    std::vector<Decision> decisions(lines.size());
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
        for (std::size_t i = next++; i < lines.size(); i = next++) {
            decisions[i] = referee.rule(lines[i].ray, tolerance, lines[i].claim);
        }
        mpfr_free_cache();
    };
    std::vector<std::thread> workers;
    for (unsigned i = 0; i < threads; ++i) workers.emplace_back(work);
    for (std::thread& worker : workers) worker.join();
    return decisions;
}

int run(int argc, char** argv) {
    std::string scene_path, answers_path, rays_path;
    double tolerance = 0;
    long most_bits = 4096;
    unsigned threads = std::max(1u, std::thread::hardware_concurrency());
    bool each = false;

    CLI::App app(
        "Says of each answer of ivory whether it is right, wrong, or beyond the referee's "
        "precision,\n"
        "in intervals of 256 bits and more. It shares no arithmetic with ivory.",
        "ivory-referee");
    app.add_option("scene", scene_path, "scene file")->required();
    app.add_option("answers", answers_path, "output of trace, or of render --answers")->required();
    app.add_option("--rays", rays_path, "the rays of a trace output");
    app.add_option("--tolerance", tolerance, "E; without it 1e-9 with --rays, 1e-6 otherwise");
    app.add_option("--bits", most_bits, "at most so many, 256 or more")
        ->check(CLI::Range(least_bits, 1L << 20));
    app.add_option("--threads", threads, "worker threads")->check(CLI::PositiveNumber);
    app.add_flag("--each", each, "a line for each answer, not only for those that are not right");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    }
    if (tolerance == 0) tolerance = rays_path.empty() ? 1e-6 : 1e-9;

    const Referee referee(read_reference_scene(scene_path), most_bits);
    std::optional<std::vector<Ray>> rays;
    if (!rays_path.empty()) {
        std::ifstream in = open(rays_path);
        rays = read_rays(in);
    }
    std::ifstream in = open(answers_path);
    const std::vector<CheckedLine> lines = read_answers(in, rays);
    const std::vector<Decision> decisions = decide(referee, lines, tolerance, threads);

    std::size_t right = 0, wrong = 0, beyond = 0;
    std::map<long, std::size_t> by_bits;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const Decision& decision = decisions[i];
        const bool is_wrong = decision.fault != Fault::none;
        const bool is_beyond = !is_wrong && decision.undecided;
        (is_wrong ? wrong : is_beyond ? beyond : right) += 1;
        if (!is_beyond) ++by_bits[decision.bits];
        if (is_wrong || is_beyond) {
            const std::string what =
                is_wrong ? "wrong, " + std::string(word(decision.fault)) : "beyond the precision";
            std::printf("line %zu: %s\n", lines[i].number,
                        described(what, lines[i].ray, lines[i].claim, decision.reference).c_str());
        } else if (each) {
            std::printf("line %zu: right, by %ld bits\n", lines[i].number, decision.bits);
        }
    }
    std::printf("right %zu, wrong %zu, beyond %zu bits %zu\n", right, wrong,
                static_cast<std::size_t>(most_bits), beyond);
    for (const auto& [bits, count] : by_bits) {
        std::printf("decided by %ld bits: %zu\n", bits, count);
    }
    return wrong == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "ivory-referee: %s\n", error.what());
        return 1;
    }
}
