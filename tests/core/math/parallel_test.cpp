#include "core/math/parallel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <vector>

namespace ivory {
namespace {

// Every index belongs to one range, and no range is shorter than asked for unless it is the only
// one.
TEST(Parallel, EveryIndexIsVisitedOnce) {
    for (const std::size_t count : {0, 1, 7, 100, 1001}) {
        for (const int threads : {-1, 0, 1, 2, 3, 16}) {
            for (const std::size_t least : {0, 1, 40, 2000}) {
                std::vector<std::atomic<int>> visits(count);
                std::atomic<int> ranges = 0;
                for_ranges(count, threads, least, [&](std::size_t first, std::size_t end) {
                    ++ranges;
                    if (end - first < count) {
                        EXPECT_GE(end - first, least);
                    }
                    for (std::size_t i = first; i < end; ++i) ++visits[i];
                });
                for (const std::atomic<int>& n : visits) EXPECT_EQ(n, 1);
                EXPECT_LE(ranges, std::max(threads, 1));
                if (threads == 16 && least == 1 && count > 16) {
                    EXPECT_EQ(ranges, 16);
                }
            }
        }
    }
}

}  // namespace
}  // namespace ivory
