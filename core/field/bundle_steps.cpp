#include "core/field/bundle_steps.h"

#include <algorithm>
#include <cmath>

#include "core/field/bundle.h"
#include "core/math/instruction_sets.h"
#include "core/math/offset.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/field/bundle_steps.cpp"
#include <hwy/foreach_target.h>  // includes this file once for each instruction set
#include "core/field/kernel_lanes.inl"

HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {
namespace {

using I = hn::RebindToSigned<D>;

constexpr double margin = 0x1p-46;
constexpr double more = 1 + 0x1p-46, less = 1 - 0x1p-46;

// The s'' of a circle is bounded where r / rho stays below this; else the element counts as kinked.
constexpr double greatest_outward = 32;

// sup of x e^-x^2 and of x^3 e^-x^2 for x >= 0 are 0.4289 and 0.4099.
constexpr double unit_slope = 0.43;

HWY_INLINE V<D> constant(double value) { return hn::Set(D(), value); }
HWY_INLINE V<D> square_of(V<D> x) { return hn::Mul(x, x); }
HWY_INLINE V<D> length_of(const Vec3v<D>& v) { return hn::Sqrt(dot<D>(v, v)); }
HWY_INLINE V<D> at_least_0(V<D> x) { return hn::Max(x, hn::Zero(D())); }

// Upper bounds of k and |k'| from a lower bound of s. The factored forms lose relative accuracy
// only in 1 - q of Nishimura's kernel, for which the absolute terms are.
template <KernelKind kind>
HWY_INLINE V<D> peak_of(V<D> s) {
    const D d;
    // rounded down, the product with s as well
    constexpr double scale = argument_scale<kind> * (1 - 0x1p-50);
    const V<D> k = kernel<kind>(d, kind == KernelKind::blinn ? hn::Mul(s, constant(scale)) : s).k;
    if constexpr (kind == KernelKind::blinn) return hn::MulAdd(k, constant(more), constant(1e-300));
    return hn::IfThenElseZero(hn::Lt(s, constant(1)),
                              hn::MulAdd(k, constant(more), constant(0x1p-49)));
}

template <KernelKind kind>
HWY_INLINE V<D> steepest(V<D> s) {
    const D d;
    const V<D> dk = hn::Neg(kernel<kind>(d, s).dk);
    return hn::IfThenElseZero(hn::Lt(s, constant(1)),
                              hn::MulAdd(dk, constant(more), constant(0x1p-46)));
}

// An upper bound of w / (2 |b|) |F'| = x |k'| <= sqrt(s) |k'| where s >= least: for Blinn's, with
// s = least + y, e^-s sqrt(s) <= e^-least (sqrt(least) + sup sqrt(y) e^-y); for the other two the
// greatest value of sqrt(s) |k'| is 1 and 0.79.
template <KernelKind kind>
HWY_INLINE V<D> slope_of(V<D> least, V<D> peak) {
    if constexpr (kind != KernelKind::blinn) {
        return hn::IfThenElseZero(hn::Lt(least, constant(1)), constant(1));
    }
    const V<D> falling = hn::Mul(peak, hn::Add(hn::Sqrt(least), constant(unit_slope)));
    return hn::Mul(hn::Min(constant(unit_slope), falling), constant(more));
}

// (1) of bundle.h: a lower bound of the distance between two places at most L apart from lower
// bounds of those there, with which it rises. Errors have to be taken off before: near 0 the result
// follows their square roots.
HWY_INLINE V<D> least_between(V<D> d0, V<D> d1, double L) {
    const double square = L * L;
    const V<D> square0 = square_of(d0), square1 = square_of(d1), squareL = constant(square);
    const V<D> half = hn::Mul(constant(0.5), hn::Sub(hn::Add(squareL, square0), square1));
    const V<D> vertex = hn::NegMulAdd(hn::Mul(half, half), constant(1 / square), square0);
    const auto within = hn::And(hn::Gt(half, hn::Zero(D())), hn::Lt(half, squareL));
    V<D> least = hn::IfThenElse(within, vertex, hn::Min(square0, square1));
    least = hn::NegMulAdd(hn::Add(hn::Add(square0, square1), squareL), constant(margin), least);
    return hn::Mul(hn::Sqrt(at_least_0(least)), constant(less));
}

// Some elements of a group, seen from the stretch's origin.
template <Shape shape>
struct Seen {
    Vec3v<D> v;           // from the origin to the point, the segment's end a, the centre
    Vec3v<D> m;           // segment: b - a; circle: unit normal
    V<D> extra;           // segment: 1 / |m|^2; circle: radius
    V<D> size;            // of the skeleton: no point of it is farther from c
    V<D> far;             // at least as far from the origin as any point of the skeleton
    V<D> strength;        // scaled
    V<D> inverse_square;  // 1 / w^2

    Seen(const Field& field, const Stretch& stretch, double scale, hn::Vec<I> index) {
        const D d;
        const auto column = [&](const std::vector<double>& values)
                                HWY_ATTR { return hn::GatherIndex(d, values.data(), index); };
        v = {hn::Sub(column(field.ax), constant(stretch.origin.x)),
             hn::Sub(column(field.ay), constant(stretch.origin.y)),
             hn::Sub(column(field.az), constant(stretch.origin.z))};
        far = hn::Mul(hn::Add(hn::Add(hn::Abs(v.x), hn::Abs(v.y)), hn::Abs(v.z)), constant(more));
        if constexpr (shape != Shape::point) {
            m = {column(field.mx), column(field.my), column(field.mz)};
            extra = column(field.extra);
            size = shape == Shape::segment ? column(field.length) : extra;
            far = hn::MulAdd(size, constant(more), far);
        } else {
            m = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
            extra = size = hn::Zero(d);
        }
        strength = hn::Mul(column(field.strength), constant(scale));
        inverse_square = column(field.inverse_square);
    }

    // The distance of the axis' point at t from the skeleton.
    HWY_INLINE V<D> distance(const Vec3d& axis, double t) const {
        const Vec3v<D> from{hn::Sub(constant(t * axis.x), v.x), hn::Sub(constant(t * axis.y), v.y),
                            hn::Sub(constant(t * axis.z), v.z)};
        const V<D> along = dot<D>(from, m);
        const Vec3v<D> foot_of = across(from, m, shape == Shape::segment ? foot(along) : along);
        if constexpr (shape == Shape::segment) return length_of(foot_of);
        const V<D> off = hn::Sub(length_of(foot_of), extra);
        return hn::Sqrt(hn::MulAdd(off, off, square_of(along)));
    }

    // And that from a circle's axis.
    HWY_INLINE V<D> rho(const Vec3d& axis, double t) const {
        const Vec3v<D> from{hn::Sub(constant(t * axis.x), v.x), hn::Sub(constant(t * axis.y), v.y),
                            hn::Sub(constant(t * axis.z), v.z)};
        return length_of(across(from, m, dot<D>(from, m)));
    }

  private:
    HWY_INLINE V<D> foot(V<D> along) const {
        return hn::Min(at_least_0(hn::Mul(along, extra)), constant(1));
    }
    static HWY_INLINE Vec3v<D> across(const Vec3v<D>& a, const Vec3v<D>& m, V<D> share) {
        return {hn::NegMulAdd(share, m.x, a.x), hn::NegMulAdd(share, m.y, a.y),
                hn::NegMulAdd(share, m.z, a.z)};
    }
};

// A point against the bundle's axis.
struct FromAxis {
    V<D> along, across_square;

    HWY_INLINE FromAxis(const Vec3v<D>& v, const Vec3d& axis) {
        const Vec3v<D> a{constant(axis.x), constant(axis.y), constant(axis.z)};
        along = dot<D>(v, a);
        const Vec3v<D> across{hn::NegMulAdd(along, a.x, v.x), hn::NegMulAdd(along, a.y, v.y),
                              hn::NegMulAdd(along, a.z, v.z)};
        across_square = dot<D>(across, across);
    }

    // Its least distance from the axis' points of a stretch.
    HWY_INLINE V<D> nearest(double begin, double end) const {
        const V<D> before = hn::Sub(constant(begin), along), after = hn::Sub(along, constant(end));
        return hn::Sqrt(hn::Add(across_square, square_of(at_least_0(hn::Max(before, after)))));
    }
};

struct DistanceRange {
    V<D> near;
    V<D> far;  // not of points: nobody asks
};

// A lower and an upper bound of the distances between the skeletons and the stretch's points. These
// are at most t spread away from the axis'; beyond t = far each ray only gets farther from every
// point of the skeleton, so that what holds up to there holds on. On a long stretch a ball around
// the skeleton, or a segment's whole line, says more than (1).
template <Shape shape>
HWY_INLINE DistanceRange distances(const Seen<shape>& e, const Stretch& s, V<D> error) {
    const V<D> last = hn::Max(constant(s.begin), hn::Min(constant(s.end), e.far));
    const V<D> aside = hn::Mul(last, constant(s.spread * more));
    const V<D> off = hn::Add(aside, error);
    if constexpr (shape == Shape::point) {
        const FromAxis c(e.v, s.axis);
        return {at_least_0(hn::Sub(c.nearest(s.begin, s.end), off)), hn::Zero(D())};
    } else {
        const double L = (s.end - s.begin) * more;
        const V<D> d0 = e.distance(s.axis, s.begin), d1 = e.distance(s.axis, s.end);
        V<D> near =
            least_between(at_least_0(hn::Sub(d0, error)), at_least_0(hn::Sub(d1, error)), L);
        // The distance to any set changes by at most L; to a convex one it is convex.
        V<D> far = hn::Max(d0, d1);
        Vec3v<D> center = e.v;
        V<D> radius = e.size;
        if constexpr (shape == Shape::segment) {
            const V<D> half = constant(0.5);
            center = {hn::MulAdd(half, e.m.x, center.x), hn::MulAdd(half, e.m.y, center.y),
                      hn::MulAdd(half, e.m.z, center.z)};
            radius = hn::Mul(half, radius);
        } else {
            far = hn::Mul(constant(0.5), hn::Add(hn::Add(d0, d1), constant(L)));
        }
        const V<D> ball = hn::Sub(FromAxis(center, s.axis).nearest(s.begin, s.end), radius);
        near = hn::Max(near, hn::Sub(ball, error));
        if constexpr (shape == Shape::segment) {
            // |v . (axis x m)| / |axis x m|, unless they are nearly parallel
            const Vec3v<D> n{
                hn::Sub(hn::Mul(constant(s.axis.y), e.m.z), hn::Mul(constant(s.axis.z), e.m.y)),
                hn::Sub(hn::Mul(constant(s.axis.z), e.m.x), hn::Mul(constant(s.axis.x), e.m.z)),
                hn::Sub(hn::Mul(constant(s.axis.x), e.m.y), hn::Mul(constant(s.axis.y), e.m.x))};
            const V<D> n_square = dot<D>(n, n);
            const V<D> line = hn::Div(hn::Abs(dot<D>(e.v, n)), hn::Sqrt(n_square));
            const auto crosses = hn::Gt(n_square, hn::Mul(constant(0x1p-12), square_of(e.size)));
            near = hn::IfThenElse(
                crosses, hn::Max(near, hn::NegMulAdd(constant(0x1p-38), e.far, line)), near);
        }
        return {at_least_0(hn::Sub(near, aside)),
                hn::Add(far, hn::Add(error, constant(s.end * s.spread * more)))};
    }
}

HWY_INLINE V<D> error_of(V<D> far, const Stretch& stretch) {
    return hn::Mul(hn::Add(far, constant(stretch.end)), constant(margin));
}

double sum_of(V<D> x) {
    const D d;
    return hn::GetLane(hn::SumOfLanes(d, x));
}

template <Shape shape, KernelKind kind>
void bound_group(const Field& field, const Stretch& stretch, double scale, double cut,
                 const ActiveElements& candidates, std::size_t first, std::size_t end,
                 ActiveElements& kept, std::size_t& count, PeakSums& sums) {
    const D d;
    const I di;
    const std::size_t N = hn::Lanes(d);
    const V<D> zero = hn::Zero(d);
    V<D> above = zero, magnitude = zero, rest_above = zero, rest_below = zero;
    for (std::size_t i = first; i < end; i += N) {
        const hn::Vec<I> index = hn::LoadU(di, &candidates.element[i]);
        const M<D> valid = hn::FirstN(d, end - i);
        const Seen<shape> e(field, stretch, scale, index);
        const DistanceRange range = distances(e, stretch, error_of(e.far, stretch));
        const V<D> least =
            hn::Mul(hn::Mul(square_of(range.near), e.inverse_square), constant(less));
        const V<D> peak = peak_of<kind>(least);
        const V<D> value = hn::Mul(hn::Mul(hn::Abs(e.strength), peak), constant(more));
        const M<D> adds = hn::Gt(e.strength, zero);
        // not a number: kept
        const M<D> keep = hn::AndNot(hn::Le(value, constant(cut)), valid);
        const V<D> left = hn::IfThenElseZero(hn::AndNot(keep, valid), value);
        const V<D> stays = hn::IfThenElseZero(keep, value);
        rest_above = hn::Add(rest_above, hn::IfThenElseZero(adds, left));
        rest_below = hn::Add(rest_below, hn::IfThenZeroElse(adds, left));
        magnitude = hn::Add(magnitude, stays);
        above = hn::Add(above, hn::IfThenElseZero(adds, stays));
        const std::size_t more_of_them =
            hn::CompressStore(index, hn::RebindMask(di, keep), di, &kept.element[count]);
        hn::CompressStore(least, keep, d, &kept.least[count]);
        if constexpr (shape != Shape::point) {
            const V<D> most =
                hn::Mul(hn::Mul(square_of(range.far), e.inverse_square), constant(more));
            hn::CompressStore(most, keep, d, &kept.most[count]);
        }
        hn::CompressStore(peak, keep, d, &kept.peak[count]);
        count += more_of_them;
    }
    sums.above += sum_of(above);
    sums.magnitude += sum_of(magnitude);
    sums.rest_above += sum_of(rest_above);
    sums.rest_below += sum_of(rest_below);
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
    const V<D> zero = hn::Zero(d);
    V<D> above = zero, magnitude = zero, rest_above = zero, rest_below = zero;
    for (std::size_t i = first; i < end; i += N) {
        const hn::Vec<I> index = hn::LoadU(di, &candidates.element[i]);
        const M<D> valid = hn::FirstN(d, end - i);
        const auto column = [&](const std::vector<double>& values)
                                HWY_ATTR { return hn::GatherIndex(d, values.data(), index); };
        const Vec3v<D> v{hn::Sub(column(clusters.x), constant(stretch.origin.x)),
                         hn::Sub(column(clusters.y), constant(stretch.origin.y)),
                         hn::Sub(column(clusters.z), constant(stretch.origin.z))};
        const V<D> radius = column(clusters.radius);
        const V<D> far =
            hn::Mul(hn::Add(hn::Add(hn::Abs(v.x), hn::Abs(v.y)), hn::Add(hn::Abs(v.z), radius)),
                    constant(more));
        const V<D> last = hn::Max(constant(stretch.begin), hn::Min(constant(stretch.end), far));
        const V<D> off = hn::MulAdd(last, constant(stretch.spread * more), error_of(far, stretch));
        const V<D> nearest = FromAxis(v, stretch.axis).nearest(stretch.begin, stretch.end);
        const V<D> near = at_least_0(hn::Sub(nearest, hn::Add(off, radius)));
        const V<D> least =
            hn::Mul(hn::Mul(square_of(near), column(clusters.inverse_square)), constant(less));
        const V<D> peak = hn::Mul(peak_of<kind>(least), constant(scale * more));
        const V<D> adds = hn::Mul(column(clusters.above), peak);
        const V<D> takes = hn::Mul(column(clusters.below), peak);
        const V<D> value = hn::Add(adds, takes);
        const M<D> keep = hn::AndNot(hn::Le(value, constant(cut)), valid);
        const M<D> leave = hn::AndNot(keep, valid);
        rest_above = hn::Add(rest_above, hn::IfThenElseZero(leave, adds));
        rest_below = hn::Add(rest_below, hn::IfThenElseZero(leave, takes));
        magnitude = hn::Add(magnitude, hn::IfThenElseZero(keep, value));
        above = hn::Add(above, hn::IfThenElseZero(keep, adds));
        count += hn::CompressStore(index, hn::RebindMask(di, keep), di, &kept.element[count]);
    }
    sums.above += sum_of(above);
    sums.magnitude += sum_of(magnitude);
    sums.rest_above += sum_of(rest_above);
    sums.rest_below += sum_of(rest_below);
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
struct Bend {
    V<D> rise, fall;
};

template <Shape shape, KernelKind kind>
HWY_INLINE Bend bend_of(const Seen<shape>& e, const Stretch& s, V<D> error, V<D> least, V<D> most,
                        V<D> peak, V<D> outward) {
    const D d;
    const V<D> zero = hn::Zero(d), one = constant(1), two = constant(2);
    if constexpr (kind == KernelKind::blinn) {
        // 2 e^-s (2 x^2 - 1 + outward), with y = x^2 at most s; for a point s = y + h^2.
        V<D> y0 = least, y1 = most, h_square = zero, fall = hn::Mul(two, peak);
        if constexpr (shape == Shape::point) {
            const FromAxis c(e.v, s.axis);
            const V<D> across = hn::Sqrt(c.across_square);
            const V<D> turn = hn::Mul(e.far, constant(s.spread * more));
            const V<D> h = at_least_0(hn::Sub(hn::Sub(across, turn), error));
            h_square = hn::Mul(hn::Mul(square_of(h), e.inverse_square), constant(less));
            const V<D> slip = hn::MulAdd(hn::Abs(c.along), constant(s.spread * s.spread),
                                         hn::MulAdd(across, constant(s.spread * more), error));
            const V<D> x0 = hn::Sub(hn::Sub(constant(s.begin), c.along), slip);
            const V<D> x1 = hn::Add(hn::Sub(constant(s.end), c.along), slip);
            const V<D> near = at_least_0(hn::Max(x0, hn::Neg(x1)));
            const V<D> far = hn::Max(hn::Abs(x0), hn::Abs(x1));
            y0 = hn::Mul(hn::Mul(square_of(near), e.inverse_square), constant(less));
            y1 = hn::Mul(hn::Mul(square_of(far), e.inverse_square), constant(more));
            fall = hn::Mul(
                hn::MulAdd(two, at_least_0(hn::NegMulAdd(two, y0, one)), constant(margin)), peak);
        }
        // (2 y - 1) e^-y rises up to 1.5
        const V<D> y = hn::Max(y0, hn::Min(y1, constant(1.5)));
        const V<D> steep =
            hn::Mul(hn::Mul(two, hn::MulSub(two, y, one)), peak_of<kind>(hn::Add(y, h_square)));
        V<D> rise = hn::IfThenElseZero(hn::Gt(y, constant(0.5)), steep);
        // |d|^2 is 1 but for 2^-49
        rise = hn::MulAdd(hn::MulAdd(two, outward, constant(margin)), peak, rise);
        return {rise, fall};
    } else {
        // 4 x^2 k'' - 2 (1 - outward) |k'| with x^2 <= s.
        const V<D> slope = steepest<kind>(least);
        V<D> greatest;  // of 4 s k''
        if constexpr (kind == KernelKind::wyvill) {
            // 4 s (34 - 24 s) / 9 falls from 17 / 24 on
            const V<D> s_worst = hn::Max(least, constant(17.0 / 24));
            greatest = hn::Mul(hn::Mul(constant(4.0 / 9), s_worst),
                               hn::NegMulAdd(constant(24), s_worst, constant(34)));
        } else {
            // 4 s 3/4 / q^3
            greatest = hn::Div(constant(3), hn::Sqrt(hn::Max(least, constant(1.0 / 9))));
        }
        const V<D> inward = hn::Mul(hn::Mul(two, at_least_0(hn::Sub(outward, one))), slope);
        const M<D> reaches = hn::Lt(least, one);
        return {hn::IfThenElseZero(reaches, hn::Mul(hn::Add(greatest, inward), constant(more))),
                hn::IfThenElseZero(reaches, hn::Mul(hn::Mul(two, slope), constant(more)))};
    }
}

template <Shape shape, KernelKind kind>
void bend_group(const Field& field, const Stretch& stretch, double scale, ActiveElements& active,
                std::size_t first, std::size_t end, BendSums& sums) {
    const D d;
    const I di;
    const std::size_t N = hn::Lanes(d);
    const V<D> zero = hn::Zero(d);
    V<D> rise = zero, fall = zero, kinks = zero;
    for (std::size_t i = first; i < end; i += N) {
        const hn::Vec<I> index = hn::LoadU(di, &active.element[i]);
        const M<D> valid = hn::FirstN(d, end - i);
        const Seen<shape> e(field, stretch, scale, index);
        const V<D> error = error_of(e.far, stretch);
        const V<D> least = hn::LoadU(d, &active.least[i]);
        const V<D> most = hn::LoadU(d, &active.most[i]);
        const V<D> peak = hn::LoadU(d, &active.peak[i]);
        M<D> smooth = valid;
        V<D> inverse = zero, outward = zero;  // 1 / rho, r / rho
        if constexpr (shape == Shape::circle) {
            // s'' w^2 / 2 = 1 - r rho'' lies in 1 - r / rho .. 1.
            const V<D> rho0 = e.rho(stretch.axis, stretch.begin);
            const V<D> rho1 = e.rho(stretch.axis, stretch.end);
            const V<D> rho = hn::Sub(
                least_between(at_least_0(hn::Sub(rho0, error)), at_least_0(hn::Sub(rho1, error)),
                              (stretch.end - stretch.begin) * more),
                constant(stretch.end * stretch.spread * more));
            const V<D> unrounded = hn::Div(constant(1), rho);
            const M<D> bounded = hn::And(
                hn::Gt(rho, zero), hn::Lt(hn::Mul(e.extra, unrounded), constant(greatest_outward)));
            const M<D> is_point = hn::Eq(e.extra, zero);
            inverse = hn::IfThenElse(bounded, hn::Mul(unrounded, constant(more)), constant(-1));
            inverse = hn::IfThenZeroElse(is_point, inverse);
            smooth = hn::And(smooth, hn::Ge(inverse, zero));
            outward = hn::Mul(e.extra, at_least_0(inverse));
            hn::StoreU(inverse, d, &active.inverse[i]);
            // no f'' is known of the others
            const V<D> slope = hn::Mul(hn::Mul(hn::Abs(e.strength), hn::Sqrt(e.inverse_square)),
                                       hn::Mul(constant(2 * more), slope_of<kind>(least, peak)));
            kinks = hn::Add(kinks, hn::IfThenElseZero(hn::AndNot(smooth, valid), slope));
        } else {
            hn::StoreU(zero, d, &active.inverse[i]);  // those of the next group follow
        }
        const Bend bend = bend_of<shape, kind>(e, stretch, error, least, most, peak, outward);
        const M<D> adds = hn::Gt(e.strength, zero);
        const V<D> weight =
            hn::IfThenElseZero(smooth, hn::Mul(hn::Abs(e.strength), e.inverse_square));
        rise = hn::MulAdd(hn::IfThenElse(adds, bend.rise, bend.fall), weight, rise);
        fall = hn::MulAdd(hn::IfThenElse(adds, bend.fall, bend.rise), weight, fall);
    }
    sums.rise += sum_of(rise);
    sums.fall += sum_of(fall);
    sums.kinks += sum_of(kinks);
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
    const D d;
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
    HWY_ALIGN double lane[HWY_MAX_BYTES / sizeof(double)];
    hn::Store(c, d, lane);
    for (std::size_t k = 0; k < hn::Lanes(d); ++k) lane[k] = offset(o, lane[k], t, direction);
    return hn::Load(d, lane);
#endif
}

// Rounding errors of one entry, with u the unit roundoff of its stage, eta the error of `away` and
// eta_slope that of its direction, both in widths. Blinn's: the computed s is off by
//     ds <= 2 sqrt(s) eta + eta^2 + 9 u s,
// five roundings of the square, one of 1 / w^2 and two of 1 / ln 2; 2^-x adds 2 u, so that with
// e^ds <= 1.02 |dk| <= 1.02 e^-s (ds + 2 u). (For s in the hundreds e^ds is larger, but then
// e^-(s - least) or e^-s itself leaves nothing to bound.) Now e^-s s^(j/2) <= peak (sqrt(least) +
// c_j)^j with c_j < 1, since sqrt(s) <= sqrt(least) + sqrt(s - least) and the suprema of y^(j/2)
// e^-y are 0.43, 0.37, 0.41 for j = 1, 2, 3. With r = sqrt(least) + 1 that is at most
//     |dF|  <= |b| peak (3 eta r + 13 u r^2),
//     |dF'| <= 2 |b| / w peak (4 eta_slope r^2 + 40 u r^3),
// the second from |d(k x)| <= |dk| sqrt(s) + 1.02 k (eta_slope + 5 u sqrt(s)) and four more
// roundings. The other kernels: |k'| <= 3, |k''| <= 20.25, s <= 1 where k is not 0, and ten
// roundings.
struct EntryErrors {
    V<D> value, slope;
};

template <KernelKind kind>
HWY_INLINE EntryErrors errors_of(double u, V<D> eta, V<D> eta_slope, V<D> least, V<D> peak) {
    if constexpr (kind == KernelKind::blinn) {
        const V<D> r = hn::Add(hn::Sqrt(least), constant(1));
        const V<D> scaled = hn::Mul(peak, r);
        return {hn::Mul(scaled, hn::MulAdd(constant(13 * u), r, hn::Mul(constant(3), eta))),
                hn::Mul(hn::Mul(scaled, r),
                        hn::MulAdd(constant(40 * u), r, hn::Mul(constant(4), eta_slope)))};
    }
    return {hn::MulAdd(constant(8), eta, constant(60 * u)),
            hn::MulAdd(constant(60), eta_slope, constant(300 * u))};
}

// |away| as computed is off by `eta` in widths. With t |d - axis| and |t - middle| at most H, (2)
// costs 7 u H for p (d - axis, the product; t - middle, d, the product; the sum), 2 u |c - M| and
// u^2 of its terms for c, and u (H + |c - M|) the difference. The foot moves away by 10 u |p - c|
// more at the most; so does the circle's axis, whose rho and 1 / rho are off by 6 u, and rho by
// `least_rho` below which it does not come. A segment whose 1 / |m|^2 counts as 0 stands for its
// end a.
template <Shape shape>
HWY_INLINE EntryErrors etas(double u, double H, double end, double least_rho, const Seen<shape>& e,
                            V<D> c_length, V<D> inverse, V<D> inverse_width) {
    const V<D> v_length = hn::Add(constant(H), c_length);
    V<D> eta = hn::MulAdd(constant(4 * u), c_length, constant(8 * u * H));
    eta = hn::MulAdd(hn::Add(e.far, constant(end)), constant(0x1p-98), eta);
    V<D> eta_slope = hn::Zero(D());
    if constexpr (shape == Shape::segment) {
        eta = hn::MulAdd(constant(2), eta,
                         hn::MulAdd(constant(12 * u), v_length, hn::Mul(constant(3 * u), e.size)));
        eta = hn::Add(eta, hn::IfThenElseZero(hn::Eq(e.extra, hn::Zero(D())), e.size));
    } else if constexpr (shape == Shape::circle) {
        eta =
            hn::MulAdd(constant(3), eta,
                       hn::MulAdd(constant(24 * u), v_length, hn::Mul(constant(10 * u), e.extra)));
        eta = hn::Add(eta, constant(least_rho));
        eta_slope = hn::Mul(hn::Mul(e.extra, at_least_0(inverse)),
                            hn::MulAdd(constant(4), eta, hn::Mul(constant(24 * u), v_length)));
    }
    const V<D> scale = hn::Mul(inverse_width, constant(more));
    return {hn::Mul(eta, scale), hn::Mul(hn::Add(eta, eta_slope), scale)};
}

constexpr std::size_t lanes_at_most = HWY_MAX_BYTES / sizeof(double);

// One stage of a window. Real: float for the coarse one, whose lengths are in units of `unit`.
template <class Real, Shape shape, KernelKind kind>
void enter_group(const Field& field, const Stretch& stretch, double scale, double unit, double cut,
                 const ActiveElements& active, std::size_t first, std::size_t end, double middle,
                 std::vector<BundleEntry<Real>>& entries, std::uint32_t* elements,
                 std::uint32_t& count, StageSums& sums) {
    constexpr bool is_coarse = sizeof(Real) == sizeof(float);
    constexpr double u = is_coarse ? 0x1p-24 : 0x1p-53;
    const D d;
    const I di;
    const std::size_t N = hn::Lanes(d);
    const V<D> zero = hn::Zero(d);
    const double H =
        0.5 * (stretch.end - stretch.begin) * more + stretch.end * stretch.spread * more;
    const double least_rho = std::sqrt(double{least_square<Real>}) * (is_coarse ? unit : 1) * more;
    V<D> error = zero, slope = zero, magnitude = zero, full_slope = zero;
    V<D> rest_above = zero, rest_below = zero;
    M<D> bad = hn::FirstN(d, 0);
    alignas(64) double column[10][lanes_at_most] = {};
    for (std::size_t i = first; i < end; i += N) {
        const hn::Vec<I> index = hn::LoadU(di, &active.element[i]);
        const M<D> valid = hn::FirstN(d, end - i);
        const Seen<shape> e(field, stretch, scale, index);
        const V<D> inverse_width = hn::GatherIndex(d, field.inverse_width.data(), index);
        const V<D> least = hn::LoadU(d, &active.least[i]);
        const V<D> peak = hn::LoadU(d, &active.peak[i]);
        const V<D> inverse = hn::LoadU(d, &active.inverse[i]);
        const M<D> kinked = hn::Lt(inverse, zero);
        const V<D> strength = hn::Abs(e.strength);
        const V<D> value = hn::Mul(hn::Mul(strength, peak), constant(more));
        const V<D> per_length = hn::Mul(hn::Mul(constant(2 * more), strength), inverse_width);
        const V<D> whole = hn::Mul(per_length, slope_of<kind>(least, peak));

        // c - M
        const V<D> cx = hn::Neg(offset_lanes(
            stretch.origin.x, hn::GatherIndex(d, field.ax.data(), index), middle, stretch.axis.x));
        const V<D> cy = hn::Neg(offset_lanes(
            stretch.origin.y, hn::GatherIndex(d, field.ay.data(), index), middle, stretch.axis.y));
        const V<D> cz = hn::Neg(offset_lanes(
            stretch.origin.z, hn::GatherIndex(d, field.az.data(), index), middle, stretch.axis.z));
        const V<D> c_length = hn::Mul(length_of({cx, cy, cz}), constant(more));
        const EntryErrors eta =
            etas<shape>(u, H, stretch.end, least_rho, e, c_length, inverse, inverse_width);
        const EntryErrors off = errors_of<kind>(u, eta.value, eta.slope, least, peak);

        const M<D> enters = is_coarse ? hn::AndNot(hn::Le(value, constant(cut)), valid) : valid;
        const M<D> leaves = hn::AndNot(enters, valid);
        const M<D> adds = hn::Gt(e.strength, zero);
        const V<D> left = hn::IfThenElseZero(leaves, value);
        rest_above = hn::Add(rest_above, hn::IfThenElseZero(adds, left));
        rest_below = hn::Add(rest_below, hn::IfThenZeroElse(adds, left));
        full_slope = hn::Add(full_slope, hn::IfThenElseZero(valid, whole));
        const V<D> slope_off =
            hn::IfThenElse(hn::Or(kinked, leaves), whole, hn::Mul(per_length, off.slope));
        slope = hn::Add(slope, hn::IfThenElseZero(valid, slope_off));
        error = hn::Add(error, hn::IfThenElseZero(enters, hn::Mul(strength, off.value)));
        magnitude = hn::Add(magnitude, hn::IfThenElseZero(enters, value));

        const V<D> per_unit = constant(is_coarse ? 1 / unit : 1);
        const V<D> square = hn::Mul(e.inverse_square, constant(is_coarse ? unit * unit : 1));
        V<D> extra = e.extra;
        V<D> m_scale = constant(1);
        if constexpr (is_coarse && shape == Shape::segment) {
            extra = hn::Mul(extra, constant(unit * unit));
            m_scale = per_unit;
        } else if constexpr (is_coarse && shape == Shape::circle) {
            extra = hn::Mul(extra, per_unit);
        }
        M<D> fit = hn::Lt(eta.value, constant(5e-4));
        if constexpr (is_coarse) {
            // 1 / |m|^2 of a very short segment and such are beyond float.
            const V<D> largest = hn::Max(square, strength);
            fit = hn::And(
                fit, hn::And(hn::Lt(eta.slope, constant(1e-2)), hn::Lt(largest, constant(1e12))));
            if constexpr (shape != Shape::point) fit = hn::And(fit, hn::Lt(extra, constant(1e12)));
        }
        bad = hn::Or(bad, hn::AndNot(fit, enters));

        hn::Store(hn::Mul(cx, per_unit), d, column[0]);
        hn::Store(hn::Mul(cy, per_unit), d, column[1]);
        hn::Store(hn::Mul(cz, per_unit), d, column[2]);
        hn::Store(hn::Mul(square, constant(argument_scale<kind>)), d, column[3]);
        hn::Store(e.strength, d, column[4]);
        hn::Store(hn::IfThenZeroElse(kinked, hn::Mul(hn::Mul(constant(2), e.strength), square)), d,
                  column[5]);
        if constexpr (shape != Shape::point) {
            hn::Store(hn::Mul(e.m.x, m_scale), d, column[6]);
            hn::Store(hn::Mul(e.m.y, m_scale), d, column[7]);
            hn::Store(hn::Mul(e.m.z, m_scale), d, column[8]);
            hn::Store(extra, d, column[9]);
        }
        std::uint8_t bits[8] = {};
        hn::StoreMaskBits(d, enters, bits);
        for (std::size_t k = 0; k < N; ++k) {
            if ((bits[k / 8] >> (k % 8) & 1) == 0) continue;
            const auto c = [&](std::size_t j) { return static_cast<Real>(column[j][k]); };
            elements[entries.size()] = static_cast<std::uint32_t>(active.element[i + k]);
            entries.push_back({c(0), c(1), c(2), c(3), c(4), c(5), c(6), c(7), c(8), c(9)});
            ++count;
        }
    }
    sums.error += sum_of(error);
    sums.slope += sum_of(slope);
    sums.magnitude += sum_of(magnitude);
    sums.full_slope += sum_of(full_slope);
    sums.rest_above += sum_of(rest_above);
    sums.rest_below += sum_of(rest_below);
    sums.usable = sums.usable && hn::AllFalse(d, bad);
}

StageSums coarse(const Field& field, const Stretch& stretch, double scale, double unit, double cut,
                 const ActiveElements& active, Window& window) {
    StageSums sums;
    window.coarse.clear();
    window.coarse_count.fill(0);
    window.coarse_element.resize(active.size());
    for_all_groups([&]<Shape shape, KernelKind kind>(std::size_t group) HWY_ATTR {
        const std::size_t first = active.first[group], end = active.first[group + 1];
        if (first == end) return;
        enter_group<float, shape, kind>(field, stretch, scale, unit, cut, active, first, end,
                                        window.middle, window.coarse, window.coarse_element.data(),
                                        window.coarse_count[group], sums);
    });
    return sums;
}

StageSums fine(const Field& field, const Stretch& stretch, double scale,
               const ActiveElements& active, Window& window) {
    StageSums sums;
    window.fine.clear();
    window.fine_count.fill(0);
    window.fine_element.resize(active.size());
    for_all_groups([&]<Shape shape, KernelKind kind>(std::size_t group) HWY_ATTR {
        const std::size_t first = active.first[group], end = active.first[group + 1];
        if (first == end) return;
        enter_group<double, shape, kind>(field, stretch, scale, 1, 0, active, first, end,
                                         window.middle, window.fine, window.fine_element.data(),
                                         window.fine_count[group], sums);
    });
    return sums;
}

}  // namespace

const BundleSteps& bundle_steps_of_target() {
    static const BundleSteps steps{bound, bound_clusters, bend, coarse, fine};
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

void ActiveElements::end(std::size_t count) {
    first[field_groups] = static_cast<std::uint32_t>(count);
    std::fill_n(element.begin() + static_cast<std::ptrdiff_t>(count), room, 0);
}

}  // namespace ivory
#endif
