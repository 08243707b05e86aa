// ivory-stress: scenes and rays that break tracers, traced one by one and as pictures, the answers
// judged by the referee. A table by family; exit 1 where an answer is wrong.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/field/field.h"
#include "core/render/render.h"
#include "core/scene/error.h"
#include "core/scene/scene_json.h"
#include "core/trace/trace.h"
#include "tests/reference/from_core.h"
#include "tests/reference/referee.h"
#include "tests/stress/families.h"
#include "tests/tools/degenerate_scenes.h"
#include "tests/tools/random_scene.h"
#include "tests/tools/run_tool.h"

namespace {

using namespace ivory;
using reference::Fault;
using reference::Outcome;
using stress::Family;
using stress::family_words;
using Clock = std::chrono::steady_clock;

constexpr double ray_tolerance = 1e-9, picture_tolerance = 1e-6;

struct Settings {
    std::uint64_t seed = 1;
    std::size_t trials = 0;  // 0: as many as there is time for
    double seconds = 60;
    std::size_t rays = 100;       // of a trial
    int width = 33, height = 23;  // of its picture
    double judged = 0.1;          // of what is not unresolved: all of that is
    long most_bits = 1024;
    std::string output;  // folder for the scenes and rays of what is wrong or left open
};

// What became of a family's rays, or of its pixels.
struct Tally {
    std::size_t trials = 0, traced = 0, hits = 0, misses = 0, unresolved = 0;
    std::size_t judged = 0, wrong = 0, beyond = 0;
    std::size_t drawn = 0, decidable_of_drawn = 0;  // a fair sample, for their share
    std::size_t unresolved_judged = 0;
    std::size_t left_open = 0;  // of these, those that are decidable
    std::size_t normals_off = 0, colors_off = 0;
    std::size_t no_picture = 0;
    double widest_hit = 0;           // in the width of the element that leads there
    std::vector<float> open_widths;  // of the unresolved, likewise
    std::vector<std::uint32_t> evaluations;

    void add(const Tally& other) {
        trials += other.trials;
        traced += other.traced;
        hits += other.hits;
        misses += other.misses;
        unresolved += other.unresolved;
        judged += other.judged;
        wrong += other.wrong;
        beyond += other.beyond;
        drawn += other.drawn;
        decidable_of_drawn += other.decidable_of_drawn;
        unresolved_judged += other.unresolved_judged;
        left_open += other.left_open;
        normals_off += other.normals_off;
        colors_off += other.colors_off;
        no_picture += other.no_picture;
        widest_hit = std::max(widest_hit, other.widest_hit);
        open_widths.insert(open_widths.end(), other.open_widths.begin(), other.open_widths.end());
        evaluations.insert(evaluations.end(), other.evaluations.begin(), other.evaluations.end());
    }
    // Of all traced, by what is known of those that were looked at.
    [[nodiscard]] double open() const {
        if (unresolved_judged == 0) return 0;
        return static_cast<double>(left_open) * static_cast<double>(unresolved) /
               static_cast<double>(unresolved_judged);
    }
    [[nodiscard]] double decidable() const {
        if (drawn == 0) return 0;
        return static_cast<double>(traced) * static_cast<double>(decidable_of_drawn) /
               static_cast<double>(drawn);
    }
};

template <class T>
double middle(std::vector<T> values) {
    if (values.empty()) return 0;
    const auto half = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), half, values.end());
    return static_cast<double>(*half);
}
template <class T>
double greatest(const std::vector<T>& values) {
    return values.empty() ? 0
                          : static_cast<double>(*std::max_element(values.begin(), values.end()));
}

void write(const std::filesystem::path& path, const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
}

// One scene, its rays and its picture.
class Court {
  public:
    // Adjourned at the deadline: what was not traced by then is not.
    Court(const Settings& settings, Family family, std::uint64_t seed, Clock::time_point deadline)
        : settings_(settings),
          deadline_(deadline),
          family_(family),
          seed_(seed),
          trial_(make_trial(family, seed, settings.rays)),
          random_(seed ^ 0x5eed),
          referee_(reference::from_core(trial_.scene), settings.most_bits),
          // Thousands of elements cost the referee a second a ray.
          judged_(settings.judged *
                  std::min(1.0, 60 / (1 + static_cast<double>(trial_.scene.elements.size())))),
          judged_open_(
              std::min(1.0, 150 / (1 + static_cast<double>(trial_.scene.elements.size())))) {}

    // Rays, and pixels.
    std::pair<Tally, Tally> hold() {
        Tally rays, pixels;
        field_ = compile(trial_.scene);
        list_ = all_elements(field_);
        rays.trials = 1;
        for (const Ray& ray : trial_.rays) {
            if (Clock::now() > deadline_) break;
            Counts counts;
            const Answer answer = trace_alone(ray, ray_tolerance, counts);
            rays.evaluations.push_back(static_cast<std::uint32_t>(counts.evaluations));
            see(ray, ray_tolerance, answer, rays, "ray", false);
        }
        paint(pixels);
        return {std::move(rays), std::move(pixels)};
    }

  private:
    Answer trace_alone(const Ray& ray, double tolerance, Counts& counts) const {
        return trace(field_, list_, ray, *find_method("proved"), {.tolerance = tolerance}, counts);
    }

    void see(const Ray& ray, double tolerance, const Answer& answer, Tally& tally, const char* what,
             bool suspect) {
        const Status status = answer.isolation.status;
        ++tally.traced;
        tally.hits += status == Status::hit;
        tally.misses += status == Status::miss;
        tally.unresolved += status == Status::unresolved;
        const bool drawn = random_.chance(judged_);
        // Of a trial that leaves nearly all open some will do.
        const bool open = status == Status::unresolved &&
                          random_.chance(told_open_ > 20 ? 0.05 * judged_open_ : judged_open_);
        if (drawn || suspect || open) {
            judge(ray, tolerance, answer, tally, what, drawn);
        }
    }

    void judge(const Ray& ray, double tolerance, const Answer& answer, Tally& tally,
               const char* what, bool drawn) {
        const reference::ReferenceField& field = referee_.field();
        const reference::Claim claim = reference::from_core(answer);
        reference::Verdict verdict = check(field, ray, tolerance, claim);
        if (verdict.undecided && verdict.fault == Fault::none) {
            static_cast<reference::Ruling&>(verdict) = referee_.rule(ray, tolerance, claim);
        }
        ++tally.judged;
        const bool open = answer.isolation.status == Status::unresolved;
        if (verdict.fault != Fault::none) {
            ++tally.wrong;
            complain(std::string("WRONG: ") + word(verdict.fault), what, ray, claim, verdict);
        } else {
            tally.beyond += verdict.undecided;
        }
        const bool can_be_decided = decidable(field, ray, tolerance, verdict.reference);
        tally.drawn += drawn;
        tally.decidable_of_drawn += drawn && can_be_decided;
        if (open) {
            ++tally.unresolved_judged;
            tally.open_widths.push_back(static_cast<float>(verdict.bracket));
            if (can_be_decided) {
                ++tally.left_open;
                if (++told_open_ <= 3) complain("left open", what, ray, claim, verdict);
            }
        } else if (answer.isolation.status == Status::hit) {
            tally.widest_hit = std::max(tally.widest_hit, verdict.bracket);
        }
        // NaN where they are not to be judged.
        if (verdict.normal_error > 1e-9) {
            ++tally.normals_off;
            complain("normal off by " + std::to_string(verdict.normal_error), what, ray, claim,
                     verdict);
        }
        if (verdict.color_error > 1e-9) {
            ++tally.colors_off;
            complain("colour off by " + std::to_string(verdict.color_error), what, ray, claim,
                     verdict);
        }
    }

    // Every pixel is set against the same ray alone: one of two that contradict is wrong.
    void paint(Tally& tally) {
        Scene scene = trial_.scene;
        scene.camera = trial_.camera;
        std::optional<Picture> picture;
        const MethodOptions options{.tolerance = picture_tolerance};
        const int width = settings_.width, height = settings_.height;
        if (width <= 0) return;
        try {
            picture = make_picture(scene, width, height, *find_method("proved"), options);
        } catch (const Error&) {
            ++tally.no_picture;
            return;
        }
        Canvas canvas(width, height, true);
        const JobReport report = render(*picture, canvas, {});
        tally.evaluations.push_back(static_cast<std::uint32_t>(
            report.counts.evaluations / static_cast<std::uint64_t>(width * height)));
        for (int j = 0; j < height; ++j) {
            for (int i = 0; i < width; ++i) {
                if (Clock::now() > deadline_) return;
                const Ray ray = primary_ray(picture->view, width, height, i, j);
                const Answer answer = answer_of(canvas.frame, i, j);
                Counts counts;
                const Answer alone = trace_alone(ray, picture_tolerance, counts);
                const bool suspect = contradict(answer.isolation, alone.isolation);
                see(ray, picture_tolerance, answer, tally, "pixel", suspect);
                if (suspect) {
                    judge(ray, picture_tolerance, alone, tally, "pixel's ray alone", false);
                }
            }
        }
    }
    static Answer answer_of(const Frame& frame, int i, int j) {
        const std::size_t pixel = frame.at(i, j);
        if (!possibly_hit(frame.status[pixel])) return {{frame.status[pixel], {}}, {}};
        return {{frame.status[pixel], frame.t(pixel)}, frame.surface[pixel]};
    }
    static bool contradict(const Isolation& a, const Isolation& b) {
        if (a.status == Status::unresolved || b.status == Status::unresolved) return false;
        if (a.status != b.status) return true;
        return a.status == Status::hit && (a.t.hi < b.t.lo || b.t.hi < a.t.lo);
    }

    void complain(const std::string& fault, const char* what, const Ray& ray,
                  const reference::Claim& claim, const reference::Ruling& ruling) {
        const std::string word(family_words[static_cast<std::size_t>(family_)]);
        const std::string text = described(fault, ray, claim, ruling.reference);
        std::printf("%s, seed %llu, %s: %s\n", word.c_str(), static_cast<unsigned long long>(seed_),
                    what, text.c_str());
        std::fflush(stdout);
        if (settings_.output.empty()) return;
        const std::filesystem::path base =
            std::filesystem::path(settings_.output) / (word + "-" + std::to_string(seed_));
        write(base.string() + ".ivory.json", write_scene(trial_.scene));
        std::ofstream(base.string() + ".rays", std::ios::app)
            << "# " << what << ": " << text << '\n'
            << tools::rays_text({ray});
    }

    const Settings& settings_;
    Clock::time_point deadline_;
    Family family_;
    std::uint64_t seed_;
    stress::Trial trial_;
    tools::Random random_;
    reference::Referee referee_;
    double judged_, judged_open_;  // shares of all answers, and of the unresolved
    int told_open_ = 0;
    Field field_;
    ElementList list_;
};

void print_header() {
    std::printf("\n%-18s %6s %8s %8s %8s %7s %6s %7s %7s %9s %6s %9s %8s %9s %8s %8s %7s\n",
                "family", "trials", "traced", "hits", "misses", "unres.", "wrong", "judged",
                "beyond", "decidable", "open", "open/1e4", "widest", "unres. w", "evals", "most",
                "shading");
}
void print_row(std::FILE* out, const std::string& name, const Tally& tally) {
    const double decidable = tally.decidable();
    const double rate = decidable > 0 ? 1e4 * tally.open() / decidable : 0;
    std::fprintf(
        out,
        "%-18s %6zu %8zu %8zu %8zu %7zu %6zu %7zu %7zu %9.0f %6zu %8.2f%s %8.1e %9.1e %8.0f %8.0f "
        "%7zu\n",
        name.c_str(), tally.trials, tally.traced, tally.hits, tally.misses, tally.unresolved,
        tally.wrong, tally.judged, tally.beyond, decidable, tally.left_open, rate,
        rate > 1 ? "!" : " ", tally.widest_hit, middle(tally.open_widths),
        middle(tally.evaluations), greatest(tally.evaluations),
        tally.normals_off + tally.colors_off);
}

int run(int argc, char** argv) {
    Settings settings;
    std::vector<std::string> words(family_words.begin(), family_words.end());
    CLI::App app(
        "Scenes and rays that break tracers, judged by the referee: a table by family, exit 1 "
        "where\n"
        "an answer is wrong.",
        "ivory-stress");
    app.add_option("--family", words, "all without it")
        ->delimiter(',')
        ->check(CLI::IsMember(words));
    app.add_option("--seed", settings.seed,
                   "of the first trial of each family; the next has the next");
    app.add_option("--seconds", settings.seconds, "of all families together");
    app.add_option("--trials", settings.trials, "of each family, however long they take");
    app.add_option("--rays", settings.rays, "of a trial");
    app.add_option("--width", settings.width, "of a trial's picture; 0: none");
    app.add_option("--height", settings.height, "likewise");
    app.add_option("--judged", settings.judged,
                   "share of what is resolved that the referee judges, of scenes of up to 60 "
                   "elements; less of larger ones");
    app.add_option("--bits", settings.most_bits, "of the referee, at most");
    app.add_option("--output", settings.output,
                   "folder for the scenes and rays of answers that are wrong or left open");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    }
    if (!settings.output.empty()) std::filesystem::create_directories(settings.output);

    std::printf("seed %llu, %zu rays and %d x %d pixels a trial\n",
                static_cast<unsigned long long>(settings.seed), settings.rays, settings.width,
                settings.height);
    const double share = settings.seconds / static_cast<double>(words.size());
    std::vector<std::pair<std::string, Tally>> rows;
    Tally all;
    for (const std::string& word : words) {
        const auto family = static_cast<Family>(
            std::find(family_words.begin(), family_words.end(), word) - family_words.begin());
        Tally rays, pixels;
        const auto start = Clock::now();
        // A trial that takes long is cut off, unless each is to be the same again.
        const auto deadline = settings.trials > 0
                                  ? Clock::time_point::max()
                                  : start + std::chrono::duration_cast<Clock::duration>(
                                                std::chrono::duration<double>(1.2 * share));
        for (std::uint64_t n = 0; settings.trials == 0 || n < settings.trials; ++n) {
            const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
            if (settings.trials == 0 && seconds >= share) break;
            const auto [of_rays, of_pixels] =
                Court(settings, family, settings.seed + n, deadline).hold();
            rays.add(of_rays);
            pixels.add(of_pixels);
        }
        all.add(rays);
        all.add(pixels);
        print_row(stderr, word, rays);  // again below, without complaints in between
        print_row(stderr, "  pixels", pixels);
        rows.emplace_back(word, std::move(rays));
        rows.emplace_back("  pixels", std::move(pixels));
    }
    print_header();
    for (const auto& [name, tally] : rows) print_row(stdout, name, tally);
    std::printf("\nwrong %zu, left open %zu, normals or colours off %zu, beyond %ld bits %zu\n",
                all.wrong, all.left_open, all.normals_off + all.colors_off, settings.most_bits,
                all.beyond);
    return all.wrong == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) { return ivory::tools::run_tool("ivory-stress", run, argc, argv); }
