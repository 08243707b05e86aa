// Lines of rays and of answers, read for the tools that check them.
#pragma once

#include <cstddef>
#include <istream>
#include <optional>
#include <string>
#include <vector>

#include "core/trace/ray.h"

namespace ivory::tools {

struct CheckedLine {
    std::size_t number;  // in its file, from 1
    Ray ray;
    Answer answer;
};

// All rays of a ray file, as the contract defines it. Throws Error on a faulty line.
[[nodiscard]] std::vector<Ray> read_rays(std::istream& in);

// The lines of `trace` for the given rays, or, without rays, of `render --answers`, whose lines
// begin with the ray. Throws Error on a faulty line and where the counts differ.
[[nodiscard]] std::vector<CheckedLine> read_answers(std::istream& in,
                                                    const std::optional<std::vector<Ray>>& rays);

}  // namespace ivory::tools
