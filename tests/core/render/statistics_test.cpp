// The keys of `--stats`.
#include "core/render/statistics.h"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "core/math/instruction_sets.h"

namespace ivory {
namespace {

using Json = nlohmann::json;

TEST(Statistics, HaveAllKeys) {
    RenderStatistics statistics;
    statistics.width = 30;
    statistics.height = 20;
    statistics.threads = 3;
    statistics.method = "proved";
    statistics.camera = {{0, 0, 8}, {0, 0.5, 0}, {0, 1, 0}, 40};
    statistics.seconds = {1, 2, 3, 4, 5, 15};
    statistics.pixels.pixels = {1, 2, 3, 4, 590};
    statistics.pixels.tiles = 4;
    statistics.pixels.empty_tiles = 1;
    statistics.pixels.enclosure_width_max = 1e-7;
    statistics.pixels.unresolved_width_max = std::numeric_limits<double>::infinity();
    statistics.counts = {1000, 4000};
    statistics.elements = 5;
    statistics.visible_elements = 4;
    statistics.reached_elements = 2;
    const std::string text = statistics_json(statistics);
    EXPECT_TRUE(text.ends_with("}\n"));
    const Json json = Json::parse(text);
    EXPECT_EQ(json.at("width"), 30);
    EXPECT_EQ(json.at("height"), 20);
    EXPECT_EQ(json.at("threads"), 3);
    EXPECT_EQ(json.at("target"), instruction_set());
    EXPECT_NE(json.at("target"), "");
    EXPECT_EQ(json.at("method"), "proved");
    EXPECT_EQ(json.at("camera"), Json::parse(R"({"position": [0, 0, 8], "target": [0, 0.5, 0],
                                                 "up": [0, 1, 0], "fov": 40})"));
    EXPECT_EQ(json.at("seconds"), Json::parse(R"({"load": 1, "compile": 2, "trace": 3, "shade": 4,
                                                  "write": 5, "total": 15})"));
    EXPECT_EQ(json.at("pixels"),
              Json::parse(R"({"hit": 1, "miss": 2, "unresolved": 3, "claimed_hit": 4,
                              "claimed_miss": 590})"));
    EXPECT_EQ(json.at("evaluations"), 1000);
    EXPECT_EQ(json.at("element_evaluations"), 4000);
    EXPECT_EQ(json.at("elements"), Json::parse(R"({"total": 5, "visible": 4, "reached": 2})"));
    EXPECT_EQ(json.at("tiles"), Json::parse(R"({"total": 4, "empty": 1})"));
    EXPECT_EQ(json.at("enclosure_width_max"), 1e-7);
    EXPECT_TRUE(json.at("unresolved_width_max").is_null());
}

}  // namespace
}  // namespace ivory
