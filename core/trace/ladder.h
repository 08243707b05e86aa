// The ladder: what a ray that is not decided tries next. Each rung proves what it answers, whatever
// the rungs before it found; a higher one knows of more elements, or has more digits, and costs more.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace ivory {

enum class Rung : std::uint8_t {
    walk,
    enclose,
    enclose_more,
    along_root,
    about_root,
    walk_along,
    walk_again,
    settle,
    alone_near,
    alone_listed,
    alone_all,
};

struct RungFacts {
    Rung rung;
    std::string_view name;      // in statistics
    std::string_view elements;  // which it adds up, the others being an interval
    std::string_view arithmetic;
    std::string_view proves;
    std::string_view next;  // for a ray that it leaves open
};

// In order. The first seven are PacketTracer's (core/trace/packet.cpp), the next three one ray's
// (core/trace/methods/proved.cpp), the last the door's (core/trace/trace.cpp).
inline constexpr std::array ladder{
    RungFacts{Rung::walk, "walk",
              "of the window, the strong ones; near the surface the weak ones too", "float",
              "f < 0 up to the place from which f rises to a root; or on all of the window",
              "walk_again"},
    RungFacts{Rung::enclose, "enclose", "of the window, all", "double, weak ones in float",
              "the two grid lines about the root", "enclose_more"},
    RungFacts{Rung::enclose_more, "enclose_more", "of the list, next to all", "the same",
              "the same, where what was left out hid a line's side", "about_root, then walk_again"},
    RungFacts{Rung::along_root, "along_root", "of a crowd, next to all, as one polynomial",
              "double", "the same", "about_root"},
    RungFacts{Rung::about_root, "about_root", "the same, bounded about that root of that ray",
              "double, sums compensated", "the same, where rounding hid it", "settle"},
    RungFacts{Rung::walk_along, "walk_along", "of a crowd, next to all, as one polynomial",
              "double", "what walk and enclose do", "alone_near"},
    RungFacts{Rung::walk_again, "walk_again", "of the window, all", "double",
              "what walk and enclose do", "alone_near"},
    RungFacts{Rung::settle, "settle", "near the root, nothing left out", "intervals",
              "which of some grid lines, where the root is known within a few cells", "alone_near"},
    RungFacts{Rung::alone_near, "alone_near", "of the list, near the ray, if it is long",
              "intervals", "all: core/trace/isolate.h", "alone_listed"},
    RungFacts{Rung::alone_listed, "alone_listed", "of the list", "intervals", "all", "alone_all"},
    RungFacts{Rung::alone_all, "alone_all", "of the field, where the list had left any out",
              "intervals", "all; or the ray is unresolved", ""},
};

static_assert([] {
    for (std::size_t k = 0; k < ladder.size(); ++k)
        if (ladder[k].rung != static_cast<Rung>(k)) return false;
    return true;
}());

// Rays that came to each rung. All rays of a packet come to the first two, and are not counted there.
struct Climbers {
    std::array<std::uint64_t, ladder.size()> rays{};

    [[nodiscard]] std::uint64_t& operator[](Rung rung) {
        return rays[static_cast<std::size_t>(rung)];
    }
    [[nodiscard]] std::uint64_t operator[](Rung rung) const {
        return rays[static_cast<std::size_t>(rung)];
    }
    Climbers& operator+=(const Climbers& other) {
        for (std::size_t k = 0; k < rays.size(); ++k) rays[k] += other.rays[k];
        return *this;
    }
};

}  // namespace ivory
