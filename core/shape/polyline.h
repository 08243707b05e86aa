// A chain of segments from point to point: one skeleton, so that its segments do not add up and its
// joints do not bulge. d is the least of the segments' distances; with a width for each point, q the
// least of the tapers' (core/shape/taper.h).
#ifndef IVORY_CORE_SHAPE_POLYLINE_H
#define IVORY_CORE_SHAPE_POLYLINE_H

#include <algorithm>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "core/shape/joined.h"
#include "core/shape/segment.h"
#include "core/shape/taper.h"

namespace ivory {

struct PolylineSkeleton : JoinedParts<SegmentSkeleton> {
    std::vector<Vec3d> points;  // 2 or more; neighbours may coincide

    PolylineSkeleton() : points(2) {}
    explicit PolylineSkeleton(std::vector<Vec3d> chain) : points(std::move(chain)) {}
    friend bool operator==(const PolylineSkeleton&, const PolylineSkeleton&) = default;

    static constexpr std::string_view word = "polyline";
    static constexpr std::string_view label = "Polyline";
    static constexpr std::string_view distance =
        "to the nearest of the segments from point to point";
    static constexpr auto members() {
        return std::tuple{places<2>("points", "Points", &PolylineSkeleton::points)};
    }
    static constexpr bool may_taper = true;
    [[nodiscard]] std::size_t width_places() const { return points.size(); }

    [[nodiscard]] Vec3d middle() const { return middle_of(points); }

    [[nodiscard]] std::size_t parts() const { return points.size() - 1; }
    [[nodiscard]] SegmentSkeleton segment(std::size_t part) const {
        return {points[part], points[part + 1]};
    }
    [[nodiscard]] SkeletonColumns part(std::size_t part) const { return segment(part).columns(); }
};

// What a field makes of a polyline with a list of widths.
struct TaperedPolyline : JoinedParts<TaperedSegment> {};

}  // namespace ivory
#endif

#ifdef IVORY_LANES  // once for each instruction set: core/shape/shape_lanes.inl
HWY_BEFORE_NAMESPACE();
namespace ivory {
namespace HWY_NAMESPACE {
namespace {

template <>
struct ShapeLanes<PolylineSkeleton> : SegmentLanes<shape_of<PolylineSkeleton>> {};
template <>
struct ShapeLanes<TaperedPolyline> : TaperLanes<shape_of<TaperedPolyline>> {};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace ivory
HWY_AFTER_NAMESPACE();
#endif
