// A point in the hand: one handle, where it is.
#pragma once

#include <array>
#include <string_view>
#include <variant>
#include <vector>

#include "app/shape/moving.h"
#include "app/shape/outlines.h"
#include "app/shape/shape_in_hand.h"
#include "core/scene/scene.h"
#include "core/shape/point.h"

namespace ivory {

template <>
struct ShapeInHand<PointSkeleton> {
    static constexpr std::string_view with_article = "a point";
    static constexpr std::array icon = {stroke::disc(0, 0, 0.42f)};

    static PointSkeleton added(const Vec3d& at, double, int) { return {at}; }

    // `position`
    static std::vector<Grip> grips(const Element& element, const HandView&) {
        return place_grips(of(element));
    }
    static bool move(Element& element, std::string_view, const HandView& view,
                     const HandleMotion& motion) {
        return move_place(std::get<PointSkeleton>(element.skeleton).position, view, motion);
    }

    static SkeletonLines lines(const Element& element) { return {{{of(element).position}}}; }
    static std::vector<PictureLine> outline(const Projection& view, const Element& element,
                                            double widths) {
        return hull_outline(view, std::array{Ball{of(element).position, widths * element.width}});
    }
    static void cover(const Element& element, double widths, std::vector<Ball>& balls) {
        balls.push_back({of(element).position, widths * element.width});
    }

  private:
    static const PointSkeleton& of(const Element& element) {
        return std::get<PointSkeleton>(element.skeleton);
    }
};

}  // namespace ivory
