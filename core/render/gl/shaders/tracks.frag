// A sample of a line of a track. FAR: program.c.
uniform vec2 half_view;
uniform vec4 cut_rows[8]; // by clip plane, applied to a sample's place and depth -1 .. 1: not negative where it is kept
uniform int n_clips;
flat in vec4 line;
flat in vec4 paint;
flat in vec4 dash;
noperspective in float along;
out vec4 result;
void main() {
    float at = clamp(along, 0.0, paint.w), part = at / max(paint.w, 1e-6);
    float depth = mix(line.x, line.y, part);
    if (dash.x > 0.0 && fract(at * dash.x) > dash.y) discard;
    vec4 here = vec4(gl_FragCoord.xy / half_view - 1.0, depth, 1.0);
    for (int i = 0; i < n_clips; i++)
        if (dot(cut_rows[i], here) < 0.0) discard;
    gl_FragDepth = clamp(0.5 * depth + 0.5, 0.0, FAR);
    result = vec4(paint.rgb * mix(line.z, line.w, part), 1.0);
}
