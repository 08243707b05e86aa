// The foot on an arc in lanes, of many points on one arc or of one point on many: what the quick forms of
// curves are made of (core/shape/curve.h, which includes this once for each instruction set).
HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {
namespace {

template <class Real>
inline constexpr int newton_steps_of_arcs = sizeof(Real) == sizeof(float) ? 5 : 8;

// The numbers of the pieces of some arcs (curve_arc::numbers_of_piece) whose middle and half are m.x and m.y.
template <class Tag>
class ArcPiece {
  public:
    template <class Arcs>
    HWY_INLINE explicit ArcPiece(const Arcs& e) {
        using namespace curve_arc;
        using Real = hn::TFromD<Tag>;
        using Margin = Margins<Real>;
        const Tag d;
        const auto c = [&](double value) HWY_ATTR { return constant(d, value); };
        const auto vector = [&](std::size_t k) HWY_ATTR __attribute__((always_inline)) {
            return Vec3v<Tag>{e.number(k), e.number(k + 1), e.number(k + 2)};
        };
        const auto plus = [](const Vec3v<Tag>& a, V<Tag> by, const Vec3v<Tag>& b) HWY_ATTR
            __attribute__((always_inline)) {
            return Vec3v<Tag>{hn::MulAdd(by, b.x, a.x), hn::MulAdd(by, b.y, a.y),
                              hn::MulAdd(by, b.z, a.z)};
        };
        const auto times =
            [](V<Tag> by, const Vec3v<Tag>& a) HWY_ATTR __attribute__((always_inline)) {
            return Vec3v<Tag>{hn::Mul(by, a.x), hn::Mul(by, a.y), hn::Mul(by, a.z)};
        };
        const V<Tag> m = e.m.x, h = e.m.y, h2 = hn::Mul(h, h), h3 = hn::Mul(h2, h),
                     m3 = hn::Mul(m, c(3)), widened = hn::Set(d, Margin::more);
        const Vec3v<Tag> c0 = vector(at_k0), c1 = vector(at_k1), c2 = vector(at_k2),
                         c3 = vector(at_k3);
        const Vec3v<Tag> k1 = times(h, plus(c1, m, plus(plus(c2, m3, c3), c(1), c2))),
                         k2 = times(h2, plus(c2, m3, c3)), k3 = times(h3, c3);
        put(at_k0, plus(c0, m, plus(c1, m, plus(c2, m, c3))));
        put(at_k1, k1);
        put(at_k2, k2);
        put(at_k3, k3);
        const V<Tag> k11 = dot<Tag>(k1, k1), k12 = dot<Tag>(k1, k2), k13 = dot<Tag>(k1, k3),
                     k22 = dot<Tag>(k2, k2), k23 = dot<Tag>(k2, k3), k33 = dot<Tag>(k3, k3);
        number_[at_g] = k11;
        number_[at_g + 1] = hn::Mul(c(3), k12);
        number_[at_g + 2] = hn::MulAdd(c(2), k22, hn::Mul(c(4), k13));
        number_[at_g + 3] = hn::Mul(c(5), k23);
        number_[at_g + 4] = hn::Mul(c(3), k33);
        const Vec3v<Tag> odd = plus(k1, c(1), k3);
        put(at_begin, plus(k2, c(-1), odd));
        put(at_end, plus(k2, c(1), odd));
        const V<Tag> n1 = hn::Sqrt(k11), n2 = hn::Sqrt(k22), n3 = hn::Sqrt(k33),
                     bend = hn::MulAdd(c(2), n2, hn::Mul(c(3), n3)),
                     whole_fastest = hn::Mul(h, e.number(at_fastest)),
                     whole_turn = hn::Mul(h2, e.number(at_turn));
        const V<Tag> lost = hn::Mul(hn::Add(whole_fastest, whole_turn), hn::Set(d, Margin::margin));
        number_[at_slowest] =
            hn::Mul(hn::Max(hn::Mul(h, e.number(at_slowest)), hn::Sub(hn::Sub(n1, bend), lost)),
                    hn::Set(d, Margin::less));
        number_[at_slowest] =
            hn::IfThenElseZero(hn::Gt(e.number(at_slowest), hn::Zero(d)), number_[at_slowest]);
        number_[at_fastest] =
            hn::Mul(hn::Min(whole_fastest, hn::Add(hn::Add(n1, bend), lost)), widened);
        number_[at_turn] = hn::Mul(
            hn::Min(whole_turn, hn::Add(hn::MulAdd(c(2), n2, hn::Mul(c(6), n3)), lost)), widened);
        const V<Tag> speeding = hn::Add(
            hn::Add(hn::Abs(hn::Add(k12, k12)), hn::Abs(hn::MulAdd(c(4), k22, hn::Mul(c(6), k13)))),
            hn::MulAdd(hn::Mul(c(18), n3), hn::Add(n2, n3), hn::Mul(lost, whole_fastest)));
        number_[at_speeding] =
            hn::Mul(hn::Min(hn::Mul(h3, e.number(at_speeding)), speeding), widened);
        number_[at_third] = hn::Mul(hn::Mul(h3, e.number(at_third)), widened);
        number_[at_radius] = hn::Mul(hn::Add(hn::Add(n1, n2), hn::Add(n3, lost)), widened);
        number_[at_lost] = e.number(at_lost);
        number_[at_lost_square] = e.number(at_lost_square);
        const V<Tag> own = e.number(at_own_end), both = c(2), one = c(1), minus_one = c(-1);
        const M<Tag> has_both = hn::Eq(own, both);
        const M<Tag> begins = hn::And(hn::Or(has_both, hn::Eq(own, minus_one)),
                                      hn::Eq(hn::Sub(m, h), minus_one)),
                     ends = hn::And(hn::Or(has_both, hn::Eq(own, one)), hn::Eq(hn::Add(m, h), one));
        number_[at_own_end] = hn::IfThenElse(begins, hn::IfThenElse(ends, both, minus_one),
                                             hn::IfThenElseZero(ends, one));
    }
    [[nodiscard]] HWY_INLINE V<Tag> operator()(std::size_t k) const { return number_[k]; }

  private:
    HWY_INLINE void put(std::size_t k, const Vec3v<Tag>& v) {
        number_[k] = v.x;
        number_[k + 1] = v.y;
        number_[k + 2] = v.z;
    }
    V<Tag> number_[curve_arc::most_numbers];
};

// What is proved of one place x of an arc: with it q and G, which bound all others, or q = 0 where nothing is.
template <class Tag>
struct ProvedArc {
    ProvedFoot<Tag> foot;
    V<Tag> x, q, G;
    M<Tag> is_end;  // D is concave
};

// An arc's cubic and its g (core/shape/curve_arc.h) for v = p - a - k0; number(k) are the arc's numbers.
template <class Tag, class Number>
class ArcFoot {
  public:
    using Real = hn::TFromD<Tag>;
    static constexpr int newton_steps = newton_steps_of_arcs<Real>;
    // From a place that is nearer, and less is asked of them: what they leave is bounded.
    static constexpr int steps_of_proof = sizeof(Real) == sizeof(float) ? 3 : 5;

    HWY_INLINE ArcFoot(Tag, const Number& number, const Vec3v<Tag>& v)
        : number_(number),
          v_(v),
          k1_(vector(curve_arc::at_k1)),
          k2_(vector(curve_arc::at_k2)),
          k3_(vector(curve_arc::at_k3)) {
        using namespace curve_arc;
        g0_ = dot<Tag>(v_, k1_);
        g1_ = hn::MulSub(c(2), dot<Tag>(v_, k2_), number_(at_g));
        g2_ = hn::MulSub(c(3), dot<Tag>(v_, k3_), number_(at_g + 1));
        g3_ = hn::Neg(number_(at_g + 2));
        g4_ = hn::Neg(number_(at_g + 3));
        g5_ = hn::Neg(number_(at_g + 4));
        s1_ = hn::Add(g2_, g2_);
        s2_ = hn::Mul(c(3), g3_);
        s3_ = hn::Mul(c(4), g4_);
        s4_ = hn::Mul(c(5), g5_);
    }

    // From the nearest place of the arc, its square, and nothing proved of it: of the two ends, the middle and
    // where Newton leads from there, the last unless another is clearly nearer.
    struct Off {
        Vec3v<Tag> from;
        V<Tag> square;
    };
    HWY_INLINE Off off() const {
        V<Tag> x = onward(hn::Zero(d), g0_, g1_);
        for (int step = 1; step < newton_steps; ++step) x = onward(x);
        Off best{away_at(x), hn::Zero(d)};
        best.square = dot<Tag>(best.from, best.from);
        const V<Tag> clearly = hn::Set(d, 1 - 16 * Margins<Real>::margin);
        const auto compare = [&](const Vec3v<Tag>& from) HWY_ATTR __attribute__((always_inline)) {
            const V<Tag> square = dot<Tag>(from, from);
            const M<Tag> nearer = hn::Lt(square, hn::Mul(best.square, clearly));
            best = {{hn::IfThenElse(nearer, from.x, best.from.x),
                     hn::IfThenElse(nearer, from.y, best.from.y),
                     hn::IfThenElse(nearer, from.z, best.from.z)},
                    hn::IfThenElse(nearer, square, best.square)};
        };
        const Vec3v<Tag> begin = vector(curve_arc::at_begin), end = vector(curve_arc::at_end);
        compare({hn::Sub(v_.x, begin.x), hn::Sub(v_.y, begin.y), hn::Sub(v_.z, begin.z)});
        compare({hn::Sub(v_.x, end.x), hn::Sub(v_.y, end.y), hn::Sub(v_.z, end.z)});
        compare(v_);
        return best;
    }

    // Of one place c(x), the nearest as far as five of them and Newton's steps tell. With h(y) = (g(y) - g(x)) /
    // (y - x), a polynomial of the fourth degree,
    //     |v - c(y)|^2 = |v - c(x)|^2 - 2 g(x) (y - x) - 2 (integral of (s - x) h(s) from x to y)
    //                 >= square - 2 G |y - x| + q (y - x)^2,
    // -q the greatest of h's Bernstein coefficients on [-1, 1] and G = |g(x)|; at an end that g leads out of G is
    // 0 and q larger by |g|, as |y - x| <= 2. After a way t of the ray that is less by no more than 2 |t| F |y - x|
    // beside what c(x) alone does, F the greatest |c'|: so slack = G^2 / q, and the foot is within |y - x| <= 2 (G
    // + |t| F) / q. Where D is concave along the arc, which it stays while |g'| changes by less than reach |c''|,
    // an end is the nearest: that which no other arc has.
    // What rounding does is as if v and the coefficients of c were others (`errors`), and, with S = (|v| + R) R,
    // R = |k1| + |k2| + |k3| and the sum of all |g_k| <= 3 S, 96 u S in g, 768 u S in q and 3072 u S in g', a third of it
    // for the coefficients of a piece.
    HWY_INLINE ProvedArc<Tag> proved(V<Tag> reach) const {
        using namespace curve_arc;
        using Margin = Margins<Real>;
        const V<Tag> zero = hn::Zero(d), one = c(1), minus_one = c(-1);

        // The nearest of five places, and on from there: D(x) = D(0) - 2 (E + O), E even and O odd in x.
        const V<Tag> e1 = hn::Mul(c(0.5), g1_), e2 = hn::Mul(c(0.25), g3_),
                     e3 = hn::Mul(c(1.0 / 6), g5_), o1 = hn::Mul(c(1.0 / 3), g2_),
                     o2 = hn::Mul(c(0.2), g4_);
        V<Tag> x = zero, gained = zero;
        V<Tag> at_first = zero, at_last = zero;  // -(D(x) - D(0)) / 2 at the ends
        for (const double place : {0.5, 1.0}) {
            const V<Tag> square = c(place * place);
            const V<Tag> even = hn::Mul(square, hn::MulAdd(square, hn::MulAdd(square, e3, e2), e1));
            const V<Tag> odd =
                hn::Mul(c(place), hn::MulAdd(square, hn::MulAdd(square, o2, o1), g0_));
            at_first = hn::Sub(even, odd);
            at_last = hn::Add(even, odd);
            x = hn::IfThenElse(hn::Gt(at_first, gained), c(-place), x);
            gained = hn::Max(gained, at_first);
            x = hn::IfThenElse(hn::Gt(at_last, gained), c(place), x);
            gained = hn::Max(gained, at_last);
        }
        const V<Tag> begun = x;
        for (int step = 0; step < steps_of_proof; ++step) x = onward(x);
        x = hn::IfThenElse(hn::Lt(square_at(begun), square_at(x)), begun, x);

        const V<Tag> R = number_(at_radius);
        const V<Tag> S =
            hn::Mul(hn::Add(hn::Add(hn::Abs(v_.x), hn::Abs(v_.y)), hn::Add(hn::Abs(v_.z), R)), R);
        const V<Tag> error =
            hn::MulAdd(S, c(6 * double{Margin::margin}), hn::Mul(number_(at_lost_square), c(64)));
        // On all of the arc and of the reach: g' as far as it is above that, in Bernstein's form.
        const V<Tag> even = hn::Add(g1_, hn::Add(s2_, s4_)), odd = hn::Add(s1_, s3_),
                     inner = hn::Sub(g1_, s4_), half_odd = hn::Mul(c(0.5), hn::Sub(s1_, s3_));
        const V<Tag> least_rise =
            hn::Min(hn::Min(hn::Sub(even, hn::Abs(odd)), hn::Sub(inner, hn::Abs(half_odd))),
                    hn::Add(hn::NegMulAdd(c(1.0 / 3), s2_, g1_), s4_));
        const V<Tag> own_end = number_(at_own_end);
        const M<Tag> is_end =
            hn::And(hn::Gt(hn::NegMulAdd(c(4), error, least_rise),
                           hn::Mul(hn::Mul(reach, number_(at_turn)), hn::Set(d, Margin::more))),
                    hn::Lt(own_end, c(1.5)));
        const V<Tag> nearer_end = hn::IfThenElse(hn::Gt(at_first, at_last), minus_one, one);
        x = hn::IfThenElse(is_end, hn::IfThenElse(hn::Eq(own_end, zero), nearer_end, own_end), x);

        const V<Tag> h4 = g5_, h3 = hn::MulAdd(x, h4, g4_), h2 = hn::MulAdd(x, h3, g3_),
                     h1 = hn::MulAdd(x, h2, g2_), h0 = hn::MulAdd(x, h1, g1_),
                     g = hn::MulAdd(x, h0, g0_);
        const V<Tag> greatest =
            hn::Max(hn::Max(hn::Add(hn::Add(h0, hn::Add(h2, h4)), hn::Abs(hn::Add(h1, h3))),
                            hn::Add(hn::Sub(h0, h4), hn::Abs(hn::Mul(c(0.5), hn::Sub(h1, h3))))),
                    hn::Add(hn::NegMulAdd(c(1.0 / 3), h2, h0), h4));
        const V<Tag> outward =
            at_least_0(hn::Sub(hn::IfThenElseZero(hn::Eq(hn::Abs(x), one), hn::Mul(g, x)), error));
        const V<Tag> q = hn::Sub(hn::Sub(outward, greatest), error);
        const V<Tag> G =
            hn::IfThenElseZero(hn::Eq(outward, zero), hn::MulAdd(error, c(0.125), hn::Abs(g)));
        const V<Tag> fastest = number_(at_fastest), widened = c(1 + 0x1p-10);
        const M<Tag> known = hn::Gt(q, hn::Mul(error, c(0x1p-3)));
        const V<Tag> inverse = hn::Div(widened, hn::IfThenElse(known, q, one));
        const V<Tag> at_most = hn::Mul(hn::Add(G, hn::Abs(hn::Min(q, zero))), c(4 * (1 + 0x1p-10)));
        ProvedFoot<Tag> foot;
        foot.away = away_at(x);
        foot.square = dot<Tag>(foot.away, foot.away);
        // Of an end nothing else is asked, and where nothing is known there is d' <= 1.
        const V<Tag> of_known = hn::Min(at_most, hn::Mul(square_of(G), inverse));
        foot.slack = hn::IfThenZeroElse(is_end, hn::IfThenElse(known, of_known, at_most));
        const M<Tag> is_bounded = hn::AndNot(is_end, known);
        foot.bend =
            hn::IfThenElseZero(is_bounded, hn::Mul(hn::Mul(c(2), square_of(fastest)), inverse));
        const V<Tag> anything =
            hn::Mul(hn::Add(hn::Sqrt(foot.square), reach), c(2 * (1 + 0x1p-10)));
        foot.pull = hn::IfThenZeroElse(
            is_end,
            hn::IfThenElse(known, hn::Mul(hn::Mul(c(2), hn::Mul(fastest, G)), inverse), anything));
        foot.in_reach = hn::Or(is_end, hn::Not(known));
        return {foot, x, hn::IfThenElseZero(known, q), G, is_end};
    }

  private:
    static constexpr Tag d{};
    static HWY_INLINE V<Tag> c(double value) { return constant(d, value); }
    HWY_INLINE Vec3v<Tag> vector(std::size_t k) const {
        return {number_(k), number_(k + 1), number_(k + 2)};
    }
    // v - c(x), and its square.
    HWY_INLINE Vec3v<Tag> away_at(V<Tag> x) const {
        const auto away = [&](V<Tag> k1i, V<Tag> k2i, V<Tag> k3i, V<Tag> vi) HWY_ATTR
            __attribute__((always_inline)) {
            return hn::NegMulAdd(x, hn::MulAdd(x, hn::MulAdd(x, k3i, k2i), k1i), vi);
        };
        return {away(k1_.x, k2_.x, k3_.x, v_.x), away(k1_.y, k2_.y, k3_.y, v_.y),
                away(k1_.z, k2_.z, k3_.z, v_.z)};
    }
    HWY_INLINE V<Tag> square_at(V<Tag> x) const {
        const Vec3v<Tag> away = away_at(x);
        return dot<Tag>(away, away);
    }
    HWY_INLINE V<Tag> g_at(V<Tag> x) const {
        return hn::MulAdd(
            x, hn::MulAdd(x, hn::MulAdd(x, hn::MulAdd(x, hn::MulAdd(x, g5_, g4_), g3_), g2_), g1_),
            g0_);
    }
    HWY_INLINE V<Tag> slope_at(V<Tag> x) const {
        return hn::MulAdd(x, hn::MulAdd(x, hn::MulAdd(x, hn::MulAdd(x, s4_, s3_), s2_), s1_), g1_);
    }
    // Newton's step, where g falls; the arc's end where it leads out of that.
    static HWY_INLINE V<Tag> onward(V<Tag> x, V<Tag> g, V<Tag> slope) {
        const V<Tag> falls = hn::Set(d, -least_square<Real>);
        return hn::Min(hn::Max(hn::Sub(x, hn::Div(g, hn::Min(slope, falls))), c(-1)), c(1));
    }
    HWY_INLINE V<Tag> onward(V<Tag> x) const { return onward(x, g_at(x), slope_at(x)); }

    const Number& number_;
    Vec3v<Tag> v_, k1_, k2_, k3_;
    V<Tag> g0_, g1_, g2_, g3_, g4_, g5_;  // of g
    V<Tag> s1_, s2_, s3_, s4_;            // and of g', which begins with g1
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();
