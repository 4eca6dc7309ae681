// A surface shaded by triangle normals, which are computed from the derivatives of the position.
#include "light.glsl"
#ifdef TEXTURED
#include "corners.glsl"
#include "wash.glsl"
#include "linear.glsl"
#include "tone.glsl"
#include "texture.glsl"
#endif
uniform mat3 eye_from_lps;
uniform float rounding;
in vec3 towards;
in vec3 place;
in vec4 rounded;
out vec4 result;
void main() {
    vec3 n = normalize(cross(dFdx(place), dFdy(place)));
    float facing = dot(n, normalize(towards));
    if (facing < 0.0) n = -n; // the visible side of the triangle
    result = mix(light(eye_from_lps * n, min(abs(facing), 1.0)), rounded, rounding);
#ifdef TEXTURED
    result = textured(result, place);
#endif
}
