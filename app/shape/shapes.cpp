#include "app/shape/shapes.h"

#include <array>
#include <utility>

#include "app/document/tidy.h"

namespace ivory {

namespace {

// Linear; told apart by hue and by lightness, so that neighbours in the list differ to every eye.
constexpr std::array<Color, 8> palette = {{
    {0.90, 0.30, 0.05},
    {0.08, 0.38, 0.85},
    {0.93, 0.68, 0.10},
    {0.05, 0.55, 0.35},
    {0.75, 0.12, 0.35},
    {0.35, 0.75, 0.90},
    {0.40, 0.20, 0.70},
    {0.62, 0.78, 0.18},
}};

// visit.operator()<S>() of the element's shape.
template <class Visit>
decltype(auto) with_shape_of(const Element& element, const Visit& visit) {
    return with_shape(shape_of_skeleton(element.skeleton), visit);
}

}  // namespace

std::span<const Stroke> strokes_of(Shape shape) {
    return with_shape(shape,
                      []<class S>() { return std::span<const Stroke>(ShapeInHand<S>::icon); });
}

std::string_view with_article(Shape shape) {
    return with_shape(shape,
                      []<class S>() { return std::string_view(ShapeInHand<S>::with_article); });
}

std::string one_of_all_shapes() {
    std::string all;
    for (std::size_t i = 0; i < shape_count; ++i) {
        if (i > 0) all += i + 1 < shape_count ? ", " : " or ";
        all += with_article(static_cast<Shape>(i));
    }
    return all;
}

Element new_element(Shape shape, Vec3d place, double size, std::size_t elements_before) {
    const int exponent = exponent_above(size / 100);
    const Vec3d at{tidy(place.x, exponent), tidy(place.y, exponent), tidy(place.z, exponent)};
    Element element;
    element.skeleton = with_shape(
        shape, [&]<class S>() -> Skeleton { return ShapeInHand<S>::added(at, size, exponent); });
    element.color = palette[elements_before % palette.size()];
    element.width = size;
    return element;
}

std::vector<Grip> grips_of(const HandView& view, const Element& element) {
    return with_shape_of(element, [&]<class S>() { return ShapeInHand<S>::grips(element, view); });
}

std::optional<Element> moved_by(const HandView& view, const Element& start,
                                const std::string& handle, const HandleMotion& motion) {
    if (motion.dx == 0 && motion.dy == 0 && !motion.round) return start;
    Element moved = start;
    const bool met = with_shape_of(
        start, [&]<class S>() { return ShapeInHand<S>::move(moved, handle, view, motion); });
    return met ? std::optional(std::move(moved)) : std::nullopt;
}

SkeletonLines skeleton_lines(const Element& element) {
    return with_shape_of(element, [&]<class S>() { return ShapeInHand<S>::lines(element); });
}

std::vector<PictureLine> outline_of(const Projection& view, const Element& element, double widths) {
    return with_shape_of(element,
                         [&]<class S>() { return ShapeInHand<S>::outline(view, element, widths); });
}

void cover_element(const Element& element, double widths, std::vector<Ball>& balls) {
    with_shape_of(element, [&]<class S>() { ShapeInHand<S>::cover(element, widths, balls); });
}

}  // namespace ivory
