#version 330 core
// A picture of fewer pixels, filtered, and over it the tiles of the final one that are there, each by its
// share.
uniform sampler2D picture;  // pixel for pixel, as frame.frag has it
uniform sampler2D coarse;   // sRGB, so that its texels are mixed as light
uniform sampler2D shares;   // one texel for each tile of 16 x 16 pixels: how much of it is seen
uniform vec2 size;          // of the picture in pixels
uniform vec2 coarse_size;   // the same height and middle

in vec2 place;

layout(location = 0) out vec4 color;

vec3 srgb(vec3 light) {
    vec3 curved = 1.055 * pow(light, vec3(1.0 / 2.4)) - 0.055;
    return mix(12.92 * light, curved, step(0.0031308, light));
}

void main() {
    vec2 from_middle = (place - 0.5 * size) * (coarse_size.y / size.y);
    vec3 below = srgb(texture(coarse, 0.5 + from_middle / coarse_size).rgb);
    ivec2 pixel = ivec2(place);
    float share = texelFetch(shares, pixel / 16, 0).r;
    color = vec4(mix(below, texelFetch(picture, pixel, 0).rgb, share), 1.0);
}
