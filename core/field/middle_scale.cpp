#include "core/field/middle_scale.h"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <variant>
#include <vector>

namespace ivory {
namespace {

// Calls visit(x) for each length of an element that may be seen.
template <class AnElement, class Visit>  // const or not
void for_lengths(AnElement& element, const Visit& visit) {
    const auto of_place = [&](auto& p) {
        visit(p.x);
        visit(p.y);
        visit(p.z);
    };
    std::visit(
        [&](auto& skeleton) {
            for_members<std::remove_cvref_t<decltype(skeleton)>>([&](const auto& member) {
                auto& value = skeleton.*member.value;
                using Value = std::remove_cvref_t<decltype(value)>;
                if constexpr (std::is_same_v<Value, std::vector<Vec3d>>) {
                    std::for_each(value.begin(), value.end(), of_place);
                } else if constexpr (std::is_same_v<Value, Vec3d>) {
                    if (member.kind == MemberKind::place) of_place(value);
                } else {
                    static_assert(std::is_same_v<Value, double>);
                    visit(value);
                }
            });
        },
        element.skeleton);
    visit(element.width);
    std::for_each(element.widths.begin(), element.widths.end(), visit);
}

int exponent_of(double x) {
    int exponent = 0;
    std::frexp(x, &exponent);
    return exponent;
}

}  // namespace

std::optional<double> scaled_exactly(double x, int exponent) {
    const double scaled = std::ldexp(x, exponent);
    if (!std::isfinite(scaled) || std::ldexp(scaled, -exponent) != x) return std::nullopt;
    return scaled;
}

int exponent_to_middle(const Scene& scene) {
    constexpr double far = 0x1p200;
    double largest = 0, least_width = infinity<double>;
    const auto look = [&](const auto& act) {
        for (const Element& element : scene.elements) {
            if (element.visible) act(element);
        }
    };
    look([&](const Element& element) {
        least_width = std::min(least_width, element.width);
        for (const double width : element.widths) least_width = std::min(least_width, width);
        for_lengths(element, [&](double x) { largest = std::max(largest, std::abs(x)); });
    });
    if (!(largest > 0) || (largest <= far && least_width >= 1 / far)) return 0;
    const int exponent = -(exponent_of(largest) + exponent_of(least_width)) / 2;
    bool all_exact = true;
    look([&](const Element& element) {
        for_lengths(element, [&](double x) {
            all_exact = all_exact && scaled_exactly(x, exponent).has_value();
        });
    });
    return all_exact ? exponent : 0;
}

Scene in_middle(const Scene& scene, int exponent) {
    Scene middle;
    middle.threshold = scene.threshold;
    middle.elements = scene.elements;
    for (Element& element : middle.elements) {
        if (!element.visible) continue;
        for_lengths(element, [&](double& x) { x = std::ldexp(x, exponent); });
    }
    return middle;
}

}  // namespace ivory
