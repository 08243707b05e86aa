#include "app/viewer/touched_tiles.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>

#include "app/shape/shapes.h"
#include "app/viewer/same_picture.h"
#include "core/math/direction.h"
#include "core/render/tiles.h"

namespace ivory {

namespace {

constexpr double visible_share = 1e-6;    // of the threshold
constexpr std::size_t most_changed = 16;  // elements: beyond, all tiles are traced anew

double length(const Vec3d& v) { return std::sqrt(dot(v, v)); }

// How many widths from the skeleton |F| <= share T begins.
double reach(const Element& element, double threshold) {
    return with_kernel(element.kernel, [&]<class K>() -> double {
        if constexpr (K::ends) {
            return 1;
        } else {
            const double ratio = std::abs(element.strength) / (visible_share * threshold);
            return ratio <= 1 ? 0 : std::sqrt(K::level(std::log(ratio)));
        }
    });
}

void cover(const Element& element, double threshold, std::vector<Ball>& balls) {
    if (element.visible) cover_element(element, reach(element, threshold), balls);
}

// What is left of each list without the elements that both begin and both end with.
struct Difference {
    std::span<const Element> before, after;
};

Difference difference(std::span<const Element> before, std::span<const Element> after) {
    while (!before.empty() && !after.empty() && looks_the_same(before.front(), after.front())) {
        before = before.subspan(1);
        after = after.subspan(1);
    }
    while (!before.empty() && !after.empty() && looks_the_same(before.back(), after.back())) {
        before = before.first(before.size() - 1);
        after = after.first(after.size() - 1);
    }
    return {before, after};
}

// One element, the first or the last, has gone to the other end: sums differ in their last bits.
bool is_moved(const Difference& changed) {
    const auto same = [](std::span<const Element> a, std::span<const Element> b) {
        return std::equal(a.begin(), a.end(), b.begin(), b.end(), looks_the_same);
    };
    const std::size_t count = changed.before.size();
    if (count < 2 || changed.after.size() != count) return false;
    const auto moved = [&](std::span<const Element> a, std::span<const Element> b) {
        return looks_the_same(a.front(), b.back()) && same(a.subspan(1), b.first(count - 1));
    };
    return moved(changed.before, changed.after) || moved(changed.after, changed.before);
}

// A ball that is seen within `angle` of a unit direction from the eye.
bool looks_at(const TileDirection& tile, const Vec3d& to_center, double angle) {
    const double sum = angle + tile.angle + 1e-6;
    return sum >= std::numbers::pi || dot(tile.axis, to_center) >= std::cos(sum);
}

// A ball, of a tile whose rays are parallel.
bool meets(const TileDirection& tile, const Vec3d& eye_to_center, double radius) {
    const Vec3d to_center = eye_to_center - tile.from_eye;
    const double along = dot(to_center, tile.axis);
    const double reach = (radius + tile.radius) * (1 + 1e-6);
    return along > -reach && length(to_center - along * tile.axis) <= reach;
}

}  // namespace

std::vector<TileDirection> tile_directions(const View& view, WindowSize size) {
    const TileGrid grid(size.width, size.height);
    std::vector<TileDirection> directions(grid.tiles.size());
    for (std::size_t tile = 0; tile < directions.size(); ++tile) {
        const Cone cone = cone_around(view, size.width, size.height, grid.tiles.rect(tile));
        directions[tile].axis = unit(cone.axis);
        if (view.is_orthographic()) {
            directions[tile].from_eye = cone.apex - view.origin;
            directions[tile].radius = cone.radius;
        } else {
            directions[tile].angle = cone.sine < 1 ? std::asin(cone.sine) : std::numbers::pi;
        }
    }
    return directions;
}

std::optional<std::vector<std::uint8_t>> touched_tiles(const Scene& before, const Scene& after,
                                                       const Vec3d& eye,
                                                       const std::vector<TileDirection>& tiles) {
    if (before.threshold != after.threshold) return std::nullopt;
    const Difference changed = difference(before.elements, after.elements);
    if (is_moved(changed)) return std::vector<std::uint8_t>(tiles.size(), 0);
    if (changed.before.size() + changed.after.size() > most_changed) return std::nullopt;

    std::vector<Ball> balls;
    for (const Element& element : changed.before) cover(element, before.threshold, balls);
    for (const Element& element : changed.after) cover(element, after.threshold, balls);

    std::vector<std::uint8_t> touched(tiles.size(), 0);
    const bool parallel = !tiles.empty() && tiles.front().radius > 0;
    for (const Ball& ball : balls) {
        const Vec3d to_center = ball.center - eye;
        const double distance = length(to_center);
        if (!parallel && !(distance > ball.radius)) return std::nullopt;  // the eye is in it
        const double angle = parallel ? 0 : std::asin(ball.radius / distance);
        for (std::size_t tile = 0; tile < tiles.size(); ++tile) {
            if (touched[tile] != 0) continue;
            touched[tile] = parallel ? meets(tiles[tile], to_center, ball.radius)
                                     : looks_at(tiles[tile], (1 / distance) * to_center, angle);
        }
    }
    return touched;
}

}  // namespace ivory
