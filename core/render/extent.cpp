#include "core/render/extent.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <queue>
#include <utility>
#include <vector>

#include "core/field/surface.h"
#include "core/kernel/kernels.h"

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

// Elements are bounded together in cells whose half is no less than this part of their ball.
constexpr double most_of_half = 2;

// So many clusters that follow each other are a block: large cells look at blocks.
constexpr std::size_t block_size = 16;

// An element whose |F| stays below this share of T, divided by how many are listed, is no longer
// listed: what it can add is kept.
constexpr double share_left_out = 0x1p-9;

// Halvings of the way from a point of the solid to the farthest that it may reach; of so few
// elements the planes are found to the last digits that matter, so that a ball is in the middle.
constexpr int halvings = 8;
constexpr int halvings_of_few = 40;
constexpr std::size_t few = 16;

double length(const Vec3d& v) { return std::hypot(v.x, v.y, v.z); }

// How far a box reaches along n.
double support(const Box3& box, const Vec3d& n) {
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) sum += n[k] * (n[k] > 0 ? box.hi[k] : box.lo[k]);
    return sum;
}

// Elements bounded together, as in core/field/clusters.h: a cluster, or a block of clusters.
struct Ball {
    Vec3d center;
    double radius = 0, above = 0, below = 0, inverse_square = 0;
    KernelKind kernel = KernelKind::blinn;
    std::uint32_t first = 0, end = 0;  // elements of a cluster, clusters of a block
};

// A cube, relative to the middle of the search, and what matters in it. The elements, the members
// of clusters and blocks, and what was left out stand for the whole field there: f <= the sum of
// the listed F_i + left_out - T.
struct Cell {
    Vec3d center;
    double half = 0;
    std::vector<std::uint32_t> elements, clusters, blocks;
    double left_out = 0;
    double value = 0;  // f at the centre, about: only a reason to stop
    bool outside = false;
    std::size_t first_child = 0;  // 0: not cut
};

// Bounds how far {f >= 0} reaches along the normals of a window.
class Search {
  public:
    Search(const Field& field, const Frustum& frustum) : field_(field), frustum_(frustum) {}

    // Relative to middle(), rounded up. Returns false where the solid is proved to be empty. The
    // field's box must be neither empty nor infinite.
    [[nodiscard]] bool run() {
        if (!start()) return false;
        for (;;) {
            for (std::size_t side = 0; side < sides; ++side) {
                if (!open_top(side)) return false;
            }
            const std::size_t side = worst_side();
            if (side == sides || cells_.size() > most_cells || evaluations_ > budget()) break;
            const std::size_t top = queue_[side].top().second;
            const double half = cells_[top].half;
            if (half <= least_of_tolerance * tolerance(side) ||
                half <= least_of_root * root_half_) {
                seen_[side] = reach_[side];
            } else {
                cut(top);
            }
        }
        for (std::size_t side = 0; side < sides; ++side) reach_[side] += 64 * slack * radius_;
        return true;
    }

    [[nodiscard]] const Reach& reach() const { return reach_; }
    [[nodiscard]] Vec3d middle() const { return middle_; }
    // All of the solid is that near to the middle.
    [[nodiscard]] double radius() const { return radius_; }
    [[nodiscard]] std::size_t cells() const { return cells_.size(); }
    [[nodiscard]] std::size_t evaluations() const { return evaluations_; }

  private:
    bool start() {
        const Box3& box = field_.box;
        middle_ = 0.5 * box.lo + 0.5 * box.hi;
        double most = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            box_.lo[k] = sub_down(box.lo[k], middle_[k]);
            box_.hi[k] = add_up(box.hi[k], -middle_[k]);
            most = std::max({most, -box_.lo[k], box_.hi[k]});
        }
        radius_ = std::sqrt(3.0) * most * (1 + 16 * slack);
        // A power of two: the middles of all cells are doubles.
        int exponent = 0;
        std::frexp(most, &exponent);
        root_half_ = std::ldexp(1.0, exponent);

        Box3 all = field_.skeletons;
        all.include(box);
        lost_ = 16 * slack * (length(all.hi - middle_) + length(all.lo - middle_));

        seen_.fill(-infinity<double>);
        planes_.fill(infinity<double>);
        Cell whole;
        whole.half = root_half_;
        if (field_.clusters.empty()) {
            whole.elements = all_elements(field_).elements;
        } else {
            make_blocks();
            for (std::uint32_t n = 0; n < blocks_.size(); ++n) whole.blocks.push_back(n);
        }
        for (const double b : field_.strength) {
            strongest_ = std::max(strongest_, std::abs(b));
            carved_ = carved_ || b < 0;
        }
        for (const Ball& block : blocks_) {
            strongest_ = std::max({strongest_, block.above, block.below});
        }
        cells_.push_back(std::move(whole));
        for (std::size_t side = 0; side < sides; ++side) {
            queue_[side].push({reach_of(cells_[0], side), 0});
            if (!open_top(side)) return false;
        }
        for (std::size_t side = 0; side < sides; ++side) {
            if (evaluations_ < budget() / 4) try_skeletons(side);
            bound_by_planes(side);
        }
        return true;
    }

    [[nodiscard]] Ball cluster(std::uint32_t n) const {
        const Clusters& all = field_.clusters;
        return {{all.x[n], all.y[n], all.z[n]},
                all.radius[n],
                all.above[n],
                all.below[n],
                all.inverse_square[n],
                field_.kernel[all.first[n]],
                all.first[n],
                all.first[n + 1]};
    }

    // Clusters of one group follow each other along a curve through space.
    void make_blocks() {
        const Clusters& all = field_.clusters;
        for (std::size_t group = 0; group < field_groups; ++group) {
            const auto [group_first, group_end] = all.first_of_group.of(group);
            for (std::uint32_t first = group_first; first < group_end;) {
                Ball block = cluster(first);
                block.first = first;
                block.end = std::min<std::uint32_t>(first + block_size, group_end);
                Box3 box;
                for (std::uint32_t n = first; n < block.end; ++n) {
                    const Vec3d& at = cluster(n).center;
                    box.include({at, at});
                }
                block.center = 0.5 * box.lo + 0.5 * box.hi;
                block.radius = block.above = block.below = 0;
                for (std::uint32_t n = first; n < block.end; ++n) {
                    const Ball ball = cluster(n);
                    block.radius =
                        std::max(block.radius, length(ball.center - block.center) + ball.radius);
                    block.above += ball.above;
                    block.below += ball.below;
                    block.inverse_square = std::min(block.inverse_square, ball.inverse_square);
                }
                block.radius *= 1 + slack;
                block.above *= 1 + slack;
                block.below *= 1 + slack;
                first = block.end;
                blocks_.push_back(block);
            }
        }
    }

    [[nodiscard]] std::size_t budget() const {
        return most_evaluations + most_evaluations_each * field_.size();
    }

    // How far the skeleton of an element reaches along a normal, about.
    [[nodiscard]] Vec3d farthest(std::size_t i, const Vec3d& normal) const {
        return with_field_shape(field_.shape[i], [&]<class S>() {
            return S::farthest(field_.columns(i), middle_, normal);
        });
    }

    // Likewise of an element, or the middle of a cluster where there are any.
    [[nodiscard]] Vec3d place(std::size_t n, const Vec3d& normal) const {
        if (field_.clusters.empty()) return farthest(n, normal);
        return cluster(static_cast<std::uint32_t>(n)).center - middle_;
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
        const double normal_length = length(normal), per_length = (1 - slack) / normal_length;
        const double least = share_left_out * field_.threshold / static_cast<double>(field_.size());
        const Far far = far_beyond(least);
        double inside = std::max(seen_[side], -radius_ * normal_length), outside = reach_[side];
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
            const Ball ball = cluster(n);
            const double away =
                (inside - dot(ball.center - middle_, normal)) * per_length - ball.radius - lost_;
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
                const double away = (plane - at.farthest) * per_length - lost_;
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
        look(cells_[0], point);
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
            part.lo[k] = std::max(cell.center[k] - cell.half, box_.lo[k]);
            part.hi[k] = std::min(cell.center[k] + cell.half, box_.hi[k]);
        }
        return support(part, frustum_.normal[side]);
    }

    // A share of what is seen at the distance that the sides known so far ask for. The sides of a
    // ball around the middle are touched nearer to the eye, at 1 / (1 + k^2) of that distance.
    [[nodiscard]] double tolerance(std::size_t side) const {
        const double distance =
            std::max({(reach_[to_right] + reach_[to_left]) / (2 * frustum_.half_width),
                      (reach_[to_top] + reach_[to_bottom]) / (2 * frustum_.half_height), 0.0});
        if (side >= to_far) return depth_tolerance * distance;
        const double half = side < to_top ? frustum_.half_width : frustum_.half_height;
        return 2 * side_tolerance * distance * half / (1 + half * half);
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
            child.half = 0.5 * cells_[parent].half;
            for (std::size_t k = 0; k < 3; ++k) {
                child.center[k] =
                    cells_[parent].center[k] + ((n >> k & 1) != 0 ? child.half : -child.half);
            }
            look(cells_[parent], child);
            if (!child.outside && child.value > 0) note_inside(child.center);
        }
        cells_[parent].elements = cells_[parent].clusters = cells_[parent].blocks = {};
    }

    // What the field can be in a cell, from the list of the one that it was cut out of.
    void look(const Cell& parent, Cell& cell) {
        for (std::size_t k = 0; k < 3; ++k) {
            if (cell.center[k] + cell.half < box_.lo[k] ||
                cell.center[k] - cell.half > box_.hi[k]) {
                cell.outside = true;
                return;
            }
        }
        Sum sum;
        sum.least = share_left_out * field_.threshold /
                    static_cast<double>(parent.elements.size() +
                                        cluster_size * (parent.clusters.size() +
                                                        block_size * parent.blocks.size()));
        sum.far = far_beyond(sum.least);
        sum.rough = !parent.blocks.empty() && cell.half > 0;
        cell.left_out = parent.left_out;
        const auto add_all = [&](const std::vector<std::uint32_t>& list, auto add) {
            for (const std::uint32_t n : list) {
                if (cell.half == 0 && is_settled(sum)) return;  // of a point no more is asked
                (this->*add)(n, cell, sum);
            }
        };
        add_all(parent.blocks, &Search::add_block);
        add_all(parent.clusters, &Search::add_cluster);
        add_all(parent.elements, &Search::add_element);

        const double count = static_cast<double>(sum.count + 8);
        evaluations_ += sum.count;
        const double rounding =
            count * 0x1p-51 * (sum.magnitude + cell.left_out + field_.threshold);
        cell.outside = sum.above + cell.left_out + rounding < field_.threshold;
        cell.value = sum.value - field_.threshold;
    }

    // For each kernel an s at and beyond which |b| k(s) <= least certainly holds for every element and
    // cluster; a kernel that ends is 0 there.
    using Far = std::array<double, kernel_count>;
    [[nodiscard]] Far far_beyond(double least) const {
        Far far;
        for_each_type(Kernels{}, [&]<class K>() {
            double& of_kernel = far[static_cast<std::size_t>(kind_of<K>)];
            if constexpr (K::ends) {
                of_kernel = 1;
            } else {
                const double s = K::level(std::log(strongest_ / least)) + 1e-6;
                const bool holds =
                    s > 0 && s < K::vanishes && mul_up(strongest_, K::at(s).hi) <= least;
                of_kernel = holds ? s : infinity<double>;
            }
        });
        return far;
    }
    struct Sum {
        double above = 0;      // of upper bounds of the listed F_i
        double magnitude = 0;  // of what was added
        double value = 0;      // of the F_i at the centre
        double least = 0;      // what counts as nothing
        Far far{};             // and from which s on
        bool rough = false;    // the cell is so large that the field at its centre tells little
        std::size_t count = 0;

        // Of parts that follow each other: what is more than with those before.
        void join(std::uint32_t of, double& bound, double& at_center) {
            if (!has_parts || of != source) {
                has_parts = true;
                source = of;
                parts_bound = bound;
                parts_value = at_center;
                return;
            }
            const double before = parts_bound, value_before = parts_value;
            parts_bound = std::max(parts_bound, bound);
            if (std::abs(at_center) > std::abs(parts_value)) parts_value = at_center;
            bound = (parts_bound - before) * (1 + slack);
            at_center = parts_value - value_before;
        }
        bool has_parts = false;
        std::uint32_t source = 0;  // of what follows
        double parts_bound = 0, parts_value = 0;
    };

    // Leaves out what is that far away.
    static void leave_out(KernelKind kernel, const Sum& sum, Cell& cell) {
        if (!kernel_ends(kernel)) cell.left_out += sum.least;
    }

    // Where nothing carves, the rest can neither lower the bound below T nor f at the centre: it is
    // only listed.
    [[nodiscard]] bool is_settled(const Sum& sum) const {
        return !carved_ && sum.above >= field_.threshold &&
               (sum.value > field_.threshold || sum.rough);
    }

    // The members of a ball that is no larger than the cell stand together; those of a larger one
    // each for itself.
    void add_block(std::uint32_t n, Cell& cell, Sum& sum) const {
        const Ball& block = blocks_[n];
        switch (add_ball(block, cell, sum)) {
            case Added::nothing:
                return;
            case Added::together:
                cell.blocks.push_back(n);
                return;
            case Added::none_yet:
                for (std::uint32_t m = block.first; m < block.end; ++m) add_cluster(m, cell, sum);
        }
    }

    void add_cluster(std::uint32_t n, Cell& cell, Sum& sum) const {
        const Ball ball = cluster(n);
        switch (add_ball(ball, cell, sum)) {
            case Added::nothing:
                return;
            case Added::together:
                cell.clusters.push_back(n);
                return;
            case Added::none_yet:
                for (std::uint32_t i = ball.first; i < ball.end; ++i) add_element(i, cell, sum);
        }
    }

    enum class Added : std::uint8_t { nothing, together, none_yet };

    // The members add up to no more than above k(s) where s is the least in the cell.
    [[nodiscard]] Added add_ball(const Ball& ball, Cell& cell, Sum& sum) const {
        const Vec3d from = ball.center - middle_;
        double nearest = 0, at_center = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const double off = std::abs(from[k] - cell.center[k]);
            const double beyond = std::max(off - cell.half, 0.0);
            nearest += beyond * beyond;
            at_center += off * off;
        }
        const double distance = std::sqrt(nearest) * (1 - slack) - ball.radius - lost_;
        const double s = distance > 0 ? distance * distance * ball.inverse_square * (1 - slack) : 0;
        ++sum.count;
        if (s >= sum.far[static_cast<std::size_t>(ball.kernel)]) {
            leave_out(ball.kernel, sum, cell);
            return Added::nothing;
        }
        // So small a ball is about a point: good enough for the value at a point.
        const bool is_point = 2 * ball.radius * ball.radius * ball.inverse_square < 1;
        if (cell.half > 0 ? ball.radius > most_of_half * cell.half : !is_point) {
            return Added::none_yet;
        }
        if (is_settled(sum)) return Added::together;
        const double most = ball.above * (s > 0 ? kernel_at(ball.kernel, s).hi : 1) * (1 + slack);
        sum.above += most;
        sum.magnitude += most;
        if (is_point) {
            sum.value += (ball.above - ball.below) *
                         midpoint(kernel_at(ball.kernel, at_center * ball.inverse_square));
        }
        return Added::together;
    }

    void add_element(std::uint32_t i, Cell& cell, Sum& sum) const {
        // q changes by no more than |p - p'| / w from p to p'; of a point more is known.
        constexpr double half_diagonal = 1.7320508075688774;  // of a cube, rounded up
        const double b = field_.strength[i], per_width = field_.inverse_width[i];
        const Vec3d from = (middle_ - field_.a(i)) + cell.center;
        double nearest = 0, farthest = 0, s = 0;
        if (!with_field_shape(field_.shape[i], []<class S>() { return S::has_axis; })) {
            for (std::size_t k = 0; k < 3; ++k) {
                const double off = std::abs(from[k]);
                const double beyond = std::max(off - cell.half, 0.0);
                nearest += beyond * beyond;
                s += off * off;
            }
            const double least = std::sqrt(nearest) - lost_;
            nearest = least > 0 ? least * per_width * (1 - slack) : 0;
            s *= per_width * per_width;
            if (b < 0) farthest = std::sqrt(s);
        } else {
            const double q = distance_in_widths(field_, i, from);
            const double least = q - (half_diagonal * cell.half + lost_) * per_width * (1 + slack);
            nearest = least > 0 ? least : 0;
            farthest = q;
            s = q * q;
        }
        const double near_s = nearest * nearest * (1 - slack);
        ++sum.count;
        if (near_s >= sum.far[static_cast<std::size_t>(field_.kernel[i])]) {
            leave_out(field_.kernel[i], sum, cell);
            return;
        }
        if (is_settled(sum)) {
            cell.elements.push_back(i);
            return;
        }
        const double largest = near_s > 0 ? kernel_at(field_.kernel[i], near_s).hi : 1;
        if (std::abs(b) * largest <= sum.least) {
            if (b > 0) cell.left_out += b * largest * (1 + slack);
            return;
        }
        cell.elements.push_back(i);
        farthest = (farthest + (half_diagonal * cell.half + lost_) * per_width) * (1 + 4 * slack);
        // What is not a number is out of the range of doubles: 0 is a bound of what carves. So it is of
        // one of several parts, each of which may be all that there is.
        const bool joins = is_joined(field_.shape[i]);
        const double far_s = farthest * farthest * (1 + slack);
        const double carved =
            !joins && far_s < infinity<double> ? b * kernel_at(field_.kernel[i], far_s).lo : 0;
        double bound = b > 0 ? b * largest : carved;
        double value = b * midpoint(kernel_at(field_.kernel[i], s));
        if (joins) sum.join(field_.source[i], bound, value);
        sum.above += bound;
        sum.magnitude += std::abs(bound);
        sum.value += value;
    }

    // What reaches farthest first.
    using Queue = std::priority_queue<std::pair<double, std::size_t>>;

    const Field& field_;
    const Frustum& frustum_;
    Vec3d middle_;
    Box3 box_;  // relative to the middle, as all else
    double radius_ = 0, root_half_ = 0;
    double lost_ = 0;       // what roundings cost a distance, at most
    bool carved_ = false;   // some strength is negative
    double strongest_ = 0;  // the greatest |b|, of elements, and of blocks all together
    std::vector<Cell> cells_;
    std::vector<Ball> blocks_;
    std::array<Queue, sides> queue_;
    Reach reach_{};   // no point of the solid is farther
    Reach seen_{};    // a point of the solid is about that far
    Reach planes_{};  // proved by planes alone
    std::size_t evaluations_ = 0;
};

}  // namespace

Frustum frustum_of(const View& view, double aspect, double share) {
    Frustum frustum{view.forward,   view.right, view.top, share * view.s * aspect,
                    share * view.s, {}};
    const Vec3d back = -1.0 * frustum.forward;
    frustum.normal = {frustum.right + frustum.half_width * back,
                      -1.0 * frustum.right + frustum.half_width * back,
                      frustum.top + frustum.half_height * back,
                      -1.0 * frustum.top + frustum.half_height * back,
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
    extent.radius = std::max(length(around.lo), length(around.hi)) * (1 + slack);
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
