#include "core/field/support.h"

#include <cmath>
#include <numeric>

#include "core/field/along_ray.h"
#include "core/field/bounding_box.h"

namespace ivory {
namespace {

constexpr double u = unit_roundoff;

// The greatest distance from a point to the skeleton of element i, rounded up.
double farthest(const Field& field, std::size_t i, const Vec3d& from) {
    const Box3 box = skeleton_box(field, i);
    double square = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const double side = std::max(std::abs(box.lo[k] - from[k]), std::abs(box.hi[k] - from[k]));
        square += side * side;
    }
    return std::sqrt(square) * (1 + 16 * u);
}

}  // namespace

ElementList all_elements(const Field& field) {
    ElementList list;
    list.elements.resize(field.size());
    std::iota(list.elements.begin(), list.elements.end(), 0u);
    list.certainly_empty = field.box.empty();
    return list;
}

// A point x of a ray of the cone, at distance t from the apex, is t sine away from the axis at the
// most. For a point c of a skeleton, the x of a ray that is nearest to c has t <= |c - apex|. So
// the distance from the skeleton to any of the rays is at least its distance to the axis (a half
// line) minus sine times the greatest |c - apex|.
ElementList reaching_elements(const Field& field, const ElementList& parent, const Cone& cone) {
    ElementList list;
    list.rest = parent.rest;
    list.certainly_empty = parent.certainly_empty;
    if (list.certainly_empty) return list;

    int exponent = 0;
    std::frexp(
        std::max(std::abs(cone.axis.x), std::max(std::abs(cone.axis.y), std::abs(cone.axis.z))),
        &exponent);
    const double scale = std::ldexp(1.0, 1 - exponent);
    const Vec3d axis = scale * cone.axis;
    const double speed = std::sqrt(dot(axis, axis)) * (1 - 8 * u);
    // Each element is dropped once, whatever the number of lists between: all together stay below
    // 2^-52 T.
    const double share = field.threshold * 0x1p-52 / (1 + static_cast<double>(field.size()));

    double bound = parent.rest.hi;
    double magnitude = std::abs(parent.rest.hi);
    for (const std::uint32_t i : parent.elements) {
        const double range = farthest(field, i, cone.apex);
        const Interval<double> span{0.0, range / speed * (1 + 16 * u)};
        double peak = 1;
        if (cone.sine <= 1 && span.hi < 1e100) {
            ElementAlongRay e;
            along_ray(field, i, cone.apex, axis, span, infinity<double>, e);
            const double away =
                std::sqrt(e.least) * (1 - 4 * u) - range * cone.sine / field.width[i] * (1 + 8 * u);
            const double q = away > 0 ? away * (1 - 4 * u) : 0;
            peak = e.form == ElementAlongRay::Form::unbounded
                       ? 1
                       : kernel_at(field.kernel[i], q * q * (1 - 4 * u)).hi;
        }
        const double most = field.strength[i] * peak * (1 + 4 * u);
        if (std::abs(most) <= share) {
            list.rest =
                list.rest + (most > 0 ? Interval<double>(0.0, most) : Interval<double>(most, 0.0));
        } else {
            list.elements.push_back(i);
        }
        bound += std::max(most, 0.0);
        magnitude += std::abs(most);
    }
    const double terms = static_cast<double>(parent.elements.size()) + 4;
    list.certainly_empty = bound + terms * 2 * u * magnitude < field.threshold;
    return list;
}

}  // namespace ivory
