// The first look at a text that is to be JSON: its bytes alone.
#pragma once

#include <cstddef>

#include "core/scene/json_reader.h"
#include "core/scene/stop.h"

namespace ivory {

// The most entries that the text's index can have. Throws Error at the first byte that is not UTF-8,
// or else at the first that stands in no JSON. Looks at `stop` as parse_json does.
[[nodiscard]] std::size_t most_entries_of(const SourceText& source, const Stop& stop);

}  // namespace ivory
