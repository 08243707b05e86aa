#include "app/viewer/same_picture.h"

#include <algorithm>

namespace ivory {

bool looks_the_same(const Element& a, const Element& b) {
    if (!a.visible && !b.visible) return true;
    return a.visible == b.visible && a.skeleton == b.skeleton && a.color == b.color &&
           a.kernel == b.kernel && a.strength == b.strength && a.width == b.width &&
           a.widths == b.widths;
}

bool same_picture(const Scene& a, const Scene& b) {
    if (a.threshold != b.threshold || a.background != b.background) return false;
    if (a.lights != b.lights &&
        a.lights.value_or(default_lights()) != b.lights.value_or(default_lights()))
        return false;
    const auto hidden = [](const Element& element) { return !element.visible; };
    auto p = a.elements.begin(), q = b.elements.begin();
    while (true) {
        p = std::find_if_not(p, a.elements.end(), hidden);
        q = std::find_if_not(q, b.elements.end(), hidden);
        if (p == a.elements.end() || q == b.elements.end())
            return p == a.elements.end() && q == b.elements.end();
        if (!looks_the_same(*p++, *q++)) return false;
    }
}

}  // namespace ivory
