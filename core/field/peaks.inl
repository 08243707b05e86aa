// What elements can add to the field on a stretch of a bundle: upper bounds of |F|, by which those
// that do not matter leave the list.
#if defined(IVORY_CORE_FIELD_PEAKS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef IVORY_CORE_FIELD_PEAKS_INL
#undef IVORY_CORE_FIELD_PEAKS_INL
#else
#define IVORY_CORE_FIELD_PEAKS_INL
#endif

#include <array>
#include <cstdint>

#include "core/field/joined.inl"

#ifndef IVORY_CORE_FIELD_PEAKS_TABLES
#define IVORY_CORE_FIELD_PEAKS_TABLES
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

HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {
namespace {

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

// The sums of peaks, lane by lane: of what is kept and of what is left out, apart what adds to the
// field and what takes away from it.
template <class Tag>
struct PeakLanes {
    V<Tag> above, magnitude, left_out_above, left_out_below;

    HWY_INLINE PeakLanes() {
        above = magnitude = left_out_above = left_out_below = hn::Zero(Tag());
    }
    HWY_INLINE void add(M<Tag> keep, M<Tag> leave, V<Tag> adds, V<Tag> takes) {
        left_out_above = hn::Add(left_out_above, hn::IfThenElseZero(leave, adds));
        left_out_below = hn::Add(left_out_below, hn::IfThenElseZero(leave, takes));
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
        sums.left_out_above += sum_of(left_out_above);
        sums.left_out_below += sum_of(left_out_below);
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
    const std::size_t kept_before = count;
    PeakLanes<D> peaks;
    for (std::size_t i = first; i < end; i += N) {
        const hn::Vec<I> index = hn::LoadU(di, &candidates.element[i]);
        const M<D> valid = hn::FirstN(d, end - i);
        const auto e = seen_active<shape>(field, stretch, scale, candidates, i);
        const DistanceRange<D> range =
            LanesOfShape<shape>::distances(e, reach, error_of(d, e.magnitude, reach));
        const V<D> least =
            hn::Mul(hn::Mul(square_of(range.near), e.inverse_square), constant(less));
        const V<D> peak = LanesOf<kind>::peak(d, least);
        const V<D> value = hn::Mul(hn::Mul(hn::Abs(e.strength), peak), constant(more));
        // not a number: kept
        M<D> keep = valid;
        if constexpr (!joined<shape>) {
            keep = hn::AndNot(hn::Le(value, constant(cut)), valid);
            peaks.add(keep, hn::AndNot(keep, valid), e.strength, value, d);
        }
        const Kept<D> lanes(d, keep);
        lanes.put(di, index, &kept.element[count]);
        lanes.put(d, least, &kept.least[count]);
        if constexpr (has_axis<shape>) {
            const V<D> most =
                hn::Mul(hn::Mul(square_of(range.far), e.inverse_square), constant(more));
            lanes.put(d, most, &kept.most[count]);
        }
        lanes.put(d, peak, &kept.peak[count]);
        if constexpr (narrows<shape>) {
            lanes.put(d, e.m.x, &kept.piece_middle[count]);
            lanes.put(d, e.m.y, &kept.piece_half[count]);
        }
        count += lanes.count();
    }
    peaks.add_to(sums);
    if constexpr (joined<shape>) {
        const auto element = [&](std::size_t i) {
            return static_cast<std::size_t>(kept.element[i]);
        };
        count = join_parts(
            kept, kept_before, count, cut, more,
            [&](std::size_t i) { return field.strength[element(i)] * scale; },
            [&](std::size_t i) { return field.source[element(i)]; },
            [&](std::size_t from, std::size_t to) {
                kept.element[to] = kept.element[from];
                kept.least[to] = kept.least[from];
                kept.most[to] = kept.most[from];
                kept.peak[to] = kept.peak[from];
                kept.piece_middle[to] = kept.piece_middle[from];
                kept.piece_half[to] = kept.piece_half[from];
            },
            sums);
    }
}

PeakSums bound(const Field& field, const Stretch& stretch, double scale, double cut,
               const ActiveElements& candidates, ActiveElements& kept) {
    kept.make_room(candidates.size());
    kept.is_whole = false;
    PeakSums sums;
    std::size_t count = 0;
    GroupStarts& starts = kept.first;
    starts.clear();
    for_groups_of(candidates.first,
                  [&]<Shape shape, KernelKind kind>(std::size_t group, std::size_t first,
                                                    std::size_t end) HWY_ATTR {
                      starts.begin(group, count);
                      bound_group<shape, kind>(field, stretch, scale, cut, candidates, first, end,
                                               kept, count, sums);
                  });
    starts.end(count);
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
        const V<D> nearest =
            nearest_of_rays(d, FromAxis<D>(v, stretch.axis), aside_of(d, size, reach), reach,
                            error_of(d, size, reach));
        const V<D> near = at_least_0(hn::Sub(nearest, radius));
        const V<D> least =
            hn::Mul(hn::Mul(square_of(near), column(clusters.inverse_square)), constant(less));
        const V<D> peak = hn::Mul(LanesOf<kind>::peak(d, least), constant(scale * more));
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
    GroupStarts& starts = kept.first;
    starts.clear();
    for_groups_of(candidates.first,
                  [&]<Shape shape, KernelKind kind>(std::size_t group, std::size_t first,
                                                    std::size_t end) HWY_ATTR {
                      starts.begin(group, count);
                      bound_cluster_group<kind>(field.clusters, stretch, scale, cut, candidates,
                                                first, end, kept, count, sums);
                  });
    starts.end(count);
    kept.end(count);
    return sums;
}

// The valid ones from `first` on; their places, less `place`, are those of `candidates`.
template <Shape shape, KernelKind kind>
HWY_INLINE void bound_local_lanes(const LocalElements& candidates,
                                  const PartNumbers<float>& numbers, std::size_t first, M<F> valid,
                                  const Reach<float>& reach, const Vec3<float>& place, float cut,
                                  LocalElements* kept, std::size_t& count, PeakLanes<F>& peaks) {
    const F d;
    const hn::RebindToSigned<F> di;
    const V<F> widened = hn::Set(d, Margins<float>::more),
               reduced = hn::Set(d, Margins<float>::less);
    const auto e = seen_local<shape>(candidates, numbers, reach, first);
    const DistanceRange<F> range =
        LanesOfShape<shape>::distances(e, reach, error_of(d, e.magnitude, reach));
    const V<F> least = hn::Mul(hn::Mul(square_of(range.near), e.inverse_square), reduced);
    const V<F> peak = LanesOf<kind>::peak(d, least);
    const V<F> value = hn::Mul(hn::Mul(hn::Abs(e.strength), peak), widened);
    // not a number: kept
    M<F> keep = valid;
    if (!joined<shape> || kept == nullptr) {  // without a list parts are added up, which bounds too
        keep = hn::AndNot(hn::Le(value, hn::Set(d, cut)), valid);
        peaks.add(keep, hn::AndNot(keep, valid), e.strength, value, d);
    }
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
    if constexpr (has_axis<shape>) {
        put(e.m.x, kept->mx);
        put(e.m.y, kept->my);
        put(e.m.z, kept->mz);
        put(e.parameter, kept->parameter);
        if constexpr (tapers<shape>) {
            put(e.taper_rate, kept->taper_rate);
        }
        if constexpr (has_length<shape>) put(e.size, kept->length);
        put(hn::Mul(hn::Mul(square_of(range.far), e.inverse_square), widened), kept->most);
    }
    put(least, kept->least);
    put(peak, kept->peak);
    lanes.put(di, hn::LoadU(di, &candidates.element[first]), &kept->element[count]);
    if constexpr (joined<shape>) {
        lanes.put(di, hn::LoadU(di, &candidates.source[first]), &kept->source[count]);
    }
    count += lanes.count();
}

void join_parts(LocalElements& kept, std::size_t first, double cut, std::size_t& count,
                PeakSums& sums) {
    count = join_parts(
        kept, first, count, cut, double{Margins<float>::more},
        [&](std::size_t i) { return double{kept.strength[i]}; },
        [&](std::size_t i) { return kept.source[i]; },
        [&](std::size_t from, std::size_t to) { move_local(kept, from, to); }, sums);
}

template <Shape shape, KernelKind kind>
void bound_local_group(const LocalElements& candidates, const LocalStretch& stretch, float cut,
                       std::size_t first, std::size_t end, LocalElements& kept, std::size_t& count,
                       PeakSums& sums) {
    const F d;
    const Reach<float> reach = reach_of(stretch, candidates);
    const std::size_t kept_before = count;
    PeakLanes<F> peaks;
    for (std::size_t i = first; i < end; i += hn::Lanes(d)) {
        bound_local_lanes<shape, kind>(candidates, candidates.numbers, i, hn::FirstN(d, end - i),
                                       reach, {}, cut, &kept, count, peaks);
    }
    peaks.add_to(sums);
    if constexpr (joined<shape>) join_parts(kept, kept_before, double{cut}, count, sums);
}

PeakSums bound_local(const LocalElements& candidates, const LocalStretch& stretch, double cut,
                     LocalElements& kept) {
    kept.make_room(candidates.size());
    kept.magnitude = candidates.magnitude;
    kept.numbers = candidates.numbers;
    PeakSums sums;
    std::size_t count = 0;
    GroupStarts& starts = kept.first;
    starts.clear();
    for_groups_of(candidates.first,
                  [&]<Shape shape, KernelKind kind>(std::size_t group, std::size_t first,
                                                    std::size_t end) HWY_ATTR {
                      starts.begin(group, count);
                      bound_local_group<shape, kind>(candidates, stretch, static_cast<float>(cut),
                                                     first, end, kept, count, sums);
                  });
    starts.end(count);
    return sums;
}

// A cluster's centre in double is off by 2^-50 of its distance from the origin; its members are as
// far from it as they say, to 2^-24 of its radius. Moved by its centre, rounded, and rounded once
// more they are off by less than 2^-23 of both together.
template <Shape shape, KernelKind kind>
void bound_member_group(const Field& field, const Stretch& bundle, double middle,
                        const LocalStretch& stretch, float cut, const ActiveElements& active,
                        std::size_t first, std::size_t end, LocalElements* kept, std::size_t& count,
                        PeakSums& sums) {
    const F d;
    const Clusters& clusters = field.clusters;
    const Reach<float> reach = reach_of(stretch);
    const double per_unit = 1 / field.unit;
    const auto place = [&](double center, double origin, double axis) {
        return static_cast<float>(((center - origin) - middle * axis) * per_unit);
    };
    const std::size_t kept_before = count;
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
            bound_local_lanes<shape, kind>(clusters.members, field.all_numbers_in_units(), e,
                                           hn::FirstN(d, last - e), from_center, center, cut, kept,
                                           count, peaks);
        }
        if (count > before) {
            kept->magnitude = std::fmax(
                kept->magnitude, aside + static_cast<float>(clusters.radius[cluster] * per_unit) +
                                     reach.t_offset * 0x1p-26F);
        }
    }
    peaks.add_to(sums);
    if constexpr (joined<shape>) {
        if (kept != nullptr) join_parts(*kept, kept_before, double{cut}, count, sums);
    }
}

PeakSums bound_members(const Field& field, const Stretch& bundle, double middle,
                       const LocalStretch& stretch, double cut, const ActiveElements& clusters,
                       LocalElements* kept) {
    if (kept != nullptr) {
        kept->make_room(clusters.size() * cluster_size);
        kept->magnitude = 0;
        kept->numbers = field.all_numbers_in_units();
    }
    PeakSums sums;
    std::size_t count = 0;
    GroupStarts none;
    GroupStarts& starts = kept != nullptr ? kept->first : none;
    starts.clear();
    for_groups_of(
        clusters.first, [&]<Shape shape, KernelKind kind>(std::size_t group, std::size_t first,
                                                          std::size_t end) HWY_ATTR {
            starts.begin(group, count);
            bound_member_group<shape, kind>(field, bundle, middle, stretch, static_cast<float>(cut),
                                            clusters, first, end, kept, count, sums);
        });
    starts.end(count);
    return sums;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();

#endif
