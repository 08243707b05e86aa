// Work on a range of indices, divided among threads.
#pragma once

#include <algorithm>
#include <cstddef>
#include <system_error>
#include <thread>
#include <vector>

namespace ivory {

// Calls visit(first, end) for ranges of at least `least` indices (fewer: one range) that together
// are 0 .. count, on at most that many threads, this one among them, and returns when all are done.
// The visits must not throw, nor touch what another one writes.
template <class Visit>
void for_ranges(std::size_t count, int threads, std::size_t least, const Visit& visit) {
    const std::size_t most = std::max<std::size_t>(count / std::max<std::size_t>(least, 1), 1);
    const std::size_t ranges = std::min(most, static_cast<std::size_t>(std::max(threads, 1)));
    const auto begin = [&](std::size_t range) { return count * range / ranges; };
    std::vector<std::jthread> others;
    others.reserve(ranges - 1);
    std::size_t taken = 1;
    for (; taken < ranges; ++taken) {
        try {
            others.emplace_back(
                [&visit, first = begin(taken), end = begin(taken + 1)] { visit(first, end); });
        } catch (const std::system_error&) {
            break;  // no more threads: this one does the rest
        }
    }
    visit(begin(0), begin(1));
    if (taken < ranges) visit(begin(taken), count);
}

}  // namespace ivory
