#include "core/field/field.h"

#include <algorithm>
#include <cmath>

#include "core/field/bounding_box.h"

namespace ivory {
namespace {

bool is_compact(const Field& field) {
    constexpr double largest = 1e30;
    const auto moderate = [](double x) { return x > 1 / largest && x < largest; };
    if (!moderate(field.threshold) || !moderate(field.least_width) ||
        !moderate(field.greatest_width) || !(field.greatest_width < 1e6 * field.least_width)) {
        return false;
    }
    for (std::size_t i = 0; i < field.size(); ++i) {
        const Vec3d a = field.a(i), b = field.b(i);
        const double most = std::max({std::abs(a.x), std::abs(a.y), std::abs(a.z), std::abs(b.x),
                                      std::abs(b.y), std::abs(b.z), field.radius[i]});
        const double share = std::abs(field.strength[i]) / field.threshold;
        if (!(most < largest && share > 1e-30 && share < 1e12)) return false;
    }
    return true;
}

}  // namespace

Field compile(const Scene& scene) {
    Field field;
    field.threshold = scene.threshold;
    for (std::size_t shape = 0; shape < std::variant_size_v<Skeleton>; ++shape) {
        for (std::size_t i = 0; i < scene.elements.size(); ++i) {
            const Element& element = scene.elements[i];
            if (!element.visible || element.skeleton.index() != shape) continue;
            Vec3d a, b;
            double radius = 0;
            if (const auto* point = std::get_if<PointSkeleton>(&element.skeleton)) {
                a = point->position;
            } else if (const auto* segment = std::get_if<SegmentSkeleton>(&element.skeleton)) {
                a = segment->a;
                b = segment->b;
            } else {
                const auto& circle = std::get<CircleSkeleton>(element.skeleton);
                a = circle.center;
                b = circle.normal;
                radius = circle.radius;
            }
            field.shape.push_back(static_cast<Shape>(shape));
            field.kernel.push_back(element.kernel);
            field.strength.push_back(element.strength);
            field.width.push_back(element.width);
            field.ax.push_back(a.x);
            field.ay.push_back(a.y);
            field.az.push_back(a.z);
            field.bx.push_back(b.x);
            field.by.push_back(b.y);
            field.bz.push_back(b.z);
            field.radius.push_back(radius);
            field.color.push_back(element.color);
            field.source.push_back(static_cast<std::uint32_t>(i));
        }
    }
    // Any number serves as a cut; what the kernel is there is enclosed where it is used. A finite
    // support ends at 1.
    const double share = field.threshold * 0x1p-50 / static_cast<double>(field.size());
    for (std::size_t i = 0; i < field.size(); ++i) {
        const double least = share / std::abs(field.strength[i]);
        field.cut.push_back(field.kernel[i] != KernelKind::blinn ? 1
                            : least < 1                          ? std::min(-std::log(least), 700.0)
                                                                 : 0);
    }
    field.least_width =
        field.width.empty() ? 1 : *std::min_element(field.width.begin(), field.width.end());
    field.greatest_width =
        field.width.empty() ? 1 : *std::max_element(field.width.begin(), field.width.end());
    field.compact = is_compact(field);
    field.reach_box = box_of_reach(field);
    field.box = shrunk_box(field, field.reach_box);
    return field;
}

}  // namespace ivory
