// Lines of rays and of answers, read for the tools that check them.
#pragma once

#include <cstddef>
#include <istream>
#include <optional>
#include <string>
#include <vector>

#include "tests/reference/claim.h"
#include "tests/reference/ray.h"

namespace ivory::reference {

struct CheckedLine {
    std::size_t number;  // in its file, from 1
    Ray ray;
    Claim claim;
};

// All rays of a ray file, as the contract defines it. Throws std::runtime_error on a faulty line.
[[nodiscard]] std::vector<Ray> read_rays(std::istream& in);

// The lines of `trace` for the given rays, or, without rays, of `render --answers`, whose lines
// begin with the ray. Throws std::runtime_error on a faulty
// line and where the counts differ.
[[nodiscard]] std::vector<CheckedLine> read_answers(std::istream& in,
                                                    const std::optional<std::vector<Ray>>& rays);

}  // namespace ivory::reference
