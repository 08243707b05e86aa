// The reference: exact field and first root of a scene along a ray, in intervals of 256 bits or more.
// Formulas: the scene format; nothing is shared with core but the type of three coordinates.
#pragma once

#include <vector>

#include "tests/reference/along_ray.h"
#include "tests/reference/from_core.h"
#include "tests/reference/multiprecision.h"
#include "tests/reference/ray.h"
#include "tests/reference/scene.h"

namespace ivory::reference {

// Everything about one point of space.
struct PointValue {
    RealInterval f;                          // sum of F_i - T
    std::vector<RealInterval> element;       // F_i of the visible elements
    std::vector<Triple<RealInterval>> rise;  // grad F_i; all numbers where it has none
    Triple<RealInterval> gradient;           // of f
    Triple<RealInterval> color;              // sum C_i max(F_i, 0) / sum max(F_i, 0)
    // Whether within some 1e-6 w of the point, w the element's width, the nearest point of its
    // skeleton jumps, so that grad F_i does.
    std::vector<bool> near_kink;
};

// The elements of a scene that are part of its field. Immutable; shared between threads freely.
class ReferenceField {
  public:
    explicit ReferenceField(const ReferenceScene& scene, long bits = least_bits);
    explicit ReferenceField(const Scene& scene);  // core's: from_core.cpp

    [[nodiscard]] long bits() const { return bits_; }  // of whatever is asked of it
    [[nodiscard]] double threshold() const { return threshold_; }
    [[nodiscard]] const std::vector<Element>& elements() const { return elements_; }  // visible
    [[nodiscard]] const std::vector<ReadyElement>& ready() const { return ready_; }   // the same
    // Those that have all but strength and colour in common as one: a wide interval of t would not
    // tell what is left of strengths that cancel.
    [[nodiscard]] const std::vector<ReadyElement>& joint() const { return joint_; }

    // At o + t d, t a point.
    [[nodiscard]] PointValue at(const Ray& ray, const Real& t) const;

    // f(o + t d) and df/dt for all t of the interval; at a kink the slope encloses both sides.
    [[nodiscard]] Germ<RealInterval> along(const Ray& ray, const RealInterval& t,
                                           double threshold_scale = 1) const;

  private:
    void join();

    long bits_;
    double threshold_;
    std::vector<Element> elements_;
    std::vector<ReadyElement> ready_, joint_;
};

enum class Outcome {
    hit,      // t encloses the first root t >= 0, to some 1e-30 of its size (256 bits) or better
    miss,     // no root t >= 0
    unknown,  // no root before t.lo; whether t holds one cannot be told with this precision
};

struct ReferenceAnswer {
    Outcome outcome = Outcome::unknown;
    RealInterval t;  // in units of |direction|
};

// The first root t >= 0 of f(o + t d), for the threshold T threshold_scale. Proved for every
// outcome.
[[nodiscard]] ReferenceAnswer first_root(const ReferenceField& field, const Ray& ray,
                                         double threshold_scale = 1);

}  // namespace ivory::reference
