// Cancellation: the wish of somebody else that work ends early, and how often work looks for it.
#pragma once

#include <atomic>
#include <cstdint>

namespace ivory {

// One for each worker. What is answered after `requested` is not to be shown: it may say
// `unresolved` where more work would have decided, but never anything that is not so.
class Cancellation {
  public:
    // The evaluations of one element between two looks, but for those of one step of many rays:
    // about a millisecond.
    static constexpr std::uint64_t often = 1'000'000;

    Cancellation() = default;  // nobody wishes it
    // `flag` has to live as long.
    explicit Cancellation(const std::atomic<bool>& flag) : flag_(&flag) {}

    // After so many evaluations of one element, or bounds of one: whether to stop.
    bool after(std::uint64_t element_evaluations) {
        since_ += element_evaluations;
        if (since_ >= often) {
            since_ = 0;
            requested_ = flag_ != nullptr && flag_->load(std::memory_order_relaxed);
        }
        return requested_;
    }

    // Whether it has been seen.
    [[nodiscard]] bool requested() const { return requested_; }

  private:
    const std::atomic<bool>* flag_ = nullptr;
    std::uint64_t since_ = 0;
    bool requested_ = false;
};

}  // namespace ivory
