#include "core/render/cell_bounds.h"

#include <algorithm>
#include <cmath>

#include "core/field/support.h"
#include "core/field/surface.h"
#include "core/math/direction.h"

namespace ivory {
namespace {

constexpr double slack = framing_slack;

// Elements are bounded together in cells whose half is no less than this part of their ball.
constexpr double most_of_half = 2;

// So many clusters that follow each other are a block: large cells look at blocks.
constexpr std::size_t block_size = 16;

}  // namespace

struct CellBounds::Sum {
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
    // Leaves out what is that far away.
    void leave_out(KernelKind kernel, Cell& cell) const {
        if (!kernel_ends(kernel)) cell.left_out += least;
    }

    bool has_parts = false;
    std::uint32_t source = 0;  // of what follows
    double parts_bound = 0, parts_value = 0;
};

CellBounds::CellBounds(const Field& field) : field_(field) {
    const Box3& box = field_.box;
    middle_ = 0.5 * box.lo + 0.5 * box.hi;
    double most = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        box_.lo[k] = sub_down(box.lo[k], middle_[k]);
        box_.hi[k] = add_up(box.hi[k], -middle_[k]);
        most = std::max({most, -box_.lo[k], box_.hi[k]});
    }
    radius_ = std::sqrt(3.0) * most * (1 + 16 * slack);
    int exponent = 0;
    std::frexp(most, &exponent);
    half_ = std::ldexp(1.0, exponent);

    Box3 all = field_.skeletons;
    all.include(box);
    lost_ = 16 * slack * (length_of(all.hi - middle_) + length_of(all.lo - middle_));

    if (!field_.clusters.empty()) make_blocks();
    for (const double b : field_.strength) {
        strongest_ = std::max(strongest_, std::abs(b));
        carved_ = carved_ || b < 0;
    }
    for (const Ball& block : blocks_) {
        strongest_ = std::max({strongest_, block.above, block.below});
    }
}

CellBounds::Cell CellBounds::whole() const {
    Cell cell;
    cell.half = half_;
    if (field_.clusters.empty()) {
        cell.elements = all_elements(field_).elements;
    } else {
        for (std::uint32_t n = 0; n < blocks_.size(); ++n) cell.blocks.push_back(n);
    }
    return cell;
}

CellBounds::Cell CellBounds::eighth(const Cell& cell, std::size_t number) {
    Cell child;
    child.half = 0.5 * cell.half;
    for (std::size_t k = 0; k < 3; ++k) {
        child.center[k] = cell.center[k] + ((number >> k & 1) != 0 ? child.half : -child.half);
    }
    return child;
}

CellBounds::Ball CellBounds::cluster(std::uint32_t n) const {
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
void CellBounds::make_blocks() {
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
                    std::max(block.radius, length_of(ball.center - block.center) + ball.radius);
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

// What the field can be in a cell, from the list of the one that it was cut out of.
void CellBounds::look(const Cell& parent, Cell& cell) {
    for (std::size_t k = 0; k < 3; ++k) {
        if (cell.center[k] + cell.half < box_.lo[k] || cell.center[k] - cell.half > box_.hi[k]) {
            cell.outside = true;
            return;
        }
    }
    Sum sum;
    sum.least = share_left_out * field_.threshold /
                static_cast<double>(
                    parent.elements.size() +
                    cluster_size * (parent.clusters.size() + block_size * parent.blocks.size()));
    sum.far = far_beyond(sum.least);
    sum.rough = !parent.blocks.empty() && cell.half > 0;
    cell.left_out = parent.left_out;
    const auto add_all = [&](const std::vector<std::uint32_t>& list, auto add) {
        for (const std::uint32_t n : list) {
            if (cell.half == 0 && is_settled(sum)) return;  // of a point no more is asked
            (this->*add)(n, cell, sum);
        }
    };
    add_all(parent.blocks, &CellBounds::add_block);
    add_all(parent.clusters, &CellBounds::add_cluster);
    add_all(parent.elements, &CellBounds::add_element);

    const double count = static_cast<double>(sum.count + 8);
    evaluations_ += sum.count;
    const double rounding = count * 0x1p-51 * (sum.magnitude + cell.left_out + field_.threshold);
    cell.outside = sum.above + cell.left_out + rounding < field_.threshold;
    cell.value = sum.value - field_.threshold;
}

CellBounds::Far CellBounds::far_beyond(double least) const {
    Far far;
    for_each_type(Kernels{}, [&]<class K>() {
        double& of_kernel = far[static_cast<std::size_t>(kind_of<K>)];
        if constexpr (K::ends) {
            of_kernel = 1;
        } else {
            const double s = K::level(std::log(strongest_ / least)) + 1e-6;
            const bool holds = s > 0 && s < K::vanishes && mul_up(strongest_, K::at(s).hi) <= least;
            of_kernel = holds ? s : infinity<double>;
        }
    });
    return far;
}
// Where nothing carves, the rest can neither lower the bound below T nor f at the centre: it is
// only listed.
bool CellBounds::is_settled(const Sum& sum) const {
    return !carved_ && sum.above >= field_.threshold && (sum.value > field_.threshold || sum.rough);
}

// The members of a ball that is no larger than the cell stand together; those of a larger one
// each for itself.
void CellBounds::add_block(std::uint32_t n, Cell& cell, Sum& sum) const {
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

void CellBounds::add_cluster(std::uint32_t n, Cell& cell, Sum& sum) const {
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

// The members add up to no more than above k(s) where s is the least in the cell.
CellBounds::Added CellBounds::add_ball(const Ball& ball, Cell& cell, Sum& sum) const {
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
        sum.leave_out(ball.kernel, cell);
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

void CellBounds::add_element(std::uint32_t i, Cell& cell, Sum& sum) const {
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
        sum.leave_out(field_.kernel[i], cell);
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

}  // namespace ivory
