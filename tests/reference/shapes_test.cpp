// The reference's shapes and kernels against brute force, cases done by hand and closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "tests/reference/reference.h"
#include "tests/tools/degenerate_scenes.h"
#include "tests/tools/random_scene.h"

namespace ivory::reference {
namespace {

using tools::Random;

constexpr Kernel all_kernels[] = {Kernel::blinn, Kernel::nishimura, Kernel::wyvill,
                                  Kernel::murakami, Kernel::blobtree};

Element element_of(Skeleton skeleton, double width = 1, Kernel kernel = Kernel::blinn) {
    Element element;
    element.skeleton = std::move(skeleton);
    element.width = width;
    element.kernel = kernel;
    return element;
}
Element tapered(Skeleton skeleton, std::vector<double> widths, Kernel kernel = Kernel::blinn) {
    const double least = *std::min_element(widths.begin(), widths.end());
    Element element = element_of(std::move(skeleton), least, kernel);
    element.widths = std::move(widths);
    return element;
}
ReferenceField field_of(double threshold, const Element& element) {
    return ReferenceField(ReferenceScene{threshold, {element}});
}

Vec3d plus(const Vec3d& a, double x, const Vec3d& b) {
    return {a.x + x * b.x, a.y + x * b.y, a.z + x * b.z};
}
Vec3d from_to(const Vec3d& a, const Vec3d& b) { return {b.x - a.x, b.y - a.y, b.z - a.z}; }
double product(const Vec3d& a, const Vec3d& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vec3d cross(const Vec3d& a, const Vec3d& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
double length(const Vec3d& v) { return std::sqrt(product(v, v)); }

Vec3d bezier(const std::vector<Vec3d>& points, double u) {
    std::vector<Vec3d> c = points;
    for (std::size_t last = c.size() - 1; last > 0; --last) {
        for (std::size_t i = 0; i < last; ++i) c[i] = plus(c[i], u, from_to(c[i], c[i + 1]));
    }
    return c[0];
}

constexpr int samples = 4000;

// q by looking at many points of the skeleton; and by how much that may be too great.
struct Sampled {
    double q = std::numeric_limits<double>::infinity(), off = 0;
    void see(const Vec3d& p, const Vec3d& c, double w) {
        q = std::min(q, length(from_to(c, p)) / w);
    }
};
void sample_chain(const std::vector<Vec3d>& points, const std::vector<double>& widths,
                  const Vec3d& p, Sampled& found) {
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        const double w = widths[i], next = widths[i + 1];
        const Vec3d m = from_to(points[i], points[i + 1]);
        const double least = std::min(w, next);
        for (int k = 0; k <= samples; ++k) {
            const double u = double(k) / samples;
            found.see(p, plus(points[i], u, m), w + u * (next - w));
        }
        const double reach = length(from_to(points[i], p)) + length(m);
        found.off =
            std::max(found.off,
                     (length(m) / least + reach * std::fabs(next - w) / (least * least)) / samples);
    }
}
// A grid on the plane, of points that lie inside by counting crossings.
void sample_polygon(const std::vector<Vec3d>& v, const Vec3d& p, double w, Sampled& found) {
    Vec3d n{0, 0, 0};
    for (std::size_t i = 0; i < v.size(); ++i) n = plus(n, 1, cross(v[i], v[(i + 1) % v.size()]));
    n = plus({0, 0, 0}, 1 / length(n), n);
    Vec3d e = from_to(v[0], v[1]);
    e = plus({0, 0, 0}, 1 / length(e), e);
    const Vec3d f = cross(n, e);
    std::vector<std::pair<double, double>> flat;
    double lo[2] = {1e9, 1e9}, hi[2] = {-1e9, -1e9};
    for (const Vec3d& vertex : v) {
        const Vec3d from = from_to(v[0], vertex);
        flat.emplace_back(product(from, e), product(from, f));
        lo[0] = std::min(lo[0], flat.back().first), hi[0] = std::max(hi[0], flat.back().first);
        lo[1] = std::min(lo[1], flat.back().second), hi[1] = std::max(hi[1], flat.back().second);
    }
    constexpr int grid = 120;
    const double step[2] = {(hi[0] - lo[0]) / grid, (hi[1] - lo[1]) / grid};
    for (int i = 0; i < grid; ++i) {
        for (int j = 0; j < grid; ++j) {
            const double x = lo[0] + (i + 0.5) * step[0], y = lo[1] + (j + 0.5) * step[1];
            bool inside = false;
            for (std::size_t k = 0; k < flat.size(); ++k) {
                const auto& [ax, ay] = flat[k];
                const auto& [bx, by] = flat[(k + 1) % flat.size()];
                if ((ay > y) != (by > y) && x < ax + (y - ay) / (by - ay) * (bx - ax)) {
                    inside = !inside;
                }
            }
            if (inside) found.see(p, plus(plus(v[0], x, e), y, f), w);
        }
    }
    std::vector<Vec3d> closed = v;
    closed.push_back(v[0]);
    sample_chain(closed, std::vector<double>(closed.size(), w), p, found);
    found.off = std::max(found.off, (step[0] + step[1]) / w);
}

Sampled sampled(const Element& element, const Vec3d& p) {
    Sampled found;
    const double w = element.width;
    if (const auto* segment = std::get_if<Segment>(&element.skeleton)) {
        const std::vector<double> one(2, w);
        sample_chain({segment->a, segment->b}, element.widths.empty() ? one : element.widths, p,
                     found);
    } else if (const auto* chain = std::get_if<Polyline>(&element.skeleton)) {
        const std::vector<double> one(chain->points.size(), w);
        sample_chain(chain->points, element.widths.empty() ? one : element.widths, p, found);
    } else if (const auto* curve = std::get_if<Curve>(&element.skeleton)) {
        double whole = 0;
        for (std::size_t i = 0; i + 1 < curve->control_points.size(); ++i) {
            whole = std::max(
                whole, length(from_to(curve->control_points[i], curve->control_points[i + 1])));
        }
        for (int k = 0; k <= samples; ++k) {
            found.see(p, bezier(curve->control_points, double(k) / samples), w);
        }
        found.off = 3 * whole / samples / w;
    } else if (const auto* polygon = std::get_if<Polygon>(&element.skeleton)) {
        sample_polygon(polygon->vertices, p, w, found);
    } else if (const auto* disc = std::get_if<Disc>(&element.skeleton)) {
        const Vec3d n = plus({0, 0, 0}, 1 / length(disc->normal), disc->normal);
        Vec3d e = cross(n, std::fabs(n.x) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0});
        e = plus({0, 0, 0}, 1 / length(e), e);
        const Vec3d f = cross(n, e);
        for (int i = 0; i <= 100; ++i) {
            for (int k = 0; k < 400; ++k) {
                const double r = disc->radius * i / 100, a = 2 * 3.14159265358979 * k / 400;
                found.see(p, plus(plus(disc->center, r * std::cos(a), e), r * std::sin(a), f), w);
            }
        }
        found.off = disc->radius * (0.01 + 0.016) / w;
    }
    return found;
}

Vec3d some_point(Random& random) {
    const Vec3d p = random.in_cube(1);  // multiples of 1/64: ties are common
    return {std::round(p.x * 64) / 64, std::round(p.y * 64) / 64, std::round(p.z * 64) / 64};
}
std::vector<Vec3d> some_points(Random& random, std::size_t count) {
    std::vector<Vec3d> all;
    while (all.size() < count) all.push_back(some_point(random));
    return all;
}
std::vector<double> some_widths(Random& random, std::size_t count) {
    std::vector<double> all;
    while (all.size() < count) all.push_back(random.uniform(0.2, 1.2));
    return all;
}
// Simple, mostly not convex: around a centre, by angle, on a plane through exact points.
Polygon some_polygon(Random& random) {
    const Vec3d e = some_point(random), c = some_point(random);
    Vec3d f = some_point(random);
    const std::size_t count = 3 + random.below(6);
    const bool backwards = random.chance(0.5);
    Polygon polygon;
    for (std::size_t i = 0; i < count; ++i) {
        const double angle = 2 * 3.14159265358979 * double(i) / double(count);
        const double r = random.uniform(0.3, 1.5);
        const double x = std::round(r * std::cos(angle) * 32) / 32;
        const double y = std::round(r * std::sin(angle) * 32) / 32;
        polygon.vertices.push_back(plus(plus(c, x, e), y, f));
    }
    if (backwards) std::reverse(polygon.vertices.begin(), polygon.vertices.end());
    return polygon;
}

Element some_element(Random& random, std::size_t kind) {
    const double w = random.uniform(0.3, 1.5);
    switch (kind % 8) {
        case 0:
            return element_of(Disc{some_point(random), plus({0, 0, 0x1p-10}, 1, some_point(random)),
                                   random.uniform(0.1, 1)},
                              w);
        case 1:
            return element_of(some_polygon(random), w);
        case 2:
            return element_of(Curve{some_points(random, 3)}, w);
        case 3:
            return element_of(Curve{some_points(random, 4)}, w);
        case 4:
            return element_of(Polyline{some_points(random, 2 + random.below(6))}, w);
        case 5: {
            const std::size_t count = 2 + random.below(6);
            return tapered(Polyline{some_points(random, count)}, some_widths(random, count));
        }
        case 6: {  // a taper whose ends are near one another, as against their widths
            const Vec3d a = some_point(random);
            const Vec3d b = plus(a, random.uniform(0, 1), some_point(random));
            return tapered(Segment{a, b}, some_widths(random, 2));
        }
        default:
            return tapered(Segment{some_point(random), some_point(random)}, some_widths(random, 2));
    }
}

bool encloses(const RealInterval& x, const RealInterval& y) { return x.lo <= y.hi && y.lo <= x.hi; }

Germ<RealInterval> square_at(const Element& element, const Vec3d& p, const Vec3d& direction) {
    return ElementAlongRay<RealInterval>(ReadyElement(element), {p, direction}, 0)
        .square(RealInterval(0.0));
}

TEST(ReferenceShapes, AreWhatSamplingSees) {
    Random random(41);
    for (std::size_t i = 0; i < 400; ++i) {
        const Element element = some_element(random, i);
        const Vec3d p = plus({0, 0, 0}, random.uniform(0, 2.5), some_point(random));
        const Sampled expected = sampled(element, p);
        const RealInterval s = square_at(element, p, {0, 0, 1}).value;
        ASSERT_LT(s.width(), Real(1e-30)) << i;
        const double q = std::sqrt(s.hi.to_double());
        EXPECT_LE(q, expected.q + 1e-12) << i;
        EXPECT_GE(q, expected.q - expected.off - 1e-12) << i;
    }
}

// Doubles see what 256 bits see, and the field's two ways agree: along a ray and in space.
TEST(ReferenceShapes, AreOneFieldInEveryWay) {
    Random random(42);
    for (std::size_t i = 0; i < 400; ++i) {
        Element element = some_element(random, i);
        element.kernel = all_kernels[i % 5];
        const ReferenceField field = field_of(0.3, element);
        const Ray ray{plus({0, 0, 0}, 1.3, random.in_cube(1)), random.in_cube(1)};
        const Germ<RealInterval> germ = field.along(ray, RealInterval(0.0));
        const Germ<OutwardDouble> rough =
            ElementAlongRay<OutwardDouble>(field.ready()[0], ray, 0).over(OutwardDouble(0));
        EXPECT_TRUE(encloses(exactly(rough.value) - RealInterval(0.3), germ.value)) << i;
        EXPECT_TRUE(encloses(exactly(rough.slope), germ.slope)) << i;
        EXPECT_LT(rough.value.width(), 1e-9) << i;
        const PointValue point = field.at(ray, Real(0.0));
        EXPECT_TRUE(encloses(point.f, germ.value)) << i;
        EXPECT_LT((point.f - germ.value).width(), Real(1e-30)) << i;
        const RealInterval slope = inner(point.gradient, triple<RealInterval>(ray.direction));
        EXPECT_TRUE(encloses(slope, germ.slope)) << i;
        EXPECT_LT((slope - germ.slope).width(), Real(1e-20)) << i;
    }
}

// Values and difference quotients lie in what is said of an interval; its width shrinks with the
// interval's, faster where it is small.
TEST(ReferenceShapes, IntervalsEncloseTheirPointsAndConverge) {
    Random random(43);
    for (std::size_t i = 0; i < 240; ++i) {
        const ReadyElement ready(some_element(random, i));
        const Ray ray{plus({0, 0, 0}, 2, random.in_cube(1)), random.in_cube(1)};
        const ElementAlongRay<RealInterval> along(ready, ray, 0);
        const ElementAlongRay<OutwardDouble> rough(ready, ray, 0);
        const double lo = random.uniform(0, 3), whole = std::pow(10, random.uniform(-8, 0.5));
        const double hi = lo + whole;
        const Germ<RealInterval> all = along.square({Real(lo), Real(hi)});
        const Germ<OutwardDouble> wide = rough.square(OutwardDouble(lo, hi));
        Germ<RealInterval> last;
        for (int k = 0; k <= 12; ++k) {
            const double t = k == 12 ? hi : lo + whole * k / 12;
            const Germ<RealInterval> one = along.square(RealInterval(t));
            EXPECT_TRUE(all.value.lo <= one.value.hi && all.value.hi >= one.value.lo) << i;
            EXPECT_TRUE(Real(wide.value.lo) <= one.value.hi && Real(wide.value.hi) >= one.value.lo);
            if (k > 0) {
                const RealInterval before(lo + whole * (k - 1) / 12);
                const RealInterval quotient = (one.value - last.value) / (RealInterval(t) - before);
                EXPECT_TRUE(encloses(all.slope, quotient)) << i;
                EXPECT_TRUE(encloses(exactly(wide.slope), quotient)) << i;
            }
            last = one;
        }
        const double steepest =
            std::max(std::fabs(all.slope.lo.to_double()), std::fabs(all.slope.hi.to_double()));
        EXPECT_LE(all.value.width().to_double(), 3 * steepest * whole + 1e-40) << i;
    }
}

// s, its slope along x, and the point that it is of.
void expect_square(const Element& element, const Vec3d& p, const RealInterval& s,
                   const std::string& what) {
    const RealInterval square = square_at(element, p, {1, 0, 0}).value;
    EXPECT_TRUE(encloses(square, s)) << what << ": " << to_string(square.lo);
    EXPECT_LT(square.width(), Real(1e-30)) << what;
}

TEST(ReferenceShapes, AreRightWhereDoneByHand) {
    const Element disc = element_of(Disc{{1, 0, 0}, {0, 0, 5}, 2}, 2);
    expect_square(disc, {2, 1, 3}, 9.0 / 4, "above a disc");
    expect_square(disc, {7, 0, 3}, (16.0 + 9) / 4, "beside a disc");
    expect_square(disc, {1, 0, 0}, 0, "in the middle of a disc");
    expect_square(disc, {3, 0, 1}, 1.0 / 4, "above a disc's rim");
    expect_square(element_of(Disc{{1, 0, 0}, {0, 0, 5}, 0}), {1, 3, 4}, 25, "a disc of no radius");

    // A U, open towards +y.
    const std::vector<Vec3d> u{{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {2, 3, 0},
                               {2, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0}};
    std::vector<Vec3d> turned(u.rbegin(), u.rend());
    for (const auto& vertices : {u, turned}) {
        const Element polygon = element_of(Polygon{vertices});
        expect_square(polygon, {0.5, 2, 4}, 16, "above a leg");
        expect_square(polygon, {1.5, 2, 2}, 0.25 + 4, "between the legs");
        expect_square(polygon, {1.5, 9, 0}, 0.25 + 36, "before the opening");
        expect_square(polygon, {1.5, 0.5, 0}, 0, "in the bottom");
        expect_square(polygon, {1.5, 1, 0}, 0, "on an inner edge");
        expect_square(polygon, {1, 1, 3}, 9, "above an inner corner");
        expect_square(polygon, {-3, -4, 0}, 25, "off a corner");
        expect_square(polygon, {1.5, 1.25, 0}, 0.0625, "at the bottom between the legs");
    }
    // A vertex off the plane of the others by little: projected.
    const Element bent = element_of(Polygon{{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0x1p-40}}});
    EXPECT_LT(square_at(bent, {1, 1, 0}, {1, 0, 0}).value.hi, Real(0x1p-78));

    // With N = (4 e, -4 e, 32), seen off the vertex D = (0, 4, e): it lies at D - N (D.N) / |N|^2.
    const double e = 0x1p-33;
    const Element tilted = element_of(Polygon{{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, e}}});
    const Triple<RealInterval> newell{RealInterval(4 * e), RealInterval(-4 * e), RealInterval(32)};
    const Triple<RealInterval> from_vertex{RealInterval(-3), RealInterval(4), RealInterval(5 - e)};
    const RealInterval up = RealInterval(16 * e) / norm2(newell);
    expect_square(tilted, {-3, 8, 5}, norm2(plus(from_vertex, times(newell, up))),
                  "off a vertex that is projected");

    const Element line = element_of(Curve{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}});
    expect_square(line, {1.2, 2, 0}, 4, "a straight curve");
    expect_square(line, {5, 0, 1}, 5, "beyond its end");
    const Element back = element_of(Curve{{{0, 0, 0}, {4, 0, 0}, {0, 0, 0}}});
    expect_square(back, {1, 1, 0}, 1, "a curve that doubles back, met twice");
    expect_square(back, {5, 0, 0}, 9, "beyond where it turns, at 2");
    const Element spot = element_of(Curve{{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}}}, 2);
    expect_square(spot, {1, 4, 5}, 25.0 / 4, "a curve that is a point");
    expect_square(spot, {1, 1, 1}, 0, "on it");
    const Element speck = element_of(Curve{{{0, 0, 0}, {0x1p-50, 0, 0}, {0x1p-49, 0, 0}}});
    expect_square(speck, {5, 0, 0}, sqr(RealInterval(5) - RealInterval(0x1p-49)),
                  "a curve that doubles take for a point");
    // y = x^2
    const Element parabola = element_of(Curve{{{-1, 1, 0}, {0, -1, 0}, {1, 1, 0}}});
    expect_square(parabola, {0, -2, 0}, 4, "below a parabola");
    expect_square(parabola, {0, 0.5, 0}, 0.25, "at its centre of curvature");
    expect_square(parabola, {0, 1, 0}, 0.75, "inside, two feet");
    const Element cusp = element_of(Curve{{{-1, 1, 0}, {1, -1, 0}, {-1, -1, 0}, {1, 1, 0}}});
    expect_square(cusp, {0, -3, 0}, 6.25, "below a cusp at (0, -1/2)");
    expect_square(cusp, {0, -0.5, 0}, 0, "at the cusp");

    const Element chain = element_of(Polyline{{{0, 0, 0}, {2, 0, 0}, {2, 0, 0}, {2, 2, 0}}});
    expect_square(chain, {3, -1, 0}, 2, "off a joint");
    expect_square(chain, {1, 1, 1}, 2, "as near to both pieces");
    expect_square(element_of(Polyline{{{1, 2, 3}, {1, 2, 3}}}), {1, 2, 4}, 1, "of no length");
}

// Segment from 0 to (4, 0, 0), widths 1 and 3: kappa = 1/2, W = 1 + z/2, apex at z = -2.
TEST(ReferenceShapes, TapersAreRightWhereDoneByHand) {
    const Element taper = tapered(Segment{{0, 0, 0}, {4, 0, 0}}, {1, 3});
    // 1/q^2 = 1/4 + (W/r)^2: z = 0, r = 1: 5/4, with the foot at z + kappa r^2 / W = 1/2.
    expect_square(taper, {0, 0, 1}, RealInterval(4) / RealInterval(5), "on the conical part");
    expect_square(taper, {2, 1, 0}, RealInterval(4) / RealInterval(17),
                  "on the conical part again");
    expect_square(taper, {0, 0, 0}, 0, "at an end");
    expect_square(taper, {-1, 0, 0}, 1, "before the thin end");
    expect_square(taper, {-2, 0, 0}, 4, "at the apex: the same from everywhere");
    expect_square(taper, {-3, 0, 0}, RealInterval(49) / RealInterval(9),
                  "beyond the apex: the thick end");
    expect_square(taper, {10, 0, 0}, 4, "beyond the thick end");
    // The thick end's ball holds the thin one's.
    const Element swallowed = tapered(Segment{{0, 0, 0}, {1, 0, 0}}, {1, 3});
    expect_square(swallowed, {-2, 0, 0}, 1, "the ball of the thick end");
    expect_square(swallowed, {1, 3, 0}, 1, "the same beside");
    const Element at_once = tapered(Segment{{0, 0, 0}, {0, 0, 0}}, {1, 3});
    expect_square(at_once, {0, 3, 0}, 1, "ends that coincide: the greater");
    const Element joined =
        tapered(Polyline{{{0, 0, 0}, {2, 0, 0}, {2, 0, 0}, {4, 0, 0}}}, {1, 1, 2, 2});
    expect_square(joined, {1, 1, 0}, 0.5, "a chain with a step in its width, from below");
    expect_square(joined, {2, 2, 0}, 1, "above the step");
    expect_square(tapered(Segment{{0, 0, 0}, {4, 0, 0}}, {2, 2}), {1, 2, 0}, 1, "of one width");
}

// Where s is constant along the ray it is known to be, over long intervals: along a polygon's face,
// a piece of a chain, and a straight line of a cone.
TEST(ReferenceShapes, AreTightAlongFlatParts) {
    const auto expect_constant = [](const Element& element, const Ray& ray, double lo, double hi,
                                    const RealInterval& s) {
        const ReadyElement ready(element);
        const auto exact =
            ElementAlongRay<RealInterval>(ready, ray, 0).square({Real(lo), Real(hi)});
        EXPECT_TRUE(encloses(exact.value, s));
        EXPECT_LT(exact.value.width(), Real(1e-60));
        EXPECT_LT(exact.slope.width(), Real(1e-60));
        const auto rough =
            ElementAlongRay<OutwardDouble>(ready, ray, 0).square(OutwardDouble(lo, hi));
        EXPECT_LT(rough.value.width(), 1e-12);
        EXPECT_LT(rough.slope.width(), 1e-12);
    };
    const Polygon triangle{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}};
    expect_constant(element_of(triangle, 2), {{-1, 0.5, 1}, {1, 0.25, 0}}, 1.5, 2.5, 0.25);
    const Polyline bar{{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}}};
    expect_constant(element_of(bar), {{-1, -0.5, 0}, {1, 0, 0}}, 1.5, 2.5, 0.25);
    // 1/s = (3/4)^2 + 1
    expect_constant(tapered(Segment{{0, 0, 0}, {4, 0, 0}}, {1, 4}), {{0, 1, 0}, {4, 3, 0}}, 0.1,
                    0.4, RealInterval(16) / RealInterval(25));
}

// At a kink the slope is that of both sides.
TEST(ReferenceShapes, SlopesAtKinksHoldBothSides) {
    const auto both = [](const Element& element, const Vec3d& p, const Vec3d& d, double left,
                         double right) {
        const RealInterval slope = square_at(element, p, d).slope;
        EXPECT_LE(slope.lo, Real(std::min(left, right) + 1e-12));
        EXPECT_GE(slope.hi, Real(std::max(left, right) - 1e-12));
        EXPECT_LT(slope.width().to_double(), std::fabs(left - right) + 1e-12);
    };
    const Element vee = element_of(Polyline{{{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}}});
    both(vee, {0, 0, 0}, {1, 0, 0}, 1, -1);
    both(vee, {0, 0, 0}, {0, 1, 0}, -1, -1);  // in the plane between: no kink
    const Element apex = tapered(Segment{{0, 0, 0}, {4, 0, 0}}, {1, 3});
    both(apex, {-2, 0, 0}, {1, 0, 0}, -12.0 / 9, -4);
    const Element parabola = element_of(Curve{{{-1, 1, 0}, {0, -1, 0}, {1, 1, 0}}});
    const double side = 2 * std::sqrt(0.5);
    both(parabola, {0, 1, 0}, {1, 0, 0}, side, -side);
}

// Where a gradient jumps within 1e-6 widths, normals are not judged; elsewhere they are.
TEST(ReferenceShapes, KnowWhereTheirKinksAre) {
    const auto is_near_kink = [](const Element& element, const Vec3d& p) -> bool {
        return field_of(0.3, element).at({p, {1, 0, 0}}, Real(0.0)).near_kink[0];
    };
    for (const double w : {0.5, 2.0}) {
        const Element vee = element_of(Polyline{{{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}}}, w);
        const Element bow = element_of(Curve{{{-1, 1, 0}, {0, -1, 0}, {1, 1, 0}}}, w);
        const Element ring = element_of(Circle{{0, 0, 0}, {0, 1, 0}, 1}, w);
        const std::vector<Vec3d> corners{{-1, 1, 0}, {-2, -1, 0}, {2, -1, 0}, {1, 1, 0}, {0, 0, 0}};
        const Element notch = element_of(Polygon{corners}, w);
        for (const auto& [element, y] :
             {std::pair{&vee, 0.0}, {&bow, 1.0}, {&ring, 0.5}, {&notch, 1.0}}) {
            EXPECT_TRUE(is_near_kink(*element, {0, y, 0})) << y;
            EXPECT_TRUE(is_near_kink(*element, {1e-7 * w, y, 0})) << y;
            EXPECT_FALSE(is_near_kink(*element, {1e-4 * w, y, 0})) << y;
        }
    }
    EXPECT_FALSE(is_near_kink(element_of(Disc{{0, 0, 0}, {0, 1, 0}, 1}), {0, 0.5, 0}));
    EXPECT_FALSE(is_near_kink(element_of(Polyline{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}}), {1, 1, 0}));
    EXPECT_TRUE(is_near_kink(tapered(Segment{{0, 0, 0}, {4, 0, 0}}, {1, 3}), {-2, 0, 0}));
}

void expect_root(const ReferenceAnswer& answer, const RealInterval& expected,
                 const std::string& what) {
    ASSERT_EQ(answer.outcome, Outcome::hit) << what;
    EXPECT_TRUE(encloses(answer.t, expected)) << what << ": " << to_string(answer.t.lo);
    EXPECT_LT((answer.t - expected).width(), Real(1e-40)) << what;
}

// q where b = 1 times the kernel is T, for those that have closed forms.
RealInterval level(Kernel kernel, double threshold) {
    const RealInterval t(threshold), one(1);
    const auto function = [](auto f, const RealInterval& x) {
        return RealInterval(rounded(f, MPFR_RNDD, x.lo), rounded(f, MPFR_RNDU, x.hi));
    };
    if (kernel == Kernel::murakami) return sqrt(one - sqrt(t));
    if (kernel == Kernel::blobtree) return sqrt(one - function(mpfr_cbrt, t));
    return sqrt(-function(mpfr_log, t));
}

TEST(ReferenceShapes, RootsAreThoseOfClosedForms) {
    for (const Kernel kernel : {Kernel::blinn, Kernel::murakami, Kernel::blobtree}) {
        const RealInterval q = level(kernel, 0.4), nine(9);
        const Ray down{{0.25, 0.125, 9}, {0, 0, -1}};
        const auto root = [&](const Element& element, const Ray& ray) {
            return first_root(field_of(0.4, element), ray);
        };
        expect_root(root(element_of(Disc{{0, 0, 0}, {0, 0, 1}, 1}, 2, kernel), down),
                    nine - RealInterval(2) * q, "a disc's face");
        expect_root(
            root(element_of(Disc{{0, 0, 0}, {0, 0, 1}, 1}, 1, kernel), {{9, 0, 0}, {-1, 0, 0}}),
            RealInterval(8) - q, "a disc edge-on");
        expect_root(
            root(element_of(Polygon{{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}}, 1, kernel),
                 down),
            nine - q, "a polygon's face");
        const std::vector<Vec3d> line{
            {-1, 0.125, 0}, {-0.5, 0.125, 0}, {0, 0.125, 0}, {0.5, 0.125, 0}};
        expect_root(root(element_of(Curve{line}, 1, kernel), down), nine - q, "a straight cubic");
        expect_root(root(element_of(Polyline{{line[0], line[3]}}, 1, kernel), down), nine - q,
                    "a chain of two");
        expect_root(root(tapered(Polyline{{line[0], line[3]}}, {2, 2}, kernel), down),
                    nine - RealInterval(2) * q, "a chain of two of width 2");
        // r = W / sqrt(1/q^2 - kappa^2) above z = 1/2 of the taper, kappa = 1/4, W = 9/8.
        const Element taper = tapered(Segment{{0, 0, 0}, {4, 0, 0}}, {1, 2}, kernel);
        const RealInterval slant = sqrt(RealInterval(1) / sqr(q) - RealInterval(0.0625));
        expect_root(root(taper, {{0.5, 0, 9}, {0, 0, -1}}), nine - RealInterval(1.125) / slant,
                    "a taper's cone");
        expect_root(root(taper, {{-9, 0, 0}, {1, 0, 0}}), nine - q, "a taper's thin end");
        expect_root(root(taper, {{19, 0, 0}, {-1, 0, 0}}), RealInterval(15) - RealInterval(2) * q,
                    "a taper's thick end");
        EXPECT_EQ(root(taper, {{-9, 5, 0}, {1, 0, 0}}).outcome, Outcome::miss);
    }
}

// What is one shape in two ways has one first root on any ray.
TEST(ReferenceShapes, AreTheSameWhereTheyAre) {
    Random random(44);
    int hits = 0;
    for (int i = 0; i < 60; ++i) {
        const Vec3d a = some_point(random), b = some_point(random), c = some_point(random);
        const Vec3d m = plus(plus({0, 0, 0}, 0.5, a), 0.5, b);
        const Kernel kernel = all_kernels[i % 5];
        const double w = random.uniform(0.3, 1);
        const std::vector<std::pair<Element, Element>> pairs{
            {element_of(Segment{a, b}, w, kernel), element_of(Curve{{a, m, b}}, w, kernel)},
            {element_of(Segment{a, b}, w, kernel), element_of(Polyline{{a, m, m, b}}, w, kernel)},
            {element_of(Segment{a, b}, w, kernel), tapered(Segment{a, b}, {w, w}, kernel)},
            {element_of(Polyline{{a, b}}, w, kernel),
             tapered(Polyline{{a, a, b}}, {0.125 * w, w, w}, kernel)},
            {element_of(Polygon{{a, b, c}}, w, kernel), element_of(Polygon{{c, b, a}}, w, kernel)},
            {element_of(Polygon{{a, b, c}}, w, kernel),
             element_of(Polygon{{a, m, b, c}}, w, kernel)},
        };
        const Vec3d o = plus({0, 0, 0}, 4, random.in_cube(1));
        const Ray ray{o, from_to(o, random.in_cube(1))};
        for (const auto& [one, other] : pairs) {
            const ReferenceAnswer first = first_root(field_of(0.35, one), ray);
            const ReferenceAnswer second = first_root(field_of(0.35, other), ray);
            ASSERT_EQ(first.outcome, second.outcome) << i;
            ASSERT_NE(first.outcome, Outcome::unknown) << i;
            if (first.outcome != Outcome::hit) continue;
            ++hits;
            EXPECT_TRUE(encloses(first.t, second.t)) << i;
            EXPECT_LT((first.t - second.t).width(), Real(1e-25)) << i;
        }
    }
    EXPECT_GT(hits, 60);
}

// Signs of f at many points of the ray, in 256 bits, of scenes with every shape and both signs.
TEST(ReferenceShapes, FirstRootsAreWhatSamplingSees) {
    Random random(45);
    int hits = 0, misses = 0;
    for (std::size_t i = 0; i < 40; ++i) {
        ReferenceScene scene{random.uniform(0.1, 0.6), {}};
        for (std::size_t k = 0; k < 4; ++k) {
            scene.elements.push_back(some_element(random, random.below(8)));
            scene.elements.back().kernel = all_kernels[random.below(5)];
            scene.elements.back().strength = k == 2 ? -0.7 : 1;
        }
        const ReferenceField field(scene);
        const Vec3d o = plus({0, 0, 0}, 5, random.in_cube(1));
        const Ray ray{o, from_to(o, random.in_cube(2))};
        const ReferenceAnswer answer = first_root(field, ray);
        ASSERT_NE(answer.outcome, Outcome::unknown) << i;
        const bool hit = answer.outcome == Outcome::hit;
        hit ? ++hits : ++misses;
        const bool inside = certainly_positive(field.along(ray, RealInterval(0.0)).value);
        const double end = hit ? answer.t.lo.to_double() * (1 - 1e-12) : 3;
        for (int k = 0; k <= 60; ++k) {
            const RealInterval f = field.along(ray, RealInterval(end * k / 60)).value;
            EXPECT_TRUE(inside ? certainly_positive(f) : certainly_negative(f)) << i << ' ' << k;
        }
        if (!hit) continue;
        const Germ<RealInterval> f = field.along(ray, answer.t);
        EXPECT_TRUE(encloses(f.value, RealInterval(0.0)) && f.value.width() < Real(1e-30)) << i;
        EXPECT_EQ(certainly_negative(f.slope), inside) << i;
    }
    EXPECT_GT(hits, 8);
    EXPECT_GT(misses, 4);
}

// The reader: each shape and each key of the contract.
TEST(ReferenceScene, IsReadAsWritten) {
    const ReferenceScene scene = parse_reference_scene(R"({"ivory": 1, "threshold": 0.25,
        "camera": {"position": [0, 0, 8]}, "elements": [
        {"shape": "point", "position": [1, 2, 3], "color": [0.5, 0, 1], "name": "a"},
        {"shape": "segment", "a": [0, 0, 0], "b": [1, 0, 0], "width": [0.5, 2]},
        {"shape": "circle", "center": [0, 0, 1], "normal": [0, 2, 0], "radius": 3},
        {"shape": "disc", "center": [0, 0, 1], "normal": [0, 2, 0], "radius": 4, "kernel": "murakami"},
        {"shape": "polygon", "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "strength": -2},
        {"shape": "curve", "control_points": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "kernel": "blobtree"},
        {"shape": "polyline", "points": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "width": [3, 2, 4],
         "visible": false}]})");
    ASSERT_EQ(scene.elements.size(), 7u);
    EXPECT_EQ(scene.threshold, 0.25);
    EXPECT_EQ(std::get<Point>(scene.elements[0].skeleton).position, (Vec3d{1, 2, 3}));
    EXPECT_EQ(scene.elements[0].color, (Vec3d{0.5, 0, 1}));
    EXPECT_EQ(scene.elements[1].widths, (std::vector<double>{0.5, 2}));
    EXPECT_EQ(scene.elements[1].width, 0.5);
    EXPECT_EQ(std::get<Circle>(scene.elements[2].skeleton).radius, 3);
    EXPECT_EQ(std::get<Disc>(scene.elements[3].skeleton).radius, 4);
    EXPECT_EQ(scene.elements[3].kernel, Kernel::murakami);
    EXPECT_EQ(std::get<Polygon>(scene.elements[4].skeleton).vertices.size(), 3u);
    EXPECT_EQ(scene.elements[4].strength, -2);
    EXPECT_EQ(std::get<Curve>(scene.elements[5].skeleton).control_points.size(), 3u);
    EXPECT_EQ(scene.elements[5].kernel, Kernel::blobtree);
    EXPECT_EQ(scene.elements[6].width, 2);
    EXPECT_FALSE(scene.elements[6].visible);
    EXPECT_EQ(ReferenceField(scene).elements().size(), 6u);
}

TEST(ReferenceScene, RefusesWhatItDoesNotKnow) {
    const auto refused = [](const std::string& element) {
        EXPECT_THROW((void)parse_reference_scene(
                         R"({"ivory": 1, "threshold": 0.25, "elements": [)" + element + "]}"),
                     std::runtime_error)
            << element;
    };
    refused(R"({"shape": "sphere", "position": [1, 2, 3]})");
    refused(R"({"shape": "point", "position": [1, 2]})");
    refused(R"({"shape": "point", "position": [1, 2, 3], "widht": 2})");
    refused(R"({"shape": "point", "position": [1, 2, 3], "width": [1, 2]})");
    refused(R"({"shape": "point", "position": [1, 2, 3], "kernel": "gauss"})");
    refused(R"({"shape": "segment", "a": [1, 2, 3], "b": [1, 2, 3], "width": [1, 2, 3]})");
    refused(R"({"shape": "curve", "control_points": [[1, 2, 3], [1, 2, 4]]})");
    refused(R"({"shape": "point", "position": [1, 2, 3], "strength": 0})");
    EXPECT_THROW((void)parse_reference_scene(R"({"ivory": 2, "threshold": 1, "elements": []})"),
                 std::runtime_error);
}

TEST(DegenerateScenes, AreReadAsWritten) {
    for (std::size_t family = 0; family < tools::family_words.size(); ++family) {
        for (std::uint64_t seed = 1; seed <= 10; ++seed) {
            const auto made = degenerate_case(static_cast<tools::Family>(family), seed);
            EXPECT_GE(made.rays.size(), 8u) << tools::family_words[family];
            EXPECT_TRUE(made.scene.threshold >= 0.1 && made.scene.threshold <= 0.6);
            const std::string text = tools::scene_text(made.scene);
            const ReferenceScene read = parse_reference_scene(text);
            EXPECT_EQ(tools::scene_text(read), text);
            EXPECT_EQ(static_cast<std::uint64_t>(read.elements[0].kernel), seed % 5);
            EXPECT_EQ(read.elements[0].strength < 0, seed / 5 % 2 == 1);
        }
    }
}

// All but those that run along the surface itself get an outcome, with a proof.
TEST(DegenerateScenes, AreDecided) {
    int unknown = 0, all = 0, hits = 0;
    for (std::size_t family = 0; family < tools::family_words.size(); ++family) {
        for (std::uint64_t seed = 1; seed <= 9; seed += 2) {  // every kernel, both signs
            const auto made = degenerate_case(static_cast<tools::Family>(family), seed);
            const ReferenceField field(made.scene);
            for (const ivory::Ray& ray : made.rays) {
                const ReferenceAnswer answer = first_root(field, ray);
                ++all;
                hits += answer.outcome == Outcome::hit;
                unknown += answer.outcome == Outcome::unknown;
                if (answer.outcome != Outcome::hit) continue;
                const Germ<RealInterval> f = field.along(ray, answer.t);
                EXPECT_TRUE(encloses(f.value, RealInterval(0.0)));
            }
        }
    }
    EXPECT_GT(all, 1500);
    EXPECT_GT(hits, all / 4);
    EXPECT_EQ(unknown, 0);
}

}  // namespace
}  // namespace ivory::reference
