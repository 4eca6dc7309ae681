// Particle tracks: an instance is a segment, laid out as struct draw_tracks says; part 0: its line, 1 and 2: the arms of its cross.
// half_view: half the size of the picture, half_size: half the width of a line, cross_size: half the side of a cross, in samples.
// The fragments find depth and cue by where they are along the line, so those of its square ends have the ends' own.
#include "clips.glsl"
layout(location = 0) in vec3 first;
layout(location = 1) in vec3 second;
layout(location = 2) in float kind; // enum track_class
layout(location = 3) in float energy; // not a number: none
uniform mat4 clip_from_lps;
uniform vec2 half_view;
uniform float half_size;
uniform float cross_size;
uniform vec4 cue;
uniform vec4 ahead; // mm beyond the nearest point that is drawn
uniform vec4 looks[8]; // by class: colour; 1 if it has a cross
uniform vec4 dashes[8]; // by class: periods in a sample, the part of them that is drawn
uniform int classes; // bit by class
uniform vec4 energies; // least and most, whether there are these limits
uniform bool is_thin;
uniform int part;
flat out vec4 line; // depth of both ends, light of both ends
flat out vec4 paint; // colour, length of the line
flat out vec4 dash; // of dashes
noperspective out float along;
float cue_at(vec3 p) { return clamp(dot(cue.xyz, p) + cue.w, DARKEST, 1.0); }
void main() {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0); // outside the view: not drawn
    int of = int(kind + 0.5);
    paint = looks[of];
    dash = dashes[of];
    along = 0.0;
    line = vec4(0.0);
    if ((classes >> of & 1) == 0 || (energies.z > 0.0 && energy < energies.x) || (energies.w > 0.0 && energy > energies.y)) return;
    vec3 p = first, q = second;
    bool has_end = true;
    for (int i = 0; i < n_clips; i++) {
        float kp = kept(i, p), kq = kept(i, q);
        if (kp <= 0.0 && kq <= 0.0) return;
        vec3 met = mix(p, q, kp / (kp - kq));
        if (kp < 0.0) p = met;
        if (kq < 0.0) { q = met; has_end = false; }
    }
    float ap = dot(ahead.xyz, p) + ahead.w, aq = dot(ahead.xyz, q) + ahead.w;
    if (ap < 0.0 && aq < 0.0) return;
    vec3 near = mix(p, q, ap / (ap - aq));
    if (ap < 0.0) p = near;
    if (aq < 0.0) { q = near; has_end = false; }
    vec4 a = clip_from_lps * vec4(p, 1.0), b = clip_from_lps * vec4(q, 1.0);
    vec2 s = a.xy / a.w * half_view, t = b.xy / b.w * half_view;
    line = vec4(a.z / a.w, b.z / b.w, cue_at(p), cue_at(q));
    if (part > 0) {
        if (paint.w == 0.0 || !has_end) return;
        vec2 arm = vec2(cross_size, part == 1 ? cross_size : -cross_size);
        s = t - arm;
        t = t + arm;
        line = line.yyww;
        dash = vec4(0.0);
    }
    vec2 d = t - s, forward, across;
    float size = length(d);
    if (is_thin) {
        bool is_tall = abs(d.y) > abs(d.x);
        float run = is_tall ? abs(d.y) : abs(d.x);
        vec2 axis = is_tall ? vec2(0.0, 0.5) : vec2(0.5, 0.0);
        forward = run > 1e-6 ? d / run * 0.5 : axis;
        across = axis.yx;
    } else {
        forward = size > 1e-6 ? d / size * half_size : vec2(half_size, 0.0);
        across = vec2(-forward.y, forward.x);
    }
    bool is_second = gl_VertexID > 1;
    if ((gl_VertexID & 1) == 0) across = -across;
    paint.w = size;
    along = is_second ? size + length(forward) : -length(forward);
    gl_Position = vec4((is_second ? t + forward : s - forward) / half_view + across / half_view, 0.0, 1.0);
}
