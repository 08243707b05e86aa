#version 330 core
// Two triangles, a strip, that cover the picture.
uniform vec2 size;  // of the picture in pixels

out vec2 place;  // in the picture, in pixels from its top left

void main() {
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    place = corner * size;
    gl_Position = vec4(2.0 * corner.x - 1.0, 1.0 - 2.0 * corner.y, 0.0, 1.0);
}
