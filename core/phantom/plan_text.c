/* Writes plan.json, labels.json and the README of the phantom. */
#include "core/phantom/plan_text.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "core/phantom/depth_dose.h"
#include "core/phantom/head.h"

static char *close_text(FILE *out, char **text, struct error *err)
{
    bool is_whole = out && !ferror(out);
    if (out && fclose(out) == 0 && is_whole && *text) /* closing may leave no text and say nothing */
        return *text;
    free(*text);
    *text = NULL;
    error_set(err, ERROR_MEMORY, "no memory for the phantom's text");
    return NULL;
}

static void print_hierarchy(FILE *out)
{
    fprintf(out, "  \"hierarchy\": {");
    for (int label = PHANTOM_SCALP; label < PHANTOM_TUMOUR; label++)
        fprintf(out, "%s\"%s\": [\"%s\"]", label > PHANTOM_SCALP ? ", " : " ", phantom_tissues[label].name,
                phantom_tissues[label + 1].name);
    fprintf(out, " },\n");
}

static void print_dose(FILE *out)
{
    fprintf(
        out,
        "  \"doses\": [\n"
        "    { \"id\": \"goorley\", \"unit\": \"Gy\", \"per\": \"minute at 1e10 n/cm2/s\", \"mask\": \"dose/valid.nii.gz\",\n"
        "      \"components\": [\n");
    for (int i = 0; i < PHANTOM_N_COMPONENTS; i++)
        fprintf(out, "        { \"quantity\": \"%s\", %s\"path\": \"dose/%s.nii.gz\" }%s\n",
                dose_quantity_word(phantom_components[i].quantity),
                phantom_components[i].is_per_ppm ? "\"per_ppm\": true, " : "",
                dose_quantity_word(phantom_components[i].quantity), i + 1 < PHANTOM_N_COMPONENTS ? "," : "");
    fprintf(out, "      ] }\n  ],\n");
}

char *phantom_plan_json(const struct phantom_options *options, struct error *err)
{
    char *text = NULL;
    size_t n_bytes;
    FILE *out = open_memstream(&text, &n_bytes);
    if (!out)
        return close_text(NULL, &text, err);
    struct vec3 target = phantom_tissues[PHANTOM_BRAIN].shape.centre_lps_mm;
    fprintf(out, "{\n  \"format\": \"beamroom-plan\", \"version\": 1,\n");
    fprintf(out, "  \"name\": \"Phantom: modified Snyder head\",\n  \"phantom\": true,\n");
    fprintf(
        out,
        "  \"note\": \"Made up, no patient. Head, beam and dose on the axis: Goorley, Kiger, Zamenhof, Med Phys 29 (2002) 145. "
        "Ours: target, tumour, the dose off the axis (logistic edge, see README.txt), the tracks (random walk, not transport) and "
        "a dense ball on the left side of the scalp, in the image only, that tells left from right. Seed %" PRIu64
        ".\",\n",
        options->seed);
    fprintf(out, "  \"images\": [ { \"id\": \"ct\", \"path\": \"ct.nii.gz\", \"modality\": \"CT\" } ],\n");
    fprintf(out, "  \"regions\": [ { \"path\": \"labels.nii.gz\", \"names\": \"labels.json\" } ],\n");
    print_hierarchy(out);
    print_dose(out);
    fprintf(
        out,
        "  \"beams\": [ { \"id\": \"beam-1\", \"entry_mm\": [0, 0, %g], \"target_mm\": [%g, %g, %g], \"aperture_mm\": %g } ],\n",
        phantom_scalp_top_mm(0, 0), target.x, target.y, target.z, 2 * phantom_beam_radius_mm);
    fprintf(out, "  \"tracks\": [ { \"path\": \"tracks.pp\", \"unit\": \"mm\" } ]\n}\n");
    return close_text(out, &text, err);
}

char *phantom_labels_json(struct error *err)
{
    char *text = NULL;
    size_t n_bytes;
    FILE *out = open_memstream(&text, &n_bytes);
    if (!out)
        return close_text(NULL, &text, err);
    fprintf(out, "{\n  \"labels\": [\n");
    for (int label = PHANTOM_SCALP; label < PHANTOM_N_LABELS; label++)
        fprintf(out, "    { \"value\": %d, \"name\": \"%s\", \"color\": \"%s\" }%s\n", label,
                phantom_tissues[label].name, phantom_tissues[label].color, label + 1 < PHANTOM_N_LABELS ? "," : "");
    fprintf(out, "  ]\n}\n");
    return close_text(out, &text, err);
}

char *phantom_readme(const struct phantom_options *options, struct error *err)
{
    char *text = NULL;
    size_t n_bytes;
    FILE *out = open_memstream(&text, &n_bytes);
    if (!out)
        return close_text(NULL, &text, err);
    fprintf(
        out,
        "A phantom, written by `beamroom phantom --size %ux%ux%u --seed %" PRIu64
        "`. No patient; not for treatment.\n\n"
        "Source: J. T. Goorley, W. S. Kiger III, R. G. Zamenhof, Med. Phys. 29 (2002) 145: the modified Snyder head, a parallel\n"
        "disk beam from above (radius %g mm, 1e10 n/cm2/s; 10 %% thermal, 89 %% epithermal, 1 %% fast) and the dose on its axis.\n\n"
        "Ellipsoids (mm, patient: x to the left, y to the back, z up); each holds the next:\n",
        options->size[0], options->size[1], options->size[2], options->seed, phantom_beam_radius_mm);
    for (int label = PHANTOM_SCALP; label < PHANTOM_N_LABELS; label++) {
        const struct phantom_tissue *t = &phantom_tissues[label];
        fprintf(out, "  %d %-8s centre %3g %3g %3g   semi-axes %3g %3g %3g   %4g HU%s\n", label, t->name,
                t->shape.centre_lps_mm.x, t->shape.centre_lps_mm.y, t->shape.centre_lps_mm.z, t->shape.semi_axes_mm.x,
                t->shape.semi_axes_mm.y, t->shape.semi_axes_mm.z, t->hounsfield,
                label >= PHANTOM_TARGET ? "   (ours)" : "");
    }
    fprintf(
        out,
        "Tissues (ICRU 46): scalp as skin 1.09 g/cm3, cranium 1.61, brain and what it holds 1.04. The image has noise of about 5 HU.\n"
        "A ball of %g HU, radius %g mm, centre %g %g %g, marks the LEFT side: in the image only, no region.\n\n",
        phantom_marker_hounsfield, phantom_marker.semi_axes_mm.x, phantom_marker.centre_lps_mm.x,
        phantom_marker.centre_lps_mm.y, phantom_marker.centre_lps_mm.z);
    fprintf(
        out,
        "Dose: Gy per minute in brain tissue at every depth; boron for 1 ppm of boron-10. On the axis, the paper's table:\n"
        "  depth mm");
    for (int i = 0; i < PHANTOM_N_COMPONENTS; i++)
        fprintf(out, "  %9s", dose_quantity_word(phantom_components[i].quantity));
    for (int depth = 0; depth < PHANTOM_N_DEPTHS; depth++) {
        fprintf(out, "\n  %8g", phantom_depths_mm[depth]);
        for (int i = 0; i < PHANTOM_N_COMPONENTS; i++)
            fprintf(out, "  %9g", phantom_components[i].table[depth]);
    }
    fprintf(
        out,
        "\nNitrogen is the paper's thermal column. Between depths: monotone cubic of the logarithm; beyond the ends: the slope there.\n"
        "Off the axis (ours): D(d, r) = T(d) (1 + exp(-R/w)) / (1 + exp((r - R)/w)), R = %g mm, d straight down from the scalp,\n",
        phantom_beam_radius_mm);
    for (int i = 0; i < PHANTOM_N_COMPONENTS; i++)
        fprintf(out, "  %-8s w = %g mm + %g d\n", dose_quantity_word(phantom_components[i].quantity),
                phantom_components[i].edge_mm, phantom_components[i].edge_per_depth);
    fprintf(
        out,
        "0 outside the head, where dose/valid.nii.gz is 0.\n\n"
        "Tracks: a random walk that looks like transport and is none; SERA's .pp columns, mm. SERA writes energy 0 for gammas;\n"
        "here they carry 1 high, 2 medium, 3 low as neutrons do.\n");
    return close_text(out, &text, err);
}
