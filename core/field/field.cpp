#include "core/field/field.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <numeric>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

#include "core/field/bounding_box.h"
#include "core/field/middle_scale.h"
#include "core/math/parallel.h"

namespace ivory {
namespace {

bool is_compact(const Field& field) {
    constexpr double largest = 1e30;
    const auto moderate = [](double x) { return x > 1 / largest && x < largest; };
    if (!moderate(field.threshold) || !moderate(field.least_width) ||
        !moderate(field.greatest_width) || !(field.greatest_width < 1e6 * field.least_width)) {
        return false;
    }
    for (std::size_t i = 0; i < field.size(); ++i) {
        const Vec3d a = field.a(i), b = field.b(i);
        const double most = std::max({std::abs(a.x), std::abs(a.y), std::abs(a.z), std::abs(b.x),
                                      std::abs(b.y), std::abs(b.z), field.radius[i]});
        const double share = std::abs(field.strength[i]) / field.threshold;
        if (!(most < largest && share > 1e-30 && share < 1e12)) return false;
    }
    return true;
}

void make_room(Field& field, std::size_t count) {
    for (auto* column :
         {&field.strength, &field.width, &field.ax, &field.ay, &field.az, &field.bx, &field.by,
          &field.bz, &field.radius, &field.mx, &field.my, &field.mz, &field.parameter,
          &field.length, &field.inverse_width, &field.inverse_square, &field.cut}) {
        column->resize(count);
    }
    for (auto* column : {&field.red, &field.green, &field.blue}) column->resize(count);
    field.color.resize(count);
    field.shape.resize(count);
    field.kernel.resize(count);
    field.source.resize(count);
}

// The parts of an element: those with numbers once they are found, others as they are asked for.
class Parts {
  public:
    explicit Parts(const Element& element) : element_(&element) {
        std::visit(
            [&]<class S>(const S& skeleton) {
                if constexpr (S::has_numbers) {
                    found_ = skeleton.split();
                    count_ = found_.size();
                } else {
                    count_ = part_count(skeleton);
                }
            },
            element.skeleton);
    }
    [[nodiscard]] std::size_t count() const { return count_; }
    [[nodiscard]] SkeletonColumns operator[](std::size_t part) const {
        return found_.empty() ? columns_of(*element_, part) : found_[part].columns;
    }
    [[nodiscard]] const std::vector<double>& numbers(std::size_t part) const {
        return found_[part].numbers;
    }

    [[nodiscard]] static std::size_t count_of(const Element& element) {
        return std::visit([](const auto& skeleton) { return part_count(skeleton); },
                          element.skeleton);
    }

    // Of an element whose shape has no numbers.
    static SkeletonColumns columns_of(const Element& element, std::size_t part) {
        return std::visit(
            [&]<class S>(const S& skeleton) -> SkeletonColumns {
                if constexpr (S::may_taper) {
                    if (!element.widths.empty()) {
                        return TaperedSegment::columns(skeleton.segment(part), element.widths[part],
                                                       element.widths[part + 1]);
                    }
                }
                if constexpr (S::has_numbers)
                    return {};
                else
                    return part_of(skeleton, part);
            },
            element.skeleton);
    }

  private:
    const Element* element_;
    std::vector<SkeletonPart> found_;
    std::size_t count_ = 0;
};

// All that a part of an element says by itself, but for its colour and its numbers.
void put(Field& field, std::size_t i, const Element& element, const SkeletonColumns& columns) {
    const auto& [a, b, m, radius, length, parameter, width_a, width_b, numbers] = columns;
    const bool tapers = !element.widths.empty();
    const double width = tapers ? std::min(width_a, width_b) : element.width;
    field.shape[i] = field_shape_of(element);
    if (tapers) {
        field.width_a[i] = width_a;
        field.width_b[i] = width_b;
        field.width_of_all[i] = element.width;
    }
    field.kernel[i] = element.kernel;
    field.strength[i] = element.strength;
    field.width[i] = width;
    field.ax[i] = a.x;
    field.ay[i] = a.y;
    field.az[i] = a.z;
    field.bx[i] = b.x;
    field.by[i] = b.y;
    field.bz[i] = b.z;
    field.radius[i] = radius;
    field.mx[i] = m.x;
    field.my[i] = m.y;
    field.mz[i] = m.z;
    field.parameter[i] = parameter;
    field.length[i] = length;
    field.inverse_width[i] = 1 / width;
    field.inverse_square[i] = 1 / (width * width);
}

// What parts have in numbers, in a row.
class NumberRows {
  public:
    explicit NumberRows(std::size_t elements) : first_(elements, 0) {}
    void add(std::size_t i, std::span<const double> numbers) {
        first_[i] = static_cast<std::int32_t>(all_.size());
        all_.insert(all_.end(), numbers.begin(), numbers.end());
    }
    // Any offset may be read from.
    void move_to(Field& field) {
        all_.resize(all_.size() + most_part_numbers);
        field.numbers = std::move(all_);
        field.numbers_first = std::move(first_);
    }

  private:
    std::vector<double> all_;
    std::vector<std::int32_t> first_;
};

// Those of some elements by others.
void replace_numbers(Field& field, const std::map<std::size_t, std::vector<double>>& by) {
    NumberRows rows(field.size());
    for (std::size_t i = 0; i < field.size(); ++i) {
        if (!has_numbers(field.shape[i])) continue;
        if (const auto found = by.find(i); found != by.end()) {
            rows.add(i, found->second);
        } else {
            const std::size_t count = with_field_shape(field.shape[i], [&]<class S>() {
                if constexpr (S::has_numbers)
                    return S::size_of(field.columns(i));
                else
                    return std::size_t{0};
            });
            rows.add(i, field.numbers_of(i).first(count));
        }
    }
    rows.move_to(field);
}

// The same for lanes of float.
void put_numbers_in_units(Field& field) {
    field.numbers_in_units.assign(field.numbers.size(), 0);
    const double per_unit = 1 / field.unit;
    for (std::size_t i = 0; i < field.size(); ++i) {
        with_field_shape(field.shape[i], [&]<class S>() {
            if constexpr (S::has_numbers) {
                const SkeletonColumns columns = field.columns(i);
                const std::size_t count = S::size_of(columns);
                float* const to = field.numbers_in_units.data() +
                                  static_cast<std::size_t>(field.numbers_first[i]);
                for (std::size_t k = 0; k < count; ++k) {
                    to[k] = S::in_units(columns, k, columns.numbers[k], per_unit);
                }
            }
        });
    }
}

void put_color(Field& field, std::size_t i, const Color& color) {
    field.color[i] = color;
    field.red[i] = static_cast<float>(color.x);
    field.green[i] = static_cast<float>(color.y);
    field.blue[i] = static_cast<float>(color.z);
}

void look_for_one_color(Field& field) {
    field.one_color = std::all_of(field.color.begin(), field.color.end(),
                                  [&](const Color& c) { return c == field.color.front(); });
}

// What follows from threshold and elements, but for clusters and boxes.
void sum_up(Field& field) {
    // Any number serves as a cut; what the kernel is there is enclosed where it is used. A finite
    // support ends at 1.
    const double share = field.threshold * 0x1p-50 / static_cast<double>(field.size());
    double of_strength = 0, minus_log = 0;  // neighbours are often equally strong
    for (std::size_t i = 0; i < field.size(); ++i) {
        const double strength = std::abs(field.strength[i]);
        if (strength != of_strength) {
            const double least = share / strength;
            of_strength = strength;
            minus_log = least < 1 ? std::min(-std::log(least), 700.0) : 0;
        }
        field.cut[i] = with_kernel(field.kernel[i], [&]<class K>() {
            if constexpr (K::ends)
                return 1.0;
            else
                return K::level(minus_log);
        });
    }
    field.least_width =
        field.width.empty() ? 1 : *std::min_element(field.width.begin(), field.width.end());
    field.greatest_width =
        field.width.empty() ? 1 : *std::max_element(field.width.begin(), field.width.end());
    field.greatest_size = 0;
    for (std::size_t i = 0; i < field.size(); ++i) {
        field.greatest_width = std::max(field.greatest_width, field.greatest_width_of(i));
        field.greatest_size =
            std::max(field.greatest_size, std::max(field.length[i], field.radius[i]));
    }
    field.compact = is_compact(field);
    field.unit = field.scale = 1;
    field.suits_float = false;
    field.numbers_in_units.clear();
    if (!field.compact) return;
    constexpr double most_in_float = 0x1p9;
    int exponent = 0;
    std::frexp(field.threshold, &exponent);
    field.scale = std::ldexp(1.0, -exponent);
    std::frexp(field.greatest_width, &exponent);
    field.unit = std::ldexp(1.0, exponent - 1);
    if (!field.numbers.empty()) put_numbers_in_units(field);
    field.suits_float = field.greatest_width < most_in_float * field.least_width &&
                        field.greatest_size < most_in_float * field.greatest_width;
}

void put_boxes(Field& field, int threads) {
    field.skeletons = {};
    std::mutex mutex;
    for_ranges(field.size(), threads, least_range, [&](std::size_t first, std::size_t end) {
        Box3 box;
        for (std::size_t i = first; i < end; ++i) box.include(skeleton_box(field, i));
        const std::lock_guard lock(mutex);
        field.skeletons.include(box);
    });
    field.reach_box = box_of_reach(field);
    field.box = shrunk_box(field, field.reach_box);
}

bool same_numbers(const Element& a, const Element& b) {
    return a.skeleton == b.skeleton && a.strength == b.strength && a.width == b.width &&
           a.widths == b.widths;
}

}  // namespace

namespace {

Field compile_as_it_is(const Scene& scene, int threads) {
    Field field;
    field.threshold = scene.threshold;
    std::array<std::vector<std::uint32_t>, field_groups> groups;
    std::size_t visible = 0;  // parts
    std::map<std::uint32_t, Parts> with_numbers;
    for (std::size_t i = 0; i < scene.elements.size(); ++i) {
        const Element& element = scene.elements[i];
        if (!element.visible) continue;
        const Shape shape = field_shape_of(element);
        groups[group_of(shape, element.kernel)].push_back(static_cast<std::uint32_t>(i));
        if (has_numbers(shape)) {
            visible +=
                with_numbers.emplace(static_cast<std::uint32_t>(i), element).first->second.count();
        } else {
            visible += Parts::count_of(element);
        }
    }
    make_room(field, visible);
    const bool tapers = std::any_of(scene.elements.begin(), scene.elements.end(),
                                    [](const Element& e) { return !e.widths.empty(); });
    if (tapers) {
        for (auto* column : {&field.width_a, &field.width_b, &field.width_of_all}) {
            column->resize(visible);
        }
    }
    std::vector<std::uint32_t> part(visible);
    std::size_t count = 0;
    for (std::size_t group = 0; group < field_groups; ++group) {
        if (groups[group].empty()) continue;
        field.first.begin(group, count);
        if (visible >= least_clustered) sort_by_place(scene, threads, groups[group]);
        for (const std::uint32_t element : groups[group]) {
            const auto found = with_numbers.find(element);
            const std::size_t parts = found != with_numbers.end()
                                          ? found->second.count()
                                          : Parts::count_of(scene.elements[element]);
            for (std::uint32_t k = 0; k < parts; ++k) {
                field.source[count] = element;
                part[count++] = k;
            }
        }
    }
    field.first.end(count);
    for_ranges(visible, threads, least_range, [&](std::size_t first, std::size_t end) {
        for (std::size_t i = first; i < end; ++i) {
            const Element& element = scene.elements[field.source[i]];
            const auto found = with_numbers.find(field.source[i]);
            put(field, i, element,
                found != with_numbers.end() ? found->second[part[i]]
                                            : Parts::columns_of(element, part[i]));
            put_color(field, i, element.color);
        }
    });
    if (!with_numbers.empty()) {
        NumberRows rows(visible);
        for (std::size_t i = 0; i < visible; ++i) {
            const auto found = with_numbers.find(field.source[i]);
            if (found != with_numbers.end()) rows.add(i, found->second.numbers(part[i]));
        }
        rows.move_to(field);
    }
    look_for_one_color(field);
    sum_up(field);
    field.clusters = clusters_of(field, threads);
    put_boxes(field, threads);
    return field;
}

}  // namespace

Field compile(const Scene& scene, int threads) {
    Field field = compile_as_it_is(scene, threads);
    field.exponent_to_middle = exponent_to_middle(scene);
    if (field.exponent_to_middle != 0) {
        field.middle = std::make_shared<const Field>(
            compile_as_it_is(in_middle(scene, field.exponent_to_middle), threads));
    }
    return field;
}

Refit refit(Field& field, const Scene& before, const Scene& after) {
    constexpr std::size_t most_in_clusters = 64;
    if (before.elements.size() != after.elements.size()) return Refit::impossible;
    if (field.middle != nullptr || exponent_to_middle(after) != 0) return Refit::impossible;
    std::vector<std::uint32_t> changed;  // in the scene
    bool is_moved = false;
    for (std::size_t i = 0; i < after.elements.size(); ++i) {
        const Element &old = before.elements[i], &element = after.elements[i];
        if (old.visible != element.visible) return Refit::impossible;
        if (!element.visible) continue;
        if (old.kernel != element.kernel || field_shape_of(old) != field_shape_of(element)) {
            return Refit::impossible;
        }
        if (same_numbers(old, element) && old.color == element.color) continue;
        if (Parts(old).count() != Parts(element).count()) return Refit::impossible;
        changed.push_back(static_cast<std::uint32_t>(i));
        if (field.clusters.empty()) continue;
        if (changed.size() > most_in_clusters) return Refit::impossible;
        is_moved = is_moved || place_of(old) != place_of(element);
    }

    if (changed.empty() && before.threshold == after.threshold) return Refit::as_compiled;

    field.threshold = after.threshold;
    std::vector<std::uint32_t> indices;  // in the field
    std::size_t part = 0;
    std::optional<Parts> parts;  // of the element that these are of
    std::map<std::size_t, std::vector<double>> numbers;
    for (std::size_t i = 0; i < field.size() && !changed.empty(); ++i) {
        const std::uint32_t source = field.source[i];
        if (!std::binary_search(changed.begin(), changed.end(), source)) continue;
        part = i > 0 && field.source[i - 1] == source ? part + 1 : 0;
        if (part == 0) parts.emplace(after.elements[source]);
        put(field, i, after.elements[source], (*parts)[part]);
        if (has_numbers(field.shape[i])) numbers[i] = parts->numbers(part);
        put_color(field, i, after.elements[source].color);
        indices.push_back(static_cast<std::uint32_t>(i));
    }
    if (!numbers.empty()) replace_numbers(field, numbers);
    look_for_one_color(field);
    const auto as_floats = [&] {
        return std::tuple(field.compact, field.unit, field.scale, field.suits_float);
    };
    const auto floats_before = as_floats();
    sum_up(field);
    if (as_floats() == floats_before) {
        constexpr std::uint32_t none = ~std::uint32_t{0};
        std::uint32_t fitted = none;  // parts of an element share clusters
        for (const std::uint32_t i : indices) {
            if (field.clusters.empty()) break;
            const std::uint32_t cluster = field.clusters.of(i);
            if (cluster != fitted) fit(field, cluster, field.clusters);
            fitted = cluster;
        }
    } else {
        field.clusters = clusters_of(field, 1);
    }
    put_boxes(field, 1);
    return is_moved ? Refit::stretched : Refit::as_compiled;
}

std::vector<std::uint32_t> recolor(Field& field, const Scene& scene) {
    std::vector<std::uint32_t> changed;
    const bool was_one_color = field.one_color;
    for (std::size_t i = 0; i < field.size(); ++i) {
        const Color& color = scene.elements[field.source[i]].color;
        if (field.color[i] == color) continue;
        changed.push_back(static_cast<std::uint32_t>(i));
        put_color(field, i, color);
    }
    look_for_one_color(field);
    if (field.one_color != was_one_color) {
        // Mixing equal colours rounds: it is not the colour itself.
        changed.resize(field.size());
        std::iota(changed.begin(), changed.end(), 0U);
    }
    if (field.middle != nullptr) {
        Field middle = *field.middle;
        recolor(middle, scene);
        field.middle = std::make_shared<const Field>(std::move(middle));
    }
    return changed;
}

}  // namespace ivory
