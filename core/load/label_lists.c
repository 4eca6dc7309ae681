/* Finds the lists of label names in a folder without plan.json, and the label map that each belongs to. */
#include "core/load/label_lists.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/formats/plan/plan_json.h"
#include "core/formats/text.h"
#include "core/load/part_names.h"
#include "core/load/reader_table.h"

enum { LIST_MAX_BYTES = 16 << 20, LISTS_MAX_MIB = 64 /* of all lists in a folder */, MOST_LISTS = PLAN_FILE_MAX_PARTS };

struct name_list {
    char path[FOLDER_NAME_SIZE];
    char map[FOLDER_NAME_SIZE]; /* the label map that its "file" names, in the same folder; "" none */
};

struct name_lists {
    struct name_list *lists;
    size_t n;
};

static int folder_length(const char *path)
{
    return (int)(part_base_name(path) - path);
}

/* "a/parts.nii.gz" and ".json" give "a/parts.json"; false when that is too long. */
static bool with_ending(const char *path, const char *ending, char out[FOLDER_NAME_SIZE])
{
    int stem = folder_length(path) + part_stem_length(part_base_name(path));
    int n = snprintf(out, FOLDER_NAME_SIZE, "%.*s%s", stem, path, ending);
    return n > 0 && n < FOLDER_NAME_SIZE;
}

static bool labels_beside(const char *path, char out[FOLDER_NAME_SIZE])
{
    int n = snprintf(out, FOLDER_NAME_SIZE, "%.*slabels.json", folder_length(path), path);
    return n > 0 && n < FOLDER_NAME_SIZE;
}

#define MAP_ENDINGS(reader) reader.grid ? reader.grid->map_endings : NULL,

static bool has_grid_beside(const struct folder *folder, const char *list)
{
    const char *const *const endings[] = { PART_READERS(MAP_ENDINGS) };
    char grid[FOLDER_NAME_SIZE];
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++)
        for (const char *const *ending = endings[i]; ending && *ending; ending++)
            if (with_ending(list, *ending, grid) && folder_look(folder, grid, NULL) == FOLDER_FILE)
                return true;
    return false;
}

/* A list that cannot be read is kept without a map. Reading the label map it is called after then reports the fault. */
static void add_list(struct name_lists *lists, const struct folder *folder, const char *path)
{
    struct name_list *list = &lists->lists[lists->n++];
    struct bytes bytes;
    struct label_names names = { 0 };
    snprintf(list->path, sizeof list->path, "%s", path);
    if (!folder_read(folder, path, LIST_MAX_BYTES, UINT64_MAX, &bytes, NULL))
        return;
    if (label_names_parse(bytes.data, bytes.size, path, &names, NULL) && names.file[0]) {
        int n = snprintf(list->map, sizeof list->map, "%.*s%s", folder_length(path), path, names.file);
        if (n >= (int)sizeof list->map)
            snprintf(list->map, sizeof list->map, "%s", names.file); /* too long for any file here: it matches none */
    }
    label_names_finish(&names);
    bytes_free(&bytes);
}

struct name_lists *name_lists_find(const struct folder *folder, const struct folder_tree *tree,
                                   const atomic_bool *cancel, struct report *report)
{
    struct name_lists *lists = mem_new(sizeof *lists);
    lists->lists = mem_new(MOST_LISTS * sizeof *lists->lists);
    uint64_t left = (uint64_t)LISTS_MAX_MIB << 20;
    size_t n_unread = 0;
    const char *first_unread = "";
    for (size_t i = 0; i < tree->n_files && lists->n < MOST_LISTS && !(cancel && atomic_load(cancel)); i++) {
        const char *path = tree->files[i].name;
        uint64_t n_bytes = tree->files[i].bytes < LIST_MAX_BYTES ? tree->files[i].bytes : LIST_MAX_BYTES;
        if (!text_has_ending(path, ".json") ||
            (strcmp(part_base_name(path), "labels.json") != 0 && !has_grid_beside(folder, path)))
            continue;
        if (n_bytes > left) {
            first_unread = n_unread++ == 0 ? path : first_unread;
            continue;
        }
        left -= n_bytes;
        add_list(lists, folder, path);
    }
    if (n_unread > 0)
        report_add(
            report, REPORT_WARNING, "region.names-limit", first_unread,
            "The folder's lists of label names have more than %d MiB together; this and %zu more were not read, and their names not used.",
            LISTS_MAX_MIB, n_unread - 1);
    return lists;
}

void name_lists_destroy(struct name_lists *lists)
{
    if (!lists)
        return;
    free(lists->lists);
    free(lists);
}

static const struct name_list *list_at(const struct name_lists *lists, const char *path)
{
    for (size_t i = 0; i < lists->n; i++)
        if (strcmp(lists->lists[i].path, path) == 0)
            return &lists->lists[i];
    return NULL;
}

static const struct name_list *list_naming(const struct name_lists *lists, const char *map)
{
    for (size_t i = 0; i < lists->n; i++)
        if (strcmp(lists->lists[i].map, map) == 0)
            return &lists->lists[i];
    return NULL;
}

bool name_lists_has_map(const struct name_lists *lists, const char *map)
{
    return list_naming(lists, map) != NULL;
}

/* A file of regions and the list of names it has of its own. */
struct label_map {
    bool is_grid, names_itself;
    const struct name_list *own;
};

/* The list whose "file" is the map; else the list called after the map, unless its "file" is another map. */
static const struct name_list *own_list(const struct name_lists *lists, const char *map)
{
    char path[FOLDER_NAME_SIZE];
    const struct name_list *list = list_naming(lists, map);
    if (list)
        return list;
    list = with_ending(map, ".json", path) ? list_at(lists, path) : NULL;
    return list && !list->map[0] ? list : NULL;
}

static struct label_map look_at(const struct name_lists *lists, const struct folder *folder, const char *path)
{
    const struct grid_reader *grid = part_reader_of(folder, path)->grid;
    struct label_map map = { grid != NULL, false, own_list(lists, path) };
    struct grid_facts facts;
    if (grid && grid->read_layers)
        map.names_itself = grid->peek(folder, path, &facts, NULL) && facts.has_segments;
    return map;
}

/* The one map of the list's folder that a list without a "file" can mean: the map it is called after; else the only map
 * without names of its own; else the only such map not called a mask, as masks have no list. SIZE_MAX: none or several.
 */
static size_t only_candidate(const struct plan_file *file, const struct label_map *maps, const struct name_list *list)
{
    static const char *const words[] = { "mask" };
    size_t n = 0, n_maps = 0, any = SIZE_MAX, map = SIZE_MAX, length = (size_t)folder_length(list->path);
    for (size_t i = 0; i < file->n_regions; i++) {
        const char *path = file->regions[i].path;
        if (!maps[i].is_grid || maps[i].names_itself || (size_t)folder_length(path) != length ||
            strncmp(path, list->path, length) != 0)
            continue;
        if (maps[i].own == list)
            return i;
        if (maps[i].own)
            continue;
        n++;
        any = i;
        if (!part_name_has_word(part_base_name(path), words, 1)) {
            n_maps++;
            map = i;
        }
    }
    return n == 1 ? any : n_maps == 1 ? map : SIZE_MAX;
}

/* owner: the map that the list belongs to; "" when unknown. */
static void note_elsewhere(struct report *report, const char *map, const char *list, const char *owner)
{
    if (owner[0])
        report_add(
            report, REPORT_WARNING, "region.names-elsewhere", map,
            "%.120s belongs to %.120s, so it names nothing here. For names give this map a list as \"names\" in a plan.json.",
            list, owner);
    else
        report_add(
            report, REPORT_WARNING, "region.names-elsewhere", map,
            "%.120s does not name its map, and several lie beside it; its names were not used. Say it in a plan.json, as \"names\" of the map.",
            list);
}

static void assign(const struct name_lists *lists, struct plan_file *file, const struct label_map *maps, size_t at,
                   struct report *report)
{
    struct plan_file_region *region = &file->regions[at];
    char path[FOLDER_NAME_SIZE];
    const struct name_list *list = maps[at].own;
    if (!list) {
        const struct name_list *beside = labels_beside(region->path, path) ? list_at(lists, path) : NULL;
        if (!beside || maps[at].names_itself)
            return;
        size_t owner = beside->map[0] ? SIZE_MAX : only_candidate(file, maps, beside);
        if (owner != at) {
            note_elsewhere(report, region->path, beside->path,
                           owner < file->n_regions ? file->regions[owner].path : beside->map);
            return;
        }
        list = beside;
    }
    memcpy(region->names, list->path, sizeof region->names);
}

void name_lists_assign(const struct name_lists *lists, const struct folder *folder, struct plan_file *file,
                       struct report *report)
{
    if (lists->n == 0)
        return;
    struct label_map *maps = mem_new((file->n_regions + 1) * sizeof *maps);
    for (size_t i = 0; i < file->n_regions; i++)
        maps[i] = look_at(lists, folder, file->regions[i].path);
    for (size_t i = 0; i < file->n_regions; i++)
        if (maps[i].is_grid)
            assign(lists, file, maps, i, report);
    free(maps);
    for (size_t i = 0; i < lists->n; i++)
        if (lists->lists[i].map[0] && folder_look(folder, lists->lists[i].map, NULL) != FOLDER_FILE)
            report_add(report, REPORT_WARNING, "region.names-elsewhere", lists->lists[i].path,
                       "The list says that it belongs to %.200s, which is not there; its names were not used.",
                       lists->lists[i].map);
}
