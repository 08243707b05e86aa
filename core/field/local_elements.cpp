#include "core/field/local_elements.h"

namespace ivory {

void LocalElements::make_room(std::size_t count) {
    if (element.size() >= count + room) return;
    const std::size_t size = count + count / 2 + room;
    element.assign(size, 0);
    source.assign(size, 0);
    for (auto* values : {&x, &y, &z, &strength, &inverse_square, &mx, &my, &mz, &parameter, &length,
                         &taper_rate, &least, &most, &peak, &whole, &inverse}) {
        values->assign(size, 0.0F);
    }
}

}  // namespace ivory
