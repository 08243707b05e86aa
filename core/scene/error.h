// The one exception of Ivory: a job that could not be done.
#pragma once

#include <stdexcept>
#include <string>

namespace ivory {

// what() is one line for the user: file, place, what is wrong, what would be right.
class Error : public std::runtime_error {
  public:
    explicit Error(const std::string& line) : std::runtime_error(line) {}
};

}  // namespace ivory
