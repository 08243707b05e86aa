// The nearest points of polygons, curves, chains and tapers: all that can be, proved, for both kinds
// of interval. A skeleton is a set of pairs of a place c(u) and a width w(u), and
//
//     s(x) = min over u of |x - c(u)|^2 / w(u)^2
//
// Lengths are in units of the element's (least) width, places are relative to the skeleton's first
// one. Here x is one point; what becomes of s along a ray between two points is in along_ray.h.
//
// A foot is a u at which the minimum may be. In space grad s = 2 (x - c) / w^2 of the one foot
// where there is just one (envelope theorem), and the one-sided slopes at a kink are among those of
// the several feet there.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "tests/reference/outward_double.h"
#include "tests/reference/scene.h"
#include "tests/reference/triple.h"

namespace ivory::reference {

// Some point of an interval, not an end of a proper one.
inline OutwardDouble middle_of(const OutwardDouble& x) {
    const double m = x.lo + 0.5 * (x.hi - x.lo);
    return OutwardDouble(m >= x.lo && m <= x.hi ? m : x.lo);
}
inline RealInterval middle_of(const RealInterval& x) {
    const Real m = scaled(rounded(mpfr_add, MPFR_RNDN, x.lo, x.hi), -1);
    return RealInterval(m >= x.lo && m <= x.hi ? m : x.lo);
}
// The point of [0, 1] next to each point of x.
template <class I>
I clamped(const I& x) {
    const auto clamp = [](const auto& end) { return end > 0 ? (end < 1 ? I(end) : I(1)) : I(0); };
    return hull(clamp(x.lo), clamp(x.hi));
}
template <class I>
bool is_half_as_wide(const I& x, const I& y) {
    return x.width() <= (I(0.5) * I(y.width())).lo;
}
inline OutwardDouble rough(const OutwardDouble& x) { return x; }
inline OutwardDouble rough(const RealInterval& x) { return OutwardDouble(x); }
template <class I>
Triple<OutwardDouble> rough(const Triple<I>& v) {
    return {rough(v[0]), rough(v[1]), rough(v[2])};
}

template <class I>
struct Foot {
    I s;
    Triple<I> pull;  // (x - c) / w^2: half the gradient of s
};

// Where a foot is: on which piece, and between which parameters of a curve.
struct Place {
    std::size_t piece = 0;
    double from = 0, to = 1;
};

// Feet as they are found: those that are beaten for certain, by more than the slack, are dropped.
template <class I>
class Feet {
  public:
    explicit Feet(double slack = 0) : slack_(slack) {}

    // Some point of the skeleton has this s.
    void reached(const I& s) {
        if (!(s.hi < best_)) return;
        best_ = s.hi;
        limit_ = slack_ > 0 ? (I(best_) + I(slack_)).hi : best_;
    }
    [[nodiscard]] bool beaten(const I& s) const { return s.lo > limit_; }
    void add(Foot<I> foot, const Place& place) {
        reached(foot.s);
        if (beaten(foot.s)) return;
        feet_.push_back(std::move(foot));
        places_.push_back(place);
    }
    void drop_the_beaten() {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < feet_.size(); ++i) {
            if (beaten(feet_[i].s)) continue;
            if (kept != i) {
                feet_[kept] = std::move(feet_[i]);
                places_[kept] = places_[i];
            }
            ++kept;
        }
        feet_.resize(kept);
        places_.resize(kept);
    }
    [[nodiscard]] const std::vector<Foot<I>>& all() const { return feet_; }
    [[nodiscard]] const std::vector<Place>& places() const { return places_; }

    // The minimum: each foot stands for a point of the skeleton, or a part of it. There is one.
    [[nodiscard]] I least() const {
        if (feet_.empty()) throw std::logic_error("a skeleton without a nearest point");
        I least = feet_.front().s;
        for (const Foot<I>& foot : feet_) {
            if (foot.s.lo < least.lo) least.lo = foot.s.lo;
            if (foot.s.hi < least.hi) least.hi = foot.s.hi;
        }
        if (best_ < least.hi) least.hi = best_;
        if (least.lo < 0) least.lo = I(0).lo;
        return least;
    }

  private:
    using Number = decltype(I::lo);
    double slack_;
    Number best_{std::numeric_limits<double>::infinity()};
    Number limit_{std::numeric_limits<double>::infinity()};
    std::vector<Foot<I>> feet_;
    std::vector<Place> places_;
};

// What is known beforehand, from doubles, of the feet in more bits.
struct Cover {
    std::vector<Place> places;
    std::optional<bool> inside;  // of a polygon

    // Parts of a curve that touch become one.
    void join() {
        std::sort(places.begin(), places.end(),
                  [](const Place& a, const Place& b) { return a.from < b.from; });
        std::size_t kept = 0;
        for (std::size_t i = 1; i < places.size(); ++i) {
            if (places[i].from <= places[kept].to) {
                places[kept].to = std::max(places[kept].to, places[i].to);
            } else {
                places[++kept] = places[i];
            }
        }
        if (!places.empty()) places.resize(kept + 1);
    }
};

template <class I>
struct Ball {
    Triple<I> center;
    I radius;
};
template <class I, class Points>
Ball<I> ball_around(const Points& points, std::size_t count) {
    Ball<I> ball;
    for (std::size_t i = 0; i < count; ++i) ball.center = plus(ball.center, points[i]);
    ball.center = times(ball.center, I(1.0 / static_cast<double>(count)));
    for (std::size_t k = 0; k < 3; ++k) ball.center[k] = middle_of(ball.center[k]);
    I greatest(0);
    for (std::size_t i = 0; i < count; ++i) {
        const I square = norm2(minus(points[i], ball.center));
        if (square.hi > greatest.hi) greatest = square;
    }
    ball.radius = I(sqrt(greatest).hi);
    return ball;
}
// No point of the ball is nearer.
template <class I>
I least_square(const Ball<I>& ball, const Triple<I>& x) {
    const I off = sqrt(norm2(minus(x, ball.center))) - ball.radius;
    return off.lo > 0 ? sqr(off) : I(0);
}

// A segment from a to a + m whose width goes linearly from w to w + dw.
template <class I>
struct Piece {
    Triple<I> a, m;
    I w{1}, dw{0}, m2{0};
    bool still = false, level = true;  // exactly: a = b, dw = 0
    Ball<I> ball;
    I greatest_w{1};
};

// With y = x - a, p = y.m: phi(u) = (|y|^2 - 2 p u + |m|^2 u^2) / (w + u dw)^2 has
// phi'(u) = 2 (E u - B) / (w + u dw)^3 with E = |m|^2 w + dw p and B = p w + dw |y|^2: so the foot is
// B / E, clamped, where E > 0, and an end where E < 0.
template <class I>
void feet_on(const Piece<I>& piece, const Triple<I>& x, const Place& place, Feet<I>& feet) {
    const Triple<I> y = minus(x, piece.a);
    const I p = inner(y, piece.m);
    const auto at = [&](const I& u) {
        const I w = common(piece.w + u * piece.dw, hull(piece.w, piece.w + piece.dw));
        const Triple<I> away = minus(y, times(piece.m, u));
        const I w2 = sqr(w);
        return Foot<I>{norm2(away) / w2, divided(away, w2)};
    };
    if (piece.level) {
        const I u = piece.still ? I(0) : clamped(p / piece.m2);
        Foot<I> foot{I(0), minus(y, times(piece.m, u))};
        foot.s = norm2(foot.pull);
        if (!piece.w.is_point() || piece.w.lo != 1) {
            const I w2 = sqr(piece.w);
            foot = {foot.s / w2, divided(foot.pull, w2)};
        }
        feet.add(std::move(foot), place);
        return;
    }
    const I e = piece.m2 * piece.w + piece.dw * p, b = p * piece.w + piece.dw * norm2(y);
    const I first = -b, last = e - b;
    if (first.lo >= 0 && last.lo >= 0 && (first.lo > 0 || last.lo > 0)) {
        return feet.add(at(I(0)), place);
    }
    if (first.hi <= 0 && last.hi <= 0 && (first.hi < 0 || last.hi < 0)) {
        return feet.add(at(I(1)), place);
    }
    if (certainly_negative(e)) {
        feet.add(at(I(0)), place);
        feet.add(at(I(1)), place);
        return;
    }
    const I u = certainly_positive(e) ? clamped(b / e) : from_to(I(0), I(1));
    Foot<I> foot = at(u);
    // The mean value form, which is exact where phi is constant: at a cone's apex.
    const I m = middle_of(u), w = common(piece.w + u * piece.dw, hull(piece.w, piece.w + piece.dw));
    const I form = at(m).s + I(2) * (e * u - b) / (w * sqr(w)) * (u - m);
    foot.s = common(foot.s, form);
    // (y - u m) / W^2 = (y + m w / dw) / W^2 - (m / dw) / W, which is as exact there.
    if (!certainly_positive(e)) {
        const I width = hull(piece.w, piece.w + piece.dw), w2 = sqr(width);
        for (std::size_t k = 0; k < 3; ++k) {
            const I from_apex = y[k] + piece.m[k] * piece.w / piece.dw;
            const I other = from_apex / w2 - piece.m[k] / piece.dw / width;
            foot.pull[k] = common(foot.pull[k], other);
        }
    }
    feet.add(std::move(foot), place);
}

template <class I>
struct Chain {
    using InDoubles = Chain<OutwardDouble>;
    std::vector<Piece<I>> pieces;
};

template <class I>
void find_feet(const Chain<I>& chain, const Triple<I>& x, const Cover* cover, Feet<I>& feet) {
    if (cover != nullptr) {
        for (const Place& place : cover->places) {
            feet_on(chain.pieces[place.piece], x, place, feet);
        }
        return;
    }
    const bool many = chain.pieces.size() > 3;
    if (many) {
        for (const Piece<I>& piece : chain.pieces) {
            feet.reached(norm2(minus(x, piece.a)) / sqr(piece.w));
        }
    }
    for (std::size_t i = 0; i < chain.pieces.size(); ++i) {
        const Piece<I>& piece = chain.pieces[i];
        if (many && feet.beaten(least_square(piece.ball, x) / sqr(piece.greatest_w))) continue;
        feet_on(piece, x, Place{i}, feet);
    }
}

// In its plane: n the unit normal, the vertices projected on the plane; two of their coordinates,
// those that the plane is seen best along, say what is inside.
template <class I>
struct Filled {
    using InDoubles = Filled<OutwardDouble>;
    Triple<I> normal;
    Chain<I> edges;
    std::size_t first = 0, second = 1;
};

// Whether a point of the plane lies inside: by the winding number, along one of a few directions
// that do not pass a vertex; nothing where that is not certain, as it is on the edges.
template <class I>
std::optional<bool> is_inside(const Filled<I>& polygon, const Triple<I>& foot) {
    static constexpr std::array<std::array<double, 2>, 5> directions{
        {{0.8131, 0.5822}, {-0.3273, 0.9449}, {-0.9767, -0.2146}, {0.1039, -0.9946}, {0.5, 0.25}}};
    const auto& pieces = polygon.edges.pieces;
    const auto cross = [](const std::array<I, 2>& a, const std::array<I, 2>& b) {
        return a[0] * b[1] - a[1] * b[0];
    };
    std::vector<std::array<I, 2>> from;  // from the point to the vertices
    for (const auto& edge : pieces) {
        from.push_back({edge.a[polygon.first] - foot[polygon.first],
                        edge.a[polygon.second] - foot[polygon.second]});
    }
    for (const auto& along : directions) {
        const std::array<I, 2> direction{I(along[0]), I(along[1])};
        int winding = 0;
        bool certain = true;
        I side = cross(direction, from.back());
        std::size_t before = from.size() - 1;
        for (std::size_t i = 0; i < from.size() && certain; before = i++) {
            const I next = cross(direction, from[i]);
            const bool up = certainly_negative(side) && certainly_positive(next);
            const bool down = certainly_positive(side) && certainly_negative(next);
            certain = certainly_positive(next) || certainly_negative(next);
            if (up || down) {  // before or behind?
                const I turn = cross(from[before], from[i]);
                certain = certain && (certainly_positive(turn) || certainly_negative(turn));
                if (up && certainly_positive(turn)) ++winding;
                if (down && certainly_negative(turn)) --winding;
            }
            side = next;
        }
        if (certain) return winding != 0;
    }
    return std::nullopt;
}

template <class I>
void find_feet(const Filled<I>& polygon, const Triple<I>& x, const Cover* cover, Feet<I>& feet) {
    const I h = inner(x, polygon.normal);
    const Triple<I> up = times(polygon.normal, h);
    const std::optional<bool> inside =
        cover != nullptr && cover->inside ? cover->inside : is_inside(polygon, minus(x, up));
    if (inside == true) return feet.add({sqr(h), up}, Place{});
    // With the cover's places alone where doubles knew that the point is outside.
    const Cover* known = cover != nullptr && cover->inside == false ? cover : nullptr;
    find_feet(polygon.edges, x, known, feet);
    if (inside == false) return;
    // On an edge, within rounding: the edges are a bound from above, the plane is one from below.
    Feet<I> both;
    for (const Foot<I>& foot : feet.all()) {
        both.add({hull(sqr(h), foot.s), foot.pull}, Place{});
    }
    both.add({hull(sqr(h), feet.least()), up}, Place{});
    feet = both;
}

template <class I>
struct Bezier {
    std::array<Triple<I>, 4> points;  // degree + 1 of them
    double from = 0, to = 1;          // in the parameter of the whole
    Ball<I> ball;
};

template <class I>
struct Arc {
    using InDoubles = Arc<OutwardDouble>;
    std::size_t degree = 3;
    std::array<Triple<I>, 4> points, powers;  // c(u) = sum of powers[k] u^k
    std::vector<Bezier<I>> pieces;
};

template <class I>
I between(const I& a, const I& b, const I& t) {
    return a + t * (b - a);
}
template <class I>
Triple<I> between(const Triple<I>& a, const Triple<I>& b, const I& t) {
    return {between(a[0], b[0], t), between(a[1], b[1], t), between(a[2], b[2], t)};
}

// The polynomial with these Bernstein coefficients, `degree` + 1 of them, by de Casteljau.
template <class T, std::size_t size, class I>
T bernstein(std::array<T, size> c, std::size_t degree, const I& t) {
    for (std::size_t last = degree; last > 0; --last) {
        for (std::size_t i = 0; i < last; ++i) c[i] = between(c[i], c[i + 1], t);
    }
    return c[0];
}

// The part of a curve between two parameters: the blossom at their choices.
template <class I>
std::array<Triple<I>, 4> part_of(const std::array<Triple<I>, 4>& points, std::size_t degree,
                                 const I& from, const I& to) {
    std::array<Triple<I>, 4> result;
    for (std::size_t k = 0; k <= degree; ++k) {
        std::array<Triple<I>, 4> c = points;
        for (std::size_t step = 0; step < degree; ++step) {
            const I& t = step < degree - k ? from : to;
            for (std::size_t i = 0; i + step < degree; ++i) c[i] = between(c[i], c[i + 1], t);
        }
        result[k] = c[0];
    }
    return result;
}

inline constexpr double binomial(std::size_t n, std::size_t k) {
    double result = 1;
    for (std::size_t i = 0; i < k; ++i) {
        result = result * static_cast<double>(n - i) / static_cast<double>(i + 1);
    }
    return result;
}

// A part of the curve as seen from x: y = x - c. phi = |y|^2, psi = phi'/2 = y.y'.
template <class I>
struct Part {
    std::array<Triple<I>, 4> y;
    double from = 0, to = 1;
    int halvings = 0;
};

// C(n,i) C(m,j) / C(n+m,i+j), for n and m up to 3.
template <class I>
const I& product_weight(std::size_t n, std::size_t m, std::size_t i, std::size_t j) {
    struct Table {
        long bits = 0;
        std::array<std::array<std::array<std::array<I, 4>, 4>, 4>, 4> all;
    };
    static thread_local Table table;
    if (table.bits != working_bits) {
        auto& all = table.all;
        for (std::size_t a = 0; a < 4; ++a) {
            for (std::size_t b = 0; b < 4; ++b) {
                for (std::size_t k = 0; k <= a; ++k) {
                    for (std::size_t l = 0; l <= b; ++l) {
                        all[a][b][k][l] =
                            I(binomial(a, k) * binomial(b, l)) / I(binomial(a + b, k + l));
                    }
                }
            }
        }
        table.bits = working_bits;
    }
    return table.all[n][m][i][j];
}

// The Bernstein coefficients of a.b, of degrees n and m.
template <class I, std::size_t size>
void multiply(const std::array<Triple<I>, 4>& a, std::size_t n, const std::array<Triple<I>, 4>& b,
              std::size_t m, std::array<I, size>& c) {
    for (std::size_t k = 0; k <= n + m; ++k) c[k] = I(0);
    for (std::size_t i = 0; i <= n; ++i) {
        for (std::size_t j = 0; j <= m; ++j) {
            c[i + j] = c[i + j] + product_weight<I>(n, m, i, j) * inner(a[i], b[j]);
        }
    }
}
// Of |a|^2.
template <class I, std::size_t size>
void square(const std::array<Triple<I>, 4>& a, std::size_t n, std::array<I, size>& c) {
    for (std::size_t k = 0; k <= 2 * n; ++k) c[k] = I(0);
    for (std::size_t i = 0; i <= n; ++i) {
        c[2 * i] = c[2 * i] + product_weight<I>(n, n, i, i) * norm2(a[i]);
        for (std::size_t j = 0; j < i; ++j) {
            c[i + j] = c[i + j] + I(2) * product_weight<I>(n, n, i, j) * inner(a[i], a[j]);
        }
    }
}

// The feet on one part, by halving until a part can be left out, holds one minimum of phi because
// phi is convex there (found by interval Newton), or is as short as makes no difference to phi.
template <class I>
void feet_on(Part<I> whole, std::size_t n, std::size_t piece, Feet<I>& feet) {
    constexpr bool doubles = std::is_same_v<I, OutwardDouble>;
    const I little = I::of(1, doubles ? -44 : -share_of_bits(200));
    const int most_halvings = doubles ? 36 : static_cast<int>(share_of_bits(220));
    const std::size_t degree = 2 * n - 1;  // of psi
    std::vector<Part<I>> open;
    open.push_back(std::move(whole));
    for (int count = 0; !open.empty(); ++count) {
        const Part<I> part = std::move(open.back());
        open.pop_back();
        const auto& y = part.y;
        std::array<I, 7> phi;
        square(y, n, phi);
        I range = phi[0], least_end = phi[0], noise(phi[0].width());
        for (std::size_t k = 1; k <= 2 * n; ++k) {
            range = hull(range, phi[k]);
            if (noise.hi < phi[k].width()) noise = I(phi[k].width());
        }
        if (feet.beaten(range)) continue;
        feet.reached(phi[0]);
        feet.reached(phi[2 * n]);
        if (phi[2 * n].hi < least_end.hi) least_end = phi[2 * n];
        const auto end = [&](bool last) {
            const double u = last ? part.to : part.from;
            feet.add({phi[last ? 2 * n : 0], y[last ? n : 0]}, {piece, u, u});
        };

        std::array<Triple<I>, 4> dy;
        for (std::size_t i = 0; i < n; ++i) dy[i] = times(minus(y[i + 1], y[i]), I(double(n)));
        std::array<I, 6> psi, bend;
        multiply(y, n, dy, n - 1, psi);
        bool falls = true, rises = true, convex = true;
        for (std::size_t k = 0; k <= degree; ++k) {
            falls = falls && certainly_negative(psi[k]);
            rises = rises && certainly_positive(psi[k]);
        }
        if (falls || rises) {  // inside of the curve another part is better then
            if (falls ? part.to == 1 : part.from == 0) end(falls);
            continue;
        }
        I bends;
        for (std::size_t k = 0; k < degree; ++k) {
            bend[k] = I(double(degree)) * (psi[k + 1] - psi[k]);
            bends = k == 0 ? bend[k] : hull(bends, bend[k]);
            convex = convex && certainly_positive(bend[k]);
        }
        const double length = part.to - part.from;
        if (convex) {
            I u = from_to(I(0), I(1));
            for (int step = 0; step < 200; ++step) {
                const I m = middle_of(u);
                const I slope = common(bernstein(bend, degree - 1, u), bends);
                const I newton = m - bernstein(psi, degree, m) / slope;
                const auto clamp = [&](const auto& x) {
                    return x < u.lo ? u.lo : x > u.hi ? u.hi : x;
                };
                const I next = hull(I(clamp(newton.lo)), I(clamp(newton.hi)));
                const bool done = !is_half_as_wide(next, u);
                u = next;
                if (done) break;
            }
            Foot<I> foot{I(0), bernstein(y, n, u)};
            const I m = middle_of(u);
            foot.s = common(norm2(foot.pull),
                            norm2(bernstein(y, n, m)) + I(2) * bernstein(psi, degree, u) * (u - m));
            const OutwardDouble place = OutwardDouble(part.from) + OutwardDouble(length) * rough(u);
            feet.add(std::move(foot),
                     {piece, std::max(part.from, place.lo), std::min(part.to, place.hi)});
            continue;
        }
        const bool endless = !(range.width() < std::numeric_limits<double>::infinity());
        const bool is_noise = range.width() <= (I(8) * noise).hi;
        if (part.halvings >= most_halvings || count > 3000 || endless || is_noise ||
            range.width() <= little.lo) {
            Foot<I> foot{from_to(range, least_end), y[0]};
            for (std::size_t i = 1; i <= n; ++i) foot.pull = hull(foot.pull, y[i]);
            feet.add(std::move(foot), {piece, part.from, part.to});
            continue;
        }
        Part<I> left{y, part.from, part.from + 0.5 * length, part.halvings + 1};
        Part<I> right{y, left.to, part.to, part.halvings + 1};
        left.y[0] = y[0];
        for (std::size_t last = n; last > 0; --last) {
            for (std::size_t i = 0; i < last; ++i) {
                for (std::size_t k = 0; k < 3; ++k) {
                    right.y[i][k] = I(0.5) * (right.y[i][k] + right.y[i + 1][k]);
                }
            }
            left.y[n + 1 - last] = right.y[0];
        }
        open.push_back(std::move(right));
        open.push_back(std::move(left));
    }
}

// The foot between two parameters that lie close together, by interval Newton on
// psi = (c - x).c', psi' = |c'|^2 + (c - x).c'', in powers of u; false where phi is not convex there
// for certain.
template <class I>
bool foot_between(const Arc<I>& arc, const Triple<I>& x, const Place& place, Feet<I>& feet) {
    const auto& c = arc.powers;
    const auto towards = [&](const I& u) {
        Triple<I> sum = c[arc.degree];
        for (std::size_t k = arc.degree; k > 0; --k) sum = plus(times(sum, u), c[k - 1]);
        return minus(sum, x);
    };
    const auto first = [&](const I& u) {
        Triple<I> sum = times(c[arc.degree], I(double(arc.degree)));
        for (std::size_t k = arc.degree; k > 1; --k) {
            sum = plus(times(sum, u), times(c[k - 1], I(double(k - 1))));
        }
        return sum;
    };
    const auto second = [&](const I& u) {
        const Triple<I> twice = times(c[2], I(2));
        return arc.degree == 2 ? twice : plus(twice, times(times(c[3], I(6)), u));
    };
    I u = from_to(I(place.from), I(place.to));
    for (int step = 0; step < 100; ++step) {
        const I m = middle_of(u);
        const I slope = norm2(first(u)) + inner(towards(u), second(u));
        if (!certainly_positive(slope)) return false;
        const I newton = m - inner(towards(m), first(m)) / slope;
        const auto clamp = [&](const auto& t) { return t < u.lo ? u.lo : t > u.hi ? u.hi : t; };
        const I next = hull(I(clamp(newton.lo)), I(clamp(newton.hi)));
        const bool done = !is_half_as_wide(next, u);
        u = next;
        if (done) break;
    }
    const Triple<I> to_curve = towards(u);
    const I m = middle_of(u);
    feet.add(
        {common(norm2(to_curve), norm2(towards(m)) + I(2) * inner(to_curve, first(u)) * (u - m)),
         times(to_curve, I(-1))},
        place);
    return true;
}

template <class I>
void find_feet(const Arc<I>& arc, const Triple<I>& x, const Cover* cover, Feet<I>& feet) {
    const auto seen = [&](const std::array<Triple<I>, 4>& points, double from, double to) {
        Part<I> part{{}, from, to, 0};
        for (std::size_t i = 0; i <= arc.degree; ++i) part.y[i] = minus(x, points[i]);
        return part;
    };
    if (cover != nullptr) {
        for (const Place& place : cover->places) {
            if (place.from == place.to) {
                const Triple<I> y = minus(x, bernstein(arc.points, arc.degree, I(place.from)));
                feet.add({norm2(y), y}, place);
            } else if (!foot_between(arc, x, place, feet)) {
                const auto points = part_of(arc.points, arc.degree, I(place.from), I(place.to));
                feet_on(seen(points, place.from, place.to), arc.degree, place.piece, feet);
            }
        }
        return;
    }
    for (const Bezier<I>& piece : arc.pieces) feet.reached(norm2(minus(x, piece.points[0])));
    for (std::size_t i = 0; i < arc.pieces.size(); ++i) {
        const Bezier<I>& piece = arc.pieces[i];
        if (feet.beaten(least_square(piece.ball, x))) continue;
        feet_on(seen(piece.points, piece.from, piece.to), arc.degree, i, feet);
    }
}

// A skeleton made ready, with the bits at work then and in doubles. Immutable.
template <class I>
using Body = std::variant<Chain<I>, Filled<I>, Arc<I>>;
struct Bodies {
    Body<RealInterval> exact;
    Body<OutwardDouble> rough;
};

// Nothing for the shapes that along_ray.h has formulas for: point, segment of one width, circle, disc.
[[nodiscard]] std::shared_ptr<const Bodies> bodies_of(const Element& element);

// The feet of x, an x as wide as rounding at most. With slack also those that are greater by less.
inline Feet<OutwardDouble> feet_of(const Bodies& bodies, const Triple<OutwardDouble>& x,
                                   double slack = 0) {
    Feet<OutwardDouble> feet(slack);
    std::visit([&](const auto& body) { find_feet(body, x, nullptr, feet); }, bodies.rough);
    feet.drop_the_beaten();
    return feet;
}
// In more bits only where doubles leave it open.
inline Feet<RealInterval> feet_of(const Bodies& bodies, const Triple<RealInterval>& x) {
    const Triple<OutwardDouble> near = rough(x);
    Cover cover;
    if (const auto* polygon = std::get_if<Filled<OutwardDouble>>(&bodies.rough)) {
        const OutwardDouble h = inner(near, polygon->normal);
        cover.inside = is_inside(*polygon, minus(near, times(polygon->normal, h)));
    }
    if (cover.inside != true) cover.places = feet_of(bodies, near).places();
    if (std::holds_alternative<Arc<OutwardDouble>>(bodies.rough)) cover.join();
    Feet<RealInterval> feet;
    std::visit([&](const auto& body) { find_feet(body, x, &cover, feet); }, bodies.exact);
    feet.drop_the_beaten();
    return feet;
}

}  // namespace ivory::reference
