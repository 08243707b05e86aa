// A polygon in the hand: its vertices by number, kept in its plane; the whole; and its normal, about which
// middle the vertices turn.
#pragma once

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
#include "core/math/direction.h"
#include "core/scene/scene.h"
#include "core/shape/polygon.h"

namespace ivory {

template <>
struct ShapeInHand<PolygonSkeleton> {
    static constexpr std::string_view with_article = "a polygon";
    static constexpr std::array icon = {
        stroke::line(-0.7f, 0.6f, -0.45f, -0.55f), stroke::line(-0.45f, -0.55f, 0.45f, -0.65f),
        stroke::line(0.45f, -0.65f, 0.75f, 0.2f), stroke::line(0.75f, 0.2f, 0.1f, 0.7f),
        stroke::line(0.1f, 0.7f, -0.7f, 0.6f)};

    static PolygonSkeleton added(const Vec3d& at, double size, int exponent) {
        constexpr std::array<std::array<double, 2>, 5> corners = {
            {{-1.4, -0.8}, {1.4, -0.8}, {1.4, 0.4}, {0, 1.2}, {-1.4, 0.4}}};
        std::vector<Vec3d> vertices;
        for (const auto& [x, y] : corners) {
            vertices.push_back(
                {tidy(at.x + x * size, exponent), tidy(at.y + y * size, exponent), at.z});
        }
        return PolygonSkeleton(std::move(vertices));
    }

    // `1`, `2`, ..., `position` and `normal`
    static std::vector<Grip> grips(const Element& element, const HandView& view) {
        const PolygonSkeleton& polygon = of(element);
        std::vector<Grip> grips = numbered_grips(polygon.vertices, "vertex ");
        grips.push_back(whole_grip("position", polygon.middle()));
        grips.push_back(normal_grip(view, polygon.middle(), normal_of(polygon), "position"));
        return grips;
    }
    static bool move(Element& element, std::string_view handle, const HandView& view,
                     const HandleMotion& motion) {
        PolygonSkeleton polygon = of(element);
        bool moves = false;
        if (const auto vertex = number_named(handle, polygon.vertices.size())) {
            moves = move_vertex(polygon, *vertex, view, motion);
        } else if (handle == "normal") {
            moves = turn(polygon, view, motion);
        } else {
            moves = move_all(polygon.vertices, polygon.middle(), view, motion);
        }
        // A vertex stops where its sides would cross others.
        if (!moves || polygon.fault()) return false;
        element.skeleton = std::move(polygon);
        return true;
    }

    static SkeletonLines lines(const Element& element) {
        SkeletonLine around = of(element).vertices;
        around.push_back(around.front());
        return {{std::move(around)}};
    }
    // The hull of each convex part with balls around its vertices.
    static std::vector<PictureLine> outline(const Projection& view, const Element& element,
                                            double widths) {
        std::vector<PictureLine> all;
        for (const SkeletonPart& part : of(element).split()) {
            std::vector<Ball> balls;
            PolygonSkeleton::for_vertices(part.seen(), [&](const Vec3d& vertex) {
                balls.push_back({vertex, widths * element.width});
            });
            for (PictureLine& line : hull_outline(view, balls)) all.push_back(std::move(line));
        }
        return all;
    }
    static void cover(const Element& element, double widths, std::vector<Ball>& balls) {
        for (const SkeletonPart& part : of(element).split()) {
            const Ball ball = PolygonSkeleton::ball(part.seen());
            cover_disc({ball.center, part.columns.m, ball.radius}, widths * element.width, balls);
        }
    }

  private:
    static const PolygonSkeleton& of(const Element& element) {
        return std::get<PolygonSkeleton>(element.skeleton);
    }
    static Vec3d normal_of(const PolygonSkeleton& polygon) {
        return polygon.split().front().columns.m;
    }

    // The pointer's line of sight meets the plane; where it hardly does, the vertex moves as a free place
    // would and is set down on the plane.
    static bool move_vertex(PolygonSkeleton& polygon, std::size_t i, const HandView& view,
                            const HandleMotion& motion) {
        constexpr double least_slope = 0.1;
        const Vec3d normal = normal_of(polygon);
        Vec3d& vertex = polygon.vertices[i];
        Vec3d to = vertex;
        const auto seen = view.projection.project(vertex);
        if (!motion.axis && seen && (motion.dx != 0 || motion.dy != 0)) {
            const Ray sight =
                view.projection.line_of_sight({seen->x + motion.dx, seen->y + motion.dy});
            const double towards = dot(sight.direction, normal);
            if (std::abs(towards) > least_slope) {
                const double t = dot(vertex - sight.origin, normal) / towards;
                if (!view.projection.is_orthographic() && !(t > 0)) return false;
                to = sight.origin + t * sight.direction;
            } else if (!move_place(to, view, motion)) {
                return false;
            }
        } else if (!move_place(to, view, motion)) {
            return false;
        }
        vertex = to - dot(to - vertex, normal) * normal;
        return true;
    }

    // All vertices turn about the middle as the normal does, by the least angle.
    static bool turn(PolygonSkeleton& polygon, const HandView& view, const HandleMotion& motion) {
        const Vec3d middle = polygon.middle(), before = normal_of(polygon);
        Vec3d after = before;
        if (!move_normal(after, middle, view, motion)) return false;
        if (dot(after, after) == 0) return false;
        after = unit(after);
        const Vec3d axis = cross(before, after);
        const double cosine = dot(before, after);
        if (cosine < -0.9) return false;
        for (Vec3d& vertex : polygon.vertices) {
            const Vec3d v = vertex - middle;
            // Rodrigues, with (1 - cos) / sin^2 = 1 / (1 + cos)
            vertex = middle + cosine * v + cross(axis, v) + (dot(axis, v) / (1 + cosine)) * axis;
        }
        return true;
    }
};

}  // namespace ivory
