// The value of an image between voxels. place: 0 .. 1 over the grid's outer faces.
// Samplers interpolate with weights of 8 bits on most cards, which is off by several grey levels; these weights are floats.
float linear_at(sampler3D grid, vec3 place) {
    ivec3 size = textureSize(grid, 0);
    vec3 voxel = clamp(place * vec3(size) - 0.5, vec3(0.0), vec3(size - 1));
    ivec3 low = min(ivec3(voxel), max(size - 2, ivec3(0))), high = min(low + 1, size - 1);
    return between_corners(grid, low, high, voxel - vec3(low));
}
