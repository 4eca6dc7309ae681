// The colour that the vertices have.
in vec4 shade;
out vec4 result;
void main() { result = shade; }
