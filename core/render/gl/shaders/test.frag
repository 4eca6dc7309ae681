// The colour of a texture.
uniform sampler2D source;
out vec4 result;
void main() { result = texelFetch(source, ivec2(gl_FragCoord.xy), 0); }
