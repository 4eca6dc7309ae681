// Colours the triangles of a shape (struct draw_texture in core/render/visible/draw.h). Needs wash.glsl, linear.glsl, tone.glsl.
uniform int is_washed; // else the image colours it
uniform sampler3D source;
uniform mat4 source_from_lps; // to 0 .. 1 over the image's outer faces
uniform vec2 grey; // grey = texture value * x + y
uniform vec2 ends; // the levels that grey 0 and 1 are drawn with
uniform float tone;
uniform int is_linear;
uniform sampler2D palette; // colours by level
uniform vec4 region_color;

// shade: the lit colour, of the image that of white. p: the patient point.
vec4 textured(vec4 shade, vec3 p) {
    if (is_washed != 0) {
        vec4 over = wash_at(p);
        return vec4(mix(shade.rgb, over.rgb, over.a), shade.a);
    }
    vec3 place = (source_from_lps * vec4(p, 1.0)).xyz, rgb = region_color.rgb;
    if (all(greaterThanEqual(place, vec3(0.0))) && all(lessThanEqual(place, vec3(1.0)))) {
        float value = is_linear != 0 ? linear_at(source, place) : texture(source, place).r;
        float level = toned(mix(ends.x, ends.y, clamp(value * grey.x + grey.y, 0.0, 1.0)), tone);
        if (is_number(value)) rgb = texelFetch(palette, ivec2(int(level * 255.0 + 0.5), 0), 0).rgb;
    }
    return vec4(shade.rgb * rgb, shade.a);
}
