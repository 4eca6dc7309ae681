// Marked univels on a plane: stripes, and an edge along their border. DRAW_MARKS in core/render/visible/draw.h.
uniform usampler3D source;
uniform vec4 scale; // size of the grid in voxels
uniform vec4 color;
uniform vec4 stripes; // their part of the color, that of black between them, their period, the width of the edge; in samples
uniform int first_row; // of the band in the picture
in vec3 at;
out vec4 result;
bool is_marked(vec3 place) {
    vec3 voxel = floor(place * scale.xyz);
    return all(greaterThanEqual(voxel, vec3(0.0))) && all(lessThan(voxel, scale.xyz)) && texelFetch(source, ivec3(voxel), 0).r != 0u;
}
void main() {
    vec3 across = dFdx(at) * stripes.w, down = dFdy(at) * stripes.w;
    if (!is_marked(at)) discard;
    bool is_inner = is_marked(at - across) && is_marked(at + across) && is_marked(at - down) && is_marked(at + down);
    float place = floor(gl_FragCoord.x) + floor(gl_FragCoord.y) + float(first_row);
    bool is_stripe = mod(place, stripes.z) < 0.5 * stripes.z;
    result = !is_inner ? vec4(color.rgb, 1.0) : is_stripe ? vec4(color.rgb, stripes.x) : vec4(0.0, 0.0, 0.0, stripes.y);
}
