#include "core/field/active_elements.h"

#include <algorithm>
#include <bit>

namespace ivory {

void ActiveElements::take(const GroupStarts& groups, std::span<const std::uint32_t> elements) {
    make_room(elements.size());
    is_whole = true;
    std::copy(elements.begin(), elements.end(), element.begin());
    first.clear();
    auto from = elements.begin();
    for (std::uint64_t left = groups.present(); left != 0; left &= left - 1) {
        const auto group = static_cast<std::size_t>(std::countr_zero(left));
        first.begin(group, static_cast<std::size_t>(from - elements.begin()));
        from = std::lower_bound(from, elements.end(), groups.range(group).end);
    }
    end(elements.size());
}

void ActiveElements::take_members(const Clusters& clusters, const ActiveElements& of) {
    make_room(of.size() * cluster_size);
    is_whole = true;
    std::size_t count = 0;
    first.clear();
    for (std::uint64_t left = of.first.present(); left != 0; left &= left - 1) {
        const auto group = static_cast<std::size_t>(std::countr_zero(left));
        const auto [begin, last] = of.first.range(group);
        first.begin(group, count);
        for (std::size_t i = begin; i < last; ++i) {
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
    for (auto* values : {&least, &most, &peak, &whole, &piece_middle, &piece_half, &inverse}) {
        values->assign(size, 0.0);
    }
}

void ActiveElements::take(const LocalElements& near, std::size_t i, double unit) {
    const std::size_t count = size();
    element[count] = near.element[i];
    least[count] = double{near.least[i]};
    most[count] = double{near.most[i]};
    peak[count] = double{near.peak[i]};
    whole[count] = double{near.whole[i]};
    piece_middle[count] = double{near.mx[i]};
    piece_half[count] = double{near.my[i]};
    is_whole = false;
    inverse[count] = double{near.inverse[i]} / unit;
    first.end(count + 1);
}

void ActiveElements::end(std::size_t count) {
    first.end(count);
    std::fill_n(element.begin() + static_cast<std::ptrdiff_t>(count), room, 0);
}

}  // namespace ivory
