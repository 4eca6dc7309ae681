/* Turns the options of `beamroom render` about beams and tracks into merge patches on scene and view. */
#include "server/cli/render_beam.h"

#include <string.h>

#include "core/track/track.h"
#include "server/cli/render_words.h"

static bool add_beams(const struct render_beam *options, const cJSON *plan, cJSON *beam, struct error *err)
{
    const char *first = json_text(cJSON_GetArrayItem(render_field(plan, "beams"), 0), "id");
    for (int i = 0; i < options->n_beams; i++) {
        const char *id = options->beams[i][0] ? options->beams[i] : first;
        if (!id && plan)
            return error_set(err, ERROR_RANGE, "--beam: the plan has no beams; --draft ENTRY:TARGET draws one");
        if (!id)
            continue;
        cJSON *look = render_member(render_member(beam, "looks"), id);
        if (!look->child)
            cJSON_AddTrueToObject(look, "visible");
        if (i == 0)
            cJSON_AddStringToObject(beam, "id", id);
    }
    return true;
}

static bool add_draft(const char *text, cJSON *beam, struct error *err)
{
    double entry[3], target[3];
    const char *at = text;
    bool is_good = render_next_point(&at, ':', entry) && render_next_point(&at, ':', target) && *at == 0;
    if (!is_good || memcmp(entry, target, sizeof entry) == 0)
        return error_set(err, ERROR_RANGE,
                         "--draft '%s' is not ENTRY:TARGET, two places X,Y,Z in mm towards L, P and S", text);
    cJSON *draft = render_member(beam, "draft"), *line = render_member(draft, "line");
    cJSON_AddTrueToObject(draft, "enabled");
    cJSON_AddItemToObject(line, "entry_mm", cJSON_CreateDoubleArray(entry, 3));
    cJSON_AddItemToObject(line, "target_mm", cJSON_CreateDoubleArray(target, 3));
    return true;
}

static bool add_slice(const char *text, cJSON *beam, struct error *err)
{
    double along_mm;
    if (!render_number(text, &along_mm))
        return error_set(err, ERROR_RANGE, "--beam-slice '%s' is not a number of mm from the beam's entry", text);
    cJSON_AddTrueToObject(render_member(beam, "slice"), "visible");
    cJSON_AddNumberToObject(render_member(beam, "slice"), "along_mm", along_mm);
    return true;
}

/* The field of the scene for a class: its word with _ for -. */
static void class_field(enum track_class class, char field[RENDER_WORD_SIZE])
{
    const char *word = track_class_word(class);
    size_t n = 0;
    for (; word[n] && n + 1 < RENDER_WORD_SIZE; n++)
        field[n] = word[n] == '-' ? '_' : word[n];
    field[n] = 0;
}

static bool add_class(const char *word, cJSON *classes)
{
    bool is_known = false;
    for (int i = 0; i < TRACK_N_CLASSES; i++) {
        char name[RENDER_WORD_SIZE];
        class_field((enum track_class)i, name);
        const char *known = track_class_word((enum track_class)i);
        size_t n = strlen(word);
        if (strncmp(known, word, n) != 0 || (known[n] && known[n] != '-')) /* "neutron": all three */
            continue;
        is_known = true;
        cJSON_ReplaceItemInObjectCaseSensitive(classes, name, cJSON_CreateTrue());
    }
    return is_known;
}

static bool add_tracks(const char *text, const cJSON *plan, cJSON *patch, struct error *err)
{
    if (plan && json_number(render_field(plan, "tracks"), "segments", 0) <= 0)
        return error_set(err, ERROR_RANGE, "--tracks: the plan has no tracks");
    cJSON *tracks = render_member(patch, "tracks");
    cJSON_AddTrueToObject(tracks, "visible");
    for (int i = 0; *text && i < TRACK_N_CLASSES; i++) {
        char name[RENDER_WORD_SIZE];
        class_field((enum track_class)i, name);
        cJSON_AddFalseToObject(render_member(tracks, "classes"), name);
    }
    for (const char *at = text; *at;) {
        char word[RENDER_WORD_SIZE];
        if (!render_next_word(&at, ',', word) || !add_class(word, render_member(tracks, "classes")))
            return error_set(err, ERROR_RANGE,
                             "--tracks '%s' is not some of neutron, neutron-low, neutron-medium, neutron-high, gamma, "
                             "gamma-low, gamma-medium, gamma-high, lost and beam-line with commas between",
                             text);
    }
    return true;
}

/* The option given that shows something of the chosen beam; NULL: none. */
static const char *needs_beam(const struct render_beam *options)
{
    if (options->slice)
        return "--beam-slice";
    if (options->has_clip)
        return "--clip beam";
    if (options->along)
        return "--along";
    if (options->ring)
        return "--ring";
    bool is_of_beam = options->kind && strncmp(options->kind, "beam", 4) == 0;
    return is_of_beam ? "--kind" : NULL;
}

static bool expect_beam(const struct render_beam *options, const cJSON *plan, const cJSON *scene, struct error *err)
{
    const char *option = needs_beam(options);
    bool has_draft = options->draft || json_flag(render_field(render_field(scene, "beam"), "draft"), "enabled", false);
    if (!plan || !option || has_draft || cJSON_GetArraySize(render_field(plan, "beams")) > 0)
        return true;
    return error_set(err, ERROR_RANGE, "%s: the plan has no beams; --draft ENTRY:TARGET draws one", option);
}

cJSON *render_beam_patch(const struct render_beam *options, const cJSON *plan, const cJSON *scene, struct error *err)
{
    cJSON *patch = cJSON_CreateObject(), *beam = cJSON_CreateObject();
    bool is_good = add_beams(options, plan, beam, err) && (!options->draft || add_draft(options->draft, beam, err)) &&
                   (!options->slice || add_slice(options->slice, beam, err)) &&
                   (!options->tracks || add_tracks(options->tracks, plan, patch, err)) &&
                   expect_beam(options, plan, scene, err);
    if (beam->child)
        cJSON_AddItemToObject(patch, "beam", beam);
    else
        cJSON_Delete(beam);
    if (is_good)
        return patch;
    cJSON_Delete(patch);
    return NULL;
}

bool render_beam_add_view(const struct render_beam *options, cJSON *patch, struct error *err)
{
    double mm;
    const char *of_view = options->ring ? "--ring" : options->along ? "--along" : NULL, *kind = options->kind;
    if (of_view && kind && strcmp(kind, "beam") != 0)
        return error_set(err, ERROR_RANGE, "%s is of the beam's-eye view, and --kind is %s", of_view, kind);
    if (of_view)
        kind = "beam";
    if (kind)
        cJSON_AddStringToObject(patch, "kind", kind);
    if (options->along) {
        if (!render_number(options->along, &mm))
            return error_set(err, ERROR_RANGE, "--along '%s' is not a number of mm from the beam's entry",
                             options->along);
        cJSON_AddNumberToObject(render_member(patch, "beam"), "along_mm", mm);
    }
    if (options->ring) {
        if (!render_number(options->ring, &mm))
            return error_set(err, ERROR_RANGE, "--ring '%s' is not a diameter in mm", options->ring);
        cJSON_AddNumberToObject(render_member(patch, "beam"), "aperture_mm", mm);
    }
    return true;
}
