// A library of the machine, loaded at run time: an executable that can do without it starts without it.
#pragma once

#include <initializer_list>
#include <string>

namespace ivory {

// It stays loaded: OpenGL drivers keep threads and leave handlers behind that outlive their contexts.
class SharedLibrary {
  public:
    // The first of the names that loads. Throws Error that names them all.
    explicit SharedLibrary(std::initializer_list<const char*> names);

    // Throws Error where it has no such function.
    template <class Function>
    [[nodiscard]] Function* function(const char* name) const {
        return reinterpret_cast<Function*>(address(name));
    }

  private:
    [[nodiscard]] void* address(const char* name) const;

    void* handle_ = nullptr;
    std::string name_;
};

}  // namespace ivory
