#include "tests/stress/families.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <string>
#include <utility>

#include "core/field/field.h"
#include "core/field/support.h"
#include "core/scene/scene_fault.h"
#include "core/scene/scene_json.h"
#include "core/trace/methods/method.h"
#include "core/trace/trace.h"
#include "tests/reference/along_ray.h"
#include "tests/reference/reference.h"
#include "tests/tools/degenerate_scenes.h"
#include "tests/tools/kinds.h"
#include "tests/tools/nasty_rays.h"
#include "tests/tools/on_skeleton.h"
#include "tests/tools/random_scene.h"

namespace ivory::stress {

namespace {

using tools::Members;
using tools::Random;
using tools::RayKind;

Vec3d plus(const Vec3d& a, double x, const Vec3d& b) { return a + x * b; }

// To nearest, of any length that a double can have.
Vec3d one_long(const Vec3d& v) {
    int exponent = 0;
    std::frexp(std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}), &exponent);
    const Vec3d m{std::ldexp(v.x, -exponent), std::ldexp(v.y, -exponent),
                  std::ldexp(v.z, -exponent)};
    return (1 / std::sqrt(dot(m, m))) * m;
}

bool finite(const Vec3d& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}
bool is_ray(const Ray& ray) {
    return finite(ray.origin) && finite(ray.direction) && ray.direction != Vec3d{0, 0, 0};
}

double widest(const Scene& scene) {
    double width = 0;
    for (const Element& element : scene.elements) width = std::max(width, element.width);
    return width;
}

void scale_widths(Element& element, double factor) {
    element.width *= factor;
    for (double& width : element.widths) width *= factor;
}

template <class Move>
void move(Element& element, const Move& where, double factor) {
    const Members members(element.skeleton);
    for (Vec3d* const place : members.places) *place = where(*place);
    for (double* const length : members.lengths) *length *= factor;
    scale_widths(element, factor);
}

double kernel_value(KernelKind kind, double q) {
    return reference::kernel_germ(kind, reference::OutwardDouble(q * q)).value.hi;
}

class Maker {
  public:
    Maker(Family family, std::uint64_t seed, std::size_t rays)
        : family_(family),
          random_(seed * family_words.size() + static_cast<std::uint64_t>(family)),
          wanted_(rays) {}

    Trial make() {
        make_scene();
        scene_.camera.reset();
        if (family_ != Family::degenerate) make_rays();
        rays_.erase(std::remove_if(rays_.begin(), rays_.end(), std::not_fn(is_ray)), rays_.end());
        while (rays_.size() > wanted_) {
            std::swap(rays_[random_.below(rays_.size())], rays_.back());
            rays_.pop_back();
        }
        return {scene_, rays_, some_camera()};
    }

  private:
    double log_uniform(double lo, double hi) {
        return std::pow(10, random_.uniform(std::log10(lo), std::log10(hi)));
    }
    double little(double hi, double lo) { return random_.sign() * log_uniform(lo, hi); }
    Vec3d direction() {
        for (;;) {
            const Vec3d v = random_.in_cube(1);
            if (dot(v, v) > 0.01 && dot(v, v) < 1) return one_long(v);
        }
    }
    tools::SceneRecipe recipe(std::size_t least, std::size_t most) {
        tools::SceneRecipe recipe;
        recipe.elements = least + random_.below(most - least + 1);
        return recipe;
    }
    std::uint64_t some_seed() { return random_.below(1u << 30); }
    Scene some_scene(std::size_t least, std::size_t most) {
        return tools::random_scene(recipe(least, most), some_seed());
    }
    // Of any kind, positive, with its first place near 0.
    Element some_element() {
        tools::SceneRecipe recipe;
        recipe.elements = 1;
        recipe.only = tools::every_kind[random_.below(tools::every_kind.size())];
        return tools::random_scene(recipe, some_seed()).elements.front();
    }
    // Whatever rounding leaves of a scene has to be one.
    void accept(Scene scene) {
        if (!find_fault(scene)) scene_ = std::move(scene);
    }

    void make_scene() {
        scene_ = some_scene(2, 8);
        switch (family_) {
            case Family::tangent:
            case Family::axes:
            case Family::origins:
            case Family::directions:
                break;
            case Family::neck:
                return neck();
            case Family::shell:
                return shell();
            case Family::critical:
                return critical();
            case Family::faint:
                scene_.threshold = log_uniform(1e-300, 1e-1);
                return;
            case Family::widths:
                return widths();
            case Family::shifted:
                return shifted();
            case Family::scaled:
                return scaled();
            case Family::cancelling:
                return cancelling();
            case Family::coincident:
                return coincident();
            case Family::overlapping:
                return overlapping();
            case Family::degenerate: {
                const auto which = random_.below(tools::family_words.size());
                const auto made =
                    tools::degenerate_case(static_cast<tools::Family>(which), some_seed());
                scene_ = parse_scene(tools::scene_text(made.scene), "degenerate");
                rays_ = made.rays;
            }
        }
    }

    // Of a field without T, at the origin.
    static double field_at_origin(const Scene& scene) {
        const reference::ReferenceField field(scene);
        return field.at({{0, 0, 0}, {0, 0, 1}}, reference::Real(0.0)).f.lo.to_double() +
               scene.threshold;
    }
    // An element, and it again at -p: in between the gradient is 0.
    void neck() {
        for (int tries = 0; tries < 20; ++tries) {
            Scene scene;
            Element element = some_element();
            const double apart = random_.uniform(0.4, 1.2) * element.width;
            const Vec3d off =
                plus(apart * direction(), -1, *Members(element.skeleton).places.front());
            move(
                element, [&](const Vec3d& p) { return p + off; }, 1);
            scene.elements.push_back(element);
            move(
                element, [](const Vec3d& p) { return -p; }, 1);
            scene.elements.push_back(element);
            const double field = field_at_origin(scene);
            if (!(field > 0.01)) continue;
            scene.threshold = field * (1 + little(1e-1, 1e-12));
            difficulty_ = std::fabs(scene.threshold / field - 1);
            if (find_fault(scene)) continue;
            scene_ = scene;
            return;
        }
    }
    // The same skeleton twice, the second time thinner and taking away. Of s = q^2 alone.
    void shell() {
        Element outer = some_element(), inner = outer;
        const double thinner = random_.uniform(0.3, 0.9);
        scale_widths(inner, thinner);
        inner.strength *= -random_.uniform(0.6, 2);
        double greatest = 0;
        for (int i = 0; i <= 40000; ++i) {
            const double q = i / 10000.0;
            greatest =
                std::max(greatest, outer.strength * kernel_value(outer.kernel, q) +
                                       inner.strength * kernel_value(inner.kernel, q / thinner));
        }
        Scene scene;
        scene.elements = {outer, inner};
        scene.threshold = greatest * (1 - log_uniform(1e-15, 1e-1));
        accept(scene);
    }
    void critical() {
        tools::SceneRecipe pairs = recipe(1, 4);
        pairs.critical = true;
        scene_ = tools::random_scene(pairs, some_seed());
        if (random_.chance(0.4)) {  // the maximum of elements in one place: a spike, or nothing
            Scene scene;
            Element element = some_element();
            const std::size_t count = 1 + random_.below(4);
            double sum = 0;
            for (std::size_t i = 0; i < count; ++i) {
                element.strength = random_.uniform(0.5, 1.5);
                element.kernel = static_cast<KernelKind>(random_.below(kernel_count));
                sum += element.strength;
                scene.elements.push_back(element);
            }
            scene.threshold = sum * (1 + little(1e-3, 1e-15));
            difficulty_ = std::fabs(scene.threshold / sum - 1);
            accept(scene);
            return;
        }
        difficulty_ = log_uniform(1e-15, 1e-3);
        const double field = field_at_origin(scene_);
        if (field > 0.01) scene_.threshold = field * (1 + random_.sign() * difficulty_);
    }
    void widths() {
        Scene scene;
        scene.threshold = random_.uniform(0.1, 0.8);
        const std::size_t count = 2 + random_.below(8);
        Vec3d place{0, 0, 0};
        for (std::size_t i = 0; i < count; ++i) {
            Element element = some_element();
            const double factor = log_uniform(1e-6, 1e6);
            if (i > 0) element.strength *= random_.chance(0.2) ? -1 : 1;
            move(
                element, [&](const Vec3d& p) { return place + factor * p; }, factor);
            // The next one on the surface of this one, or near it.
            place = plus(tools::on_skeleton(element.skeleton, random_),
                         element.width * random_.uniform(0, 1.5), direction());
            scene.elements.push_back(element);
        }
        accept(scene);
    }
    void shifted() {
        Scene scene = scene_;
        const double far = log_uniform(1, 1e12);
        const Vec3d off = far * random_.in_cube(1);
        for (Element& element : scene.elements) {
            move(
                element, [&](const Vec3d& p) { return p + off; }, 1);
        }
        accept(scene);
    }
    void scaled() {
        Scene scene = scene_;
        const double factor = log_uniform(1e-160, 1e155);
        for (Element& element : scene.elements) {
            move(
                element, [&](const Vec3d& p) { return factor * p; }, factor);
        }
        accept(scene);
    }
    // b and -b (1 - m) in one place, m down to some ulp; and T of what is left.
    void cancelling() {
        Scene scene;
        const std::size_t count = 1 + random_.below(4);
        double left = 0;
        const double large = log_uniform(1, 1e12);
        for (std::size_t i = 0; i < count; ++i) {
            Element element = some_element();
            element.strength = large * random_.uniform(0.5, 1.5);
            scene.elements.push_back(element);
            const double part = log_uniform(1e-15, 1e-1);
            const double before = element.strength;
            element.strength = -before * (1 - part);
            left = std::max(left, before + element.strength);
            scene.elements.push_back(element);
        }
        if (!(left > 0)) return;
        scene.threshold = left * random_.uniform(0.1, 1.1);
        accept(scene);
    }
    void coincident() {
        Scene scene;
        Element element = some_element();
        const std::size_t count = 100 + random_.below(300);
        const bool alike = random_.chance(0.5);
        double sum = 0;
        for (std::size_t i = 0; i < count; ++i) {
            if (!alike) {
                element.kernel = static_cast<KernelKind>(random_.below(kernel_count));
                element.strength = random_.uniform(0.5, 1.5) * (random_.chance(0.1) ? -1 : 1);
            }
            sum += element.strength;
            scene.elements.push_back(element);
        }
        scene.threshold =
            sum * (random_.chance(0.3) ? 1 + little(1e-1, 1e-12) : random_.uniform(0.05, 0.95));
        accept(scene);
    }
    void overlapping() {
        Scene scene = tools::mixed_scene(1000 + random_.below(1000), some_seed());
        double sum = 0;
        for (Element& element : scene.elements) {
            element.width = random_.uniform(0.2, 1);
            element.strength = random_.uniform(0.5, 1.5) * (random_.chance(0.2) ? -1 : 1);
            sum += element.strength * std::pow(element.width, 3);
        }
        scene.threshold = std::max(0.1, sum) * random_.uniform(0.05, 0.5);
        accept(scene);
    }

    void make_rays() {
        switch (family_) {
            case Family::tangent:
                return tangents(wanted_);
            case Family::shell:
                shots(wanted_ / 2);
                return tangents(wanted_ / 2);
            case Family::neck:
            case Family::critical:
                return through_the_origin();
            case Family::faint:
                return from_afar();
            case Family::axes:
                return axes();
            case Family::origins:
                return origins();
            case Family::directions:
                return directions();
            case Family::overlapping:
                return shots(wanted_);
            case Family::widths:
                at_skeletons(wanted_ / 2);
                [[fallthrough]];
            default:
                shots(2 * (wanted_ - rays_.size()) / 3);
                return tangents(wanted_ - rays_.size());
        }
    }

    void add(const std::vector<Ray>& rays) { rays_.insert(rays_.end(), rays.begin(), rays.end()); }
    void add(RayKind kind, std::size_t count) {
        add(tools::nasty_rays(scene_, kind, count, some_seed()));
    }
    void shots(std::size_t count) { add(RayKind::random, count); }

    // Half a width or so from some skeleton, from many widths away.
    void at_skeletons(std::size_t count) {
        for (std::size_t i = 0; i < count; ++i) {
            const Element& element = scene_.elements[random_.below(scene_.elements.size())];
            const Vec3d p = plus(tools::on_skeleton(element.skeleton, random_),
                                 element.width * random_.uniform(0, 1.2), direction());
            const double away = element.width * log_uniform(1, 1e3);
            const Vec3d d = direction();
            rays_.push_back({plus(p, -away, d), d});
        }
    }

    bool may_hit(const Ray& ray) {
        if (!field_) {
            field_ = compile(scene_);
            list_ = all_elements(*field_);
        }
        Counts counts;
        return is_ray(ray) && possibly_hit(trace(*field_, list_, ray, *find_method("proved"),
                                                 {.tolerance = 1e-9}, counts)
                                               .isolation.status);
    }
    // Between a ray that hits and one that misses lies one that touches; the tracer itself is asked
    // where.
    void tangents(std::size_t count) {
        const std::size_t aim = rays_.size() + count;
        for (int tries = 0; rays_.size() < aim && tries < 40; ++tries) {
            const auto pair = tools::nasty_rays(scene_, RayKind::random, 2, some_seed());
            if (pair.size() < 2) return;
            const Ray a = pair[0];
            Ray b = pair[1];
            if (random_.chance(0.5)) b = {a.origin, plus(b.origin + b.direction, -1, a.origin)};
            const auto between = [&](double x) {
                return Ray{plus(a.origin, x, b.origin - a.origin),
                           plus(a.direction, x, b.direction - a.direction)};
            };
            const bool first = may_hit(a);
            if (first == may_hit(b)) continue;
            double lo = 0, hi = 1;
            for (;;) {
                const double middle = lo + (hi - lo) / 2;
                if (middle <= lo || middle >= hi) break;
                (may_hit(between(middle)) == first ? lo : hi) = middle;
            }
            rays_.push_back(between(lo));
            rays_.push_back(between(hi));
            for (int i = 0; i < 20; ++i) rays_.push_back(between(lo + little(1e-3, 1e-15)));
        }
    }

    // Where a neck is, or a spike: as near as it is thin.
    void through_the_origin() {
        const double w = scene_.elements.front().width;
        const Vec3d at = family_ == Family::neck || scene_.elements.size() < 2 ||
                                 scene_.elements[0].skeleton != scene_.elements[1].skeleton
                             ? Vec3d{0, 0, 0}
                             : tools::on_skeleton(scene_.elements[0].skeleton, random_);
        const Vec3d along =
            one_long(*Members(scene_.elements.front().skeleton).places.front() + Vec3d{1e-3, 0, 0});
        while (rays_.size() < wanted_) {
            const double near = std::sqrt(difficulty_) * random_.uniform(0, 3);
            const Vec3d p = plus(at, random_.chance(0.1) ? 0 : near * w, direction());
            Vec3d d = direction();
            if (random_.chance(0.3)) d = one_long(plus(along, log_uniform(1e-15, 1e-1), d));
            const double away = w * (random_.chance(0.2) ? 0 : log_uniform(0.1, 100));
            rays_.push_back({plus(p, -away, d), d});
        }
    }
    void from_afar() {
        const double size = 30 * widest(scene_);
        while (3 * rays_.size() < 2 * wanted_) {
            const Element& element = scene_.elements[random_.below(scene_.elements.size())];
            const Vec3d d = direction();
            const Vec3d p =
                plus(tools::on_skeleton(element.skeleton, random_), size, random_.in_cube(1));
            rays_.push_back({plus(p, -2 * size, d), d});
        }
        tangents(wanted_ - rays_.size());
    }
    void axes() {
        const std::size_t part = wanted_ / 3;
        for (const RayKind kind : {RayKind::axis, RayKind::segment, RayKind::parallel}) {
            add(kind, part);
        }
        const double size = widest(scene_);
        for (Ray& ray : rays_) {
            if (random_.chance(0.5)) {
                ray.origin = plus(ray.origin, size * log_uniform(1e-15, 1e-3), direction());
            }
        }
        // Written with zeros of both signs.
        for (Ray& ray : rays_) {
            for (std::size_t k = 0; k < 3; ++k) {
                if (ray.direction[k] == 0 && random_.chance(0.5)) ray.direction[k] = -0.0;
            }
        }
    }
    void origins() {
        add(RayKind::inside, wanted_ / 5);
        for (int tries = 0; rays_.size() < wanted_ && tries < 1000; ++tries) {
            const auto one = tools::nasty_rays(scene_, RayKind::random, 1, some_seed());
            if (one.empty() || !may_hit(one[0])) continue;
            const Ray& ray = one[0];
            Counts counts;
            const Answer answer =
                trace(*field_, list_, ray, *find_method("proved"), {.tolerance = 1e-15}, counts);
            const double t = 0.5 * (answer.isolation.t.lo + answer.isolation.t.hi);
            const Vec3d p = plus(ray.origin, t, ray.direction);
            const Vec3d n = answer.surface.normal;
            const double w = scene_.elements.front().width;
            for (int i = 0; i < 6; ++i) {
                const Vec3d d = direction();
                const double off = random_.chance(0.3) ? 0 : w * little(1e-3, 1e-15);
                const Vec3d o = plus(p, off, n);
                rays_.push_back({o, d});
                rays_.push_back({o, plus(d, -dot(d, n), n)});  // along the surface
                rays_.push_back({plus(ray.origin, t * (1 + little(1e-3, 1e-15)), ray.direction),
                                 random_.sign() * ray.direction});
            }
        }
    }
    void directions() {
        shots(wanted_);
        for (Ray& ray : rays_) {
            ray.direction = one_long(ray.direction);
            const std::size_t zeros = random_.below(3);
            for (std::size_t i = 0; i < zeros; ++i) {
                const std::size_t k = random_.below(3);
                // From where it meets the same place.
                ray.origin[k] += 2 * ray.direction[k];
                ray.direction[k] = random_.chance(0.5) ? 0.0 : -0.0;
            }
            if (ray.direction == Vec3d{0, 0, 0}) ray.direction.x = -1;
            ray.direction = log_uniform(1e-150, 1e150) * ray.direction;
            if (random_.chance(0.2)) {
                ray.direction[random_.below(3)] *= log_uniform(1e-150, 1);
            }
        }
    }

    std::optional<Camera> some_camera() {
        if (rays_.empty()) return std::nullopt;
        const Ray& ray = rays_[random_.below(rays_.size())];
        const double w = scene_.elements.front().width;
        Camera camera;
        camera.position = ray.origin;
        camera.target = plus(ray.origin, 4 * w, one_long(ray.direction));
        camera.up = direction();
        camera.fov = log_uniform(0.03, 100);
        if (random_.chance(0.3)) {
            camera.projection = Camera::Projection::orthographic;
            camera.height = w * log_uniform(1e-6, 10);
        }
        if (find_fault(camera)) return std::nullopt;
        return camera;
    }

    Family family_;
    Random random_;
    std::size_t wanted_;
    Scene scene_;
    double difficulty_ = 1e-3;
    std::vector<Ray> rays_;
    std::optional<Field> field_;
    ElementList list_;
};

}  // namespace

Trial make_trial(Family family, std::uint64_t seed, std::size_t rays) {
    return Maker(family, seed, rays).make();
}

}  // namespace ivory::stress
