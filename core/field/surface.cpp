#include "core/field/surface.h"

#include <cmath>

#include "core/field/kernel.h"
#include "core/math/direction.h"
#include "core/math/offset.h"

namespace ivory {
namespace {

Vec3d scaled(const Vec3d& v, double width) { return {v.x / width, v.y / width, v.z / width}; }

// s = q^2 and the vector (grad s) / 2, both in units of the width.
struct Nearest {
    double s;
    Vec3d away;  // from the skeleton's nearest point
    bool defined = true;
};

Nearest nearest(const Field& field, std::size_t i, const Vec3d& from_a) {
    const double width = field.width[i];
    const Vec3d v = scaled(from_a, width);
    if (field.shape[i] == Shape::point) return {dot(v, v), v};
    if (field.shape[i] == Shape::segment) {
        const Vec3d m = scaled(field.b(i) - field.a(i), width);
        const double mm = dot(m, m);
        const double lambda = mm > 0 ? std::fmin(std::fmax(dot(v, m) / mm, 0.0), 1.0) : 0;
        const Vec3d away = v - lambda * m;
        return {dot(away, away), away};
    }
    // (rho - r)^2 + h^2 with the axis n; half its gradient is (rho - r) across / rho + h n.
    const Vec3d n = unit(field.b(i));
    const double r = field.radius[i] / width;
    const double h = dot(v, n);
    const Vec3d across = v - h * n;
    const double rho = std::sqrt(dot(across, across));
    const double off = rho - r;
    const Vec3d outward = rho > 0 ? (1 / rho) * across : Vec3d{};
    return {off * off + h * h, off * outward + h * n, rho > 0 || r == 0};
}

// One element's share of the sample. k' is 0 beyond a finite support, where an undefined direction
// of the gradient does no harm.
void add(const Field& field, std::size_t i, const Vec3d& from_a, FieldSample& sum, Vec3d& weighted,
         double& weight, double& strongest, bool& defined) {
    const Nearest at = nearest(field, i, from_a);
    // Beyond the support, and where exp(-s) is below all doubles, nothing is added; with a tiny
    // width the numbers below could overflow there.
    if (!(at.s < (field.kernel[i] == KernelKind::blinn ? 800 : 1))) return;
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
        sum.strongest = static_cast<std::uint32_t>(i);
    }
}

template <class Offset>
FieldSample sum_of(const Field& field, const std::vector<std::uint32_t>& elements,
                   Offset offset_of) {
    FieldSample sum;
    Vec3d weighted;
    double weight = 0, strongest = -1;
    bool defined = true;
    for (const std::uint32_t i : elements) {
        add(field, i, offset_of(i), sum, weighted, weight, strongest, defined);
    }
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

double element_value(const Field& field, std::size_t i, const Vec3d& p) {
    const double s = nearest(field, i, p - field.a(i)).s;
    return field.strength[i] * midpoint(kernel_at(field.kernel[i], s));
}

}  // namespace ivory
