#include "tests/reference/answer_lines.h"

#include <cmath>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <string_view>

namespace ivory::reference {

namespace {

[[noreturn]] void refuse(std::size_t line, const std::string& fault) {
    throw std::runtime_error("line " + std::to_string(line) + ": " + fault);
}

double number(const std::string& text, std::size_t line) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (text.empty() || *end != '\0') refuse(line, "not a number: '" + text + "'");
    return value;
}

std::vector<std::string> split(const std::string& line) {
    std::vector<std::string> cells(1);
    for (const char c : line) {
        if (c == ',') {
            cells.emplace_back();
        } else if (c != '\r') {
            cells.back() += c;
        }
    }
    return cells;
}

Claim::Status status_of(const std::string& word, std::size_t line) {
    if (word == "hit") return Claim::Status::hit;
    if (word == "miss") return Claim::Status::miss;
    if (word == "unresolved") return Claim::Status::unresolved;
    if (word == "claimed_hit") return Claim::Status::claimed_hit;
    if (word == "claimed_miss") return Claim::Status::claimed_miss;
    refuse(line, "not a status: '" + word + "'");
}

Vec3d vector_of(const std::vector<std::string>& cells, std::size_t first, std::size_t line) {
    return {number(cells[first], line), number(cells[first + 1], line),
            number(cells[first + 2], line)};
}

Claim claim_of(const std::vector<std::string>& cells, std::size_t first, std::size_t line) {
    Claim claim;
    claim.status = status_of(cells[first], line);
    if (claim.status == Claim::Status::miss || claim.status == Claim::Status::claimed_miss) {
        for (std::size_t i = first + 1; i < first + 9; ++i) {
            if (!cells[i].empty()) refuse(line, "a miss with columns that are not empty");
        }
        return claim;
    }
    claim.lo = number(cells[first + 1], line);
    claim.hi = number(cells[first + 2], line);
    claim.normal = vector_of(cells, first + 3, line);
    claim.color = vector_of(cells, first + 6, line);
    return claim;
}

}  // namespace

std::vector<Ray> read_rays(std::istream& in) {
    std::vector<Ray> rays;
    std::string line;
    for (std::size_t count = 1; std::getline(in, line); ++count) {
        line = line.substr(0, line.find('#'));
        std::vector<double> values;
        std::string cell;
        for (const char c : line + ' ') {
            if (std::string_view(" ,\t\r").find(c) == std::string_view::npos) {
                cell += c;
            } else if (!cell.empty()) {
                values.push_back(number(cell, count));
                cell.clear();
            }
        }
        if (values.empty()) continue;
        if (values.size() != 6) refuse(count, "a ray has six numbers");
        for (const double value : values) {
            if (!std::isfinite(value)) refuse(count, "a number that is not finite");
        }
        const Ray ray{{values[0], values[1], values[2]}, {values[3], values[4], values[5]}};
        if (ray.direction == Vec3d{0, 0, 0}) refuse(count, "a direction of length 0");
        rays.push_back(ray);
    }
    return rays;
}

std::vector<CheckedLine> read_answers(std::istream& in,
                                      const std::optional<std::vector<Ray>>& rays) {
    const std::string header = "status,t_lo,t_hi,nx,ny,nz,r,g,b";
    const std::size_t first = rays ? 0 : 6;
    std::size_t count = 1;
    std::string line;
    if (rays) {  // a picture's answers have no header, one line is one pixel
        std::getline(in, line);
        if (!line.empty() && line.back() == '\r') line.pop_back();
        if (line != header) refuse(1, "'" + line + "' where '" + header + "' should be");
        ++count;
    }

    std::vector<CheckedLine> lines;
    for (; std::getline(in, line); ++count) {
        const std::vector<std::string> cells = split(line);
        if (cells.size() != first + 9) {
            refuse(count, std::to_string(cells.size()) + " columns where " +
                              std::to_string(first + 9) + " should be");
        }
        if (rays && lines.size() == rays->size()) refuse(count, "more answers than rays");
        const Ray ray = rays ? (*rays)[lines.size()]
                             : Ray{vector_of(cells, 0, count), vector_of(cells, 3, count)};
        lines.push_back({count, ray, claim_of(cells, first, count)});
    }
    if (rays && lines.size() != rays->size()) {
        throw std::runtime_error(std::to_string(lines.size()) + " answers for " +
                                 std::to_string(rays->size()) + " rays");
    }
    return lines;
}

}  // namespace ivory::reference
