// The shapes in the hand: the only list of them here. A shape is a file of this folder and a line
// among the #includes; what it has to say and does not, or a shape of core without a file, does not
// compile.
#pragma once

#include <concepts>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "app/shape/circle.h"
#include "app/shape/curve.h"
#include "app/shape/disc.h"
#include "app/shape/point.h"
#include "app/shape/polygon.h"
#include "app/shape/polyline.h"
#include "app/shape/segment.h"
#include "app/shape/shape_in_hand.h"
#include "core/scene/scene.h"

namespace ivory {

// All of it is about an element whose skeleton is an S. Distances come in widths: how far that is lies
// with the element.
template <class S>
concept ShapeForHands = requires(const Element& element, Element& changed, const HandView& view,
                                 const HandleMotion& motion, std::string_view handle, double widths,
                                 std::vector<Ball>& balls, const Vec3d& place, double size,
                                 int exponent) {
    { ShapeInHand<S>::with_article } -> std::convertible_to<std::string_view>;
    // within the square from -1 to 1
    { ShapeInHand<S>::icon } -> std::convertible_to<std::span<const Stroke>>;
    // A new one about a place, for an element of width `size`; coordinates are multiples of
    // 10^exponent.
    { ShapeInHand<S>::added(place, size, exponent) } -> std::same_as<S>;
    // In the order in which they give way to one another on the screen.
    { ShapeInHand<S>::grips(element, view) } -> std::same_as<std::vector<Grip>>;
    // That handle moved; false where the pointer meets nothing.
    { ShapeInHand<S>::move(changed, handle, view, motion) } -> std::same_as<bool>;
    { ShapeInHand<S>::lines(element) } -> std::same_as<SkeletonLines>;
    {
        ShapeInHand<S>::outline(view.projection, element, widths)
        } -> std::same_as<std::vector<PictureLine>>;
    // Adds balls that cover all points within so many widths of it.
    ShapeInHand<S>::cover(element, widths, balls);
};

static_assert([]<class... S>(TypeList<S...>) { return (ShapeForHands<S> && ...); }(Shapes{}),
              "each shape of core has its file here, and that says all there is to say");

[[nodiscard]] std::span<const Stroke> strokes_of(Shape shape);
// "a segment", and "a point, a segment or a circle": all of them.
[[nodiscard]] std::string_view with_article(Shape shape);
[[nodiscard]] std::string one_of_all_shapes();

// A new element around a place of the scene, `size` being its width. Its coordinates are multiples of
// a power of ten near size / 50, and its colour differs from those of the elements before it.
[[nodiscard]] Element new_element(Shape shape, Vec3d place, double size,
                                  std::size_t elements_before);

[[nodiscard]] std::vector<Grip> grips_of(const HandView& view, const Element& element);

// The element `start` with that handle moved; nothing where the pointer's line of sight meets
// nothing that it could be moved to.
[[nodiscard]] std::optional<Element> moved_by(const HandView& view, const Element& start,
                                              const std::string& handle,
                                              const HandleMotion& motion);

// What the overlay draws of a skeleton and a click can hit.
[[nodiscard]] SkeletonLines skeleton_lines(const Element& element);

// The outline, as the view sees it, of all places within so many widths of the skeleton: closed lines
// in the picture, exact but for being polygons. Empty where the camera is inside or some of it lies
// behind.
[[nodiscard]] std::vector<PictureLine> outline_of(const Projection& view, const Element& element,
                                                  double widths);

// Adds balls that cover all points within so many widths of the skeleton.
void cover_element(const Element& element, double widths, std::vector<Ball>& balls);

}  // namespace ivory
