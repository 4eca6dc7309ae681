// Blends the translucent layers, the farthest first: in the order of the layers if rank_depth is 0, else by depth at each
// sample. Alpha of the result is the share of the picture below that still shows, for blending.
uniform sampler2DArray source;
uniform sampler2DArray depths;
uniform sampler2D before; // depth of what is opaque
uniform int n_layers;
uniform float rank_depth;
out vec4 result;
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    float opaque = texelFetch(before, at, 0).r, last = 2.0;
    int last_layer = -1;
    result = vec4(0.0, 0.0, 0.0, 1.0);
    for (int n = 0; n < n_layers; n++) {
        float most = -1.0;
        int farthest = -1;
        for (int i = rank_depth > 0.0 ? 0 : last_layer + 1; i < n_layers; i++) {
            float depth = texelFetch(depths, ivec3(at, i), 0).r;
            if (depth >= opaque) continue;
            if (rank_depth <= 0.0) { farthest = i; break; }
            depth -= rank_depth * float(i);
            if (depth > most && (depth < last || (depth == last && i > last_layer))) { most = depth; farthest = i; }
        }
        if (farthest < 0) break;
        vec4 over = texelFetch(source, ivec3(at, farthest), 0);
        result = vec4(mix(result.rgb, over.rgb, over.a), result.a * (1.0 - over.a));
        last = most;
        last_layer = farthest;
    }
    if (last_layer < 0) discard;
}
