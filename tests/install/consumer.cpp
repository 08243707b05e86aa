// Uses installed headers and the library.
#include <string_view>

#include "core/scene/scene.h"

int main() {
    ivory::Scene scene;
    scene.elements.push_back({.skeleton = ivory::PointSkeleton{{0, 0, 0}}});
    return std::string_view(ivory::element_names(scene).at(0)) == "point 1" ? 0 : 1;
}
