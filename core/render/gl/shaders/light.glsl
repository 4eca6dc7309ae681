// The light on a surface: a key light from the upper right, a weak fill from the left, a soft rim; translucency as
// proto/scene.json says. core/render/soft/light.h has the same light.
// n: the normal in eye space (x right, y up, z towards the viewer); facing: its cosine with the line of sight.
uniform vec4 color;
uniform float opacity;
uniform int is_rim;
// The factor on the colour, and the gloss that is added to it.
vec2 light_terms(vec3 n, float facing, float ambient) {
    float edge = 1.0 - facing;
    float key = max(dot(n, vec3(0.426, 0.568, 0.704)), 0.0);
    float fill = max(dot(n, vec3(-0.741, 0.106, 0.663)), 0.0);
    float gloss = key * key; gloss *= gloss; gloss *= gloss; gloss *= gloss;
    return vec2(ambient + 0.58 * key + 0.18 * fill + 0.24 * edge * edge, 0.07 * gloss);
}
vec4 light(vec3 n, float facing) {
    float edge = 1.0 - facing;
    float ambient = opacity < 1.0 ? 0.5 : 0.3; // translucent surfaces over black need more light to be seen
    vec2 terms = light_terms(n, facing, ambient);
    vec3 lit = color.rgb * terms.x + terms.y;
    float alpha = is_rim != 0 ? opacity * (0.3 + 1.82 * pow(edge, 1.8)) : opacity;
    return vec4(min(lit, 1.0), min(alpha, 1.0));
}
