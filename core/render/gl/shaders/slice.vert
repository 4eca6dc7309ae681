// A polygon in a plane through a grid. at: 0 .. 1 over the outer faces of the grid.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 place;
uniform mat4 clip_from_lps;
out vec3 at;
void main() { at = place; gl_Position = clip_from_lps * vec4(position, 1.0); }
