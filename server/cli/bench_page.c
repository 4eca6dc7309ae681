/* The Markdown page of `beamroom bench --thesis`: our figures beside those of the thesis. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "server/cli/bench_thesis.h"

/* Table 1 of the thesis: "4mm data set with a single region, the scalp", Sun Ultra 10, 300 MHz, Creator3D. The sample
 * columns: Sera3d's own functions on the sample head that SERA comes with, on one core of a present-day processor
 * without a graphics card. */
static const struct {
    const char *method, *polygons, *seconds, *fps, *sample_polygons, *sample_seconds, *sample_fps;
} thesis[3] = {
    { "8-cell, surface normals", "98,636", "3.6", "1.89", "137,132", "0.11", "10-14" },
    { "8-cell, vertex normals", "98,636", "8.0", "1.82", "137,132", "0.21", "10-14" },
    { "Marching cubes", "156,258", "5.3", "1.25", "189,092", "0.25", "7-10" },
};

static void put_count(FILE *out, size_t n)
{
    char digits[32];
    int length = snprintf(digits, sizeof digits, "%zu", n);
    for (int i = 0; i < length; i++) {
        if (i > 0 && (length - i) % 3 == 0)
            fputc(',', out);
        fputc(digits[i], out);
    }
}

/* Three significant figures; a dash for not-a-number. */
static void put_number(FILE *out, double value)
{
    if (!isfinite(value)) {
        fputs("-", out);
        return;
    }
    double size = fabs(value);
    fprintf(out, "%.*f", size >= 100 || size == 0 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : size >= 0.1 ? 3 : 4, value);
}

/* Replaces what would end a table cell: names come from files. */
static void put_name(FILE *out, const char *name)
{
    for (const char *c = name; *c; c++)
        fputc(*c == '|' || (unsigned char)*c < 32 ? ' ' : *c, out);
}

static void put_table1(FILE *out, const struct bench_plan *plan)
{
    fputs("\n### ", out);
    put_name(out, plan->name);
    fputs(": ", out);
    put_name(out, plan->scalp);
    fputs("\n\n| Algorithm | Polygons | Construction (s) | Rendering (fps) |\n|---|---:|---:|---:|\n", out);
    for (int i = 0; i < 3; i++) {
        const struct bench_row *row = &plan->table1[i];
        fprintf(out, "| %s | ", thesis[i].method);
        put_count(out, row->facts.n_triangles);
        fputs(" | ", out);
        put_number(out, row->made_ms / 1000);
        fputs(" | ", out);
        put_number(out, 1000 / row->draw_ms);
        fputs(" |\n", out);
    }
}

static void put_row(FILE *out, const struct bench_row *row)
{
    fputs("| ", out);
    put_name(out, row->region);
    fprintf(out, " | %s | ", row->method);
    if (row->refusal[0]) {
        fputs("refused: ", out);
        put_name(out, row->refusal);
        fputs(" | | | | | | | | |\n", out);
        return;
    }
    const struct shape_facts *facts = &row->facts;
    bool has_mesh = facts->n_triangles > 0;
    if (has_mesh)
        put_count(out, facts->n_triangles);
    else
        fputs("-", out);
    fputs(" | ", out);
    put_count(out, facts->n_vertices ? facts->n_vertices : facts->n_points);
    fputs(" | ", out);
    put_number(out, row->made_ms);
    fputs(" | ", out);
    put_number(out, 1000 / row->draw_ms);
    fputs(" | ", out);
    put_number(out, has_mesh ? facts->area_mm2 / 100 : NAN);
    fputs(" | ", out);
    put_number(out, has_mesh ? facts->volume_mm3 / 1000 : NAN);
    fputs(" | ", out);
    put_number(out, facts->univel_volume_mm3 / 1000);
    fputs(" | ", out);
    put_number(out, has_mesh && facts->univel_volume_mm3 > 0 ? 100 * (facts->volume_mm3 / facts->univel_volume_mm3 - 1)
                                                             : NAN);
    fputs(" | ", out);
    put_number(out, facts->distance_max_mm);
    fputs(" |\n", out);
}

char *bench_page(const struct bench_machine *machine, const struct bench_plan *plans, size_t n_plans)
{
    char *text = NULL;
    size_t n_text = 0;
    FILE *out = open_memstream(&text, &n_text);
    if (!out)
        return NULL;
    fputs(
        "# The thesis's tables beside ours\n\n"
        "Made by `beamroom bench --thesis`; nothing in it is written by hand. Figures of other machines than the one named are the thesis's\n"
        "and Sera3d's own.\n\n",
        out);
    fprintf(out, "Machine: %s, %d cores; %s; drawn by %s; window %d x %d, one region alone, full detail.\n",
            machine->processor, machine->n_cores, machine->system, machine->back_end, BENCH_SIZE_PX, BENCH_SIZE_PX);
    fputs(
        "\n## Table 1: polygonal surfaces\n\n"
        "| Algorithm | Thesis: polygons | s | fps | Sera3d on its sample head: polygons | s | fps |\n|---|---:|---:|---:|---:|---:|---:|\n",
        out);
    for (int i = 0; i < 3; i++)
        fprintf(out, "| %s | %s | %s | %s | %s | %s | %s |\n", thesis[i].method, thesis[i].polygons, thesis[i].seconds,
                thesis[i].fps, thesis[i].sample_polygons, thesis[i].sample_seconds, thesis[i].sample_fps);
    fputs(
        "\nThe thesis: another head with 4 mm slices, a Sun Ultra 10 (300 MHz) with Creator3D graphics. Sera3d on its sample head: its own\n"
        "functions on a present-day processor, one llvmpipe thread. Sera3d leaves surfaces open where the scan ends; ours are closed there, and have\n"
        "the more polygons for it. Ours:\n",
        out);
    for (size_t i = 0; i < n_plans; i++)
        put_table1(out, &plans[i]);
    fputs("\n## Table 2: medical images\n\n| Method | Thesis (fps) |", out);
    for (size_t i = 0; i < n_plans; i++) {
        fputs(" ", out);
        put_name(out, plans[i].name);
        fputs(" |", out);
    }
    fputs("\n|---|---:|", out);
    for (size_t i = 0; i < n_plans; i++)
        fputs("---:|", out);
    static const char *const ways[BENCH_N_IMAGE_WAYS] = {
        [BENCH_SLICE] = "Single slice inlaid, linear | 25",
        [BENCH_VOLUME_NEAREST] = "Volume, 256 slices, nearest | 0.18",
        [BENCH_VOLUME_LINEAR] = "Volume, 256 slices, linear | 0.09",
        [BENCH_RAY] = "Volume, rays through every voxel, lit | -",
        [BENCH_RAY_PLAIN] = "Volume, rays through every voxel, not lit | -",
    };
    for (int way = 0; way < BENCH_N_IMAGE_WAYS; way++) {
        fprintf(out, "\n| %s |", ways[way]);
        for (size_t i = 0; i < n_plans; i++) {
            fputs(" ", out);
            put_number(out, plans[i].image_fps[way]);
            fputs(" |", out);
        }
    }
    fputs(
        "\n\n## Every region, every method\n\n"
        "Made: region to shape, every thread, median. Drawn: pictures a second while it turns, median. To univels: enclosed volume against the\n"
        "univels'. Off: largest distance of a vertex from the border of the univels.\n",
        out);
    for (size_t i = 0; i < n_plans; i++) {
        fputs("\n### ", out);
        put_name(out, plans[i].name);
        fputs(
            "\n\n| Region | Method | Polygons | Vertices | Made (ms) | Drawn (fps) | Area (cm2) | Encloses (cm3) | Univels (cm3) | To univels (%) | Off (mm) |\n"
            "|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n",
            out);
        for (size_t r = 0; r < plans[i].n_rows; r++)
            put_row(out, &plans[i].rows[r]);
    }
    bool is_whole = !ferror(out);
    if (fclose(out) == 0 && is_whole)
        return text;
    free(text);
    return NULL;
}
