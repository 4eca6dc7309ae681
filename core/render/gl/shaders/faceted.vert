// A surface shaded by triangle normals. rounding: share of the shading by vertex normals (visible.h).
#include "light.glsl"
#ifdef CLIPPED // a program of its own: what no plane cuts is not slowed down
#include "clips.glsl"
out float gl_ClipDistance[8];
#endif
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
uniform mat4 clip_from_lps;
uniform mat3 eye_from_lps;
uniform vec4 viewer;
uniform float rounding;
uniform int is_two_sided;
out vec3 towards; // linear over a triangle in perspective; its derivatives are the triangle's plane
out vec3 place;
out vec4 rounded;
void main() {
    towards = viewer.xyz - viewer.w * position;
    place = position;
    rounded = vec4(0.0);
    if (rounding > 0.0) {
        float cosine = dot(normal, normalize(towards)), side = is_two_sided != 0 && cosine < 0.0 ? -1.0 : 1.0;
        rounded = light(eye_from_lps * (side * normal), clamp(side * cosine, 0.0, 1.0));
    }
    gl_Position = clip_from_lps * vec4(position, 1.0);
#ifdef CLIPPED
    for (int i = 0; i < 8; i++) gl_ClipDistance[i] = i < n_clips ? kept(i, position) : 1.0;
#endif
}
