#include "core/field/inclusion.h"

#include <algorithm>
#include <optional>
#include <span>
#include <variant>

#include "core/interval/quick.h"

namespace ivory {
namespace {

constexpr double u = unit_roundoff;

// The field of one element of strength 1 over [t0, t1].
using Terms = KernelAlong;

// k over a thin [s], by one evaluation where the kernel knows how.
template <class K>
Interval<double> over_thin(const Interval<double>& s) {
    if constexpr (!K::ends) {
        if (s.hi < infinity<double>) return K::thin(s);
    }
    return kernel_over<K>(s);
}

// Any kernel, from ranges of s, s' and s'': k(s(t))' = k' s', k(s(t))'' = k'' s'^2 + k' s''.
template <class K>
Terms composed(const Interval<double>& s0, const Interval<double>& ds0, const Interval<double>& s1,
               const Interval<double>& s, const Interval<double>& ds, const Interval<double>& dds) {
    Terms k;
    const KernelRange range = kernel_range<K>(s);
    k.left = over_thin<K>(s0);
    k.right = over_thin<K>(s1);
    if constexpr (K::ends) {
        k.left_slope = is_empty(s0)
                           ? Interval<double>::entire()
                           : quick::mul({K::slope_at(s0.lo).lo, K::slope_at(s0.hi).hi}, ds0);
    } else {
        k.left_slope = quick::mul(K::slope_over(k.left, s0.lo, s0.hi), ds0);
    }
    k.value = range.k;
    k.slope = quick::mul(range.dk, ds);
    k.curvature = quick::add(quick::mul(range.ddk, quick::sqr(ds)), quick::mul(range.dk, dds));
    return k;
}

Terms composed(KernelKind kernel, const Interval<double>& s0, const Interval<double>& ds0,
               const Interval<double>& s1, const Interval<double>& s, const Interval<double>& ds,
               const Interval<double>& dds) {
    return with_kernel(kernel, [&]<class K>() { return composed<K>(s0, ds0, s1, s, ds, dds); });
}

Terms parabola(KernelKind kernel, const MovingSquare& square, double peak, double t0, double t1) {
    return with_kernel(kernel, [&]<class K>() {
        // Sharper than what follows from the ranges of s, s' and s''.
        if constexpr (requires { K::along_parabola(square, peak, t0, t1); }) {
            return K::along_parabola(square, peak, t0, t1);
        } else {
            const SquareAt a = square.at(t0), b = square.at(t1);
            const Interval<double> ds{a.ds - a.ds_radius, b.ds + b.ds_radius};  // s' rises
            return composed<K>(a.value(), a.slope(), b.value(), square.over(a, b), ds,
                               square.curvature());
        }
    });
}

// Of two parts of one element: the greater k. Where one is below the other all along, it has no say;
// else it may be either that k' and k'' are of (core/shape/joined.h).
Terms greater(const Terms& a, const Terms& b) {
    if (a.value.hi < b.value.lo) return b;
    if (b.value.hi < a.value.lo) return a;
    const auto most = [](const Interval<double>& x, const Interval<double>& y) {
        return Interval<double>(std::max(x.lo, y.lo), std::max(x.hi, y.hi));
    };
    return {most(a.left, b.left),   most(a.right, b.right),
            most(a.value, b.value), hull(a.left_slope, b.left_slope),
            hull(a.slope, b.slope), hull(a.curvature, b.curvature)};
}

Terms hull(const Terms& a, const Terms& b) {
    return {hull(a.left, b.left),   hull(a.right, b.right),
            hull(a.value, b.value), hull(a.left_slope, b.left_slope),
            hull(a.slope, b.slope), hull(a.curvature, b.curvature)};
}

// Each piece over the part of the window in which it may be the nearest; s and s' pass continuously
// from piece to piece, s'' jumps, so the hull of the pieces' ranges encloses all three.
Terms form_over(const SquaresAlongRay& squares, const ElementAlongRay& e, double t0, double t1) {
    Terms sum;  // all empty
    for (const Piece& piece : squares.all()) {
        const double from = std::max(t0, piece.where.lo), to = std::min(t1, piece.where.hi);
        if (!(from <= to)) continue;
        Terms k = parabola(e.kernel, piece.square, e.peak, from, to);
        if (from > t0) k.left = k.left_slope = Interval<double>::empty_set();
        if (to < t1) k.right = Interval<double>::empty_set();
        sum = hull(sum, k);
    }
    return sum;
}

// A circle, a disc, a taper.
template <class Form>
Terms form_over(const Form& form, const ElementAlongRay& e, double t0, double t1) {
    const auto a = form.at(t0), b = form.at(t1);
    const SquareRange range = form.over(t0, t1, a, b);
    return composed(e.kernel, a.s, a.ds, b.s, range.s, range.ds, range.dds);
}

Terms form_over(const UnboundedAlongRay&, const ElementAlongRay&, double, double) {
    const Interval<double> k{0.0, 1.0};
    const Interval<double> all = Interval<double>::entire();
    return {k, k, k, all, all, all};
}

Terms element_over(const ElementAlongRay& e, double t0, double t1) {
    return std::visit([&](const auto& form) { return form_over(form, e, t0, t1); }, e.form);
}

Interval<double> form_at(const SquaresAlongRay& squares, const ElementAlongRay& e, double t) {
    Interval<double> k = Interval<double>::empty_set();
    for (const Piece& piece : squares.all()) {
        if (!(piece.where.lo <= t && t <= piece.where.hi)) continue;
        const SquareAt a = piece.square.at(t);
        k = hull(k, with_kernel(e.kernel, [&]<class K>() {
                     if constexpr (K::ends)
                         return kernel_over<K>(a.value());
                     else
                         return K::around(a.s, a.s_radius);
                 }));
    }
    return k;
}

template <class Form>
Interval<double> form_at(const Form& form, const ElementAlongRay& e, double t) {
    const Interval<double> s = form.at(t).s;
    return with_kernel(e.kernel, [&]<class K>() { return over_thin<K>(s); });
}

Interval<double> form_at(const UnboundedAlongRay&, const ElementAlongRay&, double) {
    return {0.0, 1.0};
}

Interval<double> element_at(const ElementAlongRay& e, double t) {
    return std::visit([&](const auto& form) { return form_at(form, e, t); }, e.form);
}

// What is known of k without looking closer: of most forms nothing.
Interval<double> rough_over(const ElementAlongRay& e, double t0, double t1) {
    const auto* const arc = std::get_if<CurveAlongRay>(&e.form);
    return arc != nullptr ? kernel_over(e.kernel, arc->rough_square(t0, t1))
                          : Interval<double>(0.0, 1.0);
}

// Of one element's parts, of which there is one at least, those near [t0, t1] that may be the nearest.
class NearParts {
  public:
    // Of all from the one at `first` on that join the next.
    NearParts(std::span<const ElementAlongRay> elements, std::size_t first, double t0, double t1)
        : t0_(t0), t1_(t1) {
        if (!std::holds_alternative<CurveAlongRay>(elements[first].form)) return;
        for (std::size_t i = first;; ++i) {
            const ElementAlongRay& e = elements[i];
            if (!is_far(e)) greatest_ = std::max(greatest_, rough_over(e, t0, t1).lo);
            if (!e.joins) break;
        }
    }
    [[nodiscard]] bool is_far(const ElementAlongRay& e) const {
        return e.active.hi < t0_ || e.active.lo > t1_;
    }
    [[nodiscard]] bool has_no_say(const ElementAlongRay& e) const {
        return greatest_ > 0 && rough_over(e, t0_, t1_).hi < greatest_;
    }

  private:
    double t0_, t1_;
    double greatest_ = 0;  // some part's k is at least that, all along
};

// A sum of intervals in plain doubles. n terms, each b k with one rounding, added one by one, err
// by at most (n + 2) u times the sum of their magnitudes, which `finish` subtracts and adds. A term
// that is unbounded on one side leaves the other side's bound alone.
class Sum {
  public:
    void add(double strength, const Interval<double>& k) {
        const double lo = strength > 0 ? strength * k.lo : strength * k.hi;
        const double hi = strength > 0 ? strength * k.hi : strength * k.lo;
        lo_ += lo;
        hi_ += hi;
        magnitude_lo_ += std::abs(lo);
        magnitude_hi_ += std::abs(hi);
    }
    [[nodiscard]] Interval<double> finish(std::size_t terms) const {
        const double relative = static_cast<double>(terms + 4) * 1.001 * u;
        const double lo = lo_ - (relative * magnitude_lo_ + 1e-300);
        const double hi = hi_ + (relative * magnitude_hi_ + 1e-300);
        // Overflow and NaN bound nothing.
        return {magnitude_lo_ < infinity<double> ? lo : -infinity<double>,
                magnitude_hi_ < infinity<double> ? hi : infinity<double>};
    }

  private:
    double lo_ = 0, hi_ = 0, magnitude_lo_ = 0, magnitude_hi_ = 0;
};

}  // namespace

void FieldAlongRay::build(const Field& field, const ElementList& list, const Vec3d& origin,
                          const Vec3d& direction, const Interval<double>& span) {
    elements_.clear();
    magnitude_ = 0;
    // All of f in units of a power of two near T: exact, but for strengths that overflow, which
    // then bound nothing, and what underflows beside T, which Sum's absolute term covers.
    threshold_ = std::frexp(field.threshold, &exponent_);
    Sum peaks, rest;
    const Interval<double> left_out(std::ldexp(list.left_out.lo, -exponent_),
                                    std::ldexp(list.left_out.hi, -exponent_));
    rest.add(1, left_out);
    peaks.add(1, left_out);
    peaks.add(-1, Interval<double>(threshold_));
    std::uint32_t last = 0;  // of those that are kept
    for (const std::uint32_t i : list.elements) {
        ElementAlongRay& element = elements_.emplace_back();
        along_ray(field, i, origin, direction, span, field.cut[i], element);
        element.strength = std::ldexp(element.strength, -exponent_);
        element.beyond = {std::ldexp(element.beyond.lo, -exponent_),
                          std::ldexp(element.beyond.hi, -exponent_)};
        // What is known of nothing but 0 <= k <= 1 would leave the derivatives unbounded; where it
        // is too weak to matter it only widens the rest.
        if (std::holds_alternative<UnboundedAlongRay>(element.form) &&
            std::abs(element.strength) <= 0x1p-50 / static_cast<double>(field.size())) {
            element.beyond = {std::min(element.strength, 0.0), std::max(element.strength, 0.0)};
            element.active = Interval<double>::empty_set();
        }
        if (is_empty(element.active)) {
            rest.add(1, element.beyond);
            peaks.add(1, element.beyond);
            elements_.pop_back();
            continue;
        }
        if (is_joined(field.shape[i]) && elements_.size() > 1 &&
            field.source[i] == field.source[last]) {
            elements_[elements_.size() - 2].joins = true;
        }
        last = i;
    }
    double peak = 0;  // of the parts so far of an element
    for (const ElementAlongRay& element : elements_) {
        peak = std::max(peak, element.peak);
        if (element.joins) continue;
        magnitude_ += std::abs(element.strength) * peak;
        if (element.strength > 0) peaks.add(element.strength, {0.0, peak});
        peak = 0;
    }
    rest_ = rest.finish(list.elements.size() + 1);
    peaks_ = peaks.finish(list.elements.size() + 2).hi;
}

Enclosure FieldAlongRay::over(double t0, double t1) const {
    Sum left, right, value, left_slope, slope, curvature, rest;
    rest.add(1, rest_);
    rest.add(-1, Interval<double>(threshold_));
    Terms parts;  // those of an element so far that are near
    bool has_parts = false, begins = true;
    std::optional<NearParts> near;
    for (std::size_t i = 0; i < elements_.size(); ++i) {
        const ElementAlongRay& e = elements_[i];
        if (begins) near.emplace(elements_, i, t0, t1);
        begins = !e.joins;
        const bool is_far = near->is_far(e);
        if (is_far) rest.add(1, e.beyond);
        if (is_far && !has_parts) continue;
        if (!is_far && !near->has_no_say(e)) {
            const Terms part = element_over(e, t0, t1);
            parts = has_parts ? greater(parts, part) : part;
            has_parts = true;
        }
        if (e.joins || !has_parts) continue;
        const Terms& k = parts;
        has_parts = false;
        left.add(e.strength, k.left);
        right.add(e.strength, k.right);
        value.add(e.strength, k.value);
        left_slope.add(e.strength, k.left_slope);
        slope.add(e.strength, k.slope);
        curvature.add(e.strength, k.curvature);
    }
    const std::size_t terms = elements_.size() + 2;
    const Interval<double> constant = rest.finish(terms);
    return {left.finish(terms) + constant,
            right.finish(terms) + constant,
            value.finish(terms) + constant,
            left_slope.finish(terms),
            slope.finish(terms),
            curvature.finish(terms)};
}

Interval<double> FieldAlongRay::at(double t) const {
    Sum value, rest;
    rest.add(1, rest_);
    rest.add(-1, Interval<double>(threshold_));
    Interval<double> parts = Interval<double>::empty_set();  // the greatest of an element so far
    bool begins = true;
    std::optional<NearParts> near;
    for (std::size_t i = 0; i < elements_.size(); ++i) {
        const ElementAlongRay& e = elements_[i];
        if (begins) near.emplace(elements_, i, t, t);
        begins = !e.joins;
        if (near->is_far(e)) {
            rest.add(1, e.beyond);
        } else if (!near->has_no_say(e)) {
            const Interval<double> k = element_at(e, t);
            parts = is_empty(parts)
                        ? k
                        : Interval<double>(std::max(parts.lo, k.lo), std::max(parts.hi, k.hi));
        }
        if (e.joins) continue;
        if (!is_empty(parts)) value.add(e.strength, parts);
        parts = Interval<double>::empty_set();
    }
    const std::size_t terms = elements_.size() + 2;
    return value.finish(terms) + rest.finish(terms);
}

}  // namespace ivory
