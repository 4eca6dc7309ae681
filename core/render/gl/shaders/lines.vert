// Lines: an instance is a segment, laid out as a rectangle square to the picture, as core/render/soft/quads.c does.
// half_view: half the size of the picture, half_size: half the width of a line, in samples. DARKEST, LINE_DEPTH: program.c.
#include "clips.glsl"
layout(location = 0) in vec3 first;
layout(location = 1) in vec3 second;
uniform mat4 clip_from_lps;
uniform vec2 half_view;
uniform float half_size;
uniform vec4 color;
uniform float opacity;
uniform vec4 cue; // darker away from the viewer: visible_depth_cue
out vec4 shade;
float cue_at(vec3 p) { return clamp(dot(cue.xyz, p) + cue.w, DARKEST, 1.0); }
void main() {
    vec3 p = first, q = second;
    shade = vec4(color.rgb * (cue_at(first) + cue_at(second)) * 0.5, opacity);
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0); // outside the view: not drawn
    for (int i = 0; i < n_clips; i++) {
        float kp = kept(i, p), kq = kept(i, q);
        if (kp < 0.0 && kq < 0.0) return;
        vec3 met = mix(p, q, kp / (kp - kq));
        if (kp < 0.0) p = met;
        if (kq < 0.0) q = met;
    }
    vec4 a = clip_from_lps * vec4(p, 1.0), b = clip_from_lps * vec4(q, 1.0), uncut = a;
    float fa = a.z + a.w, fb = b.z + b.w;
    if (fa < 0.0 && fb < 0.0) return;
    if (fa < 0.0) a = mix(a, b, fa / (fa - fb));
    if (fb < 0.0) b = mix(uncut, b, fa / (fa - fb));
    if (a.w <= 0.0 || b.w <= 0.0) return;
    vec2 s = a.xy / a.w * half_view, t = b.xy / b.w * half_view, along = t - s;
    float size = length(along);
    along = size > 1e-6 ? along / size * half_size : vec2(half_size, 0.0);
    vec2 across = (gl_VertexID & 1) == 0 ? vec2(-along.y, along.x) : vec2(along.y, -along.x);
    bool is_second = gl_VertexID > 1;
    float z = is_second ? b.z / b.w : a.z / a.w;
    gl_Position = vec4((is_second ? t + along + across : s - along + across) / half_view, max(z - 2.0 * LINE_DEPTH, -1.0), 1.0);
}
