// A segment in the hand: its ends, and its middle for the whole.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string_view>
#include <variant>
#include <vector>

#include "app/document/tidy.h"
#include "app/shape/moving.h"
#include "app/shape/outlines.h"
#include "app/shape/shape_in_hand.h"
#include "app/shape/widths.h"
#include "core/scene/scene.h"
#include "core/shape/segment.h"

namespace ivory {

template <>
struct ShapeInHand<SegmentSkeleton> {
    static constexpr std::string_view with_article = "a segment";
    static constexpr std::array icon = {stroke::line(-0.65f, 0.5f, 0.65f, -0.5f),
                                        stroke::disc(-0.68f, 0.52f, 0.26f),
                                        stroke::disc(0.68f, -0.52f, 0.26f)};

    static SegmentSkeleton added(const Vec3d& at, double size, int exponent) {
        return {{tidy(at.x - size, exponent), at.y, at.z},
                {tidy(at.x + size, exponent), at.y, at.z}};
    }

    // `a`, `b` and `middle`, and of tapers `width 1` and `width 2`
    static std::vector<Grip> grips(const Element& element, const HandView& view) {
        std::vector<Grip> grips = place_grips(of(element));
        grips.push_back(whole_grip("middle", of(element).middle()));
        add_width_grips(element, view, chain(element), {"a", "b"}, grips);
        return grips;
    }
    static bool move(Element& element, std::string_view handle, const HandView& view,
                     const HandleMotion& motion) {
        auto& segment = std::get<SegmentSkeleton>(element.skeleton);
        if (const auto width = width_named(element, handle)) {
            return move_width(element, *width, view, chain(element), motion);
        }
        if (Vec3d* const end = place_named(segment, handle)) return move_place(*end, view, motion);
        return move_all(std::array{std::ref(segment.a), std::ref(segment.b)}, segment.middle(),
                        view, motion);
    }

    static SkeletonLines lines(const Element& element) {
        const SegmentSkeleton& segment = of(element);
        return {{{segment.a, segment.b}}, {segment.a, segment.b}};
    }
    static std::vector<PictureLine> outline(const Projection& view, const Element& element,
                                            double widths) {
        return hull_outline(view, std::array{Ball{of(element).a, widths * width_at(element, 0)},
                                             Ball{of(element).b, widths * width_at(element, 1)}});
    }
    static void cover(const Element& element, double widths, std::vector<Ball>& balls) {
        const SegmentSkeleton& segment = of(element);
        const Vec3d along = segment.b - segment.a;
        cover_curve(
            std::sqrt(dot(along, along)),
            widths * std::max(width_at(element, 0), width_at(element, 1)),
            [&](double x) { return segment.a + x * along; }, balls);
    }

  private:
    static std::array<Vec3d, 2> chain(const Element& element) {
        return {of(element).a, of(element).b};
    }
    static const SegmentSkeleton& of(const Element& element) {
        return std::get<SegmentSkeleton>(element.skeleton);
    }
};

}  // namespace ivory
