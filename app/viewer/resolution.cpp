#include "app/viewer/resolution.h"

#include <algorithm>
#include <cmath>

namespace ivory {

namespace {

// Of the budget: more than that is not counted on, since times vary; and what a finer picture has to
// be within.
constexpr double comfortable = 0.8, with_room = 0.7;
constexpr int pictures_with_room = 15;
// A picture of fewer pixels takes more for each: its tiles see more. Of a step that nothing is known
// of the worse is expected: of a finer one that the time grows with almost the square of the step's
// ratio, of a coarser one that it shrinks with less than the ratio itself.
constexpr double growth = 1.6, shrinking = 0.8;
// A picture that takes so much of what a finer one takes is not worth being coarse.
constexpr double hardly_quicker = 0.85;
// Shading costs so much of tracing, until more is known.
constexpr double shading_share = 0.25;

}  // namespace

void Resolution::Times::add(double seconds) { last_[count_++ % last_.size()] = seconds; }

std::optional<double> Resolution::Times::typical() const {
    const std::size_t count = std::min(count_, last_.size());
    if (count == 0) return std::nullopt;
    std::array<double, 5> sorted = last_;
    std::sort(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(count));
    return sorted[(count - 1) / 2];
}

std::size_t Resolution::choose(const FineWork& work, double budget, bool goes_on,
                               std::size_t at_least) {
    const auto stays_within = [&](double seconds) {
        return expected(step_, work).value_or(0) <= seconds;
    };
    if (!goes_on || at_least > step_) {
        step_ = std::max(finest_within(comfortable * budget, work), at_least);
        with_room_ = 0;
    } else if (const std::size_t coarser = finest_within(comfortable * budget, work);
               coarser > step_ && !stays_within(budget)) {
        step_ = coarser;
        with_room_ = 0;
    } else if (const std::size_t finer = finest_within(with_room * budget, work); finer >= step_) {
        with_room_ = 0;
    } else if (++with_room_ >= pictures_with_room) {
        step_ = finer;
        with_room_ = 0;
    }
    return step_;
}

void Resolution::learn(std::size_t step, const FineWork& work, double seconds) {
    if (step > 0) {
        coarse_[step].add(seconds);
    } else if (work.effort >= 1) {
        (work.shades ? shades_ : traces_).add(seconds / work.effort);
    }
}

// The finest step that is; where none is, the one that is quickest. Where a finer one takes hardly
// longer that one instead: a processor that others use, too, may be late with any.
std::size_t Resolution::finest_within(double seconds, const FineWork& work) const {
    const auto takes = [&](std::size_t step) { return expected(step, work).value_or(0); };
    std::size_t best = 0;
    for (std::size_t step = 1; step < resolution_steps.size() && takes(best) > seconds; ++step)
        if (takes(step) < hardly_quicker * takes(best)) best = step;
    return best;
}

std::optional<double> Resolution::expected(std::size_t step, const FineWork& work) const {
    const std::optional<double> trace = traces_.typical();
    if (step == 0) {
        std::optional<double> each = work.shades ? shades_.typical() : trace;
        if (!each && work.shades && trace) each = shading_share * *trace;
        if (each) {
            // What was told of full pictures may be old, of one that came first and found nothing warm: one
            // takes no more for each pixel than the coarser ones that are made now.
            const auto now = step_ > 0 && !work.shades ? coarse_[step_].typical() : std::nullopt;
            const double most = *each * work.effort;
            if (!now || !(work.whole > 0)) return most;
            return std::min(most, *now * resolution_steps[step_] * resolution_steps[step_] *
                                      work.effort / work.whole);
        }
        if (work.shades) return std::nullopt;
    } else if (const auto known = coarse_[step].typical()) {
        return known;
    }
    // from the nearest step that is known, of those as near the coarser one
    std::optional<double> result;
    std::size_t least = resolution_steps.size();
    for (std::size_t other = 0; other < resolution_steps.size(); ++other) {
        std::optional<double> known = coarse_[other].typical();
        if (other == 0 && trace) known = *trace * work.whole;
        const std::size_t away = std::max(other, step) - std::min(other, step);
        if (!known || away > least) continue;
        least = away;
        const double ratio = resolution_steps[other] / resolution_steps[step];
        result = *known * std::pow(ratio, ratio > 1 ? growth : shrinking);
    }
    if (result && step == 0 && work.whole > 0) *result *= work.effort / work.whole;
    return result;
}

}  // namespace ivory
