// The kernels k(s), s = q^2, q = distance / width: F = b k(s). This is the only list of them; a
// kernel is a file, a line among the #includes, a word in `KernelKind` and one in `Kernels`.
//
// All fall, and all k' rise (each k is convex in s), so that ranges over [s] need only the ends.
// k'' falls on each piece; where it jumps a range holds both one-sided values.

#include "core/kernel/blinn.h"
#include "core/kernel/blobtree.h"
#include "core/kernel/murakami.h"
#include "core/kernel/nishimura.h"
#include "core/kernel/wyvill.h"

#ifndef IVORY_CORE_KERNEL_KERNELS_H
#define IVORY_CORE_KERNEL_KERNELS_H

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <string_view>

#include "core/interval/interval.h"
#include "core/math/type_list.h"

namespace ivory {

enum class KernelKind : unsigned char { blinn, nishimura, wyvill, murakami, blobtree };
using Kernels = TypeList<Blinn, Nishimura, Wyvill, Murakami, BlobTree>;

static_assert(index_in<Blinn, Kernels> == static_cast<std::size_t>(KernelKind::blinn));
static_assert(index_in<Nishimura, Kernels> == static_cast<std::size_t>(KernelKind::nishimura));
static_assert(index_in<Wyvill, Kernels> == static_cast<std::size_t>(KernelKind::wyvill));
static_assert(index_in<Murakami, Kernels> == static_cast<std::size_t>(KernelKind::murakami));
static_assert(index_in<BlobTree, Kernels> == static_cast<std::size_t>(KernelKind::blobtree));

// What the file of a kernel has to say. Units and meanings: core/kernel/blinn.h; the quick forms for
// SIMD, which are at the end of the same file, are asked for in core/kernel/kernel_lanes.inl.
template <class K>
concept Kernel = requires(double x, const Interval<double>& range) {
    { K::word } -> std::convertible_to<std::string_view>;     // in scene files
    { K::label } -> std::convertible_to<std::string_view>;    // in the viewer
    { K::formula } -> std::convertible_to<std::string_view>;  // of k, by q
    { K::source } -> std::convertible_to<std::string_view>;
    { K::ends } -> std::convertible_to<bool>;
    { K::at(x) } -> std::same_as<Interval<double>>;
    { K::slope_at(x) } -> std::same_as<Interval<double>>;
    { K::curvature_over(range, x, x) } -> std::same_as<Interval<double>>;
    { K::plain(x) } -> std::same_as<double>;
    { K::touching_point(x) } -> std::same_as<double>;
    { K::steepest_beyond(x) } -> std::same_as<double>;
}
&& (K::ends ? requires {
    { K::greatest_slope } -> std::convertible_to<double>;
    { K::greatest_curvature } -> std::convertible_to<double>;
    { K::greatest_root_slope } -> std::convertible_to<double>;
} : requires(double x) {
    { K::level(x) } -> std::same_as<double>;
    { K::vanishes } -> std::convertible_to<double>;
});

inline constexpr std::size_t kernel_count = Kernels::size;

template <class K>
inline constexpr KernelKind kind_of = static_cast<KernelKind>(index_in<K, Kernels>);
template <KernelKind kind>
using KernelOf = TypeAt<static_cast<std::size_t>(kind), Kernels>;

// visit.operator()<K>() of that kernel.
template <class Visit>
constexpr decltype(auto) with_kernel(KernelKind kind, const Visit& visit) {
    return with_type(Kernels{}, static_cast<std::size_t>(kind), visit);
}

// "blinn", ..., in the order of `KernelKind`: the words of the file format.
inline constexpr auto kernel_words = []<class... K>(TypeList<K...>) {
    static_assert((Kernel<K> && ...));
    return std::array<std::string_view, sizeof...(K)>{K::word...};
}(Kernels{});

[[nodiscard]] constexpr const char* kernel_word(KernelKind kind) {
    return kernel_words[static_cast<std::size_t>(kind)].data();  // a literal: it ends with a 0
}

[[nodiscard]] constexpr bool kernel_ends(KernelKind kind) {
    return with_kernel(kind, []<class K>() { return K::ends; });
}

// k at one double s >= 0, enclosed; 0 <= result <= 1.
inline Interval<double> kernel_at(KernelKind kind, double s) {
    return with_kernel(kind, [&]<class K>() { return K::at(s); });
}

// k'(s) at one double s >= 0, enclosed; never positive.
inline Interval<double> kernel_slope_at(KernelKind kind, double s) {
    return with_kernel(kind, [&]<class K>() { return K::slope_at(s); });
}

// The range of k over [s], s >= 0 where it matters: a lower end below 0 counts as 0.
template <class K>
Interval<double> kernel_over(const Interval<double>& s) {
    if (is_empty(s)) return {0.0, 1.0};  // lost to overflow: all that k can be
    return {K::at(s.hi).lo, K::at(std::max(s.lo, 0.0)).hi};
}

inline Interval<double> kernel_over(KernelKind kind, const Interval<double>& s) {
    return with_kernel(kind, [&]<class K>() { return kernel_over<K>(s); });
}

// The ranges of k, k' and k'' over [s].
template <class K>
KernelRange kernel_range(const Interval<double>& s) {
    KernelRange range;
    range.k = kernel_over<K>(s);
    if (is_empty(s)) {
        range.dk = range.ddk = Interval<double>::entire();
        return range;
    }
    const double s_lo = std::max(s.lo, 0.0);
    if constexpr (K::ends) {
        range.dk = {K::slope_at(s_lo).lo, K::slope_at(s.hi).hi};
        range.ddk = s_lo > 1 ? Interval<double>(0.0) : K::curvature_over(range.k, s_lo, s.hi);
    } else {
        range.dk = K::slope_over(range.k, s_lo, s.hi);
        range.ddk = K::curvature_over(range.k, s_lo, s.hi);
    }
    return range;
}

inline KernelRange kernel_range(KernelKind kind, const Interval<double>& s) {
    return with_kernel(kind, [&]<class K>() { return kernel_range<K>(s); });
}

}  // namespace ivory
#endif
