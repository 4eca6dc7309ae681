// Between the eight texels at the corners low and high, with floats: weight is the part of high along each axis. Where it is 0,
// high may equal low.
float between_corners(sampler3D grid, ivec3 low, ivec3 high, vec3 weight) {
    vec4 near, far;
    near.x = texelFetch(grid, low, 0).r;
    far.x = texelFetch(grid, ivec3(high.x, low.yz), 0).r;
    near.y = texelFetch(grid, ivec3(low.x, high.y, low.z), 0).r;
    far.y = texelFetch(grid, ivec3(high.xy, low.z), 0).r;
    near.z = texelFetch(grid, ivec3(low.xy, high.z), 0).r;
    far.z = texelFetch(grid, ivec3(high.x, low.y, high.z), 0).r;
    near.w = texelFetch(grid, ivec3(low.x, high.yz), 0).r;
    far.w = texelFetch(grid, high, 0).r;
    near += (far - near) * weight.x;
    vec2 across = near.xz + (near.yw - near.xz) * weight.y;
    return across.x + (across.y - across.x) * weight.z;
}
