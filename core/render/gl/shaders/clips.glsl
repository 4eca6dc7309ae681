// The clip planes that cut a draw: a point p is kept where dot(clips[i], vec4(p, 1)) >= 0.
uniform vec4 clips[8];
uniform int n_clips;
float kept(int i, vec3 p) { return dot(clips[i], vec4(p, 1.0)); }
