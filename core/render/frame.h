// A picture as planes, one value a pixel, row by row from the top.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>

#include "core/render/pages.h"
#include "core/trace/ray.h"

namespace ivory {

// Bytes of sRGB (IEC 61966-2-1); a is 255.
struct Rgba8 {
    std::uint8_t r, g, b, a;
    friend bool operator==(const Rgba8&, const Rgba8&) = default;
};

// Not initialised: a page of memory that no pixel needs is never touched, and each of the others
// first by the worker that fills it.
template <class T>
class Plane {
  public:
    Plane() = default;
    explicit Plane(std::size_t size)
        : values_(static_cast<T*>(size > 0 ? allocate_pages(size * sizeof(T)) : nullptr)),
          size_(size) {
        std::uninitialized_default_construct_n(values_.get(), size);
    }

    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] bool empty() const { return size_ == 0; }
    [[nodiscard]] T& operator[](std::size_t i) { return values_[i]; }
    [[nodiscard]] const T& operator[](std::size_t i) const { return values_[i]; }

  private:
    static_assert(std::is_trivially_destructible_v<T>);
    struct Free {
        void operator()(T* values) const { free_pages(values); }
    };
    std::unique_ptr<T[], Free> values_;
    std::size_t size_ = 0;
};

// 21 bytes a pixel, 48 more where the surface is kept.
struct Frame {
    int width, height;  // pixels
    Plane<Status> status;
    Plane<double> t_lo, t_hi;     // set where a root is or may be, and nowhere else
    Plane<Rgba8> color;           // shaded
    Plane<SurfacePoint> surface;  // likewise set where a root may be; empty unless kept

    Frame(int frame_width, int frame_height, bool keep_surface)
        : width(frame_width),
          height(frame_height),
          status(size()),
          t_lo(size()),
          t_hi(size()),
          color(size()),
          surface(keep_surface ? size() : 0) {}

    [[nodiscard]] std::size_t size() const {
        return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    }
    // Column i, row j from the top.
    [[nodiscard]] std::size_t at(int i, int j) const {
        return static_cast<std::size_t>(j) * static_cast<std::size_t>(width) +
               static_cast<std::size_t>(i);
    }
    [[nodiscard]] Interval<double> t(std::size_t pixel) const { return {t_lo[pixel], t_hi[pixel]}; }
};

}  // namespace ivory
