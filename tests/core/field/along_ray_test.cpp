// s and s' of each shape along rays, against 256 bits, and what along_ray claims of whole spans.
#include "core/field/along_ray.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/trace/clip.h"
#include "tests/reference/along_ray.h"
#include "tests/reference/multiprecision.h"
#include "tests/tools/kinds.h"
#include "tests/tools/nasty_rays.h"
#include "tests/tools/parts.h"
#include "tests/tools/random_scene.h"
#include "tests/tools/seed.h"

namespace ivory {
namespace {

using reference::Germ;
using reference::Real;
using reference::RealInterval;
using tools::Random;
using tools::RayKind;

using ExactElement = reference::ElementAlongRay<RealInterval>;

bool meets(const Interval<double>& bounds, const RealInterval& exact) {
    return Real(bounds.lo) <= exact.hi && exact.lo <= Real(bounds.hi);
}

std::string text(const Interval<double>& a) {
    char line[96];
    std::snprintf(line, sizeof line, "[%.17g, %.17g]", a.lo, a.hi);
    return line;
}

// One element along one ray over a span, with what is exactly so.
struct View {
    ElementAlongRay along;
    ExactElement element;
    Interval<double> span;
    double cut;

    // s and s', to 256 bits.
    [[nodiscard]] Germ<RealInterval> exact(double t) const {
        return element.square(RealInterval(t));
    }
};

std::span<const Piece> pieces_of(const ElementAlongRay& e) {
    const auto* const squares = std::get_if<SquaresAlongRay>(&e.form);
    return squares != nullptr ? squares->all() : std::span<const Piece>();
}

// Calls check(form) for one that has no pieces; whether it is one.
template <class Check>
bool without_pieces(const ElementAlongRay& e, const Check& check) {
    return std::visit(
        [&]<class Form>(const Form& form) {
            constexpr bool is_whole = requires { form.at(0.0).s; };
            if constexpr (is_whole) check(form);
            return is_whole;
        },
        e.form);
}

// Places to look at: the ends, where pieces and the active part begin and end, the foot, others.
std::vector<double> places(const View& view, Random& random) {
    const ElementAlongRay& e = view.along;
    std::vector<double> t{view.span.lo, view.span.hi};
    const auto around = [&](double x) {
        const double off = std::exp(random.uniform(-36, -2)) * std::max(std::abs(x), 1e-3);
        for (const double y : {x, next_down(x), next_up(x), x - off, x + off}) t.push_back(y);
    };
    if (!is_empty(e.active)) {
        around(e.active.lo);
        around(e.active.hi);
    }
    for (const Piece& piece : pieces_of(e)) {
        around(piece.where.lo);
        around(piece.where.hi);
        around(piece.square.reference);
    }
    if (const auto* const circle = std::get_if<CircleAlongRay>(&e.form)) {
        around(circle->across.reference);
    }
    for (int i = 0; i < 8; ++i) t.push_back(random.uniform(view.span.lo, view.span.hi));
    std::erase_if(t, [&](double x) { return !(view.span.lo <= x && x <= view.span.hi); });
    std::sort(t.begin(), t.end());
    t.erase(std::unique(t.begin(), t.end()), t.end());
    return t;
}

bool has_others(const Field& field, std::size_t i) {
    return (i > 0 && field.source[i - 1] == field.source[i]) || field.joins_next(i);
}

// Calls check(view, random) for every element of scenes of one shape, one for each kernel, along
// nasty rays, over spans of many lengths that come near the element.
template <class Check>
void for_views(Shape shape, std::uint64_t own_seed, tools::SceneRecipe recipe, const Check& check) {
    int views = 0;
    std::uint64_t seed = tools::announced_seed(own_seed);
    for (const KernelKind kernel : tools::every_kernel) {
        recipe.only = {shape, kernel};
        const Scene scene = random_scene(recipe, ++seed);
        const Field field = compile(scene);
        Random random(seed);
        for (std::size_t kind = 0; kind < tools::ray_kind_words.size(); ++kind) {
            for (const Ray& own : nasty_rays(scene, static_cast<RayKind>(kind), 8, seed)) {
                const ScaledRay ray = scaled(own);
                Interval<double> span = clip(ray, field.reach_box);
                if (is_empty(span) || !(span.hi < 1e90)) continue;
                if (random.chance(0.5)) {  // a part of it
                    const double length = width(span) * std::exp(random.uniform(-12, 0));
                    span.lo = random.uniform(span.lo, span.hi - length);
                    span.hi = span.lo + length;
                }
                if (!(span.lo < span.hi)) continue;
                for (std::size_t i = 0; i < field.size(); ++i) {
                    // One of several parts with numbers is no element that doubles could name.
                    if (has_numbers(field.shape[i]) && has_others(field, i)) continue;
                    const double cut = random.chance(0.5) ? field.cut[i] : random.uniform(0, 4);
                    View view{
                        {},
                        {has_numbers(field.shape[i]) ? scene.elements[field.source[i]]
                                                     : tools::element_of_part(scene, field, i),
                         {ray.origin, ray.direction},
                         0},
                        span,
                        cut};
                    along_ray(field, i, ray.origin, ray.direction, span, cut, view.along);
                    SCOPED_TRACE(tools::word_of(kernel) + ", seed " + std::to_string(seed) + ", " +
                                 std::string(tools::ray_kind_words[kind]) + ", element " +
                                 std::to_string(i) + ", span " + text(span));
                    check(view, random);
                    if (testing::Test::HasFatalFailure()) return;
                    ++views;
                }
            }
        }
    }
    // Curves of one arc are few: for others see Inclusion.
    EXPECT_GT(views, shape == Shape::curve ? 10 : 300);
}

class AlongRayOf : public testing::TestWithParam<Shape> {};
INSTANTIATE_TEST_SUITE_P(Each, AlongRayOf, testing::ValuesIn(tools::every_shape),
                         tools::name_of_kind);

// What is enclosed at t is what some piece in force there says, or the whole.
void check_at(const View& view, double t) {
    const ElementAlongRay& e = view.along;
    const Germ<RealInterval> exact = view.exact(t);
    SCOPED_TRACE("t = " + std::to_string(t));
    const bool is_whole = without_pieces(e, [&](const auto& form) {
        const auto at = form.at(t);
        ASSERT_TRUE(meets(at.s, exact.value)) << text(at.s) << to_string(exact.value.lo);
        ASSERT_TRUE(meets(at.ds, exact.slope)) << text(at.ds) << to_string(exact.slope.lo);
    });
    if (is_whole) return;
    bool covered = false, held = false;
    for (const Piece& piece : pieces_of(e)) {
        if (!contains(piece.where, t)) continue;
        covered = true;
        const SquareAt at = piece.square.at(t);
        held = held || (meets(at.value(), exact.value) && meets(at.slope(), exact.slope));
        ASSERT_LE(piece.square.vertex, at.s + at.s_radius);
        ASSERT_LE(piece.square.least, at.s + at.s_radius);
    }
    ASSERT_TRUE(covered) << "no piece";
    ASSERT_TRUE(held) << to_string(exact.value.lo) << ' ' << to_string(exact.slope.lo);
}

TEST_P(AlongRayOf, SquareAndSlopeHoldTheExactOnesAndPiecesCoverTheSpan) {
    for (const double scale : {1.0, 1e-6, 1e6}) {
        for_views(GetParam(), 21, {.elements = 4, .scale = scale},
                  [](const View& view, Random& random) {
                      ASSERT_FALSE(std::holds_alternative<UnboundedAlongRay>(view.along.form));
                      for (const double t : places(view, random)) {
                          ASSERT_NO_FATAL_FAILURE(check_at(view, t));
                      }
                  });
    }
}

TEST_P(AlongRayOf, SquareAndSlopeHoldTheExactOnesFarFromTheOrigin) {
    for_views(GetParam(), 22, {.elements = 4, .shift = 1e6}, [](const View& view, Random& random) {
        for (const double t : places(view, random)) ASSERT_NO_FATAL_FAILURE(check_at(view, t));
    });
}

TEST_P(AlongRayOf, CutIsExceededOutsideOfTheActivePart) {
    for_views(GetParam(), 23, {.elements = 4}, [](const View& view, Random& random) {
        const Interval<double>& active = view.along.active;
        if (!is_empty(active)) {
            ASSERT_TRUE(is_subset(active, view.span)) << text(active);
        }
        for (const double t : places(view, random)) {
            if (contains(active, t)) continue;
            ASSERT_TRUE(view.exact(t).value.hi >= Real(view.cut))
                << "t = " << t << ", active " << text(active) << ", cut " << view.cut;
        }
    });
}

TEST_P(AlongRayOf, LeastIsBelowEverySquareOfTheSpan) {
    for_views(GetParam(), 24, {.elements = 4}, [](const View& view, Random& random) {
        for (const double t : places(view, random)) {
            const RealInterval s = view.exact(t).value;
            ASSERT_TRUE(s.hi >= Real(view.along.least))
                << "t = " << t << ", s = " << s.lo.to_double() << ", least " << view.along.least
                << ", cut " << view.cut << ", active " << text(view.along.active);
        }
    });
}

// v(t) = (t, 0, t - 15) and r = 10, so that s = (t - 10)^2 + (t - 15)^2: 17 at t = 11, where the
// ray leaves the cylinder outside of which s > cut is known, and least, 12.5, at t = 12.5.
TEST(AlongRay, LeastAndPeakHoldWhereTheRayComesNearerToACircleOutsideOfTheActivePart) {
    Scene scene;
    scene.elements = {{.skeleton = CircleSkeleton{{0, 0, 0}, {0, 0, 1}, 10}}};
    const Field field = compile(scene);
    ElementAlongRay e;
    along_ray(field, 0, {0, 0, -15}, {1, 0, 1}, {0.0, 20.0}, 1, e);
    const double s = std::get<CircleAlongRay>(e.form).at(12.5).s.hi;
    EXPECT_NEAR(s, 12.5, 1e-11);
    EXPECT_LE(e.least, s);
    EXPECT_GE(e.peak, std::exp(-s));
}

TEST_P(AlongRayOf, PeakIsAboveEveryValueOfTheSpanAndBeyondAboveThoseOutsideOfTheActivePart) {
    for_views(GetParam(), 25, {.elements = 4}, [](const View& view, Random& random) {
        const ElementAlongRay& e = view.along;
        for (const double t : places(view, random)) {
            const RealInterval k = reference::kernel_germ(e.kernel, view.exact(t).value).value;
            ASSERT_TRUE(k.lo <= Real(e.peak)) << "t = " << t << ", peak " << e.peak;
            if (contains(e.active, t)) continue;
            const RealInterval f = RealInterval(e.strength) * k;
            ASSERT_TRUE(meets(e.beyond, f))
                << "t = " << t << ", F = " << f.lo.to_double() << ", beyond " << text(e.beyond);
        }
    });
}

// Without a kink in between, s' gains between inf s'' and sup s'' times the time.
TEST_P(AlongRayOf, RangesOverAWindowHoldWhatTheEndsAndTheInsideAre) {
    for_views(GetParam(), 26, {.elements = 4}, [](const View& view, Random& random) {
        const ElementAlongRay& e = view.along;
        for (int window = 0; window < 3; ++window) {
            const double length = width(view.span) * std::exp(random.uniform(-14, 0));
            const double t0 = random.uniform(view.span.lo, view.span.hi - length);
            const double t1 = std::min(t0 + length, view.span.hi);
            if (!(t0 < t1)) continue;
            std::vector<double> t{t0, t1};
            for (int i = 0; i < 3; ++i) t.push_back(std::min(random.uniform(t0, t1), t1));
            std::sort(t.begin(), t.end());
            SCOPED_TRACE(text({t0, t1}));
            Interval<double> s = Interval<double>::empty_set(), ds = s, dds = s;
            without_pieces(e, [&](const auto& form) {
                const SquareRange range = form.over(t0, t1, form.at(t0), form.at(t1));
                s = range.s, ds = range.ds, dds = range.dds;
            });
            for (const Piece& piece : pieces_of(e)) {
                const double from = std::max(t0, piece.where.lo);
                const double to = std::min(t1, piece.where.hi);
                if (!(from <= to)) continue;
                const SquareAt a = piece.square.at(from), b = piece.square.at(to);
                s = hull(s, piece.square.over(a, b));
                ds = hull(ds, Interval<double>(a.slope().lo, b.slope().hi));
                dds = hull(dds, piece.square.curvature());
            }
            std::vector<Germ<RealInterval>> exact;
            for (const double x : t) exact.push_back(view.exact(x));
            for (std::size_t i = 0; i < t.size(); ++i) {
                ASSERT_TRUE(meets(s, exact[i].value)) << "s at " << t[i] << ' ' << text(s);
                ASSERT_TRUE(meets(ds, exact[i].slope)) << "s' at " << t[i] << ' ' << text(ds);
                if (i == 0 || t[i] == t[i - 1]) continue;
                const RealInterval time = RealInterval(t[i]) - RealInterval(t[i - 1]);
                const RealInterval mean = (exact[i].slope - exact[i - 1].slope) / time;
                ASSERT_TRUE(meets(dds, mean)) << "s'' at " << t[i] << ' ' << text(dds) << ' '
                                              << to_string(mean.lo) << to_string(mean.hi);
            }
        }
    });
}

TEST_P(AlongRayOf, EnclosuresAreAFewUnitsWide) {
    for_views(GetParam(), 27, {.elements = 4}, [](const View& view, Random& random) {
        for (const double t : places(view, random)) {
            const double s = view.exact(t).value.lo.to_double();
            if (s > 100) continue;
            const ElementAlongRay& e = view.along;
            if (const auto* const circle = std::get_if<CircleAlongRay>(&e.form)) {
                // The distance errs by units of the sizes of circle and offset.
                const double size = s + circle->radius.hi * circle->radius.hi + 1;
                EXPECT_LE(width(circle->at(t).s), 1e-12 * size) << s;
            }
            if (const auto* const taper = std::get_if<TaperAlongRay>(&e.form)) {
                EXPECT_LE(width(taper->at(t).s), 1e-11 * (s + 1)) << s;
            }
            for (const Piece& piece : pieces_of(e)) {
                if (!contains(piece.where, t)) continue;
                const MovingSquare& square = piece.square;
                const double reach = square.rho + square.kappa * std::abs(t - square.reference);
                EXPECT_LE(square.at(t).s_radius, 1e-13 * (reach * reach + 1)) << s;
            }
        }
    });
}

TEST(AlongRay, NumbersBeyondTheLemmaGiveTheFormThatClaimsNothing) {
    Scene scene;
    scene.elements = {{.skeleton = PointSkeleton{{0, 0, 0}}, .width = 1e-120}};
    const Field field = compile(scene);
    ElementAlongRay e;
    along_ray(field, 0, {0, 0, -5}, {0, 0, 1}, {0.0, 10.0}, 1, e);
    EXPECT_TRUE(std::holds_alternative<UnboundedAlongRay>(e.form));
    EXPECT_EQ(e.active, Interval<double>::entire());
    EXPECT_EQ(e.least, 0);
    EXPECT_EQ(e.peak, 1);
}

}  // namespace
}  // namespace ivory
