#include "core/trace/packet.h"

#include <algorithm>
#include <limits>

namespace ivory {

void PacketTracer::take(const RayBundle& rays) {
    lanes_.count = rays.count;
    std::copy_n(rays.dx.begin(), rays.count, lanes_.dx.begin());
    std::copy_n(rays.dy.begin(), rays.count, lanes_.dy.begin());
    std::copy_n(rays.dz.begin(), rays.count, lanes_.dz.begin());
}

void PacketTracer::isolate(const Field& field, const ElementList& list, const RayBundle& rays,
                           const Settings& settings, std::span<Isolation> isolations,
                           Counts& counts) {
    const Interval<double> nothing = Interval<double>::empty_set();
    if (!bundle_field_.build(field, list, rays.bundle, settings.tolerance)) {
        std::fill(isolations.begin(), isolations.end(), Isolation{Status::unresolved, nothing});
        return;
    }
    const PacketSteps& steps = packet_steps();
    take(rays);
    steps.prepare(lanes_, rays.bundle.axis);
    const double T = bundle_field_.threshold(), unit = bundle_field_.unit();
    const auto state_is = [](Lanes::State state) {
        return [state](std::int32_t s) { return s == state; };
    };
    const auto begin = lanes_.state.begin();
    const auto end = begin + static_cast<std::ptrdiff_t>(rays.count);
    bundle_field_.for_windows(
        [](double, double) { return true; },
        [&](const Window& window) {
            if (!window.coarse_usable) {
                std::replace(begin, end, std::int32_t{Lanes::walking},
                             std::int32_t{Lanes::undecided});
                return false;
            }
            const std::uint64_t walked = steps.walk(window, T, unit, lanes_);
            const std::uint64_t enclosed =
                steps.enclose(window, T, unit, settings.greatest_cell, lanes_);
            counts.evaluations += walked + enclosed;
            counts.element_evaluations +=
                walked * window.coarse.size() + enclosed * window.fine.size();
            return std::any_of(begin, end, state_is(Lanes::walking));
        });
    for (std::size_t k = 0; k < rays.count; ++k) {
        switch (lanes_.state[k]) {
            case Lanes::walking:
                isolations[k] = {Status::miss, nothing};
                break;
            case Lanes::hit:
                isolations[k] = {Status::hit, {lanes_.t_lo[k], lanes_.t_hi[k]}};
                break;
            default:
                isolations[k] = {Status::unresolved, nothing};
        }
    }
}

void PacketTracer::surface(const Field& field, const ElementList& list, const RayBundle& rays,
                           double tolerance, std::span<const double> m,
                           std::span<SurfacePoint> surfaces) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    double first = infinity<double>, last = -infinity<double>, distance = 0;
    for (std::size_t k = 0; k < rays.count; ++k) {
        surfaces[k].normal = {nan, nan, nan};
        if (!(m[k] < infinity<double>)) continue;
        first = std::min(first, m[k]);
        last = std::max(last, m[k]);
    }
    if (!(first <= last)) return;
    // In plain double, origin + m direction is off by 2^-53 times its terms.
    const Vec3d& o = rays.bundle.origin;
    distance = std::max({std::abs(o.x), std::abs(o.y), std::abs(o.z), last});
    if (!(distance < 1e4 * field.least_width)) return;
    if (!bundle_field_.build(field, list, rays.bundle, tolerance)) return;
    take(rays);
    const PacketSteps& steps = packet_steps();
    bundle_field_.for_windows(
        [&](double t0, double t1) { return t0 <= last && t1 >= first; },
        [&](const Window& window) {
            index_.clear();
            t_.clear();
            for (std::size_t k = 0; k < rays.count; ++k) {
                if (!(m[k] >= window.begin && m[k] < window.end)) continue;
                index_.push_back(static_cast<std::uint32_t>(k));
                t_.push_back(m[k]);
            }
            if (index_.empty()) return true;
            points_.resize(index_.size());
            steps.surface(window, field, lanes_, index_, t_.data(), points_.data());
            for (std::size_t k = 0; k < index_.size(); ++k) surfaces[index_[k]] = points_[k];
            return window.end <= last;
        });
}

std::string_view packet_target() {
    const std::string_view target = packet_steps().target;
    return target.starts_with("AVX3") ? "AVX-512" : target;  // Highway's name for it
}

}  // namespace ivory
