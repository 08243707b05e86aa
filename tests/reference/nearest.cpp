#include "tests/reference/nearest.h"

#include <algorithm>
#include <cmath>

namespace ivory::reference {

namespace {

using Exact = RealInterval;
using Rough = OutwardDouble;

// Parts that a curve is cut into beforehand: near ones are told from far ones by their balls.
constexpr std::size_t curve_parts = 16;

// Places relative to the first one, in units of the width.
std::vector<Triple<Exact>> relative(const std::vector<Vec3d>& places, double width) {
    std::vector<Triple<Exact>> result;
    const Triple<Exact> origin = triple<Exact>(places.front());
    for (const Vec3d& place : places) {
        result.push_back(divided(minus(triple<Exact>(place), origin), Exact(width)));
    }
    return result;
}

Piece<Exact> piece(const Triple<Exact>& a, const Triple<Exact>& b) {
    Piece<Exact> result;
    result.a = a;
    result.m = minus(b, a);
    result.m2 = norm2(result.m);
    result.still = result.m2.hi.is_zero();
    result.ball = ball_around<Exact>(std::array{a, b}, 2);
    return result;
}

Chain<Exact> chain(const Element& element, const std::vector<Vec3d>& points) {
    const std::vector<Triple<Exact>> places = relative(points, element.width);
    Chain<Exact> result;
    for (std::size_t i = 0; i + 1 < places.size(); ++i) {
        Piece<Exact> one = piece(places[i], places[i + 1]);
        if (!element.widths.empty()) {
            const double w = element.widths[i], next = element.widths[i + 1];
            one.w = Exact(w) / Exact(element.width);
            one.dw = (Exact(next) - Exact(w)) / Exact(element.width);
            one.greatest_w = Exact(std::max(w, next)) / Exact(element.width);
            one.level = w == next;
        }
        result.pieces.push_back(one);
    }
    return result;
}

// N = sum of v_i x v_(i+1), the same from every origin. A vertex v is projected to v - (v.n) n.
Filled<Exact> filled(const Element& element, const std::vector<Vec3d>& vertices) {
    std::vector<Triple<Exact>> places = relative(vertices, element.width);
    Triple<Exact> newell;
    for (std::size_t i = 0; i < places.size(); ++i) {
        newell = plus(newell, outer(places[i], places[(i + 1) % places.size()]));
    }
    Filled<Exact> result;
    result.normal = divided(newell, sqrt(norm2(newell)));
    for (Triple<Exact>& place : places) {
        place = minus(place, times(result.normal, inner(place, result.normal)));
    }
    for (std::size_t i = 0; i < places.size(); ++i) {
        result.edges.pieces.push_back(piece(places[i], places[(i + 1) % places.size()]));
    }
    const Vec3d n{newell[0].lo.to_double(), newell[1].lo.to_double(), newell[2].lo.to_double()};
    std::size_t longest = 0;
    for (std::size_t k = 1; k < 3; ++k) {
        if (std::fabs(n[k]) > std::fabs(n[longest])) longest = k;
    }
    result.first = (longest + 1) % 3;
    result.second = (longest + 2) % 3;
    return result;
}

Arc<Exact> arc(const Element& element, const std::vector<Vec3d>& points) {
    const std::vector<Triple<Exact>> places = relative(points, element.width);
    Arc<Exact> result;
    result.degree = places.size() - 1;
    std::copy(places.begin(), places.end(), result.points.begin());
    // Powers of u from differences: C(n,k) times the k-th difference at the first point.
    std::array<Triple<Exact>, 4> difference = result.points;
    for (std::size_t k = 0; k <= result.degree; ++k) {
        result.powers[k] = times(difference[0], Exact(binomial(result.degree, k)));
        for (std::size_t i = 0; i + k < result.degree; ++i) {
            difference[i] = minus(difference[i + 1], difference[i]);
        }
    }
    for (std::size_t i = 0; i < curve_parts; ++i) {
        Bezier<Exact> part;
        part.from = static_cast<double>(i) / curve_parts;
        part.to = static_cast<double>(i + 1) / curve_parts;
        part.points = part_of(result.points, result.degree, Exact(part.from), Exact(part.to));
        part.ball = ball_around<Exact>(part.points, result.degree + 1);
        result.pieces.push_back(part);
    }
    return result;
}

std::array<Triple<Rough>, 4> in_doubles(const std::array<Triple<Exact>, 4>& points) {
    return {rough(points[0]), rough(points[1]), rough(points[2]), rough(points[3])};
}
Ball<Rough> in_doubles(const Ball<Exact>& ball) {
    // Doubles round the centre: by less than the radius grows.
    Ball<Rough> result;
    Rough off(0);
    for (std::size_t k = 0; k < 3; ++k) {
        const Rough center = rough(ball.center[k]);
        result.center[k] = middle_of(center);
        off = off + Rough(center.width());
    }
    result.radius = Rough((rough(ball.radius) + off).hi);
    return result;
}
Chain<Rough> in_doubles(const Chain<Exact>& chain) {
    Chain<Rough> result;
    for (const Piece<Exact>& piece : chain.pieces) {
        result.pieces.push_back({rough(piece.a), rough(piece.m), rough(piece.w), rough(piece.dw),
                                 rough(piece.m2), piece.still, piece.level, in_doubles(piece.ball),
                                 rough(piece.greatest_w)});
    }
    return result;
}
Filled<Rough> in_doubles(const Filled<Exact>& polygon) {
    return {rough(polygon.normal), in_doubles(polygon.edges), polygon.first, polygon.second};
}
Arc<Rough> in_doubles(const Arc<Exact>& arc) {
    Arc<Rough> result{arc.degree, in_doubles(arc.points), in_doubles(arc.powers), {}};
    for (const Bezier<Exact>& piece : arc.pieces) {
        result.pieces.push_back(
            {in_doubles(piece.points), piece.from, piece.to, in_doubles(piece.ball)});
    }
    return result;
}

template <class Made>
std::shared_ptr<const Bodies> both(const Made& exact) {
    return std::make_shared<const Bodies>(Bodies{exact, in_doubles(exact)});
}

}  // namespace

std::shared_ptr<const Bodies> bodies_of(const Element& element) {
    if (const auto* segment = std::get_if<Segment>(&element.skeleton)) {
        if (element.widths.empty()) return nullptr;
        return both(chain(element, {segment->a, segment->b}));
    }
    if (const auto* polyline = std::get_if<Polyline>(&element.skeleton)) {
        return both(chain(element, polyline->points));
    }
    if (const auto* polygon = std::get_if<Polygon>(&element.skeleton)) {
        return both(filled(element, polygon->vertices));
    }
    if (const auto* curve = std::get_if<Curve>(&element.skeleton)) {
        return both(arc(element, curve->control_points));
    }
    return nullptr;
}

}  // namespace ivory::reference
