/* The shader programs: compiling and linking core/render/gl/shaders, and finding their uniforms. */
#include "core/render/gl/program.h"

#include <stddef.h>
#include <stdio.h>

#include "core/render/visible/draw.h"

/* A ray ends where less of the light than this passes: half a grey level. */
static const double least_left = 1.0 / 512;
/* A sample of a volume that adds less is not worth its gradient. */
static const double least_lit = 1.0 / 128;

/* Compiles a shader. constants: lines of "#define NAME value" that the source uses, or "". Returns 0 on failure. */
static GLuint compile(const struct gl *gl, GLenum kind, const char *name, const char *constants, const char *source,
                      struct error *err)
{
    const char *parts[3] = { "#version 330 core\n", constants, source };
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

static bool create(const struct gl *gl, struct gl_program *program, const char *name, const char *constants,
                   const char *vertex, const char *fragment, struct error *err)
{
    GLuint v = compile(gl, GL_VERTEX_SHADER, name, constants, vertex, err);
    GLuint f = v ? compile(gl, GL_FRAGMENT_SHADER, name, constants, fragment, err) : 0;
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
#define UNIFORM_LOCATION(uniform) program->uniform = gl->GetUniformLocation(program->name, #uniform);
    GL_UNIFORMS(UNIFORM_LOCATION)
#undef UNIFORM_LOCATION
    return true;
}

static const char *line_constants(char text[80])
{
    (void)snprintf(text, 80, "#define DARKEST %.9f\n#define LINE_DEPTH %.9f\n", VISIBLE_DARKEST, VISIBLE_LINE_DEPTH);
    return text;
}

static const char *track_constants(char text[80])
{
    (void)snprintf(text, 80, "#define DARKEST %.9f\n#define FAR %.9f\n", VISIBLE_DARKEST, DRAW_TRACKS_FAR);
    return text;
}

static const char *image_constants(char text[120], bool is_linear, bool has_colors)
{
    const uint8_t *rgb = visible_background;
    (void)snprintf(text, 120, "#define DARKEST_GREY (vec3(%d, %d, %d) / 255.0)\n#define LINEAR %d\n#define COLORS %d\n",
                   rgb[0], rgb[1], rgb[2], is_linear, has_colors);
    return text;
}

static const char *volume_constants(char text[540], bool is_depth, bool is_washed)
{
    const uint8_t *rgb = visible_background;
    (void)snprintf(text, 540,
                   "#define DARKEST_GREY (vec3(%d, %d, %d) / 255.0)\n#define FLAT %.9f\n#define TABLE %d.0\n"
                   "#define JITTER_X %uu\n#define JITTER_Y %uu\n#define LEAST_LEFT %.9f\n#define LEAST_LIT %.9f\n"
                   "#define METHOD_RAY %d\n#define METHOD_SLICES %d\n#define METHOD_MIP %d\n"
                   "#define METHOD_AVERAGE %d\n#define DEPTH %d\n#define WASH %d\n",
                   rgb[0], rgb[1], rgb[2], DRAW_VOLUME_FLAT, DRAW_VOLUME_TABLE, DRAW_VOLUME_JITTER_X,
                   DRAW_VOLUME_JITTER_Y, least_left, least_lit, SCENE_VOLUME_METHOD_RAY, SCENE_VOLUME_METHOD_SLICES,
                   SCENE_VOLUME_METHOD_MIP, SCENE_VOLUME_METHOD_AVERAGE, is_depth, is_washed);
    return text;
}

bool gl_programs_create(const struct gl *gl, struct gl_programs *programs, struct error *err)
{
    char constants[80], tracks[80], images[4][120], of_volume[3][540];
    const struct {
        struct gl_program *program;
        const char *name, *constants, *vertex, *fragment;
    } all[] = {
        { &programs->smooth, "smooth", "", gl_shader_smooth_vert, gl_shader_shade_frag },
        { &programs->faceted, "faceted", "", gl_shader_faceted_vert, gl_shader_faceted_frag },
        { &programs->smooth_clipped, "smooth", "#define CLIPPED\n", gl_shader_smooth_vert, gl_shader_shade_frag },
        { &programs->faceted_clipped, "faceted", "#define CLIPPED\n", gl_shader_faceted_vert, gl_shader_faceted_frag },
        { &programs->smooth_textured, "smooth, textured", "#define CLIPPED\n#define TEXTURED\n", gl_shader_smooth_vert,
          gl_shader_textured_frag },
        { &programs->faceted_textured, "faceted, textured", "#define CLIPPED\n#define TEXTURED\n",
          gl_shader_faceted_vert, gl_shader_faceted_frag },
        { &programs->lines, "lines", line_constants(constants), gl_shader_lines_vert, gl_shader_shade_frag },
        { &programs->tracks, "tracks", track_constants(tracks), gl_shader_tracks_vert, gl_shader_tracks_frag },
        { &programs->points, "points", "", gl_shader_points_vert, gl_shader_shade_frag },
        { &programs->compose, "compose", "", gl_shader_whole_vert, gl_shader_compose_frag },
        { &programs->volume, "volume", volume_constants(of_volume[0], false, false), gl_shader_whole_vert,
          gl_shader_volume_frag },
        { &programs->volume_washed, "volume, washed", volume_constants(of_volume[2], false, true), gl_shader_whole_vert,
          gl_shader_volume_frag },
        { &programs->volume_depth, "volume, depth", volume_constants(of_volume[1], true, false), gl_shader_whole_vert,
          gl_shader_volume_frag },
        { &programs->image[0], "image", image_constants(images[0], false, false), gl_shader_slice_vert,
          gl_shader_image_frag },
        { &programs->image[1], "image, linear", image_constants(images[1], true, false), gl_shader_slice_vert,
          gl_shader_image_frag },
        { &programs->colors[0], "colors", image_constants(images[2], false, true), gl_shader_slice_vert,
          gl_shader_image_frag },
        { &programs->colors[1], "colors, linear", image_constants(images[3], true, true), gl_shader_slice_vert,
          gl_shader_image_frag },
        { &programs->labels, "labels", "", gl_shader_slice_vert, gl_shader_labels_frag },
        { &programs->wash, "wash", "", gl_shader_slice_vert, gl_shader_wash_frag },
        { &programs->marks, "marks", "", gl_shader_slice_vert, gl_shader_marks_frag },
        { &programs->fan, "fan", "", gl_shader_fan_vert, gl_shader_shade_frag },
        { &programs->plain, "plain", "", gl_shader_plain_vert, gl_shader_shade_frag },
        { &programs->test, "test", "", gl_shader_whole_vert, gl_shader_test_frag },
    };
    *programs = (struct gl_programs){ 0 };
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
        if (!create(gl, all[i].program, all[i].name, all[i].constants, all[i].vertex, all[i].fragment, err)) {
            gl_programs_destroy(gl, programs);
            return false;
        }
    return true;
}

void gl_programs_destroy(const struct gl *gl, struct gl_programs *programs)
{
    const GLuint names[] = { programs->smooth.name,          programs->faceted.name,
                             programs->smooth_clipped.name,  programs->faceted_clipped.name,
                             programs->compose.name,         programs->lines.name,
                             programs->points.name,          programs->tracks.name,
                             programs->image[0].name,        programs->image[1].name,
                             programs->colors[0].name,       programs->colors[1].name,
                             programs->labels.name,          programs->wash.name,
                             programs->smooth_textured.name, programs->faceted_textured.name,
                             programs->marks.name,           programs->fan.name,
                             programs->plain.name,           programs->test.name,
                             programs->volume.name,          programs->volume_washed.name,
                             programs->volume_depth.name };
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (names[i])
            gl->DeleteProgram(names[i]);
    *programs = (struct gl_programs){ 0 };
}
