#include "tests/reference/referee.h"

#include <cstdio>
#include <utility>

namespace ivory::reference {

Referee::Referee(ReferenceScene scene, long most_bits)
    : scene_(std::move(scene)), most_bits_(most_bits) {}

const ReferenceField& Referee::field(long bits) const {
    const std::lock_guard lock(guard_);
    for (const auto& made : fields_) {
        if (made->bits() == bits) return *made;
    }
    return *fields_.emplace_back(std::make_unique<ReferenceField>(scene_, bits));
}

Decision Referee::rule(const Ray& ray, double tolerance, const Claim& claim) const {
    for (long bits = least_bits;; bits *= 2) {
        const Ruling ruling = reference::rule(field(bits), ray, tolerance, claim);
        const bool open = ruling.undecided && ruling.fault == Fault::none;
        if (!open || 2 * bits > most_bits_) return {ruling, bits};
    }
}

std::string described(const std::string& fault, const Ray& ray, const Claim& claim,
                      const ReferenceAnswer& known) {
    static constexpr const char* words[] = {"hit", "miss", "unresolved", "claimed hit",
                                            "claimed miss"};
    char text[512];
    std::snprintf(text, sizeof text, "%s; ray %a %a %a %a %a %a; answer %s [%.17g, %.17g]",
                  fault.c_str(), ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x,
                  ray.direction.y, ray.direction.z, words[static_cast<int>(claim.status)], claim.lo,
                  claim.hi);
    const std::string result = text;
    switch (known.outcome) {
        case Outcome::hit:
            return result + "; reference hit " + to_string(known.t.lo);
        case Outcome::miss:
            return result + "; reference miss";
        case Outcome::unknown:
            return result + "; reference unknown from " + to_string(known.t.lo);
    }
    return result;
}

}  // namespace ivory::reference
