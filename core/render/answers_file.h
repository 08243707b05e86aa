// Rays and answers as lines of text. Numbers are written so that they read back to the same double.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/render/canvas.h"
#include "core/trace/ray.h"

namespace ivory {

// The names of the columns that append_answer writes.
inline constexpr std::string_view answer_columns = "status,t_lo,t_hi,nx,ny,nz,r,g,b";

// The status as it is written: "hit", "claimed_miss" ...
[[nodiscard]] std::string_view status_word(Status status);

// The answer's columns, without the end of the line; of a miss all but the first are empty.
void append_answer(std::string& text, const Answer& answer);

// "0x1.8p+1", as C reads it.
void append_hexadecimal(std::string& text, double value);

// Row j of a picture, one line a pixel: the ray's six numbers in hexadecimal, then the answer's
// columns. The frame has to keep the surface.
void append_row(std::string& text, const Picture& picture, const Frame& frame, int j);

// A line of a file of rays: six numbers `ox oy oz dx dy dz`, decimal or C hexadecimal, split by
// spaces, tabs or commas; `#` begins a comment. Nothing where the line holds none.
// Throws Error with what is wrong and what would be right, without file and line.
[[nodiscard]] std::optional<Ray> parse_ray(std::string_view line);

}  // namespace ivory
