#include "core/render/statistics.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/math/instruction_sets.h"
#include "core/render/answers_file.h"
#include "core/scene/scene_json.h"

namespace ivory {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

PixelStatistics pixel_statistics(const Canvas& canvas) {
    PixelStatistics sum;
    sum.tiles = canvas.tiles.size();
    for (const TileState& tile : canvas.tiles) {
        if (!tile.traced) continue;
        for (std::size_t status = 0; status < sum.pixels.size(); ++status) {
            sum.pixels[status] += tile.pixels[status];
        }
        if (tile.empty) ++sum.empty_tiles;
        sum.enclosure_width_max = std::max(sum.enclosure_width_max, tile.enclosure_width_max);
        sum.unresolved_width_max = std::max(sum.unresolved_width_max, tile.unresolved_width_max);
    }
    return sum;
}

PixelStatistics pixel_statistics(const Canvas& canvas, const SampledPicture& sampled) {
    PixelStatistics sum = pixel_statistics(canvas);
    sum.pixels = {};
    sum.tiles = sampled.pixels.size();
    sum.empty_tiles = 0;
    for (const std::array<std::uint16_t, 5>& tile : sampled.pixels) {
        const auto all = static_cast<std::uint64_t>(std::accumulate(tile.begin(), tile.end(), 0));
        for (std::size_t status = 0; status < tile.size(); ++status)
            sum.pixels[status] += tile[status];
        if (all > 0 && tile[static_cast<std::size_t>(Status::miss)] == all) ++sum.empty_tiles;
    }
    return sum;
}

PixelStatistics& PixelStatistics::operator+=(const PixelStatistics& other) {
    for (std::size_t status = 0; status < pixels.size(); ++status)
        pixels[status] += other.pixels[status];
    tiles += other.tiles;
    empty_tiles += other.empty_tiles;
    enclosure_width_max = std::max(enclosure_width_max, other.enclosure_width_max);
    unresolved_width_max = std::max(unresolved_width_max, other.unresolved_width_max);
    return *this;
}

std::string statistics_json(const RenderStatistics& s) {
    Json pixels = Json::object();
    for (std::size_t status = 0; status < s.pixels.pixels.size(); ++status) {
        pixels[std::string(status_word(static_cast<Status>(status)))] = s.pixels.pixels[status];
    }
    Json json;
    json["width"] = s.width;
    json["height"] = s.height;
    json["threads"] = s.threads;
    json["target"] = instruction_set();
    json["method"] = s.method;
    json["tolerance"] = s.options.tolerance;
    json["samples"] = s.samples;
    json["camera"] = Json::parse(write_camera(with_height(s.camera)));
    json["repeats"] = s.repeats;
    json["seconds"] = {{"load", s.seconds.load},   {"compile", s.seconds.compile},
                       {"trace", s.seconds.trace}, {"shade", s.seconds.shade},
                       {"write", s.seconds.write}, {"total", s.seconds.total}};
    json["pixels"] = pixels;
    json["evaluations"] = s.counts.evaluations;
    json["element_evaluations"] = s.counts.element_evaluations;
    json["elements"] = {
        {"total", s.elements}, {"visible", s.visible_elements}, {"reached", s.reached_elements}};
    json["tiles"] = {{"total", s.pixels.tiles}, {"empty", s.pixels.empty_tiles}};
    const SkippingCounts& skipping = s.counts.skipping;
    json["skipping"] = {
        {"off", Json::array()},
        {"list_elements",
         {{"tested", skipping.list_elements}, {"left_out", skipping.list_left_out}}},
        {"stretches", {{"bounded", skipping.stretches}, {"ended", skipping.stretches_ended}}},
        {"windows", skipping.windows},
        {"rays",
         {{"in_packets", skipping.rays},
          {"doubtful_in_float",
           s.counts.climbers[Rung::walk_along] + s.counts.climbers[Rung::walk_again]},
          {"alone", skipping.rays_alone}}}};
    Json& ladder_json = json["ladder"] = Json::object();
    for (const RungFacts& rung : ladder) {
        if (rung.rung == Rung::walk || rung.rung == Rung::enclose) continue;
        ladder_json[std::string(rung.name)] = s.counts.climbers[rung.rung];
    }
    for (const SkippingName& kind : skipping_names) {
        if (!(s.options.skipping.*kind.member)) json["skipping"]["off"].push_back(kind.name);
    }
    json["enclosure_width_max"] = s.pixels.enclosure_width_max;
    json["unresolved_width_max"] = s.pixels.unresolved_width_max;
    return json.dump(2) + "\n";
}

}  // namespace ivory
