// A triangle from one point of a plane to a segment of an outline in it; an instance is a segment. Of the triangles to all
// segments an odd number covers what is inside the outlines.
layout(location = 0) in vec3 first;
layout(location = 1) in vec3 second;
uniform mat4 clip_from_lps;
uniform vec4 anchor;
out vec4 shade;
void main() {
    vec3 p = gl_VertexID == 0 ? anchor.xyz : gl_VertexID == 1 ? first : second;
    shade = vec4(0.0);
    gl_Position = clip_from_lps * vec4(p, 1.0);
}
