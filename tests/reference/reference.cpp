#include "tests/reference/reference.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "tests/reference/outward_double.h"

namespace ivory::reference {

namespace {

// The elements that matter on a part of the ray; the others together are within `rest`.
template <class I>
struct Active {
    std::vector<std::size_t> elements;
    Germ<I> rest{I(0), I(0)};
};

// f and df/dt along o + t d 2^exponent. Elements are prepared when first asked for.
template <class I>
class FieldAlongRay {
  public:
    FieldAlongRay(const ReferenceField& field, const Ray& ray, long exponent, const I& threshold)
        : field_(field),
          ray_(ray),
          exponent_(exponent),
          threshold_(threshold),
          prepared_(field.joint().size()) {}

    Germ<I> element(std::size_t i, const I& t) {
        auto& prepared = prepared_[i];
        if (!prepared) {
            prepared = std::make_unique<ElementAlongRay<I>>(field_.joint()[i], ray_, exponent_);
        }
        return prepared->over(t);
    }

    Germ<I> over(const I& t, const Active<I>& active) {
        Germ<I> sum{active.rest.value - threshold_, active.rest.slope};
        for (const std::size_t i : active.elements) add(sum, element(i, t));
        return sum;
    }

    static void add(Germ<I>& sum, const Germ<I>& term) {
        sum.value = sum.value + term.value;
        sum.slope = sum.slope + term.slope;
    }

  private:
    const ReferenceField& field_;
    const Ray& ray_;
    long exponent_;
    I threshold_;
    std::vector<std::unique_ptr<ElementAlongRay<I>>> prepared_;
};

template <class I>
bool certainly_not_zero(const I& x) {
    return certainly_positive(x) || certainly_negative(x);
}

template <class I>
bool certainly_opposite(const I& x, const I& y) {
    return (certainly_positive(x) && certainly_negative(y)) ||
           (certainly_negative(x) && certainly_positive(y));
}

template <class I>
bool certainly_alike(const I& x, const I& y) {
    return (certainly_positive(x) && certainly_positive(y)) ||
           (certainly_negative(x) && certainly_negative(y));
}

// A point inside (a, b), at an odd fraction: roots of handmade scenes lie at halves and quarters,
// and a root at an end of an interval cannot be told by its sign.
constexpr double odd_fraction = 0.48731846292715;

double inside(double a, double b) { return a + (b - a) * odd_fraction; }

Real inside(const Real& a, const Real& b) {
    const Real part =
        rounded(mpfr_mul, MPFR_RNDN, rounded(mpfr_sub, MPFR_RNDN, b, a), Real(odd_fraction));
    return rounded(mpfr_add, MPFR_RNDN, a, part);
}

// The search from the left, first in doubles, then, for what they leave open, in the field's bits.
class Search {
  public:
    Search(const ReferenceField& field, const Ray& ray, double threshold_scale)
        : field_(field),
          exponent_(-binary_exponent(ray.direction)),
          exact_threshold_(RealInterval(field.threshold()) * RealInterval(threshold_scale)),
          rough_(field, ray, exponent_, OutwardDouble(exact_threshold_)),
          exact_(field, ray, exponent_, exact_threshold_),
          ray_(ray) {
        least_width_ = std::numeric_limits<double>::infinity();
        for (const Element& element : field.elements()) {
            least_width_ = std::min(least_width_, element.width);
        }
    }

    ReferenceAnswer run() {
        Active<OutwardDouble> all;
        for (std::size_t i = 0; i < field_.joint().size(); ++i) all.elements.push_back(i);
        const std::optional<OutwardDouble> range = reach<OutwardDouble>();
        if (!range) return {Outcome::miss, {}};
        ReferenceAnswer answer;
        if (range->hi <= 1e300) {
            answer = search_rough(range->lo, range->hi, std::move(all));
        } else {  // beyond the doubles: the field's bits all the way
            const std::optional<RealInterval> wide = reach<RealInterval>();
            if (!wide) return {Outcome::miss, {}};
            answer = search_exact(wide->lo, wide->hi, exactly(all));
        }
        answer.t.lo = scaled(answer.t.lo, exponent_);
        answer.t.hi = scaled(answer.t.hi, exponent_);
        return answer;
    }

  private:
    static Active<RealInterval> exactly(const Active<OutwardDouble>& active) {
        return {active.elements,
                {reference::exactly(active.rest.value), reference::exactly(active.rest.slope)}};
    }

    // The part of t >= 0 that can hold roots: where f = 0, some element of positive strength, of n,
    // has F >= T/n, so its skeleton is within w q with b k(q) = T/n, here with T/(2 n) and q a bit
    // greater. The skeleton lies in a ball of known centre and radius. Nothing where no t >= 0
    // does.
    template <class I>
    std::optional<I> reach() const {
        double positive = 0;
        for (const ReadyElement& ready : field_.joint()) positive += ready.element.strength > 0;
        const double threshold = OutwardDouble(exact_threshold_).lo;
        const Triple<I> o = triple<I>(ray_.origin), d = triple<I>(ray_.direction, exponent_);
        const I d2 = norm2(d), length = sqrt(d2);
        std::optional<I> range;
        for (const ReadyElement& ready : field_.joint()) {
            const Element& element = ready.element;
            if (element.strength <= 0) continue;
            double q = 1;
            if (element.kernel == Kernel::blinn) {
                const double q2 = std::log(element.strength) - std::log(threshold) +
                                  std::log(2 * positive) + 1e-9;
                if (q2 < 0) continue;
                q = std::sqrt(q2) * (1 + 1e-9);
            }
            const auto [center, radius] = ball<I>(element.skeleton);
            const I foot = inner(minus(center, o), d) / d2;
            const I half = (radius + I(element.greatest_width()) * I(q)) / length;
            const I lo = foot - half, hi = foot + half;
            if (hi.hi < 0) continue;
            const I part = lo.lo > 0 ? from_to(lo, hi) : from_to(I(0), hi);
            range = range ? hull(*range, part) : part;
        }
        return range;
    }

    // A ball around the skeleton; a polygon's vertices come no farther from the first one where they
    // are projected on a plane through it.
    template <class I>
    static std::pair<Triple<I>, I> ball(const Skeleton& skeleton) {
        const Triple<I> center = triple<I>(first_place(skeleton));
        const auto around = [&](const std::vector<Vec3d>& places) {
            I square(0);
            for (const Vec3d& place : places) {
                const I own = norm2(minus(triple<I>(place), center));
                if (own.hi > square.hi) square = own;
            }
            return I(sqrt(square).hi);
        };
        struct Radius {
            const decltype(around)& from;
            I operator()(const Point&) const { return I(0); }
            I operator()(const Segment& s) const { return from({s.b}); }
            I operator()(const Circle& s) const { return I(s.radius); }
            I operator()(const Disc& s) const { return I(s.radius); }
            I operator()(const Polygon& s) const { return from(s.vertices); }
            I operator()(const Curve& s) const { return from(s.control_points); }
            I operator()(const Polyline& s) const { return from(s.points); }
        };
        return {center, std::visit(Radius{around}, skeleton)};
    }

    // As FieldAlongRay::over; `shorter` gets the elements that add less than 2^-200 T (256 bits) to f
    // here.
    Germ<OutwardDouble> over(const OutwardDouble& t, const Active<OutwardDouble>& active,
                             Active<OutwardDouble>& shorter) {
        const double little = std::ldexp(field_.threshold(), -static_cast<int>(share_of_bits(200)));
        Germ<OutwardDouble> sum{active.rest.value - OutwardDouble(exact_threshold_),
                                active.rest.slope};
        shorter.rest = active.rest;
        for (const std::size_t i : active.elements) {
            const Germ<OutwardDouble> germ = rough_.element(i, t);
            FieldAlongRay<OutwardDouble>::add(sum, germ);
            const double value = std::max(std::fabs(germ.value.lo), std::fabs(germ.value.hi));
            const double slope = std::max(std::fabs(germ.slope.lo), std::fabs(germ.slope.hi));
            if (value < little && slope * least_width_ < little) {
                FieldAlongRay<OutwardDouble>::add(shorter.rest, germ);
            } else {
                shorter.elements.push_back(i);
            }
        }
        return sum;
    }

    // In doubles; `lo` to `hi` of scaled t. An interval is dropped where f is certainly not 0: by
    // its enclosure, by its mean value form, or since f is monotone and its ends have one sign.
    // Where doubles see a root or nothing at all, more bits are asked.
    ReferenceAnswer search_rough(double lo, double hi, Active<OutwardDouble> all) {
        struct Part {
            double lo, hi;
            std::shared_ptr<const Active<OutwardDouble>> active;
        };
        std::vector<Part> open{{lo, hi, std::make_shared<Active<OutwardDouble>>(std::move(all))}};
        for (int count = 0; !open.empty(); ++count) {
            Part part = std::move(open.back());
            open.pop_back();
            if (count > 100000) {
                return {Outcome::unknown, RealInterval(Real(part.lo), Real(hi))};
            }
            const OutwardDouble t(part.lo, part.hi);
            Active<OutwardDouble> shorter;
            const Germ<OutwardDouble> range = over(t, *part.active, shorter);
            if (certainly_not_zero(range.value)) continue;
            if (4 * shorter.elements.size() <= 3 * part.active->elements.size()) {
                part.active = std::make_shared<Active<OutwardDouble>>(std::move(shorter));
            }
            const double middle = inside(part.lo, part.hi);
            const OutwardDouble at_middle = rough_.over(middle, *part.active).value;
            if (certainly_not_zero(at_middle + range.slope * (t - OutwardDouble(middle)))) continue;

            bool ask = !certainly_not_zero(at_middle) || !(part.lo < middle && middle < part.hi) ||
                       t.width() <= 1e-11 * (part.hi + least_width_);
            if (!ask && certainly_not_zero(range.slope)) {
                const OutwardDouble first = rough_.over(part.lo, *part.active).value;
                const OutwardDouble last = rough_.over(part.hi, *part.active).value;
                if (certainly_alike(first, last)) continue;
                ask = true;
                if (certainly_opposite(first, last)) {
                    const OutwardDouble root = close_in(t, *part.active);
                    part.lo = root.lo;
                    part.hi = root.hi;
                }
            }
            if (ask) {
                const ReferenceAnswer answer =
                    search_exact(Real(part.lo), Real(part.hi), exactly(*part.active));
                if (answer.outcome != Outcome::miss) return answer;
            } else {
                open.push_back({middle, part.hi, part.active});
                open.push_back({part.lo, middle, part.active});
            }
        }
        return {Outcome::miss, {}};
    }

    // The one root of t, on which f is monotone, in a part of t as narrow as doubles can prove; an
    // ulp wider, so that its ends are not roots.
    OutwardDouble close_in(const OutwardDouble& whole, const Active<OutwardDouble>& active) {
        OutwardDouble t = whole;
        for (int count = 0; count < 100; ++count) {
            const double middle = inside(t.lo, t.hi);
            const OutwardDouble slope = rough_.over(t, active).slope;
            if (!certainly_not_zero(slope)) break;
            const OutwardDouble newton =
                OutwardDouble(middle) - rough_.over(middle, active).value / slope;
            const OutwardDouble next = common(newton, t);
            if (!(next.width() <= 0.75 * t.width())) break;
            t = next;
        }
        return common(OutwardDouble::around(t.lo, t.hi), whole);
    }

    // In the field's bits, likewise, and with interval Newton steps N = m - f(m) / f'([t]): all roots of
    // [t] lie in N, and if N lies in [t] there is one (f is Lipschitz, f' holds the slopes of both
    // sides of a kink, so that the mean value theorem stands).
    ReferenceAnswer search_exact(const Real& lo, const Real& hi,
                                 const Active<RealInterval>& active) {
        if (mpfr_zero_p(lo.raw())) {  // a root at t = 0 counts, and has no other side
            const RealInterval start = exact_.over(RealInterval(lo), active).value;
            if (start.lo.is_zero() && start.hi.is_zero()) return {Outcome::hit, RealInterval(lo)};
        }
        std::vector<RealInterval> open{RealInterval(lo, hi)};
        for (int count = 0; !open.empty(); ++count) {
            const RealInterval t = std::move(open.back());
            open.pop_back();
            if (count > 20000) return {Outcome::unknown, RealInterval(t.lo, hi)};
            const Germ<RealInterval> range = exact_.over(t, active);
            if (certainly_not_zero(range.value)) continue;
            const Real middle = inside(t.lo, t.hi);
            const RealInterval at_middle = exact_.over(RealInterval(middle), active).value;
            if (certainly_not_zero(at_middle + range.slope * (t - RealInterval(middle)))) continue;

            if (certainly_not_zero(range.slope)) {
                const RealInterval first = exact_.over(RealInterval(t.lo), active).value;
                const RealInterval last = exact_.over(RealInterval(t.hi), active).value;
                if (certainly_alike(first, last)) continue;
                if (certainly_opposite(first, last)) return {Outcome::hit, polish(t, active)};
                const RealInterval newton = RealInterval(middle) - at_middle / range.slope;
                if (newton.hi < t.lo || newton.lo > t.hi) continue;
                if (newton.lo >= t.lo && newton.hi <= t.hi) {
                    return {Outcome::hit, polish(newton, active)};
                }
                const RealInterval rest = common(newton, t);
                if (narrow(rest, 133)) return {Outcome::unknown, rest};
                if (much_narrower(rest, t)) {
                    open.push_back(rest);
                    continue;
                }
            }
            if (narrow(t, certainly_not_zero(at_middle) ? 113 : 66)) {
                return {Outcome::unknown, t};
            }
            open.push_back(RealInterval(middle, t.hi));
            open.push_back(RealInterval(t.lo, middle));
        }
        return {Outcome::miss, {}};
    }

    // t holds exactly one root, and f is monotone on it.
    RealInterval polish(RealInterval t, const Active<RealInterval>& active) {
        for (int count = 0; count < share_of_bits(300) && !narrow(t, 113); ++count) {
            const Real middle = inside(t.lo, t.hi);
            const RealInterval value = exact_.over(RealInterval(middle), active).value;
            const RealInterval slope = exact_.over(t, active).slope;
            if (!certainly_not_zero(slope)) break;
            const RealInterval next = common(RealInterval(middle) - value / slope, t);
            if (!much_narrower(next, t)) return next;
            t = next;
        }
        return t;
    }

    // Of so many of 256 bits: 2^-113 is some 1e-34, 2^-66 some 1e-20.
    bool narrow(const RealInterval& t, long bits) const {
        const Real size = rounded(mpfr_add, MPFR_RNDN, t.hi, Real(least_width_));
        return t.width() <= scaled(size, -share_of_bits(bits));
    }
    static bool much_narrower(const RealInterval& part, const RealInterval& whole) {
        return part.width() <= rounded(mpfr_mul, MPFR_RNDN, whole.width(), Real(0.75));
    }

    const ReferenceField& field_;
    long exponent_;  // scaled t = t 2^-exponent_, so that the scaled direction is about 1 long
    RealInterval exact_threshold_;
    FieldAlongRay<OutwardDouble> rough_;
    FieldAlongRay<RealInterval> exact_;
    const Ray& ray_;
    double least_width_;
};

}  // namespace

ReferenceAnswer first_root(const ReferenceField& field, const Ray& ray, double threshold_scale) {
    const WithBits with_bits(field.bits());
    return Search(field, ray, threshold_scale).run();
}

ReferenceField::ReferenceField(const ReferenceScene& scene, long bits)
    : bits_(bits), threshold_(scene.threshold) {
    const WithBits with_bits(bits_);
    for (const Element& element : scene.elements) {
        if (!element.visible) continue;
        elements_.push_back(element);
        ready_.emplace_back(element);
    }
    join();
}

// No sum of doubles needs more bits than all of their exponents and a few.
void ReferenceField::join() {
    const auto alike = [](const Element& a, const Element& b) {
        return a.kernel == b.kernel && a.width == b.width && a.widths == b.widths &&
               a.skeleton == b.skeleton;
    };
    const WithBits all_bits(std::max(bits_, 2200L));
    for (const ReadyElement& ready : ready_) {
        const auto known = std::find_if(
            joint_.begin(), joint_.end(),
            [&](const ReadyElement& other) { return alike(other.element, ready.element); });
        if (known == joint_.end()) {
            joint_.push_back(ready);
        } else {
            known->strength = known->strength + ready.strength;
        }
    }
    for (ReadyElement& one : joint_) one.element.strength = one.strength.hi.to_double(MPFR_RNDU);
}

Germ<RealInterval> ReferenceField::along(const Ray& ray, const RealInterval& t,
                                         double threshold_scale) const {
    const WithBits with_bits(bits_);
    Germ<RealInterval> sum{-(RealInterval(threshold_) * RealInterval(threshold_scale)), 0.0};
    for (const ReadyElement& element : ready_) {
        FieldAlongRay<RealInterval>::add(sum,
                                         ElementAlongRay<RealInterval>(element, ray, 0).over(t));
    }
    return sum;
}

namespace {

// s = q^2 and its gradient in space: an independent second way, from the nearest point of the
// skeleton, used for normals and colours.
template <class I>
struct SpaceGerm {
    I value;
    Triple<I> slope;
};

template <class I>
SpaceGerm<I> from_nearest(const Triple<I>& away, const I& w) {
    const I w2 = sqr(w);
    return {norm2(away) / w2, times(away, I(2) / w2)};
}

template <class I>
SpaceGerm<I> square_in_space(const Point& point, const Triple<I>& p, const I& w) {
    return from_nearest(minus(p, triple<I>(point.position)), w);
}

template <class I>
SpaceGerm<I> square_in_space(const Segment& segment, const Triple<I>& p, const I& w) {
    const Triple<I> a = triple<I>(segment.a), b = triple<I>(segment.b);
    const Triple<I> m = minus(b, a), from_a = minus(p, a);
    if (segment.a == segment.b) return from_nearest(from_a, w);
    return from_nearest(minus(from_a, times(m, clamped(inner(from_a, m) / norm2(m)))), w);
}

template <class I>
SpaceGerm<I> square_in_space(const Circle& circle, const Triple<I>& p, const I& w) {
    const Triple<I> n = unit<I>(circle.normal);
    const Triple<I> u = minus(p, triple<I>(circle.center));
    if (circle.radius == 0) return from_nearest(u, w);
    const I h = inner(u, n), rho = sqrt(norm2(outer(n, u)));
    const Triple<I> off_axis = minus(u, times(n, h));
    const I excess = rho - I(circle.radius), w2 = sqr(w);
    SpaceGerm<I> germ{(sqr(excess) + sqr(h)) / w2, {}};
    for (std::size_t k = 0; k < 3; ++k) {  // all numbers on the axis: there is no gradient there
        germ.slope[k] = I(2) * (excess * (off_axis[k] / rho) + h * n[k]) / w2;
    }
    return germ;
}

// From the nearest point: the centre and the foot in the plane, drawn in to the rim.
template <class I>
SpaceGerm<I> square_in_space(const Disc& disc, const Triple<I>& p, const I& w) {
    const Triple<I> n = unit<I>(disc.normal), u = minus(p, triple<I>(disc.center));
    const Triple<I> up = times(n, inner(u, n)), off_axis = minus(u, up);
    const I r(disc.radius), rho2 = norm2(off_axis);
    if (sqr(r).lo >= rho2.hi) return from_nearest(up, w);
    const I drawn_in = clamped(r / sqrt(rho2));
    return from_nearest(minus(u, times(off_axis, drawn_in)), w);
}

// The conical part of a taper: with y = p - a and |y x m|^2 = r^2 |m|^2, the formula
// 1 / s = kappa^2 + (W / r)^2 is s = |y x m|^2 / N, N = |m|^2 w^2 + 2 dw w y.m + dw^2 |y|^2.
template <class I>
std::optional<SpaceGerm<I>> conical_square(const Element& element, const Triple<I>& p) {
    const auto* segment = std::get_if<Segment>(&element.skeleton);
    if (segment == nullptr || element.widths.empty()) return std::nullopt;
    const I w(element.widths[0]), dw = I(element.widths[1]) - w;
    const Triple<I> a = triple<I>(segment->a), m = minus(triple<I>(segment->b), a), y = minus(p, a);
    const I along = inner(y, m), y2 = norm2(y), m2 = norm2(m);
    const I foot = along * w + dw * y2, whole = m2 * w + dw * along;
    if (!certainly_positive(foot) || !certainly_positive(whole - foot)) return std::nullopt;
    const I below = m2 * sqr(w) + I(2) * dw * w * along + sqr(dw) * y2;
    if (!certainly_positive(below)) return std::nullopt;
    SpaceGerm<I> germ{norm2(outer(y, m)) / below, {}};
    for (std::size_t k = 0; k < 3; ++k) {
        const I above_rise = I(2) * (m2 * y[k] - along * m[k]);
        const I below_rise = I(2) * dw * (w * m[k] + dw * y[k]);
        germ.slope[k] = (above_rise - germ.value * below_rise) / below;
    }
    return germ;
}

// s and grad s, whose components enclose those of all feet.
template <class I>
SpaceGerm<I> square_in_space(const ReadyElement& ready, const Triple<I>& p) {
    const Element& element = ready.element;
    const I w(element.width);
    if (ready.bodies) {
        if (const auto cone = conical_square(element, p)) return *cone;
        const Triple<I> x = divided(minus(p, triple<I>(first_place(element.skeleton))), w);
        const Feet<I> feet = feet_of(*ready.bodies, x);
        SpaceGerm<I> germ{feet.least(), feet.all().front().pull};
        for (const Foot<I>& foot : feet.all()) germ.slope = hull(germ.slope, foot.pull);
        germ.slope = times(germ.slope, I(2) / w);
        return germ;
    }
    return std::visit(
        [&](const auto& skeleton) -> SpaceGerm<I> {
            if constexpr (requires { square_in_space(skeleton, p, w); }) {
                return square_in_space(skeleton, p, w);
            } else {
                return {};  // these have bodies
            }
        },
        element.skeleton);
}

// F and grad F of one element at p.
template <class I>
SpaceGerm<I> field_in_space(const ReadyElement& ready, const Triple<I>& p) {
    const SpaceGerm<I> s = square_in_space(ready, p);
    const Germ<I> k = kernel_germ(ready.element.kernel, s.value);
    const I b(ready.element.strength);
    return {b * k.value, times(s.slope, b * k.slope)};
}

// Feet that a move of 1e-6 widths could make the nearest one, with pulls that differ.
bool is_near_kink(const ReadyElement& ready, const Triple<OutwardDouble>& p) {
    constexpr double near = 1e-6;
    const Element& element = ready.element;
    const OutwardDouble w(element.width);
    if (const auto* circle = std::get_if<Circle>(&element.skeleton)) {
        if (circle->radius == 0) return false;
        const auto u = minus(p, triple<OutwardDouble>(circle->center));
        return sqrt(norm2(outer(unit<OutwardDouble>(circle->normal), u))).lo < near * element.width;
    }
    if (!ready.bodies) return false;
    const auto x = divided(minus(p, triple<OutwardDouble>(first_place(element.skeleton))), w);
    const double q = std::sqrt(feet_of(*ready.bodies, x).least().hi);
    const Feet<OutwardDouble> feet = feet_of(*ready.bodies, x, 4 * near * (q + near));
    Triple<OutwardDouble> pull = feet.all().front().pull;
    for (const auto& foot : feet.all()) pull = hull(pull, foot.pull);
    double spread = 0;
    for (const OutwardDouble& component : pull) spread = std::max(spread, component.width());
    return spread > 1e-3 * q;
}

double greatest(const OutwardDouble& x) { return std::max(std::fabs(x.lo), std::fabs(x.hi)); }

}  // namespace

PointValue ReferenceField::at(const Ray& ray, const Real& t) const {
    using Exact = RealInterval;
    using Rough = OutwardDouble;
    const WithBits with_bits(bits_);
    Triple<Exact> p = triple<Exact>(ray.origin);
    const Triple<Exact> d = triple<Exact>(ray.direction);
    for (std::size_t k = 0; k < 3; ++k) p[k] = p[k] + Exact(t) * d[k];
    const Triple<Rough> rough_p{Rough(p[0]), Rough(p[1]), Rough(p[2])};

    PointValue result;
    result.f = -Exact(threshold_);
    Exact weights(0.0);
    for (const ReadyElement& ready : ready_) {
        const Element& element = ready.element;
        SpaceGerm<Exact> germ;
        const SpaceGerm<Rough> rough = field_in_space(ready, rough_p);
        double size = greatest(rough.value);
        for (const Rough& slope : rough.slope) {
            size = std::max(size, greatest(slope) * element.width);
        }
        if (size < 1e-40 * threshold_) {  // too little to be worth many bits
            germ = {exactly(rough.value),
                    {exactly(rough.slope[0]), exactly(rough.slope[1]), exactly(rough.slope[2])}};
        } else {
            germ = field_in_space(ready, p);
        }
        const Exact& field = germ.value;
        const Exact weight(field.lo < 0 ? Real(0) : field.lo, field.hi < 0 ? Real(0) : field.hi);
        const Triple<Exact> color = triple<Exact>(element.color);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            result.gradient[axis] = result.gradient[axis] + germ.slope[axis];
            result.color[axis] = result.color[axis] + weight * color[axis];
        }
        weights = weights + weight;
        result.f = result.f + field;
        result.element.push_back(field);
        result.rise.push_back(germ.slope);
        result.near_kink.push_back(is_near_kink(ready, rough_p));
    }
    for (Exact& component : result.color) {
        if (mpfr_sgn(weights.hi.raw()) > 0) component = component / weights;
    }
    return result;
}

}  // namespace ivory::reference
