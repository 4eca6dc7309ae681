/* Draws particle tracks by OpenGL: an instance of a rectangle for each segment, two more for each cross. */
#include <stddef.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/render/gl/draw.h"
#include "core/render/visible/draw_clip.h"

static void attribute(const struct gl *gl, GLuint place, GLint n, GLenum type, size_t offset)
{
    gl->VertexAttribPointer(place, n, type, GL_FALSE, sizeof(struct track_segment), (const void *)offset);
    gl->EnableVertexAttribArray(place);
    gl->VertexAttribDivisor(place, 1);
}

static bool upload(const struct gl *gl, const struct track_set *set, struct gl_tracks *out, struct error *err)
{
    size_t n_crosses = 0;
    for (int class = 0; class < TRACK_N_CLASSES; class ++)
        n_crosses += track_class_look((enum track_class) class).has_cross ? set->n_of_class[class] : 0;
    struct track_segment *crossed = mem_array(n_crosses, sizeof *crossed, UINT64_MAX, err);
    out->crosses = crossed ? mem_array(n_crosses, sizeof *out->crosses, UINT64_MAX, err) : NULL;
    for (size_t i = 0; out->crosses && i < set->n_segments && out->n_crosses < n_crosses; i++)
        if (track_class_look((enum track_class)set->segments[i].class).has_cross) {
            crossed[out->n_crosses] = set->segments[i];
            out->crosses[out->n_crosses++] = i;
        }
    bool is_good = out->crosses != NULL;
    for (int i = 0; is_good && i < 2; i++) {
        const struct track_segment *segments = i ? crossed : set->segments;
        size_t n = i ? out->n_crosses : set->n_segments;
        gl->GenBuffers(1, &out->buffers[i]);
        gl->BindBuffer(GL_ARRAY_BUFFER, out->buffers[i]);
        gl->BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(n * sizeof *segments), segments, GL_STATIC_DRAW);
        out->base.n_bytes += n * sizeof *segments;
    }
    free(crossed);
    gl->GenVertexArrays(1, &out->vertex_array);
    return gl_check(gl, "uploading tracks", err) && is_good;
}

void gl_tracks_destroy(const struct gl *gl, struct gl_tracks *tracks)
{
    gl->DeleteVertexArrays(1, &tracks->vertex_array);
    for (int i = 0; i < 2; i++)
        gl->DeleteBuffers(1, &tracks->buffers[i]);
    free(tracks->crosses);
    free(tracks);
}

struct gl_tracks *gl_tracks_create(const struct gl *gl, const struct track_set *set, struct error *err)
{
    struct gl_tracks *made = mem_new(sizeof *made);
    made->base.n_bytes = sizeof *made;
    if (upload(gl, set, made, err))
        return made;
    gl_tracks_destroy(gl, made);
    return NULL;
}

/* The clip planes over a sample's place in the band and its depth, as soft/tracks.c has them over the picture's. */
static void set_cuts(const struct gl_frame *frame, const struct gl_program *program, const struct clip_set *clip)
{
    const double in_plane_mm = 1e-4; /* as in shapes.c */
    float planes[CLIP_MAX][4], rows[CLIP_MAX][4];
    struct mat4 clip_from_lps, lps_from_clip = { { 0 } };
    int n = 0;
    for (int i = 0; i < 16; i++)
        clip_from_lps.m[i] = (double)frame->clip_from_lps[i];
    (void)mat4_invert(&clip_from_lps, &lps_from_clip);
    for (size_t i = 0; i < clip->n_planes; i++) {
        if (!clip_set_has(clip, i))
            continue;
        const struct plane *plane = &clip->planes[i].plane;
        const double below[4] = { -plane->normal.x, -plane->normal.y, -plane->normal.z,
                                  plane_position_mm(plane) + (clip->planes[i].is_capped ? 0 : in_plane_mm) };
        for (int column = 0; column < 4; column++) {
            double sum = 0;
            for (int row = 0; row < 4; row++)
                sum += below[row] * lps_from_clip.m[4 * column + row];
            planes[n][column] = (float)below[column];
            rows[n][column] = (float)sum;
        }
        n++;
    }
    frame->gl->Uniform1i(program->n_clips, n);
    if (n > 0) {
        frame->gl->Uniform4fv(program->clips, n, &planes[0][0]);
        frame->gl->Uniform4fv(program->cut_rows, n, &rows[0][0]);
    }
}

static void set_looks(const struct gl_frame *frame, const struct gl_program *program, double samples_per_px)
{
    float looks[TRACK_N_CLASSES][4], dashes[TRACK_N_CLASSES][4] = { { 0 } };
    for (int class = 0; class < TRACK_N_CLASSES; class ++) {
        const struct track_look look = track_class_look((enum track_class) class);
        const double period_px = look.on_px + look.off_px;
        for (int c = 0; c < 3; c++)
            looks[class][c] = (float)(look.color_rgb >> (16 - 8 * c) & 255) / 255.0f;
        looks[class][3] = look.has_cross;
        if (look.off_px > 0) {
            dashes[class][0] = (float)(1 / (period_px * samples_per_px));
            dashes[class][1] = (float)(look.on_px / period_px);
        }
    }
    frame->gl->Uniform4fv(program->looks, TRACK_N_CLASSES, &looks[0][0]);
    frame->gl->Uniform4fv(program->dashes, TRACK_N_CLASSES, &dashes[0][0]);
}

static const struct gl_program *use_program(const struct gl_frame *frame, const struct draw *draw)
{
    const struct gl *gl = frame->gl;
    const struct gl_program *program = &frame->programs->tracks;
    const struct draw_tracks *tracks = &draw->tracks;
    const struct tracks_shown *shown = &tracks->shown;
    const double samples_per_px = (double)frame->target->width_px / frame->view_line_width,
                 width = draw_tracks_width(tracks, samples_per_px);
    const struct vec3 *f = &frame->camera->forward;
    const struct visible_cue *cue = &tracks->cue;
    gl->UseProgram(program->name);
    gl->UniformMatrix4fv(program->clip_from_lps, 1, GL_FALSE, frame->clip_from_lps);
    gl->Uniform2f(program->half_view, (float)frame->target->width_px / 2.0f, (float)frame->target->height_px / 2.0f);
    gl->Uniform1f(program->half_size, (float)(width / 2));
    gl->Uniform1f(program->cross_size, (float)(DRAW_TRACKS_CROSS_PX * samples_per_px + width / 2));
    gl->Uniform1i(program->is_thin, draw_tracks_are_thin(tracks, samples_per_px));
    gl->Uniform4f(program->cue, (float)cue->x, (float)cue->y, (float)cue->z, (float)cue->w);
    if (tracks->nearest_mm == -INFINITY)
        gl->Uniform4f(program->ahead, 0, 0, 0, 1);
    else
        gl->Uniform4f(program->ahead, (float)f->x, (float)f->y, (float)f->z,
                      (float)(-vec3_dot(frame->camera->eye_lps_mm, *f) - tracks->nearest_mm));
    gl->Uniform1i(program->classes, (GLint)shown->classes);
    gl->Uniform4f(program->energies, (float)fmax(shown->energy_low_mev, -1e30),
                  (float)fmin(shown->energy_high_mev, 1e30), isfinite(shown->energy_low_mev) ? 1.0f : 0.0f,
                  isfinite(shown->energy_high_mev) ? 1.0f : 0.0f);
    set_looks(frame, program, samples_per_px);
    set_cuts(frame, program, &draw->clip);
    return program;
}

/* The instances first .. end - 1 of a buffer. */
static void draw_part(const struct gl_frame *frame, const struct gl_program *program, GLuint buffer, size_t first,
                      size_t end, int part)
{
    const struct gl *gl = frame->gl;
    const size_t start = first * sizeof(struct track_segment);
    gl->BindBuffer(GL_ARRAY_BUFFER, buffer);
    attribute(gl, 0, 3, GL_FLOAT, start + offsetof(struct track_segment, from_lps_mm));
    attribute(gl, 1, 3, GL_FLOAT, start + offsetof(struct track_segment, to_lps_mm));
    attribute(gl, 2, 1, GL_UNSIGNED_BYTE, start + offsetof(struct track_segment, class));
    attribute(gl, 3, 1, GL_FLOAT, start + offsetof(struct track_segment, energy_mev));
    gl->Uniform1i(program->part, part);
    gl->DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, (GLsizei)(end - first));
}

/* The first cross of a segment `segment` or later. */
static size_t find_cross(const struct gl_tracks *tracks, size_t segment)
{
    size_t low = 0, high = tracks->n_crosses;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (tracks->crosses[middle] < segment)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

bool gl_draw_tracks(const struct gl_frame *frame, const struct draw *draw, struct error *err)
{
    const struct gl *gl = frame->gl;
    const struct tracks_shown *shown = &draw->tracks.shown;
    const struct gl_tracks *tracks = (const struct gl_tracks *)draw_cache_tracks(frame->cache, frame->plan, err);
    if (!tracks)
        return false;
    const struct gl_program *program = use_program(frame, draw);
    gl->BindVertexArray(tracks->vertex_array);
    draw_part(frame, program, tracks->buffers[0], shown->first, shown->end, 0);
    const size_t first = find_cross(tracks, shown->first), end = find_cross(tracks, shown->end);
    for (int part = 1; part <= 2 && first < end; part++)
        draw_part(frame, program, tracks->buffers[1], first, end, part);
    gl->BindVertexArray(0);
    return gl_check(gl, "drawing tracks", err);
}
