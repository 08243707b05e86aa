#include "core/shape/convex_part.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>

#include "core/interval/interval.h"
#include "core/math/double_double.h"

namespace ivory {
namespace {

// Where doubles of twice the precision say nothing any more, relative to a polygon of size 1.
constexpr double too_small = 0x1p-90;

struct Point2 {
    DoubleDouble x, y;
};

Point2 operator-(const Point2& a, const Point2& b) { return {a.x - b.x, a.y - b.y}; }

double dot(const Point2& a, const Point2& b) { return (a.x * b.x + a.y * b.y).rounded(); }
// Twice the area of a, b, c; above 0 where they turn left.
double area(const Point2& a, const Point2& b, const Point2& c) {
    const Point2 to_b = b - a, to_c = c - a;
    return (to_b.x * to_c.y - to_b.y * to_c.x).rounded();
}

// A polygon in its plane, sizes near 1: 2^exponent times that is the scene's.
struct Plane {
    int exponent = 0;
    Vec3dd n, e1, e2;
    double length = 0;  // of the Newell normal: twice the area
    std::vector<Point2> at;
    std::vector<Vec3dd> from_first;  // not projected
    double size = 0;                 // the greatest distance from the first vertex
    double error = 1;                // E of convex_part.h
};

Vec3dd scaled(const Vec3dd& v, int exponent) {
    const auto scale = [&](const DoubleDouble& x) {
        return DoubleDouble(std::ldexp(x.hi, exponent), std::ldexp(x.lo, exponent));
    };
    return {scale(v.x), scale(v.y), scale(v.z)};
}

Plane plane_of(std::span<const Vec3d> vertices) {
    Plane plane;
    double largest = 0;
    for (const Vec3d& vertex : vertices) {
        plane.from_first.push_back(difference(vertex, vertices[0]));
        const Vec3d v = rounded(plane.from_first.back());
        largest = std::max({largest, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    }
    std::frexp(largest, &plane.exponent);
    std::size_t farthest = 0;
    Vec3dd normal;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        plane.from_first[i] = scaled(plane.from_first[i], -plane.exponent);
        const double away = length(plane.from_first[i]).rounded();
        if (away > plane.size) {
            plane.size = away;
            farthest = i;
        }
        if (i > 0) normal = normal + cross(plane.from_first[i - 1], plane.from_first[i]);
    }
    plane.length = length(normal).rounded();
    if (!(plane.length > too_small)) return plane;
    // Each product is off by some 2^-97 of the square of the size, near 1.
    const double off = static_cast<double>(vertices.size()) * 0x1p-94 / plane.length;
    plane.error = 1 + off * 0x1p53;
    const auto unit = [](const Vec3dd& v) {
        const DoubleDouble inverse = DoubleDouble(1) / length(v);
        return inverse * v;
    };
    plane.n = unit(normal);
    const Vec3dd& along = plane.from_first[farthest];
    plane.e1 = unit(along - dot(along, plane.n) * plane.n);
    plane.e2 = cross(plane.n, plane.e1);
    for (const Vec3dd& v : plane.from_first)
        plane.at.push_back({dot(v, plane.e1), dot(v, plane.e2)});
    return plane;
}

using Cycle = std::vector<std::uint32_t>;

// No other vertex of the rest lies in the triangle or on it.
bool is_ear(const std::vector<Point2>& at, const Cycle& rest, std::size_t k) {
    const std::size_t count = rest.size();
    const std::size_t before = (k + count - 1) % count, after = (k + 1) % count;
    const Point2 &a = at[rest[before]], &b = at[rest[k]], &c = at[rest[after]];
    if (!(area(a, b, c) > too_small)) return false;
    for (std::size_t i = 0; i < count; ++i) {
        if (i == before || i == k || i == after) continue;
        const Point2& p = at[rest[i]];
        if (area(a, b, p) >= 0 && area(b, c, p) >= 0 && area(c, a, p) >= 0) return false;
    }
    return true;
}

// Triangles by ear clipping. Vertices in line with their neighbours bound nothing by themselves: where no
// ear is left they go.
std::vector<Cycle> triangles_of(const std::vector<Point2>& at) {
    std::vector<Cycle> triangles;
    Cycle rest(at.size());
    std::iota(rest.begin(), rest.end(), 0U);
    std::size_t k = 0, refused = 0;
    while (rest.size() > 3) {
        k %= rest.size();
        if (is_ear(at, rest, k)) {
            const std::size_t count = rest.size();
            triangles.push_back({rest[(k + count - 1) % count], rest[k], rest[(k + 1) % count]});
            rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(k));
            refused = 0;
            ++k;  // not a fan of slivers around one vertex
            continue;
        }
        ++k;
        if (++refused <= rest.size()) continue;
        std::size_t flattest = 0;
        double least = infinity<double>;
        for (std::size_t i = 0; i < rest.size(); ++i) {
            const double turn = std::abs(area(at[rest[(i + rest.size() - 1) % rest.size()]],
                                              at[rest[i]], at[rest[(i + 1) % rest.size()]]));
            if (turn < least) {
                least = turn;
                flattest = i;
            }
        }
        rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(flattest));
        refused = 0;
    }
    if (area(at[rest[0]], at[rest[1]], at[rest[2]]) > too_small) triangles.push_back(rest);
    return triangles;
}

bool is_convex(const std::vector<Point2>& at, const Cycle& cycle) {
    const std::size_t count = cycle.size();
    for (std::size_t i = 0; i < count; ++i) {
        if (area(at[cycle[i]], at[cycle[(i + 1) % count]], at[cycle[(i + 2) % count]]) < 0) {
            return false;
        }
    }
    return true;
}

// Both with the edge that they share left out; empty: they share none.
Cycle joined(const Cycle& a, const Cycle& b) {
    for (std::size_t i = 0; i < a.size(); ++i) {
        const std::uint32_t from = a[i], to = a[(i + 1) % a.size()];
        for (std::size_t k = 0; k < b.size(); ++k) {
            if (b[k] != to || b[(k + 1) % b.size()] != from) continue;
            Cycle both;
            for (std::size_t n = 0; n < a.size(); ++n) both.push_back(a[(i + 1 + n) % a.size()]);
            for (std::size_t n = 2; n < b.size(); ++n) both.push_back(b[(k + n) % b.size()]);
            return both;
        }
    }
    return {};
}

std::vector<Cycle> joined_while_convex(const std::vector<Point2>& at, std::vector<Cycle> parts) {
    for (std::size_t i = 0; i < parts.size();) {
        bool grew = false;
        for (std::size_t k = i + 1; k < parts.size() && !grew; ++k) {
            if (parts[i].size() + parts[k].size() - 2 > convex_part::most_edges) continue;
            Cycle both = joined(parts[i], parts[k]);
            if (both.empty() || !is_convex(at, both)) continue;
            parts[i] = std::move(both);
            parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(k));
            grew = true;
        }
        if (!grew) ++i;
    }
    return parts;
}

double distance(const Point2& p, const Point2& a, const Point2& b) {
    const Point2 along = b - a;
    const double foot = std::clamp(dot(p - a, along) / dot(along, along), 0.0, 1.0);
    const Point2 off{p.x - (a.x + DoubleDouble(foot) * along.x),
                     p.y - (a.y + DoubleDouble(foot) * along.y)};
    return std::sqrt(dot(off, off));
}

// The least of its edges, and of what is between a vertex and another edge.
double least_length(const std::vector<Point2>& at, const Cycle& cycle) {
    const std::size_t count = cycle.size();
    double least = infinity<double>;
    for (std::size_t i = 0; i < count; ++i) {
        const Point2 &a = at[cycle[i]], &b = at[cycle[(i + 1) % count]];
        least = std::min(least, std::sqrt(dot(b - a, b - a)));
        for (std::size_t k = 2; k < count; ++k) {
            least = std::min(least, distance(at[cycle[(i + k) % count]], a, b));
        }
    }
    return least;
}

std::vector<double> numbers_of(const Plane& plane, const Cycle& cycle) {
    using namespace convex_part;
    std::vector<double> numbers;
    numbers.reserve(at_edges + per_edge * cycle.size());
    const auto length = [&](double x) { numbers.push_back(std::ldexp(x, plane.exponent)); };
    numbers.push_back(static_cast<double>(cycle.size()));
    numbers.push_back(8 * plane.error * unit_roundoff);
    for (const Vec3dd* const axis : {&plane.n, &plane.e1, &plane.e2}) {
        const Vec3d v = rounded(*axis);
        numbers.insert(numbers.end(), {v.x, v.y, v.z});
    }
    length(least_length(plane.at, cycle));
    Point2 lo = plane.at[cycle[0]], hi = lo;
    for (const std::uint32_t i : cycle) {
        const Point2& p = plane.at[i];
        lo = {std::min(lo.x.rounded(), p.x.rounded()), std::min(lo.y.rounded(), p.y.rounded())};
        hi = {std::max(hi.x.rounded(), p.x.rounded()), std::max(hi.y.rounded(), p.y.rounded())};
    }
    const Point2 middle{0.5 * lo.x.hi + 0.5 * hi.x.hi, 0.5 * lo.y.hi + 0.5 * hi.y.hi};
    double radius = 0;
    for (const std::uint32_t i : cycle) {
        radius = std::max(radius, std::sqrt(dot(plane.at[i] - middle, plane.at[i] - middle)));
    }
    length(middle.x.hi);
    length(middle.y.hi);
    length(radius * (1 + 0x1p-40) + 8 * plane.error * unit_roundoff * plane.size);
    for (std::size_t i = 0; i < cycle.size(); ++i) {
        const Point2& from = plane.at[cycle[i]];
        const Point2 along = plane.at[cycle[(i + 1) % cycle.size()]] - from;
        const DoubleDouble reach = sqrt(along.x * along.x + along.y * along.y);
        length(from.x.rounded());
        length(from.y.rounded());
        numbers.push_back((along.x / reach).rounded());
        numbers.push_back((along.y / reach).rounded());
        length(reach.rounded());
    }
    return numbers;
}

// Whether a, b and c, d have a place in common.
bool cross_or_touch(const Point2& a, const Point2& b, const Point2& c, const Point2& d) {
    const auto sign = [](double x) { return x > too_small ? 1 : x < -too_small ? -1 : 0; };
    const int of_c = sign(area(a, b, c)), of_d = sign(area(a, b, d));
    const int of_a = sign(area(c, d, a)), of_b = sign(area(c, d, b));
    if (of_c * of_d > 0 || of_a * of_b > 0) return false;
    if (of_c != 0 || of_d != 0 || of_a != 0 || of_b != 0) return true;
    const Point2 along = b - a;  // all on one line
    const double at_c = dot(c - a, along), at_d = dot(d - a, along), end = dot(along, along);
    return std::max(std::min(at_c, at_d), 0.0) <= std::min(std::max(at_c, at_d), end);
}

}  // namespace

convex_part::OffPart convex_part::nearest_in_plane(std::span<const double> numbers, double size,
                                                   double x, double y) {
    const double tau = numbers[at_margin] * (std::abs(x) + std::abs(y) + size);
    OffPart off{0, 0};
    double nearest = infinity<double>;
    bool inside = true;
    const auto edge_count = static_cast<std::size_t>(numbers[at_count]);
    for (std::size_t k = 0; k < edge_count; ++k) {
        const double* const edge = &numbers[at_edges + per_edge * k];
        const double from_x = x - edge[0], from_y = y - edge[1];
        const double along = from_x * edge[2] + from_y * edge[3];
        const double above = from_y * edge[2] - from_x * edge[3];
        const double foot = std::clamp(along, 0.0, edge[4]);
        const double off_x = from_x - foot * edge[2], off_y = from_y - foot * edge[3];
        const bool is_outside = above < tau;
        inside = inside && !is_outside;
        const double square = is_outside && along > 0 && along < edge[4]
                                  ? -1  // none is nearer
                                  : off_x * off_x + off_y * off_y;
        if (!(square < nearest)) continue;
        nearest = square;
        off = {off_x, off_y};
    }
    return inside ? OffPart{0, 0} : off;
}

std::vector<SkeletonPart> convex_parts(std::span<const Vec3d> vertices) {
    const Plane plane = plane_of(vertices);
    std::vector<SkeletonPart> parts;
    SkeletonColumns columns;
    columns.a = columns.b = vertices[0];
    columns.m = rounded(plane.n);
    columns.parameter =
        std::ldexp(plane.size * (1 + 0x1p-40) + 4 * plane.error * unit_roundoff, plane.exponent);
    columns.radius = columns.parameter;
    for (const Cycle& cycle : joined_while_convex(plane.at, triangles_of(plane.at))) {
        parts.push_back({columns, numbers_of(plane, cycle)});
    }
    return parts;
}

std::optional<std::string> polygon_fault(std::span<const Vec3d> vertices) {
    const Plane plane = plane_of(vertices);
    if (!(plane.length > too_small) || plane.error > 0x1p20) {
        return "lie in a line; they must enclose an area";
    }
    double largest = 0, diameter = 0, off = 0;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const Vec3d& v = vertices[i];
        largest = std::max({largest, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
        off = std::max(off, std::abs(dot(plane.from_first[i], plane.n).rounded()));
        for (std::size_t k = i + 1; k < vertices.size(); ++k) {
            const Vec3dd between = plane.from_first[k] - plane.from_first[i];
            diameter = std::max(diameter, std::abs(dot(between, between).hi));
        }
    }
    const double ulp = std::nextafter(largest, infinity<double>) - largest;
    if (off > std::max(1e-9 * std::sqrt(diameter), std::ldexp(8 * ulp, -plane.exponent))) {
        return "do not lie in one plane; move them into it, to 1e-9 of the diameter";
    }
    const std::size_t count = vertices.size();
    for (std::size_t i = 0; i < count; ++i) {
        const Point2 along = plane.at[(i + 1) % count] - plane.at[i];
        if (dot(along, along) > 0) continue;
        return "have one place twice, number " + std::to_string(i + 1) +
               " and the next; leave one out";
    }
    for (std::size_t i = 0; i < count; ++i) {
        const Point2 &a = plane.at[i], &b = plane.at[(i + 1) % count],
                     &c = plane.at[(i + 2) % count];
        const std::string number = std::to_string(i + 1);
        if (std::abs(area(a, b, c)) <= too_small && dot(b - a, c - b) < 0) {
            return "turn back on themselves after number " + number + "; they must go around once";
        }
        for (std::size_t k = i + 2; k < count; ++k) {
            if (i == 0 && k + 1 == count) continue;
            if (!cross_or_touch(a, b, plane.at[k], plane.at[(k + 1) % count])) continue;
            return "make sides that cross or touch, after number " + number + " and number " +
                   std::to_string(k + 1) + "; they must go around once";
        }
    }
    return std::nullopt;
}

}  // namespace ivory
