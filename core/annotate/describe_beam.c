/* Words for the beam of a snapshot. */
#include "core/annotate/describe_beam.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/annotate/describe_dose.h"
#include "core/render/visible/beam_eye_marks.h"
#include "core/scene/beams_drawn.h"

void beam_words(char text[WORDS_SIZE], const struct snapshot *snapshot, const struct beam_shown *beam)
{
    const struct beam *planned = beam->beam >= 0 ? &snapshot->plan->beams[beam->beam] : NULL;
    bool has_name = planned && planned->name[0] && strcmp(planned->name, planned->id) != 0;
    char of[150] = "";
    if (planned)
        (void)snprintf(of, sizeof of, "%s%s%s%s", planned->id, has_name ? " (" : "", has_name ? planned->name : "",
                       has_name ? ")" : "");
    if (!beam->is_draft) {
        (void)snprintf(text, WORDS_SIZE, "%s", of);
        return;
    }
    const char *name = snapshot->scene.beam.draft.line.name;
    (void)snprintf(text, WORDS_SIZE, "draft%s%.80s%s%s", name[0] ? " " : "", name, planned ? " of " : "", of);
}

void beam_place_words(char text[WORDS_SIZE], double along_mm)
{
    const double metre_mm = 1000;
    char number[40];
    bool is_far = fabs(along_mm) >= metre_mm, is_before = along_mm <= -0.05;
    words_number(number, (is_before ? fabs(along_mm) : along_mm) / (is_far ? metre_mm : 1), 1);
    (void)snprintf(text, WORDS_SIZE, "%s %s %s source end", number, is_far ? "m" : "mm", is_before ? "before" : "from");
}

/* "ring 120 mm", "ring 88.5 mm": a ring that is drawn need not be the beam's aperture. */
static void ring_words(char text[WORDS_SIZE], double diameter_mm, const char *after)
{
    char number[40];
    words_number(number, diameter_mm, fabs(diameter_mm - round(diameter_mm)) < 0.05 ? 0 : 1);
    (void)snprintf(text, WORDS_SIZE, "ring %s mm%s", number, after);
}

void beam_describe(struct annotations *annotations, const struct snapshot *snapshot)
{
    const struct beam_shown *beam = snapshot_beam(snapshot);
    const struct view *view = &snapshot->view;
    char words[WORDS_SIZE];
    if (beam) {
        beam_words(words, snapshot, beam);
        (void)snprintf(annotation_add(annotations, ANNOTATION_BEAM)->text, ANNOTATION_TEXT_SIZE, "Beam: %.240s", words);
        bool is_eye = view->kind == SCENE_KIND_BEAM;
        if (!is_eye || view->beam.has_along_mm) {
            beam_place_words(words, is_eye ? view->beam.along_mm : snapshot->scene.beam.slice.along_mm);
            (void)snprintf(annotation_add(annotations, ANNOTATION_BEAM)->text, ANNOTATION_TEXT_SIZE, "%s%.240s",
                           is_eye ? "eye " : "", words);
        }
        if (view->beam.has_aperture_mm)
            ring_words(annotation_add(annotations, ANNOTATION_BEAM)->text, view->beam.aperture_mm, ", drawn");
    }
    if (snapshot->has_beam && snapshot->beam.is_draft && dose_is_described(snapshot))
        (void)snprintf(annotation_add(annotations, ANNOTATION_BEAM)->text, ANNOTATION_TEXT_SIZE, "%s",
                       snapshot->beam.beam >= 0 ? "Draft beam: the dose shown belongs to the planned beam"
                                                : "Draft beam: the dose shown does not belong to it");
}

/* ---- labels ----------------------------------------------------------------------------------------------------- */

struct labels {
    struct annotations *annotations; /* with room for BEAM_MAX_LABELS more labels */
    const int *size_px;
    double text_px; /* both on the full-size view */
};
enum { BEAM_MAX_LABELS = BEAM_EYE_MAX_NUMBERS + 2 + BEAMS_DRAWN_MAX };

/* NULL: it is not in the picture. */
static struct annotation_label *add_label(const struct labels *labels, struct paint_point at, bool is_centred)
{
    if (!(at.x >= 0 && at.x < labels->size_px[0] && at.y >= 0 && at.y < labels->size_px[1]))
        return NULL;
    struct annotation_label *label = &labels->annotations->labels[labels->annotations->n_labels++];
    *label = (struct annotation_label){ .at = { at.x / labels->size_px[0], at.y / labels->size_px[1] },
                                        .is_centred = is_centred };
    return label;
}

/* Half of what a text is wide: a figure is 0.6 of its size, as are most letters. */
static double half_width_px(const struct labels *labels, const char *text)
{
    return 0.35 * (double)strlen(text) * labels->text_px;
}

/* True if a text around the place would cover a label. Those that are not around their places are above, to the right.
 */
static bool is_taken(const struct labels *labels, struct paint_point at, double half_px)
{
    for (size_t i = 0; i < labels->annotations->n_labels; i++) {
        const struct annotation_label *label = &labels->annotations->labels[i];
        double half = half_width_px(labels, label->text),
               x = label->at[0] * labels->size_px[0] + (label->is_centred ? 0 : half),
               y = label->at[1] * labels->size_px[1] - (label->is_centred ? 0 : labels->text_px);
        if (fabs(x - at.x) < half + half_px && fabs(y - at.y) < 1.2 * labels->text_px)
            return true;
    }
    return false;
}

static void add_numbers(const struct labels *labels, const struct beam_eye_marks *marks)
{
    struct beam_eye_number numbers[BEAM_EYE_MAX_NUMBERS];
    size_t n = beam_eye_numbers(marks, labels->text_px, numbers);
    for (size_t i = 0; i < n; i++) {
        struct annotation_label *label =
            is_taken(labels, numbers[i].at, labels->text_px) ? NULL : add_label(labels, numbers[i].at, true);
        if (label)
            (void)snprintf(label->text, sizeof label->text, "%d", numbers[i].mm);
    }
}

static void add_name(const struct labels *labels, struct paint_point at, const char *name)
{
    enum { MAX_TRIES = 6 }; /* higher, where names would cover each other */
    double half = half_width_px(labels, name);
    for (int i = 0; i < MAX_TRIES; i++) {
        struct paint_point middle = { at.x + half, at.y - labels->text_px };
        if (!is_taken(labels, middle, half))
            break;
        at.y -= 1.3 * labels->text_px;
    }
    struct annotation_label *label = add_label(labels, at, false);
    if (label)
        (void)snprintf(label->text, sizeof label->text, "%s", name);
}

/* The names of the beams that are drawn in space, at their ends before the patient. In the view of a draft that of the
 * planned beam is left to its entry. */
static void add_names(const struct labels *labels, const struct snapshot *snapshot, const struct camera *camera)
{
    struct beam_drawn drawn[BEAMS_DRAWN_MAX];
    size_t n = snapshot_is_pane(snapshot) ? 0 : beams_drawn(snapshot->plan, &snapshot->scene, &snapshot->fits, drawn);
    for (size_t i = 0; i < n; i++) {
        char name[WORDS_SIZE], words[WORDS_SIZE + 16];
        struct vec3 p = beam_label_lps_mm(&drawn[i]), clip = mat4_project(&camera->clip_from_lps_mm, p);
        struct paint_point at = { (clip.x + 1) / 2 * labels->size_px[0], (1 - clip.y) / 2 * labels->size_px[1] };
        bool is_before_eye = vec3_dot(vec3_sub(p, camera->eye_lps_mm), camera->forward) > camera->near_mm;
        if (!is_before_eye || !beam_line_is_drawn(&drawn[i], &snapshot->view) ||
            (drawn[i].is_beside_draft && snapshot_beam(snapshot)))
            continue;
        beam_words(name, snapshot, &drawn[i].shown);
        (void)snprintf(words, sizeof words, "%s%s", name, drawn[i].is_beside_draft ? ", planned" : "");
        add_name(labels, at, words);
    }
}

static void add_eye(const struct labels *labels, const struct beam_eye_marks *marks)
{
    double reach = marks->ring_mm / 2 * marks->pixels_per_mm * sqrt(0.5);
    struct paint_point on_ring = { marks->middle.x + reach, marks->middle.y - reach };
    struct annotation_label *label = reach > 0 ? add_label(labels, on_ring, false) : NULL;
    if (label)
        ring_words(label->text, marks->ring_mm, "");
    label = marks->has_planned ? add_label(labels, marks->planned_entry, false) : NULL;
    if (label)
        (void)snprintf(label->text, sizeof label->text, "planned source end");
    add_numbers(labels, marks);
}

bool beam_label(struct annotations *annotations, const struct snapshot *snapshot, const struct camera *camera,
                int width_px, struct error *err)
{
    struct beam_eye_marks marks;
    const struct view *view = &snapshot->view;
    struct annotation_label *grown =
        realloc(annotations->labels, (annotations->n_labels + BEAM_MAX_LABELS) * sizeof *grown);
    if (!grown)
        return error_set(err, ERROR_MEMORY, "no memory for the labels of a beam");
    annotations->labels = grown;
    const struct labels labels = { annotations, view->size_px,
                                   (double)annotate_text_px(width_px) * view->size_px[0] / width_px };
    add_names(&labels, snapshot, camera);
    if (beam_eye_marks_of(snapshot, camera, &marks))
        add_eye(&labels, &marks);
    return true;
}
