// Memory for what is large and touched here and there.
#pragma once

#include <cstddef>

namespace ivory {

// Zero pages or old ones, as the system has them; where that offers pages of 2 MiB they are asked
// for: in pages of 4 KiB the system took a sixth of the time of a simple picture.
// Throws std::bad_alloc.
[[nodiscard]] void* allocate_pages(std::size_t bytes);
void free_pages(void* memory) noexcept;

}  // namespace ivory
