// How fine a picture can be that has to be there in time: chosen from what the last ones took, and
// seldom another one while a hand moves. Nothing is started, timed or cut short here.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace ivory {

// Pixels of the window a side that one pixel of a picture covers, from fine to coarse.
inline constexpr std::array<double, 8> resolution_steps = {1, 1.5, 2, 3, 4, 6, 8, 12};

// What is left to do of a picture of every pixel, where those of earlier pictures serve.
struct FineWork {
    bool shades = false;  // what is traced already; otherwise it traces
    double effort = 0;    // in tiles that see something: EditedCanvas::effort
    double whole = 0;     // the same of a picture of which nothing is there
};

// Used by one thread. Times in seconds.
class Resolution {
  public:
    // An index into resolution_steps, `at_least` or more: the finest whose picture takes no longer
    // than `budget`, as far as can be told; where none does, the quickest. What nothing is known of
    // is thought to be in time. `goes_on`: the picture before was of the same motion, so that
    // another step than its own has to be called for: a coarser one because its own takes too
    // long, a finer one because it has long been in time with much to spare.
    [[nodiscard]] std::size_t choose(const FineWork& work, double budget, bool goes_on,
                                     std::size_t at_least = 0);
    // What a picture of that step took; of one that was given up, what all of it would have taken.
    void learn(std::size_t step, const FineWork& work, double seconds);

  private:
    // The last times, of which one that something else delayed tells nothing.
    class Times {
      public:
        void add(double seconds);
        [[nodiscard]] std::optional<double> typical() const;

      private:
        std::array<double, 5> last_{};
        std::size_t count_ = 0;  // of all that were added
    };

    [[nodiscard]] std::optional<double> expected(std::size_t step, const FineWork& work) const;
    [[nodiscard]] std::size_t finest_within(double seconds, const FineWork& work) const;

    Times traces_, shades_;  // of fine pictures, for each tile of effort
    std::array<Times, resolution_steps.size()> coarse_;  // of whole pictures; the first is not used
    std::size_t step_ = 0;
    int with_room_ = 0;  // so many pictures in a row could have been finer
};

}  // namespace ivory
