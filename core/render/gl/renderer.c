/* The OpenGL back end: start, test and stop; a picture drawn and read back in bands. */
#include "core/render/gl/renderer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "core/render/gl/context.h"
#include "core/render/gl/draw.h"
#include "core/render/gl/drawables.h"
#include "core/render/visible/visible.h"

/* A picture of more samples than a band is drawn in several bands. */
enum { MAX_SIDE_PX = 4096, MAX_BAND_SAMPLES = 16 << 20 };

struct gl_renderer {
    struct gl gl;
    struct gl_context context;
    struct render_facts facts;
    struct gl_programs programs;
    struct gl_target target;
    struct gl_layers layers;
    GLuint no_vertices, polygon_array, polygon, segment_array, segments, palette, transfer;
    uint8_t *samples; /* of a band of a still, as read back */
    size_t n_samples_bytes;
};

/* ---- start and stop --------------------------------------------------------------------------------------------- */

static void copy_text(char *to, size_t size, const GLubyte *from)
{
    snprintf(to, size, "%s", from ? (const char *)from : "unknown");
}

static bool is_software_name(const char *renderer)
{
    static const char *const names[] = { "llvmpipe", "softpipe", "swrast", "SWR", "Software", "SwiftShader" };
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (strstr(renderer, names[i]))
            return true;
    return false;
}

static void learn_facts(struct gl_renderer *renderer)
{
    const struct gl *gl = &renderer->gl;
    struct render_facts *facts = &renderer->facts;
    GLint samples = 0;
    facts->back_end = renderer->context.back_end;
    copy_text(facts->vendor, sizeof facts->vendor, gl->GetString(GL_VENDOR));
    copy_text(facts->renderer, sizeof facts->renderer, gl->GetString(GL_RENDERER));
    copy_text(facts->version, sizeof facts->version, gl->GetString(GL_VERSION));
    facts->is_software = is_software_name(facts->renderer);
    gl->GetIntegerv(GL_MAX_SAMPLES, &samples);
    facts->max_samples = samples;
}

/* A texture whose texels are read one by one. */
static GLuint make_table(const struct gl *gl)
{
    GLuint name = 0;
    gl->GenTextures(1, &name);
    gl->BindTexture(GL_TEXTURE_2D, name);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
    gl->BindTexture(GL_TEXTURE_2D, 0);
    return name;
}

static void make_polygon(struct gl_renderer *renderer)
{
    const struct gl *gl = &renderer->gl;
    gl->GenVertexArrays(1, &renderer->no_vertices);
    gl->GenVertexArrays(1, &renderer->polygon_array);
    gl->GenBuffers(1, &renderer->polygon);
    gl->BindVertexArray(renderer->polygon_array);
    gl->BindBuffer(GL_ARRAY_BUFFER, renderer->polygon);
    gl->VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 6 * sizeof(float), NULL);
    gl->VertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, 6 * sizeof(float), (const void *)(3 * sizeof(float)));
    gl->EnableVertexAttribArray(0);
    gl->EnableVertexAttribArray(1);
    gl->BindVertexArray(0);

    gl->GenVertexArrays(1, &renderer->segment_array);
    gl->GenBuffers(1, &renderer->segments);
    gl->BindVertexArray(renderer->segment_array);
    gl->BindBuffer(GL_ARRAY_BUFFER, renderer->segments);
    for (GLuint end = 0; end < 2; end++) {
        gl->VertexAttribPointer(end, 3, GL_FLOAT, GL_FALSE, 6 * sizeof(float), (const void *)(3 * end * sizeof(float)));
        gl->EnableVertexAttribArray(end);
        gl->VertexAttribDivisor(end, 1);
    }
    gl->BindVertexArray(0);

    renderer->palette = make_table(gl);
    renderer->transfer = make_table(gl);
}

/* Tests the driver's compiler and rasteriser: a triangle must come back in the right colour. */
static bool draw_test_pixel(struct gl_renderer *renderer, struct error *err)
{
    const struct gl *gl = &renderer->gl;
    const uint8_t texel[4] = { 51, 102, 204, 255 };
    uint8_t pixel[4] = { 0 };
    GLuint texture = 0;
    if (!gl_target_resize(gl, &renderer->target, 4, 4, err))
        return false;
    gl->GenTextures(1, &texture);
    gl->BindTexture(GL_TEXTURE_2D, texture);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl->TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 1, 1, 0, GL_RGBA, GL_UNSIGNED_BYTE, texel);
    gl->BindFramebuffer(GL_FRAMEBUFFER, renderer->target.framebuffer);
    gl->Viewport(0, 0, 1, 1);
    gl->UseProgram(renderer->programs.test.name);
    gl->BindVertexArray(renderer->no_vertices);
    gl->DrawArrays(GL_TRIANGLES, 0, 3);
    gl->ReadPixels(0, 0, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, pixel);
    gl->BindTexture(GL_TEXTURE_2D, 0);
    gl->DeleteTextures(1, &texture);
    gl_target_destroy(gl, &renderer->target);
    if (!gl_check(gl, "drawing a test pixel", err))
        return false;
    if (memcmp(pixel, texel, sizeof pixel) != 0)
        return error_set(err, ERROR_GL, "a test pixel came back as %d %d %d %d", pixel[0], pixel[1], pixel[2],
                         pixel[3]);
    return true;
}

static bool start(struct gl_renderer *renderer, enum render_back_end back_end, enum gl_device_wish wish,
                  struct error *err)
{
    if (!gl_context_open(&renderer->context, back_end, wish, &renderer->gl, err))
        return false;
    learn_facts(renderer);
    if (!gl_programs_create(&renderer->gl, &renderer->programs, err))
        return false;
    make_polygon(renderer);
    return draw_test_pixel(renderer, err);
}

struct gl_renderer *gl_renderer_create(enum render_back_end back_end, bool is_hardware_wanted, struct error *err)
{
    struct gl_renderer *renderer = mem_new(sizeof *renderer);
    if (start(renderer, back_end, is_hardware_wanted ? GL_DEVICE_HARDWARE : GL_DEVICE_ANY, err))
        return renderer;
    gl_renderer_destroy(renderer);
    return NULL;
}

void gl_renderer_destroy(struct gl_renderer *renderer)
{
    if (!renderer)
        return;
    if (renderer->context.context) {
        const struct gl *gl = &renderer->gl;
        gl_target_destroy(gl, &renderer->target);
        gl_layers_destroy(gl, &renderer->layers);
        gl_programs_destroy(gl, &renderer->programs);
        gl->DeleteVertexArrays(1, &renderer->no_vertices);
        gl->DeleteVertexArrays(1, &renderer->polygon_array);
        gl->DeleteBuffers(1, &renderer->polygon);
        gl->DeleteVertexArrays(1, &renderer->segment_array);
        gl->DeleteBuffers(1, &renderer->segments);
        gl->DeleteTextures(1, &renderer->palette);
        gl->DeleteTextures(1, &renderer->transfer);
        gl_context_close(&renderer->context);
    }
    free(renderer->samples);
    free(renderer);
}

const struct render_facts *gl_renderer_facts(const struct gl_renderer *renderer)
{
    return &renderer->facts;
}

struct drawable_maker gl_renderer_maker(struct gl_renderer *renderer)
{
    return gl_drawable_maker(&renderer->gl);
}

/* ---- a picture -------------------------------------------------------------------------------------------------- */

/* The camera's matrix for rows first .. first + n - 1 of a picture of `rows` rows; upside down, so that row 0 is read
 * first. */
static void band_matrix(const struct camera *camera, int first, int n, int rows, float out[16])
{
    double scale = (double)rows / n, centre = (2.0 * first + n) / rows - 1;
    for (int column = 0; column < 4; column++) {
        const double *m = &camera->clip_from_lps_mm.m[4 * column];
        out[4 * column] = (float)m[0];
        out[4 * column + 1] = (float)(scale * (-m[1] - centre * m[3]));
        out[4 * column + 2] = (float)m[2];
        out[4 * column + 3] = (float)m[3];
    }
}

/* How many draws from `first` on have its kind and depth rule, one after the other. */
static size_t n_alike(const struct draw_list *list, size_t first)
{
    const struct draw *draws = list->draws;
    size_t end = first;
    while (end < list->n_in_image && draws[end].kind == draws[first].kind && draws[end].depth == draws[first].depth)
        end++;
    return end - first;
}

static bool draw_alike(const struct gl_frame *frame, const struct draw *draws, size_t n, struct error *err)
{
    if (draws->kind == DRAW_SHAPE)
        return gl_draw_shapes(frame, draws, n, err);
    bool (*const draw)(const struct gl_frame *frame, const struct draw *draw, struct error *err) =
        draws->kind == DRAW_IMAGE      ? gl_draw_image
        : draws->kind == DRAW_LABELS   ? gl_draw_labels
        : draws->kind == DRAW_WASH     ? gl_draw_wash
        : draws->kind == DRAW_MARKS    ? gl_draw_marks
        : draws->kind == DRAW_TRACKS   ? gl_draw_tracks
        : draws->kind == DRAW_CAP      ? gl_draw_cap
        : draws->kind == DRAW_ISOLINES ? gl_draw_isolines
                                       : NULL;
    for (size_t i = 0; draw && i < n; i++)
        if (!draw(frame, &draws[i], err))
            return false;
    return true;
}

/* Keeps the depths of the band's pixels: those of opaque shapes, then, negative, those of planes before them, then what
 * gl_draw_volume_depth has left. drawn: the pass just drawn. */
static bool keep_depth(const struct gl_frame *frame, enum draw_pass drawn, struct error *err)
{
    const struct gl *gl = frame->gl;
    const size_t width = (size_t)frame->target->width_px, samples = (size_t)frame->list->samples;
    float *depth = mem_array(width * (size_t)frame->target->height_px, sizeof *depth, UINT64_MAX, err);
    if (!depth)
        return false;
    gl->PixelStorei(GL_PACK_ALIGNMENT, 4);
    gl->ReadPixels(0, 0, frame->target->width_px, frame->target->height_px, GL_DEPTH_COMPONENT, GL_FLOAT, depth);
    for (size_t y = 0; y < (size_t)frame->target->height_px / samples; y++) {
        float *to = frame->list->depth + ((size_t)frame->first_row / samples + y) * (width / samples);
        const float *from = depth + y * samples * width;
        for (size_t x = 0; x < width / samples; x++) {
            const float here = from[x * samples], of_volume = 2 * here - (here < 0.5f ? 0 : 1);
            if (drawn == DRAW_OPAQUE)
                to[x] = here;
            else if (drawn == DRAW_PLANES && here < to[x])
                to[x] = -here;
            else if (drawn == DRAW_TRANSLUCENT && here < 1 && of_volume < fabsf(to[x]))
                to[x] = here < 0.5f ? of_volume : -of_volume;
        }
    }
    free(depth);
    return gl_check(gl, "reading depths", err);
}

/* Executes the list in its order. */
static bool draw_all(const struct gl_frame *frame, struct error *err)
{
    const struct gl *gl = frame->gl;
    gl->BindFramebuffer(GL_FRAMEBUFFER, frame->target->framebuffer);
    gl->Viewport(0, 0, frame->target->width_px, frame->target->height_px);
    gl->ClearColor((float)frame->ground[0] / 255.0f, (float)frame->ground[1] / 255.0f, (float)frame->ground[2] / 255.0f,
                   1);
    gl->Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    const struct draw_list *list = frame->list;
    bool is_good = true;
    enum draw_pass kept = DRAW_OPAQUE;
    for (size_t i = 0, n; is_good && i <= list->n_in_image; i += n) {
        enum draw_pass pass = i < list->n_in_image ? list->draws[i].pass : DRAW_OVERLAY;
        for (; is_good && list->depth && kept < DRAW_TRANSLUCENT && kept < pass; kept++)
            is_good = keep_depth(frame, kept, err);
        if (!is_good || i == list->n_in_image)
            break;
        const struct draw *draw = &list->draws[i];
        if (draw->depth == DRAW_DEPTH_NONE)
            gl->Disable(GL_DEPTH_TEST);
        else
            gl->Enable(GL_DEPTH_TEST);
        n = draw->depth == DRAW_DEPTH_LAYER ? draw_list_n_layers(list, i) : n_alike(list, i);
        is_good =
            draw->depth == DRAW_DEPTH_LAYER ? gl_draw_layers(frame, draw, n, err) : draw_alike(frame, draw, n, err);
        if (is_good && list->depth && draw->kind == DRAW_VOLUME) {
            is_good = gl_draw_volume_depth(frame, draw, err) && keep_depth(frame, DRAW_TRANSLUCENT, err);
            gl->BindFramebuffer(GL_FRAMEBUFFER, frame->target->framebuffer);
        }
    }
    return is_good;
}

/* Mean of 2 x 2 samples, rounded. */
static void average_samples(const uint8_t *restrict samples, int width_px, int n_rows, uint8_t *restrict rgba)
{
    size_t row = (size_t)width_px * 2 * 4;
    for (int y = 0; y < n_rows; y++) {
        const uint8_t *upper = samples + (size_t)y * 2 * row, *lower = upper + row;
        uint8_t *out = rgba + (size_t)y * (size_t)width_px * 4;
        for (int x = 0; x < width_px; x++)
            for (int c = 0; c < 4; c++)
                out[4 * x + c] =
                    (uint8_t)((upper[8 * x + c] + upper[8 * x + 4 + c] + lower[8 * x + c] + lower[8 * x + 4 + c] + 2) >>
                              2);
    }
}

static bool read_band(struct gl_renderer *renderer, struct image *image, int first, int n, int samples,
                      struct error *err)
{
    const struct gl *gl = &renderer->gl;
    uint8_t *rgba = image->rgba + (size_t)first * (size_t)image->width_px * 4, *to = rgba;
    if (samples > 1) {
        size_t n_bytes = (size_t)image->width_px * (size_t)n * (size_t)(samples * samples) * 4;
        if (renderer->n_samples_bytes < n_bytes) {
            free(renderer->samples);
            renderer->samples = mem_array(n_bytes, 1, UINT64_MAX, err);
            renderer->n_samples_bytes = renderer->samples ? n_bytes : 0;
            if (!renderer->samples)
                return false;
        }
        to = renderer->samples;
    }
    gl->PixelStorei(GL_PACK_ALIGNMENT, 4);
    gl->ReadPixels(0, 0, image->width_px * samples, n * samples, GL_RGBA, GL_UNSIGNED_BYTE, to);
    if (!gl_check(gl, "reading the picture", err))
        return false;
    if (samples > 1)
        average_samples(to, image->width_px, n, rgba);
    return true;
}

static bool draw_band(struct gl_renderer *renderer, struct gl_frame *frame, struct image *image, int first, int n,
                      struct render_timing *timing, struct error *err)
{
    int64_t start_us = clock_now_us();
    int samples = frame->list->samples;
    if (!gl_target_resize(&renderer->gl, &renderer->target, image->width_px * samples, n * samples, err))
        return false;
    frame->first_row = first * samples;
    frame->n_rows = image->height_px * samples;
    band_matrix(frame->camera, first, n, image->height_px, frame->clip_from_lps);
    if (!draw_all(frame, err))
        return false;
    renderer->gl.Finish();
    int64_t drawn_us = clock_now_us();
    timing->draw_us += drawn_us - start_us;
    bool is_good = read_band(renderer, image, first, n, samples, err);
    timing->read_us += clock_now_us() - drawn_us;
    return is_good;
}

struct gl_picture {
    struct gl_renderer *renderer;
    struct gl_frame frame;
    struct render_options options;
    struct image *image;
    int next_row, band; /* in pixels of the picture */
};

struct gl_picture *gl_picture_begin(struct gl_renderer *renderer, const struct draw_scope *scope,
                                    const struct draw_list *list, const struct render_options *options)
{
    struct gl_picture *picture = mem_new(sizeof *picture);
    picture->renderer = renderer;
    picture->options = *options;
    picture->frame = (struct gl_frame){ .gl = &renderer->gl,
                                        .programs = &renderer->programs,
                                        .cache = scope->cache,
                                        .target = &renderer->target,
                                        .layers = &renderer->layers,
                                        .no_vertices = renderer->no_vertices,
                                        .polygon_array = renderer->polygon_array,
                                        .polygon = renderer->polygon,
                                        .segment_array = renderer->segment_array,
                                        .segments = renderer->segments,
                                        .palette = renderer->palette,
                                        .transfer = renderer->transfer,
                                        .plan = scope->snapshot->plan,
                                        .list = list,
                                        .camera = scope->camera,
                                        .lights = visible_lights(&scope->snapshot->scene.lights, scope->camera),
                                        .view_line_width = snapshot_line_width(scope->snapshot) };
    visible_ground(scope->snapshot, picture->frame.ground);
    return picture;
}

static bool prepare(struct gl_picture *picture, struct error *err)
{
    const struct render_options *options = &picture->options;
    if (options->width_px < 1 || options->height_px < 1 || options->width_px > MAX_SIDE_PX ||
        options->height_px > MAX_SIDE_PX)
        return error_set(err, ERROR_RANGE, "a picture of %d x %d pixels: each side must be 1 to %d", options->width_px,
                         options->height_px, MAX_SIDE_PX);
    picture->image = image_create(options->width_px, options->height_px, err);
    if (!picture->image)
        return false;
    const struct draw_list *list = picture->frame.list;
    int row = options->width_px * list->samples * list->samples, band = MAX_BAND_SAMPLES / row;
    int n_layers = list->n_layers_planned < GL_LAYERS_MAX ? (int)list->n_layers_planned : GL_LAYERS_MAX;
    if (n_layers > 0 && band > GL_LAYERS_MAX_SAMPLES / n_layers / row)
        band = GL_LAYERS_MAX_SAMPLES / n_layers / row; /* 8 rows at the very least */
    picture->band = band;
    return true;
}

enum render_state gl_picture_go_on(struct gl_picture *picture, const struct render_pause *pause,
                                   struct render_timing *timing, struct error *err)
{
    if (!picture->image && !prepare(picture, err))
        return RENDER_FAILED;
    do {
        int left = picture->image->height_px - picture->next_row, n = left < picture->band ? left : picture->band;
        if (!draw_band(picture->renderer, &picture->frame, picture->image, picture->next_row, n, timing, err))
            return RENDER_FAILED;
        picture->next_row += n;
    } while (picture->next_row < picture->image->height_px && !(pause && pause->is_due(pause->context)));
    return picture->next_row < picture->image->height_px ? RENDER_PAUSED : RENDER_DONE;
}

struct image *gl_picture_end(struct gl_picture *picture)
{
    struct image *image = picture->image;
    if (image && picture->next_row < image->height_px) {
        image_destroy(image);
        image = NULL;
    }
    free(picture);
    return image;
}
