// The light on a surface: a key light, a weak fill from the left, both of the scene (core/render/visible/lights.h), a soft
// rim; translucency as proto/scene.json says. core/render/soft/light.h has the same light.
// n: the normal in eye space (x right, y up, z towards the viewer); facing: its cosine with the line of sight.
uniform vec4 color;
uniform float opacity;
uniform int is_rim;
uniform vec4 key_light; // towards it in eye space; its light
uniform vec4 lights;    // of the fill, gloss, ambient, ambient on what is translucent
// The factor on the colour, and the gloss that is added to it.
vec2 light_terms(vec3 n, float facing, float ambient) {
    float edge = 1.0 - facing;
    float key = max(dot(n, key_light.xyz), 0.0);
    float fill = max(dot(n, vec3(-0.741, 0.106, 0.663)), 0.0);
    float gloss = key * key; gloss *= gloss; gloss *= gloss; gloss *= gloss;
    return vec2(ambient + key_light.w * key + lights.x * fill + 0.24 * edge * edge, lights.y * gloss);
}
vec4 light(vec3 n, float facing) {
    float edge = 1.0 - facing;
    vec2 terms = light_terms(n, facing, opacity < 1.0 ? lights.w : lights.z);
    vec3 lit = color.rgb * terms.x + terms.y;
    float alpha = is_rim != 0 ? opacity * (0.3 + 1.82 * pow(edge, 1.8)) : opacity;
    return vec4(min(lit, 1.0), min(alpha, 1.0));
}
