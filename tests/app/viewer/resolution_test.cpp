// How fine a picture is made: from what the last ones took, and seldom another one.
#include "app/viewer/resolution.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace ivory {
namespace {

constexpr FineWork whole{.shades = false, .effort = 1000, .whole = 1000};

// What a picture of that step takes where all of them takes `full` seconds.
double seconds_of(std::size_t step, double full) {
    return full / std::pow(resolution_steps[step], 1.2);
}

TEST(Resolution, WhatNothingIsKnownOfIsTriedInFull) {
    Resolution resolution;
    EXPECT_EQ(resolution.choose(whole, 0.01, false), 0u);
    EXPECT_EQ(resolution.choose(whole, 0.01, true), 0u);
}

TEST(Resolution, WhatIsInTimeInFullStaysSo) {
    Resolution resolution;
    for (int picture = 0; picture < 100; ++picture) {
        EXPECT_EQ(resolution.choose(whole, 0.02, picture > 0), 0u);
        resolution.learn(0, whole, 0.015);
    }
}

TEST(Resolution, TheFinestThatIsInTimeIsFoundAndKept) {
    for (const double full : {0.03, 0.05, 0.1, 0.2}) {
        Resolution resolution;
        constexpr double budget = 0.02;
        std::size_t step = 0;
        int changes = -1;  // the first is no change
        for (int picture = 0; picture < 300; ++picture) {
            const std::size_t next = resolution.choose(whole, budget, picture > 0);
            changes += picture == 0 || next != step;
            step = next;
            resolution.learn(step, whole, seconds_of(step, full));
        }
        EXPECT_LE(seconds_of(step, full), budget) << full;
        EXPECT_GT(seconds_of(step - 1, full), 0.55 * budget) << full;
        EXPECT_LE(changes, 4) << full;
    }
}

// The first picture found nothing warm; what is quick enough once it is comes back.
TEST(Resolution, ASlowBeginningIsForgotten) {
    Resolution resolution;
    ASSERT_EQ(resolution.choose(whole, 0.02, false), 0u);
    resolution.learn(0, whole, 0.06);
    std::size_t step = 0, most = 0;
    for (int picture = 0; picture < 200; ++picture) {
        step = resolution.choose(whole, 0.02, picture > 0);
        most = std::max(most, step);
        resolution.learn(step, whole, step == 0 ? 0.008 : 0.008 / resolution_steps[step]);
    }
    EXPECT_GT(most, 0u);
    EXPECT_EQ(step, 0u);
}

TEST(Resolution, OneLatePictureChangesNothing) {
    Resolution resolution;
    for (int picture = 0; picture < 200; ++picture) {
        EXPECT_EQ(resolution.choose(whole, 0.02, picture > 0), 0u) << picture;
        resolution.learn(0, whole, picture % 10 == 5 ? 0.2 : 0.012);
    }
}

TEST(Resolution, AStepThatHasBecomeTooSlowIsLeft) {
    Resolution resolution;
    for (int picture = 0; picture < 10; ++picture) {
        static_cast<void>(resolution.choose(whole, 0.02, picture > 0));
        resolution.learn(0, whole, 0.01);
    }
    int late = 0;
    std::size_t step = 0;
    for (int picture = 0; picture < 20; ++picture) {
        step = resolution.choose(whole, 0.02, true);
        late += seconds_of(step, 0.08) > 0.02;
        resolution.learn(step, whole, seconds_of(step, 0.08));
    }
    EXPECT_GT(step, 0u);
    EXPECT_LE(late, 4);
}

// Not by one picture that is quicker, or a step would be taken back and forth.
TEST(Resolution, AFinerOneIsTakenOnlyAfterAWhile) {
    Resolution resolution;
    for (int picture = 0; picture < 20; ++picture) {
        const std::size_t step = resolution.choose(whole, 0.02, picture > 0);
        resolution.learn(step, whole, seconds_of(step, 0.08));
    }
    const std::size_t coarse = resolution.choose(whole, 0.02, true);
    ASSERT_GT(coarse, 0u);
    int pictures = 0;
    while (resolution.choose(whole, 0.2, true) == coarse && pictures < 100) ++pictures;
    EXPECT_GE(pictures, 10);
    EXPECT_LT(pictures, 30);
    // a new motion begins with what is thought best
    EXPECT_EQ(resolution.choose(whole, 0.2, false), 0u);
}

// Of an edit that touches few tiles every pixel can be there in time, though a whole picture cannot.
TEST(Resolution, TouchedTilesCountAlone) {
    Resolution resolution;
    resolution.learn(0, whole, 0.1);
    EXPECT_GT(resolution.choose(whole, 0.02, false), 0u);
    EXPECT_EQ(resolution.choose({.shades = false, .effort = 100, .whole = 1000}, 0.02, false), 0u);
}

TEST(Resolution, ShadingInFullIsTakenWhereItIsQuickerThanTracingLess) {
    Resolution resolution;
    resolution.learn(0, whole, 0.4);
    constexpr FineWork shading{.shades = true, .effort = 1000, .whole = 1000};
    resolution.learn(0, shading, 0.03);
    for (std::size_t step = 1; step < resolution_steps.size(); ++step)
        resolution.learn(step, whole, 0.035);
    EXPECT_EQ(resolution.choose(shading, 0.02, false), 0u);
}

// Others use the processor, and each picture waits for it.
TEST(Resolution, WhereCoarserIsNoQuickerFinerIsTaken) {
    Resolution resolution;
    std::size_t step = 0;
    for (int picture = 0; picture < 300; ++picture) {
        step = resolution.choose(whole, 0.02, picture > 0);
        resolution.learn(step, whole, 0.06 + seconds_of(step, 0.01));
    }
    EXPECT_LE(step, 2u);
}

TEST(Resolution, AfterOneThatWasGivenUpACoarserOneFollows) {
    Resolution resolution;
    std::size_t step = resolution.choose(whole, 0.02, false);
    for (std::size_t least = 1; least < resolution_steps.size(); ++least) {
        step = resolution.choose(whole, 0.02, true, least);
        EXPECT_GE(step, least);
    }
    EXPECT_EQ(step, resolution_steps.size() - 1);
}

}  // namespace
}  // namespace ivory
