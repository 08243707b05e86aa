#include "core/field/surface.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/math/offset.h"

namespace ivory {
namespace {

Vec3d scaled(const Vec3d& v, double width) { return {v.x / width, v.y / width, v.z / width}; }

Nearest nearest(const Field& field, std::size_t i, const Vec3d& from_a) {
    return with_field_shape(field.shape[i], [&]<class S>() {
        return S::nearest(field.columns(i), from_a, field.width[i]);
    });
}

// The s beyond which nothing is added.
double end_of(KernelKind kind) {
    return with_kernel(kind, []<class K>() {
        if constexpr (K::ends)
            return 1.0;
        else
            return K::vanishes;
    });
}

// How near to one another two parts of an element have to be, in s + 1, and how much of its length
// squared the way to them has to turn, so that there is no telling which is the nearest.
constexpr double tie = 0x1p-44, turn = 0x1p-40;

struct NearestPart {
    std::uint32_t part;
    Nearest at;
};

// Less than the part's s there, as its ball tells.
double least_of_ball(const Field& field, std::size_t i, const Vec3d& from_a) {
    return with_field_shape(field.shape[i], [&]<class S>() {
        if constexpr (S::is_taper) {
            return 0.0;
        } else {
            const Ball ball = S::ball(field.columns(i));
            const Vec3d center = ball.center - field.a(i), away = from_a - center;
            const auto size = [](const Vec3d& v) { return std::sqrt(dot(v, v)); };
            const double distance =
                size(away) - ball.radius - 0x1p-45 * (size(from_a) + size(center) + ball.radius);
            const double q = std::max(distance, 0.0) / field.width[i];
            return q * q * (1 - 0x1p-40);
        }
    });
}

template <class Offset>
NearestPart nearest_of(const Field& field, std::span<const std::uint32_t> parts,
                       const Offset& offset_of) {
    NearestPart best{parts[0], nearest(field, parts[0], offset_of(parts[0]))};
    for (const std::uint32_t i : parts.subspan(1)) {
        if (least_of_ball(field, i, offset_of(i)) > best.at.s + 2 * tie * (best.at.s + 1)) continue;
        const Nearest at = nearest(field, i, offset_of(i));
        const Vec3d here = scaled(at.away, field.width[i]),
                    there = scaled(best.at.away, field.width[best.part]), between = here - there;
        const bool is_tied =
            std::abs(at.s - best.at.s) <= tie * (best.at.s + 1) &&
            dot(between, between) > turn * std::max(dot(here, here), dot(there, there));
        if (at.s < best.at.s) best = {i, at};
        if (is_tied) best.at.defined = false;
    }
    return best;
}

// One element's share of the sample. k' is 0 beyond a finite support, where an undefined direction
// of the gradient does no harm.
void add(const Field& field, const NearestPart& nearest, FieldSample& sum, Vec3d& weighted,
         double& weight, double& strongest, bool& defined) {
    const auto& [i, at] = nearest;
    // With a tiny width the numbers below could overflow there.
    if (!(at.s < end_of(field.kernel[i]))) return;
    const double b = field.strength[i];
    const double k = midpoint(kernel_at(field.kernel[i], at.s));
    const double dk = midpoint(kernel_slope_at(field.kernel[i], at.s));
    sum.value += b * k;
    sum.gradient = sum.gradient + (2 * b * dk / field.width[i]) * at.away;
    if (!at.defined && dk != 0) defined = false;
    const double positive = std::fmax(b * k, 0.0);
    weighted = weighted + positive * field.color[i];
    weight += positive;
    if (std::abs(b * k) > strongest) {
        strongest = std::abs(b * k);
        sum.strongest = i;
    }
}

template <class Offset>
FieldSample sum_of(const Field& field, const std::vector<std::uint32_t>& elements,
                   Offset offset_of) {
    FieldSample sum;
    Vec3d weighted;
    double weight = 0, strongest = -1;
    bool defined = true;
    for_elements(field, elements, [&](std::span<const std::uint32_t> parts) {
        add(field, nearest_of(field, parts, offset_of), sum, weighted, weight, strongest, defined);
    });
    sum.value -= field.threshold;
    if (!defined) sum.gradient = {};
    if (weight > 0) sum.color = scaled(weighted, weight);
    return sum;
}

}  // namespace

FieldSample sample(const Field& field, const ElementList& list, const Vec3d& origin,
                   const Vec3d& direction, double t) {
    return sum_of(field, list.elements, [&](std::size_t i) -> Vec3d {
        return {offset(origin.x, field.ax[i], t, direction.x),
                offset(origin.y, field.ay[i], t, direction.y),
                offset(origin.z, field.az[i], t, direction.z)};
    });
}

FieldSample sample(const Field& field, const Vec3d& p) {
    return sum_of(field, all_elements(field).elements,
                  [&](std::size_t i) { return p - field.a(i); });
}

// v = from_a / w and m / w carry a few u each; at the lambda of a segment, off by a few u |v| / |m|,
// the distance is no less than at the best one, and within that times |m| of it. A circle's axis is
// a unit vector within 4 u, so rho and h are off by a few u |v|. With u = 2^-53, 256 u is ample.
double distance_in_widths(const Field& field, std::size_t i, const Vec3d& from_a) {
    return std::sqrt(nearest(field, i, from_a).s);
}

double element_value(const Field& field, std::span<const std::uint32_t> parts, const Vec3d& p) {
    double s = infinity<double>;
    for (const std::uint32_t i : parts) s = std::min(s, nearest(field, i, p - field.a(i)).s);
    return field.strength[parts[0]] * midpoint(kernel_at(field.kernel[parts[0]], s));
}

}  // namespace ivory
