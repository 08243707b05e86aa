// A disc in the hand: its centre for the whole, its normal and its radius.
#pragma once

#include <array>
#include <string_view>
#include <variant>
#include <vector>

#include "app/document/tidy.h"
#include "app/shape/moving.h"
#include "app/shape/outlines.h"
#include "app/shape/shape_in_hand.h"
#include "core/scene/scene.h"
#include "core/shape/disc.h"

namespace ivory {

template <>
struct ShapeInHand<DiscSkeleton> {
    static constexpr std::string_view with_article = "a disc";
    static constexpr std::array icon = {stroke::disc(0, 0, 0.75f)};

    static DiscSkeleton added(const Vec3d& at, double size, int exponent) {
        return {at, {0, 0, 1}, tidy(1.5 * size, exponent)};
    }

    // `center`, `normal` and `radius`
    static std::vector<Grip> grips(const Element& element, const HandView& view) {
        return round_grips(std::get<DiscSkeleton>(element.skeleton), view);
    }
    static bool move(Element& element, std::string_view handle, const HandView& view,
                     const HandleMotion& motion) {
        return move_round(std::get<DiscSkeleton>(element.skeleton), handle, view, motion);
    }

    static SkeletonLines lines(const Element& element) { return {{ring_line(rim(element))}}; }
    static std::vector<PictureLine> outline(const Projection& view, const Element& element,
                                            double widths) {
        return disc_outline(view, rim(element), widths * element.width);
    }
    static void cover(const Element& element, double widths, std::vector<Ball>& balls) {
        cover_disc(rim(element), widths * element.width, balls);
    }

  private:
    static Ring rim(const Element& element) {
        const auto& disc = std::get<DiscSkeleton>(element.skeleton);
        return {disc.center, disc.normal, disc.radius};
    }
};

}  // namespace ivory
