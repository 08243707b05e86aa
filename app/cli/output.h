// Where data goes: a file that is whole or not there, or standard output.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/scene/write_file.h"

namespace ivory {

class Output {
  public:
    // "-" is standard output. Throws Error where the file cannot be made.
    explicit Output(const std::string& target);

    // Appends; on standard output at once. Throws Error, or Interrupted.
    void write(std::string_view bytes);

    // Puts the file in its place; the last call. Throws Error.
    void commit();

  private:
    std::optional<AtomicFile> file_;
};

}  // namespace ivory
