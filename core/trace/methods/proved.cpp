#include "core/trace/methods/proved.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/field/inclusion.h"
#include "core/field/surface.h"
#include "core/trace/isolate.h"
#include "core/trace/methods/search.h"
#include "core/trace/packet.h"

namespace ivory {
namespace {

// Enough for a ray that grazes many elements; one that needs more says `unresolved`.
constexpr int evaluation_budget = 4000;

// The greatest power of two <= x, but no less than 2^-1000 (Precision::cell_at has a floor of its
// own).
double power_of_two_below(double x) {
    if (!(x > 0x1p-1000)) return 0x1p-1000;
    int exponent = 0;
    std::frexp(x, &exponent);
    return std::ldexp(1.0, exponent - 1);
}

// Half of what an answer may be wide, in scene units. A coarser grid than 2^-20 widths would save
// at most one step of the walk, and hide bumps that are thinner than a cell.
double greatest_cell(const Field& field, double tolerance) {
    return 0.5 * std::min(tolerance, 0x1p-20) * field.least_width;
}

// A length in units of the scaled t, rounded down.
double in_t(const Search& search, double length) {
    return length / search.speed * (1 - 8 * unit_roundoff);
}

Precision precision_of(const Search& search, const Field& field, const MethodOptions& options) {
    return {power_of_two_below(in_t(search, greatest_cell(field, options.tolerance)))};
}

// Those that reach the ray, or its `part`.
ElementList local_elements(const Field& field, const ElementList& list, const Ray& ray,
                           const Interval<double>& part, const MethodOptions& options,
                           Counts& counts) {
    if (!options.skipping.lists) return list;
    ElementList near = reaching_elements(field, list, {ray.origin, ray.direction, 0}, part);
    counts.stop.after(list.elements.size());
    counts.skipping.list_elements += list.elements.size();
    counts.skipping.list_left_out += list.elements.size() - near.elements.size();
    return near;
}

struct Found {
    Isolation isolation;
    bool one_cell = true;  // a hit is no wider: no sign was hidden
};

// f < 0 certainly holds on [0, outside_until).
Found search_from(double outside_until, const Field& field, const ElementList& list, const Ray& ray,
                  const MethodOptions& options, Counts& counts) {
    // 1. The ray, scaled, as far as it is in the bounding box.
    const Search search = begin_search(field, list, ray, options);
    if (search.over()) return {search.answer};
    const ScaledRay& scaled_ray = search.ray;
    const double least = std::ldexp(outside_until, -scaled_ray.shift) * (1 - 4 * unit_roundoff);
    const Interval<double> span =
        intersection(search.span, Interval<double>(least, infinity<double>));
    if (is_empty(span)) return {{Status::miss, span}};

    // 2. The field along it. A miss already where the peaks do not add up to T.
    thread_local FieldAlongRay along;
    along.build(field, list, scaled_ray.origin, scaled_ray.direction, span);
    counts.add(1, list.elements.size());
    if (along.certainly_outside()) return {search.answer};

    // 3. The first root.
    const Precision precision = precision_of(search, field, options);
    Isolation isolation =
        isolate_first_root(along, span, span.lo > 0 ? Start::outside : Start::unknown, precision,
                           evaluation_budget, counts);

    // 4. Two cells are always narrow enough. A wider bracket is judged by the element that matters
    // there.
    const double width = sub_up(isolation.t.hi, isolation.t.lo);
    const double cell = precision.cell_at(isolation.t.hi);
    if (isolation.status == Status::hit && width > 2 * cell) {
        const FieldSample middle =
            sample(field, list, scaled_ray.origin, scaled_ray.direction, midpoint(isolation.t));
        if (!(width <= in_t(search, options.tolerance * field.width_of_element(middle.strongest))))
            isolation.status = Status::unresolved;
    }
    isolation.t = scaled_ray.unscaled(isolation.t);
    if (isolation.status == Status::hit && !(isolation.t.hi < infinity<double>)) {
        isolation.status = Status::unresolved;  // t is beyond the doubles
    }
    return {isolation, width <= cell};
}

// Where the first root is known to lie in `bracket`, hardly wider than a cell, all that is left to
// find is between which grid lines: signs that the packet's bounds were too wide for. Let g be the
// sum of the elements that take part. If g rises from bracket.lo to a line and f < 0 is certain
// there, f is so on all of the way (isolate.h: f <= g + what is left out); if f > 0 is certain at
// the line, the root is before it. |direction| is 1 within 2^-50. unresolved: not found.
Isolation settled(const Interval<double>& bracket, const Field& field, const ElementList& list,
                  const Ray& ray, const MethodOptions& options, Counts& counts) {
    constexpr double most_lines = 32;
    const Isolation unsettled{Status::unresolved, {bracket.lo, infinity<double>}};
    const Search search = begin_search(field, list, ray, options);
    if (search.over()) return unsettled;
    const double lo = std::ldexp(bracket.lo, -search.ray.shift);
    const double hi = std::ldexp(bracket.hi, -search.ray.shift);
    const double cell = precision_of(search, field, options).cell_at(hi);
    const double first = std::ceil(lo / cell) * cell;  // exact: fewer than 2^50 cells
    if (!(hi - first < most_lines * cell)) return unsettled;

    const Interval<double> span{std::max(first - cell, 0.0), hi + cell};
    const ElementList near =
        local_elements(field, list, ray, search.ray.unscaled(span), options, counts);
    thread_local FieldAlongRay along;
    along.build(field, near, search.ray.origin, search.ray.direction, span);
    double before = lo < first ? first - cell : first;  // f < 0 up to there
    double after = before + cell;                       // the line in question
    for (; after < hi; after += cell) {
        const Enclosure e = along.over(lo, after);
        counts.add(1, along.size());
        if (e.right.lo > 0) break;
        if (e.right.hi < 0 && e.slope.lo > 0) before = after;
    }
    // Two cells, where one line's sign stays hidden, are always narrow enough.
    if (!(after - before <= 2 * cell)) return unsettled;
    return {Status::hit, search.ray.unscaled({before, after})};
}

// Against those elements alone that reach the ray, where there are many; if what the others could
// add hides a sign, which it often would on the finest grids, against all.
// `known`: of the first root, that f < 0 on [0, known.lo) and, if known.hi is finite, that the root
// lies in it.
Isolation isolate_from(const Interval<double>& known, const Field& field, const ElementList& list,
                       const Ray& ray, const MethodOptions& options, Counts& counts) {
    constexpr std::size_t many = 200;
    constexpr double fine = 1e-11;
    const Vec3d& d = ray.direction;
    const double largest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    if (known.hi < infinity<double>) {
        ++counts.climbers[Rung::settle];
        const Isolation isolation = settled(known, field, list, ray, options, counts);
        if (isolation.status == Status::hit) return isolation;
    }
    if (options.skipping.lists && list.elements.size() > many && options.tolerance > fine &&
        largest > 1e-100 && largest < 1e100) {
        ++counts.climbers[Rung::alone_near];
        const ElementList near =
            local_elements(field, list, ray, {0.0, infinity<double>}, options, counts);
        if (near.certainly_empty) return {Status::miss, Interval<double>::empty_set()};
        const Found found = search_from(known.lo, field, near, ray, options, counts);
        if (found.isolation.status == Status::miss) return found.isolation;
        if (found.isolation.status == Status::hit && found.one_cell) return found.isolation;
    }
    ++counts.climbers[Rung::alone_listed];
    return search_from(known.lo, field, list, ray, options, counts).isolation;
}

}  // namespace

Isolation Proved::isolate(const Field& field, const ElementList& list, const Ray& ray,
                          const MethodOptions& options, Counts& counts) const {
    return isolate_from({0.0, infinity<double>}, field, list, ray, options, counts);
}

void Proved::trace_bundle(const Field& field, const ElementList& list, const RayBundle& rays,
                          const MethodOptions& options, BundleIsolations& isolations,
                          BundleSurfaces* surfaces, Counts& counts) const {
    if (!options.skipping.packets) {
        counts.skipping.rays_alone += rays.size();
        Method::trace_bundle(field, list, rays, options, isolations, surfaces, counts);
        return;
    }
    const PacketTracer::Settings settings{
        options.tolerance, greatest_cell(field, options.tolerance), options.skipping};
    thread_local PacketTracer packets;
    const std::size_t found =
        packets.isolate(field, list, rays, settings, isolations, surfaces, counts);
    const BundleTally tally = tally_of(isolations, rays.size());
    const bool all_found = surfaces == nullptr || found == tally[Status::hit];
    if (tally[Status::unresolved] == 0 && all_found) return;
    ElementList elements;  // those of the clusters, once a ray wants them
    const ElementList* for_one = list.clusters.empty() ? &list : nullptr;
    std::array<double, RayBundle::capacity> m;
    bool left = false;
    for (std::size_t k = 0; k < rays.size(); ++k) {
        m[k] = infinity<double>;
        if (isolations.status[k] == Status::unresolved && !counts.stop.requested()) {
            ++counts.skipping.rays_alone;
            if (for_one == nullptr) {
                elements = elements_for(rays, field, list);
                for_one = &elements;
            }
            isolations.set(k, isolate_from({isolations.t_lo[k], isolations.t_hi[k]}, field,
                                           *for_one, rays.ray(k), options, counts));
        }
        if (surfaces == nullptr || isolations.status[k] == Status::miss || surfaces->found(k)) {
            continue;
        }
        m[k] = midpoint(isolations[k].t);
        left = true;
    }
    if (left)
        surface_bundle(field, list, rays, options, {m.data(), rays.size()}, *surfaces, counts.stop);
}

void Proved::certify_bundle(const Field& field, const ElementList& list, const RayBundle& rays,
                            const Footprint& footprint, const MethodOptions& options,
                            BundleIsolations& isolations, BundleSurfaces& surfaces,
                            Counts& counts) const {
    if (!options.skipping.packets) {
        Method::certify_bundle(field, list, rays, footprint, options, isolations, surfaces, counts);
        return;
    }
    thread_local PacketTracer packets;
    packets.certify(field, list, rays, footprint,
                    {options.tolerance, greatest_cell(field, options.tolerance), options.skipping},
                    isolations, surfaces, counts);
}

void Proved::surface_bundle(const Field& field, const ElementList& list, const RayBundle& rays,
                            const MethodOptions& options, std::span<const double> m,
                            BundleSurfaces& surfaces, Cancellation& stop) const {
    thread_local PacketTracer packets;
    packets.surface(field, list, rays, options.tolerance, m, surfaces, stop);
    // What the packets leave to one ray at a time.
    std::array<double, RayBundle::capacity> left;
    bool any = false;
    for (std::size_t k = 0; k < rays.size(); ++k) {
        const bool is_left = std::isfinite(m[k]) && !surfaces.found(k);
        left[k] = is_left ? m[k] : infinity<double>;
        any = any || is_left;
    }
    if (any) {
        Method::surface_bundle(field, list, rays, options, {left.data(), rays.size()}, surfaces,
                               stop);
    }
}

}  // namespace ivory
