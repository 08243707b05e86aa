// What the field can be in cubes of space, from lists that grow shorter from cube to cube: what the search
// for how far a solid reaches (core/render/extent.h) asks for.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/field/field.h"
#include "core/kernel/kernels.h"
#include "core/math/box3.h"
#include "core/math/vec3.h"

namespace ivory {

// More than what a few roundings of lengths can cost, relative to the largest of them.
inline constexpr double framing_slack = 0x1p-44;

// Cells of one field, whose box must be neither empty nor infinite. Places are relative to the middle of
// that box.
class CellBounds {
  public:
    // A cube and what matters in it. The elements, the members of clusters and blocks, and what was left
    // out stand for the whole field there: f <= the sum of the listed F_i + left_out - T.
    struct Cell {
        Vec3d center;
        double half = 0;
        std::vector<std::uint32_t> elements, clusters, blocks;
        double left_out = 0;
        double value = 0;  // f at the centre, about: only a reason to stop
        bool outside = false;
        std::size_t first_child = 0;  // 0: not cut
    };

    // Elements bounded together, as in core/field/clusters.h: a cluster, or a block of clusters.
    struct Ball {
        Vec3d center;
        double radius = 0, above = 0, below = 0, inverse_square = 0;
        KernelKind kernel = KernelKind::blinn;
        std::uint32_t first = 0, end = 0;  // elements of a cluster, clusters of a block
    };

    explicit CellBounds(const Field& field);

    [[nodiscard]] const Vec3d& middle() const { return middle_; }
    [[nodiscard]] const Box3& box() const { return box_; }
    // All of the box is that near to the middle.
    [[nodiscard]] double radius() const { return radius_; }
    // What roundings cost a distance, at most.
    [[nodiscard]] double lost() const { return lost_; }

    // Around the box; its half is a power of two, so that the middles of all that it is cut into are
    // doubles.
    [[nodiscard]] Cell whole() const;
    // The eighth with that number, 0 to 7.
    [[nodiscard]] static Cell eighth(const Cell& cell, std::size_t number);
    // Sets all but `center` and `half` of a cell, 0 for a point, that lies in `parent`.
    void look(const Cell& parent, Cell& cell);

    // An element whose |F| stays below this share of T, divided by how many are listed, is no longer
    // listed: what it can add is kept.
    static constexpr double share_left_out = 0x1p-9;

    // For each kernel an s at and beyond which |b| k(s) <= least certainly holds for every element and
    // cluster; a kernel that ends is 0 there.
    using Far = std::array<double, kernel_count>;
    [[nodiscard]] Far far_beyond(double least) const;

    [[nodiscard]] Ball cluster(std::uint32_t n) const;

    // Of single elements and clusters, until now.
    [[nodiscard]] std::size_t evaluations() const { return evaluations_; }

  private:
    struct Sum;
    enum class Added : std::uint8_t { nothing, together, none_yet };

    void make_blocks();
    [[nodiscard]] bool is_settled(const Sum& sum) const;
    void add_block(std::uint32_t n, Cell& cell, Sum& sum) const;
    void add_cluster(std::uint32_t n, Cell& cell, Sum& sum) const;
    [[nodiscard]] Added add_ball(const Ball& ball, Cell& cell, Sum& sum) const;
    void add_element(std::uint32_t i, Cell& cell, Sum& sum) const;

    const Field& field_;
    Vec3d middle_;
    Box3 box_;
    double radius_ = 0, half_ = 0, lost_ = 0;
    bool carved_ = false;   // some strength is negative
    double strongest_ = 0;  // the greatest |b|, of elements, and of blocks all together
    std::vector<Ball> blocks_;
    std::size_t evaluations_ = 0;
};

}  // namespace ivory
