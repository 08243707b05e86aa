#include "core/render/extent.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <queue>
#include <utility>
#include <vector>

#include "core/kernel/kernels.h"
#include "core/math/direction.h"
#include "core/render/cell_bounds.h"

namespace ivory {
namespace {

constexpr double slack = framing_slack;

// Of the picture's width or height: how near a side has to be known.
constexpr double side_tolerance = 1.0 / 100;
// Of the distance: how near the surface's depth has to be known, for the target.
constexpr double depth_tolerance = 1.0 / 12;

// Cells that are that much smaller than the tolerance are not cut any more.
constexpr double least_of_tolerance = 0.4;
constexpr double least_of_root = 0x1p-40;

// The work is limited by what it looks at, so that it depends on the scene alone.
constexpr std::size_t most_cells = 65536;
constexpr std::size_t most_evaluations = std::size_t{1} << 16;
constexpr std::size_t most_evaluations_each = 64;  // and so many more for each element

// Halvings of the way from a point of the solid to the farthest that it may reach; of so few
// elements the planes are found to the last digits that matter, so that a ball is in the middle.
constexpr int halvings = 8;
constexpr int halvings_of_few = 40;
constexpr std::size_t few = 16;

// How far a box reaches along n.
double support(const Box3& box, const Vec3d& n) {
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) sum += n[k] * (n[k] > 0 ? box.hi[k] : box.lo[k]);
    return sum;
}

// Bounds how far {f >= 0} reaches along the normals of a window.
class Search {
  public:
    Search(const Field& field, const Frustum& frustum)
        : field_(field), frustum_(frustum), bounds_(field) {}

    // Relative to middle(), rounded up. Returns false where the solid is proved to be empty. The
    // field's box must be neither empty nor infinite.
    [[nodiscard]] bool run() {
        if (!start()) return false;
        for (;;) {
            for (std::size_t side = 0; side < sides; ++side) {
                if (!open_top(side)) return false;
            }
            const std::size_t side = worst_side();
            if (side == sides || cells_.size() > most_cells || evaluations() > budget()) break;
            const std::size_t top = queue_[side].top().second;
            const double half = cells_[top].half;
            if (half <= least_of_tolerance * tolerance(side) ||
                half <= least_of_root * cells_[0].half) {
                seen_[side] = reach_[side];
            } else {
                cut(top);
            }
        }
        for (std::size_t side = 0; side < sides; ++side) reach_[side] += 64 * slack * radius();
        return true;
    }

    [[nodiscard]] const Reach& reach() const { return reach_; }
    [[nodiscard]] const Vec3d& middle() const { return bounds_.middle(); }
    // All of the solid is that near to the middle.
    [[nodiscard]] double radius() const { return bounds_.radius(); }
    [[nodiscard]] std::size_t cells() const { return cells_.size(); }
    [[nodiscard]] std::size_t evaluations() const { return evaluations_ + bounds_.evaluations(); }

  private:
    using Cell = CellBounds::Cell;

    bool start() {
        seen_.fill(-infinity<double>);
        planes_.fill(infinity<double>);
        cells_.push_back(bounds_.whole());
        for (std::size_t side = 0; side < sides; ++side) {
            queue_[side].push({reach_of(cells_[0], side), 0});
            if (!open_top(side)) return false;
        }
        for (std::size_t side = 0; side < sides; ++side) {
            if (evaluations() < budget() / 4) try_skeletons(side);
            bound_by_planes(side);
        }
        return true;
    }

    [[nodiscard]] std::size_t budget() const {
        return most_evaluations + most_evaluations_each * field_.size();
    }

    // How far the skeleton of an element reaches along a normal, about.
    [[nodiscard]] Vec3d farthest(std::size_t i, const Vec3d& normal) const {
        return with_field_shape(field_.shape[i], [&]<class S>() {
            return S::farthest(field_.columns(i), middle(), normal);
        });
    }

    // Likewise of an element, or the middle of a cluster where there are any.
    [[nodiscard]] Vec3d place(std::size_t n, const Vec3d& normal) const {
        if (field_.clusters.empty()) return farthest(n, normal);
        return bounds_.cluster(static_cast<std::uint32_t>(n)).center - middle();
    }

    // Beyond the plane n . p = t an element adds no more than b k(s) at the distance of its
    // skeleton from there: moves the bound of a side to where these add up to T. Many elements one
    // beside the other count as if they were all at one place, and yet it is much nearer than the
    // box.
    void bound_by_planes(std::size_t side) {
        struct Behind {
            double farthest;  // along the normal
            std::uint32_t element;
        };
        const Vec3d& normal = frustum_.normal[side];
        const double normal_length = length_of(normal), per_length = (1 - slack) / normal_length;
        const double least =
            CellBounds::share_left_out * field_.threshold / static_cast<double>(field_.size());
        const CellBounds::Far far = bounds_.far_beyond(least);
        double inside = std::max(seen_[side], -radius() * normal_length), outside = reach_[side];
        double left_out = 0;
        std::vector<Behind> behind;
        const auto take = [&](std::size_t i) {
            if (field_.strength[i] < 0) return;
            behind.push_back({dot(farthest(i, normal), normal), static_cast<std::uint32_t>(i)});
        };
        if (field_.clusters.empty()) {
            for (std::size_t i = 0; i < field_.size(); ++i) take(i);
        }
        for (std::uint32_t n = 0; n < field_.clusters.size(); ++n) {
            const CellBounds::Ball ball = bounds_.cluster(n);
            const double away = (inside - dot(ball.center - middle(), normal)) * per_length -
                                ball.radius - bounds_.lost();
            const double s = away > 0 ? away * away * ball.inverse_square * (1 - slack) : 0;
            if (s >= far[static_cast<std::size_t>(ball.kernel)]) {
                if (!kernel_ends(ball.kernel)) left_out += least;
                continue;
            }
            for (std::uint32_t i = ball.first; i < ball.end; ++i) take(i);
        }
        const double rounding = 1 + static_cast<double>(field_.size() + 8) * 0x1p-51;
        const int steps = field_.size() <= few ? halvings_of_few : halvings;
        for (int step = 0; step < steps && inside < outside; ++step) {
            const double plane = 0.5 * (inside + outside);
            std::size_t kept = 0;
            double sum = left_out, dropped = 0, of_parts = 0;
            std::uint32_t last_source = 0;  // of what `of_parts` is of
            for (std::size_t n = 0; n < behind.size(); ++n) {
                const Behind& at = behind[n];
                const std::size_t i = at.element;
                const double away = (plane - at.farthest) * per_length - bounds_.lost();
                const double q = away > 0 ? away / field_.greatest_width_of(i) * (1 - slack) : 0;
                const double s = q * q * (1 - slack);
                if (s >= far[static_cast<std::size_t>(field_.kernel[i])]) {
                    if (!kernel_ends(field_.kernel[i])) dropped += least;
                    continue;
                }
                const Behind copy = at;
                if (sum < field_.threshold) {
                    const double most =
                        field_.strength[i] * (s > 0 ? kernel_at(field_.kernel[i], s).hi : 1);
                    // of an element's parts, which follow each other, the greatest
                    const bool joins =
                        is_joined(field_.shape[i]) && kept > 0 && field_.source[i] == last_source;
                    sum += joins ? std::max(most - of_parts, 0.0) : most;
                    of_parts = joins ? std::max(most, of_parts) : most;
                    last_source = field_.source[i];
                }
                std::swap(behind[n], behind[kept]);
                behind[kept++] = copy;
            }
            evaluations_ += kept;
            if ((sum + dropped) * rounding < field_.threshold) {
                outside = plane;
            } else {
                inside = plane;
                // Farther on they add even less.
                left_out += dropped;
                behind.resize(kept);
            }
        }
        reach_[side] = planes_[side] = outside;
    }

    // Looks for a point of the solid that reaches far, from the skeletons that do on, so that less
    // has to be searched.
    void try_skeletons(std::size_t side) {
        const Vec3d& normal = frustum_.normal[side];
        const std::size_t count = field_.clusters.empty() ? field_.size() : field_.clusters.size();
        std::vector<std::pair<double, std::size_t>> order(count);
        for (std::size_t n = 0; n < count; ++n) order[n] = {dot(place(n, normal), normal), n};
        std::sort(order.begin(), order.end(), std::greater<>());
        for (std::size_t rank = 0; rank < count; rank = 2 * rank + (rank == 0 ? 1 : 0)) {
            const Vec3d start = place(order[rank].second, normal);
            if (!is_inside(start)) continue;
            double inside = 0, beyond = (reach_[side] - dot(start, normal)) / dot(normal, normal);
            for (int step = 0; step < halvings; ++step) {
                const double middle = 0.5 * (inside + beyond);
                (is_inside(start + middle * normal) ? inside : beyond) = middle;
            }
            note_inside(start + inside * normal);
            return;
        }
    }

    // f > 0 there, about. Before the first cell is cut.
    [[nodiscard]] bool is_inside(const Vec3d& place) {
        Cell point;
        point.center = place;
        bounds_.look(cells_[0], point);
        return point.value > 0;
    }

    void note_inside(const Vec3d& place) {
        for (std::size_t side = 0; side < sides; ++side) {
            seen_[side] = std::max(seen_[side], dot(frustum_.normal[side], place));
        }
    }

    // Puts the farthest cell that has not been cut on top of the side's queue. False: there is
    // none.
    bool open_top(std::size_t side) {
        Queue& queue = queue_[side];
        while (!queue.empty() && cells_[queue.top().second].first_child != 0) {
            const std::size_t first = cells_[queue.top().second].first_child;
            queue.pop();
            for (std::size_t child = first; child < first + 8; ++child) {
                if (!cells_[child].outside) queue.push({reach_of(cells_[child], side), child});
            }
        }
        if (queue.empty()) return false;
        reach_[side] = std::min(queue.top().first, planes_[side]);
        return true;
    }

    [[nodiscard]] double reach_of(const Cell& cell, std::size_t side) const {
        Box3 part;
        for (std::size_t k = 0; k < 3; ++k) {
            part.lo[k] = std::max(cell.center[k] - cell.half, bounds_.box().lo[k]);
            part.hi[k] = std::min(cell.center[k] + cell.half, bounds_.box().hi[k]);
        }
        return support(part, frustum_.normal[side]);
    }

    // A share of what is seen at the distance, or with the half height, that the sides known so far
    // ask for. The sides of a ball around the middle are touched nearer to the eye, at 1 / (1 + k^2)
    // of that distance.
    [[nodiscard]] double tolerance(std::size_t side) const {
        const double distance =
            std::max({(reach_[to_right] + reach_[to_left]) / (2 * frustum_.half_width),
                      (reach_[to_top] + reach_[to_bottom]) / (2 * frustum_.half_height), 0.0});
        if (side >= to_far) return depth_tolerance * distance;
        const double half = side < to_top ? frustum_.half_width : frustum_.half_height;
        const double farther = frustum_.is_parallel ? 1 : 1 + half * half;
        return 2 * side_tolerance * distance * half / farther;
    }

    // The one that is known worst, compared with its tolerance; `sides` where all are good enough.
    // Large cells come first: where no point of the solid is known that reaches far, cutting small
    // ones would take all the work.
    [[nodiscard]] std::size_t worst_side() const {
        std::size_t worst = sides;
        double most = 0;
        for (std::size_t side = 0; side < sides; ++side) {
            const double gap = reach_[side] - seen_[side], enough = tolerance(side);
            const double half = cells_[queue_[side].top().second].half;
            if (gap > enough && std::min(gap, half) / enough > most) {
                most = std::min(gap, half) / enough;
                worst = side;
            }
        }
        return worst;
    }

    void cut(std::size_t parent) {
        const std::size_t first = cells_.size();
        cells_.resize(first + 8);
        cells_[parent].first_child = first;
        for (std::size_t n = 0; n < 8; ++n) {
            Cell& child = cells_[first + n];
            child = CellBounds::eighth(cells_[parent], n);
            bounds_.look(cells_[parent], child);
            if (!child.outside && child.value > 0) note_inside(child.center);
        }
        cells_[parent].elements = cells_[parent].clusters = cells_[parent].blocks = {};
    }

    // What reaches farthest first.
    using Queue = std::priority_queue<std::pair<double, std::size_t>>;

    const Field& field_;
    const Frustum& frustum_;
    CellBounds bounds_;
    std::vector<Cell> cells_;
    std::array<Queue, sides> queue_;
    Reach reach_{};                // no point of the solid is farther
    Reach seen_{};                 // a point of the solid is about that far
    Reach planes_{};               // proved by planes alone
    std::size_t evaluations_ = 0;  // by planes
};

}  // namespace

Frustum frustum_of(const View& view, double aspect, double share) {
    Frustum frustum;
    frustum.forward = view.forward;
    frustum.right = view.right;
    frustum.top = view.top;
    frustum.is_parallel = view.is_orthographic();
    const double half = frustum.is_parallel ? share : share * view.s;
    frustum.half_width = half * aspect;
    frustum.half_height = half;
    const Vec3d back = -1.0 * frustum.forward;
    const Vec3d outward = frustum.is_parallel ? Vec3d{} : back;
    frustum.normal = {frustum.right + frustum.half_width * outward,
                      -1.0 * frustum.right + frustum.half_width * outward,
                      frustum.top + frustum.half_height * outward,
                      -1.0 * frustum.top + frustum.half_height * outward,
                      frustum.forward,
                      back};
    return frustum;
}

Extent extent_of(const Box3& box, const Frustum& frustum) {
    Extent extent;
    extent.middle = 0.5 * box.lo + 0.5 * box.hi;
    Box3 around;
    for (std::size_t k = 0; k < 3; ++k) {
        around.lo[k] = sub_down(box.lo[k], extent.middle[k]);
        around.hi[k] = sub_up(box.hi[k], extent.middle[k]);
    }
    extent.radius = std::max(length_of(around.lo), length_of(around.hi)) * (1 + slack);
    for (std::size_t side = 0; side < sides; ++side) {
        extent.reach[side] = support(around, frustum.normal[side]) + 64 * slack * extent.radius;
    }
    return extent;
}

std::optional<Extent> extent_of_solid(const Field& field, const Frustum& frustum,
                                      ExtentWork& work) {
    if (field.box.empty()) return std::nullopt;
    Search search(field, frustum);
    const bool is_empty = !search.run();
    work = {search.cells(), search.evaluations()};
    if (is_empty) return std::nullopt;
    return Extent{search.reach(), search.middle(), search.radius()};
}

}  // namespace ivory
