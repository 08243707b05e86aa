#include "core/render/pages.h"

#include <cstdlib>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace ivory {

void* allocate_pages(std::size_t bytes) {
    constexpr std::size_t large_page = std::size_t{1} << 21, line = 64;
    const std::size_t alignment = bytes >= large_page ? large_page : line;
    const std::size_t size = (bytes + alignment - 1) / alignment * alignment;
    void* const memory = std::aligned_alloc(alignment, size);
    if (memory == nullptr) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
    // Advice: where it is not taken, nothing is lost.
    if (alignment == large_page) static_cast<void>(madvise(memory, size, MADV_HUGEPAGE));
#endif
    return memory;
}

void free_pages(void* memory) noexcept { std::free(memory); }

}  // namespace ivory
