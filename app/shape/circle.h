// A circle in the hand: its centre for the whole, its normal and its radius.
#pragma once

#include <array>
#include <numbers>
#include <string_view>
#include <variant>
#include <vector>

#include "app/document/tidy.h"
#include "app/shape/moving.h"
#include "app/shape/outlines.h"
#include "app/shape/shape_in_hand.h"
#include "core/scene/scene.h"
#include "core/shape/circle.h"

namespace ivory {

template <>
struct ShapeInHand<CircleSkeleton> {
    static constexpr std::string_view with_article = "a circle";
    static constexpr std::array icon = {stroke::circle(0, 0, 0.75f)};

    static CircleSkeleton added(const Vec3d& at, double size, int exponent) {
        return {at, {0, 0, 1}, tidy(1.5 * size, exponent)};
    }

    // `center`, `normal` and `radius`
    static std::vector<Grip> grips(const Element& element, const HandView& view) {
        return round_grips(std::get<CircleSkeleton>(element.skeleton), view);
    }
    static bool move(Element& element, std::string_view handle, const HandView& view,
                     const HandleMotion& motion) {
        return move_round(std::get<CircleSkeleton>(element.skeleton), handle, view, motion);
    }

    static SkeletonLines lines(const Element& element) { return {{ring_line(ring(element))}}; }
    static std::vector<PictureLine> outline(const Projection& view, const Element& element,
                                            double widths) {
        return ring_outline(view, ring(element), widths * element.width);
    }
    static void cover(const Element& element, double widths, std::vector<Ball>& balls) {
        const Ring all = ring(element);
        cover_curve(
            2 * std::numbers::pi * all.radius(), widths * element.width,
            [&](double x) { return all.at(2 * std::numbers::pi * x); }, balls);
    }

  private:
    static Ring ring(const Element& element) {
        const auto& circle = std::get<CircleSkeleton>(element.skeleton);
        return {circle.center, circle.normal, circle.radius};
    }
};

}  // namespace ivory
