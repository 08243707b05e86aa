#include "tests/tools/nasty_rays.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <iterator>
#include <limits>
#include <optional>
#include <variant>

#include "tests/reference/reference.h"
#include "tests/tools/kinds.h"
#include "tests/tools/random_scene.h"

namespace ivory::tools {

namespace {

// a + x b, rounded as it comes.
Vec3d plus(const Vec3d& a, double x, const Vec3d& b) {
    return {a.x + x * b.x, a.y + x * b.y, a.z + x * b.z};
}

Vec3d from_to(const Vec3d& a, const Vec3d& b) { return {b.x - a.x, b.y - a.y, b.z - a.z}; }

double length(const Vec3d& v) { return std::hypot(v.x, v.y, v.z); }

Vec3d times(double x, const Vec3d& v) { return {x * v.x, x * v.y, x * v.z}; }

// Some vector at a right angle to v, 1 long.
Vec3d beside(const Vec3d& v) {
    const Vec3d a = std::fabs(v.x) < 0.5 * length(v) ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
    const Vec3d n{a.y * v.z - a.z * v.y, a.z * v.x - a.x * v.z, a.x * v.y - a.y * v.x};
    return times(1 / length(n), n);
}

bool finite(const Vec3d& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// Scenes of extreme scales lose directions and origins to underflow and overflow.
bool is_ray(const Ray& ray) {
    return finite(ray.origin) && finite(ray.direction) && ray.direction != Vec3d{0, 0, 0};
}

class Maker {
  public:
    Maker(const Scene& scene, std::uint64_t seed) : field_(scene), random_(seed) {
        std::copy_if(scene.elements.begin(), scene.elements.end(), std::back_inserter(elements_),
                     [](const Element& element) { return element.visible; });
        const double infinity = std::numeric_limits<double>::infinity();
        Vec3d lo{infinity, infinity, infinity}, hi{-infinity, -infinity, -infinity};
        for (const Element& element : elements_) {
            for (const Vec3d& p : marks(element)) {
                for (std::size_t k = 0; k < 3; ++k) {
                    lo[k] = std::min(lo[k], p[k] - 1.5 * element.width);
                    hi[k] = std::max(hi[k], p[k] + 1.5 * element.width);
                }
            }
        }
        if (elements_.empty()) lo = {-1, -1, -1}, hi = {1, 1, 1};
        center_ = plus(times(0.5, lo), 0.5, hi);
        size_ = 0.5 * length(from_to(lo, hi));
    }

    std::vector<Ray> make(RayKind kind, std::size_t count) {
        // A kind may find nothing, in a scene without a surface for example.
        for (std::size_t tries = 0; rays_.size() < count && tries < 4 * count; ++tries) {
            const auto before = static_cast<std::ptrdiff_t>(rays_.size());
            switch (kind) {
                case RayKind::random:
                    rays_.push_back(random_ray());
                    break;
                case RayKind::tangent:
                    tangent();
                    break;
                case RayKind::axis:
                    axis();
                    break;
                case RayKind::segment:
                    segment();
                    break;
                case RayKind::inside:
                    inside();
                    break;
                case RayKind::scaled:
                    scaled();
                    break;
                case RayKind::parallel:
                    parallel();
                    break;
                case RayKind::surface:
                    surface();
                    break;
                case RayKind::far:
                    far();
                    break;
            }
            rays_.erase(std::remove_if(rays_.begin() + before, rays_.end(), std::not_fn(is_ray)),
                        rays_.end());
        }
        if (rays_.size() > count) rays_.resize(count);
        return std::move(rays_);
    }

  private:
    // Points of the skeleton that span it: its places, or what lies about them around a direction.
    static std::vector<Vec3d> marks(const Element& element) {
        Skeleton skeleton = element.skeleton;
        const Members members(skeleton);
        std::vector<Vec3d> points;
        if (members.directions.empty()) {
            for (const Vec3d* const place : members.places) points.push_back(*place);
            return points;
        }
        const Vec3d& n = *members.directions.front();
        const Vec3d u = beside(n);
        const Vec3d cross{n.y * u.z - n.z * u.y, n.z * u.x - n.x * u.z, n.x * u.y - n.y * u.x};
        const Vec3d v = times(1 / length(n), cross);
        for (const Vec3d& side : {u, times(-1, u), v, times(-1, v)}) {
            points.push_back(std::visit(
                [&]<class S>(const S& s) { return S::farthest(parts_of(s)[0].seen(), {}, side); },
                skeleton));
        }
        return points;
    }

    // A skeleton of which `suits` is true of the members.
    template <class Suits>
    std::optional<Skeleton> some_skeleton(const Suits& suits) {
        std::vector<Skeleton> found;
        for (const Element& element : elements_) {
            Skeleton skeleton = element.skeleton;
            if (suits(Members(skeleton))) found.push_back(skeleton);
        }
        if (found.empty()) return std::nullopt;
        return found[random_.below(found.size())];
    }

    Vec3d some_direction() {
        for (;;) {
            const Vec3d v = random_.in_cube(1);
            const double l = length(v);
            if (l > 0.1 && l < 1) return times(1 / l, v);
        }
    }
    // Somewhere near the skeleton.
    Vec3d target() {
        if (elements_.empty() || random_.chance(0.2)) {
            return plus(center_, size_ * 0.6, random_.in_cube(1));
        }
        const Element& element = elements_[random_.below(elements_.size())];
        const std::vector<Vec3d> points = marks(element);
        return plus(points[random_.below(points.size())], element.width, random_.in_cube(1.2));
    }
    Vec3d viewpoint() { return plus(center_, size_ * random_.uniform(1.2, 4), some_direction()); }
    Ray random_ray() {
        const Vec3d o = viewpoint(), d = from_to(o, target());
        return {o, random_.chance(0.5) ? times(1 / length(d), d) : d};
    }
    bool hits(const Ray& ray) {
        return is_ray(ray) && first_root(field_, ray).outcome == reference::Outcome::hit;
    }

    // Between a ray that hits and one that misses lies one that just touches.
    void tangent() {
        const Ray a = random_ray();
        Ray b = random_ray();
        if (random_.chance(0.5)) {
            b.origin = a.origin;
            b.direction = from_to(a.origin, target());
        }
        if (hits(a) == hits(b)) return;
        const auto between = [&](double x) {
            return Ray{plus(a.origin, x, from_to(a.origin, b.origin)),
                       plus(a.direction, x, from_to(a.direction, b.direction))};
        };
        double lo = 0, hi = 1;
        const bool start_hits = hits(a);
        for (;;) {
            const double middle = lo + (hi - lo) / 2;
            if (middle <= lo || middle >= hi) break;
            (hits(between(middle)) == start_hits ? lo : hi) = middle;
        }
        rays_.push_back(between(lo));
        rays_.push_back(between(hi));
        for (int power = 4; power <= 15; ++power) {
            const double off = std::pow(10, -power) * random_.uniform(0.5, 2);
            rays_.push_back(between(lo - off));
            rays_.push_back(between(hi + off));
        }
    }

    void axis() {
        auto around = some_skeleton([](const Members& m) { return !m.directions.empty(); });
        if (!around) return;
        const Members members(*around);
        const Vec3d center = *members.places.front(), n = *members.directions.front();
        const double radius = members.lengths.empty() ? 0 : *members.lengths.front();
        const double scale = std::max(radius, 0x1p-10 * size_);
        const Vec3d side = beside(n);
        const double back = random_.sign() * std::ceil(random_.uniform(1, 4) * size_ / length(n));
        const Vec3d o = plus(center, back, n), d = times(back > 0 ? -1 : 1, n);
        rays_.push_back({o, d});
        for (const double off : {1e-3, 1e-8, 1e-14}) {
            rays_.push_back({plus(o, off * scale, side), d});
            rays_.push_back({o, plus(d, off * length(d), side)});
        }
        rays_.push_back({center, d});     // from the centre
        rays_.push_back({center, side});  // from the centre to the circle
        const Vec3d across = plus(center, -4 * size_, side);
        rays_.push_back({across, side});
        rays_.push_back({plus(across, 1e-8 * scale, n), side});
        const Vec3d oblique = plus(side, random_.uniform(-1, 1), some_direction());
        rays_.push_back({plus(center, -4 * size_, oblique), oblique});
    }

    void segment() {
        auto line = some_skeleton([](const Members& m) { return m.places.size() > 1; });
        if (!line || random_.chance(0.2)) {  // through a point of some skeleton
            if (elements_.empty()) return;
            const auto points = marks(elements_[random_.below(elements_.size())]);
            const Vec3d o = viewpoint();
            rays_.push_back({o, from_to(o, points[0])});
            return;
        }
        const Members members(*line);
        const Vec3d a = *members.places.front(), b = *members.places.back();
        const Vec3d along = a == b ? some_direction() : from_to(a, b);
        const double back = std::ceil(random_.uniform(1, 4) * size_ / length(along));
        const Vec3d o = plus(a, -back, along), side = beside(along);
        rays_.push_back({o, along});
        rays_.push_back({a, along});
        rays_.push_back({plus(b, back, along), times(-1, along)});
        for (const double off : {1e-3, 1e-8, 1e-14}) {
            rays_.push_back({plus(o, off * size_, side), along});
            rays_.push_back({o, plus(along, off * length(along), side)});
        }
        for (const Vec3d& end : {a, b}) {
            const Vec3d from = viewpoint();
            rays_.push_back({from, from_to(from, end)});
            rays_.push_back({plus(end, -4 * size_, side), side});
            rays_.push_back({end, some_direction()});
        }
    }

    void inside() {
        if (elements_.empty()) return;
        const Element& element = elements_[random_.below(elements_.size())];
        if (element.strength < 0) return;
        const auto points = marks(element);
        const Vec3d o = plus(points[random_.below(points.size())],
                             random_.chance(0.3) ? 0 : 0.3 * element.width, random_.in_cube(1));
        rays_.push_back({o, some_direction()});
    }

    void scaled() {
        const Ray ray = random_ray();
        const Vec3d unit = times(1 / length(ray.direction), ray.direction);
        for (const double factor : {1e-6, 1e-3, 1e3, 1e6, 1e-150, 1e150}) {
            rays_.push_back({ray.origin, times(factor, unit)});
        }
        rays_.push_back({ray.origin, times(std::pow(10, random_.uniform(-6, 6)), unit)});
    }

    void parallel() {
        const std::size_t k = random_.below(3);
        Vec3d d{0, 0, 0};
        d[k] = random_.sign() * (random_.chance(0.5) ? 1 : random_.uniform(0.1, 10));
        Vec3d o = target();
        if (!elements_.empty() && random_.chance(0.5)) {  // exactly through a mark
            const auto points = marks(elements_[random_.below(elements_.size())]);
            o = points[0];
        }
        o[k] = center_[k] - 3 * size_ * (d[k] > 0 ? 1 : -1);
        rays_.push_back({o, d});
    }

    void surface() {
        const Ray ray = random_ray();
        if (!is_ray(ray)) return;
        const reference::ReferenceAnswer answer = first_root(field_, ray);
        if (answer.outcome != reference::Outcome::hit) return;
        const Vec3d o = plus(ray.origin, answer.t.lo.to_double(), ray.direction);
        rays_.push_back({o, ray.direction});
        rays_.push_back({o, times(-1, ray.direction)});
        rays_.push_back({o, some_direction()});
    }

    void far() {
        const Vec3d d = some_direction();
        const double away = 1e6 * size_;
        rays_.push_back({plus(target(), -away, d), random_.chance(0.5) ? d : times(away, d)});
    }

    reference::ReferenceField field_;
    std::vector<Element> elements_;  // visible
    Random random_;
    Vec3d center_;
    double size_ = 1;  // half the diagonal of a box around the scene
    std::vector<Ray> rays_;
};

}  // namespace

std::vector<Ray> nasty_rays(const Scene& scene, RayKind kind, std::size_t count,
                            std::uint64_t seed) {
    return Maker(scene, seed).make(kind, count);
}

}  // namespace ivory::tools
