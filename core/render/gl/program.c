#include "core/render/gl/program.h"

#include <stddef.h>

/* Every picture is drawn upside down (flip in the camera's matrix, see renderer.c), so that reading it back gives row 0 at the
 * top. */

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

/* Light is worked out at the vertices: a voxel's surface has triangles of a pixel or few, and on a software rasteriser a fragment
 * costs what a vertex does.
 * viewer: xyz the eye and w 1 in perspective, xyz the direction towards the viewer and w 0 in parallel projection. */
static const char smooth_vertex[] =
    "layout(location = 0) in vec3 position;\n"
    "layout(location = 1) in vec3 normal;\n"
    "uniform mat4 clip_from_lps;\n"
    "uniform mat3 eye_from_lps;\n"
    "uniform vec4 viewer;\n"
    "out vec4 shade;\n"
    "void main() {\n"
    "    vec3 towards = normalize(viewer.xyz - viewer.w * position);\n"
    "    shade = light(eye_from_lps * normal, clamp(dot(normal, towards), 0.0, 1.0));\n"
    "    gl_Position = clip_from_lps * vec4(position, 1.0);\n"
    "}\n";

static const char smooth_fragment[] =
    "in vec4 shade;\n"
    "out vec4 result;\n"
    "void main() { result = shade; }\n";

static const char faceted_vertex[] =
    "layout(location = 0) in vec3 position;\n"
    "uniform mat4 clip_from_lps;\n"
    "uniform vec4 viewer;\n"
    "out vec3 towards;\n" /* linear over a triangle in perspective; its derivatives are the triangle's plane */
    "out vec3 place;\n"
    "void main() {\n"
    "    towards = viewer.xyz - viewer.w * position;\n"
    "    place = position;\n"
    "    gl_Position = clip_from_lps * vec4(position, 1.0);\n"
    "}\n";

static const char faceted_fragment[] =
    "uniform mat3 eye_from_lps;\n"
    "in vec3 towards;\n"
    "in vec3 place;\n"
    "out vec4 result;\n"
    "void main() {\n"
    "    vec3 n = normalize(cross(dFdx(place), dFdy(place)));\n"
    "    float facing = dot(n, normalize(towards));\n"
    "    if (facing < 0.0) n = -n;\n" /* the visible side of the triangle */
    "    result = light(eye_from_lps * n, min(abs(facing), 1.0));\n"
    "}\n";

/* A polygon in a plane through a grid. at: 0 .. 1 over the grid's outer faces. */
static const char slice_vertex[] =
    "layout(location = 0) in vec3 position;\n"
    "layout(location = 1) in vec3 place;\n"
    "uniform mat4 clip_from_lps;\n"
    "out vec3 at;\n"
    "void main() { at = place; gl_Position = clip_from_lps * vec4(position, 1.0); }\n";

static const char image_fragment[] =
    "uniform sampler3D source;\n"
    "uniform vec2 grey;\n" /* stored value to 0 .. 1 */
    "uniform float cull;\n" /* in the same scale: what is below is left out */
    "in vec3 at;\n"
    "out vec4 result;\n"
    "void main() {\n"
    "    float value = texture(source, at).r;\n"
    "    if (isnan(value) || isinf(value)) discard;\n"
    "    if (value * grey.x + grey.y < cull)\n"
    "        discard;\n"
    "    result = vec4(vec3(clamp(value * grey.x + grey.y, 0.0, 1.0)), 1.0);\n"
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

/* Layers over each other, the farther first: with rank_depth 0 in their own order, else each sample in its own. What is laid down
 * comes out with the share of what was there before that still shows, for blending. */
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

static const char test_fragment[] =
    "uniform sampler2D source;\n"
    "out vec4 result;\n"
    "void main() { result = texelFetch(source, ivec2(gl_FragCoord.xy), 0); }\n";

static GLuint compile(const struct gl *gl, GLenum kind, const char *name, const char *library, const char *source, struct error *err)
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
        { &program->clip_from_lps, "clip_from_lps" }, { &program->eye_from_lps, "eye_from_lps" }, { &program->viewer, "viewer" },
        { &program->color, "color" }, { &program->opacity, "opacity" }, { &program->is_rim, "is_rim" },
        { &program->source, "source" }, { &program->palette, "palette" }, { &program->grey, "grey" },
        { &program->cull, "cull" }, { &program->scale, "scale" }, { &program->depths, "depths" }, { &program->before, "before" },
        { &program->n_layers, "n_layers" }, { &program->rank_depth, "rank_depth" },
    };
    for (size_t i = 0; i < sizeof uniforms / sizeof uniforms[0]; i++)
        *uniforms[i].place = gl->GetUniformLocation(program->name, uniforms[i].name);
    return true;
}

bool gl_programs_create(const struct gl *gl, struct gl_programs *programs, struct error *err)
{
    *programs = (struct gl_programs){ 0 };
    if (create(gl, &programs->smooth, "smooth", surface_light, smooth_vertex, "", smooth_fragment, err) &&
        create(gl, &programs->faceted, "faceted", "", faceted_vertex, surface_light, faceted_fragment, err) &&
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
    const GLuint names[] = { programs->smooth.name, programs->faceted.name, programs->compose.name, programs->image.name, programs->labels.name,
                             programs->test.name };
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (names[i])
            gl->DeleteProgram(names[i]);
    *programs = (struct gl_programs){ 0 };
}
