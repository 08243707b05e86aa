#version 330 core
// Glyphs and plain colours; all of it is sRGB already, and so is the frame buffer.
uniform sampler2D atlas;

in vec2 fragment_place;
in vec4 fragment_color;

layout(location = 0) out vec4 color;

void main() {
    color = fragment_color * texture(atlas, fragment_place);
}
