// How long work that knows nothing of signals, windows or threads is ended before it is done.
#pragma once

#include <cstddef>
#include <functional>

namespace ivory {

// Asked now and then by work that may take long; throws where the work is to end. Empty: it never
// is.
using Stop = std::function<void()>;

// How far such work gets at most between two looks: bytes of a text or file, values or elements of
// a scene. Either takes a few milliseconds.
inline constexpr std::size_t bytes_between_looks = std::size_t{1} << 20;
inline constexpr std::size_t values_between_looks = std::size_t{1} << 12;

inline void look_at(const Stop& stop) {
    if (stop) stop();
}

}  // namespace ivory
