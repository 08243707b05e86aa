// The referee: whether an answer is right. The reference is asked in 256 bits, and again in twice as
// many while that leaves it open, up to as many as are allowed.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "tests/reference/claim.h"
#include "tests/reference/ray.h"
#include "tests/reference/reference.h"
#include "tests/reference/scene.h"
#include "tests/reference/verdict.h"

namespace ivory::reference {

struct Decision : Ruling {
    long bits = 0;  // of the arithmetic that decided, or gave up
};

// Shared between threads freely.
class Referee {
  public:
    explicit Referee(ReferenceScene scene, long most_bits = 4096);

    [[nodiscard]] Decision rule(const Ray& ray, double tolerance, const Claim& claim) const;

    [[nodiscard]] const ReferenceField& field(long bits = least_bits) const;

  private:
    ReferenceScene scene_;
    long most_bits_;
    mutable std::mutex guard_;
    mutable std::vector<std::unique_ptr<ReferenceField>> fields_;  // made when first asked for
};

// For messages: the fault, the ray in hexadecimal, its claim, and what the reference knows instead.
[[nodiscard]] std::string described(const std::string& fault, const Ray& ray, const Claim& claim,
                                    const ReferenceAnswer& known);

}  // namespace ivory::reference
