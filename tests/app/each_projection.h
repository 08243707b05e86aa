// Tests that are run in both projections.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <string>

#include "core/scene/scene.h"

namespace ivory::tests {

class InEachProjection : public testing::TestWithParam<Camera::Projection> {
  public:
    // Of a suite's instances, and what they are called.
    static auto all() {
        return testing::Values(Camera::Projection::perspective, Camera::Projection::orthographic);
    }
    static std::string name(const testing::TestParamInfo<Camera::Projection>& test) {
        return std::string(projection_words[static_cast<std::size_t>(test.param)]);
    }
};

}  // namespace ivory::tests
