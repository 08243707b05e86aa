#version 330 core
// The traced picture, pixel for pixel: texel (i, j), counted from the top left, lands on pixel (i, j)
// of the viewport, unfiltered, so that what is seen is byte for byte what `ivory render` writes. The
// middle of a pixel is interpolated to far less than the half by which its texel may be missed.
uniform sampler2D picture;

in vec2 place;

layout(location = 0) out vec4 color;

void main() {
    color = vec4(texelFetch(picture, ivec2(place), 0).rgb, 1.0);
}
