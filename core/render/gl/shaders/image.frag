// A slice of an image: window and level. LINEAR: interpolated between voxels. COLORS: with colour maps, and a second
// image over it.
uniform sampler3D source;
uniform vec2 grey; // grey = texture value * x + y
uniform vec2 ends; // the levels that grey 0 and 1 are drawn with
uniform float cull; // as grey: not drawn below it
in vec3 at;
out vec4 result;

#if LINEAR
// Samplers interpolate with weights of 8 bits on most cards, which is off by several grey levels; these weights are floats.
float value_at(sampler3D grid, vec3 place) {
    ivec3 size = textureSize(grid, 0);
    vec3 voxel = clamp(place * vec3(size) - 0.5, vec3(0.0), vec3(size - 1));
    ivec3 low = min(ivec3(voxel), max(size - 2, ivec3(0))), high = min(low + 1, size - 1);
    vec3 weight = voxel - vec3(low);
    vec4 along, along_high;
    along.x = texelFetch(grid, low, 0).r;
    along_high.x = texelFetch(grid, ivec3(high.x, low.yz), 0).r;
    along.y = texelFetch(grid, ivec3(low.x, high.y, low.z), 0).r;
    along_high.y = texelFetch(grid, ivec3(high.xy, low.z), 0).r;
    along.z = texelFetch(grid, ivec3(low.xy, high.z), 0).r;
    along_high.z = texelFetch(grid, ivec3(high.x, low.y, high.z), 0).r;
    along.w = texelFetch(grid, ivec3(low.x, high.yz), 0).r;
    along_high.w = texelFetch(grid, high, 0).r;
    along += (along_high - along) * weight.x;
    vec2 across = along.xz + (along.yw - along.xz) * weight.y;
    return across.x + (across.y - across.x) * weight.z;
}
#else
float value_at(sampler3D grid, vec3 place) { return texture(grid, place).r; }
#endif

float level_of(float value, vec2 scale, vec2 range) {
    return mix(range.x, range.y, clamp(value * scale.x + scale.y, 0.0, 1.0));
}

#if COLORS
uniform sampler2D palette; // colours by level: row 0 of the image, row 1 of the second
uniform sampler3D second;
uniform mat4 second_from_at; // from `at` to the same of the second image's grid
uniform vec2 second_grey;
uniform vec2 second_ends;
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
    float level = level_of(value, grey, ends);
#if COLORS
    vec3 color = color_of(level, 0), place = (second_from_at * vec4(at, 1.0)).xyz;
    if (part > 0.0 && all(greaterThanEqual(place, vec3(0.0))) && all(lessThanEqual(place, vec3(1.0)))) {
        float over = value_at(second, place);
        if (!isnan(over) && !isinf(over))
            color += (color_of(level_of(over, second_grey, second_ends), 1) - color) * part;
    }
    result = vec4(max(color, DARKEST_GREY), 1.0);
#else
    result = vec4(max(vec3(level), DARKEST_GREY), 1.0);
#endif
}
