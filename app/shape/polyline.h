// A polyline in the hand: its points by number, the whole, and a width for each point where there is a
// list of them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "app/document/tidy.h"
#include "app/shape/moving.h"
#include "app/shape/outlines.h"
#include "app/shape/shape_in_hand.h"
#include "app/shape/widths.h"
#include "core/scene/scene.h"
#include "core/shape/polyline.h"

namespace ivory {

template <>
struct ShapeInHand<PolylineSkeleton> {
    static constexpr std::string_view with_article = "a polyline";
    static constexpr std::array icon = {
        stroke::line(-0.75f, 0.45f, -0.2f, -0.45f), stroke::line(-0.2f, -0.45f, 0.25f, 0.4f),
        stroke::line(0.25f, 0.4f, 0.75f, -0.45f),   stroke::disc(-0.75f, 0.45f, 0.2f),
        stroke::disc(-0.2f, -0.45f, 0.2f),          stroke::disc(0.25f, 0.4f, 0.2f),
        stroke::disc(0.75f, -0.45f, 0.2f)};

    static PolylineSkeleton added(const Vec3d& at, double size, int exponent) {
        std::vector<Vec3d> points;
        for (int i = 0; i < 4; ++i) {
            points.push_back({tidy(at.x + (i - 1.5) * size, exponent),
                              tidy(at.y + (i % 2 == 0 ? -0.5 : 0.5) * size, exponent), at.z});
        }
        return PolylineSkeleton(std::move(points));
    }

    // `1`, `2`, ..., `position`, and of tapers `width 1`, ...
    static std::vector<Grip> grips(const Element& element, const HandView& view) {
        const std::vector<Vec3d>& points = of(element).points;
        std::vector<Grip> grips = numbered_grips(points, "point ");
        grips.push_back(whole_grip("position", of(element).middle()));
        add_width_grips(element, view, points, numbers_of(points.size()), grips);
        return grips;
    }
    static bool move(Element& element, std::string_view handle, const HandView& view,
                     const HandleMotion& motion) {
        auto& chain = std::get<PolylineSkeleton>(element.skeleton);
        if (const auto width = width_named(element, handle)) {
            return move_width(element, *width, view, chain.points, motion);
        }
        if (const auto point = number_named(handle, chain.points.size())) {
            return move_place(chain.points[*point], view, motion);
        }
        return move_all(chain.points, chain.middle(), view, motion);
    }

    static SkeletonLines lines(const Element& element) {
        return {{of(element).points}, of(element).points};
    }
    static std::vector<PictureLine> outline(const Projection& view, const Element& element,
                                            double widths) {
        std::vector<PictureLine> all;
        const std::vector<Vec3d>& points = of(element).points;
        for (std::size_t i = 0; i + 1 < points.size(); ++i) {
            const std::array balls{Ball{points[i], widths * width_at(element, i)},
                                   Ball{points[i + 1], widths * width_at(element, i + 1)}};
            for (PictureLine& line : hull_outline(view, balls)) all.push_back(std::move(line));
        }
        return all;
    }
    static void cover(const Element& element, double widths, std::vector<Ball>& balls) {
        const std::vector<Vec3d>& points = of(element).points;
        for (std::size_t i = 0; i + 1 < points.size(); ++i) {
            const Vec3d from = points[i], along = points[i + 1] - from;
            cover_curve(
                std::sqrt(dot(along, along)),
                widths * std::max(width_at(element, i), width_at(element, i + 1)),
                [&](double x) { return from + x * along; }, balls);
        }
    }

  private:
    static const PolylineSkeleton& of(const Element& element) {
        return std::get<PolylineSkeleton>(element.skeleton);
    }
};

}  // namespace ivory
