#include "app/shape/widths.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <variant>

#include "app/shape/moving.h"
#include "core/math/direction.h"

namespace ivory {

namespace {

constexpr std::string_view width_prefix = "width ";

// Along the chain there; along the view where it does not lead anywhere.
Vec3d tangent(std::span<const Vec3d> chain, std::size_t place, const Vec3d& otherwise) {
    const Vec3d& before = chain[place > 0 ? place - 1 : 0];
    const Vec3d& after = chain[std::min(place + 1, chain.size() - 1)];
    const Vec3d along = after - before;
    return dot(along, along) > 0 ? along : otherwise;
}

}  // namespace

double width_at(const Element& element, std::size_t place) {
    return element.widths.empty() ? element.width : element.widths[place];
}

bool can_taper(const Element& element) {
    return std::visit([]<class S>(const S&) { return S::may_taper; }, element.skeleton);
}

void set_tapers(Element& element, bool tapers) {
    element.widths.clear();
    if (!tapers) return;
    std::visit(
        [&]<class S>(const S& skeleton) {
            if constexpr (S::may_taper) {
                element.widths.assign(skeleton.width_places(), element.width);
            }
        },
        element.skeleton);
}

std::vector<std::string> numbers_of(std::size_t count) {
    std::vector<std::string> numbers;
    for (std::size_t i = 1; i <= count; ++i) numbers.push_back(std::to_string(i));
    return numbers;
}

std::vector<Grip> numbered_grips(std::span<const Vec3d> places, std::string_view part_prefix) {
    std::vector<Grip> grips;
    for (std::size_t i = 0; i < places.size(); ++i) {
        const std::string number = std::to_string(i + 1);
        grips.push_back({.name = number,
                         .kind = GripKind::place,
                         .part = std::string(part_prefix) + number,
                         .place = places[i],
                         .value = places[i]});
    }
    return grips;
}

std::optional<std::size_t> number_named(std::string_view handle, std::size_t count) {
    std::size_t number = 0;
    const char* const end = handle.data() + handle.size();
    const auto [stop, error] = std::from_chars(handle.data(), end, number);
    if (error != std::errc() || stop != end || number < 1 || number > count) return std::nullopt;
    return number - 1;
}

void add_width_grips(const Element& element, const HandView& view, std::span<const Vec3d> chain,
                     const std::vector<std::string>& arms, std::vector<Grip>& grips) {
    for (std::size_t i = 0; i < element.widths.size(); ++i) {
        Grip grip = radius_grip(view, chain[i], tangent(chain, i, view.projection.back()),
                                element.widths[i], arms[i]);
        grip.name = grip.part = std::string(width_prefix) + std::to_string(i + 1);
        grips.push_back(std::move(grip));
    }
}

std::optional<std::size_t> width_named(const Element& element, std::string_view handle) {
    if (!handle.starts_with(width_prefix)) return std::nullopt;
    return number_named(handle.substr(width_prefix.size()), element.widths.size());
}

bool move_width(Element& element, std::size_t place, const HandView& view,
                std::span<const Vec3d> chain, const HandleMotion& motion) {
    double& width = element.widths[place];
    const double before = width;
    if (!move_radius(width, chain[place], tangent(chain, place, view.projection.back()), view,
                     motion)) {
        return false;
    }
    // A width of 0 is none.
    width = std::max(width, 1e-3 * before);
    element.width = *std::min_element(element.widths.begin(), element.widths.end());
    return true;
}

}  // namespace ivory
