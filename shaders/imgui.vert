#version 330 core
// Dear ImGui's vertices: frame-buffer pixels from the top left, to clip space.
uniform vec2 display_size;

layout(location = 0) in vec2 position;
layout(location = 1) in vec2 texture_place;
layout(location = 2) in vec4 color;

out vec2 fragment_place;
out vec4 fragment_color;

void main() {
    fragment_place = texture_place;
    fragment_color = color;
    gl_Position = vec4(2.0 * position.x / display_size.x - 1.0,
                       1.0 - 2.0 * position.y / display_size.y, 0.0, 1.0);
}
