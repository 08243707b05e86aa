// A curve in the hand: its control points by number, and the whole.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "app/document/tidy.h"
#include "app/shape/moving.h"
#include "app/shape/outlines.h"
#include "app/shape/shape_in_hand.h"
#include "app/shape/widths.h"
#include "core/scene/scene.h"
#include "core/shape/curve.h"

namespace ivory {

template <>
struct ShapeInHand<CurveSkeleton> {
    static constexpr std::string_view with_article = "a curve";
    static constexpr std::array icon = {
        stroke::line(-0.75f, 0.5f, -0.58f, -0.05f), stroke::line(-0.58f, -0.05f, -0.3f, -0.4f),
        stroke::line(-0.3f, -0.4f, 0, -0.3f),       stroke::line(0, -0.3f, 0.25f, 0.15f),
        stroke::line(0.25f, 0.15f, 0.5f, 0.3f),     stroke::line(0.5f, 0.3f, 0.75f, -0.1f)};

    static CurveSkeleton added(const Vec3d& at, double size, int exponent) {
        constexpr std::array<std::array<double, 2>, 4> points = {
            {{-2, -0.5}, {-0.8, 0.9}, {0.8, 0.9}, {2, -0.5}}};
        std::vector<Vec3d> control_points;
        for (const auto& [x, y] : points) {
            control_points.push_back(
                {tidy(at.x + x * size, exponent), tidy(at.y + y * size, exponent), at.z});
        }
        return CurveSkeleton(std::move(control_points));
    }

    // `1`, `2`, ... and `position`
    static std::vector<Grip> grips(const Element& element, const HandView&) {
        std::vector<Grip> grips = numbered_grips(of(element).control_points, "control point ");
        grips.push_back(whole_grip("position", of(element).middle()));
        return grips;
    }
    static bool move(Element& element, std::string_view handle, const HandView& view,
                     const HandleMotion& motion) {
        auto& curve = std::get<CurveSkeleton>(element.skeleton);
        if (const auto point = number_named(handle, curve.control_points.size())) {
            return move_place(curve.control_points[*point], view, motion);
        }
        return move_all(curve.control_points, curve.middle(), view, motion);
    }

    static SkeletonLines lines(const Element& element) { return {{places(element, line_pieces)}}; }
    // Around the balls as they are seen: along one side, about the end, back along the other. (A ball off the
    // middle of the picture is seen a little longer than it is wide.)
    static std::vector<PictureLine> outline(const Projection& view, const Element& element,
                                            double widths) {
        constexpr int half_turn = 16;
        struct Seen {
            WindowPoint at;
            double radius;
        };
        std::vector<Seen> seen;
        for (const Vec3d& place : places(element, line_pieces)) {
            const auto at = view.project(place);
            const double pixel = view.length_of_pixel(place);
            if (!at || !(pixel > 0)) return {};
            seen.push_back({*at, widths * element.width / pixel});
        }
        // The direction of the way at a place, in the picture.
        const auto angle = [&](std::size_t i) {
            const WindowPoint& from = seen[i > 0 ? i - 1 : 0].at;
            const WindowPoint& to = seen[std::min(i + 1, seen.size() - 1)].at;
            return std::atan2(to.y - from.y, to.x - from.x);
        };
        PictureLine line;
        const auto add = [&](std::size_t i, double turned) {
            WindowPoint point = seen[i].at;
            point.x += static_cast<decltype(point.x)>(seen[i].radius * std::cos(turned));
            point.y += static_cast<decltype(point.y)>(seen[i].radius * std::sin(turned));
            line.push_back(point);
        };
        constexpr double right = 1.5707963267948966;
        const std::size_t last = seen.size() - 1;
        for (std::size_t i = 0; i <= last; ++i) add(i, angle(i) - right);
        for (int k = 1; k < half_turn; ++k)
            add(last, angle(last) - right + 2 * right * k / half_turn);
        for (std::size_t i = last + 1; i-- > 0;) add(i, angle(i) + right);
        for (int k = 1; k <= half_turn; ++k) add(0, angle(0) + right + 2 * right * k / half_turn);
        return {std::move(line)};
    }
    // A curve is within an eighth of the greatest |c''| of its chord, over the square of the pieces.
    static void cover(const Element& element, double widths, std::vector<Ball>& balls) {
        const std::vector<Vec3d> chain = places(element, outline_pieces);
        const std::vector<Vec3d>& p = of(element).control_points;
        double bend = 0;
        for (std::size_t i = 0; i + 2 < p.size(); ++i) {
            const Vec3d second = p[i] - 2.0 * p[i + 1] + p[i + 2];
            bend = std::max(bend, std::sqrt(dot(second, second)));
        }
        const double off = 0.75 * bend / (outline_pieces * outline_pieces);
        for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
            const Vec3d from = chain[i], along = chain[i + 1] - from;
            cover_curve(
                std::sqrt(dot(along, along)), widths * element.width + off,
                [&](double x) { return from + x * along; }, balls);
        }
    }

  private:
    static constexpr int line_pieces = 64, outline_pieces = 24;

    static const CurveSkeleton& of(const Element& element) {
        return std::get<CurveSkeleton>(element.skeleton);
    }
    // de Casteljau's
    static std::vector<Vec3d> places(const Element& element, int pieces) {
        std::vector<Vec3d> line;
        for (int i = 0; i <= pieces; ++i) {
            const double x = static_cast<double>(i) / pieces;
            std::vector<Vec3d> p = of(element).control_points;
            for (std::size_t left = p.size() - 1; left > 0; --left) {
                for (std::size_t k = 0; k < left; ++k) p[k] = (1 - x) * p[k] + x * p[k + 1];
            }
            line.push_back(p[0]);
        }
        return line;
    }
};

}  // namespace ivory
