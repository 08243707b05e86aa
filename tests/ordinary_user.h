// Root may read and write everything, so a test of permissions gives that up for a while.
#pragma once

#include <unistd.h>

namespace ivory::tests {

// While it lives, the process is an ordinary user: who it was, or "nobody" where that was root.
class OrdinaryUser {
  public:
    OrdinaryUser() {
        constexpr uid_t nobody = 65534;
        holds_ = ::geteuid() != 0 || ::seteuid(nobody) == 0;
    }
    ~OrdinaryUser() {
        if (::getuid() == 0 && ::seteuid(0) != 0) ::_exit(1);
    }
    OrdinaryUser(const OrdinaryUser&) = delete;
    OrdinaryUser& operator=(const OrdinaryUser&) = delete;

    // False where the system lets nobody change: in some containers.
    [[nodiscard]] bool holds() const { return holds_; }

  private:
    bool holds_;
};

}  // namespace ivory::tests
