#include "tests/tools/degenerate_scenes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <utility>
#include <variant>

#include "tests/tools/random_scene.h"

namespace ivory::tools {

namespace {

using reference::Curve;
using reference::Disc;
using reference::Kernel;
using reference::Point;
using reference::Polygon;
using reference::Polyline;
using reference::Segment;

Vec3d plus(const Vec3d& a, double x, const Vec3d& b) {
    return {a.x + x * b.x, a.y + x * b.y, a.z + x * b.z};
}
Vec3d times(double x, const Vec3d& v) { return {x * v.x, x * v.y, x * v.z}; }
Vec3d from_to(const Vec3d& a, const Vec3d& b) { return {b.x - a.x, b.y - a.y, b.z - a.z}; }
Vec3d outer(const Vec3d& a, const Vec3d& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
double length(const Vec3d& v) { return std::hypot(v.x, v.y, v.z); }

double in_steps(double x) { return std::round(x * 32) / 32; }

// q at which a kernel of strength b is T, by bisection.
double level(Kernel kernel, double ratio) {
    const auto k = [&](double q) {
        const double s = q * q;
        if (kernel == Kernel::blinn) return std::exp(-s);
        if (q >= 1) return 0.0;
        if (kernel == Kernel::murakami) return (1 - s) * (1 - s);
        if (kernel == Kernel::blobtree) return (1 - s) * (1 - s) * (1 - s);
        if (kernel == Kernel::wyvill) return (1 - s) * (1 - s) * (1 - 4.0 / 9 * s);
        return 3 * q < 1 ? 1 - 3 * s : 1.5 * (1 - q) * (1 - q);
    };
    double lo = 0, hi = 4;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (lo + hi);
        (k(middle) > ratio ? lo : hi) = middle;
    }
    return lo;
}

class Maker {
  public:
    Maker(Family family, std::uint64_t seed) : family_(family), random_(seed * 18 + index()) {
        threshold_ = random_.uniform(0.1, 0.6);
        subject_.kernel = static_cast<Kernel>(seed % 5);
        subject_.strength = random_.uniform(0.8, 1.5) * (seed / 5 % 2 == 0 ? 1 : -1);
        subject_.width = std::exp(random_.uniform(std::log(0.4), std::log(1.4)));
        choose_frame(seed % 3 == 0);
    }

    DegenerateCase make() {
        place_shape();
        DegenerateCase result;
        result.scene.threshold = threshold_;
        subject_.color = {0.9, 0.4, 0.1};
        result.scene.elements.push_back(subject_);
        if (subject_.strength < 0 || random_.chance(0.4)) {
            reference::Element other;
            other.skeleton = Point{plus(center_, 0.25, n_)};
            other.kernel = static_cast<Kernel>(random_.below(5));
            other.width = random_.uniform(1.5, 3);
            other.strength = subject_.strength < 0 ? random_.uniform(1, 1.6) : -0.5;
            other.color = {0.2, 0.3, 0.8};
            result.scene.elements.push_back(other);
        }
        result.rays = std::move(rays_);
        return result;
    }

  private:
    [[nodiscard]] std::uint64_t index() const { return static_cast<std::uint64_t>(family_); }

    // e and f span a plane, n = e x f, all of small whole numbers.
    void choose_frame(bool along_axes) {
        if (along_axes) {
            const std::size_t k = random_.below(3);
            e_ = f_ = {0, 0, 0};
            e_[k] = random_.sign();
            f_[(k + 1) % 3] = random_.sign();
        } else {
            do {
                e_ = whole();
                f_ = whole();
                n_ = outer(e_, f_);
            } while (n_ == Vec3d{0, 0, 0});
            e_ = times(0.5, e_);
            f_ = times(0.5, f_);
        }
        n_ = outer(e_, f_);
        center_ = random_.chance(0.3) ? Vec3d{0, 0, 0} : whole();
    }
    Vec3d whole() {
        const auto one = [&] { return double(random_.below(5)) - 2; };
        const double x = one(), y = one();
        return {x, y, one()};
    }

    [[nodiscard]] Vec3d at(double x, double y, double z = 0) const {
        return plus(plus(plus(center_, x, e_), y, f_), z, n_);
    }
    double some(double lo, double hi) { return in_steps(random_.uniform(lo, hi)); }

    void add(const Vec3d& o, const Vec3d& d) {
        if (!(d == Vec3d{0, 0, 0})) rays_.push_back({o, d});
    }
    // Through p along d: from before, from p itself, from behind; and beside by little.
    void line(const Vec3d& p, const Vec3d& d) {
        const double back = std::ceil(10 / length(d));
        const Vec3d o = plus(p, -back, d);
        add(o, d);
        add(plus(p, back, d), times(-1, d));
        add(p, d);
        Vec3d side = outer(d, random_.in_cube(1));
        side = times(1 / length(side), side);
        for (const double off : {1e-3, 1e-8, 1e-14}) {
            add(plus(o, off, side), d);
            add(o, plus(d, off * length(d), side));
        }
    }
    Vec3d some_direction() {
        const Vec3d d = whole();
        return d == Vec3d{0, 0, 0} ? n_ : d;
    }

    void place_shape() {
        switch (family_) {
            case Family::curve_in_plane:
            case Family::curve_cusp:
            case Family::curve_loop:
            case Family::curve_collinear:
            case Family::curve_point:
                return curve();
            case Family::polygon_edge_on:
            case Family::polygon_plane:
            case Family::polygon_vertex:
            case Family::polygon_edge:
                return polygon();
            case Family::taper_axis:
            case Family::taper_line:
            case Family::taper_apex:
            case Family::taper_swallow:
                return taper();
            case Family::coincident:
                return coincident();
            case Family::disc_edge_on:
            case Family::disc_axis:
            case Family::disc_rim:
            case Family::disc_plane:
                return disc();
        }
    }

    void curve() {
        const double x = some(0.5, 1.5), y = some(0.5, 1.5);
        const bool cubic = random_.chance(0.6);
        Curve shape;
        if (family_ == Family::curve_in_plane) {
            for (int i = 0; i < (cubic ? 4 : 3); ++i) {
                shape.control_points.push_back(at(some(-2, 2), some(-2, 2)));
            }
            for (int i = 0; i < 3; ++i) {
                line(at(some(-1, 1), some(-1, 1)), plus(times(some(-1, 1), e_), some(0.5, 1), f_));
            }
            line(shape.control_points[0],
                 from_to(shape.control_points[0], shape.control_points[1]));
        } else if (family_ == Family::curve_cusp) {
            // At u = 1/2, in the middle between first and last at -y/2 f, along f.
            shape.control_points = {at(-x, y), at(x, -y), at(-x, -y), at(x, y)};
            const Vec3d cusp = at(0, -0.5 * y);
            for (const Vec3d& d : {e_, f_, n_, some_direction()}) line(cusp, d);
        } else if (family_ == Family::curve_loop) {
            // Meets itself on the middle line.
            shape.control_points = {at(-x, -y), at(2 * x, y), at(-2 * x, y), at(x, -y)};
            // x(u) = 0 for 1 - 2u = 0 and u (1 - u) = 1/7.
            const Vec3d knot = at(0, -y + 6 * y / 7);
            for (const Vec3d& d : {e_, f_, n_, some_direction()}) line(knot, d);
        } else if (family_ == Family::curve_collinear) {
            for (int i = 0; i < (cubic ? 4 : 3); ++i) {
                shape.control_points.push_back(at(some(-2, 2), 0));
            }
            if (random_.chance(0.5)) shape.control_points.back() = shape.control_points.front();
            line(at(0, 0), e_);
            line(shape.control_points[1], f_);
            line(shape.control_points[0], some_direction());
        } else {
            shape.control_points.assign(cubic ? 4 : 3, center_);
            for (const Vec3d& d : {e_, f_, n_, some_direction()}) line(center_, d);
            line(plus(center_, 0.25, n_), e_);
        }
        subject_.skeleton = shape;
    }

    void polygon() {
        // Stars, simple and mostly not convex.
        const std::size_t count = 3 + random_.below(5);
        Polygon shape;
        for (std::size_t i = 0; i < count; ++i) {
            const double angle = 2 * 3.14159265358979 * double(i) / double(count);
            const double r = random_.uniform(0.5, 1.7);
            shape.vertices.push_back(
                at(in_steps(r * std::cos(angle)), in_steps(r * std::sin(angle))));
        }
        if (random_.chance(0.5)) std::reverse(shape.vertices.begin(), shape.vertices.end());
        const auto& v = shape.vertices;
        const auto in_plane = [&] { return plus(times(some(-1, 1), e_), some(0.5, 1), f_); };
        if (family_ == Family::polygon_edge_on) {
            const double unit = 1 / length(n_);
            for (const double h : {0.0, 1e-14, 1e-8, 1e-3, 0.25, 0.5}) {
                const Vec3d d = in_plane();
                const double back = std::ceil(10 / length(d));
                add(plus(plus(at(some(-1, 1), some(-1, 1)), h * unit, n_), -back, d), d);
                add(plus(at(some(-2, 2), some(-2, 2)), -h * unit, n_), d);
            }
        } else if (family_ == Family::polygon_plane) {
            for (int i = 0; i < 4; ++i) line(at(some(-1, 1), some(-1, 1)), in_plane());
            line(at(0, 0), n_);
        } else if (family_ == Family::polygon_vertex) {
            for (const Vec3d& vertex : v) line(vertex, random_.chance(0.5) ? n_ : some_direction());
            line(v[0], from_to(v[0], v[2]));
        } else {
            for (std::size_t i = 0; i < 3; ++i) {
                const Vec3d edge = from_to(v[i], v[(i + 1) % count]);
                line(v[i], edge);
                line(plus(v[i], 0.5, edge), n_);
                line(plus(plus(v[i], 0.5, edge), 0.125, n_), edge);
            }
        }
        subject_.skeleton = shape;
    }

    void taper() {
        const double half = some(0.5, 1.5);
        const Vec3d a = at(-half, 0), b = at(half, 0), m = from_to(a, b);
        double thin = some(0.25, 0.75), thick = thin + some(0.1, 1) * length(m);
        if (family_ == Family::taper_swallow) {
            // The balls of radius q w at the ends, here for q = 1, touch from inside.
            const double off[] = {0, 1e-14, -1e-14, 1e-8, -1e-8, 1e-3, -1e-3, 0.5};
            thick = thin + length(m) * (1 + off[random_.below(8)]);
        }
        const double steps = (thick - thin) / length(m);
        subject_.skeleton = Segment{a, b};
        subject_.widths = {thin, thick};
        const Vec3d apex = plus(a, -thin / (thick - thin), m);
        const Vec3d across = times(1 / length(f_), outer(n_, e_));
        const Vec3d up = times(1 / length(across), across);
        if (family_ == Family::taper_axis || family_ == Family::taper_swallow) {
            line(a, m);
            line(b, e_);
            line(plus(a, 0.5, m), f_);
            line(a, n_);
            line(apex, some_direction());
        } else if (family_ == Family::taper_apex) {
            for (const Vec3d& d : {m, f_, n_, some_direction()}) line(apex, d);
            line(apex, from_to(apex, plus(b, 0.5 * thick, up)));
        } else {
            const double q = level(subject_.kernel, threshold_ / std::fabs(subject_.strength));
            const double slant = 1 / (q * q) - steps * steps;
            for (const double off : {0.0, 1e-3, -1e-3, 1e-8, -1e-8, 1e-12, -1e-12}) {
                if (slant <= 0) break;
                const double r = 1 / std::sqrt(slant);
                const Vec3d p = plus(a, r * thin * (1 + off), up);
                const Vec3d d = from_to(p, plus(b, r * thick * (1 + off), up));
                const double back = std::ceil(10 / length(d));
                add(plus(p, -back, d), d);
                add(plus(p, back, d), times(-1, d));
                add(p, d);
            }
            line(plus(a, 0.5 * thin, up), m);
        }
        if (random_.chance(0.5)) {
            subject_.skeleton = Segment{b, a};
            std::swap(subject_.widths[0], subject_.widths[1]);
        }
        subject_.width = thin;
    }

    void coincident() {
        const double thin = some(0.25, 0.75), thick = some(0.75, 1.5);
        if (random_.chance(0.4)) {
            subject_.skeleton = Segment{center_, center_};
            subject_.widths = {thin, thick};
        } else {
            const Vec3d p = at(1, 0.5), q = at(some(-2, 0), -1);
            subject_.skeleton = Polyline{{center_, center_, p, p, p, q}};
            if (random_.chance(0.7)) {
                subject_.widths = {thick, thin, thin, thick, thin, some(0.25, 1)};
            }
            line(p, n_);
            line(p, from_to(q, p));
        }
        for (const Vec3d& d : {e_, f_, n_, some_direction()}) line(center_, d);
        if (!subject_.widths.empty()) {
            subject_.width = *std::min_element(subject_.widths.begin(), subject_.widths.end());
        }
    }

    void disc() {
        Disc shape{center_, n_, some(0.5, 2)};
        // In the plane, and at a right angle to that in the plane.
        const Vec3d g = outer(n_, e_);
        const double r = shape.radius;
        const auto rim = [&](double angle) {
            return plus(plus(center_, r * std::cos(angle) / length(e_), e_),
                        r * std::sin(angle) / length(g), g);
        };
        const double unit = 1 / length(n_);
        if (family_ == Family::disc_edge_on) {
            for (const double h : {0.0, 1e-14, 1e-8, 1e-3, 0.25, 0.5}) {
                const Vec3d d = plus(e_, some(-1, 1), g), p = plus(center_, some(-1, 1), g);
                const double back = std::ceil(10 / length(d));
                add(plus(plus(p, h * unit, n_), -back, d), d);
                add(plus(p, -h * unit, n_), d);
            }
        } else if (family_ == Family::disc_axis) {
            line(center_, n_);
            line(plus(center_, 0.25, e_), n_);
            line(center_, e_);
        } else if (family_ == Family::disc_rim) {
            for (const double angle : {0.0, 0.5 * 3.14159265358979, random_.uniform(0, 6)}) {
                line(rim(angle), n_);
                line(rim(angle), some_direction());
                line(rim(angle), outer(n_, from_to(center_, rim(angle))));
            }
        } else {
            for (int i = 0; i < 3; ++i) {
                line(plus(plus(center_, some(-1, 1), e_), some(-1, 1), g),
                     plus(times(some(-1, 1), e_), some(0.5, 1), g));
            }
            line(plus(center_, r / length(e_), e_), g);
        }
        subject_.skeleton = shape;
    }

    Family family_;
    Random random_;
    double threshold_;
    reference::Element subject_;
    Vec3d center_, e_, f_, n_;
    std::vector<Ray> rays_;
};

std::string number(double x) {
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", x);
    return text;
}
std::string list(const Vec3d& v) {
    return "[" + number(v.x) + ", " + number(v.y) + ", " + number(v.z) + "]";
}
std::string list(const std::vector<Vec3d>& all) {
    std::string text = "[";
    for (const Vec3d& v : all) text += (text.size() > 1 ? ", " : "") + list(v);
    return text + "]";
}

struct ShapeText {
    std::string operator()(const Point& s) const {
        return R"("shape": "point", "position": )" + list(s.position);
    }
    std::string operator()(const Segment& s) const {
        return R"("shape": "segment", "a": )" + list(s.a) + R"(, "b": )" + list(s.b);
    }
    std::string operator()(const reference::Circle& s) const {
        return R"("shape": "circle", )" + round(s.center, s.normal, s.radius);
    }
    std::string operator()(const Disc& s) const {
        return R"("shape": "disc", )" + round(s.center, s.normal, s.radius);
    }
    std::string operator()(const Polygon& s) const {
        return R"("shape": "polygon", "vertices": )" + list(s.vertices);
    }
    std::string operator()(const Curve& s) const {
        return R"("shape": "curve", "control_points": )" + list(s.control_points);
    }
    std::string operator()(const Polyline& s) const {
        return R"("shape": "polyline", "points": )" + list(s.points);
    }

  private:
    static std::string round(const Vec3d& center, const Vec3d& normal, double radius) {
        return R"("center": )" + list(center) + R"(, "normal": )" + list(normal) +
               R"(, "radius": )" + number(radius);
    }
};

const char* kernel_text(Kernel kernel) {
    switch (kernel) {
        case Kernel::blinn:
            return "blinn";
        case Kernel::nishimura:
            return "nishimura";
        case Kernel::wyvill:
            return "wyvill";
        case Kernel::murakami:
            return "murakami";
        case Kernel::blobtree:
            return "blobtree";
    }
    return "";
}

}  // namespace

DegenerateCase degenerate_case(Family family, std::uint64_t seed) {
    return Maker(family, seed).make();
}

std::string scene_text(const reference::ReferenceScene& scene) {
    std::string text =
        "{\n  \"ivory\": 1,\n  \"threshold\": " + number(scene.threshold) + ",\n  \"elements\": [";
    const char* between = "\n";
    for (const reference::Element& element : scene.elements) {
        std::string width = number(element.width);
        if (!element.widths.empty()) {
            width.clear();
            for (const double w : element.widths) width += (width.empty() ? "[" : ", ") + number(w);
            width += "]";
        }
        text += between + ("    {" + std::visit(ShapeText{}, element.skeleton)) + R"(, "color": )" +
                list(element.color) + R"(, "kernel": ")" + kernel_text(element.kernel) +
                R"(", "strength": )" + number(element.strength) + R"(, "width": )" + width +
                (element.visible ? "}" : R"(, "visible": false})");
        between = ",\n";
    }
    return text + "\n  ]\n}\n";
}

std::string rays_text(const std::vector<Ray>& rays) {
    std::string text;
    for (const Ray& ray : rays) {
        char line[200];
        std::snprintf(line, sizeof line, "%a %a %a %a %a %a\n", ray.origin.x, ray.origin.y,
                      ray.origin.z, ray.direction.x, ray.direction.y, ray.direction.z);
        text += line;
    }
    return text;
}

}  // namespace ivory::tools
