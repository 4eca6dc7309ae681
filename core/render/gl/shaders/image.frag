// A slice of an image: window and level. LINEAR: interpolated between voxels. COLORS: with colour maps, and a second
// image over it.
uniform sampler3D source;
uniform vec2 grey; // grey = texture value * x + y
uniform vec2 ends; // the levels that grey 0 and 1 are drawn with
uniform float tone;
uniform float cull; // as grey: not drawn below it
in vec3 at;
out vec4 result;

#include "tone.glsl"

#if LINEAR
#include "corners.glsl"
#include "linear.glsl"
float value_at(sampler3D grid, vec3 place) { return linear_at(grid, place); }
#else
float value_at(sampler3D grid, vec3 place) { return texture(grid, place).r; }
#endif

float level_of(float value, vec2 scale, vec2 range, float power) {
    return toned(mix(range.x, range.y, clamp(value * scale.x + scale.y, 0.0, 1.0)), power);
}

#if COLORS
uniform sampler2D palette; // colours by level: row 0 of the image, row 1 of the second
uniform sampler3D second;
uniform mat4 second_from_at; // from `at` to the same of the second image's grid
uniform vec2 second_grey;
uniform vec2 second_ends;
uniform float second_tone;
uniform float part; // of the second image in the mixed colour; 0: there is none

vec3 color_of(float level, int row) {
    return texelFetch(palette, ivec2(int(level * 255.0 + 0.5), row), 0).rgb;
}
#endif

void main() {
    float value = value_at(source, at);
    if (isnan(value) || isinf(value)) discard;
    if (value * grey.x + grey.y < cull)
        discard;
    float level = level_of(value, grey, ends, tone);
#if COLORS
    vec3 color = color_of(level, 0), place = (second_from_at * vec4(at, 1.0)).xyz;
    if (part > 0.0 && all(greaterThanEqual(place, vec3(0.0))) && all(lessThanEqual(place, vec3(1.0)))) {
        float over = value_at(second, place);
        if (!isnan(over) && !isinf(over))
            color += (color_of(level_of(over, second_grey, second_ends, second_tone), 1) - color) * part;
    }
    result = vec4(max(color, DARKEST_GREY), 1.0);
#else
    result = vec4(max(vec3(level), DARKEST_GREY), 1.0);
#endif
}
