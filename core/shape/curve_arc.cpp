#include "core/shape/curve_arc.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/interval/quick.h"
#include "core/math/double_double.h"

namespace ivory {
namespace {

using Span = Interval<double>;
using Vector = Vec3<Span>;

// Numbers are rounded from twice the precision: within u of themselves, and what that has lost.
Span about(double x, double lost) {
    const double error = 0x1p-52 * std::abs(x) + lost;
    return {x - error, x + error};
}
Span length_at(std::span<const double> numbers, std::size_t k) {
    return about(numbers[k], numbers[curve_arc::at_lost]);
}
Vector vector_at(std::span<const double> numbers, std::size_t k) {
    return {length_at(numbers, k), length_at(numbers, k + 1), length_at(numbers, k + 2)};
}
Span inner(const Vector& a, const Vector& b) {
    return quick::add(quick::add(quick::mul(a.x, b.x), quick::mul(a.y, b.y)), quick::mul(a.z, b.z));
}
Span square_of(const Vector& v) {
    return quick::add(quick::add(quick::sqr(v.x), quick::sqr(v.y)), quick::sqr(v.z));
}

// g, and its derivative.
class Foot {
  public:
    Foot(std::span<const double> numbers, const Vector& v) {
        using namespace curve_arc;
        const Vector k1 = vector_at(numbers, at_k1), k2 = vector_at(numbers, at_k2),
                     k3 = vector_at(numbers, at_k3);
        const auto number = [&](std::size_t k) {
            return about(numbers[at_g + k], numbers[at_lost_square]);
        };
        const auto minus = [](const Span& x) { return Span(-x.hi, -x.lo); };
        a_ = {inner(v, k1),
              quick::sub(quick::scale(2, inner(v, k2)), number(0)),
              quick::sub(quick::scale(3, inner(v, k3)), number(1)),
              minus(number(2)),
              minus(number(3)),
              minus(number(4))};
    }
    [[nodiscard]] Span at(const Span& x) const {
        Span sum = a_[5];
        for (std::size_t k = 5; k-- > 0;) sum = quick::add(a_[k], quick::mul(x, sum));
        return sum;
    }
    [[nodiscard]] Span slope(const Span& x) const {
        Span sum = quick::scale(5, a_[5]);
        for (std::size_t k = 5; k-- > 1;) {
            sum = quick::add(quick::scale(static_cast<double>(k), a_[k]), quick::mul(x, sum));
        }
        return sum;
    }
    // The zero of g between a and b, where it falls, or the end where it would be; to nearest. Newton's
    // steps, or halves where these lead out of what is left.
    [[nodiscard]] double zero(double a, double b) const {
        std::array<double, 6> c{};
        for (std::size_t k = 0; k < 6; ++k) c[k] = midpoint(a_[k]);
        const auto value = [&](double x) {
            double g = c[5];
            for (std::size_t k = 5; k-- > 0;) g = c[k] + x * g;
            return g;
        };
        if (value(a) <= 0) return a;
        if (value(b) >= 0) return b;
        double x = 0.5 * (a + b);
        constexpr int most_steps = 60;
        for (int step = 0; step < most_steps; ++step) {
            const double g = value(x);
            if (g == 0) return x;
            double slope = 5 * c[5];
            for (std::size_t k = 5; k-- > 1;) slope = static_cast<double>(k) * c[k] + x * slope;
            (g > 0 ? a : b) = x;
            const double newton = x - g / slope;
            const double next = newton > a && newton < b ? newton : 0.5 * (a + b);
            if (std::abs(next - x) <= 0x1p-52) return next;
            x = next;
        }
        return x;
    }

    // From x by Newton's steps as far as they go down, or to an end.
    [[nodiscard]] double refined(double x) const {
        std::array<double, 6> c{};
        for (std::size_t k = 0; k < 6; ++k) c[k] = midpoint(a_[k]);
        constexpr int most_steps = 12;
        for (int step = 0; step < most_steps; ++step) {
            double g = c[5], slope = 5 * c[5];
            for (std::size_t k = 5; k-- > 0;) g = c[k] + x * g;
            for (std::size_t k = 5; k-- > 1;) slope = static_cast<double>(k) * c[k] + x * slope;
            const double next = slope < 0 ? std::clamp(x - g / slope, -1.0, 1.0)
                                : g > 0   ? 1.0
                                          : -1.0;
            if (std::abs(next - x) <= 0x1p-52) return next;
            x = next;
        }
        return x;
    }
    // -h, h(y) = (g(y) - g(x)) / (y - x), at the least for y from -1 to 1: in Bernstein's form.
    [[nodiscard]] double least_fall(double x) const {
        std::array<Span, 5> h;
        h[4] = a_[5];
        for (std::size_t k = 4; k-- > 0;) {
            h[k] = quick::add(a_[k + 1], quick::mul(Span(x), h[k + 1]));
        }
        const auto magnitude = [](const Span& s) {
            return std::max(std::abs(s.lo), std::abs(s.hi));
        };
        const Span even = quick::add(h[0], quick::add(h[2], h[4]));
        const double odd = magnitude(quick::add(h[1], h[3])),
                     half_odd = 0.5 * magnitude(quick::sub(h[1], h[3]));
        const Span middle = quick::add(
            quick::sub(h[0], quick::mul(Span(1.0 / 3 - 0x1p-54, 1.0 / 3 + 0x1p-54), h[2])), h[4]);
        return -std::max(
            {add_up(even.hi, odd), add_up(quick::sub(h[0], h[4]).hi, half_odd), middle.hi});
    }

  private:
    std::array<Span, 6> a_;
};

struct Cubic {
    Vec3dd k0, k1, k2, k3;
};

// The same over x = middle + half y, y from -1 to 1.
Cubic part_of(const Cubic& c, double middle, double half) {
    const DoubleDouble m = middle, h = half, h2 = h * h;
    const auto scaled = [](const DoubleDouble& s, const Vec3dd& v) { return s * v; };
    const Vec3dd first = c.k1 + scaled(m, scaled(2, c.k2) + scaled(DoubleDouble(3) * m, c.k3));
    return {c.k0 + scaled(m, c.k1 + scaled(m, c.k2 + scaled(m, c.k3))), scaled(h, first),
            scaled(h2, c.k2 + scaled(DoubleDouble(3) * m, c.k3)), scaled(h2 * h, c.k3)};
}

double norm(const Vec3dd& v) { return length(v).rounded(); }
double product(const Vec3dd& a, const Vec3dd& b) { return dot(a, b).rounded(); }

constexpr double more = 1 + 0x1p-40, less = 1 - 0x1p-40;

// What an arc's numbers say of its shape.
struct ArcShape {
    double slowest, fastest, turn, speeding, third, radius;

    explicit ArcShape(const Cubic& c) {
        const double k1 = norm(c.k1), k2 = norm(c.k2), k3 = norm(c.k3);
        const double bend = 2 * k2 + 3 * k3;  // of c'
        slowest = std::max((k1 - bend) * less, 0.0);
        fastest = (k1 + bend) * more;
        turn = (2 * k2 + 6 * k3) * more;
        third = 6 * k3 * more;
        // c'.c'' = 2 k1.k2 + (4 k2.k2 + 6 k1.k3) x + 18 k2.k3 x^2 + 18 k3.k3 x^3
        speeding = (std::abs(2 * product(c.k1, c.k2)) +
                    std::abs(4 * product(c.k2, c.k2) + 6 * product(c.k1, c.k3)) + 18 * k2 * k3 +
                    18 * k3 * k3) *
                   more;
        radius = (k1 + k2 + k3) * more;
    }
    [[nodiscard]] bool is_short(const Cubic& c) const {
        const double k1 = norm(c.k1);
        return fastest - k1 <= curve_arc::greatest_turn * k1 &&
               3 * speeding <= curve_arc::greatest_speeding * slowest * slowest;
    }
};

std::vector<double> numbers_of(const Cubic& c, const ArcShape& shape, int exponent) {
    using namespace curve_arc;
    std::vector<double> numbers;
    numbers.reserve(most_numbers);
    const auto length = [&](double x) { numbers.push_back(std::ldexp(x, exponent)); };
    const auto square = [&](double x) { numbers.push_back(std::ldexp(x, 2 * exponent)); };
    const auto vector = [&](const Vec3dd& v) {
        for (std::size_t axis = 0; axis < 3; ++axis) length(v[axis].rounded());
    };
    for (const Vec3dd* const k : {&c.k0, &c.k1, &c.k2, &c.k3}) vector(*k);
    square(product(c.k1, c.k1));
    square(3 * product(c.k1, c.k2));
    square((DoubleDouble(2) * dot(c.k2, c.k2) + DoubleDouble(4) * dot(c.k1, c.k3)).rounded());
    square(5 * product(c.k2, c.k3));
    square(3 * product(c.k3, c.k3));
    vector(c.k2 - c.k1 - c.k3);
    vector(c.k1 + c.k2 + c.k3);
    // What counts as 0: there an arc is taken for a point.
    length(shape.slowest);
    length(shape.fastest);
    length(shape.turn);
    square(shape.speeding);
    length(shape.third);
    length(shape.radius);
    // No coefficient is larger than some dozen sizes, near 1.
    length(0x1p-90);
    square(0x1p-86);
    numbers.push_back(0);
    return numbers;
}

}  // namespace

Vec3<Span> curve_arc::away_at(std::span<const double> numbers, const Vector& v, const Span& x) {
    Vector away;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        Span sum = length_at(numbers, at_k3 + axis);
        sum = quick::add(length_at(numbers, at_k2 + axis), quick::mul(x, sum));
        sum = quick::add(length_at(numbers, at_k1 + axis), quick::mul(x, sum));
        away[axis] = quick::sub(v[axis], quick::mul(x, sum));
    }
    return away;
}

// The lanes' form is ArcPiece in curve_foot.inl.
void curve_arc::numbers_of_piece(std::span<const double> numbers, double middle, double half,
                                 std::span<double, most_numbers> piece) {
    const auto vector = [&](std::size_t k) {
        return Vec3d{numbers[k], numbers[k + 1], numbers[k + 2]};
    };
    const auto put = [&](std::size_t k, const Vec3d& v) {
        for (std::size_t axis = 0; axis < 3; ++axis) piece[k + axis] = v[axis];
    };
    const auto norm = [](const Vec3d& v) { return std::sqrt(dot(v, v)); };
    const double m = middle, h = half;
    const Vec3d c0 = vector(at_k0), c1 = vector(at_k1), c2 = vector(at_k2), c3 = vector(at_k3);
    const Vec3d k1 = h * (c1 + m * (2.0 * c2 + (3 * m) * c3)), k2 = (h * h) * (c2 + (3 * m) * c3),
                k3 = (h * h * h) * c3;
    put(at_k0, c0 + m * (c1 + m * (c2 + m * c3)));
    put(at_k1, k1);
    put(at_k2, k2);
    put(at_k3, k3);
    piece[at_g] = dot(k1, k1);
    piece[at_g + 1] = 3 * dot(k1, k2);
    piece[at_g + 2] = 2 * dot(k2, k2) + 4 * dot(k1, k3);
    piece[at_g + 3] = 5 * dot(k2, k3);
    piece[at_g + 4] = 3 * dot(k3, k3);
    put(at_begin, k2 - k1 - k3);
    put(at_end, k1 + k2 + k3);
    const double n1 = norm(k1), n2 = norm(k2), n3 = norm(k3), bend = 2 * n2 + 3 * n3,
                 whole_fastest = h * numbers[at_fastest], whole_turn = h * h * numbers[at_turn];
    const double lost = 0x1p-46 * (whole_fastest + whole_turn);
    piece[at_slowest] =
        numbers[at_slowest] > 0 ? std::max(h * numbers[at_slowest], n1 - bend - lost) * less : 0;
    piece[at_fastest] = std::min(whole_fastest, n1 + bend + lost) * more;
    piece[at_turn] = std::min(whole_turn, 2 * n2 + 6 * n3 + lost) * more;
    piece[at_speeding] =
        std::min(h * h * h * numbers[at_speeding], std::abs(2 * dot(k1, k2)) +
                                                       std::abs(4 * dot(k2, k2) + 6 * dot(k1, k3)) +
                                                       18 * n3 * (n2 + n3) + lost * whole_fastest) *
        more;
    piece[at_third] = h * h * h * numbers[at_third] * more;
    piece[at_radius] = (n1 + n2 + n3 + lost) * more;
    piece[at_lost] = numbers[at_lost];
    piece[at_lost_square] = numbers[at_lost_square];
    const double own = numbers[at_own_end];
    const bool begins = (own == -1 || own == 2) && m - h == -1,
               ends = (own == 1 || own == 2) && m + h == 1;
    piece[at_own_end] = begins && ends ? 2 : begins ? -1 : ends ? 1 : 0;
}

// Between two x D has one least place where g falls all along, and it is at an end where g rises or keeps
// its sign; what is none of these is cut in two, and what cannot be the nearest falls away.
curve_arc::Feet curve_arc::feet(std::span<const double> numbers, const Vector& v) {
    const Foot foot(numbers, v);
    const auto square_at = [&](const Span& x) { return square_of(away_at(numbers, v, x)); };
    struct Leaf {
        Span x;
        double least;
    };
    constexpr std::size_t most_leaves = 32, most_halvings = 512, most_open = 56;
    std::array<Leaf, most_leaves> leaves;
    std::size_t leaf_count = 0;
    double best = infinity<double>;
    const auto leave = [&](const Span& x, double least) {
        if (least > best) return;
        if (leaf_count == most_leaves) {  // some that have been overtaken, or neighbours
            std::size_t kept = 0;
            for (std::size_t k = 0; k < leaf_count; ++k) {
                if (leaves[k].least <= best) leaves[kept++] = leaves[k];
            }
            if (kept == leaf_count) {
                const Leaf &last = leaves[kept - 1], &before = leaves[kept - 2];
                leaves[kept - 2] = {hull(last.x, before.x), std::min(last.least, before.least)};
                --kept;
            }
            leaf_count = kept;
        }
        leaves[leaf_count++] = {x, least};
    };
    const auto leave_at = [&](double x) {
        const Span square = square_at(Span(x));
        best = std::min(best, square.hi);
        leave(Span(x), square.lo);
    };

    // One foot that is lower than all other places by q |y - x|^2: as `proved_foot` in curve.h.
    const double whole_fall = -foot.slope(Span(-1.0, 1.0)).hi;  // of g, at the least
    if (!(whole_fall > 0)) {
        const Vec3d middle{midpoint(v.x), midpoint(v.y), midpoint(v.z)};
        const auto vector = [&](std::size_t k) {
            return Vec3d{numbers[k], numbers[k + 1], numbers[k + 2]};
        };
        const Vec3d k1 = vector(at_k1), k2 = vector(at_k2), k3 = vector(at_k3);
        double x = -1, nearest = infinity<double>;
        for (const double place : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
            const Vec3d away = middle - place * (k1 + place * (k2 + place * k3));
            if (dot(away, away) < nearest) x = place;
            nearest = std::min(nearest, dot(away, away));
        }
        x = foot.refined(x);
        const Span g = foot.at(Span(x));
        const double outward = x == 1 ? g.lo : x == -1 ? -g.hi : 0;
        const double q = sub_down(std::max(outward, 0.0), -foot.least_fall(x));
        const double G = outward > 0 ? 0 : mag(g);
        if (q > 0 && G < 0x1p-20 * q) {
            const Span square = square_at(Span(x));
            const double off = 2 * G / q * (1 + 8 * unit_roundoff),
                         slack = G * G / q * (1 + 8 * unit_roundoff), fastest = numbers[at_fastest];
            Feet found;
            found.square = {std::max(sub_down(square.lo, slack), 0.0), square.hi};
            found.x[0] = {std::max(sub_down(x, off), -1.0), std::min(add_up(x, off), 1.0)};
            found.count = 1;
            found.bend = 2 * fastest * fastest / q * (1 + 16 * unit_roundoff);
            return found;
        }
    }

    struct Part {
        double a, b;
    };
    std::array<Part, most_open + 2> open;
    std::size_t open_count = 0, halvings = 0;
    open[open_count++] = {-1, 1};
    while (open_count > 0) {
        const auto [a, b] = open[--open_count];
        const Span x(a, b), slope = foot.slope(x);
        if (slope.hi < 0) {
            const double at = foot.zero(a, b);
            const Span g = foot.at(Span(at)), square = square_at(Span(at));
            best = std::min(best, square.hi);
            if ((at == b && g.lo >= 0) || (at == a && g.hi <= 0)) {
                leave(Span(at), square.lo);
                continue;
            }
            // D >= D(at) - 2 g (x - at) - slope.hi (x - at)^2
            const Span off = quick::div(Span(mag(g)), Span(-slope.hi));
            leave({std::max(a, sub_down(at, off.hi)), std::min(b, add_up(at, off.hi))},
                  quick::sub(Span(square.lo), quick::mul(Span(mag(g)), off)).lo);
            continue;
        }
        const Span g = foot.at(x);
        if (g.lo > 0) {
            leave_at(b);
        } else if (g.hi < 0) {
            leave_at(a);
        } else if (slope.lo > 0) {
            leave_at(a);
            leave_at(b);
        } else {
            const double middle = 0.5 * (a + b);
            const Span square = square_at(Span(middle));
            best = std::min(best, square.hi);
            // D' = -2 g
            const Span gain = quick::mul(Span(mag(g)), Span(b - a));
            const double least = quick::sub(square, gain).lo;
            if (least > best) continue;
            // Where D is flat, about a centre of curvature or for an arc that is small beside |v|, halves
            // soon say no more than rounding has left.
            if (gain.hi <= 2 * (square.hi - square.lo) || open_count >= most_open ||
                ++halvings > most_halvings) {
                leave(x, least);
                continue;
            }
            open[open_count++] = {middle, b};
            open[open_count++] = {a, middle};
        }
    }
    Feet found;
    double least = infinity<double>;
    for (std::size_t k = 0; k < leaf_count; ++k) {
        if (leaves[k].least > best) continue;
        least = std::min(least, leaves[k].least);
        if (found.count == found.x.size()) {
            found.x.back() = hull(found.x.back(), leaves[k].x);
        } else {
            found.x[found.count++] = leaves[k].x;
        }
    }
    found.square = {std::max(least, 0.0), best};
    if (whole_fall > 0) {
        found.bend =
            2 * numbers[at_fastest] * numbers[at_fastest] / whole_fall * (1 + 16 * unit_roundoff);
    }
    return found;
}

// The cases are those of the lanes' `turning` in curve.h.
curve_arc::OffArc curve_arc::off_arc(std::span<const double> numbers, const Vec3d& v) {
    const auto vector = [&](std::size_t k) {
        return Vec3d{numbers[k], numbers[k + 1], numbers[k + 2]};
    };
    const double slowest = numbers[at_slowest], fastest = numbers[at_fastest],
                 turn = numbers[at_turn], size = numbers[at_radius];
    if (!(slowest > 0)) return {v};
    const Vec3d k1 = vector(at_k1), k2 = vector(at_k2), k3 = vector(at_k3);
    const double reach = std::sqrt(dot(v, v)), g0 = dot(v, k1);
    const double own = (fastest + size) * (fastest + size);
    if (std::abs(g0) > 1.01 * ((2 * reach + 2 * size) * turn + 2 * own)) {
        return {v - vector(g0 > 0 ? at_end : at_begin)};
    }
    const Foot foot(numbers, {Span(v.x), Span(v.y), Span(v.z)});
    const double x = foot.zero(-1, 1);
    const Vec3d away = v - x * (k1 + x * (k2 + x * k3));
    const double inward = 2 * dot(v, k2) + (reach + fastest) * numbers[at_third] +
                          numbers[at_speeding] + 0.5 * turn * turn;
    const double bent = std::min(std::sqrt(dot(away, away)) * turn, inward);
    if (bent < 0.9 * slowest * slowest) return {away};

    const Feet found = feet(numbers, {Span(v.x), Span(v.y), Span(v.z)});
    constexpr double apart = 1e-3;
    OffArc best;
    double least = infinity<double>;
    Span where = found.x[0];
    for (std::size_t k = 0; k < found.count; ++k) {
        const double at = midpoint(found.x[k]);
        const Vec3d from = v - at * (k1 + at * (k2 + at * k3));
        where = hull(where, found.x[k]);
        if (dot(from, from) < least) best.away = from;
        least = std::min(least, dot(from, from));
    }
    best.one_place = where.hi - where.lo < apart;
    return best;
}

std::vector<SkeletonPart> curve_arcs(std::span<const Vec3d> control_points) {
    constexpr double no_size = 0x1p-46;
    constexpr double shortest = 0x1p-30;  // in the curve's parameter
    std::vector<Vec3dd> p;
    double largest = 0;
    for (const Vec3d& point : control_points) {
        p.push_back(difference(point, control_points[0]));
        const Vec3d v = rounded(p.back());
        largest = std::max({largest, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    }
    int exponent = 0;
    std::frexp(largest, &exponent);
    double size = 0;
    for (Vec3dd& v : p) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            v[axis] = {std::ldexp(v[axis].hi, -exponent), std::ldexp(v[axis].lo, -exponent)};
        }
        size = std::max(size, norm(v));
    }
    const auto times = [](double s, const Vec3dd& v) { return DoubleDouble(s) * v; };
    Cubic curve;  // in the parameter from 0 to 1
    if (p.size() == 3) {
        curve.k1 = times(2, p[1]);
        curve.k2 = p[2] - times(2, p[1]);
    } else {
        curve.k1 = times(3, p[1]);
        curve.k2 = times(3, p[2] - times(2, p[1]));
        curve.k3 = p[3] - times(3, p[2] - p[1]);
    }
    SkeletonColumns columns;
    columns.a = columns.b = control_points[0];
    columns.m = {0, 1, 0};  // the middle and the half of its piece: all of it
    columns.parameter = columns.radius = std::ldexp(size * more, exponent);
    std::vector<SkeletonPart> arcs;
    std::vector<std::pair<double, double>> open{{0.5, 0.5}};
    while (!open.empty()) {
        const auto [middle, half] = open.back();
        open.pop_back();
        const Cubic arc = part_of(curve, middle, half);
        ArcShape shape(arc);
        const bool is_point = shape.radius <= no_size * size || half <= shortest;
        if (!is_point && !shape.is_short(arc)) {
            open.emplace_back(middle + half / 2, half / 2);
            open.emplace_back(middle - half / 2, half / 2);
            continue;
        }
        if (is_point) shape.slowest = 0;
        arcs.push_back({columns, numbers_of(arc, shape, exponent)});
    }
    arcs.front().numbers[curve_arc::at_own_end] = arcs.size() == 1 ? 2 : -1;
    if (arcs.size() > 1) arcs.back().numbers[curve_arc::at_own_end] = 1;
    return arcs;
}

}  // namespace ivory
