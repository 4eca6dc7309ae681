// A surface shaded by vertex normals, at the vertices: a surface made of voxels has triangles of a few pixels, and on a
// software rasteriser a fragment costs as much as a vertex.
// viewer: in perspective the eye and 1, in parallel projection the direction towards the viewer and 0.
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
uniform int is_two_sided;
out vec4 shade;
#ifdef TEXTURED
out vec3 place;
#endif
void main() {
    vec3 towards = normalize(viewer.xyz - viewer.w * position);
    float cosine = dot(normal, towards), side = is_two_sided != 0 && cosine < 0.0 ? -1.0 : 1.0; // the side that is seen
    shade = light(eye_from_lps * (side * normal), clamp(side * cosine, 0.0, 1.0));
    gl_Position = clip_from_lps * vec4(position, 1.0);
#ifdef TEXTURED
    place = position;
#endif
#ifdef CLIPPED
    for (int i = 0; i < 8; i++) gl_ClipDistance[i] = i < n_clips ? kept(i, position) : 1.0;
#endif
}
