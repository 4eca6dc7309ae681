// A colourwash at a place: the rule of core/render/visible/draw_wash.h. Places are those of the matrices.
uniform sampler3D wash_rows; // the volumes of the rows, stacked
uniform usampler3D wash_tissue;
uniform mat4 wash_from_place; // to indices of the rows' grid
uniform mat4 tissue_from_place;
uniform vec4 wash_size; // of a row, voxels; w: rows along z of the stack
uniform vec4 tissue_size; // w: 0: there is none
uniform int n_rows;
uniform int is_per_slice;
uniform int n_knots;
uniform vec4 knots[10]; // four in each
uniform vec4 knot_colors[40];
uniform vec4 knot_rises[40];

// In voxels. A plane may run along faces of voxels: rounding must not change the side from sample to sample.
const float NUDGE = 1e-4;

bool is_number(float value) { return (floatBitsToUint(value) & 0x7f800000u) != 0x7f800000u; }

// Color and opacity; opacity 0: nothing is drawn.
vec4 wash_at(vec3 place) {
    int row = 0;
    if (tissue_size.w > 0.0) {
        vec3 voxel = floor((tissue_from_place * vec4(place, 1.0)).xyz + (0.5 + NUDGE));
        if (any(lessThan(voxel, vec3(0.0))) || any(greaterThanEqual(voxel, tissue_size.xyz))) return vec4(0.0);
        row = int(texelFetch(wash_tissue, ivec3(voxel), 0).r);
    }
    vec3 index = (wash_from_place * vec4(place, 1.0)).xyz;
    if (row >= n_rows || any(lessThan(index, vec3(-0.5 - NUDGE))) || any(greaterThan(index, wash_size.xyz - (0.5 - NUDGE))))
        return vec4(0.0);
    if (is_per_slice != 0) index.z = floor(index.z + (0.5 + NUDGE));
    index = clamp(index, vec3(0.0), wash_size.xyz - 1.0);
    vec3 base = floor(index), weight = index - base;
    int along = int(wash_size.w);
    ivec3 low = ivec3(base) + ivec3(0, int(wash_size.y) * (row / along), int(wash_size.z) * (row % along));
    ivec3 high = low + ivec3(greaterThan(weight, vec3(0.0))); // a corner without a part is not read: it may be no number
    float value = between_corners(wash_rows, low, high, weight);
    if (!is_number(value)) return vec4(0.0);
    int knot = -1;
    for (int i = 0; i < n_knots && value >= knots[i >> 2][i & 3]; i++) knot = i;
    return knot < 0 ? vec4(0.0) : knot_colors[knot] + (value - knots[knot >> 2][knot & 3]) * knot_rises[knot];
}
