#include "tests/reference/from_core.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>

#include "core/scene/scene.h"
#include "core/trace/ray.h"
#include "tests/reference/reference.h"
#include "tests/reference/verdict.h"

namespace ivory::reference {

namespace {

// Each of core's shapes by the word that scene files have for it.
template <class S>
Skeleton skeleton_from_core(const S& s) {
    if constexpr (S::word == "point") {
        return Point{s.position};
    } else if constexpr (S::word == "segment") {
        return Segment{s.a, s.b};
    } else if constexpr (S::word == "circle") {
        return Circle{s.center, s.normal, s.radius};
    } else if constexpr (S::word == "disc") {
        return Disc{s.center, s.normal, s.radius};
    } else if constexpr (S::word == "polygon") {
        return Polygon{{s.vertices.begin(), s.vertices.end()}};
    } else if constexpr (S::word == "curve") {
        return Curve{{s.control_points.begin(), s.control_points.end()}};
    } else {
        static_assert(S::word == "polyline", "the reference does not know this shape");
        return Polyline{{s.points.begin(), s.points.end()}};
    }
}

// Widths that are written as a list, of elements that have such.
template <class E>
void widths_from_core(const E& element, Element& result) {
    if constexpr (requires { element.widths.size(); }) {
        result.widths.assign(element.widths.begin(), element.widths.end());
        if (result.widths.empty()) return;
        result.width = *std::min_element(result.widths.begin(), result.widths.end());
    }
}

}  // namespace

Kernel from_core(KernelKind kind) {
    const std::string_view word = kernel_word(kind);
    if (word == "blinn") return Kernel::blinn;
    if (word == "nishimura") return Kernel::nishimura;
    if (word == "wyvill") return Kernel::wyvill;
    if (word == "murakami") return Kernel::murakami;
    if (word == "blobtree") return Kernel::blobtree;
    throw std::logic_error("the reference does not know the kernel " + std::string(word));
}

Element from_core(const ivory::Element& element) {
    Element result;
    result.skeleton =
        std::visit([](const auto& s) { return skeleton_from_core(s); }, element.skeleton);
    result.kernel = from_core(element.kernel);
    result.strength = element.strength;
    result.width = element.width;
    widths_from_core(element, result);
    result.color = element.color;
    result.visible = element.visible;
    return result;
}

ReferenceScene from_core(const Scene& scene) {
    ReferenceScene result;
    result.threshold = scene.threshold;
    for (const ivory::Element& element : scene.elements) {
        result.elements.push_back(from_core(element));
    }
    return result;
}

Claim from_core(const Answer& answer) {
    const auto status = [&] {
        switch (answer.isolation.status) {
            case Status::hit:
                return Claim::Status::hit;
            case Status::miss:
                return Claim::Status::miss;
            case Status::unresolved:
                return Claim::Status::unresolved;
            case Status::claimed_hit:
                return Claim::Status::claimed_hit;
            case Status::claimed_miss:
                return Claim::Status::claimed_miss;
        }
        throw std::logic_error("the reference does not know the status");
    };
    return {status(), answer.isolation.t.lo, answer.isolation.t.hi, answer.surface.normal,
            answer.surface.color};
}

ReferenceField::ReferenceField(const Scene& scene) : ReferenceField(from_core(scene)) {}

Verdict check(const ReferenceField& field, const Ray& ray, double tolerance, const Answer& answer) {
    return check(field, ray, tolerance, from_core(answer));
}

}  // namespace ivory::reference
