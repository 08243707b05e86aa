#version 330 core
// The traced picture, pixel for pixel: texel (i, j), counted from the top left, lands on pixel (i, j)
// of the viewport, unfiltered, so that what is seen is byte for byte what `ivory render` writes.
uniform sampler2D picture;
uniform vec2 size;          // of the picture in pixels; 0, 0 where there is none yet
uniform vec2 top_left;      // of the picture in the frame buffer, in pixels from the bottom left
uniform vec4 surroundings;  // where the picture does not reach (a window that has just grown)

layout(location = 0) out vec4 color;

void main() {
    vec2 place = vec2(gl_FragCoord.x - top_left.x, top_left.y - gl_FragCoord.y);
    bool inside = all(greaterThan(place, vec2(0.0))) && all(lessThan(place, size));
    color = inside ? vec4(texelFetch(picture, ivec2(place), 0).rgb, 1.0) : surroundings;
}
