/* The further pages of a record: figures, checklist, who was present, notes, saved views, hashes. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "server/paper/blocks.h"

static const cJSON *get(const cJSON *object, const char *name)
{
    return cJSON_GetObjectItemCaseSensitive(object, name);
}

static const char *text_of(const cJSON *object, const char *name)
{
    const char *text = json_text(object, name);
    return text ? text : "";
}

/* ---- figures ------------------------------------------------------------------------------------------------------ */

/* The name of who moved the view last; "" where that is not known. */
static const char *mover_of(const struct paper *paper, const cJSON *figure)
{
    const char *member = text_of(get(figure, "view"), "moved_by");
    const cJSON *stay;
    cJSON_ArrayForEach(stay, get(paper->record, "present"))
    {
        if (member[0] && strcmp(text_of(stay, "member"), member) == 0)
            return text_of(stay, "name");
    }
    return "";
}

/* Whether two captions have the same words in this row. */
static bool is_same_row(const cJSON *a, const cJSON *b, const char *row)
{
    const cJSON *of_a = get(a, "caption"), *of_b = get(b, "caption");
    of_a = of_a ? of_a->child : NULL;
    of_b = of_b ? of_b->child : NULL;
    for (;;) {
        while (of_a && strcmp(text_of(of_a, "row"), row) != 0)
            of_a = of_a->next;
        while (of_b && strcmp(text_of(of_b, "row"), row) != 0)
            of_b = of_b->next;
        if (!of_a || !of_b)
            return of_a == of_b;
        if (strcmp(text_of(of_a, "text"), text_of(of_b, "text")) != 0)
            return false;
        of_a = of_a->next;
        of_b = of_b->next;
    }
}

static void add_part(cJSON *list, const char *rgb, cJSON *text)
{
    cJSON *part = cJSON_CreateObject();
    cJSON_AddStringToObject(part, "rgb", rgb);
    json_add(part, "text", text);
    json_append(list, part);
}

static bool is_slice(const cJSON *figure)
{
    const char *kind = text_of(figure, "kind");
    return strcmp(kind, "axial") == 0 || strcmp(kind, "sagittal") == 0 || strcmp(kind, "coronal") == 0;
}

static const char *written_crosshair(const struct paper *paper, char text[PAPER_PLACE])
{
    static const char *const names[3] = { "sagittal", "coronal", "axial" }; /* at L, P, S */
    const cJSON *slices = get(get(paper->scene, "image"), "slices");
    cJSON *point = cJSON_CreateArray();
    for (int axis = 0; axis < 3; axis++) {
        const cJSON *position = get(get(slices, names[axis]), "position_mm");
        if (cJSON_IsNumber(position))
            json_append(point, cJSON_CreateNumber(position->valuedouble));
    }
    (void)written_place(point, text);
    cJSON_Delete(point);
    return text;
}

/* The words of a caption: row "pane" names plane and place and is the title; the rest stands below. What is the same as
 * in figure 1 is not said again. */
static void add_caption(const struct paper *paper, const cJSON *figure, cJSON *to)
{
    static const char *const rows[] = { "levels", "dose", "regions", "beam", "methods", "missing" };
    cJSON *list = cJSON_AddArrayToObject(to, "caption");
    const cJSON *item, *first = cJSON_GetArrayItem(get(paper->kept, "figures"), 0);
    const char *mover = mover_of(paper, figure);
    int n_pane = 0, n_same = 0;
    char place[PAPER_PLACE];
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const bool is_same = figure != first && i < 3 && is_same_row(figure, first, rows[i]);
        n_same += is_same;
        cJSON_ArrayForEach(item, get(figure, "caption"))
        {
            if (!is_same && strcmp(text_of(item, "row"), rows[i]) == 0)
                add_part(list, text_of(item, "rgb"), written(text_of(item, "text")));
        }
    }
    cJSON_ArrayForEach(item, get(figure, "caption")) /* image and window, behind kind and place */
    {
        if (strcmp(text_of(item, "row"), "pane") == 0 && n_pane++ >= 2)
            add_part(list, "", written(text_of(item, "text")));
    }
    if (is_slice(figure) && written_crosshair(paper, place)[0])
        add_part(list, "", written_format("crosshair %s", place));
    if (n_same)
        add_part(list, "", written("dose, levels and regions not named here as in figure 1"));
    if (mover[0])
        add_part(list, "", written_format("view as %.300s left it", mover));
}

static cJSON *title_of(const cJSON *figure, int number)
{
    const char *words[2] = { "", "" };
    const cJSON *item;
    int n = 0;
    cJSON_ArrayForEach(item, get(figure, "caption"))
    {
        if (strcmp(text_of(item, "row"), "pane") == 0 && n < 2)
            words[n++] = text_of(item, "text");
    }
    return written_format("Figure %d: %.100s%s%.200s", number, words[0][0] ? words[0] : text_of(figure, "kind"),
                          words[1][0] ? ", " : "", words[1]);
}

static cJSON *figure_block(struct paper *paper, const char *width)
{
    cJSON *block = cJSON_CreateObject();
    cJSON_AddStringToObject(block, "type", "figures");
    cJSON_AddStringToObject(block, "width", width);
    (void)cJSON_AddArrayToObject(block, "figures");
    json_append(paper->blocks, block);
    return block;
}

/* The first large, the next two beside each other, the last one large. */
static void add_figures(struct paper *paper)
{
    const cJSON *figure;
    cJSON *block = NULL;
    int number = 0;
    if (!cJSON_GetArraySize(get(paper->kept, "figures")))
        return;
    block_page(paper);
    cJSON_ArrayForEach(figure, get(paper->kept, "figures"))
    {
        const double of = json_number(figure, "place", 0);
        const int place = of >= 0 && of < 100 ? (int)of : 0;
        const bool is_half = place == 1 || place == 2;
        if (!is_half || !block || strcmp(text_of(block, "width"), "half") != 0)
            block = figure_block(paper, is_half ? "half" : "whole");
        cJSON *to = cJSON_CreateObject();
        cJSON_AddNumberToObject(to, "place", place);
        cJSON_AddNumberToObject(to, "width_px", json_number(figure, "width_px", 1600));
        cJSON_AddNumberToObject(to, "height_px", json_number(figure, "height_px", 1200));
        json_add(to, "title", title_of(figure, ++number));
        add_caption(paper, figure, to);
        json_append((cJSON *)get(block, "figures"), to);
    }
}

/* ---- lists -------------------------------------------------------------------------------------------------------- */

/* Entries of the page's checklist (web/js/features/record): for those that nobody marked, whose words no item has. */
static const char *const entries[][2] = {
    { "identity", "Plan, patient position and treated side are those of the prescription" },
    { "registration", "Images are registered, and oriented as the patient lies" },
    { "regions", "Targets and organs at risk are complete and rightly named" },
    { "boron", "Boron concentrations, ratios and biological weights are as prescribed" },
    { "dose", "Dose is plausible by component and in total; unit and fraction are clear" },
    { "constraints", "Constraints of organs at risk and the coverage of the target are met" },
    { "beam", "Beam, aperture, gap and irradiation time are as planned" },
    { "positioning", "The position can be set up, and checked at the beam" },
    { "deviations", "Deviations from the protocol are named and justified" },
};
enum { N_ENTRIES = sizeof entries / sizeof entries[0] };

/* -1: an entry that a member added. */
static int entry_of(const cJSON *item)
{
    const char *id = text_of(item, text_of(item, "entry")[0] ? "entry" : "id");
    for (int i = 0; i < N_ENTRIES; i++)
        if (strcmp(entries[i][0], id) == 0)
            return i;
    return -1;
}

static void add_mark(const struct paper *paper, cJSON *table, const cJSON *item)
{
    const char *state = text_of(item, "state");
    const bool is_ok = strcmp(state, "ok") == 0, is_issue = strcmp(state, "issue") == 0;
    cJSON *row = table_row(table);
    char time[PAPER_TIME];
    row_add(row, written(text_of(item, "text")), "");
    row_add(row,
            written(is_ok      ? "\xe2\x9c\x93 OK"
                    : is_issue ? "! Issue"
                               : "Open"),
            is_ok      ? "ok"
            : is_issue ? "err"
                       : "");
    row_add(row, written(text_of(item, "comment")), "");
    row_add(row,
            written_format("%.300s, %s", text_of(item, "changed_name"),
                           written_time(paper, json_number(item, "changed_ms", NAN), time)),
            "");
}

/* Adds the marks of an entry that were made of the files and the patient of the decision. False: it has none. */
static bool add_marks(const struct paper *paper, cJSON *table, int entry)
{
    const cJSON *item;
    bool has_mark = false;
    cJSON_ArrayForEach(item, get(paper->record, "checklist"))
    {
        if (entry_of(item) == entry && paper_is_of_same(paper, item)) {
            add_mark(paper, table, item);
            has_mark = true;
        }
    }
    return has_mark;
}

static void add_unmarked(cJSON *table, const char *words)
{
    cJSON *row = table_row(table);
    row_add(row, written(words), "");
    row_add(row, written("not marked"), "warn");
    row_add(row, written(""), "");
    row_add(row, written(""), "");
}

static void add_checklist(struct paper *paper)
{
    static const struct paper_column columns[] = {
        { "Entry", 40, 'l' }, { "State", 12, 'l' }, { "What is wrong", 25, 'l' }, { "By", 23, 'l' }
    };
    block_heading(paper, "Checklist", "");
    cJSON *table = block_table(paper, columns, 4);
    for (int entry = 0; cJSON_IsArray(get(paper->record, "checklist")) && entry < N_ENTRIES; entry++)
        if (!add_marks(paper, table, entry))
            add_unmarked(table, entries[entry][1]);
    (void)add_marks(paper, table, -1);
    table_end(paper, table, "It was not kept with this decision.");
}

static void add_present(struct paper *paper)
{
    static const struct paper_column columns[] = {
        { "Person", 40, 'l' }, { "Role", 16, 'l' }, { "From", 22, 'l' }, { "To", 22, 'l' }
    };
    const cJSON *stay;
    char time[PAPER_TIME];
    const double dropped = json_number(paper->record, "n_present_dropped", 0);
    block_heading(paper, "Present", "until the decision");
    cJSON *table = block_table(paper, columns, 4);
    cJSON_ArrayForEach(stay, get(paper->record, "present"))
    {
        const double left = json_number(stay, "left_ms", NAN);
        cJSON *row = table_row(table);
        row_add(row, written_person(stay, "name", "user"), "");
        row_add(row, written(text_of(stay, "role")), "");
        row_add(row, written(written_time(paper, json_number(stay, "entered_ms", NAN), time)), "");
        row_add(row,
                isfinite(left) ? written(written_time(paper, left, time))
                               : written(json_flag(stay, "here", false) ? "at the decision" : "until the server ended"),
                "");
    }
    table_end(paper, table, "Nobody.");
    if (dropped > 0)
        block_text(paper, written_format("%.0f earlier stays were not kept.", dropped), "pale");
}

static void add_notes(struct paper *paper)
{
    static const struct paper_column columns[] = { { "Note", 46, 'l' }, { "Place", 24, 'l' }, { "By", 30, 'l' } };
    const cJSON *note;
    char time[PAPER_TIME], place[PAPER_PLACE];
    block_heading(paper, "Notes", "");
    cJSON *table = block_table(paper, columns, 3);
    cJSON_ArrayForEach(note, get(paper->record, "notes"))
    {
        const cJSON *anchor = get(note, "anchor"), *point = get(anchor, "point_mm");
        const char *hidden = text_of(note, "hidden_by"), *region = text_of(anchor, "region");
        cJSON *row = table_row(table), *person = written_person(note, "author_name", "author_user");
        row_add(row, written(text_of(note, "text")), "");
        row_add(row,
                cJSON_IsArray(point) ? written(written_place(point, place))
                : region[0]          ? written_format("region %.100s", region_name(paper, region))
                                     : written(text_of(note, "parent")[0] ? "reply" : "the plan"),
                "");
        row_add(row,
                written_format("%.400s, %s%s%s%.200s", cJSON_GetStringValue(person),
                               written_time(paper, json_number(note, "created_ms", NAN), time),
                               json_flag(note, "resolved", false) ? ", resolved" : "", hidden[0] ? ", hidden by " : "",
                               hidden),
                "");
        cJSON_Delete(person);
    }
    table_end(paper, table, "None.");
}

static void add_views(struct paper *paper)
{
    static const struct paper_column columns[] = { { "Saved view", 60, 'l' }, { "By", 40, 'l' } };
    const cJSON *view;
    char time[PAPER_TIME];
    if (!cJSON_GetArraySize(get(paper->record, "saved_views")))
        return;
    block_heading(paper, "Saved views", "");
    cJSON *table = block_table(paper, columns, 2);
    cJSON_ArrayForEach(view, get(paper->record, "saved_views"))
    {
        cJSON *row = table_row(table), *person = written_person(view, "author_name", "author_user");
        row_add(row, written(text_of(view, "name")), "");
        row_add(row,
                written_format("%.400s, %s", cJSON_GetStringValue(person),
                               written_time(paper, json_number(view, "created_ms", NAN), time)),
                "");
        cJSON_Delete(person);
    }
}

/* ---- hashes ------------------------------------------------------------------------------------------------------- */

static void add_hash(cJSON *table, cJSON *of, const char *hash)
{
    cJSON *row = table_row(table);
    row_add(row, of, "");
    row_add(row, written(hash[0] ? hash : "not known"), "code");
}

static void add_hashes(struct paper *paper)
{
    static const struct paper_column columns[] = { { "SHA-256 of", 36, 'l' }, { "Digits", 64, 'l' } };
    const cJSON *figure;
    int number = 0;
    block_page(paper);
    block_heading(paper, "Hashes in full", "");
    cJSON *table = block_table(paper, columns, 2);
    add_hash(table, written("the plan's files"), text_of(get(paper->source->item, "body"), "plan_revision"));
    add_hash(table, written("this record, as in the audit's row of the decision"), paper->source->hash);
    if (text_of(paper->kept, "identity_sha256")[0])
        add_hash(table, written("the patient's identity at the decision"), text_of(paper->kept, "identity_sha256"));
    cJSON_ArrayForEach(figure, get(paper->kept, "figures"))
    {
        add_hash(table, written_format("figure %d", ++number), text_of(figure, "sha256"));
    }
    block_text(
        paper,
        written_format("Record %.63s of room %.63s on plan %.63s, scene revision %.0f. beamroomd --verify-audit checks "
                       "these against the audit.",
                       paper->source->id, paper->source->room, paper->source->plan,
                       json_number(paper->record, "revision", 0)),
        "pale");
}

void parts_add(struct paper *paper)
{
    add_figures(paper);
    add_checklist(paper);
    add_present(paper);
    add_notes(paper);
    add_views(paper);
    add_hashes(paper);
}
