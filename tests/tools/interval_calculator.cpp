// A calculator of Interval<double>, so that outside conformance suites can be run against it.
//
// Reads lines `op,operand;operand;...` from standard input and answers each on standard output:
//     operand  `lo:hi`, a number for a point, or `empty`; numbers hexadecimal or decimal (taken as
//              the nearest double), `-inf`, `inf`; for pown the second is an integer
//     op       add sub mul div recip neg sqr sqrt exp pown fma hull intersection min max abs, and
//              mid rad wid mag mig, which give a number
//     answer   `lo,hi` in hexadecimal; a number as `v,v` (`nan,nan` for that of the empty set);
//              `empty`; `skip` for another op
// A line of another form ends it with one line on standard error and exit status 1.
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "core/interval/exp.h"
#include "core/interval/interval.h"
#include "core/interval/power.h"

namespace {

using I = ivory::Interval<double>;
using Operands = std::vector<std::string>;

std::vector<std::string> split(const std::string& text, char separator) {
    std::vector<std::string> parts(1);
    for (const char c : text) {
        if (c == separator) {
            parts.emplace_back();
        } else {
            parts.back() += c;
        }
    }
    return parts;
}

double parse_number(const std::string& text) {
    char* end = nullptr;
    const double x = std::strtod(text.c_str(), &end);
    const bool is_space = !text.empty() && (text.front() == ' ' || text.front() == '\t');
    if (text.empty() || is_space || *end != '\0' || std::isnan(x)) {
        throw std::runtime_error("\"" + text + "\" is not a number");
    }
    return x;
}

I parse_interval(const std::string& text) {
    if (text == "empty") return I::empty_set();
    const std::vector<std::string> ends = split(text, ':');
    if (ends.size() > 2) throw std::runtime_error("\"" + text + "\" is not lo:hi");
    const I a(parse_number(ends.front()), parse_number(ends.back()));
    if (is_empty(a) || a.lo == ivory::infinity<double> || a.hi == -ivory::infinity<double>) {
        throw std::runtime_error("\"" + text + "\" has no members; write empty");
    }
    return a;
}

int parse_integer(const std::string& text) {
    int n = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), n);
    if (error != std::errc() || end != text.data() + text.size()) {
        throw std::runtime_error("\"" + text + "\" is not an integer of 32 bits");
    }
    return n;
}

std::string hexadecimal(double x) {
    if (std::isnan(x)) return "nan";
    char buffer[40];
    std::snprintf(buffer, sizeof buffer, "%a", x);
    return buffer;
}

std::string answer(const I& a) {
    return is_empty(a) ? "empty" : hexadecimal(a.lo) + ',' + hexadecimal(a.hi);
}

std::string answer(double x) { return hexadecimal(x) + ',' + hexadecimal(x); }

struct Operation {
    std::size_t operand_count;
    std::function<std::string(const Operands&)> apply;
};

template <class Function>
Operation unary(Function f) {
    return {1, [f](const Operands& o) { return answer(f(parse_interval(o[0]))); }};
}

template <class Function>
Operation binary(Function f) {
    return {2, [f](const Operands& o) {
                return answer(f(parse_interval(o[0]), parse_interval(o[1])));
            }};
}

const std::map<std::string, Operation, std::less<>>& operations() {
    static const std::map<std::string, Operation, std::less<>> table{
        {"add", binary([](const I& a, const I& b) { return a + b; })},
        {"sub", binary([](const I& a, const I& b) { return a - b; })},
        {"mul", binary([](const I& a, const I& b) { return a * b; })},
        {"div", binary([](const I& a, const I& b) { return a / b; })},
        {"hull", binary([](const I& a, const I& b) { return hull(a, b); })},
        {"intersection", binary([](const I& a, const I& b) { return intersection(a, b); })},
        {"min", binary([](const I& a, const I& b) { return min(a, b); })},
        {"max", binary([](const I& a, const I& b) { return max(a, b); })},
        {"recip", unary([](const I& a) { return recip(a); })},
        {"neg", unary([](const I& a) { return -a; })},
        {"sqr", unary([](const I& a) { return sqr(a); })},
        {"sqrt", unary([](const I& a) { return sqrt(a); })},
        {"exp", unary([](const I& a) { return ivory::exp(a); })},
        {"abs", unary([](const I& a) { return abs(a); })},
        {"mid", unary([](const I& a) { return midpoint(a); })},
        {"rad", unary([](const I& a) { return radius(a); })},
        {"wid", unary([](const I& a) { return width(a); })},
        {"mag", unary([](const I& a) { return mag(a); })},
        {"mig", unary([](const I& a) { return mig(a); })},
        {"pown",
         {2,
          [](const Operands& o) {
              return answer(ivory::pown(parse_interval(o[0]), parse_integer(o[1])));
          }}},
        {"fma",
         {3,
          [](const Operands& o) {
              return answer(fma(parse_interval(o[0]), parse_interval(o[1]), parse_interval(o[2])));
          }}},
    };
    return table;
}

std::string calculate(const std::string& line) {
    const std::size_t comma = line.find(',');
    if (comma == std::string::npos || comma == 0) {
        throw std::runtime_error("expected op,operand;operand;...");
    }
    const std::string op = line.substr(0, comma);
    const auto found = operations().find(op);
    if (found == operations().end()) return "skip";
    const Operands operands = split(line.substr(comma + 1), ';');
    if (operands.size() != found->second.operand_count) {
        throw std::runtime_error(op + " takes " + std::to_string(found->second.operand_count) +
                                 " operands, not " + std::to_string(operands.size()));
    }
    return found->second.apply(operands);
}

}  // namespace

int main() {
    std::string line;
    for (long number = 1; std::getline(std::cin, line); ++number) {
        if (!line.empty() && line.back() == '\r') line.pop_back();
        try {
            std::cout << calculate(line) << '\n';
        } catch (const std::runtime_error& error) {
            std::cout.flush();
            std::cerr << "interval_calculator: line " << number << ": " << error.what() << '\n';
            return 1;
        }
    }
    return 0;
}
