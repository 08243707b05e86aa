// Places in the window: frame-buffer pixels, origin at the top left, x to the right, y down.
#pragma once

namespace ivory {

// Pixel (i, j) covers [i, i + 1) x [j, j + 1).
struct WindowPoint {
    double x = 0, y = 0;
    friend bool operator==(const WindowPoint&, const WindowPoint&) = default;
};

struct WindowSize {
    int width = 0, height = 0;
    friend bool operator==(const WindowSize&, const WindowSize&) = default;
};

struct WindowRect {
    int x = 0, y = 0, width = 0, height = 0;

    [[nodiscard]] bool contains(WindowPoint p) const {
        return p.x >= x && p.x < x + width && p.y >= y && p.y < y + height;
    }
    [[nodiscard]] WindowSize size() const { return {width, height}; }
    friend bool operator==(const WindowRect&, const WindowRect&) = default;
};

}  // namespace ivory
