// A slice of a label layer: one colour a label.
uniform usampler3D source;
uniform sampler2D palette; // 256 x 256, label = 256 row + column; alpha 0: not drawn
uniform vec4 scale; // size of the grid in voxels
in vec3 at;
out vec4 result;
void main() {
    ivec3 voxel = clamp(ivec3(at * scale.xyz), ivec3(0), ivec3(scale.xyz) - 1);
    uint label = texelFetch(source, voxel, 0).r;
    result = texelFetch(palette, ivec2(int(label & 255u), int(label >> 8u)), 0);
    if (result.a == 0.0) discard;
}
