#include "tests/reference/verdict.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace ivory::reference {

namespace {

double length(const Vec3d& v) { return std::hypot(v.x, v.y, v.z); }

Real magnitude(const RealInterval& x) {
    const Real lo = rounded(mpfr_abs, MPFR_RNDU, x.lo), hi = rounded(mpfr_abs, MPFR_RNDU, x.hi);
    return lo < hi ? hi : lo;
}

bool has_bracket(const Claim& claim) {
    return claim.status != Claim::Status::miss && claim.status != Claim::Status::claimed_miss;
}
// An unresolved bracket may be endless.
bool is_malformed(const Claim& claim) {
    if (!has_bracket(claim)) return false;
    const bool ends = claim.status != Claim::Status::unresolved || !std::isinf(claim.hi);
    return !(0 <= claim.lo && claim.lo <= claim.hi && std::isfinite(claim.lo)) ||
           (ends && !std::isfinite(claim.hi));
}

Real middle_of(const Claim& claim) {
    return scaled(rounded(mpfr_add, MPFR_RNDN, Real(claim.lo), Real(claim.hi)), -1);  // exact
}

// The width of the element with the greatest |F_i|: the greater one where two are alike.
double leading_width(const ReferenceField& field, const PointValue& point) {
    Real greatest(0.0);
    for (const RealInterval& value : point.element) {
        const RealInterval size = sqrt(sqr(value));
        if (greatest < size.lo) greatest = size.lo;
    }
    double width = 0;
    for (std::size_t i = 0; i < point.element.size(); ++i) {
        if (magnitude(point.element[i]) >= greatest) {
            width = std::max(width, field.elements()[i].width);
        }
    }
    return width;
}

// t_hi - t_lo > max(E w / |d|, 16 ulp(t_hi)) for certain.
bool certainly_too_wide(const ReferenceField& field, const Ray& ray, double tolerance,
                        const Claim& claim) {
    const RealInterval width = RealInterval(claim.hi) - RealInterval(claim.lo);
    const double ulp = std::nextafter(claim.hi, std::numeric_limits<double>::infinity()) - claim.hi;
    if (width.lo <= scaled(Real(ulp), 4)) return false;
    const RealInterval d = sqrt(norm2(triple<RealInterval>(ray.direction)));
    const auto allowed = [&](double w) { return RealInterval(tolerance) * RealInterval(w) / d; };
    double least = std::numeric_limits<double>::infinity();
    for (const Element& element : field.elements()) least = std::min(least, element.width);
    if (width.lo <= allowed(least).lo) return false;
    return width.lo > allowed(leading_width(field, field.at(ray, middle_of(claim)))).hi;
}

// No root on [0, t.lo), and one on t: true, false, or nothing where that cannot be told.
std::optional<bool> holds_first_root(const ReferenceField& field, const Ray& ray,
                                     const Claim& claim, const ReferenceAnswer& reference) {
    const Real lo(claim.lo), hi(claim.hi);
    const RealInterval& root = reference.t;
    if (reference.outcome == Outcome::miss) return false;
    if (root.lo > hi) return false;
    if (reference.outcome == Outcome::hit) {
        if (root.hi < lo) return false;
        if (root.lo >= lo && root.hi <= hi) return true;
    }
    const RealInterval first = field.along(ray, RealInterval(lo)).value;
    const RealInterval last = field.along(ray, RealInterval(hi)).value;
    const auto exactly_zero = [](const RealInterval& x) {
        return x.lo.is_zero() && x.hi.is_zero();
    };
    const bool holds_one = exactly_zero(first) || exactly_zero(last) ||
                           (certainly_positive(first) && certainly_negative(last)) ||
                           (certainly_negative(first) && certainly_positive(last));
    // The reference's root, the first one, is at most at root.hi: an exact root at t_lo within
    // root is that one.
    const bool none_before = root.lo >= lo || (reference.outcome == Outcome::hit &&
                                               exactly_zero(first) && root.hi >= lo);
    if (holds_one && none_before) return true;
    return std::nullopt;
}

double norm(const Triple<RealInterval>& v) { return sqrt(norm2(v)).hi.to_double(MPFR_RNDU); }

double normal_error(const ReferenceField& field, const PointValue& point, double w,
                    const Vec3d& normal) {
    const RealInterval steepness = sqrt(norm2(point.gradient));
    double rises = 0;
    for (const auto& rise : point.rise) rises += norm(rise);
    const double least = std::max(1e-4 * rises, 1e-6 * field.threshold() / w);
    if (!(steepness.lo.to_double() >= least)) return Verdict::nothing;
    for (std::size_t i = 0; i < point.rise.size(); ++i) {
        if (point.near_kink[i] && norm(point.rise[i]) > 1e-9 * rises) return Verdict::nothing;
    }
    Triple<RealInterval> difference;
    for (std::size_t k = 0; k < 3; ++k) {
        difference[k] = RealInterval(normal[k]) + point.gradient[k] / steepness;
    }
    return norm(difference);
}

double color_error(const ReferenceField& field, const PointValue& point, const Vec3d& color) {
    double positive = 0;
    for (const RealInterval& value : point.element) positive += std::max(0.0, value.lo.to_double());
    if (positive < field.threshold() / 2) return Verdict::nothing;
    double error = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const Real difference = magnitude(RealInterval(color[k]) - point.color[k]);
        error = std::max(error, difference.to_double(MPFR_RNDU));
    }
    return error;
}

// The element nearest to the ray at t, or, without t, to the whole ray, found by a rough search:
// this only sorts rays, it proves nothing.
struct Nearest {
    double size = 0;   // L
    double width = 1;  // w
};

// From p to the skeleton of an element that has one width.
double distance(const ReadyElement& ready, const Vec3d& p) {
    const ElementAlongRay<OutwardDouble> still(ready, {p, {0, 0, 1}}, 0);
    return std::sqrt(still.square(OutwardDouble(0)).value.hi) * ready.element.width;
}
ReadyElement with_one_width(const ReadyElement& ready) {
    if (ready.element.widths.empty()) return ready;
    Element element = ready.element;
    element.widths.clear();
    return ReadyElement(element);
}

// How far a skeleton reaches from its first place.
struct Reach {
    const Vec3d& from;

    double operator()(const Point&) const { return 0; }
    double operator()(const Segment& s) const { return to({s.b}); }
    double operator()(const Circle& s) const { return s.radius; }
    double operator()(const Disc& s) const { return s.radius; }
    double operator()(const Polygon& s) const { return to(s.vertices); }
    double operator()(const Curve& s) const { return to(s.control_points); }
    double operator()(const Polyline& s) const { return to(s.points); }

  private:
    [[nodiscard]] double to(const std::vector<Vec3d>& places) const {
        double farthest = 0;
        for (const Vec3d& p : places) {
            farthest = std::max(farthest, length({p.x - from.x, p.y - from.y, p.z - from.z}));
        }
        return farthest;
    }
};

Nearest nearest(const ReferenceField& field, const Ray& ray, const ReferenceAnswer& known) {
    const auto at = [&](double t) {
        return Vec3d{std::fma(t, ray.direction.x, ray.origin.x),
                     std::fma(t, ray.direction.y, ray.origin.y),
                     std::fma(t, ray.direction.z, ray.origin.z)};
    };
    const double d = length(ray.direction);
    double least = std::numeric_limits<double>::infinity();
    Nearest result;
    for (const ReadyElement& written : field.ready()) {
        const ReadyElement ready = with_one_width(written);
        const Element& element = ready.element;
        const Vec3d c = first_place(element.skeleton);
        const Vec3d from{ray.origin.x - c.x, ray.origin.y - c.y, ray.origin.z - c.z};
        double own = std::numeric_limits<double>::infinity();
        if (known.outcome == Outcome::hit) {
            own = distance(ready, at(known.t.lo.to_double()));
        } else {
            const double foot = -(from.x * (ray.direction.x / d) + from.y * (ray.direction.y / d) +
                                  from.z * (ray.direction.z / d));
            const double reach = std::visit(Reach{c}, element.skeleton);
            for (int step = -16; step <= 16; ++step) {
                const double along = std::max(0.0, foot + reach * step / 16.0);
                own = std::min(own, distance(ready, at(along / d)));
            }
        }
        if (own < least) {
            least = own;
            result = {std::max({std::fabs(from.x), std::fabs(from.y), std::fabs(from.z)}),
                      element.width};
        }
    }
    return result;
}

}  // namespace

const char* word(Fault fault) {
    switch (fault) {
        case Fault::none:
            return "right";
        case Fault::malformed:
            return "malformed";
        case Fault::wrong_hit:
            return "wrong hit";
        case Fault::wrong_miss:
            return "wrong miss";
        case Fault::wrong_bracket:
            return "wrong bracket";
        case Fault::too_wide:
            return "too wide";
        case Fault::false_claim:
            return "false claim";
    }
    return "";
}

Ruling rule(const ReferenceField& field, const Ray& ray, double tolerance, const Claim& claim) {
    const WithBits with_bits(field.bits());
    Ruling ruling;
    if (is_malformed(claim)) {
        ruling.fault = Fault::malformed;
        return ruling;
    }
    ruling.reference = first_root(field, ray);
    const ReferenceAnswer& reference = ruling.reference;
    const bool is_hit = reference.outcome == Outcome::hit;
    ruling.undecided = reference.outcome == Outcome::unknown;
    switch (claim.status) {
        case Claim::Status::miss:
            if (is_hit) ruling.fault = Fault::wrong_miss;
            break;
        case Claim::Status::claimed_miss:
            if (is_hit) ruling.fault = Fault::false_claim;
            break;
        case Claim::Status::claimed_hit:
            if (reference.outcome == Outcome::miss) ruling.fault = Fault::false_claim;
            break;
        case Claim::Status::unresolved: {
            if (reference.outcome == Outcome::miss) break;
            if (std::isinf(claim.hi)) {
                if (is_hit && reference.t.hi < Real(claim.lo)) ruling.fault = Fault::wrong_bracket;
                break;
            }
            const std::optional<bool> right = holds_first_root(field, ray, claim, reference);
            if (right == false && is_hit) ruling.fault = Fault::wrong_bracket;
            // Where all that is known is that no root lies in it, there may be none at all.
            ruling.undecided = !right || (right == false && !is_hit);
            break;
        }
        case Claim::Status::hit: {
            const std::optional<bool> right = holds_first_root(field, ray, claim, reference);
            ruling.undecided = !right;
            if (right == false) {
                ruling.fault = Fault::wrong_hit;
            } else if (certainly_too_wide(field, ray, tolerance, claim)) {
                ruling.fault = Fault::too_wide;
            }
            break;
        }
    }
    return ruling;
}

Verdict check(const ReferenceField& field, const Ray& ray, double tolerance, const Claim& claim) {
    const WithBits with_bits(field.bits());
    Verdict verdict;
    static_cast<Ruling&>(verdict) = rule(field, ray, tolerance, claim);
    if (verdict.fault == Fault::malformed || !has_bracket(claim)) return verdict;
    if (std::isinf(claim.hi)) {  // without a middle there is no normal and no colour to judge
        verdict.bracket = claim.hi;
        return verdict;
    }

    const Real m = middle_of(claim);
    const PointValue point = field.at(ray, m);
    const double w = leading_width(field, point);
    const RealInterval d = sqrt(norm2(triple<RealInterval>(ray.direction)));
    const RealInterval span = (RealInterval(claim.hi) - RealInterval(claim.lo)) * d;
    if (w > 0) {
        verdict.bracket = (span / RealInterval(w)).hi.to_double();
        verdict.normal_error = normal_error(field, point, w, claim.normal);
        verdict.color_error = color_error(field, point, claim.color);
    }
    if (verdict.reference.outcome == Outcome::hit) {
        verdict.root_error = magnitude((RealInterval(m) - verdict.reference.t) * d).to_double();
    }
    return verdict;
}

bool decidable(const ReferenceField& field, const Ray& ray, double tolerance,
               const ReferenceAnswer& known) {
    const WithBits with_bits(field.bits());
    if (known.outcome == Outcome::unknown) return false;
    const Nearest near = nearest(field, ray, known);
    const double shift = std::min(1e-11 * std::max(1.0, near.size / near.width), 1e-3);
    const ReferenceAnswer lower = first_root(field, ray, 1 - shift);
    const ReferenceAnswer upper = first_root(field, ray, 1 + shift);
    if (lower.outcome != known.outcome || upper.outcome != known.outcome) return false;
    if (known.outcome == Outcome::miss) return true;
    const RealInterval d = sqrt(norm2(triple<RealInterval>(ray.direction)));
    const RealInterval allowed = RealInterval(tolerance) * RealInterval(near.width) / d;
    return magnitude(lower.t - upper.t) <= allowed.lo &&
           magnitude(lower.t - known.t) <= allowed.lo && magnitude(upper.t - known.t) <= allowed.lo;
}

}  // namespace ivory::reference
