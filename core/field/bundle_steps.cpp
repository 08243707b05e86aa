#include "core/field/bundle_steps.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "core/field/bundle.h"
#include "core/math/instruction_sets.h"
#include "core/math/offset.h"

#ifndef IVORY_BUNDLE_STEPS_TABLES
#define IVORY_BUNDLE_STEPS_TABLES
namespace ivory {
namespace {

// For each byte the numbers of its bits that are set, in order.
constexpr std::array<std::array<std::uint8_t, 8>, 256> lanes_of_bits = [] {
    std::array<std::array<std::uint8_t, 8>, 256> table{};
    for (std::size_t bits = 0; bits < table.size(); ++bits) {
        std::size_t at = 0;
        for (std::uint8_t k = 0; k < 8; ++k) {
            if ((bits >> k & 1) != 0) table[bits][at++] = k;
        }
    }
    return table;
}();

}  // namespace
}  // namespace ivory
#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/field/bundle_steps.cpp"
#include <hwy/foreach_target.h>  // includes this file once for each instruction set
#include "core/field/kernel_lanes.inl"

HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {
namespace {

using I = hn::RebindToSigned<D>;
using F = hn::ScalableTag<float>;

// What makes up for rounding, relative to the magnitudes that went in: 2^7 units of it.
template <class Real>
struct Margins;

template <>
struct Margins<double> {
    static constexpr double margin = 0x1p-46, more = 1 + 0x1p-46, less = 1 - 0x1p-46;
    static constexpr double least_peak = 1e-300;  // what underflows
    static constexpr double near_end = 0x1p-49;   // of a kernel that ends at 1
};

template <>
struct Margins<float> {
    static constexpr float margin = 0x1p-17f, more = 1 + 0x1p-17f, less = 1 - 0x1p-17f;
    static constexpr float least_peak = 1e-36f;
    static constexpr float near_end = 0x1p-20f;
};

constexpr double more = Margins<double>::more, less = Margins<double>::less;

// The s'' of a circle is bounded where r / rho stays below this; else the element counts as kinked.
constexpr double greatest_outward = 32;

// sup of x e^-x^2 and of x^3 e^-x^2 for x >= 0 are 0.4289 and 0.4099.
constexpr double unit_slope = 0.43;

template <class Tag>
HWY_INLINE V<Tag> constant(Tag d, double value) {
    return hn::Set(d, static_cast<hn::TFromD<Tag>>(value));
}
HWY_INLINE V<D> constant(double value) { return hn::Set(D(), value); }
template <class Vector>
HWY_INLINE Vector square_of(Vector x) {
    return hn::Mul(x, x);
}
template <class Tag>
HWY_INLINE V<Tag> length_of(Tag, const Vec3v<Tag>& v) {
    return hn::Sqrt(dot<Tag>(v, v));
}
template <class Vector>
HWY_INLINE Vector at_least_0(Vector x) {
    return hn::Max(x, hn::Zero(hn::DFromV<Vector>()));
}

// Upper bounds of k and |k'| from a lower bound of s. The factored forms lose relative accuracy
// only in 1 - q of Nishimura's kernel, for which the absolute terms are.
template <KernelKind kind, class Tag>
HWY_INLINE V<Tag> peak_of(Tag d, V<Tag> s) {
    using Real = hn::TFromD<Tag>;
    using Margin = Margins<Real>;
    const V<Tag> widened = hn::Set(d, Margin::more);
    if constexpr (kind == KernelKind::blinn) {
        // rounded down, the product with s as well
        constexpr double scale =
            argument_scale<kind> * (sizeof(Real) == 4 ? 1 - 0x1p-21 : 1 - 0x1p-50);
        const V<Tag> k = exp2_minus(d, hn::Mul(s, constant(d, scale)));
        return hn::MulAdd(k, widened, hn::Set(d, Margin::least_peak));
    }
    const V<Tag> k = kernel<kind>(d, s).k;
    return hn::IfThenElseZero(hn::Lt(s, constant(d, 1)),
                              hn::MulAdd(k, widened, hn::Set(d, Margin::near_end)));
}

template <KernelKind kind, class Tag>
HWY_INLINE V<Tag> steepest(Tag d, V<Tag> s) {
    using Margin = Margins<hn::TFromD<Tag>>;
    const V<Tag> dk = hn::Neg(kernel<kind>(d, s).dk);
    return hn::IfThenElseZero(hn::Lt(s, constant(d, 1)),
                              hn::MulAdd(dk, hn::Set(d, Margin::more), hn::Set(d, Margin::margin)));
}

// An upper bound of w / (2 |b|) |F'| = x |k'| <= sqrt(s) |k'| where s >= least: for Blinn's, with
// s = least + y, e^-s sqrt(s) <= e^-least (sqrt(least) + sup sqrt(y) e^-y); for the other two the
// greatest value of sqrt(s) |k'| is 1 and 0.79.
template <KernelKind kind, class Tag>
HWY_INLINE V<Tag> slope_of(Tag d, V<Tag> least, V<Tag> peak) {
    if constexpr (kind != KernelKind::blinn) {
        return hn::IfThenElseZero(hn::Lt(least, constant(d, 1)), constant(d, 1));
    }
    const V<Tag> falling = hn::Mul(peak, hn::Add(hn::Sqrt(least), constant(d, unit_slope)));
    return hn::Mul(hn::Min(constant(d, unit_slope), falling),
                   hn::Set(d, Margins<hn::TFromD<Tag>>::more));
}

// (1) of bundle.h: a lower bound of the distance between two places at most L apart from lower
// bounds of those there, with which it rises. Errors have to be taken off before: near 0 the result
// follows their square roots.
template <class Tag>
HWY_INLINE V<Tag> least_between(Tag d, V<Tag> d0, V<Tag> d1, hn::TFromD<Tag> L) {
    using Margin = Margins<hn::TFromD<Tag>>;
    const hn::TFromD<Tag> square = L * L;
    const V<Tag> square0 = square_of(d0), square1 = square_of(d1), squareL = hn::Set(d, square);
    const V<Tag> half = hn::Mul(constant(d, 0.5), hn::Sub(hn::Add(squareL, square0), square1));
    const V<Tag> vertex = hn::NegMulAdd(hn::Mul(half, half), hn::Set(d, 1 / square), square0);
    const auto within = hn::And(hn::Gt(half, hn::Zero(d)), hn::Lt(half, squareL));
    V<Tag> least = hn::IfThenElse(within, vertex, hn::Min(square0, square1));
    least = hn::NegMulAdd(hn::Add(hn::Add(square0, square1), squareL), hn::Set(d, Margin::margin),
                          least);
    return hn::Mul(hn::Sqrt(at_least_0(least)), hn::Set(d, Margin::less));
}

// A stretch as the lanes see it: the points base + tau axis, begin <= tau <= end, and what is at
// most `spread` times t = tau + t_offset away from them. Places are relative to the bundle's origin
// in double, to the middle of some stretch in float.
template <class Real>
struct Reach {
    Vec3<Real> axis, base;
    Real begin, end, spread;
    Real t_offset;
    Real magnitude;  // of all numbers here but t_offset: what rounding is relative to
};

HWY_INLINE Reach<double> reach_of(const Stretch& s) {
    return {s.axis, {}, s.begin, s.end, s.spread, 0, s.end};
}

HWY_INLINE Reach<float> reach_of(const NearStretch& s) {
    const auto narrow = [](const Vec3d& v) {
        return Vec3<float>{static_cast<float>(v.x), static_cast<float>(v.y),
                           static_cast<float>(v.z)};
    };
    const double magnitude = std::fmax(std::abs(s.begin), std::abs(s.end)) + std::abs(s.base.x) +
                             std::abs(s.base.y) + std::abs(s.base.z);
    return {narrow(s.axis),
            narrow(s.base),
            static_cast<float>(s.begin),
            static_cast<float>(s.end),
            static_cast<float>(s.spread * (1 + 0x1p-22)),
            static_cast<float>(s.t_offset * (1 + 0x1p-22)),
            static_cast<float>(magnitude * (1 + 0x1p-22))};
}

// Of elements whose places are off by more than their own rounding.
HWY_INLINE Reach<float> reach_of(const NearStretch& s, const NearElements& near) {
    Reach<float> reach = reach_of(s);
    reach.magnitude += 0x1p-5F * near.magnitude;  // margin of that: 2^-22
    return reach;
}

// Some elements of a group, seen from where their places are relative to.
template <class Tag, Shape shape>
struct Seen {
    using Real = hn::TFromD<Tag>;
    Vec3v<Tag> v;           // to the point, the segment's end a, the centre
    Vec3v<Tag> m;           // segment: b - a; circle: unit normal
    V<Tag> extra;           // segment: 1 / |m|^2; circle: radius
    V<Tag> size;            // of the skeleton: no point of it is farther from c
    V<Tag> magnitude;       // at least |v| + size
    V<Tag> strength;        // scaled
    V<Tag> inverse_square;  // 1 / w^2

    Seen(const Field& field, const Stretch& stretch, double scale,
         hn::Vec<I> index) requires(sizeof(Real) == sizeof(double)) {
        const D d;
        const auto column = [&](const std::vector<double>& values)
                                HWY_ATTR { return hn::GatherIndex(d, values.data(), index); };
        v = {hn::Sub(column(field.ax), constant(stretch.origin.x)),
             hn::Sub(column(field.ay), constant(stretch.origin.y)),
             hn::Sub(column(field.az), constant(stretch.origin.z))};
        if constexpr (shape != Shape::point) {
            m = {column(field.mx), column(field.my), column(field.mz)};
            extra = column(field.extra);
            size = shape == Shape::segment ? column(field.length) : extra;
        }
        strength = hn::Mul(column(field.strength), constant(scale));
        inverse_square = column(field.inverse_square);
        finish();
    }

    Seen(const NearElements& near, const Reach<float>& reach,
         std::size_t i) requires(sizeof(Real) == sizeof(float)) {
        const F d;
        const auto column = [&](const std::vector<float>& values)
                                HWY_ATTR { return hn::LoadU(d, &values[i]); };
        v = {hn::Sub(column(near.x), hn::Set(d, reach.base.x)),
             hn::Sub(column(near.y), hn::Set(d, reach.base.y)),
             hn::Sub(column(near.z), hn::Set(d, reach.base.z))};
        if constexpr (shape != Shape::point) {
            m = {column(near.mx), column(near.my), column(near.mz)};
            extra = column(near.extra);
            size = shape == Shape::segment ? column(near.length) : extra;
        }
        strength = column(near.strength);
        inverse_square = column(near.inverse_square);
        finish();
    }

    // The distance of the axis' point at t from the skeleton.
    HWY_INLINE V<Tag> distance(const Vec3<Real>& axis, Real t) const {
        const Tag d;
        const Vec3v<Tag> from = from_axis(axis, t);
        const V<Tag> along = dot<Tag>(from, m);
        const Vec3v<Tag> foot_of = across(from, m, shape == Shape::segment ? foot(along) : along);
        if constexpr (shape == Shape::segment) return length_of(d, foot_of);
        const V<Tag> off = hn::Sub(length_of(d, foot_of), extra);
        return hn::Sqrt(hn::MulAdd(off, off, square_of(along)));
    }

    // And that from a circle's axis.
    HWY_INLINE V<Tag> rho(const Vec3<Real>& axis, Real t) const {
        const Vec3v<Tag> from = from_axis(axis, t);
        return length_of(Tag(), across(from, m, dot<Tag>(from, m)));
    }

  private:
    HWY_INLINE void finish() {
        const Tag d;
        if constexpr (shape == Shape::point) {
            m = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
            extra = size = hn::Zero(d);
        }
        magnitude =
            hn::Mul(hn::Add(hn::Add(hn::Abs(v.x), hn::Abs(v.y)), hn::Add(hn::Abs(v.z), size)),
                    hn::Set(d, Margins<Real>::more));
    }
    HWY_INLINE Vec3v<Tag> from_axis(const Vec3<Real>& axis, Real t) const {
        const Tag d;
        return {hn::Sub(hn::Set(d, t * axis.x), v.x), hn::Sub(hn::Set(d, t * axis.y), v.y),
                hn::Sub(hn::Set(d, t * axis.z), v.z)};
    }
    HWY_INLINE V<Tag> foot(V<Tag> along) const {
        return hn::Min(at_least_0(hn::Mul(along, extra)), constant(Tag(), 1));
    }
    static HWY_INLINE Vec3v<Tag> across(const Vec3v<Tag>& a, const Vec3v<Tag>& m, V<Tag> share) {
        return {hn::NegMulAdd(share, m.x, a.x), hn::NegMulAdd(share, m.y, a.y),
                hn::NegMulAdd(share, m.z, a.z)};
    }
};

// A point against the bundle's axis.
template <class Tag>
struct FromAxis {
    using Real = hn::TFromD<Tag>;
    V<Tag> along, across_square;

    HWY_INLINE FromAxis(const Vec3v<Tag>& v, const Vec3<Real>& axis) {
        const Tag d;
        const Vec3v<Tag> a{hn::Set(d, axis.x), hn::Set(d, axis.y), hn::Set(d, axis.z)};
        along = dot<Tag>(v, a);
        const Vec3v<Tag> across{hn::NegMulAdd(along, a.x, v.x), hn::NegMulAdd(along, a.y, v.y),
                                hn::NegMulAdd(along, a.z, v.z)};
        across_square = dot<Tag>(across, across);
    }

    // Its least distance from the axis' points of a stretch.
    HWY_INLINE V<Tag> nearest(Real begin, Real end) const {
        const Tag d;
        const V<Tag> before = hn::Sub(hn::Set(d, begin), along),
                     after = hn::Sub(along, hn::Set(d, end));
        return hn::Sqrt(hn::Add(across_square, square_of(at_least_0(hn::Max(before, after)))));
    }
};

template <class Tag>
struct DistanceRange {
    V<Tag> near;
    V<Tag> far;  // not of points: nobody asks
};

// What rounding does to distances, where numbers are no larger than that.
template <class Tag>
HWY_INLINE V<Tag> error_of(Tag d, V<Tag> magnitude, const Reach<hn::TFromD<Tag>>& reach) {
    return hn::Mul(hn::Add(magnitude, hn::Set(d, reach.magnitude)),
                   hn::Set(d, Margins<hn::TFromD<Tag>>::margin));
}

// At most so far from the axis' points are the rays', up to t = far: beyond, each ray only gets
// farther from every point of the skeleton, so that what holds up to there holds on.
template <class Tag>
HWY_INLINE V<Tag> aside_of(Tag d, V<Tag> magnitude, const Reach<hn::TFromD<Tag>>& s) {
    const V<Tag> offset = hn::Set(d, s.t_offset);
    const V<Tag> last =
        hn::Max(hn::Set(d, s.t_offset + s.begin),
                hn::Min(hn::Set(d, s.t_offset + s.end), hn::Add(offset, magnitude)));
    return hn::Mul(last, hn::Set(d, s.spread * Margins<hn::TFromD<Tag>>::more));
}

// A lower and an upper bound of the distances between the skeletons and the stretch's points. On a
// long stretch a ball around the skeleton, or a segment's whole line, says more than (1).
template <class Tag, Shape shape>
HWY_INLINE DistanceRange<Tag> distances(const Seen<Tag, shape>& e, const Reach<hn::TFromD<Tag>>& s,
                                        V<Tag> error) {
    const Tag d;
    using Real = hn::TFromD<Tag>;
    constexpr Real widened = Margins<Real>::more;
    const V<Tag> aside = aside_of(d, e.magnitude, s);
    const V<Tag> off = hn::Add(aside, error);
    if constexpr (shape == Shape::point) {
        const FromAxis<Tag> c(e.v, s.axis);
        return {at_least_0(hn::Sub(c.nearest(s.begin, s.end), off)), hn::Zero(d)};
    } else {
        const Real L = (s.end - s.begin) * widened;
        const V<Tag> d0 = e.distance(s.axis, s.begin), d1 = e.distance(s.axis, s.end);
        V<Tag> near =
            least_between(d, at_least_0(hn::Sub(d0, error)), at_least_0(hn::Sub(d1, error)), L);
        // The distance to any set changes by at most L; to a convex one it is convex.
        V<Tag> far = hn::Max(d0, d1);
        Vec3v<Tag> center = e.v;
        V<Tag> radius = e.size;
        if constexpr (shape == Shape::segment) {
            const V<Tag> half = constant(d, 0.5);
            center = {hn::MulAdd(half, e.m.x, center.x), hn::MulAdd(half, e.m.y, center.y),
                      hn::MulAdd(half, e.m.z, center.z)};
            radius = hn::Mul(half, radius);
        } else {
            far = hn::Mul(constant(d, 0.5), hn::Add(hn::Add(d0, d1), hn::Set(d, L)));
        }
        const V<Tag> ball = hn::Sub(FromAxis<Tag>(center, s.axis).nearest(s.begin, s.end), radius);
        near = hn::Max(near, hn::Sub(ball, error));
        if constexpr (shape == Shape::segment && sizeof(Real) == sizeof(double)) {
            // |v . (axis x m)| / |axis x m|, unless they are nearly parallel
            const Vec3v<D> n{
                hn::Sub(hn::Mul(constant(s.axis.y), e.m.z), hn::Mul(constant(s.axis.z), e.m.y)),
                hn::Sub(hn::Mul(constant(s.axis.z), e.m.x), hn::Mul(constant(s.axis.x), e.m.z)),
                hn::Sub(hn::Mul(constant(s.axis.x), e.m.y), hn::Mul(constant(s.axis.y), e.m.x))};
            const V<D> n_square = dot<D>(n, n);
            const V<D> line = hn::Div(hn::Abs(dot<D>(e.v, n)), hn::Sqrt(n_square));
            const auto crosses = hn::Gt(n_square, hn::Mul(constant(0x1p-12), square_of(e.size)));
            near = hn::IfThenElse(
                crosses, hn::Max(near, hn::NegMulAdd(constant(0x1p-38), e.magnitude, line)), near);
        }
        return {at_least_0(hn::Sub(near, aside)),
                hn::Add(far, hn::Add(error, hn::Set(d, (s.t_offset + s.end) * s.spread * widened *
                                                           widened)))};
    }
}

#if HWY_TARGET == HWY_AVX3
HWY_INLINE V<F> compressed(V<F> x, __mmask16 mask) {
    return V<F>{_mm512_maskz_compress_ps(mask, x.raw)};
}
HWY_INLINE hn::Vec<hn::RebindToSigned<F>> compressed(hn::Vec<hn::RebindToSigned<F>> x,
                                                     __mmask16 mask) {
    return decltype(x){_mm512_maskz_compress_epi32(mask, x.raw)};
}
HWY_INLINE V<D> compressed(V<D> x, __mmask8 mask) {
    return V<D>{_mm512_maskz_compress_pd(mask, x.raw)};
}
HWY_INLINE hn::Vec<I> compressed(hn::Vec<I> x, __mmask8 mask) {
    return hn::Vec<I>{_mm512_maskz_compress_epi64(mask, x.raw)};
}
#endif

// Puts the lanes of a mask side by side, and whatever after them. Highway's own compression copies
// its tables to the stack at each call (version 1.0.3 with GCC 12).
template <class Tag>
class Kept {
  public:
    HWY_INLINE Kept(Tag d, M<Tag> mask) : mask_(mask), count_(hn::CountTrue(d, mask)) {
        if constexpr (by_bits) {
            std::uint8_t bytes[8] = {};
            hn::StoreMaskBits(d, mask, bytes);
            bits_ = bytes[0];
        }
    }
    [[nodiscard]] HWY_INLINE std::size_t count() const { return count_; }

    // Of any numbers as wide as the tag's.
    template <class Other>
    HWY_INLINE void put(Other d, V<Other> values, hn::TFromD<Other>* to) const {
        if constexpr (!by_bits) {
            hn::StoreU(compressed(values, mask_.raw), d, to);
        } else if constexpr (lanes == 8) {
            const hn::RebindToSigned<Other> di;
            const hn::Rebind<std::uint8_t, decltype(di)> narrow;
            const auto order = hn::PromoteTo(di, hn::LoadU(narrow, lanes_of_bits[bits_].data()));
            hn::StoreU(hn::TableLookupLanes(values, hn::IndicesFromVec(d, order)), d, to);
        } else {
            HWY_ALIGN hn::TFromD<Other> all[lanes];
            hn::Store(values, d, all);
            for (std::size_t k = 0, at = 0; k < lanes; ++k) {
                to[at] = all[k];
                at += bits_ >> k & 1;
            }
        }
    }

  private:
    static constexpr std::size_t lanes = hn::MaxLanes(Tag());
    static constexpr bool by_bits = lanes <= 8 && HWY_MAX_BYTES < 64;
    M<Tag> mask_;
    std::size_t count_;
    std::size_t bits_ = 0;
};

HWY_INLINE double sum_of(V<D> x) { return hn::GetLane(hn::SumOfLanes(D(), x)); }

// Each lane's sum is rounded as often as there are summands; the sum over lanes is not.
#if HWY_TARGET != HWY_SCALAR
HWY_INLINE double sum_of(V<F> x) {
    return sum_of(hn::PromoteTo(D(), hn::LowerHalf(x))) +
           sum_of(hn::PromoteTo(D(), hn::UpperHalf(hn::Half<F>(), x)));
}
#else
HWY_INLINE double sum_of(V<F> x) { return hn::GetLane(x); }
#endif

// The sums of peaks, lane by lane: of what is kept and of what is left out, apart what adds to the
// field and what takes away from it.
template <class Tag>
struct PeakLanes {
    V<Tag> above, magnitude, rest_above, rest_below;

    HWY_INLINE PeakLanes() { above = magnitude = rest_above = rest_below = hn::Zero(Tag()); }
    HWY_INLINE void add(M<Tag> keep, M<Tag> leave, V<Tag> adds, V<Tag> takes) {
        rest_above = hn::Add(rest_above, hn::IfThenElseZero(leave, adds));
        rest_below = hn::Add(rest_below, hn::IfThenElseZero(leave, takes));
        magnitude = hn::Add(magnitude, hn::IfThenElseZero(keep, hn::Add(adds, takes)));
        above = hn::Add(above, hn::IfThenElseZero(keep, adds));
    }
    // Of elements, which do either.
    HWY_INLINE void add(M<Tag> keep, M<Tag> leave, V<Tag> strength, V<Tag> value, Tag d) {
        const M<Tag> is_positive = hn::Gt(strength, hn::Zero(d));
        add(keep, leave, hn::IfThenElseZero(is_positive, value),
            hn::IfThenZeroElse(is_positive, value));
    }
    HWY_INLINE void add_to(PeakSums& sums) const {
        sums.above += sum_of(above);
        sums.magnitude += sum_of(magnitude);
        sums.rest_above += sum_of(rest_above);
        sums.rest_below += sum_of(rest_below);
    }
};

template <Shape shape, KernelKind kind>
void bound_group(const Field& field, const Stretch& stretch, double scale, double cut,
                 const ActiveElements& candidates, std::size_t first, std::size_t end,
                 ActiveElements& kept, std::size_t& count, PeakSums& sums) {
    const D d;
    const I di;
    const std::size_t N = hn::Lanes(d);
    const Reach<double> reach = reach_of(stretch);
    PeakLanes<D> peaks;
    for (std::size_t i = first; i < end; i += N) {
        const hn::Vec<I> index = hn::LoadU(di, &candidates.element[i]);
        const M<D> valid = hn::FirstN(d, end - i);
        const Seen<D, shape> e(field, stretch, scale, index);
        const DistanceRange<D> range = distances(e, reach, error_of(d, e.magnitude, reach));
        const V<D> least =
            hn::Mul(hn::Mul(square_of(range.near), e.inverse_square), constant(less));
        const V<D> peak = peak_of<kind>(d, least);
        const V<D> value = hn::Mul(hn::Mul(hn::Abs(e.strength), peak), constant(more));
        // not a number: kept
        const M<D> keep = hn::AndNot(hn::Le(value, constant(cut)), valid);
        peaks.add(keep, hn::AndNot(keep, valid), e.strength, value, d);
        const Kept<D> lanes(d, keep);
        lanes.put(di, index, &kept.element[count]);
        lanes.put(d, least, &kept.least[count]);
        if constexpr (shape != Shape::point) {
            const V<D> most =
                hn::Mul(hn::Mul(square_of(range.far), e.inverse_square), constant(more));
            lanes.put(d, most, &kept.most[count]);
        }
        lanes.put(d, peak, &kept.peak[count]);
        count += lanes.count();
    }
    peaks.add_to(sums);
}

// Calls visit.operator()<shape, kernel>(group).
template <class Visit>
HWY_INLINE void for_all_groups(const Visit& visit) {
    const auto kernels = [&]<Shape shape>() HWY_ATTR {
        visit.template operator()<shape, KernelKind::blinn>(group_of(shape, KernelKind::blinn));
        visit.template operator()<shape, KernelKind::nishimura>(
            group_of(shape, KernelKind::nishimura));
        visit.template operator()<shape, KernelKind::wyvill>(group_of(shape, KernelKind::wyvill));
    };
    kernels.template operator()<Shape::point>();
    kernels.template operator()<Shape::segment>();
    kernels.template operator()<Shape::circle>();
}

PeakSums bound(const Field& field, const Stretch& stretch, double scale, double cut,
               const ActiveElements& candidates, ActiveElements& kept) {
    kept.make_room(candidates.size());
    PeakSums sums;
    std::size_t count = 0;
    for_all_groups([&]<Shape shape, KernelKind kind>(std::size_t group) HWY_ATTR {
        kept.first[group] = static_cast<std::uint32_t>(count);
        const std::size_t first = candidates.first[group], end = candidates.first[group + 1];
        if (first == end) return;
        bound_group<shape, kind>(field, stretch, scale, cut, candidates, first, end, kept, count,
                                 sums);
    });
    kept.end(count);
    return sums;
}

template <KernelKind kind>
void bound_cluster_group(const Clusters& clusters, const Stretch& stretch, double scale, double cut,
                         const ActiveElements& candidates, std::size_t first, std::size_t end,
                         ActiveElements& kept, std::size_t& count, PeakSums& sums) {
    const D d;
    const I di;
    const std::size_t N = hn::Lanes(d);
    const Reach<double> reach = reach_of(stretch);
    PeakLanes<D> peaks;
    for (std::size_t i = first; i < end; i += N) {
        const hn::Vec<I> index = hn::LoadU(di, &candidates.element[i]);
        const M<D> valid = hn::FirstN(d, end - i);
        const auto column = [&](const std::vector<double>& values)
                                HWY_ATTR { return hn::GatherIndex(d, values.data(), index); };
        const Vec3v<D> v{hn::Sub(column(clusters.x), constant(stretch.origin.x)),
                         hn::Sub(column(clusters.y), constant(stretch.origin.y)),
                         hn::Sub(column(clusters.z), constant(stretch.origin.z))};
        const V<D> radius = column(clusters.radius);
        const V<D> size =
            hn::Mul(hn::Add(hn::Add(hn::Abs(v.x), hn::Abs(v.y)), hn::Add(hn::Abs(v.z), radius)),
                    constant(more));
        const V<D> off = hn::Add(aside_of(d, size, reach), error_of(d, size, reach));
        const V<D> nearest = FromAxis<D>(v, stretch.axis).nearest(stretch.begin, stretch.end);
        const V<D> near = at_least_0(hn::Sub(nearest, hn::Add(off, radius)));
        const V<D> least =
            hn::Mul(hn::Mul(square_of(near), column(clusters.inverse_square)), constant(less));
        const V<D> peak = hn::Mul(peak_of<kind>(d, least), constant(scale * more));
        const V<D> adds = hn::Mul(column(clusters.above), peak);
        const V<D> takes = hn::Mul(column(clusters.below), peak);
        const M<D> keep = hn::AndNot(hn::Le(hn::Add(adds, takes), constant(cut)), valid);
        peaks.add(keep, hn::AndNot(keep, valid), adds, takes);
        const Kept<D> lanes(d, keep);
        lanes.put(di, index, &kept.element[count]);
        count += lanes.count();
    }
    peaks.add_to(sums);
}

PeakSums bound_clusters(const Field& field, const Stretch& stretch, double scale, double cut,
                        const ActiveElements& candidates, ActiveElements& kept) {
    kept.make_room(candidates.size());
    PeakSums sums;
    std::size_t count = 0;
    for_all_groups([&]<Shape shape, KernelKind kind>(std::size_t group) HWY_ATTR {
        kept.first[group] = static_cast<std::uint32_t>(count);
        const std::size_t first = candidates.first[group], end = candidates.first[group + 1];
        if (first == end) return;
        bound_cluster_group<kind>(field.clusters, stretch, scale, cut, candidates, first, end, kept,
                                  count, sums);
    });
    kept.end(count);
    return sums;
}

// rise: an upper bound of w^2 (k'' s'^2 + k' s'') for all rays on the stretch; fall: of its
// negative.
template <class Tag>
struct Bend {
    V<Tag> rise, fall;
};

template <KernelKind kind, class Tag, Shape shape>
HWY_INLINE Bend<Tag> bend_of(const Seen<Tag, shape>& e, const Reach<hn::TFromD<Tag>>& s,
                             V<Tag> error, V<Tag> least, V<Tag> most, V<Tag> peak, V<Tag> outward) {
    using Real = hn::TFromD<Tag>;
    using Margin = Margins<Real>;
    const Tag d;
    const V<Tag> zero = hn::Zero(d), one = constant(d, 1), two = constant(d, 2);
    const V<Tag> widened = hn::Set(d, Margin::more), reduced = hn::Set(d, Margin::less);
    if constexpr (kind == KernelKind::blinn) {
        // 2 e^-s (2 x^2 - 1 + outward), with y = x^2 at most s; for a point s = y + h^2.
        V<Tag> y0 = least, y1 = most, h_square = zero, fall = hn::Mul(two, peak);
        if constexpr (shape == Shape::point) {
            const FromAxis<Tag> c(e.v, s.axis);
            const V<Tag> across = hn::Sqrt(c.across_square);
            const V<Tag> offset = hn::Set(d, s.t_offset);
            const V<Tag> spread = hn::Set(d, s.spread * Margin::more);
            const V<Tag> turn = hn::Mul(hn::Add(offset, e.magnitude), spread);
            const V<Tag> h = at_least_0(hn::Sub(hn::Sub(across, turn), error));
            h_square = hn::Mul(hn::Mul(square_of(h), e.inverse_square), reduced);
            const V<Tag> slip = hn::Mul(
                hn::MulAdd(hn::Add(offset, hn::Abs(c.along)), hn::Set(d, s.spread * s.spread),
                           hn::MulAdd(across, spread, error)),
                widened);
            const V<Tag> x0 = hn::Sub(hn::Sub(hn::Set(d, s.begin), c.along), slip);
            const V<Tag> x1 = hn::Add(hn::Sub(hn::Set(d, s.end), c.along), slip);
            const V<Tag> near = at_least_0(hn::Max(x0, hn::Neg(x1)));
            const V<Tag> far = hn::Max(hn::Abs(x0), hn::Abs(x1));
            y0 = hn::Mul(hn::Mul(square_of(near), e.inverse_square), reduced);
            y1 = hn::Mul(hn::Mul(square_of(far), e.inverse_square), widened);
            fall = hn::Mul(hn::MulAdd(two, at_least_0(hn::NegMulAdd(two, y0, one)),
                                      hn::Set(d, Margin::margin)),
                           peak);
        }
        // (2 y - 1) e^-y rises up to 1.5
        const V<Tag> y = hn::Max(y0, hn::Min(y1, constant(d, 1.5)));
        const V<Tag> steep =
            hn::Mul(hn::Mul(two, hn::MulSub(two, y, one)), peak_of<kind>(d, hn::Add(y, h_square)));
        V<Tag> rise = hn::IfThenElseZero(hn::Gt(y, constant(d, 0.5)), hn::Mul(steep, widened));
        // |d|^2 is 1 but for 2^-49
        rise = hn::MulAdd(hn::MulAdd(two, outward, hn::Set(d, Margin::margin)), peak, rise);
        return {rise, fall};
    } else {
        // 4 x^2 k'' - 2 (1 - outward) |k'| with x^2 <= s.
        const V<Tag> slope = steepest<kind>(d, least);
        V<Tag> greatest;  // of 4 s k''
        if constexpr (kind == KernelKind::wyvill) {
            // 4 s (34 - 24 s) / 9 falls from 17 / 24 on
            const V<Tag> s_worst = hn::Max(least, constant(d, 17.0 / 24));
            greatest = hn::Mul(hn::Mul(constant(d, 4.0 / 9), s_worst),
                               hn::NegMulAdd(constant(d, 24), s_worst, constant(d, 34)));
        } else {
            // 4 s 3/4 / q^3
            greatest = hn::Div(constant(d, 3), hn::Sqrt(hn::Max(least, constant(d, 1.0 / 9))));
        }
        const V<Tag> inward = hn::Mul(hn::Mul(two, at_least_0(hn::Sub(outward, one))), slope);
        const M<Tag> reaches = hn::Lt(least, one);
        return {hn::IfThenElseZero(reaches, hn::Mul(hn::Add(greatest, inward), widened)),
                hn::IfThenElseZero(reaches, hn::Mul(hn::Mul(two, slope), widened))};
    }
}

template <class Tag>
struct BendLanes {
    V<Tag> rise, fall, kinks;
};

// Adds the bends of some elements; returns the circles' bound of 1 / rho.
template <KernelKind kind, class Tag, Shape shape>
HWY_INLINE V<Tag> add_bends(const Seen<Tag, shape>& e, const Reach<hn::TFromD<Tag>>& s,
                            M<Tag> valid, V<Tag> least, V<Tag> most, V<Tag> peak,
                            BendLanes<Tag>& sums) {
    using Real = hn::TFromD<Tag>;
    using Margin = Margins<Real>;
    const Tag d;
    const V<Tag> zero = hn::Zero(d);
    const V<Tag> error = error_of(d, e.magnitude, s);
    M<Tag> smooth = valid;
    V<Tag> inverse = zero, outward = zero;  // 1 / rho, r / rho
    if constexpr (shape == Shape::circle) {
        // s'' w^2 / 2 = 1 - r rho'' lies in 1 - r / rho .. 1.
        const V<Tag> rho0 = e.rho(s.axis, s.begin), rho1 = e.rho(s.axis, s.end);
        const Real aside = (s.t_offset + s.end) * s.spread * Margin::more * Margin::more;
        const V<Tag> rho = hn::Sub(
            least_between(d, at_least_0(hn::Sub(rho0, error)), at_least_0(hn::Sub(rho1, error)),
                          (s.end - s.begin) * Margin::more),
            hn::Set(d, aside));
        const V<Tag> unrounded = hn::Div(constant(d, 1), rho);
        const M<Tag> bounded = hn::And(
            hn::Gt(rho, zero), hn::Lt(hn::Mul(e.extra, unrounded), constant(d, greatest_outward)));
        const M<Tag> is_point = hn::Eq(e.extra, zero);
        inverse =
            hn::IfThenElse(bounded, hn::Mul(unrounded, hn::Set(d, Margin::more)), constant(d, -1));
        inverse = hn::IfThenZeroElse(is_point, inverse);
        smooth = hn::And(smooth, hn::Ge(inverse, zero));
        outward = hn::Mul(hn::Mul(e.extra, at_least_0(inverse)), hn::Set(d, Margin::more));
        // no f'' is known of the others
        const V<Tag> slope = hn::Mul(
            hn::Mul(hn::Abs(e.strength), hn::Sqrt(e.inverse_square)),
            hn::Mul(hn::Set(d, 2 * Margin::more * Margin::more), slope_of<kind>(d, least, peak)));
        sums.kinks = hn::Add(sums.kinks, hn::IfThenElseZero(hn::AndNot(smooth, valid), slope));
    }
    const Bend<Tag> bend = bend_of<kind>(e, s, error, least, most, peak, outward);
    const M<Tag> adds = hn::Gt(e.strength, zero);
    const V<Tag> weight = hn::IfThenElseZero(
        smooth, hn::Mul(hn::Mul(hn::Abs(e.strength), e.inverse_square), hn::Set(d, Margin::more)));
    sums.rise = hn::MulAdd(hn::IfThenElse(adds, bend.rise, bend.fall), weight, sums.rise);
    sums.fall = hn::MulAdd(hn::IfThenElse(adds, bend.fall, bend.rise), weight, sums.fall);
    return inverse;
}

template <class Tag>
HWY_INLINE void add_up(const BendLanes<Tag>& lanes, BendSums& sums) {
    sums.rise += sum_of(lanes.rise);
    sums.fall += sum_of(lanes.fall);
    sums.kinks += sum_of(lanes.kinks);
}

template <Shape shape, KernelKind kind>
void bend_group(const Field& field, const Stretch& stretch, double scale, ActiveElements& active,
                std::size_t first, std::size_t end, BendSums& sums) {
    const D d;
    const I di;
    const Reach<double> reach = reach_of(stretch);
    BendLanes<D> lanes{hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    for (std::size_t i = first; i < end; i += hn::Lanes(d)) {
        const Seen<D, shape> e(field, stretch, scale, hn::LoadU(di, &active.element[i]));
        const V<D> inverse =
            add_bends<kind>(e, reach, hn::FirstN(d, end - i), hn::LoadU(d, &active.least[i]),
                            hn::LoadU(d, &active.most[i]), hn::LoadU(d, &active.peak[i]), lanes);
        // of elements that are no circles 0, those of the next group follow
        hn::StoreU(inverse, d, &active.inverse[i]);
    }
    add_up(lanes, sums);
}

BendSums bend(const Field& field, const Stretch& stretch, double scale, ActiveElements& active) {
    BendSums sums;
    for_all_groups([&]<Shape shape, KernelKind kind>(std::size_t group) HWY_ATTR {
        const std::size_t first = active.first[group], end = active.first[group + 1];
        if (first == end) return;
        bend_group<shape, kind>(field, stretch, scale, active, first, end, sums);
    });
    return sums;
}

// (o - c) + t d of core/math/offset.h, whose proof wants products without error.
HWY_INLINE V<D> offset_lanes(double o, V<D> c, double t, double direction) {
#if HWY_NATIVE_FMA
    const V<D> origin = constant(o);
    const V<D> difference = hn::Sub(origin, c);
    const V<D> back = hn::Sub(difference, origin);
    const V<D> difference_low =
        hn::Sub(hn::Sub(origin, hn::Sub(difference, back)), hn::Add(c, back));
    const double product = t * direction;
    const V<D> product_low = constant(std::fma(t, direction, -product));
    const V<D> sum = hn::Add(difference, constant(product));
    const V<D> sum_back = hn::Sub(sum, difference);
    const V<D> sum_low =
        hn::Add(hn::Sub(constant(product), sum_back), hn::Sub(difference, hn::Sub(sum, sum_back)));
    return hn::Add(sum, hn::Add(sum_low, hn::Add(difference_low, product_low)));
#else
    const D d;
    HWY_ALIGN double lane[HWY_MAX_BYTES / sizeof(double)];
    hn::Store(c, d, lane);
    for (std::size_t k = 0; k < hn::Lanes(d); ++k) lane[k] = offset(o, lane[k], t, direction);
    return hn::Load(d, lane);
#endif
}

void place_near(const Field& field, const Stretch& bundle, double middle, NearElements& near) {
    const D d;
    const I di;
    const hn::Rebind<float, D> narrow;
    const hn::Rebind<std::int32_t, D> narrow_index;
    const V<D> outward = constant(-1 / field.unit);
    // Vectors are read whole: what stands beyond the last element may be of another field.
    std::fill_n(near.element.begin() + static_cast<std::ptrdiff_t>(near.size()), hn::Lanes(d), 0);
    for (std::size_t i = 0; i < near.size(); i += hn::Lanes(d)) {
        const hn::Vec<I> index = hn::PromoteTo(di, hn::LoadU(narrow_index, &near.element[i]));
        const auto place = [&](double o, const std::vector<double>& c, double axis,
                               std::vector<float>& values) HWY_ATTR {
            const V<D> from = offset_lanes(o, hn::GatherIndex(d, c.data(), index), middle, axis);
            hn::StoreU(hn::DemoteTo(narrow, hn::Mul(from, outward)), narrow, &values[i]);
        };
        place(bundle.origin.x, field.ax, bundle.axis.x, near.x);
        place(bundle.origin.y, field.ay, bundle.axis.y, near.y);
        place(bundle.origin.z, field.az, bundle.axis.z, near.z);
    }
    near.magnitude = 0;
}

// The elements of a list as floats, but for their places.
template <Shape shape>
void near_group(const Field& field, const ActiveElements& active, std::size_t first,
                std::size_t end, NearElements& near) {
    const D d;
    const I di;
    const hn::Rebind<float, D> narrow;
    const double unit = field.unit, per_unit = 1 / unit;
    for (std::size_t i = first; i < end; i += hn::Lanes(d)) {
        const hn::Vec<I> index = hn::LoadU(di, &active.element[i]);
        const auto column = [&](const std::vector<double>& values)
                                HWY_ATTR { return hn::GatherIndex(d, values.data(), index); };
        const auto put = [&](V<D> x, std::vector<float>& to)
                             HWY_ATTR { hn::StoreU(hn::DemoteTo(narrow, x), narrow, &to[i]); };
        put(hn::Mul(column(field.strength), constant(field.scale)), near.strength);
        put(hn::Mul(column(field.inverse_square), constant(unit * unit)), near.inverse_square);
        if constexpr (shape == Shape::segment) {
            put(hn::Mul(column(field.mx), constant(per_unit)), near.mx);
            put(hn::Mul(column(field.my), constant(per_unit)), near.my);
            put(hn::Mul(column(field.mz), constant(per_unit)), near.mz);
            put(hn::Min(hn::Mul(column(field.extra), constant(unit * unit)), constant(1e30)),
                near.extra);
            put(hn::Mul(column(field.length), constant(per_unit)), near.length);
        } else if constexpr (shape == Shape::circle) {
            put(column(field.mx), near.mx);
            put(column(field.my), near.my);
            put(column(field.mz), near.mz);
            put(hn::Mul(column(field.extra), constant(per_unit)), near.extra);
        }
        put(hn::Mul(hn::LoadU(d, &active.least[i]), constant(1 - 0x1p-22)), near.least);
        put(hn::Mul(hn::LoadU(d, &active.most[i]), constant(1 + 0x1p-22)), near.most);
        put(hn::MulAdd(hn::LoadU(d, &active.peak[i]), constant(1 + 0x1p-22), constant(1e-37)),
            near.peak);
        for (std::size_t k = i; k < i + hn::Lanes(d); ++k) {
            near.element[k] = static_cast<std::int32_t>(active.element[k]);
        }
    }
}

void enter_near(const Field& field, const Stretch& bundle, double middle,
                const ActiveElements& active, NearElements& near) {
    near.make_room(active.size());
    near.first = active.first;
    for_all_groups([&]<Shape shape, KernelKind kind>(std::size_t group) HWY_ATTR {
        const std::size_t first = active.first[group], end = active.first[group + 1];
        if (first == end) return;
        near_group<shape>(field, active, first, end, near);
    });
    place_near(field, bundle, middle, near);
}

// The valid ones from `first` on; their places, less `place`, are those of `candidates`.
template <Shape shape, KernelKind kind>
HWY_INLINE void bound_near_lanes(const NearElements& candidates, std::size_t first, M<F> valid,
                                 const Reach<float>& reach, const Vec3<float>& place, float cut,
                                 NearElements* kept, std::size_t& count, PeakLanes<F>& peaks) {
    const F d;
    const hn::RebindToSigned<F> di;
    const V<F> widened = hn::Set(d, Margins<float>::more),
               reduced = hn::Set(d, Margins<float>::less);
    const Seen<F, shape> e(candidates, reach, first);
    const DistanceRange<F> range = distances(e, reach, error_of(d, e.magnitude, reach));
    const V<F> least = hn::Mul(hn::Mul(square_of(range.near), e.inverse_square), reduced);
    const V<F> peak = peak_of<kind>(d, least);
    const V<F> value = hn::Mul(hn::Mul(hn::Abs(e.strength), peak), widened);
    // not a number: kept
    const M<F> keep = hn::AndNot(hn::Le(value, hn::Set(d, cut)), valid);
    peaks.add(keep, hn::AndNot(keep, valid), e.strength, value, d);
    if (kept == nullptr) return;
    const Kept<F> lanes(d, keep);
    if (lanes.count() == 0) return;
    const auto put = [&](V<F> x, std::vector<float>& to) HWY_ATTR { lanes.put(d, x, &to[count]); };
    const auto move =
        [&](const std::vector<float>& from, float by, std::vector<float>& to)
            HWY_ATTR { put(hn::Add(hn::LoadU(d, &from[first]), hn::Set(d, by)), to); };
    move(candidates.x, place.x, kept->x);
    move(candidates.y, place.y, kept->y);
    move(candidates.z, place.z, kept->z);
    put(e.strength, kept->strength);
    put(e.inverse_square, kept->inverse_square);
    if constexpr (shape != Shape::point) {
        put(e.m.x, kept->mx);
        put(e.m.y, kept->my);
        put(e.m.z, kept->mz);
        put(e.extra, kept->extra);
        if constexpr (shape == Shape::segment) put(e.size, kept->length);
        put(hn::Mul(hn::Mul(square_of(range.far), e.inverse_square), widened), kept->most);
    }
    put(least, kept->least);
    put(peak, kept->peak);
    lanes.put(di, hn::LoadU(di, &candidates.element[first]), &kept->element[count]);
    count += lanes.count();
}

template <Shape shape, KernelKind kind>
void bound_near_group(const NearElements& candidates, const NearStretch& stretch, float cut,
                      std::size_t first, std::size_t end, NearElements& kept, std::size_t& count,
                      PeakSums& sums) {
    const F d;
    const Reach<float> reach = reach_of(stretch, candidates);
    PeakLanes<F> peaks;
    for (std::size_t i = first; i < end; i += hn::Lanes(d)) {
        bound_near_lanes<shape, kind>(candidates, i, hn::FirstN(d, end - i), reach, {}, cut, &kept,
                                      count, peaks);
    }
    peaks.add_to(sums);
}

PeakSums bound_near(const NearElements& candidates, const NearStretch& stretch, double cut,
                    NearElements& kept) {
    kept.make_room(candidates.size());
    kept.magnitude = candidates.magnitude;
    PeakSums sums;
    std::size_t count = 0;
    for_all_groups([&]<Shape shape, KernelKind kind>(std::size_t group) HWY_ATTR {
        kept.first[group] = static_cast<std::uint32_t>(count);
        const std::size_t first = candidates.first[group], end = candidates.first[group + 1];
        if (first == end) return;
        bound_near_group<shape, kind>(candidates, stretch, static_cast<float>(cut), first, end,
                                      kept, count, sums);
    });
    kept.first[field_groups] = static_cast<std::uint32_t>(count);
    return sums;
}

// A cluster's centre in double is off by 2^-50 of its distance from the origin; its members are as
// far from it as they say, to 2^-24 of its radius. Moved by its centre, rounded, and rounded once
// more they are off by less than 2^-23 of both together.
template <Shape shape, KernelKind kind>
void bound_member_group(const Field& field, const Stretch& bundle, double middle,
                        const NearStretch& stretch, float cut, const ActiveElements& active,
                        std::size_t first, std::size_t end, NearElements* kept, std::size_t& count,
                        PeakSums& sums) {
    const F d;
    const Clusters& clusters = field.clusters;
    const Reach<float> reach = reach_of(stretch);
    const double per_unit = 1 / field.unit;
    const auto place = [&](double center, double origin, double axis) {
        return static_cast<float>(((center - origin) - middle * axis) * per_unit);
    };
    PeakLanes<F> peaks;
    for (std::size_t i = first; i < end; ++i) {
        const auto cluster = static_cast<std::size_t>(active.element[i]);
        const Vec3<float> center{place(clusters.x[cluster], bundle.origin.x, bundle.axis.x),
                                 place(clusters.y[cluster], bundle.origin.y, bundle.axis.y),
                                 place(clusters.z[cluster], bundle.origin.z, bundle.axis.z)};
        Reach<float> from_center = reach;
        from_center.base = reach.base - center;
        const float aside = std::abs(center.x) + std::abs(center.y) + std::abs(center.z);
        from_center.magnitude += aside + reach.t_offset * 0x1p-30F;
        const std::size_t before = count;
        const std::size_t last = clusters.first[cluster + 1];
        for (std::size_t e = clusters.first[cluster]; e < last; e += hn::Lanes(d)) {
            bound_near_lanes<shape, kind>(clusters.members, e, hn::FirstN(d, last - e), from_center,
                                          center, cut, kept, count, peaks);
        }
        if (count > before) {
            kept->magnitude = std::fmax(
                kept->magnitude, aside + static_cast<float>(clusters.radius[cluster] * per_unit) +
                                     reach.t_offset * 0x1p-26F);
        }
    }
    peaks.add_to(sums);
}

PeakSums bound_members(const Field& field, const Stretch& bundle, double middle,
                       const NearStretch& stretch, double cut, const ActiveElements& clusters,
                       NearElements* kept) {
    if (kept != nullptr) {
        kept->make_room(clusters.size() * cluster_size);
        kept->magnitude = 0;
    }
    PeakSums sums;
    std::size_t count = 0;
    for_all_groups([&]<Shape shape, KernelKind kind>(std::size_t group) HWY_ATTR {
        if (kept != nullptr) kept->first[group] = static_cast<std::uint32_t>(count);
        const std::size_t first = clusters.first[group], end = clusters.first[group + 1];
        if (first == end) return;
        bound_member_group<shape, kind>(field, bundle, middle, stretch, static_cast<float>(cut),
                                        clusters, first, end, kept, count, sums);
    });
    if (kept != nullptr) kept->first[field_groups] = static_cast<std::uint32_t>(count);
    return sums;
}

template <Shape shape, KernelKind kind>
void bend_near_group(NearElements& near, const Reach<float>& reach, std::size_t first,
                     std::size_t end, BendSums& sums) {
    const F d;
    BendLanes<F> lanes{hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    for (std::size_t i = first; i < end; i += hn::Lanes(d)) {
        const Seen<F, shape> e(near, reach, i);
        const V<F> inverse =
            add_bends<kind>(e, reach, hn::FirstN(d, end - i), hn::LoadU(d, &near.least[i]),
                            hn::LoadU(d, &near.most[i]), hn::LoadU(d, &near.peak[i]), lanes);
        hn::StoreU(inverse, d, &near.inverse[i]);
    }
    add_up(lanes, sums);
}

BendSums bend_near(NearElements& near, const NearStretch& stretch) {
    BendSums sums;
    const Reach<float> reach = reach_of(stretch, near);
    for_all_groups([&]<Shape shape, KernelKind kind>(std::size_t group) HWY_ATTR {
        const std::size_t first = near.first[group], end = near.first[group + 1];
        if (first == end) return;
        bend_near_group<shape, kind>(near, reach, first, end, sums);
    });
    return sums;
}

// Rounding errors of one entry, with u the unit roundoff of its stage, eta < 5e-4 the error of
// `away` and eta_slope that of its direction, both in widths. Blinn's: the computed s is off by
//     ds <= 2 sqrt(s) eta + eta^2 + 9 u s,
// five roundings of the square, one of 1 / w^2 and two of 1 / ln 2; 2^-x adds 2 u, so that with
// e^ds <= 1.02 |dk| <= 1.02 e^-s (ds + 2 u). (For s in the hundreds e^ds is larger, but then
// e^-(s - least) or e^-s itself leaves nothing to bound.) Now e^-s s^(j/2) <= peak r^j for j = 1,
// 2, 3, with r the lesser of
//     the greatest sqrt(s) on the stretch,
//     sqrt(least) + 1, since sqrt(s) <= sqrt(least) + sqrt(s - least) and the suprema of y^(j/2)
//         e^-y are 0.43, 0.37, 0.41.
// Hence
//     |dF|  <= |b| peak (eta (2.1 r + 1e-3) + u (10 r^2 + 4)),
//     |dF'| <= 2 |b| / w peak (eta_slope (2.1 r^2 + 1.1) + u r (10 r^2 + 16)),
// with one more rounding, of b, in the first; the second from |d(k x)| <= |dk| sqrt(s) + 1.02 k
// (eta_slope + 5 u sqrt(s)), eta <= eta_slope, and up to six more roundings. The other kernels:
// |k'| <= 3, |k''| <= 20.25, s <= 1 where k is not 0, and ten roundings.
template <class Tag>
struct EntryErrors {
    V<Tag> value, slope;
};

template <KernelKind kind, class Tag>
HWY_INLINE EntryErrors<Tag> errors_of(Tag d, double u, const EntryErrors<Tag>& eta, V<Tag> least,
                                      V<Tag> greatest_root, V<Tag> peak) {
    const auto c = [&](double value) HWY_ATTR { return constant(d, value); };
    if constexpr (kind == KernelKind::blinn) {
        const V<Tag> r = hn::Min(hn::Add(hn::Sqrt(least), c(1)), greatest_root);
        const V<Tag> square = hn::Mul(r, r);
        const V<Tag> of_value = hn::Mul(c(u), hn::MulAdd(c(10), square, c(4)));
        const V<Tag> of_slope = hn::Mul(hn::Mul(c(u), r), hn::MulAdd(c(10), square, c(16)));
        return {hn::Mul(peak, hn::MulAdd(eta.value, hn::MulAdd(c(2.1), r, c(1e-3)), of_value)),
                hn::Mul(peak, hn::MulAdd(eta.slope, hn::MulAdd(c(2.1), square, c(1.1)), of_slope))};
    }
    return {hn::MulAdd(c(8), eta.value, c(60 * u)), hn::MulAdd(c(60), eta.slope, c(300 * u))};
}

// A window as its entries see it, in their lengths.
struct Entering {
    double u;     // unit roundoff of the stage
    double unit;  // of the entries' lengths, in those of the elements
    double H;     // the greatest |t - middle| + t |d - axis|
    double end;   // the greatest t
    // c - M is known to 2 u of itself and this.
    double place_error;
    double least_rho;
};

// |away| as computed is off by `eta` in widths. With t |d - axis| and |t - middle| at most H, (2)
// costs 7 u H for p (d - axis, the product; t - middle, d, the product; the sum), 2 u |c - M| and
// u^2 of its terms for c, and u (H + |c - M|) the difference. The foot moves away by 10 u |p - c|
// more at the most; so does the circle's axis, whose rho and 1 / rho are off by 6 u, and rho by
// `least_rho` below which it does not come. A segment whose 1 / |m|^2 counts as 0 stands for its
// end a.
template <Shape shape, class Tag>
HWY_INLINE EntryErrors<Tag> etas(Tag d, const Entering& on, const Seen<Tag, shape>& e,
                                 V<Tag> c_length, V<Tag> inverse, V<Tag> inverse_width) {
    const auto c = [&](double value) HWY_ATTR { return constant(d, value); };
    const double u = on.u;
    const V<Tag> v_length = hn::Add(c(on.H), c_length);
    V<Tag> eta = hn::MulAdd(c(4 * u), c_length, c(8 * u * on.H + on.place_error));
    eta = hn::MulAdd(hn::Add(e.magnitude, c(on.end)), c(0x1p-98), eta);
    V<Tag> eta_slope = hn::Zero(d);
    if constexpr (shape == Shape::segment) {
        eta = hn::MulAdd(c(2), eta, hn::MulAdd(c(12 * u), v_length, hn::Mul(c(3 * u), e.size)));
        eta = hn::Add(eta, hn::IfThenElseZero(hn::Eq(e.extra, hn::Zero(d)), e.size));
    } else if constexpr (shape == Shape::circle) {
        eta = hn::MulAdd(c(3), eta, hn::MulAdd(c(24 * u), v_length, hn::Mul(c(10 * u), e.extra)));
        eta = hn::Add(eta, c(on.least_rho));
        eta_slope = hn::Mul(hn::Mul(e.extra, at_least_0(inverse)),
                            hn::MulAdd(c(4), eta, hn::Mul(c(24 * u), v_length)));
    }
    const V<Tag> scale = hn::Mul(inverse_width, hn::Set(d, Margins<hn::TFromD<Tag>>::more));
    return {hn::Mul(eta, scale), hn::Mul(hn::Add(eta, eta_slope), scale)};
}

// What is known of some elements of a group when they enter a window.
template <class Tag, Shape shape>
struct Arrivals {
    Seen<Tag, shape> e;
    Vec3v<Tag> place;                                  // c - M
    V<Tag> inverse_width, least, most, peak, inverse;  // most: not of points
};

// The greatest sqrt(s) on the stretch: no place of it is farther from M than H.
template <Shape shape, class Tag>
HWY_INLINE V<Tag> greatest_root(Tag d, const Entering& on, const Arrivals<Tag, shape>& arrivals,
                                V<Tag> c_length) {
    if constexpr (shape != Shape::point) return hn::Sqrt(arrivals.most);
    const V<Tag> farthest = hn::Add(c_length, constant(d, on.H + on.place_error));
    return hn::Mul(hn::Mul(farthest, arrivals.inverse_width),
                   hn::Set(d, Margins<hn::TFromD<Tag>>::more));
}

// From the field, in double.
template <Shape shape>
struct FieldArrivals {
    using Lanes = D;
    const Field& field;
    const Stretch& stretch;
    double scale, middle;
    const ActiveElements& active;

    HWY_INLINE Arrivals<D, shape> at(std::size_t i) const {
        const D d;
        const hn::Vec<I> index = hn::LoadU(I(), &active.element[i]);
        const auto place = [&](double o, const std::vector<double>& c, double axis) HWY_ATTR {
            return hn::Neg(offset_lanes(o, hn::GatherIndex(d, c.data(), index), middle, axis));
        };
        return {Seen<D, shape>(field, stretch, scale, index),
                {place(stretch.origin.x, field.ax, stretch.axis.x),
                 place(stretch.origin.y, field.ay, stretch.axis.y),
                 place(stretch.origin.z, field.az, stretch.axis.z)},
                hn::GatherIndex(d, field.inverse_width.data(), index),
                hn::LoadU(d, &active.least[i]),
                hn::LoadU(d, &active.most[i]),
                hn::LoadU(d, &active.peak[i]),
                hn::LoadU(d, &active.inverse[i])};
    }
    [[nodiscard]] std::uint32_t element(std::size_t i) const {
        return static_cast<std::uint32_t>(active.element[i]);
    }
};

// From elements in float; `middle` is the window's, relative to the same place.
template <Shape shape>
struct NearArrivals {
    using Lanes = F;
    const NearElements& near;
    Reach<float> reach;
    Vec3<float> middle;

    HWY_INLINE Arrivals<F, shape> at(std::size_t i) const {
        const F d;
        const auto place = [&](const std::vector<float>& c, float from)
                               HWY_ATTR { return hn::Sub(hn::LoadU(d, &c[i]), hn::Set(d, from)); };
        const Seen<F, shape> e(near, reach, i);
        return {e,
                {place(near.x, middle.x), place(near.y, middle.y), place(near.z, middle.z)},
                hn::Sqrt(e.inverse_square),
                hn::LoadU(d, &near.least[i]),
                hn::LoadU(d, &near.most[i]),
                hn::LoadU(d, &near.peak[i]),
                hn::LoadU(d, &near.inverse[i])};
    }
    [[nodiscard]] std::uint32_t element(std::size_t i) const {
        return static_cast<std::uint32_t>(near.element[i]);
    }
    // Those of i .. that the bits name join others.
    void leave(std::size_t i, std::uint32_t bits, double unit, ActiveElements& others) const {
        for (; bits != 0; bits &= bits - 1) {
            others.take(near, i + static_cast<std::size_t>(std::countr_zero(bits)), unit);
        }
    }
};

template <class Tag>
HWY_INLINE std::uint32_t lane_bits(Tag d, M<Tag> mask) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, mask, bytes);
    return bytes[0] | std::uint32_t{bytes[1]} << 8;
}

// Where elements go that have peaks above the cut of the strong ones: they enter `strong`, or are
// of another stage.
template <class Real>
struct StrongOnes {
    StageEntries<Real>* entries = nullptr;
    ActiveElements* others = nullptr;
    double unit = 1;  // of the others
};

// Some elements of one stage of a window: the strong ones, and others with peaks above the second
// cut, which enter `weak`. In float lengths are in units.
template <class Real, Shape shape, KernelKind kind, class Source>
void enter_group(const Source& source, const Entering& on, const CoarseCuts& cuts,
                 std::size_t first, std::size_t end, const StrongOnes<Real>& strong,
                 StageEntries<Real>* weak, StageSums& sums) {
    using Tag = typename Source::Lanes;
    constexpr bool is_coarse = sizeof(Real) == sizeof(float);
    constexpr std::size_t lanes_at_most = hn::MaxLanes(Tag());
    const Tag d;
    const std::size_t N = hn::Lanes(d);
    const V<Tag> zero = hn::Zero(d);
    const auto c = [&](double value) HWY_ATTR { return constant(d, value); };
    const V<Tag> widened = hn::Set(d, Margins<hn::TFromD<Tag>>::more);
    V<Tag> error = zero, slope = zero, magnitude = zero, full_slope = zero;
    V<Tag> rest_above = zero, rest_below = zero;
    V<Tag> weak_above = zero, weak_below = zero, weak_slope = zero;
    M<Tag> bad = hn::FirstN(d, 0);
    alignas(64) Real quads[3][4 * lanes_at_most];  // of each lane, side by side
    const std::size_t strong_before = strong.entries != nullptr ? strong.entries->size : 0,
                      weak_before = weak != nullptr ? weak->size : 0;
    if (strong.entries != nullptr) strong.entries->make_room(end - first);
    if (weak != nullptr) weak->make_room(end - first);
    for (std::size_t i = first; i < end; i += N) {
        M<Tag> valid = hn::FirstN(d, end - i);
        const Arrivals<Tag, shape> arrivals = source.at(i);
        const Seen<Tag, shape>& e = arrivals.e;
        const M<Tag> kinked = hn::Lt(arrivals.inverse, zero);
        const V<Tag> strength = hn::Abs(e.strength);
        const V<Tag> value = hn::Mul(hn::Mul(strength, arrivals.peak), widened);
        const V<Tag> per_length =
            hn::Mul(hn::Mul(hn::Add(widened, widened), strength), arrivals.inverse_width);
        const V<Tag> whole = hn::Mul(per_length, slope_of<kind>(d, arrivals.least, arrivals.peak));
        const V<Tag> c_length = hn::Mul(length_of(d, arrivals.place), widened);
        const EntryErrors<Tag> eta =
            etas<shape>(d, on, e, c_length, arrivals.inverse, arrivals.inverse_width);
        const EntryErrors<Tag> off =
            errors_of<kind>(d, on.u, eta, arrivals.least,
                            greatest_root<shape>(d, on, arrivals, c_length), arrivals.peak);

        M<Tag> is_strong = valid, enters = valid;
        if constexpr (is_coarse) {
            is_strong = hn::AndNot(hn::Le(value, c(cuts.strong)), valid);
            if constexpr (sizeof(hn::TFromD<Tag>) == sizeof(float)) {
                if (strong.others != nullptr) {
                    source.leave(i, lane_bits(d, is_strong), strong.unit, *strong.others);
                    valid = hn::AndNot(is_strong, valid);
                }
            }
            enters = hn::AndNot(hn::Le(value, c(cuts.weak)), valid);
        }
        const M<Tag> leaves = hn::AndNot(enters, valid);
        const M<Tag> adds = hn::Gt(e.strength, zero);
        const V<Tag> left = hn::IfThenElseZero(leaves, value);
        rest_above = hn::Add(rest_above, hn::IfThenElseZero(adds, left));
        rest_below = hn::Add(rest_below, hn::IfThenZeroElse(adds, left));
        full_slope = hn::Add(full_slope, hn::IfThenElseZero(valid, whole));
        const V<Tag> slope_off =
            hn::IfThenElse(hn::Or(kinked, leaves), whole, hn::Mul(per_length, off.slope));
        slope = hn::Add(slope, hn::IfThenElseZero(valid, slope_off));
        error = hn::Add(error, hn::IfThenElseZero(enters, hn::Mul(strength, off.value)));
        magnitude = hn::Add(magnitude, hn::IfThenElseZero(enters, value));
        const M<Tag> is_weak = hn::AndNot(is_strong, enters);
        if constexpr (is_coarse) {
            const V<Tag> part = hn::IfThenElseZero(is_weak, value);
            weak_above = hn::Add(weak_above, hn::IfThenElseZero(adds, part));
            weak_below = hn::Add(weak_below, hn::IfThenZeroElse(adds, part));
            weak_slope = hn::Add(weak_slope, hn::IfThenElseZero(is_weak, whole));
        }

        const V<Tag> per_unit = c(1 / on.unit);
        const V<Tag> square = hn::Mul(e.inverse_square, c(on.unit * on.unit));
        V<Tag> extra = e.extra;
        V<Tag> m_scale = c(1);
        if constexpr (is_coarse && shape == Shape::segment) {
            extra = hn::Mul(extra, c(on.unit * on.unit));
            m_scale = per_unit;
        } else if constexpr (is_coarse && shape == Shape::circle) {
            extra = hn::Mul(extra, per_unit);
        }
        M<Tag> fit = hn::Lt(eta.value, c(5e-4));
        if constexpr (is_coarse) {
            // 1 / |m|^2 of a very short segment and such are beyond float.
            const V<Tag> largest = hn::Max(square, strength);
            fit = hn::And(fit, hn::And(hn::Lt(eta.slope, c(1e-2)), hn::Lt(largest, c(1e12))));
            if constexpr (shape != Shape::point) fit = hn::And(fit, hn::Lt(extra, c(1e12)));
        }
        bad = hn::Or(bad, hn::AndNot(fit, enters));

        const auto put = [&](V<Tag> x0, V<Tag> x1, V<Tag> x2, V<Tag> x3, std::size_t j) HWY_ATTR {
            if constexpr (sizeof(Real) != sizeof(hn::TFromD<Tag>)) {
                const hn::Rebind<float, D> narrow;
                hn::StoreInterleaved4(hn::DemoteTo(narrow, x0), hn::DemoteTo(narrow, x1),
                                      hn::DemoteTo(narrow, x2), hn::DemoteTo(narrow, x3), narrow,
                                      quads[j]);
            } else {
                hn::StoreInterleaved4(x0, x1, x2, x3, d, quads[j]);
            }
        };
        const V<Tag> full = hn::Mul(hn::Mul(c(2 * slope_sign<kind>), e.strength), square);
        put(hn::Mul(arrivals.place.x, per_unit), hn::Mul(arrivals.place.y, per_unit),
            hn::Mul(arrivals.place.z, per_unit), hn::Mul(square, c(argument_scale<kind>)), 0);
        put(e.strength, hn::IfThenZeroElse(kinked, full), zero, zero, 1);
        if constexpr (shape != Shape::point) {
            put(hn::Mul(e.m.x, m_scale), hn::Mul(e.m.y, m_scale), hn::Mul(e.m.z, m_scale), extra,
                2);
        }
        const auto enter = [&](StageEntries<Real>& stage, M<Tag> which) HWY_ATTR {
            for (std::uint32_t bits = lane_bits(d, which); bits != 0; bits &= bits - 1) {
                const auto k = static_cast<std::size_t>(std::countr_zero(bits));
                stage.element[stage.size] = source.element(i + k);
                static_assert(sizeof(BundleEntry<Real>) == 12 * sizeof(Real));
                auto* const to = reinterpret_cast<Real*>(&stage.entry[stage.size]);
                std::memcpy(to, quads[0] + 4 * k, 4 * sizeof(Real));
                std::memcpy(to + 4, quads[1] + 4 * k, 4 * sizeof(Real));
                if constexpr (shape != Shape::point) {
                    std::memcpy(to + 8, quads[2] + 4 * k, 4 * sizeof(Real));
                }
                ++stage.size;
            }
        };
        if (strong.entries != nullptr) enter(*strong.entries, is_strong);
        if (weak != nullptr) enter(*weak, is_weak);
    }
    constexpr std::size_t group = group_of(shape, kind);
    if (strong.entries != nullptr) {
        strong.entries->count[group] =
            static_cast<std::uint32_t>(strong.entries->size - strong_before);
    }
    if (weak != nullptr) weak->count[group] = static_cast<std::uint32_t>(weak->size - weak_before);
    sums.error += sum_of(error);
    sums.slope += sum_of(slope);
    sums.magnitude += sum_of(magnitude);
    sums.full_slope += sum_of(full_slope);
    sums.rest_above += sum_of(rest_above);
    sums.rest_below += sum_of(rest_below);
    sums.weak_above += sum_of(weak_above);
    sums.weak_below += sum_of(weak_below);
    sums.weak_slope += sum_of(weak_slope);
    sums.usable = sums.usable && hn::AllFalse(d, bad);
}

template <class Real>
Entering entering(const Stretch& s, double unit) {
    return {.u = sizeof(Real) == sizeof(float) ? 0x1p-24 : 0x1p-53,
            .unit = unit,
            .H = 0.5 * (s.end - s.begin) * more + s.end * s.spread * more,
            .end = s.end,
            .place_error = 0,
            .least_rho = std::sqrt(double{least_square<Real>}) * unit * more};
}

StageSums coarse(const Field& field, const Stretch& stretch, double scale, const CoarseCuts& cuts,
                 const ActiveElements& active, Window& window) {
    StageSums sums;
    window.strong.clear();
    window.weak.clear();
    const Entering on = entering<float>(stretch, field.unit);
    for_all_groups([&]<Shape shape, KernelKind kind>(std::size_t group) HWY_ATTR {
        const std::size_t first = active.first[group], end = active.first[group + 1];
        if (first == end) return;
        const FieldArrivals<shape> source{field, stretch, scale, window.middle, active};
        enter_group<float, shape, kind>(source, on, cuts, first, end, {&window.strong},
                                        &window.weak, sums);
    });
    return sums;
}

// c - M: beside what the elements' places are off by, and their own roundings, that of the middle's
// place and of the difference; |place| <= |c - M| + |middle|. `middle` is that of the window,
// relative to the elements' place.
StageSums enter_from_near(const NearElements& near, const NearStretch& stretch, double middle,
                          const CoarseCuts& cuts, const StrongOnes<float>& strong,
                          StageEntries<float>& weak) {
    StageSums sums;
    if (strong.entries != nullptr) strong.entries->clear();
    if (strong.others != nullptr) {
        strong.others->make_room(near.size());
        strong.others->end(0);
    }
    weak.clear();
    const Reach<float> reach = reach_of(stretch);
    const auto place = [&](double base, double axis) {
        return static_cast<float>(base + middle * axis);
    };
    const Vec3<float> from{place(stretch.base.x, stretch.axis.x),
                           place(stretch.base.y, stretch.axis.y),
                           place(stretch.base.z, stretch.axis.z)};
    const double size =
        std::sqrt(double{from.x} * double{from.x} + double{from.y} * double{from.y} +
                  double{from.z} * double{from.z});
    const double end = (stretch.t_offset + stretch.end) * more;
    const Entering on{.u = 0x1p-24,
                      .unit = 1,
                      .H = 0.5 * (stretch.end - stretch.begin) * more + end * stretch.spread * more,
                      .end = end,
                      .place_error = 0x1p-23 * double{near.magnitude} + 0x1.1p-23 * size,
                      .least_rho = std::sqrt(double{least_square<float>}) * more};
    for_all_groups([&]<Shape shape, KernelKind kind>(std::size_t group) HWY_ATTR {
        const std::size_t first = near.first[group], end_of_group = near.first[group + 1];
        if (strong.others != nullptr) strong.others->begin(group);
        if (first == end_of_group) return;
        const NearArrivals<shape> source{near, reach, from};
        enter_group<float, shape, kind>(source, on, cuts, first, end_of_group, strong, &weak, sums);
    });
    if (strong.others != nullptr) strong.others->end(strong.others->size());
    return sums;
}

StageSums coarse_near(const NearElements& near, const NearStretch& stretch, double middle,
                      const CoarseCuts& cuts, Window& window) {
    return enter_from_near(near, stretch, middle, cuts, {&window.strong}, window.weak);
}

StageSums fine(const Field& field, const Stretch& stretch, double scale,
               const ActiveElements& active, Window& window) {
    StageSums sums;
    window.fine.clear();
    const Entering on = entering<double>(stretch, 1);
    for_all_groups([&]<Shape shape, KernelKind kind>(std::size_t group) HWY_ATTR {
        const std::size_t first = active.first[group], end = active.first[group + 1];
        if (first == end) return;
        const FieldArrivals<shape> source{field, stretch, scale, window.middle, active};
        enter_group<double, shape, kind>(source, on, {}, first, end, {&window.fine}, nullptr, sums);
    });
    return sums;
}

StageSums faint(const NearElements& near, const NearStretch& stretch, double middle, double unit,
                double cut, Window& window, ActiveElements& others) {
    return enter_from_near(near, stretch, middle, {.strong = cut, .weak = 0},
                           {.others = &others, .unit = unit}, window.faint);
}

}  // namespace

const BundleSteps& bundle_steps_of_target() {
    static const BundleSteps steps{bound,      bound_clusters, bend,       enter_near,
                                   place_near, bound_members,  bound_near, bend_near,
                                   coarse,     coarse_near,    fine,       faint};
    return steps;
}

}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ivory {

HWY_EXPORT(bundle_steps_of_target);

const BundleSteps& bundle_steps() { return HWY_DYNAMIC_DISPATCH(bundle_steps_of_target)(); }

void ActiveElements::take(const std::array<std::uint32_t, field_groups + 1>& groups,
                          std::span<const std::uint32_t> elements) {
    make_room(elements.size());
    std::copy(elements.begin(), elements.end(), element.begin());
    for (std::size_t group = 0; group < field_groups; ++group) {
        first[group] = static_cast<std::uint32_t>(
            std::lower_bound(elements.begin(), elements.end(), groups[group]) - elements.begin());
    }
    end(elements.size());
}

void ActiveElements::take_members(const Clusters& clusters, const ActiveElements& of) {
    make_room(of.size() * cluster_size);
    std::size_t count = 0;
    for (std::size_t group = 0; group < field_groups; ++group) {
        first[group] = static_cast<std::uint32_t>(count);
        for (std::size_t i = of.first[group]; i < of.first[group + 1]; ++i) {
            const auto cluster = static_cast<std::size_t>(of.element[i]);
            for (std::uint32_t e = clusters.first[cluster]; e < clusters.first[cluster + 1]; ++e) {
                element[count++] = e;
            }
        }
    }
    end(count);
}

void ActiveElements::make_room(std::size_t count) {
    if (element.size() >= count + room) return;
    const std::size_t size = count + count / 2 + room;
    element.assign(size, 0);
    for (auto* values : {&least, &most, &peak, &inverse}) values->assign(size, 0.0);
}

void ActiveElements::take(const NearElements& near, std::size_t i, double unit) {
    const std::size_t count = size();
    element[count] = near.element[i];
    least[count] = double{near.least[i]};
    most[count] = double{near.most[i]};
    peak[count] = double{near.peak[i]};
    inverse[count] = double{near.inverse[i]} / unit;
    ++first[field_groups];
}

void NearElements::make_room(std::size_t count) {
    if (element.size() >= count + room) return;
    const std::size_t size = count + count / 2 + room;
    element.assign(size, 0);
    for (auto* values : {&x, &y, &z, &strength, &inverse_square, &mx, &my, &mz, &extra, &length,
                         &least, &most, &peak, &inverse}) {
        values->assign(size, 0.0F);
    }
}

void ActiveElements::end(std::size_t count) {
    first[field_groups] = static_cast<std::uint32_t>(count);
    std::fill_n(element.begin() + static_cast<std::ptrdiff_t>(count), room, 0);
}

}  // namespace ivory
#endif
