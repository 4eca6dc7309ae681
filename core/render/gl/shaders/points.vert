// Points: an instance is a rectangle square to the picture, as core/render/soft/quads.c lays it out.
// half_view: half the size of the picture, half_size: half the side of a point, in samples.
#include "light.glsl"
#include "clips.glsl"
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in float baked;
uniform mat4 clip_from_lps;
uniform mat3 eye_from_lps;
uniform vec4 viewer;
uniform vec2 half_view;
uniform float half_size;
uniform int is_covering; // as large as a voxel; else half_size
uniform int is_baked;
uniform int is_two_sided;
uniform vec4 edges[3]; // of a voxel, in clip space
out vec4 shade;
void main() {
    vec4 middle = clip_from_lps * vec4(position, 1.0);
    vec3 towards = normalize(viewer.xyz - viewer.w * position);
    vec3 n = dot(normal, normal) > 0.25 ? normal : towards; // a part one voxel thin has no normal
    if (is_two_sided != 0 && dot(n, towards) < 0.0) n = -n; // seen through an opened cut
    shade = is_baked != 0 ? vec4(color.rgb * baked, opacity) : light(eye_from_lps * n, clamp(dot(n, towards), 0.0, 1.0));
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0); // outside the view: not drawn
    if (middle.z + middle.w < 0.0 || middle.w <= 0.0) return;
    for (int i = 0; i < n_clips; i++)
        if (kept(i, position) < 0.0) return; // cut by its centre
    vec2 at = middle.xy / middle.w, size = vec2(half_size);
    if (is_covering != 0) {
        vec2 across = vec2(0.0);
        float depth = 0.0;
        for (int i = 0; i < 3; i++) {
            across += abs(edges[i].xy - at * edges[i].w) * 0.5;
            depth += abs(edges[i].w) * 0.5;
        }
        size = max(across / max(middle.w - depth, middle.w * 0.125) * half_view + 1.0 / 256.0, 0.5);
    }
    vec2 corner = vec2((gl_VertexID & 1) == 0 ? -1.0 : 1.0, gl_VertexID > 1 ? 1.0 : -1.0);
    gl_Position = vec4(at + corner * size / half_view, middle.z / middle.w, 1.0);
}
