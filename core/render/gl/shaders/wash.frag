// A colourwash over what a plane shows.
#include "corners.glsl"
#include "wash.glsl"
in vec3 at;
out vec4 result;
void main() {
    result = wash_at(at);
    if (result.a <= 0.0) discard;
}
