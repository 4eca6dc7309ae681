// A surface shaded by triangle normals. rounding: share of the shading by vertex normals (visible.h).
#include "light.glsl"
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
uniform mat4 clip_from_lps;
uniform mat3 eye_from_lps;
uniform vec4 viewer;
uniform float rounding;
out vec3 towards; // linear over a triangle in perspective; its derivatives are the triangle's plane
out vec3 place;
out vec4 rounded;
void main() {
    towards = viewer.xyz - viewer.w * position;
    place = position;
    rounded = vec4(0.0);
    if (rounding > 0.0) rounded = light(eye_from_lps * normal, clamp(dot(normal, normalize(towards)), 0.0, 1.0));
    gl_Position = clip_from_lps * vec4(position, 1.0);
}
