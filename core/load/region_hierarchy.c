/* Gives regions their parents from pairs of names. */
#include "core/load/region_hierarchy.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/formats/text.h"

/* A graph: names are the nodes, an edge leads from an inner to its outer name. */
struct names {
    const char **name;
    int *region; /* index in the set; -1: no region of this plan */
    int *depth;  /* edges on the longest way up to a root; -1: not known yet */
    size_t n;
    const struct plan_file_pair *pairs;
    size_t (*edges)[2]; /* [n_edges] inner, outer */
    size_t n_edges;
};

/* is_by_id: tries ids before names. Our own plan.json uses ids, and another region may be named like an id; other files
 * use names only. */
static int find_region(const struct region_set *set, const char *name, bool is_by_id)
{
    const struct region *known = is_by_id ? region_find(set, name) : NULL;
    if (known)
        return (int)(known - set->regions);
    for (size_t r = 0; r < set->n_regions; r++)
        if (text_equal(set->regions[r].name, name) || strcmp(set->regions[r].id, name) == 0)
            return (int)r;
    return -1;
}

static size_t find_name(struct names *names, const struct region_set *set, const char *name, bool is_by_id)
{
    for (size_t i = 0; i < names->n; i++)
        if (text_equal(names->name[i], name))
            return i;
    size_t at = names->n++;
    names->name[at] = name;
    names->region[at] = find_region(set, name, is_by_id);
    names->depth[at] = -1;
    return at;
}

/* True if a way up leads from a to b. marks: one zeroed byte for each name. */
static bool leads_to(const struct names *names, size_t a, size_t b, uint8_t *marks)
{
    if (a == b)
        return true;
    marks[a] = 1;
    for (size_t e = 0; e < names->n_edges; e++)
        if (names->edges[e][0] == a && !marks[names->edges[e][1]] && leads_to(names, names->edges[e][1], b, marks))
            return true;
    return false;
}

static int find_depth(struct names *names, size_t at)
{
    if (names->depth[at] >= 0)
        return names->depth[at];
    int depth = 0;
    for (size_t e = 0; e < names->n_edges; e++)
        if (names->edges[e][0] == at) {
            int outer = find_depth(names, names->edges[e][1]);
            depth = outer + 1 > depth ? outer + 1 : depth;
        }
    return names->depth[at] = depth;
}

/* Finds the deepest name above at that is a region of this plan. */
static void find_parent(struct names *names, size_t at, uint8_t *marks, int *parent, int *depth)
{
    for (size_t e = 0; e < names->n_edges; e++) {
        size_t outer = names->edges[e][1];
        if (names->edges[e][0] != at || marks[outer])
            continue;
        marks[outer] = 1;
        if (names->region[outer] < 0) {
            find_parent(names, outer, marks, parent, depth);
        } else if (find_depth(names, outer) > *depth) {
            *depth = find_depth(names, outer);
            *parent = names->region[outer];
        }
    }
}

static bool is_above(const struct region_set *set, int region, int of)
{
    for (; of >= 0; of = set->regions[of].parent)
        if (of == region)
            return true;
    return false;
}

void region_set_apply_pairs(struct region_set *set, const struct plan_file_pair *pairs, size_t n_pairs, bool is_strict,
                            const char *where, struct report *report)
{
    size_t most = 2 * n_pairs + 1;
    struct names names = { .name = mem_new(most * sizeof(char *)),
                           .region = mem_new(most * sizeof(int)),
                           .depth = mem_new(most * sizeof(int)),
                           .edges = mem_new(most * sizeof(size_t[2])) };
    uint8_t *marks = mem_new(most);
    for (size_t i = 0; i < n_pairs; i++) {
        size_t outer = find_name(&names, set, pairs[i].outer, is_strict),
               inner = find_name(&names, set, pairs[i].inner, is_strict);
        memset(marks, 0, most);
        if (leads_to(&names, outer, inner, marks)) {
            report_add(report, REPORT_WARNING, "hierarchy.cycle", where,
                       "\"%s > %s\" would put a region inside itself; left out.", pairs[i].outer, pairs[i].inner);
            continue;
        }
        names.edges[names.n_edges][0] = inner;
        names.edges[names.n_edges++][1] = outer;
    }
    for (size_t at = 0; at < names.n; at++) {
        if (names.region[at] < 0) {
            if (is_strict)
                report_add(report, REPORT_WARNING, "hierarchy.unknown-name", where, "There is no region \"%s\".",
                           names.name[at]);
            continue;
        }
        int parent = -1, depth = -1;
        memset(marks, 0, most);
        find_parent(&names, at, marks, &parent, &depth);
        if (parent < 0)
            continue;
        if (is_above(set, names.region[at], parent)) { /* one region under two names: its name and its id */
            report_add(report, REPORT_WARNING, "hierarchy.cycle", where, "\"%s\" would lie inside itself; left out.",
                       names.name[at]);
            continue;
        }
        set->regions[names.region[at]].parent = parent;
        set->hierarchy = HIERARCHY_FILE;
    }
    free(names.name);
    free(names.region);
    free(names.depth);
    free(names.edges);
    free(marks);
}
