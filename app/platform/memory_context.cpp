#include <cstdlib>
#include <string>
#include <string_view>

#include "app/platform/context.h"
#include "core/scene/error.h"

namespace ivory {

std::unique_ptr<MemoryContext> open_memory_context(WindowSize size) {
    const char* const chosen = std::getenv("IVORY_HEADLESS_CONTEXT");
    const std::string_view choice = chosen == nullptr ? "" : chosen;
    if (choice == "osmesa") return open_osmesa_context(size);
    if (choice == "egl") return open_egl_context(size);
    if (!choice.empty())
        throw Error("IVORY_HEADLESS_CONTEXT is \"" + std::string(choice) +
                    "\"; it may be osmesa or egl");
    try {
        return open_osmesa_context(size);
    } catch (const Error& osmesa) {
        try {
            return open_egl_context(size);
        } catch (const Error& egl) {
            throw Error(std::string("--headless needs OpenGL in memory: ") + osmesa.what() + "; " +
                        egl.what() + ". Debian's packages are libosmesa6 and libegl1");
        }
    }
}

}  // namespace ivory
