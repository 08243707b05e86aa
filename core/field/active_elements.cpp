#include "core/field/active_elements.h"

#include <algorithm>

namespace ivory {

void ActiveElements::take(const GroupStarts& groups, std::span<const std::uint32_t> elements) {
    make_room(elements.size());
    std::copy(elements.begin(), elements.end(), element.begin());
    for (std::size_t group = 0; group < field_groups; ++group) {
        first[group] = static_cast<std::uint32_t>(
            std::lower_bound(elements.begin(), elements.end(), groups[group]) - elements.begin());
    }
    end(elements.size());
}

void ActiveElements::take_members(const Clusters& clusters, const ActiveElements& of) {
    make_room(of.size() * cluster_size);
    std::size_t count = 0;
    for (std::size_t group = 0; group < field_groups; ++group) {
        first[group] = static_cast<std::uint32_t>(count);
        for (std::size_t i = of.first[group]; i < of.first[group + 1]; ++i) {
            const auto cluster = static_cast<std::size_t>(of.element[i]);
            for (std::uint32_t e = clusters.first[cluster]; e < clusters.first[cluster + 1]; ++e) {
                element[count++] = e;
            }
        }
    }
    end(count);
}

void ActiveElements::make_room(std::size_t count) {
    if (element.size() >= count + room) return;
    const std::size_t size = count + count / 2 + room;
    element.assign(size, 0);
    for (auto* values : {&least, &most, &peak, &inverse}) values->assign(size, 0.0);
}

void ActiveElements::take(const LocalElements& near, std::size_t i, double unit) {
    const std::size_t count = size();
    element[count] = near.element[i];
    least[count] = double{near.least[i]};
    most[count] = double{near.most[i]};
    peak[count] = double{near.peak[i]};
    inverse[count] = double{near.inverse[i]} / unit;
    ++first[field_groups];
}

void ActiveElements::end(std::size_t count) {
    first[field_groups] = static_cast<std::uint32_t>(count);
    std::fill_n(element.begin() + static_cast<std::ptrdiff_t>(count), room, 0);
}

}  // namespace ivory
