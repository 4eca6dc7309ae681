#include "core/render/gl/program.h"

#include <stddef.h>
#include <stdio.h>

#include "core/render/visible/visible.h"

/* Every picture is drawn upside down (flip in the camera's matrix, see renderer.c), so that reading it back gives row 0
 * at the top. */

/* A key light from the upper right, a weak fill from the left, a soft rim; translucency as proto/scene.json says.
 * n: the normal in eye space (x right, y up, z towards the viewer); facing: its cosine with the line of sight. */
static const char surface_light[] =
    "uniform vec4 color;\n"
    "uniform float opacity;\n"
    "uniform int is_rim;\n"
    "vec4 light(vec3 n, float facing) {\n"
    "    float edge = 1.0 - facing;\n"
    "    float key = max(dot(n, vec3(0.426, 0.568, 0.704)), 0.0);\n"
    "    float fill = max(dot(n, vec3(-0.741, 0.106, 0.663)), 0.0);\n"
    "    float ambient = opacity < 1.0 ? 0.5 : 0.3;\n" /* what shows through black must be brighter to be seen */
    "    float gloss = key * key; gloss *= gloss; gloss *= gloss; gloss *= gloss;\n"
    "    vec3 lit = color.rgb * (ambient + 0.58 * key + 0.18 * fill + 0.24 * edge * edge) + 0.07 * gloss;\n"
    "    float alpha = is_rim != 0 ? opacity * (0.3 + 1.82 * pow(edge, 1.8)) : opacity;\n"
    "    return vec4(min(lit, 1.0), min(alpha, 1.0));\n"
    "}\n";

/* Light is worked out at the vertices: a voxel's surface has triangles of a pixel or few, and on a software rasteriser
 * a fragment costs what a vertex does. viewer: xyz the eye and w 1 in perspective, xyz the direction towards the viewer
 * and w 0 in parallel projection. */
static const char smooth_vertex[] =
    "layout(location = 0) in vec3 position;\n"
    "layout(location = 1) in vec3 normal;\n"
    "uniform mat4 clip_from_lps;\n"
    "uniform mat3 eye_from_lps;\n"
    "uniform vec4 viewer;\n"
    "uniform int is_two_sided;\n"
    "out vec4 shade;\n"
    "void main() {\n"
    "    vec3 towards = normalize(viewer.xyz - viewer.w * position);\n"
    "    float cosine = dot(normal, towards), side = is_two_sided != 0 && cosine < 0.0 ? -1.0 : 1.0;\n" /* that is seen
                                                                                                         */
    "    shade = light(eye_from_lps * (side * normal), clamp(side * cosine, 0.0, 1.0));\n"
    "    gl_Position = clip_from_lps * vec4(position, 1.0);\n"
    "}\n";

static const char smooth_fragment[] = "in vec4 shade;\n"
                                      "out vec4 result;\n"
                                      "void main() { result = shade; }\n";

/* rounding: share of the light that falls as on a rounded surface (visible.h). */
static const char faceted_vertex[] =
    "layout(location = 0) in vec3 position;\n"
    "layout(location = 1) in vec3 normal;\n"
    "uniform mat4 clip_from_lps;\n"
    "uniform mat3 eye_from_lps;\n"
    "uniform vec4 viewer;\n"
    "uniform float rounding;\n"
    "out vec3 towards;\n" /* linear over a triangle in perspective; its derivatives are the triangle's plane */
    "out vec3 place;\n"
    "out vec4 rounded;\n"
    "void main() {\n"
    "    towards = viewer.xyz - viewer.w * position;\n"
    "    place = position;\n"
    "    rounded = vec4(0.0);\n"
    "    if (rounding > 0.0) rounded = light(eye_from_lps * normal, clamp(dot(normal, normalize(towards)), 0.0, 1.0));\n"
    "    gl_Position = clip_from_lps * vec4(position, 1.0);\n"
    "}\n";

static const char faceted_fragment[] =
    "uniform mat3 eye_from_lps;\n"
    "uniform float rounding;\n"
    "in vec3 towards;\n"
    "in vec3 place;\n"
    "in vec4 rounded;\n"
    "out vec4 result;\n"
    "void main() {\n"
    "    vec3 n = normalize(cross(dFdx(place), dFdy(place)));\n"
    "    float facing = dot(n, normalize(towards));\n"
    "    if (facing < 0.0) n = -n;\n" /* the visible side of the triangle */
    "    result = mix(light(eye_from_lps * n, min(abs(facing), 1.0)), rounded, rounding);\n"
    "}\n";

/* Lines and points are rectangles square to the picture: an instance of four corners each, laid out here as
 * core/render/soft/quads.c does. half_view: half the picture's size in samples; half_size: of a line or point, in
 * samples. */
static const char line_vertex[] =
    "layout(location = 0) in vec3 first;\n"
    "layout(location = 1) in vec3 second;\n"
    "uniform mat4 clip_from_lps;\n"
    "uniform vec2 half_view;\n"
    "uniform float half_size;\n"
    "uniform vec4 color;\n"
    "uniform float opacity;\n"
    "uniform vec4 cue;\n" /* darker away from the viewer: visible_depth_cue */
    "out vec4 shade;\n"
    "float cue_at(vec3 p) { return clamp(dot(cue.xyz, p) + cue.w, DARKEST, 1.0); }\n"
    "void main() {\n"
    "    vec4 a = clip_from_lps * vec4(first, 1.0), b = clip_from_lps * vec4(second, 1.0), uncut = a;\n"
    "    float fa = a.z + a.w, fb = b.z + b.w;\n"
    "    shade = vec4(color.rgb * (cue_at(first) + cue_at(second)) * 0.5, opacity);\n"
    "    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);\n" /* nothing */
    "    if (fa < 0.0 && fb < 0.0) return;\n"
    "    if (fa < 0.0) a = mix(a, b, fa / (fa - fb));\n"
    "    if (fb < 0.0) b = mix(uncut, b, fa / (fa - fb));\n"
    "    if (a.w <= 0.0 || b.w <= 0.0) return;\n"
    "    vec2 s = a.xy / a.w * half_view, t = b.xy / b.w * half_view, along = t - s;\n"
    "    float size = length(along);\n"
    "    along = size > 1e-6 ? along / size * half_size : vec2(half_size, 0.0);\n"
    "    vec2 across = (gl_VertexID & 1) == 0 ? vec2(-along.y, along.x) : vec2(along.y, -along.x);\n"
    "    bool is_second = gl_VertexID > 1;\n"
    "    float z = is_second ? b.z / b.w : a.z / a.w;\n"
    "    gl_Position = vec4((is_second ? t + along + across : s - along + across) / half_view, max(z - 2.0 * LINE_DEPTH, -1.0), 1.0);\n"
    "}\n";

static const char point_vertex[] =
    "layout(location = 0) in vec3 position;\n"
    "layout(location = 1) in vec3 normal;\n"
    "layout(location = 2) in float baked;\n"
    "uniform mat4 clip_from_lps;\n"
    "uniform mat3 eye_from_lps;\n"
    "uniform vec4 viewer;\n"
    "uniform vec2 half_view;\n"
    "uniform float half_size;\n"
    "uniform int is_covering;\n" /* as large as a voxel; else half_size */
    "uniform int is_baked;\n"
    "uniform vec4 edges[3];\n" /* of a voxel, in clip space */
    "out vec4 shade;\n"
    "void main() {\n"
    "    vec4 middle = clip_from_lps * vec4(position, 1.0);\n"
    "    vec3 towards = normalize(viewer.xyz - viewer.w * position);\n"
    "    vec3 n = dot(normal, normal) > 0.25 ? normal : towards;\n" /* none: what is one voxel thin */
    "    shade = is_baked != 0 ? vec4(color.rgb * baked, opacity) : light(eye_from_lps * n, clamp(dot(n, towards), 0.0, 1.0));\n"
    "    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);\n" /* nothing */
    "    if (middle.z + middle.w < 0.0 || middle.w <= 0.0) return;\n"
    "    vec2 at = middle.xy / middle.w, size = vec2(half_size);\n"
    "    if (is_covering != 0) {\n"
    "        vec2 across = vec2(0.0);\n"
    "        float depth = 0.0;\n"
    "        for (int i = 0; i < 3; i++) {\n"
    "            across += abs(edges[i].xy - at * edges[i].w) * 0.5;\n"
    "            depth += abs(edges[i].w) * 0.5;\n"
    "        }\n"
    "        size = max(across / max(middle.w - depth, middle.w * 0.125) * half_view + 1.0 / 256.0, 0.5);\n"
    "    }\n"
    "    vec2 corner = vec2((gl_VertexID & 1) == 0 ? -1.0 : 1.0, gl_VertexID > 1 ? 1.0 : -1.0);\n"
    "    gl_Position = vec4(at + corner * size / half_view, middle.z / middle.w, 1.0);\n"
    "}\n";

/* A polygon in a plane through a grid. at: 0 .. 1 over the grid's outer faces. */
static const char slice_vertex[] = "layout(location = 0) in vec3 position;\n"
                                   "layout(location = 1) in vec3 place;\n"
                                   "uniform mat4 clip_from_lps;\n"
                                   "out vec3 at;\n"
                                   "void main() { at = place; gl_Position = clip_from_lps * vec4(position, 1.0); }\n";

static const char image_fragment[] =
    "uniform sampler3D source;\n"
    "uniform vec2 grey;\n"  /* stored value to 0 .. 1 */
    "uniform vec2 ends;\n"  /* what 0 and 1 are drawn as */
    "uniform float cull;\n" /* in the same scale: what is below is left out */
    "in vec3 at;\n"
    "out vec4 result;\n"
    "void main() {\n"
    "    float value = texture(source, at).r;\n"
    "    if (isnan(value) || isinf(value)) discard;\n"
    "    if (value * grey.x + grey.y < cull)\n"
    "        discard;\n"
    "    result = vec4(vec3(mix(ends.x, ends.y, clamp(value * grey.x + grey.y, 0.0, 1.0))), 1.0);\n"
    "}\n";

static const char labels_fragment[] =
    "uniform usampler3D source;\n"
    "uniform sampler2D palette;\n" /* 256 x 256, label = 256 row + column; alpha 0: nothing to see */
    "uniform vec4 scale;\n"        /* voxels along the grid */
    "in vec3 at;\n"
    "out vec4 result;\n"
    "void main() {\n"
    "    ivec3 voxel = clamp(ivec3(at * scale.xyz), ivec3(0), ivec3(scale.xyz) - 1);\n"
    "    uint label = texelFetch(source, voxel, 0).r;\n"
    "    result = texelFetch(palette, ivec2(int(label & 255u), int(label >> 8u)), 0);\n"
    "    if (result.a == 0.0) discard;\n"
    "}\n";

static const char test_vertex[] =
    "void main() {\n"
    "    gl_Position = vec4(float(gl_VertexID & 1) * 4.0 - 1.0, float(gl_VertexID & 2) * 2.0 - 1.0, 0.0, 1.0);\n"
    "}\n";

/* Layers over each other, the farther first: with rank_depth 0 in their own order, else each sample in its own. What is
 * laid down comes out with the share of what was there before that still shows, for blending. */
static const char compose_fragment[] =
    "uniform sampler2DArray source;\n"
    "uniform sampler2DArray depths;\n"
    "uniform sampler2D before;\n" /* depth of what is opaque */
    "uniform int n_layers;\n"
    "uniform float rank_depth;\n"
    "out vec4 result;\n"
    "void main() {\n"
    "    ivec2 at = ivec2(gl_FragCoord.xy);\n"
    "    float opaque = texelFetch(before, at, 0).r, last = 2.0;\n"
    "    int last_layer = -1;\n"
    "    result = vec4(0.0, 0.0, 0.0, 1.0);\n"
    "    for (int n = 0; n < n_layers; n++) {\n"
    "        float most = -1.0;\n"
    "        int farthest = -1;\n"
    "        for (int i = rank_depth > 0.0 ? 0 : last_layer + 1; i < n_layers; i++) {\n"
    "            float depth = texelFetch(depths, ivec3(at, i), 0).r;\n"
    "            if (depth >= opaque) continue;\n"
    "            if (rank_depth <= 0.0) { farthest = i; break; }\n"
    "            depth -= rank_depth * float(i);\n"
    "            if (depth > most && (depth < last || (depth == last && i > last_layer))) { most = depth; farthest = i; }\n"
    "        }\n"
    "        if (farthest < 0) break;\n"
    "        vec4 over = texelFetch(source, ivec3(at, farthest), 0);\n"
    "        result = vec4(mix(result.rgb, over.rgb, over.a), result.a * (1.0 - over.a));\n"
    "        last = most;\n"
    "        last_layer = farthest;\n"
    "    }\n"
    "    if (last_layer < 0) discard;\n"
    "}\n";

static const char test_fragment[] = "uniform sampler2D source;\n"
                                    "out vec4 result;\n"
                                    "void main() { result = texelFetch(source, ivec2(gl_FragCoord.xy), 0); }\n";

static GLuint compile(const struct gl *gl, GLenum kind, const char *name, const char *library, const char *source,
                      struct error *err)
{
    const char *parts[3] = { "#version 330 core\n", library, source };
    GLuint shader = gl->CreateShader(kind);
    GLint is_good = 0;
    gl->ShaderSource(shader, 3, parts, NULL);
    gl->CompileShader(shader);
    gl->GetShaderiv(shader, GL_COMPILE_STATUS, &is_good);
    if (is_good)
        return shader;
    char words[160] = "";
    gl->GetShaderInfoLog(shader, sizeof words, NULL, words);
    gl->DeleteShader(shader);
    error_set(err, ERROR_GL, "%s shader '%s': %s", kind == GL_VERTEX_SHADER ? "vertex" : "fragment", name, words);
    return 0;
}

static bool create(const struct gl *gl, struct gl_program *program, const char *name, const char *vertex_library,
                   const char *vertex, const char *library, const char *fragment, struct error *err)
{
    GLuint v = compile(gl, GL_VERTEX_SHADER, name, vertex_library, vertex, err);
    GLuint f = v ? compile(gl, GL_FRAGMENT_SHADER, name, library, fragment, err) : 0;
    if (!f) {
        if (v)
            gl->DeleteShader(v);
        return false;
    }
    GLint is_good = 0;
    program->name = gl->CreateProgram();
    gl->AttachShader(program->name, v);
    gl->AttachShader(program->name, f);
    gl->LinkProgram(program->name);
    gl->DeleteShader(v);
    gl->DeleteShader(f);
    gl->GetProgramiv(program->name, GL_LINK_STATUS, &is_good);
    if (!is_good) {
        char words[160] = "";
        gl->GetProgramInfoLog(program->name, sizeof words, NULL, words);
        return error_set(err, ERROR_GL, "shader program '%s': %s", name, words);
    }
    const struct {
        GLint *place;
        const char *name;
    } uniforms[] = {
        { &program->clip_from_lps, "clip_from_lps" },
        { &program->eye_from_lps, "eye_from_lps" },
        { &program->viewer, "viewer" },
        { &program->color, "color" },
        { &program->opacity, "opacity" },
        { &program->is_rim, "is_rim" },
        { &program->source, "source" },
        { &program->palette, "palette" },
        { &program->grey, "grey" },
        { &program->ends, "ends" },
        { &program->cull, "cull" },
        { &program->scale, "scale" },
        { &program->depths, "depths" },
        { &program->before, "before" },
        { &program->n_layers, "n_layers" },
        { &program->rank_depth, "rank_depth" },
        { &program->is_two_sided, "is_two_sided" },
        { &program->rounding, "rounding" },
        { &program->is_baked, "is_baked" },
        { &program->is_covering, "is_covering" },
        { &program->half_size, "half_size" },
        { &program->half_view, "half_view" },
        { &program->cue, "cue" },
        { &program->edges, "edges" },
    };
    for (size_t i = 0; i < sizeof uniforms / sizeof uniforms[0]; i++)
        *uniforms[i].place = gl->GetUniformLocation(program->name, uniforms[i].name);
    return true;
}

static const char *line_constants(char text[80])
{
    (void)snprintf(text, 80, "#define DARKEST %.9f\n#define LINE_DEPTH %.9f\n", VISIBLE_DARKEST, VISIBLE_LINE_DEPTH);
    return text;
}

bool gl_programs_create(const struct gl *gl, struct gl_programs *programs, struct error *err)
{
    char constants[80];
    *programs = (struct gl_programs){ 0 };
    if (create(gl, &programs->smooth, "smooth", surface_light, smooth_vertex, "", smooth_fragment, err) &&
        create(gl, &programs->faceted, "faceted", surface_light, faceted_vertex, surface_light, faceted_fragment,
               err) &&
        create(gl, &programs->lines, "lines", line_constants(constants), line_vertex, "", smooth_fragment, err) &&
        create(gl, &programs->points, "points", surface_light, point_vertex, "", smooth_fragment, err) &&
        create(gl, &programs->compose, "compose", "", test_vertex, "", compose_fragment, err) &&
        create(gl, &programs->image, "image", "", slice_vertex, "", image_fragment, err) &&
        create(gl, &programs->labels, "labels", "", slice_vertex, "", labels_fragment, err) &&
        create(gl, &programs->test, "test", "", test_vertex, "", test_fragment, err))
        return true;
    gl_programs_destroy(gl, programs);
    return false;
}

void gl_programs_destroy(const struct gl *gl, struct gl_programs *programs)
{
    const GLuint names[] = { programs->smooth.name, programs->faceted.name, programs->compose.name,
                             programs->lines.name,  programs->points.name,  programs->image.name,
                             programs->labels.name, programs->test.name };
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (names[i])
            gl->DeleteProgram(names[i]);
    *programs = (struct gl_programs){ 0 };
}
