#include "tests/tools/random_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "tests/reference/reference.h"

namespace ivory::tools {

namespace {

double rounded_off(double x) { return std::round(x * 0x1p20) * 0x1p-20; }

Vec3d rounded_off(const Vec3d& v) { return {rounded_off(v.x), rounded_off(v.y), rounded_off(v.z)}; }

Vec3d sum(const Vec3d& a, const Vec3d& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }

// A star around a middle near `first`, often not convex, in a plane of a few binary digits: its vertices are
// in it exactly.
PolygonSkeleton random_polygon(const Vec3d& first, Random& random) {
    const auto coarse = [&](double x) { return std::round(x * 0x1p8) * 0x1p-8; };
    Vec3d e, f;
    do {
        for (std::size_t k = 0; k < 3; ++k) {
            e[k] = coarse(random.uniform(-1, 1));
            f[k] = coarse(random.uniform(-1, 1));
        }
    } while (dot(cross(e, f), cross(e, f)) < 0.05);
    const std::size_t count = 3 + random.below(6);
    std::vector<Vec3d> vertices;
    for (std::size_t i = 0; i < count; ++i) {
        const double angle = 2 * 3.14159265 * (static_cast<double>(i) + random.uniform(0.1, 0.9)) /
                             static_cast<double>(count);
        const double radius = random.uniform(0.3, 1.2);
        vertices.push_back(first + coarse(radius * std::cos(angle)) * e +
                           coarse(radius * std::sin(angle)) * f);
    }
    return PolygonSkeleton(std::move(vertices));
}

// Its first place is that one, others are near it; some directions are along an axis.
// Some curves are as wild as four places can be, unless all are to be `calm`: of a few arcs.
Skeleton random_skeleton(Shape shape, const Vec3d& first, bool calm, Random& random) {
    Skeleton skeleton = skeleton_of(shape);
    if (auto* const chain = std::get_if<PolylineSkeleton>(&skeleton)) {
        chain->points.resize(2 + random.below(5));
    }
    if (std::holds_alternative<PolygonSkeleton>(skeleton)) {
        PolygonSkeleton polygon;
        do polygon = random_polygon(first, random);
        while (polygon.fault());
        return polygon;
    }
    if (auto* const curve = std::get_if<CurveSkeleton>(&skeleton)) {
        curve->control_points.resize(3 + random.below(2));
        if (random.chance(0.7) || calm) {
            const Vec3d along = rounded_off(random.in_cube(0.5));
            for (std::size_t i = 0; i < curve->control_points.size(); ++i) {
                curve->control_points[i] =
                    first + static_cast<double>(i) * along + rounded_off(random.in_cube(0.08));
            }
            return skeleton;
        }
    }
    const Members members(skeleton);
    for (Vec3d* const place : members.places) {
        const bool is_apart = place != members.places.front() && !random.chance(0.05);
        *place = is_apart ? sum(first, rounded_off(random.in_cube(1))) : first;
    }
    for (Vec3d* const direction : members.directions) {
        if (random.chance(0.3)) {
            *direction = {0, 0, 0};
            (*direction)[random.below(3)] = random.sign();
        } else {
            *direction = sum(rounded_off(random.in_cube(1)), {0, 0, 0x1p-21});  // never 0
        }
    }
    for (double* const length : members.lengths) {
        *length = random.chance(0.05) ? 0 : rounded_off(random.uniform(0.1, 1.5));
    }
    return skeleton;
}

Element random_element(const SceneRecipe& recipe, Random& random, double half) {
    Element element;
    const Vec3d first = rounded_off(random.in_cube(half));
    auto shape = static_cast<Shape>(random.below(shape_count));
    // Of a crowd each curve would be many parts.
    if (recipe.elements > 30 && shape == Shape::curve) shape = Shape::polyline;
    element.skeleton = random_skeleton(recipe.only ? recipe.only->shape : shape, first,
                                       recipe.elements > 30 || !recipe.only, random);
    const auto kernel = static_cast<KernelKind>(random.below(kernel_count));
    element.kernel = recipe.only ? recipe.only->kernel : kernel;
    element.strength = random.uniform(0.5, 1.5) * (random.chance(0.2) ? -1 : 1);
    element.width = std::exp(random.uniform(std::log(0.3), std::log(1.5)));
    element.color = {random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1)};
    element.visible = !random.chance(0.05);
    if (recipe.only && is_taper(recipe.only->shape)) {
        element.widths = {element.width};
        while (element.widths.size() < width_places(element.skeleton)) {
            element.widths.push_back(element.width * std::exp(random.uniform(-1.6, 1.6)));
        }
        element.width = *std::min_element(element.widths.begin(), element.widths.end());
    }
    return element;
}

// The same element at -p, or scaled and shifted.
template <class Move>
Element moved(Element element, Move&& move, double factor) {
    const Members members(element.skeleton);
    for (Vec3d* const place : members.places) *place = move(*place);
    for (double* const length : members.lengths) *length *= factor;
    element.width *= factor;
    for (double& width : element.widths) width *= factor;
    return element;
}

}  // namespace

Scene random_scene(const SceneRecipe& recipe, std::uint64_t seed) {
    Random random(seed);
    Scene scene;
    const double half = 0.9 * std::cbrt(static_cast<double>(recipe.elements));
    while (scene.elements.size() < recipe.elements) {
        Element element = random_element(recipe, random, half);
        if (scene.elements.empty()) {
            element.strength = std::fabs(element.strength);
            element.visible = true;
        }
        scene.elements.push_back(element);
        if (recipe.critical) {
            const auto mirror = [](const Vec3d& p) { return Vec3d{-p.x, -p.y, -p.z}; };
            scene.elements.push_back(moved(element, mirror, 1));
        }
    }
    scene.threshold = random.uniform(0.1, 0.9);
    if (recipe.critical) {
        // At the origin t = 0 of any ray that starts there.
        const reference::Ray from_center{{0, 0, 0}, {0, 0, 1}};
        const double field = reference::ReferenceField(scene)
                                 .at(from_center, reference::Real(0.0))
                                 .f.lo.to_double() +
                             scene.threshold;
        const double off = random.sign() * std::pow(10, -random.uniform(3, 14));
        if (field > 0.01) scene.threshold = field * (1 + off);
    }
    const auto place = [&](const Vec3d& p) {
        return Vec3d{p.x * recipe.scale + recipe.shift, p.y * recipe.scale + recipe.shift,
                     p.z * recipe.scale + recipe.shift};
    };
    for (Element& element : scene.elements) element = moved(element, place, recipe.scale);
    return scene;
}

Scene mixed_scene(std::size_t elements, std::uint64_t seed) {
    // These, whatever other shapes there are: measurements are compared over the years.
    constexpr std::array shapes{Shape::point, Shape::segment, Shape::circle};
    Random random(seed);
    const auto in_ball = [&] {
        while (true) {
            const Vec3d p = random.in_cube(1);
            if (dot(p, p) <= 1 && dot(p, p) > 0) return p;
        }
    };
    Scene scene;
    scene.threshold = 0.5;
    scene.camera = Camera{{0, 0, 3.9}, {0, 0, 0}};
    while (scene.elements.size() < elements) {
        Element element;
        const Vec3d center = in_ball(), along = in_ball();
        const double size = random.uniform(0.15, 0.3);
        element.skeleton = skeleton_of(shapes[scene.elements.size() % shapes.size()]);
        const Members members(element.skeleton);
        const Vec3d half = (size / std::sqrt(dot(along, along))) * along;
        // Several places side by side, from -1 to 1 halves.
        for (std::size_t n = 0; n < members.places.size(); ++n) {
            const double last = static_cast<double>(members.places.size() - 1);
            const double share = last > 0 ? 2 * static_cast<double>(n) / last - 1 : 0;
            *members.places[n] = center + share * half;
        }
        for (Vec3d* const direction : members.directions) *direction = along;
        for (double* const length : members.lengths) *length = size;
        element.width = random.uniform(0.1, 0.2);
        element.color = {random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1)};
        scene.elements.push_back(element);
    }
    return scene;
}

}  // namespace ivory::tools
