// The field of one element along a ray, straight from the formulas of the scene format, for any
// type of interval: RealInterval (256 bits or more) and OutwardDouble. With q = distance / width, s = q^2:
// F = b k(s), dF/dt = b k'(s) ds/dt.
//
// Every k falls with s and every k' rises with s (that is, k is convex) on s >= 0:
//   blinn      k = exp(-s)                        k' = -exp(-s)
//   nishimura  k = 1 - 3 s            s <= 1/9    k' = -3
//                = 3/2 (1 - q)^2      s <= 1      k' = 3/2 - 3/2 / q
//   wyvill     k = (1 - s)^2 (1 - 4/9 s)  s <= 1  k' = -2/9 (1 - s) (11 - 6 s)
//   murakami   k = (1 - s)^2          s <= 1      k' = -2 (1 - s)
//   blobtree   k = (1 - s)^3          s <= 1      k' = -3 (1 - s)^2
// and each is written with factors that are monotone the same way, so that interval evaluation
// gives the exact ranges but for rounding. (The wyvill polynomial of the format, factored.)
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "tests/reference/from_core.h"
#include "tests/reference/nearest.h"
#include "tests/reference/ray.h"
#include "tests/reference/scene.h"
#include "tests/reference/triple.h"

namespace ivory::reference {

// k and k' for s in the given interval; s < 0 stands for rounding below 0.
template <class I>
Germ<I> kernel_germ(Kernel kind, const I& s) {
    const I one(1);
    if (kind == Kernel::blinn) {
        const I e = exp(-s);
        return {e, -e};
    }
    const bool reaches_beyond = !(s.hi < one.lo);
    const Germ<I> beyond{I(0), I(0)};
    if (s.lo >= one.hi) return beyond;
    const I inside = common(s, from_to(I(-1), one));
    if (kind == Kernel::wyvill) {
        const I rest = one - inside;
        const Germ<I> germ{sqr(rest) * (one - I(4) / I(9) * inside),
                           -(I(2) / I(9) * rest) * (I(11) - I(6) * inside)};
        return reaches_beyond ? either(germ, beyond) : germ;
    }
    if (kind == Kernel::murakami || kind == Kernel::blobtree) {
        const I rest = one - inside;
        const Germ<I> germ = kind == Kernel::murakami
                                 ? Germ<I>{sqr(rest), I(-2) * rest}
                                 : Germ<I>{rest * sqr(rest), I(-3) * sqr(rest)};
        return reaches_beyond ? either(germ, beyond) : germ;
    }
    const I ninth = one / I(9);
    const bool reaches_core = !(inside.lo > ninth.hi), reaches_rim = !(inside.hi < ninth.lo);
    Germ<I> germ;
    if (reaches_rim) {
        const I q = sqrt(common(inside, from_to(ninth, one)));
        germ = {I(1.5) * sqr(one - q), I(1.5) - I(1.5) / q};
    }
    if (reaches_core) {
        const Germ<I> core{one - I(3) * common(inside, from_to(I(-1), ninth)), I(-3)};
        germ = reaches_rim ? either(germ, core) : core;
    }
    return reaches_beyond ? either(germ, beyond) : germ;
}

template <class I>
Germ<I> kernel_germ(KernelKind kind, const I& s) {
    return kernel_germ(from_core(kind), s);
}

// |a + t b|^2
template <class I>
struct Quadratic {
    Triple<I> a, b;
    I least{0};  // its lower end bounds the function from below for every t

    Quadratic() = default;
    // |a x b|^2 / |b|^2 is the minimum over the whole line.
    Quadratic(Triple<I> start, Triple<I> direction) : a(start), b(direction) {
        const I b2 = norm2(b);
        if (certainly_positive(b2)) least = norm2(outer(a, b)) / b2;
    }
    Germ<I> at(const I& t) const {  // t a point
        const Triple<I> v{a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]};
        return {norm2(v), I(2) * inner(v, b)};
    }
};

// s is a convex function of t with the given germs at the ends of an interval, and not less than
// the lower end of `least`: so it is greatest at an end, and ds/dt rises.
template <class I>
Germ<I> convex_range(const Germ<I>& first, const Germ<I>& last, const I& least) {
    const I ends = hull(first.value, last.value);
    const I slope = from_to(first.slope, last.slope);
    if (first.slope.lo >= 0) return {from_to(first.value, last.value), slope};
    if (last.slope.hi <= 0) return {from_to(last.value, first.value), slope};
    return {from_to(least.lo < ends.lo ? least : ends, ends), slope};
}

// The same without a bound: where it first falls and then rises, a convex function lies above its
// tangents at both ends, and so above where they meet.
template <class I>
Germ<I> convex_range_above_tangents(const Germ<I>& first, const Germ<I>& last, const I& length) {
    if (!(first.slope.lo < 0 && last.slope.hi > 0)) return convex_range(first, last, I(0));
    const I fall(first.slope.lo), rise(last.slope.hi);
    const I least = (rise * first.value - fall * last.value + fall * rise * length) / (rise - fall);
    return convex_range(first, last, least.lo > 0 ? least : I(0));
}

// s along the ray o + t d; all lengths are divided by the width.
template <class I>
class PointAlongRay {
  public:
    PointAlongRay(const Triple<I>& from_point, const Triple<I>& d) : square_(from_point, d) {}
    Germ<I> at(const I& t) const { return square_.at(t); }
    Germ<I> over(const I& t) const { return convex_range(at(I(t.lo)), at(I(t.hi)), square_.least); }

  private:
    Quadratic<I> square_;
};

// With u = ((p - a).m) / |m|^2, m = b - a: the distance to a for u <= 0, to b for u >= 1, to the
// line in between; u is affine in t. The distance to a convex set is convex along the ray, and
// where u leaves [0, 1] value and slope pass continuously from one formula to the next.
template <class I>
class SegmentAlongRay {
  public:
    SegmentAlongRay(const Triple<I>& from_a, const Triple<I>& from_b, const Triple<I>& m,
                    const Triple<I>& d)
        : ends_{Quadratic<I>(from_a, d), Quadratic<I>(from_b, d)} {
        const I m2 = norm2(m), inverse = I(1) / sqrt(m2);
        middle_ = Quadratic<I>(times(outer(from_a, m), inverse), times(outer(d, m), inverse));
        u0_ = inner(from_a, m) / m2;
        u1_ = inner(d, m) / m2;
    }
    Germ<I> at(const I& t) const {
        const I u = u0_ + t * u1_;
        Germ<I> germ;
        bool any = false;
        const auto join = [&](const Quadratic<I>& piece) {
            germ = any ? either(germ, piece.at(t)) : piece.at(t);
            any = true;
        };
        if (u.lo <= 0) join(ends_[0]);
        if (u.hi >= 0 && u.lo <= 1) join(middle_);
        if (u.hi >= 1) join(ends_[1]);
        return germ;
    }
    Germ<I> over(const I& t) const {
        const I first(t.lo), last(t.hi);
        const I u = hull(u0_ + first * u1_, u0_ + last * u1_);
        // Each value of s is one of a piece that is in force somewhere on t.
        I least(0);
        bool any = false;
        const auto join = [&](const Quadratic<I>& piece) {
            const I own = convex_range(piece.at(first), piece.at(last), piece.least).value;
            least = any ? hull(least, own) : own;
            any = true;
        };
        if (u.lo <= 0) join(ends_[0]);
        if (u.hi >= 0 && u.lo <= 1) join(middle_);
        if (u.hi >= 1) join(ends_[1]);
        return convex_range(at(first), at(last), least);
    }

  private:
    std::array<Quadratic<I>, 2> ends_;
    Quadratic<I> middle_;
    I u0_, u1_;
};

// s = (rho - r)^2 + h^2 with h = n.(p - c), affine, and rho = |n x (p - c)|, convex; rho has a kink
// where the ray crosses the axis, and there its slope is the hull of the one-sided ones. In general
// d rho/dt rises, and it is never beyond +-|n x d|.
template <class I>
class CircleAlongRay {
  public:
    CircleAlongRay(const Triple<I>& from_center, const Triple<I>& unit_normal, const I& radius,
                   const Triple<I>& d)
        : rho2_(outer(unit_normal, from_center), outer(unit_normal, d)),
          h0_(inner(unit_normal, from_center)),
          h1_(inner(unit_normal, d)),
          r_(radius) {
        const I steepest = sqrt(norm2(rho2_.b));
        slopes_ = from_to(-steepest, steepest);
    }
    Germ<I> at(const I& t) const { return square(rho(t), h0_ + t * h1_); }
    Germ<I> over(const I& t) const {
        const I first(t.lo), last(t.hi);
        const I least = sqrt(rho2_.least);
        return square(convex_range(rho(first), rho(last), least),
                      hull(h0_ + first * h1_, h0_ + last * h1_));
    }

  private:
    Germ<I> rho(const I& t) const {
        const Germ<I> square = rho2_.at(t);
        const I value = sqrt(square.value);
        if (!certainly_positive(value)) return {value, slopes_};
        return {value, common(square.slope / (I(2) * value), slopes_)};
    }
    Germ<I> square(const Germ<I>& rho, const I& h) const {
        const I off = rho.value - r_;
        return {sqr(off) + sqr(h), I(2) * (off * rho.slope + h * h1_)};
    }

    Quadratic<I> rho2_;
    I h0_, h1_, r_, slopes_;
};

// s = max(0, rho - r)^2 + h^2, r > 0, h and rho as for the circle. A disc is convex, and so is s.
template <class I>
class DiscAlongRay {
  public:
    DiscAlongRay(const Triple<I>& from_center, const Triple<I>& unit_normal, const I& radius,
                 const Triple<I>& d)
        : rho2_(outer(unit_normal, from_center), outer(unit_normal, d)),
          h0_(inner(unit_normal, from_center)),
          h1_(inner(unit_normal, d)),
          r_(radius) {}
    // Off the axis where it matters: rho' = (rho^2)' / (2 rho) with rho >= r.
    Germ<I> at(const I& t) const {
        const I h = h0_ + t * h1_;
        Germ<I> germ{sqr(h), I(2) * h * h1_};
        const Germ<I> square = rho2_.at(t);
        const I rho = sqrt(square.value), off = rho - r_;
        if (!(off.hi > 0)) return germ;
        const I beyond = off.lo > 0 ? off : from_to(I(0), off);
        const I outside = rho.lo < r_.lo ? from_to(r_, rho) : rho;
        germ.value = germ.value + sqr(beyond);
        germ.slope = germ.slope + beyond * square.slope / outside;
        return germ;
    }
    Germ<I> over(const I& t) const {
        const Germ<I> first = at(I(t.lo)), last = at(I(t.hi));
        return convex_range_above_tangents(first, last, I(t.hi) - I(t.lo));
    }

  private:
    Quadratic<I> rho2_;
    I h0_, h1_, r_;
};

// s of any skeleton over an interval, from its feet at the ends alone. Each |x - c|^2 / w(c)^2 is a
// parabola in t with no more than K = |d|^2 / w_least^2 of t^2, so that s - K t^2, a minimum of
// functions that are concave, is concave. Hence, with L = t1 - t0:
//   s >= the chord of s0 and s1 less K (t - t0) (t1 - t), whose minimum over all t is
//        s0 - K (L/2 - (s1 - s0) / (2 K L))^2, and not less than min(s0, s1) - K L^2 / 4;
//   s <= s0 + s0' (t - t0) + K (t - t0)^2, which is convex, for every s0' that a foot has, and
//        likewise from t1;
//   s' - 2 K t falls.
template <class I>
Germ<I> bowed_range(const Germ<I>& first, const Germ<I>& last, const I& length, const I& k) {
    const I half = I(0.5) * length, bow = k * sqr(length), turn = I(2) * k * length;
    const I off = (last.value - first.value) / turn;
    const I ends = first.value.lo < last.value.lo ? first.value : last.value;
    I low = ends;
    if (!(off.lo >= half.hi || off.hi <= (-half).lo)) {
        const I inside = first.value - k * sqr(half - off), least = ends - I(0.25) * bow;
        if (inside.lo < ends.lo) low = inside;
        if (least.lo > low.lo) low = least;
    }
    if (low.lo < 0) low = I(0);
    const I up = first.value + I(first.slope.hi) * length + bow;
    const I down = last.value - I(last.slope.lo) * length + bow;
    const I from_first = up.hi > first.value.hi ? up : first.value;
    const I from_last = down.hi > last.value.hi ? down : last.value;
    return {from_to(low, from_first.hi < from_last.hi ? from_first : from_last),
            from_to(last.slope - turn, first.slope + turn)};
}

template <class I>
Germ<I> germ_of(const Feet<I>& feet, const Triple<I>& d) {
    const auto slope = [&](const Foot<I>& foot) { return I(2) * inner(d, foot.pull); };
    Germ<I> germ{feet.least(), slope(feet.all().front())};
    for (const Foot<I>& foot : feet.all()) germ.slope = hull(germ.slope, slope(foot));
    return germ;
}

// What two enclosures have in common.
template <class I>
Germ<I> both(const Germ<I>& a, const Germ<I>& b) {
    return {common(a.value, b.value), common(a.slope, b.slope)};
}

// s of a piece of a chain along x = from + t d. With one width it is convex. On the conical part of a
// taper (nearest.h: E, B; here between 0 < B < E for certain) s = N / D, N = |y x m|^2 and
// D = |m|^2 w^2 + 2 dw w y.m + dw^2 |y|^2, both quadratic in t: of N' D - N D' the cubes cancel, and
// along a straight line of a cone all of it does.
template <class I>
Germ<I> piece_over(const Piece<I>& piece, const Triple<I>& from, const Triple<I>& d, const I& t) {
    const I length = I(t.hi) - I(t.lo);
    const auto at = [&](const I& end) {
        Feet<I> feet;
        feet_on(piece, plus(from, times(d, end)), Place{}, feet);
        return germ_of(feet, d);
    };
    const Germ<I> first = at(I(t.lo)), last = at(I(t.hi));
    if (piece.level) return convex_range_above_tangents(first, last, length);
    const I d2 = norm2(d), w = piece.w, dw = piece.dw, end_w = w + dw;
    const Germ<I> range = bowed_range(first, last, length, d2 / sqr(end_w.lo < w.lo ? end_w : w));

    const I m = middle_of(t), tau = t - m;
    const Triple<I> y = minus(plus(from, times(d, m)), piece.a);
    const I y2 = norm2(y), yd = inner(y, d), p = inner(y, piece.m), p1 = inner(d, piece.m);
    const I e = piece.m2 * w + dw * p, e1 = dw * p1;
    const I b = p * w + dw * y2, b1 = p1 * w + I(2) * dw * yd, b2 = dw * d2;
    const auto over = [&](const I& c0, const I& c1, const I& c2) {
        return c0 + tau * (c1 + tau * c2);
    };
    if (!certainly_positive(over(b, b1, b2))) return range;
    if (!certainly_positive(over(e - b, e1 - b1, -b2))) return range;
    const Triple<I> c = outer(y, piece.m), c1 = outer(d, piece.m);
    const I n[] = {norm2(c), I(2) * inner(c, c1), norm2(c1)};
    const I q[] = {piece.m2 * sqr(w) + I(2) * dw * w * p + sqr(dw) * y2,
                   I(2) * dw * (w * p1 + dw * yd), sqr(dw) * d2};
    const I below = over(q[0], q[1], q[2]);
    if (!certainly_positive(below)) return range;
    const I slope = over(n[1] * q[0] - n[0] * q[1], I(2) * (n[2] * q[0] - n[0] * q[2]),
                         n[2] * q[1] - n[1] * q[2]) /
                    sqr(below);
    return both(range, {n[0] / q[0] + slope * tau, slope});
}

// The minimum of functions by their ranges: its slope is one of those that can be the least.
template <class I>
Germ<I> least_of(const std::vector<Germ<I>>& ranges) {
    Germ<I> least = ranges.front();
    for (const Germ<I>& range : ranges) {
        if (range.value.lo < least.value.lo) least.value.lo = range.value.lo;
        if (range.value.hi < least.value.hi) least.value.hi = range.value.hi;
    }
    bool any = false;
    for (const Germ<I>& range : ranges) {
        if (range.value.lo > least.value.hi) continue;
        least.slope = any ? hull(least.slope, range.slope) : range.slope;
        any = true;
    }
    return least;
}

// The pieces that can be nearest somewhere in t, with their ranges; s <= `highest`.
struct NearPieces {
    std::vector<std::size_t> pieces;
    std::vector<Germ<OutwardDouble>> ranges;
};
inline NearPieces near_pieces(const Chain<OutwardDouble>& chain, const Triple<OutwardDouble>& from,
                              const Triple<OutwardDouble>& d, const OutwardDouble& t,
                              OutwardDouble highest) {
    using I = OutwardDouble;
    const I m = middle_of(t), off = t - m;
    const I reach = sqrt(norm2(d)) * I(std::max(off.hi, -off.lo));
    const Triple<I> x = plus(from, times(d, m));
    NearPieces found;
    for (std::size_t i = 0; i < chain.pieces.size(); ++i) {
        const Piece<I>& piece = chain.pieces[i];
        const Ball<I> wider{piece.ball.center, piece.ball.radius + reach};
        if (least_square(wider, x).lo > (highest * sqr(piece.greatest_w)).hi) continue;
        const Germ<I> range = piece_over(piece, from, d, t);
        if (range.value.lo > highest.hi) continue;
        if (range.value.hi < highest.hi) highest = range.value;
        found.pieces.push_back(i);
        found.ranges.push_back(range);
    }
    std::size_t kept = 0;
    for (std::size_t k = 0; k < found.pieces.size(); ++k) {
        if (found.ranges[k].value.lo > highest.hi) continue;
        found.pieces[kept] = found.pieces[k];
        found.ranges[kept++] = found.ranges[k];
    }
    found.pieces.resize(kept);
    found.ranges.resize(kept);
    return found;
}

// s over t, which is not more than `highest`.
template <class I>
Germ<I> body_over(const Chain<I>& chain, const Chain<OutwardDouble>& in_doubles,
                  const Triple<I>& from, const Triple<I>& d, const I& t, const I& highest) {
    const NearPieces near =
        near_pieces(in_doubles, rough(from), rough(d), rough(t), rough(highest));
    if (near.pieces.empty()) return {I::entire(), I::entire()};  // of rounding alone
    if constexpr (std::is_same_v<I, OutwardDouble>) {
        return least_of(near.ranges);
    } else {
        std::vector<Germ<I>> ranges;
        for (const std::size_t i : near.pieces) {
            ranges.push_back(piece_over(chain.pieces[i], from, d, t));
        }
        return least_of(ranges);
    }
}

// Over the plane, s = h^2, h affine.
template <class I>
Germ<I> body_over(const Filled<I>& polygon, const Filled<OutwardDouble>& in_doubles,
                  const Triple<I>& from, const Triple<I>& d, const I& t, const I& highest) {
    const I h1 = inner(d, polygon.normal), h0 = inner(from, polygon.normal);
    const I h = hull(h0 + I(t.lo) * h1, h0 + I(t.hi) * h1);
    const Germ<I> face{sqr(h), I(2) * h * h1};
    const Triple<I> foot = minus(from, times(polygon.normal, h0));
    const Triple<I> along = minus(d, times(polygon.normal, h1));
    const std::optional<bool> inside = is_inside(polygon, plus(foot, times(along, t)));
    if (inside == true) return face;
    const Germ<I> edges = body_over(polygon.edges, in_doubles.edges, from, d, t, highest);
    if (inside == false) return edges;
    return {from_to(face.value, edges.value), hull(face.slope, edges.slope)};
}

template <class I>
Germ<I> body_over(const Arc<I>&, const Arc<OutwardDouble>&, const Triple<I>&, const Triple<I>&,
                  const I&, const I&) {
    return {I::entire(), I::entire()};
}

// s of a skeleton with a body.
template <class I>
class BodyAlongRay {
  public:
    BodyAlongRay(const Bodies& bodies, const Triple<I>& from, const Triple<I>& d)
        : bodies_(&bodies), from_(from), d_(d), k_(norm2(d)) {}

    Germ<I> at(const I& t) const {
        for (const Known& known : known_) {
            if (known.t.lo == t.lo && known.t.hi == t.hi) return known.germ;
        }
        const Germ<I> germ = germ_of(feet_of(*bodies_, plus(from_, times(d_, t))), d_);
        if (known_.size() < most_known) {
            known_.push_back({t, germ});
        } else {
            known_[next_++ % most_known] = {t, germ};
        }
        return germ;
    }
    Germ<I> over(const I& t) const {
        const Germ<I> range = bowed_range(at(I(t.lo)), at(I(t.hi)), I(t.hi) - I(t.lo), k_);
        const I highest(range.value.hi);
        const auto over_body = [&](const auto& body) {
            using InDoubles = typename std::decay_t<decltype(body)>::InDoubles;
            return body_over(body, std::get<InDoubles>(bodies_->rough), from_, d_, t, highest);
        };
        if constexpr (std::is_same_v<I, OutwardDouble>) {
            return both(range, std::visit(over_body, bodies_->rough));
        } else {
            return both(range, std::visit(over_body, bodies_->exact));
        }
    }

  private:
    struct Known {
        I t;
        Germ<I> germ;
    };
    static constexpr std::size_t most_known = 24;  // intervals share their ends

    const Bodies* bodies_;
    Triple<I> from_, d_;
    I k_;
    mutable std::vector<Known> known_;
    mutable std::size_t next_ = 0;
};

// An element made ready for any number of rays.
struct ReadyElement {
    explicit ReadyElement(Element e)
        : element(std::move(e)), strength(element.strength), bodies(bodies_of(element)) {}
    Element element;
    RealInterval strength;  // the element's, or the sum of several that are alike but for it
    std::shared_ptr<const Bodies> bodies;
};

// One element along the ray o + t d 2^exponent. Not for two threads at once.
template <class I>
class ElementAlongRay {
  public:
    ElementAlongRay(const ReadyElement& ready, const Ray& ray, long exponent)
        : kernel_(ready.element.kernel),
          strength_(strength_of(ready)),
          s_(along(ready, triple<I>(ray.origin), triple<I>(ray.direction, exponent))) {}

    ElementAlongRay(const ivory::Element& element, const Ray& ray, long exponent)
        : ElementAlongRay(std::make_shared<const ReadyElement>(from_core(element)), ray, exponent) {
    }

    // F and dF/dt for all t of the interval.
    Germ<I> over(const I& t) const {
        const Germ<I> s = square(t);
        const Germ<I> k = kernel_germ(kernel_, s.value);
        return {strength_ * k.value, strength_ * (k.slope * s.slope)};
    }
    // s = q^2 and ds/dt likewise.
    Germ<I> square(const I& t) const {
        return std::visit(
            [&](const auto& shape) { return t.is_point() ? shape.at(t) : shape.over(t); }, s_);
    }

    static Triple<I> unit_normal(const Vec3d& n) { return unit<I>(n); }

  private:
    using Shape = std::variant<PointAlongRay<I>, SegmentAlongRay<I>, CircleAlongRay<I>,
                               DiscAlongRay<I>, BodyAlongRay<I>>;

    static I strength_of(const ReadyElement& ready) {
        if constexpr (std::is_same_v<I, OutwardDouble>) {
            return OutwardDouble(ready.strength);
        } else {
            return ready.strength;
        }
    }

    static Shape along(const ReadyElement& ready, const Triple<I>& o, const Triple<I>& d) {
        const Element& element = ready.element;
        const I w(element.width);
        const Triple<I> direction = divided(d, w);
        const auto from = [&](const Vec3d& c) { return divided(minus(o, triple<I>(c)), w); };
        const Triple<I> from_first = from(first_place(element.skeleton));
        if (ready.bodies) return BodyAlongRay<I>(*ready.bodies, from_first, direction);
        if (const auto* segment = std::get_if<Segment>(&element.skeleton)) {
            if (segment->a == segment->b) return PointAlongRay<I>(from_first, direction);
            const Triple<I> m = minus(triple<I>(segment->b), triple<I>(segment->a));
            return SegmentAlongRay<I>(from_first, from(segment->b), divided(m, w), direction);
        }
        if (const auto* circle = std::get_if<Circle>(&element.skeleton)) {
            return CircleAlongRay<I>(from_first, unit<I>(circle->normal), I(circle->radius) / w,
                                     direction);
        }
        const auto* disc = std::get_if<Disc>(&element.skeleton);
        if (disc == nullptr || disc->radius == 0) return PointAlongRay<I>(from_first, direction);
        return DiscAlongRay<I>(from_first, unit<I>(disc->normal), I(disc->radius) / w, direction);
    }

    ElementAlongRay(std::shared_ptr<const ReadyElement> own, const Ray& ray, long exponent)
        : ElementAlongRay(*own, ray, exponent) {
        own_ = std::move(own);
    }

    Kernel kernel_;
    I strength_;
    Shape s_;
    std::shared_ptr<const ReadyElement> own_;  // where nobody else keeps it
};

}  // namespace ivory::reference
