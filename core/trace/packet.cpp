#include "core/trace/packet.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ivory {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// Stretches of t that are bounded for one bundle, for each of its parts and for the rays of these;
// if that is not enough, the rays are better traced one by one.
constexpr int budget = 1024, budget_of_part = 256, budget_of_rays = 8192;

// The t up to which the places of core/field/bundle_field.h are close enough for normals and colours:
// they are off by 2^-98 of it.
double exact_limit(const Field& field, const Bundle& bundle) {
    const Vec3d& o = bundle.origin;
    const double limit = 1e9 * field.least_width;
    return std::max({std::abs(o.x), std::abs(o.y), std::abs(o.z)}) < limit ? limit : 0;
}

}  // namespace

void PacketTracer::take(const RayBundle& rays, bool in_parts) {
    lanes_.count = rays.count;
    lanes_.rays = rays.columns();
    packet_steps().prepare(lanes_);

    if (rays.part_count > 0 && in_parts) {
        parts_.assign(rays.parts.begin(), rays.parts.begin() + rays.part_count);
    } else {
        parts_.assign(1, whole_of(rays.bundle));
    }
    parts_[0].end = static_cast<std::uint32_t>(rays.count);
}

// Of the hits whose t lies in the window: in float, and in double where that is wanted or float
// loses the direction. Of how many it is known now.
std::size_t PacketTracer::surface_in(Window& window, const BundlePart& part, const Field& field,
                                     double limit, BundleSurfaces& surfaces, Cancellation& stop) {
    if (window.condensed != nullptr) {
        const auto hit_here = [&](std::size_t k) {
            return lanes_.state[k] == Lanes::hit && lanes_.t[k] >= window.begin &&
                   lanes_.t[k] < window.end;
        };
        std::size_t k = part.first;
        while (k < part.end && !hit_here(k)) ++k;
        if (k == part.end) return 0;
        if (window.is_rough) descent_.field().condense_closely(window);
        descent_.field().enter(window);
    }
    if (window.coarse_usable) {
        const SeenSurfaces looked =
            packet_steps().look(window, field, descent_.field().unit(), limit, lanes_, part.first,
                                part.end, surfaces, stop);
        if (stop.requested()) return 0;
        if (looked.wanted == 0) return 0;
        surfaces.mix(window.strong.elements());
        surfaces.mix(window.weak.elements());
        if (looked.known == looked.wanted && !surfaces.exact) return looked.known;
    }
    const double end = std::min(window.end, limit);
    index_.clear();
    std::size_t found = 0;
    for (std::size_t k = part.first; k < part.end; ++k) {
        if (lanes_.state[k] != Lanes::hit) continue;
        if (!(lanes_.t[k] >= window.begin && lanes_.t[k] < end)) continue;
        if (surfaces.found(k)) {
            ++found;
            continue;
        }
        index_.push_back(static_cast<std::uint32_t>(k));
    }
    if (index_.empty()) return found;
    points_.resize(index_.size());
    const Window& refined = surfaces.exact ? descent_.field().full() : descent_.field().in_double();
    surfaces.mix(refined.fine.elements());
    packet_steps().surface(refined, field, lanes_, index_, points_.data(), stop);
    if (stop.requested()) return 0;
    for (std::size_t i = 0; i < index_.size(); ++i) {
        const std::size_t k = index_[i];
        if (!surfaces.seen(k)) surfaces.set_seen(k, points_[i]);
        if (surfaces.exact) surfaces.points[k] = points_[i];
        if (surfaces.found(k)) ++found;
    }
    return found;
}

bool PacketTracer::any(const BundlePart& part, Lanes::State state) const {
    return packet_steps().any(lanes_, state, part.first, part.end);
}

void PacketTracer::replace(const BundlePart& part, Lanes::State state, Lanes::State by) {
    std::replace(lanes_.state.begin() + part.first, lanes_.state.begin() + part.end,
                 std::int32_t{state}, std::int32_t{by});
}

std::size_t PacketTracer::isolate(const Field& field, const ElementList& list,
                                  const RayBundle& rays, const Settings& settings,
                                  BundleIsolations& isolations, BundleSurfaces* surfaces,
                                  Counts& counts) {
    const auto leave_all = [&] {
        for (std::size_t k = 0; k < rays.count; ++k) {
            isolations.set(k, {Status::unresolved, {0.0, infinity<double>}});
        }
    };
    if (surfaces != nullptr) surfaces->clear(rays.count);
    if (!descent_.build(field, list, rays.bundle, settings.tolerance, settings.skipping.windows,
                        rays.common, &counts.stop)) {
        leave_all();
        return 0;
    }
    lanes_.t_lo = isolations.t_lo.data();
    lanes_.t_hi = isolations.t_hi.data();
    take(rays, settings.skipping.parts);
    counts.skipping.rays += rays.count;
    Job job{field, settings, surfaces, exact_limit(field, rays.bundle), counts};
    descent_.begin(parts_, lanes_.rays,
                   parts_.size() == 1
                       ? budget + budget_of_part
                       : budget + static_cast<int>(parts_.size()) * budget_of_part + budget_of_rays,
                   true);
    const auto wanted = [&](const BundlePart& part, double, double) {
        return any(part, Lanes::walking);
    };
    std::size_t found = 0;
    while (Window* const window = descent_.next(wanted)) {
        const BundlePart part = descent_.part();
        if (window->is_unknown) {
            leave(*window, part);
        } else if (climb(*window, part, job) && surfaces != nullptr) {
            found += surface_in(*window, part, field, job.surface_limit, *surfaces, counts.stop);
        }
        if (counts.stop.requested() || !any(parts_[0], Lanes::walking)) break;
    }
    counts.skipping.stretches += descent_.field().stretches();
    counts.skipping.stretches_ended += descent_.field().stretches_ended();
    if (counts.stop.requested()) {
        leave_all();
        return 0;
    }
    packet_steps().conclude(lanes_, isolations);
    return found;
}

void PacketTracer::certify(const Field& field, const ElementList& list, const RayBundle& rays,
                           const Footprint& footprint, const Settings& settings,
                           BundleIsolations& isolations, BundleSurfaces& surfaces, Counts& counts) {
    const auto leave_all = [&] {
        std::fill_n(isolations.status.begin(), rays.count, Status::unresolved);
    };
    surfaces.clear(rays.count);
    if (footprint.spread > Footprint::widest ||
        !descent_.build(field, list, rays.bundle, settings.tolerance, settings.skipping.windows,
                        rays.common, &counts.stop)) {
        leave_all();
        return;
    }
    lanes_.t_lo = isolations.t_lo.data();
    lanes_.t_hi = isolations.t_hi.data();
    take(rays, true);
    const double limit = exact_limit(field, rays.bundle);
    // A part of one ray alone would not hold its pixel's.
    descent_.begin(parts_, {}, budget + static_cast<int>(parts_.size()) * budget_of_part);
    const auto goes_on = [&](const BundlePart& part) {
        return any(part, Lanes::walking) || any(part, Lanes::entering);
    };
    const auto wanted = [&](const BundlePart& part, double, double) { return goes_on(part); };
    std::fill_n(entering_.pending.begin(), rays.count, std::uint8_t{0});
    while (Window* const window = descent_.next(wanted)) {
        const BundlePart part = descent_.part();
        if (!window->coarse_usable) {
            leave(*window, part);
            replace(part, Lanes::entering, Lanes::undecided);
        } else {
            const FootprintBounds bounds{footprint.radius + window->end * footprint.spread,
                                         descent_.field().bound_across()};
            const std::uint64_t steps = packet_steps().certify(
                *window, bounds, descent_.field().threshold(), descent_.field().unit(), part.first,
                part.end, lanes_, entering_, counts.stop);
            counts.evaluations += steps;
            counts.element_evaluations += steps * (window->strong.size + window->weak.size);
            surface_in(*window, part, field, limit, surfaces, counts.stop);
            for (std::size_t k = part.first; k < part.end; ++k) {
                if (entering_.pending[k] == 0) continue;
                entering_.pending[k] = 0;
                lanes_.state[k] = Lanes::entering;
            }
        }
        if (counts.stop.requested() || !goes_on(parts_[0])) break;
    }
    if (counts.stop.requested()) {
        leave_all();
        return;
    }
    packet_steps().conclude(lanes_, isolations);
    for (std::size_t k = 0; k < rays.count; ++k) {
        if (isolations.status[k] == Status::hit) {
            isolations.t_lo[k] = isolations.t_hi[k] = lanes_.t[k];
        }
    }
}

// True: there may be hits to be looked at.
bool PacketTracer::climb(Window& window, const BundlePart& part, Job& job) {
    const Cancellation& stop = job.counts.stop;
    ++job.counts.skipping.windows;
    // What float cannot tell at all begins in double.
    if (!job.settings.skipping.coarse || !window.coarse_usable) {
        replace(part, Lanes::walking, Lanes::doubtful);
    }
    walk(window, part, job);
    if (stop.requested()) return false;
    if (window.condensed != nullptr && window.is_rough &&
        (any(part, Lanes::candidate) || any(part, Lanes::doubtful))) {
        // From its begin, now that there may be a root.
        replace(part, Lanes::candidate, Lanes::walking);
        replace(part, Lanes::doubtful, Lanes::walking);
        descent_.field().condense_closely(window);
        if (!window.coarse_usable) {
            leave(window, part);
            return false;
        }
        if (!job.settings.skipping.coarse) replace(part, Lanes::walking, Lanes::doubtful);
        walk(window, part, job);
        if (stop.requested()) return false;
    }
    if (!any(part, Lanes::candidate) && !any(part, Lanes::doubtful)) return false;

    if (window.condensed == nullptr) {
        if (any(part, Lanes::candidate)) {
            descent_.field().complete(window);
            enclose(window, part, job);
            if (any(part, Lanes::hidden)) enclose_more(window, part, job);
        }
    } else {
        enclose_condensed(window, part, job);
    }
    if (stop.requested()) return false;
    if (window.condensed != nullptr && any(part, Lanes::doubtful)) walk_along(part, job);
    if (any(part, Lanes::doubtful)) walk_again(part, job);
    return !stop.requested();
}

void PacketTracer::walk(const Window& window, const BundlePart& part, Job& job) {
    const Walked walked = packet_steps().walk(window, descent_.field().threshold(),
                                              descent_.field().unit(), job.settings.greatest_cell,
                                              part.first, part.end, lanes_, job.counts.stop);
    job.counts.evaluations += walked.steps;
    job.counts.element_evaluations +=
        walked.steps * window.strong.size + walked.close_steps * window.weak.size;
    if (window.condensed != nullptr) job.counts.element_evaluations += window.condensed->elements;
}

void PacketTracer::enclose_lanes(const Window& in, double left_out, std::size_t first,
                                 std::size_t end, Lanes::State pinned, Lanes::State otherwise,
                                 Job& job) {
    const std::uint64_t evaluations = packet_steps().enclose(
        in, descent_.field().threshold(), descent_.field().unit(), job.settings.greatest_cell,
        left_out, first, end, pinned, otherwise, lanes_, job.counts.stop);
    job.counts.evaluations += evaluations;
    job.counts.element_evaluations += evaluations * (in.fine.size + in.fine_in_float.size);
}

void PacketTracer::enclose(const Window& window, const BundlePart& part, Job& job) {
    enclose_lanes(window, 0, part.first, part.end, Lanes::hidden, Lanes::hidden, job);
}

// What was walked to in a polynomial, by the elements themselves.
void PacketTracer::enclose_condensed(const Window& window, const BundlePart& part, Job& job) {
    const Window& more = descent_.field().full_mixed();
    enclose_lanes(more, window.walk_left_out, part.first, part.end, Lanes::hidden, Lanes::doubtful,
                  job);
    for (std::size_t k = part.first; k < part.end; ++k) {
        if (lanes_.state[k] != Lanes::hidden) continue;
        if (job.counts.stop.requested()) return;
        const Window* const along = condensed_along(k, part);
        if (along == nullptr) break;
        ++job.counts.climbers[Rung::along_root];
        lanes_.state[k] = Lanes::candidate;
        enclose_lanes(*along, window.walk_left_out, k, k + 1, Lanes::hidden, Lanes::doubtful, job);
    }
    about_roots(std::max(window.walk_left_out, more.fine_bounds.above + more.fine_bounds.below),
                part, job);
}

const Window* PacketTracer::condensed_along(std::size_t k, const BundlePart& part) {
    return descent_.field().along(lanes_.rays.origin(k, part.origin), lanes_.rays[k]);
}

// What the window's own fine list leaves open, with one that leaves out next to nothing.
void PacketTracer::enclose_more(const Window& window, const BundlePart& part, Job& job) {
    job.counts.climbers[Rung::enclose_more] += static_cast<std::uint64_t>(
        std::count(lanes_.state.begin() + part.first, lanes_.state.begin() + part.end,
                   std::int32_t{Lanes::hidden}));
    replace(part, Lanes::hidden, Lanes::candidate);
    const auto left_out = [](const Window& by) {
        return by.fine_bounds.above + by.fine_bounds.below;
    };
    const Window& more = descent_.field().full_mixed();
    enclose_lanes(more, left_out(window), part.first, part.end, Lanes::hidden, Lanes::doubtful,
                  job);
    // What rises up to a ray's own piece is the sum of either.
    about_roots(std::max(left_out(window), left_out(more)), part, job);
}

// And what rounding leaves open, by the ray itself.
void PacketTracer::about_roots(double left_out, const BundlePart& part, Job& job) {
    for (std::size_t k = part.first; k < part.end; ++k) {
        if (lanes_.state[k] != Lanes::hidden) continue;
        if (job.counts.stop.requested()) return;
        ++job.counts.climbers[Rung::about_root];
        const Interval<double> bracket{lanes_.t_lo[k], lanes_.t_hi[k]};
        const double t = midpoint(bracket);
        lanes_.state[k] = Lanes::candidate;
        lanes_.t[k] = t;
        const Vec3d direction = lanes_.rays[k], origin = lanes_.rays.origin(k, part.origin);
        enclose_lanes(descent_.field().about_root(origin, direction, t), left_out, k, k + 1,
                      Lanes::undecided, Lanes::undecided, job);
        if (lanes_.state[k] != Lanes::undecided) continue;
        lanes_.t_lo[k] = bracket.lo;
        lanes_.t_hi[k] = bracket.hi;
    }
}

// Of a crowd: by each ray's own polynomial.
void PacketTracer::walk_along(const BundlePart& part, Job& job) {
    Counts& counts = job.counts;
    for (std::size_t k = part.first; k < part.end; ++k) {
        if (lanes_.state[k] != Lanes::doubtful) continue;
        if (counts.stop.requested()) return;
        const Window* const along = condensed_along(k, part);
        if (along == nullptr) return;
        ++counts.climbers[Rung::walk_along];
        counts.evaluations += packet_steps().walk_again(*along, descent_.field().threshold(), k,
                                                        k + 1, lanes_, counts.stop);
        enclose_lanes(*along, 0, k, k + 1, Lanes::undecided, Lanes::undecided, job);
    }
}

void PacketTracer::walk_again(const BundlePart& part, Job& job) {
    Counts& counts = job.counts;
    counts.climbers[Rung::walk_again] += static_cast<std::uint64_t>(
        std::count(lanes_.state.begin() + part.first, lanes_.state.begin() + part.end,
                   std::int32_t{Lanes::doubtful}));
    const Window& whole = descent_.field().in_double();
    const std::uint64_t steps = packet_steps().walk_again(
        whole, descent_.field().threshold(), part.first, part.end, lanes_, counts.stop);
    counts.evaluations += steps;
    counts.element_evaluations += steps * whole.fine.size;
    enclose_lanes(whole, 0, part.first, part.end, Lanes::undecided, Lanes::undecided, job);
}

void PacketTracer::leave(const Window& window, const BundlePart& part) {
    for (std::size_t k = part.first; k < part.end; ++k) {
        if (lanes_.state[k] != Lanes::walking) continue;
        lanes_.state[k] = Lanes::undecided;
        lanes_.t_lo[k] = window.begin;
        lanes_.t_hi[k] = infinity<double>;
    }
}

void PacketTracer::surface(const Field& field, const ElementList& list, const RayBundle& rays,
                           double tolerance, std::span<const double> m, BundleSurfaces& surfaces,
                           Cancellation& stop) {
    const double limit = exact_limit(field, rays.bundle);
    for (std::size_t k = 0; k < rays.count; ++k) {
        if (!std::isfinite(m[k])) continue;
        surfaces.nx[k] = std::numeric_limits<float>::quiet_NaN();
        if (surfaces.exact) surfaces.points[k].normal.x = nan;
    }
    if (!descent_.build(field, list, rays.bundle, tolerance, true, rays.common, &stop)) {
        return;
    }
    take(rays, true);
    for (std::size_t k = 0; k < rays.count; ++k) {
        lanes_.state[k] = std::isfinite(m[k]) ? Lanes::hit : Lanes::unused;
        lanes_.t[k] = m[k];
    }
    descent_.begin(parts_, lanes_.rays, std::numeric_limits<int>::max(), true);
    const auto wanted = [&](const BundlePart& part, double t0, double t1) {
        return std::any_of(m.begin() + part.first, m.begin() + part.end,
                           [=](double t) { return t >= t0 && t < t1 && t < limit; });
    };
    while (Window* const window = descent_.next(wanted)) {
        surface_in(*window, descent_.part(), field, limit, surfaces, stop);
        if (stop.requested()) break;
    }
}

}  // namespace ivory
