#include "core/field/field.h"

#include <algorithm>
#include <cmath>

#include "core/field/bounding_box.h"
#include "core/math/direction.h"

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

void make_room(Field& field, std::size_t count) {
    for (auto* column :
         {&field.strength, &field.width, &field.ax, &field.ay, &field.az, &field.bx, &field.by,
          &field.bz, &field.radius, &field.mx, &field.my, &field.mz, &field.extra, &field.length,
          &field.inverse_width, &field.inverse_square, &field.cut}) {
        column->reserve(count);
    }
    field.shape.reserve(count);
    field.kernel.reserve(count);
    field.source.reserve(count);
}

void add(Field& field, const Element& element, std::size_t source) {
    Vec3d a, b, m;
    double radius = 0, length = 0, extra = 0;
    if (const auto* point = std::get_if<PointSkeleton>(&element.skeleton)) {
        a = point->position;
    } else if (const auto* segment = std::get_if<SegmentSkeleton>(&element.skeleton)) {
        a = segment->a;
        b = segment->b;
        m = b - a;
        const double square = dot(m, m);
        length = std::sqrt(square);
        extra = length > 1e-40 ? 1 / square : 0;
    } else {
        const auto& circle = std::get<CircleSkeleton>(element.skeleton);
        a = circle.center;
        b = circle.normal;
        m = unit(b);
        radius = extra = circle.radius;
    }
    field.shape.push_back(static_cast<Shape>(element.skeleton.index()));
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
    field.source.push_back(static_cast<std::uint32_t>(source));
    field.mx.push_back(m.x);
    field.my.push_back(m.y);
    field.mz.push_back(m.z);
    field.extra.push_back(extra);
    field.length.push_back(length);
    field.inverse_width.push_back(1 / element.width);
    field.inverse_square.push_back(1 / (element.width * element.width));
}

}  // namespace

Field compile(const Scene& scene) {
    Field field;
    field.threshold = scene.threshold;
    std::array<std::vector<std::uint32_t>, field_groups> groups;
    std::size_t visible = 0;
    for (std::size_t i = 0; i < scene.elements.size(); ++i) {
        const Element& element = scene.elements[i];
        if (!element.visible) continue;
        const auto shape = static_cast<Shape>(element.skeleton.index());
        groups[group_of(shape, element.kernel)].push_back(static_cast<std::uint32_t>(i));
        ++visible;
    }
    make_room(field, visible);
    for (std::size_t group = 0; group < field_groups; ++group) {
        field.first[group] = static_cast<std::uint32_t>(field.size());
        if (visible >= least_clustered) sort_by_place(scene, groups[group]);
        for (const std::uint32_t i : groups[group]) add(field, scene.elements[i], i);
    }
    field.first[field_groups] = static_cast<std::uint32_t>(field.size());
    recolor(field, scene);
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
    for (std::size_t i = 0; i < field.size(); ++i) {
        field.greatest_size =
            std::max(field.greatest_size, std::max(field.length[i], field.radius[i]));
    }
    field.compact = is_compact(field);
    if (field.compact) {
        constexpr double most_in_float = 0x1p9;
        int exponent = 0;
        std::frexp(field.threshold, &exponent);
        field.scale = std::ldexp(1.0, -exponent);
        std::frexp(field.greatest_width, &exponent);
        field.unit = std::ldexp(1.0, exponent - 1);
        field.suits_float = field.greatest_width < most_in_float * field.least_width &&
                            field.greatest_size < most_in_float * field.greatest_width;
    }
    field.clusters = clusters_of(field);
    for (std::size_t i = 0; i < field.size(); ++i) field.skeletons.include(skeleton_box(field, i));
    field.reach_box = box_of_reach(field);
    field.box = shrunk_box(field, field.reach_box);
    return field;
}

std::vector<std::uint32_t> recolor(Field& field, const Scene& scene) {
    std::vector<std::uint32_t> changed;
    const std::size_t size = field.size();
    field.color.resize(size, Color{-1, -1, -1});  // of none
    field.red.resize(size);
    field.green.resize(size);
    field.blue.resize(size);
    for (std::size_t i = 0; i < size; ++i) {
        const Color& color = scene.elements[field.source[i]].color;
        if (field.color[i] == color) continue;
        changed.push_back(static_cast<std::uint32_t>(i));
        field.color[i] = color;
        field.red[i] = static_cast<float>(color.x);
        field.green[i] = static_cast<float>(color.y);
        field.blue[i] = static_cast<float>(color.z);
    }
    field.one_color = std::all_of(field.color.begin(), field.color.end(),
                                  [&](const Color& c) { return c == field.color.front(); });
    return changed;
}

}  // namespace ivory
