// The value of an image between voxels. place: 0 .. 1 over the grid's outer faces.
// Samplers interpolate with weights of 8 bits on most cards, which is off by several grey levels; these weights are floats.
float linear_at(sampler3D grid, vec3 place) {
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
