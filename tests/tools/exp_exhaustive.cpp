// Every float with 2^-25 <= |x| <= 104 against MPFR: the enclosure of exp and exp_nearest.
// Exit status 1 on a fault. A long run, some minutes on two cores, that this starts:
//
//     ./tests/run -C Long -R long.exp_of_every_float
#include <mpfr.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <mutex>
#include <thread>
#include <vector>

#include "tests/core/interval/exp_oracle.h"

int main() {
    using namespace ivory::test;
    const unsigned workers = std::max(1U, std::thread::hardware_concurrency());

    // Positive floats are ordered as their bits; the oracle checks x and -x.
    constexpr auto first = std::bit_cast<std::uint32_t>(0x1p-25f);
    constexpr auto last = std::bit_cast<std::uint32_t>(104.0f);
    constexpr std::uint32_t chunk = 1U << 20;
    constexpr std::uint32_t chunks = (last - first) / chunk + 1;

    ExpFindings all;
    std::uint32_t chunks_done = 0;
    std::mutex mutex;
    std::atomic<std::uint32_t> next_chunk{0};
    const auto work = [&] {
        {
            ExpOracle oracle;
            for (std::uint32_t i = next_chunk++; i < chunks; i = next_chunk++) {
                ExpFindings found;
                const std::uint32_t begin = first + i * chunk;
                const std::uint32_t end = std::min(last, begin + (chunk - 1));
                for (std::uint32_t bits = begin; bits <= end; ++bits) {
                    oracle.check(std::bit_cast<float>(bits), found);
                }
                const std::lock_guard lock(mutex);
                all += found;
                std::fprintf(stderr, "\r%u of %u parts, %lld faults", ++chunks_done, chunks,
                             static_cast<long long>(all.faults));
            }
        }
        mpfr_free_cache();
    };
    std::vector<std::thread> threads;
    for (unsigned i = 0; i < workers; ++i) threads.emplace_back(work);
    for (std::thread& thread : threads) thread.join();

    std::fprintf(stderr, "\n");
    std::printf(
        "%lld floats checked, %lld faults; %.4f %% of the ends are the tightest; "
        "exp_nearest is off by %.4f epsilon at most\n",
        static_cast<long long>(all.checked), static_cast<long long>(all.faults),
        50.0 * static_cast<double>(all.tightest) / static_cast<double>(all.checked),
        all.worst_nearest);
    if (all.faults != 0) std::printf("first: %s\n", all.first_fault.c_str());
    return all.faults == 0 ? 0 : 1;
}
