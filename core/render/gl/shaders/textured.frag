// The interpolated colour of the vertices, with the shape's texture.
#include "corners.glsl"
#include "wash.glsl"
#include "linear.glsl"
#include "tone.glsl"
#include "texture.glsl"
in vec4 shade;
in vec3 place;
out vec4 result;
void main() { result = textured(shade, place); }
