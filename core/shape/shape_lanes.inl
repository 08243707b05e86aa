// What a skeleton can do on a stretch of a bundle, and where its nearest point is, in SIMD over
// elements or rays: what the quick forms at the end of the shapes' files are made of (core/shape/
// point.h, ...). For files that are compiled once for each instruction set.
#if defined(IVORY_CORE_SHAPE_SHAPE_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IVORY_CORE_SHAPE_SHAPE_LANES_INL
#undef IVORY_CORE_SHAPE_SHAPE_LANES_INL
#else
#define IVORY_CORE_SHAPE_SHAPE_LANES_INL
#endif

#include <utility>

#include "core/kernel/kernel_lanes.inl"
#include "core/shape/bundle_entry.h"
#include "core/shape/shapes.h"

HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {
namespace {

using I = hn::RebindToSigned<D>;
using F = hn::ScalableTag<float>;

constexpr double more = Margins<double>::more, less = Margins<double>::less;

HWY_INLINE V<D> constant(double value) { return hn::Set(D(), value); }
template <class Vector>
HWY_INLINE Vector square_of(Vector x) {
    return hn::Mul(x, x);
}
template <class Tag>
HWY_INLINE V<Tag> length_of(Tag, const Vec3v<Tag>& v) {
    return hn::Sqrt(dot<Tag>(v, v));
}
// a - share m.
template <class Tag>
HWY_INLINE Vec3v<Tag> less_share(const Vec3v<Tag>& a, const Vec3v<Tag>& m, V<Tag> share) {
    return {hn::NegMulAdd(share, m.x, a.x), hn::NegMulAdd(share, m.y, a.y),
            hn::NegMulAdd(share, m.z, a.z)};
}
template <class Tag>
HWY_INLINE Vec3v<Tag> from_first_place(Tag d, const BundleEntry<hn::TFromD<Tag>>& e,
                                       const Vec3v<Tag>& p) {
    return {hn::Sub(p.x, hn::Set(d, e.cx)), hn::Sub(p.y, hn::Set(d, e.cy)),
            hn::Sub(p.z, hn::Set(d, e.cz))};
}

// (1) of core/field/bundle_field.h: a lower bound of the distance between two places at most L apart from
// lower bounds of those there, with which it rises. Errors have to be taken off before: near 0 the result
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
// most radius + spread t, t = tau + t_offset, away from them. Places are relative to the bundle's origin
// in double, to the middle of some stretch in float.
template <class Real>
struct Reach {
    Vec3<Real> axis, base;
    Real begin, end, spread, radius;
    Real t_offset;
    Real magnitude;  // of all numbers here but t_offset: what rounding is relative to

    // So far from the axis' points are the rays' at most.
    [[nodiscard]] Real aside() const {
        constexpr auto widened = Margins<Real>::more;
        return ((t_offset + end) * spread + radius) * widened * widened;
    }
};

// The numbers of some elements, side by side (SkeletonColumns::numbers).
template <class Tag, bool has_any>
struct SeenNumbers {};
template <class Tag>
struct SeenNumbers<Tag, true> {
    using Real = hn::TFromD<Tag>;
    using Index = hn::RebindToSigned<Tag>;
    const Real* all;
    hn::Vec<Index> first;

    // Beyond the last element stands whatever there was.
    template <class Element>
    HWY_INLINE void see(const PartNumbers<Real>& numbers, const Element* element) {
        constexpr std::size_t lanes = hn::MaxLanes(Tag());
        HWY_ALIGN hn::TFromD<Index> at[lanes];
        for (std::size_t k = 0; k < lanes; ++k) {
            const auto i = static_cast<std::uint64_t>(element[k]);
            at[k] = i < numbers.elements ? numbers.first[i] : 0;
        }
        all = numbers.all;
        first = hn::Load(Index(), at);
    }
    // The k-th; and the one whose place each lane says.
    [[nodiscard]] HWY_INLINE V<Tag> number(std::size_t k) const {
        return hn::GatherIndex(Tag(), all + k, first);
    }
    [[nodiscard]] HWY_INLINE V<Tag> number_at(V<Tag> place) const {
        return hn::GatherIndex(Tag(), all, hn::Add(first, hn::ConvertTo(Index(), place)));
    }
};

// Some elements of a group, seen from where their places are relative to.
template <class Tag, Shape shape>
struct Seen : SeenNumbers<Tag, SkeletonOf<shape>::has_numbers> {
    using Real = hn::TFromD<Tag>;
    Vec3v<Tag> v;           // to the skeleton's first place
    Vec3v<Tag> m;           // as the shape's file says; 0 where it has no axis
    V<Tag> parameter;       // likewise
    V<Tag> size;            // of the skeleton: no point of it is farther from its first place
    V<Tag> magnitude;       // at least |v| + size
    V<Tag> strength;        // scaled
    V<Tag> inverse_square;  // 1 / w^2
    V<Tag> taper_rate;      // of tapers: how much more the width is at m, in least widths

    // Once all but m, parameter and size, unless it has an axis, and magnitude are set.
    HWY_INLINE void finish() {
        const Tag d;
        if constexpr (!SkeletonOf<shape>::has_axis) {
            m = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
            parameter = size = hn::Zero(d);
        }
        magnitude =
            hn::Mul(hn::Add(hn::Add(hn::Abs(v.x), hn::Abs(v.y)), hn::Add(hn::Abs(v.z), size)),
                    hn::Set(d, Margins<Real>::more));
    }

    // From the first place to the point of the axis at t.
    HWY_INLINE Vec3v<Tag> from_axis(const Vec3<Real>& axis, Real t) const {
        const Tag d;
        return {hn::Sub(hn::Set(d, t * axis.x), v.x), hn::Sub(hn::Set(d, t * axis.y), v.y),
                hn::Sub(hn::Set(d, t * axis.z), v.z)};
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

// Its least distance from the rays' points of a stretch, which lie no farther than `aside` across the axis; along
// it they are off by |(o - origin) . axis| <= spread radius and t |(d - axis) . axis| <= t spread^2, so by less
// than spread aside. All of it is given `error`.
template <class Tag>
HWY_INLINE V<Tag> nearest_of_rays(Tag d, const FromAxis<Tag>& c, V<Tag> aside,
                                  const Reach<hn::TFromD<Tag>>& s, V<Tag> error) {
    constexpr auto widened = Margins<hn::TFromD<Tag>>::more;
    const V<Tag> slip = hn::MulAdd(aside, hn::Set(d, s.spread * widened), error);
    const V<Tag> before = hn::Sub(hn::Set(d, s.begin), c.along),
                 after = hn::Sub(c.along, hn::Set(d, s.end));
    const V<Tag> along = at_least_0(hn::Sub(hn::Max(before, after), slip));
    const V<Tag> across = at_least_0(hn::Sub(hn::Sqrt(c.across_square), hn::Add(aside, error)));
    return hn::Sqrt(hn::MulAdd(across, across, square_of(along)));
}

template <class Tag>
struct DistanceRange {
    V<Tag> near;
    V<Tag> far;  // not of shapes without an axis: nobody asks
};

// What rounding does to distances, where numbers are no larger than that.
template <class Tag>
HWY_INLINE V<Tag> error_of(Tag d, V<Tag> magnitude, const Reach<hn::TFromD<Tag>>& reach) {
    return hn::Mul(hn::Add(magnitude, hn::Set(d, reach.magnitude)),
                   hn::Set(d, Margins<hn::TFromD<Tag>>::margin));
}

// At most so far from the axis' points are the rays', up to the t from which on each ray only gets
// farther from every point of the skeleton, so that what holds up to there holds on.
template <class Tag>
HWY_INLINE V<Tag> aside_of(Tag d, V<Tag> magnitude, const Reach<hn::TFromD<Tag>>& s) {
    const V<Tag> offset = hn::Set(d, s.t_offset);
    const V<Tag> last = hn::Max(hn::Set(d, s.t_offset + s.begin),
                                hn::Min(hn::Set(d, s.t_offset + s.end),
                                        hn::Add(offset, hn::Add(magnitude, hn::Set(d, s.radius)))));
    constexpr auto widened = Margins<hn::TFromD<Tag>>::more;
    return hn::MulAdd(last, hn::Set(d, s.spread * widened), hn::Set(d, s.radius * widened));
}

// A lower bound of the distances of the axis' points from those at both ends, or from a ball around
// the skeleton, which says more on a long stretch.
template <class Tag>
HWY_INLINE V<Tag> nearest_of_ends_and_ball(Tag d, V<Tag> d0, V<Tag> d1, const Vec3v<Tag>& center,
                                           V<Tag> radius, const Reach<hn::TFromD<Tag>>& s,
                                           V<Tag> error) {
    using Real = hn::TFromD<Tag>;
    const Real L = (s.end - s.begin) * Margins<Real>::more;
    const V<Tag> near =
        least_between(d, at_least_0(hn::Sub(d0, error)), at_least_0(hn::Sub(d1, error)), L);
    const V<Tag> ball = hn::Sub(FromAxis<Tag>(center, s.axis).nearest(s.begin, s.end), radius);
    return hn::Max(near, hn::Sub(ball, error));
}

// From bounds of the distances of the axis' points those of the rays'.
template <class Tag>
HWY_INLINE DistanceRange<Tag> range_of_rays(Tag d, V<Tag> magnitude, V<Tag> near, V<Tag> far,
                                            const Reach<hn::TFromD<Tag>>& s, V<Tag> error) {
    return {at_least_0(hn::Sub(near, aside_of(d, magnitude, s))),
            hn::Add(far, hn::Add(error, hn::Set(d, s.aside())))};
}

// A window as its entries see it, in their lengths.
struct Entering {
    double u;     // unit roundoff of the stage
    double unit;  // of the entries' lengths, in those of the elements
    double H;     // the greatest |t - middle| + t |d - axis| + |o - origin|
    double end;   // the greatest t
    // c - M is known to 2 u of itself and this.
    double place_error;
    double least_rho;
};

// The quick forms of a shape, next to the exact ones in its file: values to nearest and bounds that
// are widened by far more than their roundings. Both are there because the inner loops can afford
// neither directed steps nor cases.
//     away(d, entry, p, square)                   from the nearest point to p
//     distances(seen, reach, error)               of a stretch's points from the skeleton
//     curvature_range(seen, reach, error, least, most) what kernels' bounds of f'' want to know
//     errors(d, entering, seen, eta, v_length, inverse)
//         what `away` is off by, and what its direction adds, from what p - c is; `inverse`: of rho
// and, where it has kinks,
//     turning(seen, reach, error, most)
//     is_defined(d, entry, inverse_square, p)     the direction of `away`
// where it proves feet,
//     proved_foot(d, entry, p, reach)
// and, where parts of an element may be told apart by it,
//     part_foot(seen, reach, t, reach, error)
template <class S>
struct ShapeLanes;

// What is proved of one place c of a skeleton from p alone, whatever its other places are like: with d the
// distance and v a ray's direction, of length 1,
//     square - slack <= d^2 <= square = |p - c|^2,
//     |(d^2)'(t) - 2 (p - c).v - 2 t| <= 2 (bend |t| + pull)  for all t from p, on either side;
// where `in_reach` only for |t| <= reach, and as far as no other part of the skeleton is nearer.
template <class Tag>
struct ProvedFoot {
    Vec3v<Tag> away;  // p - c
    V<Tag> square, slack, bend, pull;
    M<Tag> in_reach;
};
// Of the axis' point at t, on one part of an element.
template <class Tag>
struct PartFoot {
    ProvedFoot<Tag> foot;
    V<Tag> error;   // of any place of the part, from there
    V<Tag> length;  // no place of the part is farther from the foot
    M<Tag> never;   // within reach no place of this part alone is the element's nearest
    // Of an arc, not known where q = 0: a place y is at least `square` - 2 G |y - at| + q (y - at)^2 away, |c'| <=
    // F and pull = G + reach F. y counts within its piece, from -1 to 1.
    V<Tag> at, q, pull;
};
// Stands for what there is no bound of.
template <class Real>
inline constexpr Real boundless = static_cast<Real>(sizeof(Real) == 4 ? 1e15 : 1e100);

// Of a skeleton with kinks, on a stretch: s'' w^2 / 2 >= 1 - outward for a ray of speed 1, unless
// `inverse` is below 0: then there may be a kink. Otherwise that is what `errors` wants to know.
template <class Tag>
struct Turning {
    V<Tag> inverse, outward;
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();

#define IVORY_LANES
#include "core/shape/shapes.h"
#undef IVORY_LANES

HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {
namespace {

template <Shape shape>
using LanesOfShape = ShapeLanes<SkeletonOf<shape>>;

// Whether it has kinks of which each ray may prove that they are none of its own.
template <Shape shape>
inline constexpr bool proves_feet = SkeletonOf<shape>::has_numbers&& SkeletonOf<shape>::has_kinks;

// Whether elements' parts can be told apart by their feet, and whether they are narrowed down to pieces: m.x and
// m.y are then the piece's.
template <Shape shape>
inline constexpr bool narrows = proves_feet<shape>;
template <Shape shape>
inline constexpr bool compares_feet = SkeletonOf<shape>::is_joined&& requires(
    const Seen<F, shape>& e, const Reach<float>& s, V<F> x) {
    LanesOfShape<shape>::part_foot(e, s, 0.0F, x, x);
};

template <class Visit, std::size_t... shape>
HWY_INLINE void for_shapes(const Visit& visit, std::index_sequence<shape...>) {
    (visit.template operator()<static_cast<Shape>(shape)>(), ...);
}
template <Shape shape, class Visit, std::size_t... kernel>
HWY_INLINE void for_kernels(const Visit& visit, std::index_sequence<kernel...>) {
    (visit.template operator()<shape, static_cast<KernelKind>(kernel)>(), ...);
}

// Calls visit.operator()<shape>() for all that fields are made of.
template <class Visit>
HWY_INLINE void for_shapes(const Visit& visit) {
    for_shapes(visit, std::make_index_sequence<field_shape_count>());
}
// Calls visit.operator()<shape, kind>() for all kernels; and for all of both, in the order of their
// groups.
template <Shape shape, class Visit>
HWY_INLINE void for_kernels(const Visit& visit) {
    for_kernels<shape>(visit, std::make_index_sequence<kernel_count>());
}
template <class Visit>
HWY_INLINE void for_shapes_and_kernels(const Visit& visit) {
    for_shapes([&]<Shape shape>() HWY_ATTR
               __attribute__((always_inline)) { for_kernels<shape>(visit); });
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();

#endif
