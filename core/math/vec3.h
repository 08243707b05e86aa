// Three components of any number type: double, Interval<double>, SIMD lanes.
#pragma once

#include <cstddef>

namespace ivory {

template <class Real>
struct Vec3 {
    Real x{}, y{}, z{};

    constexpr Real& operator[](std::size_t i) { return i == 0 ? x : i == 1 ? y : z; }
    constexpr const Real& operator[](std::size_t i) const { return i == 0 ? x : i == 1 ? y : z; }
    friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
};

using Vec3d = Vec3<double>;

template <class Real>
constexpr Vec3<Real> operator+(const Vec3<Real>& a, const Vec3<Real>& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}

template <class Real>
constexpr Vec3<Real> operator-(const Vec3<Real>& a, const Vec3<Real>& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}

template <class Real>
constexpr Vec3<Real> operator-(const Vec3<Real>& a) {
    return {-a.x, -a.y, -a.z};
}

template <class Real>
constexpr Vec3<Real> operator*(const Real& s, const Vec3<Real>& a) {
    return {s * a.x, s * a.y, s * a.z};
}

template <class Real>
constexpr Real dot(const Vec3<Real>& a, const Vec3<Real>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class Real>
constexpr Vec3<Real> cross(const Vec3<Real>& a, const Vec3<Real>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

}  // namespace ivory
