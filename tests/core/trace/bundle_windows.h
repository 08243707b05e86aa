// Windows of a bundle one after another, with the stages of the one that is visited.
#pragma once

#include <cstdint>
#include <span>

#include "core/trace/descent.h"

namespace ivory {

class BundleWindows {
  public:
    bool build(const Field& field, const ElementList& list, const Bundle& bundle, double tolerance,
               bool skips_windows = true, const CommonBundle* common = nullptr) {
        return descent_.build(field, list, bundle, tolerance, skips_windows, common);
    }
    // Until visit(window, part) returns false.
    template <class Wanted, class Visit>
    void for_windows(std::span<const BundlePart> parts, const RayColumns& rays,
                     const Wanted& wanted, int budget, const Visit& visit) {
        descent_.begin(parts, rays, budget);
        while (Window* const window = descent_.next(wanted)) {
            if (!visit(*window, descent_.part())) return;
        }
    }

    void complete(Window& window) { descent_.field().complete(window); }
    const Window& full() { return descent_.field().full(); }
    const Window& full_mixed() { return descent_.field().full_mixed(); }
    const Window& about_root(const Vec3d& origin, const Vec3d& direction, double t) {
        return descent_.field().about_root(origin, direction, t);
    }
    [[nodiscard]] double unit() const { return descent_.field().unit(); }
    [[nodiscard]] double threshold() const { return descent_.field().threshold(); }
    [[nodiscard]] std::uint64_t stretches() const { return descent_.field().stretches(); }

  private:
    Descent descent_;
};

}  // namespace ivory
