#include "app/panels/icons.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "app/shape/shapes.h"

namespace ivory {

namespace {

constexpr float pi = 3.14159265f;

// Coordinates from -1 to 1, x to the right and y down.
class Sketch {
  public:
    Sketch(ImDrawList& list, ImVec2 middle, float side, ImU32 color)
        : list_(list),
          middle_(middle),
          half_(0.5f * side),
          color_(color),
          width_(std::max(1.0f, side / 11)) {}

    void line(float x0, float y0, float x1, float y1) {
        list_.AddLine(at(x0, y0), at(x1, y1), color_, width_);
    }
    void circle(float x, float y, float r) {
        list_.AddCircle(at(x, y), r * half_, color_, 0, width_);
    }
    void disc(float x, float y, float r) { list_.AddCircleFilled(at(x, y), r * half_, color_); }
    void rect(float x0, float y0, float x1, float y1) {
        list_.AddRect(at(x0, y0), at(x1, y1), color_, 0.18f * half_, 0, width_);
    }
    // Angles from the right, clockwise.
    void arc(float x, float y, float r, float from, float to) {
        list_.PathArcTo(at(x, y), r * half_, from, to);
        list_.PathStroke(color_, 0, width_);
    }
    void half_disc(float x, float y, float r, float from, float to) {
        list_.PathArcTo(at(x, y), r * half_, from, to);
        list_.PathFillConvex(color_);
    }
    void ellipse(float rx, float ry) {
        constexpr int steps = 32;
        for (int i = 0; i < steps; ++i) {
            const float angle = 2 * pi * static_cast<float>(i) / steps;
            list_.PathLineTo(at(rx * std::cos(angle), ry * std::sin(angle)));
        }
        list_.PathStroke(color_, ImDrawFlags_Closed, width_);
    }
    // The outline of an eye: two arcs that meet at its corners.
    void lids() {
        constexpr int steps = 12;
        for (const float side : {-1.0f, 1.0f})
            for (int i = 0; i < steps; ++i) {
                const float x = side * (2 * static_cast<float>(i) / steps - 1);
                list_.PathLineTo(at(x, side * 0.62f * (1 - x * x)));
            }
        list_.PathStroke(color_, ImDrawFlags_Closed, width_);
    }
    void lower_lid() {
        constexpr int steps = 12;
        for (int i = 0; i <= steps; ++i) {
            const float x = 2 * static_cast<float>(i) / steps - 1;
            list_.PathLineTo(at(x, 0.5f * (1 - x * x) - 0.1f));
        }
        list_.PathStroke(color_, 0, width_);
    }

  private:
    [[nodiscard]] ImVec2 at(float x, float y) const {
        return {middle_.x + x * half_, middle_.y + y * half_};
    }

    ImDrawList& list_;
    ImVec2 middle_;
    float half_;
    ImU32 color_;
    float width_;
};

// A bent arrow back, mirrored for `redo`.
void turn_back(Sketch& s, float side) {
    s.line(-0.85f * side, -0.2f, -0.4f * side, -0.65f);
    s.line(-0.85f * side, -0.2f, -0.4f * side, 0.25f);
    s.line(-0.85f * side, -0.2f, 0.25f * side, -0.2f);
    if (side > 0) {
        s.arc(0.25f, 0.25f, 0.45f, -0.5f * pi, 0.5f * pi);
    } else {
        s.arc(-0.25f, 0.25f, 0.45f, 0.5f * pi, 1.5f * pi);
    }
    s.line(0.25f * side, 0.7f, -0.3f * side, 0.7f);
}

}  // namespace

void draw_icon(ImDrawList& list, Shape shape, ImVec2 middle, float side, ImU32 color) {
    Sketch s(list, middle, side, color);
    for (const Stroke& stroke : strokes_of(shape)) {
        switch (stroke.kind) {
            case Stroke::Kind::line:
                s.line(stroke.x0, stroke.y0, stroke.x1, stroke.y1);
                break;
            case Stroke::Kind::circle:
                s.circle(stroke.x0, stroke.y0, stroke.radius);
                break;
            case Stroke::Kind::disc:
                s.disc(stroke.x0, stroke.y0, stroke.radius);
                break;
        }
    }
}

void draw_icon(ImDrawList& list, Icon icon, ImVec2 middle, float side, ImU32 color) {
    Sketch s(list, middle, side, color);
    switch (icon) {
        case Icon::eye:
            s.lids();
            s.disc(0, 0, 0.3f);
            return;
        case Icon::eye_closed:
            s.lower_lid();
            s.line(-0.55f, 0.25f, -0.75f, 0.6f);
            s.line(0, 0.4f, 0, 0.8f);
            s.line(0.55f, 0.25f, 0.75f, 0.6f);
            return;
        case Icon::trash:
            s.line(-0.8f, -0.55f, 0.8f, -0.55f);
            s.line(-0.3f, -0.85f, 0.3f, -0.85f);
            s.line(-0.6f, -0.55f, -0.5f, 0.85f);
            s.line(0.6f, -0.55f, 0.5f, 0.85f);
            s.line(-0.5f, 0.85f, 0.5f, 0.85f);
            return;
        case Icon::copy:
            s.rect(-0.3f, -0.3f, 0.85f, 0.85f);
            s.line(-0.8f, 0.35f, -0.8f, -0.8f);
            s.line(-0.8f, -0.8f, 0.35f, -0.8f);
            return;
        case Icon::up:
            s.line(0, -0.7f, 0, 0.75f);
            s.line(0, -0.75f, -0.5f, -0.2f);
            s.line(0, -0.75f, 0.5f, -0.2f);
            return;
        case Icon::down:
            s.line(0, 0.7f, 0, -0.75f);
            s.line(0, 0.75f, -0.5f, 0.2f);
            s.line(0, 0.75f, 0.5f, 0.2f);
            return;
        case Icon::undo:
            turn_back(s, 1);
            return;
        case Icon::redo:
            turn_back(s, -1);
            return;
        case Icon::frame:
            for (const float x : {-1.0f, 1.0f})
                for (const float y : {-1.0f, 1.0f}) {
                    s.line(0.85f * x, 0.85f * y, 0.35f * x, 0.85f * y);
                    s.line(0.85f * x, 0.85f * y, 0.85f * x, 0.35f * y);
                }
            s.disc(0, 0, 0.26f);
            return;
        case Icon::orthographic:
            // a box whose edges do not converge
            s.rect(-0.85f, -0.3f, 0.3f, 0.85f);
            s.line(-0.85f, -0.3f, -0.3f, -0.85f);
            s.line(0.3f, -0.3f, 0.85f, -0.85f);
            s.line(0.3f, 0.85f, 0.85f, 0.3f);
            s.line(-0.3f, -0.85f, 0.85f, -0.85f);
            s.line(0.85f, -0.85f, 0.85f, 0.3f);
            return;
        case Icon::paste:
            s.rect(-0.65f, -0.6f, 0.65f, 0.85f);
            s.line(-0.3f, -0.85f, 0.3f, -0.85f);
            s.line(-0.3f, -0.85f, -0.3f, -0.35f);
            s.line(0.3f, -0.85f, 0.3f, -0.35f);
            s.line(-0.3f, -0.35f, 0.3f, -0.35f);
            return;
        case Icon::skeleton:
            s.line(-0.6f, 0.35f, 0, -0.5f);
            s.line(0, -0.5f, 0.65f, 0.4f);
            s.disc(-0.62f, 0.4f, 0.24f);
            s.disc(0, -0.52f, 0.24f);
            s.disc(0.66f, 0.42f, 0.24f);
            return;
        case Icon::theme:
            s.circle(0, 0, 0.75f);
            s.half_disc(0, 0, 0.75f, -0.5f * pi, 0.5f * pi);
            return;
        case Icon::cross:
            s.line(-0.55f, -0.55f, 0.55f, 0.55f);
            s.line(-0.55f, 0.55f, 0.55f, -0.55f);
            return;
        case Icon::plus:
            s.line(-0.65f, 0, 0.65f, 0);
            s.line(0, -0.65f, 0, 0.65f);
            return;
        case Icon::folder:
            s.line(-0.85f, -0.55f, -0.2f, -0.55f);
            s.line(-0.2f, -0.55f, 0, -0.3f);
            s.line(-0.85f, -0.55f, -0.85f, 0.65f);
            s.line(0, -0.3f, 0.85f, -0.3f);
            s.line(0.85f, -0.3f, 0.85f, 0.65f);
            s.line(-0.85f, 0.65f, 0.85f, 0.65f);
            return;
        case Icon::file:
            s.line(-0.55f, -0.85f, 0.2f, -0.85f);
            s.line(0.2f, -0.85f, 0.6f, -0.4f);
            s.line(0.6f, -0.4f, 0.6f, 0.85f);
            s.line(0.6f, 0.85f, -0.55f, 0.85f);
            s.line(-0.55f, 0.85f, -0.55f, -0.85f);
            return;
    }
}

}  // namespace ivory
