/* Asks the renderer, collects its answers into the record, and ends with or without them. */
#include "server/net/keep_figures.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/auth/digest.h"
#include "server/net/schedule.h"
#include "server/wire/document.h"
#include "server/wire/json.h"

/* The pictures first: STORE_FIGURES of them, by their place. */
enum { ASK_DOSE = STORE_FIGURES, ASK_DVH, ASK_LIMITS, ASK_FITS, ASK_BEAM, ASK_IRRADIATION, ASK_IDENTITY, N_ASKED };
static const char *const names[N_ASKED] = {
    "axial picture", "sagittal picture", "coronal picture", "3-D picture", "dose", "dvh", "limits", "fits",
    "beam",          "irradiation",      "identity"
};
static const char *const kinds[STORE_FIGURES] = { "axial", "sagittal", "coronal", "3d" };

struct asked {
    struct gathering *gathering;
    uint64_t request; /* of the fleet; 0: it waits for nothing */
};
struct gathering {
    struct net_room *entry;
    struct prompt_write *prompt;
    void (*done)(struct net_room *entry, struct prompt_write *prompt);
    struct asked asked[N_ASKED];
    int n_waiting;
    int64_t until_us;
    cJSON *kept, *missing, *figures;
    cJSON *views[STORE_FIGURES]; /* as they were drawn */
};

static void destroy(struct gathering *gathering)
{
    for (size_t i = 0; i < STORE_FIGURES; i++)
        cJSON_Delete(gathering->views[i]);
    cJSON_Delete(gathering->kept);
    cJSON_Delete(gathering->missing);
    cJSON_Delete(gathering->figures);
    free(gathering);
}

static void add_missing(struct gathering *gathering, int what, const char *why)
{
    cJSON *row = cJSON_CreateObject();
    cJSON_AddStringToObject(row, "what", names[what]);
    cJSON_AddStringToObject(row, "why", why);
    json_append(gathering->missing, row);
}

/* ---- facts of the moment ------------------------------------------------------------------------------------------ */

/* The server's own zone: a record says its times in it, wherever and whenever it is printed. */
static cJSON *describe_zone(void)
{
    const time_t now = (time_t)(clock_wall_ms() / 1000);
    struct tm local = { 0 };
    cJSON *zone = cJSON_CreateObject();
    const bool is_known = localtime_r(&now, &local) != NULL;
    cJSON_AddStringToObject(zone, "name", is_known && local.tm_zone ? local.tm_zone : "UTC");
    cJSON_AddNumberToObject(zone, "offset_min", is_known ? (double)(local.tm_gmtoff / 60) : 0);
    return zone;
}

static void copy_fields(cJSON *to, const cJSON *from, const char *const *fields)
{
    for (; *fields; fields++) {
        const cJSON *field = cJSON_GetObjectItemCaseSensitive(from, *fields);
        if (field)
            json_add(to, *fields, cJSON_Duplicate(field, true));
    }
}

static void copy_list(cJSON *to, const cJSON *document, const char *name, const char *const *fields)
{
    cJSON *list = cJSON_CreateArray();
    const cJSON *item;
    cJSON_ArrayForEach(item, cJSON_GetObjectItemCaseSensitive(document, name))
    {
        cJSON *row = cJSON_CreateObject();
        copy_fields(row, item, fields);
        json_append(list, row);
    }
    json_add(to, name, list);
}

/* The facts of the plan's document that paper names; patients in their masked form alone. */
static cJSON *describe_plan(const struct fleet_plan *plan)
{
    static const char *const whole[] = {
        "id", "name", "is_phantom", "note", "shown_patient", "shown_plan", "treatment_plans", "statement", NULL
    };
    static const char *const of_patient[] = { "masked", "has_conflict", NULL };
    static const char *const of_image[] = { "id", "name", "modality", "unit", "patient", NULL };
    static const char *const of_region[] = { "id", "name", "color", "is_target", "voxels", "volume_cm3", NULL };
    static const char *const of_dose[] = { "id", "name", "unit", "per", "beam", "patient", "plan", NULL };
    static const char *const of_beam[] = { "id", "name", "aperture_mm", NULL };
    cJSON *json = cJSON_CreateObject();
    copy_fields(json, plan->document, whole);
    copy_list(json, plan->document, "patients", of_patient);
    copy_list(json, plan->document, "images", of_image);
    copy_list(json, plan->document, "regions", of_region);
    copy_list(json, plan->document, "doses", of_dose);
    copy_list(json, plan->document, "beams", of_beam);
    return json;
}

/* ---- the views that are drawn ------------------------------------------------------------------------------------- */

/* The shared view of this kind with the lowest number, as the room had it; NULL: it had none. mover: who moved it last.
 */
static const cJSON *view_of_room(const cJSON *views, const char *kind, const char **mover)
{
    const cJSON *entry, *best = NULL;
    cJSON_ArrayForEach(entry, views)
    {
        const cJSON *view = cJSON_GetObjectItemCaseSensitive(entry, "view");
        const char *word = json_text(view, "kind");
        if (!word || strcmp(word, kind) != 0 ||
            (best && json_number(view, "number", 1) >= json_number(best, "number", 1)))
            continue;
        best = view;
        *mover = json_text(entry, "mover");
    }
    return best;
}

/* The view at the size of a picture to print. NULL: no memory. */
static cJSON *view_to_draw(const cJSON *views, const char *kind, const char **mover)
{
    const cJSON *of_room = view_of_room(views, kind, mover);
    cJSON *patch = of_room ? cJSON_Duplicate(of_room, true) : cJSON_CreateObject();
    if (!of_room)
        cJSON_AddStringToObject(patch, "kind", kind);
    cJSON_DeleteItemFromObjectCaseSensitive(patch, "size_px");
    cJSON_DeleteItemFromObjectCaseSensitive(patch, "foot_px"); /* on paper nothing of a page stands there */
    json_add(patch, "size_px", cJSON_CreateDoubleArray((double[]){ KEEP_FIGURE_WIDTH_PX, KEEP_FIGURE_HEIGHT_PX }, 2));
    cJSON *view = view_document_patch(NULL, patch, NULL);
    cJSON_Delete(patch);
    return view;
}

/* ---- answers ------------------------------------------------------------------------------------------------------ */

static void finish(struct gathering *gathering);

static void take_picture(struct gathering *gathering, int place, struct packet *answer)
{
    struct store_record *record = &gathering->prompt->row->records[0];
    char hash[DIGEST_TEXT];
    if (answer->type != PACKET_FRAME || !answer->blob || answer->n_blob < 4 ||
        answer->n_blob > STORE_MAX_FIGURE_BYTES) {
        char why[100];
        (void)snprintf(why, sizeof why, "the picture has %zu bytes, 4 to %d are kept",
                       answer->blob ? answer->n_blob : 0, STORE_MAX_FIGURE_BYTES);
        add_missing(gathering, place, why);
        return;
    }
    record->figures[place] = (struct store_figure){ .bytes = answer->blob, .n_bytes = answer->n_blob };
    answer->blob = NULL;
    digest_bytes(record->figures[place].bytes, record->figures[place].n_bytes, hash);
    cJSON *figure = cJSON_CreateObject();
    cJSON_AddNumberToObject(figure, "place", place);
    cJSON_AddStringToObject(figure, "kind", kinds[place]);
    cJSON_AddNumberToObject(figure, "width_px", (double)answer->frame.width_px);
    cJSON_AddNumberToObject(figure, "height_px", (double)answer->frame.height_px);
    cJSON_AddNumberToObject(figure, "n_bytes", (double)record->figures[place].n_bytes);
    cJSON_AddStringToObject(figure, "sha256", hash);
    json_add(figure, "view", gathering->views[place]);
    gathering->views[place] = NULL;
    json_add(figure, "caption",
             answer->frame.caption ? cJSON_Duplicate(answer->frame.caption, true) : cJSON_CreateArray());
    json_add(figure, "missing",
             answer->frame.missing ? cJSON_Duplicate(answer->frame.missing, true) : cJSON_CreateNull());
    json_append(gathering->figures, figure);
}

/* The identity stands in the record as a hash alone: names are asked for anew where somebody may read them. */
static void take_identity(struct gathering *gathering, const cJSON *body)
{
    char hash[DIGEST_TEXT];
    const cJSON *patients = cJSON_GetObjectItemCaseSensitive(body, "patients");
    char *text = patients && cJSON_GetArraySize(patients) ? json_print(patients) : NULL;
    if (!text)
        return; /* the files say no identity */
    digest_text(text, hash);
    cJSON_AddStringToObject(gathering->kept, "identity_sha256", hash);
    free(text);
}

static void take_answer(struct gathering *gathering, int what, struct packet *answer)
{
    char why[120];
    if (answer->type != PACKET_ANSWER) {
        add_missing(gathering, what, "the renderer's answer is not one to this question");
    } else if (what == ASK_IDENTITY) {
        take_identity(gathering, answer->answer.body);
    } else {
        char *text = json_print(answer->answer.body);
        const size_t n = text ? strlen(text) : 0;
        (void)snprintf(why, sizeof why, "it has %zu bytes, at most %d are kept", n, KEEP_MAX_ANSWER_BYTES);
        if (text && n <= KEEP_MAX_ANSWER_BYTES)
            json_add(gathering->kept, names[what], cJSON_Duplicate(answer->answer.body, true));
        else
            add_missing(gathering, what, text ? why : "there was no memory for it");
        free(text);
    }
}

static void answered(void *context, struct packet *answer, const struct problem *problem)
{
    struct asked *asked = context;
    struct gathering *gathering = asked->gathering;
    const int what = (int)(asked - gathering->asked);
    asked->request = 0;
    gathering->n_waiting--;
    if (problem)
        add_missing(gathering, what, problem->detail[0] ? problem->detail : "the renderer has not answered");
    else if (what < STORE_FIGURES)
        take_picture(gathering, what, answer);
    else
        take_answer(gathering, what, answer);
    if (gathering->n_waiting == 0)
        finish(gathering);
}

static int by_place(const cJSON *figure)
{
    return (int)json_number(figure, "place", 0);
}

/* Answers come in any order, a record has one. */
static void sort_figures(cJSON *figures)
{
    cJSON *sorted[STORE_FIGURES] = { NULL };
    cJSON *figure;
    while ((figure = cJSON_DetachItemFromArray(figures, 0)))
        sorted[by_place(figure)] = figure;
    for (size_t i = 0; i < STORE_FIGURES; i++)
        if (sorted[i])
            json_append(figures, sorted[i]);
}

/* body becomes {..., "kept": kept}. False: no memory, and it stays what it was. */
static bool extend_body(struct store_record *record, const cJSON *kept)
{
    char *text = json_print(kept);
    const size_t n_body = strlen(record->body), n_text = text ? strlen(text) : 0;
    char *whole = text && n_body > 1 ? malloc(n_body + n_text + 16) : NULL;
    if (whole) {
        (void)snprintf(whole, n_body + n_text + 16, "%.*s,\"kept\":%s}", (int)(n_body - 1), record->body, text);
        free(record->body);
        record->body = whole;
    }
    free(text);
    return whole != NULL;
}

/* The row of the audit that is committed with it names the record as it is now. */
static bool name_in_audit(struct store_room *row)
{
    char hash[DIGEST_TEXT];
    cJSON *json = json_read(row->audit[0], strlen(row->audit[0]), NULL);
    cJSON *detail = cJSON_GetObjectItemCaseSensitive(json, "detail");
    digest_text(row->records[0].body, hash);
    char *text = NULL;
    if (cJSON_IsObject(detail)) {
        cJSON_DeleteItemFromObjectCaseSensitive(detail, "record_sha256");
        cJSON_AddStringToObject(detail, "record_sha256", hash);
        text = json_print(json);
    }
    cJSON_Delete(json);
    if (!text)
        return false;
    free(row->audit[0]);
    row->audit[0] = text;
    return true;
}

static void finish(struct gathering *gathering)
{
    struct net_room *entry = gathering->entry;
    struct prompt_write *prompt = gathering->prompt;
    struct store_record *record = &prompt->row->records[0];
    char *before = mem_copy_text(record->body);
    sort_figures(gathering->figures);
    json_add(gathering->kept, "figures", gathering->figures);
    json_add(gathering->kept, "missing", gathering->missing);
    gathering->figures = gathering->missing = NULL;
    if (extend_body(record, gathering->kept) && name_in_audit(prompt->row)) {
        free(before);
    } else { /* the record as it was, without pictures that it does not name */
        log_error("room %s: a decision is kept without its pictures: no memory", room_id(entry->room));
        free(record->body);
        record->body = before;
        for (size_t i = 0; i < STORE_FIGURES; i++) {
            free(record->figures[i].bytes);
            record->figures[i] = (struct store_figure){ 0 };
        }
    }
    void (*done)(struct net_room * entry, struct prompt_write * prompt) = gathering->done;
    prompt->gathering = NULL;
    destroy(gathering);
    done(entry, prompt);
}

/* ---- questions ---------------------------------------------------------------------------------------------------- */

static void ask(struct gathering *gathering, int what, struct packet *packet)
{
    struct asked *asked = &gathering->asked[what];
    struct net_room *entry = gathering->entry;
    gathering->n_waiting++;
    asked->request = fleet_request(entry->net->fleet, room_plan_id(entry->room), packet, answered, asked);
}

static void ask_picture(struct gathering *gathering, int place, const struct packet_snapshot *shown, const cJSON *views,
                        const struct fleet_plan *plan)
{
    const char *mover = NULL;
    struct problem ignored = { 0 };
    struct packet packet;
    cJSON *view = view_to_draw(views, kinds[place], &mover);
    if (!view) {
        add_missing(gathering, place, "there was no memory for it");
        return;
    }
    const bool has_override = cJSON_IsObject(cJSON_GetObjectItemCaseSensitive(view, "override"));
    cJSON *scene = has_override
                       ? scene_document_for_view(plan->document, plan->default_scene, shown->scene, view, &ignored)
                       : NULL;
    packet_init(&packet, PACKET_RENDER);
    packet.render.shown = *shown;
    packet.render.shown.view = view;
    if (scene)
        packet.render.shown.scene = scene;
    packet.render.quality = KEEP_FIGURE_QUALITY;
    packet.render.full_color = packet.render.still = packet.render.annotations = packet.render.caption_apart = true;
    packet.render.crosshair = true;
    (void)snprintf(packet.render.source, sizeof packet.render.source, "%s/record", room_id(gathering->entry->room));
    ask(gathering, place, &packet);
    cJSON_Delete(scene);
    if (mover)
        cJSON_AddStringToObject(view, "moved_by", mover);
    gathering->views[place] = view;
}

static void ask_all(struct gathering *gathering, const struct packet_snapshot *shown, const cJSON *views,
                    const struct fleet_plan *plan)
{
    struct packet packet;
    for (int place = 0; place < STORE_FIGURES; place++)
        ask_picture(gathering, place, shown, views, plan);
    packet_init(&packet, PACKET_DOSE);
    packet.dose.shown = *shown;
    ask(gathering, ASK_DOSE, &packet);
    packet_init(&packet, PACKET_DVH);
    packet.dvh.shown = *shown;
    packet.dvh.bins = KEEP_DVH_BINS;
    ask(gathering, ASK_DVH, &packet);
    packet_init(&packet, PACKET_CONSTRAINTS);
    packet.constraints.shown = *shown;
    ask(gathering, ASK_LIMITS, &packet);
    packet_init(&packet, PACKET_FITS);
    packet.fits.shown = *shown;
    ask(gathering, ASK_FITS, &packet);
    packet_init(&packet, PACKET_BEAM);
    packet.beam.shown = *shown;
    ask(gathering, ASK_BEAM, &packet);
    packet_init(&packet, PACKET_IRRADIATION);
    packet.irradiation.shown = *shown;
    ask(gathering, ASK_IRRADIATION, &packet);
    packet_init(&packet, PACKET_IDENTITY);
    ask(gathering, ASK_IDENTITY, &packet);
}

bool keep_figures_begin(struct net_room *entry, struct prompt_write *prompt,
                        void (*done)(struct net_room *entry, struct prompt_write *prompt))
{
    struct store_room *row = prompt->row;
    struct fleet_plan plan;
    if (!row->n_records || strcmp(row->records[0].kind, "decision") != 0)
        return false;
    const bool is_found = fleet_plan_find(entry->net->fleet, room_plan_id(entry->room), &plan);
    cJSON *body = json_read(row->records[0].body, strlen(row->records[0].body), NULL);
    const cJSON *scene = cJSON_GetObjectItemCaseSensitive(body, "scene");
    if (!is_found || !cJSON_IsObject(scene)) { /* nobody has seen the plan in this room: there is nothing to keep */
        cJSON_Delete(body);
        return false;
    }
    struct gathering *gathering = mem_new(sizeof *gathering);
    *gathering = (struct gathering){ .entry = entry,
                                     .prompt = prompt,
                                     .done = done,
                                     .until_us = clock_now_us() + KEEP_FIGURES_MS * INT64_C(1000),
                                     .kept = cJSON_CreateObject(),
                                     .missing = cJSON_CreateArray(),
                                     .figures = cJSON_CreateArray() };
    for (int i = 0; i < N_ASKED; i++)
        gathering->asked[i].gathering = gathering;
    cJSON_AddNumberToObject(gathering->kept, "version", 1);
    json_add(gathering->kept, "zone", describe_zone());
    json_add(gathering->kept, "plan", describe_plan(&plan));
    const struct packet_snapshot shown = { .scene = scene, .acceptances = room_acceptances(entry->room) };
    ask_all(gathering, &shown, cJSON_GetObjectItemCaseSensitive(body, "views"), &plan);
    cJSON_Delete(body);
    prompt->gathering = gathering;
    schedule_at(entry->net, gathering->until_us);
    return true;
}

/* ---- without answers ---------------------------------------------------------------------------------------------- */

static void end_late(struct gathering *gathering)
{
    for (int i = 0; i < N_ASKED; i++) {
        if (!gathering->asked[i].request)
            continue;
        fleet_forget_request(gathering->entry->net->fleet, gathering->asked[i].request);
        gathering->asked[i].request = 0;
        char why[80];
        (void)snprintf(why, sizeof why, "the renderer has not answered within %d s", KEEP_FIGURES_MS / 1000);
        add_missing(gathering, i, why);
    }
    finish(gathering);
}

/* One that has waited too long; NULL: none has. */
static struct gathering *find_late(const struct net *net, int64_t now_us)
{
    for (size_t i = 0; i < net->n_rooms; i++)
        for (const struct prompt_write *prompt = net->rooms[i]->keep.prompts; prompt; prompt = prompt->next) {
            if (!prompt->gathering)
                continue;
            if (prompt->gathering->until_us <= now_us)
                return prompt->gathering;
        }
    return NULL;
}

void keep_figures_due(struct net *net)
{
    const int64_t now_us = clock_now_us();
    for (struct gathering *late; (late = find_late(net, now_us));)
        end_late(late);
    for (size_t i = 0; i < net->n_rooms; i++)
        for (const struct prompt_write *prompt = net->rooms[i]->keep.prompts; prompt; prompt = prompt->next)
            if (prompt->gathering)
                schedule_at(net, prompt->gathering->until_us);
}

void keep_figures_forget(struct net_room *entry, struct prompt_write *prompt)
{
    struct gathering *gathering = prompt->gathering;
    if (!gathering)
        return;
    for (int i = 0; i < N_ASKED; i++)
        if (gathering->asked[i].request)
            fleet_forget_request(entry->net->fleet, gathering->asked[i].request);
    prompt->gathering = NULL;
    destroy(gathering);
}
