#include "core/field/bounding_box.h"

#include <algorithm>
#include <cmath>

namespace ivory {
namespace {

constexpr double u = unit_roundoff;

// b k(s) n < T certainly holds.
bool certainly_low(const Field& field, std::size_t i, double s, double positive) {
    return mul_up(mul_up(kernel_at(field.kernel[i], s).hi, field.strength[i]), positive) <
           field.threshold;
}

double gap(double lo, double hi, double other_lo, double other_hi) {
    return std::fmax(0.0, std::fmax(other_lo - hi, lo - other_hi));
}

// A lower bound of the distance between two boxes, in units of `width`.
double box_distance(const Box3& a, const Box3& b, double width) {
    double square = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const double g = gap(a.lo[k], a.hi[k], b.lo[k], b.hi[k]) / width;
        square += g * g;
    }
    return std::sqrt(square) * (1 - 16 * u);
}

// An upper bound of f over a box: every positive element at its least distance, estimated by that
// of its skeleton's box; the negative ones carve nothing.
bool certainly_outside(const Field& field, const std::vector<Box3>& skeletons, const Box3& box) {
    double sum = 0, of_parts = 0;  // the greatest of those of one element
    for (std::size_t i = 0; i < field.size(); ++i) {
        if (field.strength[i] < 0) continue;
        const double q = box_distance(skeletons[i], box, field.greatest_width_of(i));
        of_parts = std::max(of_parts,
                            field.strength[i] * kernel_at(field.kernel[i], q * q * (1 - 4 * u)).hi);
        if (field.joins_next(i)) continue;
        sum += of_parts;
        of_parts = 0;
        if (sum >= field.threshold) return false;
    }
    return sum * (1 + (static_cast<double>(field.size()) + 4) * 2 * u) < field.threshold;
}

}  // namespace

std::size_t count_positive(const Field& field) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < field.size(); ++i) {
        count += field.strength[i] > 0 && !field.joins_next(i);
    }
    return count;
}

namespace {

// An s at and beyond which b k(s) n < T certainly holds; below 0 where it does everywhere.
double level(const Field& field, std::size_t i, std::size_t positive) {
    const double n = static_cast<double>(positive);
    if (field.strength[i] < 0 || certainly_low(field, i, 0, n)) return -1;
    // The least s found for which the field is certainly low: kernels that never end have a closed
    // form, to be confirmed; the others end at 1 and are halved towards their level.
    double s = 1;
    return with_kernel(field.kernel[i], [&]<class K>() {
        if constexpr (K::ends) {
            double lo = 0;
            for (int step = 0; step < 60; ++step) {
                const double middle = 0.5 * (lo + s);
                (certainly_low(field, i, middle, n) ? s : lo) = middle;
            }
        } else {
            s = std::fmax(
                K::level(std::log(n) + std::log(field.strength[i]) - std::log(field.threshold)),
                0.0);
            for (double pad = 0x1p-48; !certainly_low(field, i, s, n); pad *= 2) {
                // k(s) is below all doubles, and yet too much: no ball that doubles can tell.
                if (s > K::vanishes) return infinity<double>;
                s = s * (1 + pad) + pad;
            }
        }
        return s;
    });
}

double radius_at(double level, double width) {
    return next_up(std::sqrt(level) * width * (1 + 8 * u));
}

}  // namespace

double reach(const Field& field, std::size_t i, std::size_t positive) {
    const double s = level(field, i, positive);
    return s < 0 ? -1 : radius_at(s, field.greatest_width_of(i));
}

Box3 skeleton_box(const Field& field, std::size_t i) {
    return with_field_shape(field.shape[i], [&]<class S>() { return S::box(field.columns(i)); });
}

namespace {

// The box holds all places within `radius` of the skeleton, certainly: quick, since rounding is
// covered by far more than it can cost.
bool certainly_holds(const Box3& box, const Field& field, std::size_t i, double radius) {
    const Surroundings around = with_field_shape(
        field.shape[i], [&]<class S>() { return S::surroundings(field.columns(i)); });
    const double most = radius + around.radius;
    for (std::size_t k = 0; k < 3; ++k) {
        const double lo = around.box.lo[k], hi = around.box.hi[k];
        const double slack = 1e-12 * (std::abs(lo) + std::abs(hi) + most);
        if (!(lo - most - slack >= box.lo[k] && hi + most + slack <= box.hi[k])) return false;
    }
    return true;
}

}  // namespace

Box3 box_of_reach(const Field& field) {
    const std::size_t positive = count_positive(field);
    Box3 box;
    for (std::size_t group = 0; group < field_groups; ++group) {
        const auto [first, end] = field.first.of(group);
        if (first == end) continue;
        const auto strengths = field.strength.begin();
        const auto strongest = static_cast<std::size_t>(
            std::max_element(strengths + static_cast<std::ptrdiff_t>(first),
                             strengths + static_cast<std::ptrdiff_t>(end)) -
            strengths);
        const double highest = level(field, strongest, positive);
        if (highest < 0) continue;
        const double widths = radius_at(highest, 1);
        for (std::size_t i = first; i < end; ++i) {
            // What the strongest would reach from here is in the box already: most are so inside.
            if (certainly_holds(box, field, i, widths * field.greatest_width_of(i))) continue;
            const double radius = reach(field, i, positive);
            if (radius < 0) continue;
            Box3 ball = skeleton_box(field, i);
            for (std::size_t k = 0; k < 3; ++k) {
                ball.lo[k] = sub_down(ball.lo[k], radius);
                ball.hi[k] = add_up(ball.hi[k], radius);
            }
            box.include(ball);
        }
    }
    return box;
}

Box3 shrunk_box(const Field& field, const Box3& box) {
    if (box.empty() || field.size() > 512) return box;
    std::vector<Box3> skeletons;
    for (std::size_t i = 0; i < field.size(); ++i) skeletons.push_back(skeleton_box(field, i));

    Box3 rest = box;
    // A slab is cut into cells across the face, since one box over the whole face would be near
    // everything.
    constexpr int cells = 6;
    const auto slab_is_outside = [&](std::size_t axis, double from, double to) {
        const std::size_t j = (axis + 1) % 3, k = (axis + 2) % 3;
        for (int cell = 0; cell < cells * cells; ++cell) {
            const auto edge = [&](std::size_t along, int n) {
                return n == cells ? rest.hi[along]
                                  : rest.lo[along] + (rest.hi[along] - rest.lo[along]) * n / cells;
            };
            Box3 piece;
            piece.lo[axis] = from;
            piece.hi[axis] = to;
            piece.lo[j] = edge(j, cell % cells);
            piece.hi[j] = edge(j, cell % cells + 1);
            piece.lo[k] = edge(k, cell / cells);
            piece.hi[k] = edge(k, cell / cells + 1);
            if (!certainly_outside(field, skeletons, piece)) return false;
        }
        return true;
    };
    for (int face = 0; face < 6; ++face) {
        const std::size_t axis = static_cast<std::size_t>(face / 2);
        double step = (rest.hi[axis] - rest.lo[axis]) / 8;
        const double finest = step / 8;
        while (step >= finest && step > 0) {
            const bool from_below = face % 2 == 0;
            const double edge = from_below ? rest.lo[axis] + step : rest.hi[axis] - step;
            if (!(rest.lo[axis] < edge && edge < rest.hi[axis])) break;
            if (from_below ? slab_is_outside(axis, rest.lo[axis], edge)
                           : slab_is_outside(axis, edge, rest.hi[axis])) {
                (from_below ? rest.lo[axis] : rest.hi[axis]) = edge;
            } else {
                step /= 2;
            }
        }
    }
    return rest;
}

}  // namespace ivory
