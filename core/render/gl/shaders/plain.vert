// A polygon in one colour.
layout(location = 0) in vec3 position;
uniform mat4 clip_from_lps;
uniform vec4 color;
uniform float opacity;
out vec4 shade;
void main() { shade = vec4(color.rgb, opacity); gl_Position = clip_from_lps * vec4(position, 1.0); }
