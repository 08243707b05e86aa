// check_answers: answers of `ivory trace` or `ivory render --answers` against the reference of 256
// bits. Exit 1 where one is wrong, with the first faults on standard output.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <iterator>
#include <mutex>
#include <numeric>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "core/scene/error.h"
#include "tests/reference/answer_lines.h"
#include "tests/reference/referee.h"
#include "tests/reference/scene.h"
#include "tests/reference/verdict.h"
#include "tests/tools/run_tool.h"

namespace {

using namespace ivory;
using reference::Fault;
using reference::Outcome;
using reference::Verdict;
using Status = reference::Claim::Status;

// A normal or a colour further off than this is a fault.
constexpr double allowed_shading_error = 1e-9;

struct Worst {
    double value = 0;
    std::size_t line = 0;
    void see(double x, std::size_t where) {  // NaN: nothing to see
        if (x > value) *this = {x, where};
    }
    void see(const Worst& other) { see(other.value, other.line); }
};

struct Totals {
    std::size_t checked = 0, hits = 0, misses = 0, unresolved = 0, claimed_hits = 0,
                claimed_misses = 0;
    std::size_t faults[7] = {};
    std::size_t undecided = 0, decidable = 0, unresolved_decidable = 0;
    std::size_t normals_judged = 0, normals_off = 0, colors_off = 0;
    Worst normal, color, bracket, unresolved_bracket, root, claimed_root;
    std::vector<std::string> messages;

    void add(const Totals& other) {
        checked += other.checked;
        hits += other.hits;
        misses += other.misses;
        unresolved += other.unresolved;
        claimed_hits += other.claimed_hits;
        claimed_misses += other.claimed_misses;
        for (std::size_t i = 0; i < std::size(faults); ++i) faults[i] += other.faults[i];
        undecided += other.undecided;
        decidable += other.decidable;
        unresolved_decidable += other.unresolved_decidable;
        normals_judged += other.normals_judged;
        normals_off += other.normals_off;
        colors_off += other.colors_off;
        normal.see(other.normal);
        color.see(other.color);
        bracket.see(other.bracket);
        unresolved_bracket.see(other.unresolved_bracket);
        root.see(other.root);
        claimed_root.see(other.claimed_root);
        messages.insert(messages.end(), other.messages.begin(), other.messages.end());
    }

    std::size_t wrong() const {
        std::size_t count = normals_off + colors_off;
        for (std::size_t i = 1; i < std::size(faults); ++i) {
            if (i != static_cast<std::size_t>(Fault::false_claim)) count += faults[i];
        }
        return count;
    }
};

void judge(const reference::ReferenceField& field, const reference::CheckedLine& line,
           double tolerance, bool with_decidable, Totals& totals) {
    const Verdict verdict = check(field, line.ray, tolerance, line.claim);
    const Status status = line.claim.status;
    const auto complain = [&](const std::string& fault) {
        if (totals.messages.size() < 20) {
            totals.messages.push_back("line " + std::to_string(line.number) + ": " +
                                      described(fault, line.ray, line.claim, verdict.reference));
        }
    };
    ++totals.checked;
    totals.hits += status == Status::hit;
    totals.misses += status == Status::miss;
    totals.unresolved += status == Status::unresolved;
    totals.claimed_hits += status == Status::claimed_hit;
    totals.claimed_misses += status == Status::claimed_miss;
    totals.undecided += verdict.undecided;
    ++totals.faults[static_cast<std::size_t>(verdict.fault)];
    if (verdict.fault != Fault::none && verdict.fault != Fault::false_claim) {
        complain(word(verdict.fault));
    }

    if (with_decidable && verdict.fault != Fault::malformed &&
        decidable(field, line.ray, tolerance, verdict.reference)) {
        ++totals.decidable;
        if (status == Status::unresolved) {
            ++totals.unresolved_decidable;
            complain("unresolved and decidable");
        }
    }

    if (status == Status::hit) {
        totals.bracket.see(verdict.bracket, line.number);
        totals.root.see(verdict.root_error, line.number);
    } else if (status == Status::unresolved) {
        totals.unresolved_bracket.see(verdict.bracket, line.number);
    } else if (status == Status::claimed_hit) {
        totals.claimed_root.see(verdict.root_error, line.number);
    }
    if (status == Status::hit || status == Status::unresolved) {
        totals.normals_judged += !std::isnan(verdict.normal_error);
        totals.normal.see(verdict.normal_error, line.number);
        totals.color.see(verdict.color_error, line.number);
        if (verdict.normal_error > allowed_shading_error) {
            ++totals.normals_off;
            complain("normal off by " + std::to_string(verdict.normal_error * 1e9) + "e-9");
        }
        if (verdict.color_error > allowed_shading_error) {
            ++totals.colors_off;
            complain("colour off by " + std::to_string(verdict.color_error * 1e9) + "e-9");
        }
    }
}

void print(const Totals& totals) {
    const auto count = [](const char* what, std::size_t value) {
        std::printf("%-26s %zu\n", what, value);
    };
    const auto worst = [](const char* what, const Worst& value) {
        std::printf("%-26s %.3g", what, value.value);
        if (value.line != 0) std::printf(" (line %zu)", value.line);
        std::printf("\n");
    };
    const auto faults = [&](Fault fault) { return totals.faults[static_cast<int>(fault)]; };
    count("checked", totals.checked);
    count("hits", totals.hits);
    count("misses", totals.misses);
    count("unresolved", totals.unresolved);
    if (totals.claimed_hits + totals.claimed_misses > 0) {
        count("claimed hits", totals.claimed_hits);
        count("claimed misses", totals.claimed_misses);
        count("false claims", faults(Fault::false_claim));
        worst("worst claimed root", totals.claimed_root);
    }
    count("wrong hits", faults(Fault::wrong_hit));
    count("wrong misses", faults(Fault::wrong_miss));
    count("wrong brackets", faults(Fault::wrong_bracket));
    count("malformed", faults(Fault::malformed));
    count("too wide", faults(Fault::too_wide));
    count("undecided by the reference", totals.undecided);
    count("decidable", totals.decidable);
    count("unresolved and decidable", totals.unresolved_decidable);
    count("normals judged", totals.normals_judged);
    count("normals off", totals.normals_off);
    count("colours off", totals.colors_off);
    worst("worst normal", totals.normal);
    worst("worst colour", totals.color);
    worst("worst root, length", totals.root);
    worst("widest hit / w", totals.bracket);
    worst("widest unresolved / w", totals.unresolved_bracket);
}

int run(int argc, char** argv) {
    std::string scene_path, answers_path, rays_path;
    double tolerance = 0;
    std::size_t sample = 0;
    std::uint64_t seed = 1;
    unsigned threads = std::max(1u, std::thread::hardware_concurrency());
    bool skip_decidable = false;

    CLI::App app("Checks answers of ivory against a reference of 256 bits.", "check_answers");
    app.add_option("scene", scene_path, "scene file")->required();
    app.add_option("answers", answers_path, "output of trace, or of render --answers")->required();
    app.add_option("--rays", rays_path, "the rays of a trace output");
    app.add_option("--tolerance", tolerance, "E; without it 1e-9 with --rays, 1e-6 otherwise");
    app.add_option("--sample", sample, "check so many answers, chosen at random; 0: all");
    app.add_option("--seed", seed, "of the sample");
    app.add_option("--threads", threads, "worker threads")->check(CLI::PositiveNumber);
    app.add_flag("--no-decidable", skip_decidable, "do not sort out the decidable rays: faster");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    }
    if (tolerance == 0) tolerance = rays_path.empty() ? 1e-6 : 1e-9;

    const auto open = [](const std::string& path) {
        std::ifstream in(path);
        if (!in) throw Error(path + ": cannot be read");
        return in;
    };
    const reference::ReferenceField field(reference::read_reference_scene(scene_path));
    std::optional<std::vector<reference::Ray>> rays;
    if (!rays_path.empty()) {
        std::ifstream in = open(rays_path);
        rays = reference::read_rays(in);
    }
    std::ifstream in = open(answers_path);
    const std::vector<reference::CheckedLine> lines = reference::read_answers(in, rays);

    std::vector<std::size_t> chosen(lines.size());
    std::iota(chosen.begin(), chosen.end(), std::size_t{0});
    if (sample > 0 && sample < chosen.size()) {
        std::mt19937_64 random(seed);
        std::vector<std::size_t> some;
        std::sample(chosen.begin(), chosen.end(), std::back_inserter(some), sample, random);
        chosen = some;
        std::printf("%-26s %zu of %zu, seed %llu\n", "sample", sample, lines.size(),
                    static_cast<unsigned long long>(seed));
    }

    const auto start = std::chrono::steady_clock::now();
    Totals totals;
    std::mutex guard;
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
        Totals own;
        for (std::size_t i = next++; i < chosen.size(); i = next++) {
            judge(field, lines[chosen[i]], tolerance, !skip_decidable, own);
        }
        mpfr_free_cache();
        const std::lock_guard lock(guard);
        totals.add(own);
    };
    std::vector<std::thread> workers;
    for (unsigned i = 0; i < threads; ++i) workers.emplace_back(work);
    for (std::thread& worker : workers) worker.join();
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

    print(totals);
    std::printf("%-26s %.3g\n", "seconds", seconds);
    for (const std::string& message : totals.messages) std::printf("%s\n", message.c_str());
    return totals.wrong() == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) { return ivory::tools::run_tool("check_answers", run, argc, argv); }
