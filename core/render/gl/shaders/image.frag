// A slice of an image: window and level.
uniform sampler3D source;
uniform vec2 grey; // grey = texture value * x + y
uniform vec2 ends; // the levels that grey 0 and 1 are drawn with
uniform float cull; // as grey: not drawn below it
in vec3 at;
out vec4 result;
void main() {
    float value = texture(source, at).r;
    if (isnan(value) || isinf(value)) discard;
    if (value * grey.x + grey.y < cull)
        discard;
    float level = mix(ends.x, ends.y, clamp(value * grey.x + grey.y, 0.0, 1.0));
    result = vec4(max(vec3(level), DARKEST_GREY), 1.0);
}
