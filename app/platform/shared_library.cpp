#include "app/platform/shared_library.h"

#include <dlfcn.h>

#include "core/scene/error.h"

namespace ivory {

SharedLibrary::SharedLibrary(std::initializer_list<const char*> names) {
    std::string tried;
    for (const char* name : names) {
        handle_ = dlopen(name, RTLD_LAZY | RTLD_LOCAL);
        if (handle_ != nullptr) {
            name_ = name;
            return;
        }
        tried += tried.empty() ? name : std::string(" or ") + name;
    }
    throw Error("no " + tried + " on this machine");
}

void* SharedLibrary::address(const char* name) const {
    void* const found = dlsym(handle_, name);
    if (found == nullptr) throw Error(name_ + " has no function " + name);
    return found;
}

}  // namespace ivory
