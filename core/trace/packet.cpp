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

// The t up to which the places of core/field/bundle.h are close enough for normals and colours:
// they are off by 2^-98 of it.
double exact_limit(const Field& field, const Bundle& bundle) {
    const Vec3d& o = bundle.origin;
    const double limit = 1e9 * field.least_width;
    return std::max({std::abs(o.x), std::abs(o.y), std::abs(o.z)}) < limit ? limit : 0;
}

}  // namespace

void PacketTracer::take(const RayBundle& rays, bool in_parts) {
    lanes_.count = rays.count;
    lanes_.dx = rays.dx.data();
    lanes_.dy = rays.dy.data();
    lanes_.dz = rays.dz.data();
    packet_steps().prepare(lanes_);

    if (rays.part_count > 0 && in_parts) {
        parts_.assign(rays.parts.begin(), rays.parts.begin() + rays.part_count);
    } else {
        parts_.assign(1, {.axis = rays.bundle.axis, .spread = rays.bundle.spread});
    }
    parts_[0].end = static_cast<std::uint32_t>(rays.count);
}

// Of the hits whose t lies in the window: in float, and in double where that is wanted or float
// loses the direction. Of how many it is known now.
std::size_t PacketTracer::surface_in(const Window& window, const BundlePart& part,
                                     const Field& field, double limit, BundleSurfaces& surfaces,
                                     Cancellation& stop) {
    if (window.coarse_usable) {
        const Looked looked = packet_steps().look(window, field, bundle_field_.unit(), limit,
                                                  lanes_, part.first, part.end, surfaces, stop);
        if (stop.requested()) return 0;
        if (looked.wanted == 0) return 0;
        surfaces.mix(window.strong.elements());
        surfaces.mix(window.weak.elements());
        if (looked.known == looked.wanted && !surfaces.exact) return looked.known;
    }
    const double end = std::min(window.end, limit);
    index_.clear();
    t_.clear();
    std::size_t found = 0;
    for (std::size_t k = part.first; k < part.end; ++k) {
        if (lanes_.state[k] != Lanes::hit) continue;
        if (!(lanes_.t[k] >= window.begin && lanes_.t[k] < end)) continue;
        if (surfaces.found(k)) {
            ++found;
            continue;
        }
        index_.push_back(static_cast<std::uint32_t>(k));
        t_.push_back(lanes_.t[k]);
    }
    if (index_.empty()) return found;
    points_.resize(index_.size());
    const Window& refined = bundle_field_.refined();
    surfaces.mix(refined.fine.elements());
    packet_steps().surface(refined, field, lanes_, index_, t_.data(), points_.data(), stop);
    if (stop.requested()) return 0;
    for (std::size_t i = 0; i < index_.size(); ++i) {
        const std::size_t k = index_[i];
        if (!surfaces.seen(k)) surfaces.set_seen(k, points_[i]);
        if (surfaces.exact) surfaces.points[k] = points_[i];
        if (surfaces.found(k)) ++found;
    }
    return found;
}

std::size_t PacketTracer::isolate(const Field& field, const ElementList& list,
                                  const RayBundle& rays, const Settings& settings,
                                  BundleIsolations& isolations, BundleSurfaces* surfaces,
                                  Counts& counts) {
    if (surfaces != nullptr) surfaces->clear(rays.count);
    if (!bundle_field_.build(field, list, rays.bundle, settings.tolerance,
                             settings.skipping.windows, rays.common, &counts.stop)) {
        for (std::size_t k = 0; k < rays.count; ++k) {
            isolations.set(k, {Status::unresolved, {0.0, infinity<double>}});
        }
        return 0;
    }
    const PacketSteps& steps = packet_steps();
    lanes_.t_lo = isolations.t_lo.data();
    lanes_.t_hi = isolations.t_hi.data();
    take(rays, settings.skipping.parts);
    counts.skipping.rays += rays.count;
    const double T = bundle_field_.threshold(), unit = bundle_field_.unit();
    const double limit = exact_limit(field, rays.bundle);
    const auto any = [&](const BundlePart& part, Lanes::State state) {
        return steps.any(lanes_, state, part.first, part.end);
    };
    std::size_t found = 0;
    const BundlePart& all = parts_[0];
    bundle_field_.for_windows(
        parts_, {lanes_.dx, lanes_.dy, lanes_.dz},
        [&](const BundlePart& part, double, double) { return any(part, Lanes::walking); },
        parts_.size() == 1
            ? budget + budget_of_part
            : budget + static_cast<int>(parts_.size()) * budget_of_part + budget_of_rays,
        [&](Window& window, const BundlePart& part) {
            if (!window.coarse_usable) {
                for (std::size_t k = part.first; k < part.end; ++k) {
                    if (lanes_.state[k] != Lanes::walking) continue;
                    lanes_.state[k] = Lanes::undecided;
                    lanes_.t_lo[k] = window.begin;
                    lanes_.t_hi[k] = infinity<double>;
                }
                return any(all, Lanes::walking);
            }
            ++counts.skipping.windows;
            if (!settings.skipping.coarse) {
                std::replace(lanes_.state.begin() + part.first, lanes_.state.begin() + part.end,
                             std::int32_t{Lanes::walking}, std::int32_t{Lanes::doubtful});
            }
            const Walked walked =
                steps.walk(window, T, unit, settings.greatest_cell, part.first, part.end, lanes_,
                           counts.stop);
            if (counts.stop.requested()) return false;
            counts.evaluations += walked.steps;
            counts.element_evaluations +=
                walked.steps * window.strong.size + walked.close_steps * window.weak.size;
            if (!any(part, Lanes::candidate) && !any(part, Lanes::doubtful)) {
                return any(all, Lanes::walking);
            }
            bundle_field_.complete(window);
            const auto enclose_lanes = [&](const Window& in, double left_out, std::size_t first,
                                           std::size_t end, Lanes::State pinned,
                                           Lanes::State otherwise) {
                const std::uint64_t evaluations =
                    steps.enclose(in, T, unit, settings.greatest_cell, left_out, first, end, pinned,
                                  otherwise, lanes_, counts.stop);
                counts.evaluations += evaluations;
                counts.element_evaluations += evaluations * (in.fine.size + in.faint.size);
            };
            const auto enclose = [&](const Window& in, double left_out, Lanes::State pinned,
                                     Lanes::State otherwise) {
                enclose_lanes(in, left_out, part.first, part.end, pinned, otherwise);
            };
            enclose(window, 0, Lanes::hidden, Lanes::hidden);
            // What the fine list leaves open, with one that leaves out next to nothing.
            if (any(part, Lanes::hidden)) {
                std::replace(lanes_.state.begin() + part.first, lanes_.state.begin() + part.end,
                             std::int32_t{Lanes::hidden}, std::int32_t{Lanes::candidate});
                const auto left_out = [](const Window& by) {
                    return by.fine_bounds.above + by.fine_bounds.below;
                };
                const Window& finer = bundle_field_.finer();
                enclose(finer, left_out(window), Lanes::hidden, Lanes::doubtful);
                // What rises up to the ray's own piece is the sum of either.
                const double left_out_by_both = std::max(left_out(window), left_out(finer));
                for (std::size_t k = part.first; k < part.end; ++k) {
                    if (lanes_.state[k] != Lanes::hidden) continue;
                    if (counts.stop.requested()) return false;
                    // And what rounding leaves open, by the ray itself.
                    const Interval<double> bracket{lanes_.t_lo[k], lanes_.t_hi[k]};
                    const double t = midpoint(bracket);
                    lanes_.state[k] = Lanes::candidate;
                    lanes_.t[k] = t;
                    const Vec3d direction{lanes_.dx[k], lanes_.dy[k], lanes_.dz[k]};
                    enclose_lanes(bundle_field_.closer(direction, t), left_out_by_both, k, k + 1,
                                  Lanes::undecided, Lanes::undecided);
                    if (lanes_.state[k] != Lanes::undecided) continue;
                    lanes_.t_lo[k] = bracket.lo;
                    lanes_.t_hi[k] = bracket.hi;
                }
            }
            if (any(part, Lanes::doubtful)) {
                counts.skipping.rays_doubtful += static_cast<std::uint64_t>(
                    std::count(lanes_.state.begin() + part.first, lanes_.state.begin() + part.end,
                               std::int32_t{Lanes::doubtful}));
                const Window& refined = bundle_field_.refined();
                const std::uint64_t again =
                    steps.walk_again(refined, T, part.first, part.end, lanes_, counts.stop);
                counts.evaluations += again;
                counts.element_evaluations += again * refined.fine.size;
                enclose(refined, 0, Lanes::undecided, Lanes::undecided);
            }
            if (counts.stop.requested()) return false;
            if (surfaces != nullptr) {
                found += surface_in(window, part, field, limit, *surfaces, counts.stop);
            }
            return any(all, Lanes::walking);
        });
    counts.skipping.stretches += bundle_field_.stretches();
    counts.skipping.stretches_ended += bundle_field_.stretches_ended();
    if (counts.stop.requested()) {
        for (std::size_t k = 0; k < rays.count; ++k) {
            isolations.set(k, {Status::unresolved, {0.0, infinity<double>}});
        }
        return 0;
    }
    steps.conclude(lanes_, isolations);
    return found;
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
    if (!bundle_field_.build(field, list, rays.bundle, tolerance, true, rays.common, &stop)) {
        return;
    }
    take(rays, true);
    for (std::size_t k = 0; k < rays.count; ++k) {
        lanes_.state[k] = std::isfinite(m[k]) ? Lanes::hit : Lanes::unused;
        lanes_.t[k] = m[k];
    }
    bundle_field_.for_windows(
        parts_, {lanes_.dx, lanes_.dy, lanes_.dz},
        [&](const BundlePart& part, double t0, double t1) {
            return std::any_of(m.begin() + part.first, m.begin() + part.end,
                               [=](double t) { return t >= t0 && t < t1 && t < limit; });
        },
        std::numeric_limits<int>::max(),
        [&](Window& window, const BundlePart& part) {
            surface_in(window, part, field, limit, surfaces, stop);
            return !stop.requested();
        });
}

}  // namespace ivory
