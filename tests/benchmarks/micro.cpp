// What the tracer is made of, one operation at a time, by Google Benchmark: intervals, exp, kernels,
// inclusion functions by shape, kernel and number of elements. Arguments vary from call to call, so
// that no branch is learnt by heart. `time` is that of one operation.
#include <array>
#include <cstddef>
#include <string>

#include <benchmark/benchmark.h>

#include "core/field/inclusion.h"
#include "core/field/surface.h"
#include "core/interval/exp.h"
#include "core/interval/interval.h"
#include "core/interval/quick.h"
#include "core/trace/clip.h"
#include "core/trace/methods/affine_form.h"
#include "core/trace/methods/natural_numbers.h"
#include "core/trace/trace.h"
#include "tests/tools/random_scene.h"

namespace ivory {
namespace {

constexpr std::size_t count = 1024;

std::array<Interval<double>, count> intervals(double lo, double hi, std::uint64_t seed) {
    tools::Random random(seed);
    std::array<Interval<double>, count> all;
    for (Interval<double>& x : all) {
        const double a = random.uniform(lo, hi), b = random.uniform(lo, hi);
        x = {std::min(a, b), std::max(a, b)};
    }
    return all;
}

// One operation on intervals of both signs.
template <class Operation>
void binary(benchmark::State& state, Operation operation) {
    const auto a = intervals(-2, 2, 1), b = intervals(-2, 2, 2);
    std::size_t i = 0;
    for (auto _ : state) {
        i = (i + 1) % count;
        benchmark::DoNotOptimize(operation(a[i], b[i]));
    }
}

template <class Operation>
void unary(benchmark::State& state, Operation operation, double lo, double hi) {
    const auto a = intervals(lo, hi, 3);
    std::size_t i = 0;
    for (auto _ : state) {
        i = (i + 1) % count;
        benchmark::DoNotOptimize(operation(a[i]));
    }
}

// Elements of one shape and kernel within the unit ball, and rays past them.
struct Subject {
    Field field;
    ElementList list;
    std::array<ScaledRay, 64> rays;
    std::array<FieldAlongRay, 64> along;
    std::array<natural::RayField, 64> natural;
    static constexpr double near = 2, far = 6;
};

Subject subject(Shape shape, KernelKind kernel, std::size_t elements) {
    tools::Random random(5);
    Scene scene;
    scene.threshold = 0.5;
    for (std::size_t n = 0; n < elements; ++n) {
        Element element;
        const Vec3d a = random.in_cube(1);
        const Vec3d b = random.in_cube(1);
        if (shape == Shape::point) element.skeleton = PointSkeleton{a};
        if (shape == Shape::segment) element.skeleton = SegmentSkeleton{a, b};
        if (shape == Shape::circle) element.skeleton = CircleSkeleton{a, b, 0.5};
        element.kernel = kernel;
        scene.elements.push_back(element);
    }
    Subject s;
    s.field = compile(scene);
    s.list = all_elements(s.field);
    for (std::size_t n = 0; n < s.rays.size(); ++n) {
        const Ray ray{{random.uniform(-1, 1), random.uniform(-1, 1), -4},
                      {random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), 1}};
        s.rays[n] = scaled(ray);
        s.along[n].build(s.field, s.list, s.rays[n].origin, s.rays[n].direction,
                         {Subject::near, Subject::far});
        s.natural[n].build(s.field, s.list, ray, s.rays[n]);
    }
    return s;
}

// A window of a tenth of a width at a random place, on ray after ray.
template <class Evaluate>
void over_windows(benchmark::State& state, Shape shape, KernelKind kernel, Evaluate evaluate) {
    const auto elements = static_cast<std::size_t>(state.range(0));
    const Subject s = subject(shape, kernel, elements);
    tools::Random random(6);
    std::array<double, count> starts;
    for (double& t : starts) t = random.uniform(Subject::near, Subject::far - 0.1);
    std::size_t i = 0;
    for (auto _ : state) {
        i = (i + 1) % count;
        benchmark::DoNotOptimize(evaluate(s, i % s.rays.size(), starts[i]));
    }
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(elements));
}

const char* word(Shape shape) {
    return shape == Shape::point ? "point" : shape == Shape::segment ? "segment" : "circle";
}

void register_all() {
    using I = Interval<double>;
    benchmark::RegisterBenchmark(
        "interval/add", [](auto& s) { binary(s, [](const I& a, const I& b) { return a + b; }); });
    benchmark::RegisterBenchmark(
        "interval/mul", [](auto& s) { binary(s, [](const I& a, const I& b) { return a * b; }); });
    benchmark::RegisterBenchmark(
        "interval/div", [](auto& s) { binary(s, [](const I& a, const I& b) { return a / b; }); });
    benchmark::RegisterBenchmark("interval/sqr", [](auto& s) {
        unary(
            s, [](const I& a) { return sqr(a); }, -2, 2);
    });
    benchmark::RegisterBenchmark("interval/sqrt", [](auto& s) {
        unary(
            s, [](const I& a) { return sqrt(a); }, 0, 2);
    });
    benchmark::RegisterBenchmark("quick/add", [](auto& s) {
        binary(s, [](const I& a, const I& b) { return quick::add(a, b); });
    });
    benchmark::RegisterBenchmark("quick/mul", [](auto& s) {
        binary(s, [](const I& a, const I& b) { return quick::mul(a, b); });
    });
    benchmark::RegisterBenchmark("quick/sqr", [](auto& s) {
        unary(
            s, [](const I& a) { return quick::sqr(a); }, -2, 2);
    });
    benchmark::RegisterBenchmark("exp/interval", [](auto& s) {
        unary(
            s, [](const I& a) { return exp(a); }, -20, 0);
    });
    benchmark::RegisterBenchmark("exp/minus", [](auto& s) {
        unary(
            s, [](const I& a) { return exp_minus(-a.lo, 1e-12); }, -20, 0);
    });
    benchmark::RegisterBenchmark("exp/nearest", [](auto& s) {
        unary(
            s, [](const I& a) { return exp_nearest(a.lo); }, -20, 0);
    });
    benchmark::RegisterBenchmark("exp/c_library", [](auto& s) {
        unary(
            s, [](const I& a) { return std::exp(a.lo); }, -20, 0);
    });
    for (const KernelKind kernel : {KernelKind::blinn, KernelKind::nishimura, KernelKind::wyvill}) {
        benchmark::RegisterBenchmark(
            ("kernel/" + std::string(kernel_word(kernel))).c_str(), [kernel](auto& s) {
                unary(
                    s, [&](const I& a) { return kernel_range(kernel, a); }, 0, 1.2);
            });
        for (const Shape shape : {Shape::point, Shape::segment, Shape::circle}) {
            const std::string name = std::string("/") + word(shape) + "/" + kernel_word(kernel);
            const auto add = [&](const std::string& what, auto evaluate) {
                benchmark::RegisterBenchmark(
                    (what + name).c_str(),
                    [=](auto& s) { over_windows(s, shape, kernel, evaluate); })
                    ->Arg(1)
                    ->Arg(16);
            };
            add("inclusion", [](const Subject& s, std::size_t n, double t) {
                return s.along[n].over(t, t + 0.1);
            });
            add("at", [](const Subject& s, std::size_t n, double t) { return s.along[n].at(t); });
            add("natural", [](const Subject& s, std::size_t n, double t) {
                return natural::extension(s.natural[n], natural::Range{{t, t + 0.1}});
            });
            add("natural_with_slope", [](const Subject& s, std::size_t n, double t) {
                return natural::extension(s.natural[n], natural::Dual{{t, t + 0.1}, 1.0});
            });
            add("affine", [](const Subject& s, std::size_t n, double t) {
                return natural::extension(s.natural[n], natural::affine_over({t, t + 0.1}));
            });
            add("plain", [](const Subject& s, std::size_t n, double t) {
                return natural::extension(s.natural[n], natural::Plain{t});
            });
            add("surface", [](const Subject& s, std::size_t n, double t) {
                return sample(s.field, s.list, s.rays[n].origin, s.rays[n].direction, t);
            });
            add("build", [](const Subject& s, std::size_t n, double t) {
                static FieldAlongRay along;
                along.build(s.field, s.list, s.rays[n].origin, s.rays[n].direction,
                            {t, Subject::far});
                return along.size();
            });
        }
    }
    for (const Method* method : methods()) {
        benchmark::RegisterBenchmark(
            ("ray/" + std::string(method->name())).c_str(), [method](benchmark::State& state) {
                const Subject s = subject(Shape::point, KernelKind::blinn, 4);
                std::size_t i = 0;
                Counts counts;
                for (auto _ : state) {
                    i = (i + 1) % s.rays.size();
                    const Ray ray{s.rays[i].origin, s.rays[i].direction};
                    benchmark::DoNotOptimize(
                        trace(s.field, s.list, ray, *method, {.tolerance = 1e-6}, counts));
                }
                state.counters["evaluations"] = benchmark::Counter(
                    static_cast<double>(counts.evaluations), benchmark::Counter::kAvgIterations);
            });
    }
}

}  // namespace
}  // namespace ivory

int main(int argc, char** argv) {
    ivory::register_all();
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
    return 0;
}
