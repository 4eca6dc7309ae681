/* Starts VTK's volume mappers as another program and asks them for pictures. */
#include "tests/bench/vtk_volume.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The setup, for free(). */
static char *write_setup(const struct vtk_volume *vtk, const struct volume *volume,
                         const struct scene_transfer_point *points, size_t n_points, bool is_shaded)
{
    char *text = NULL;
    size_t n_text = 0;
    FILE *out = open_memstream(&text, &n_text);
    const uint32_t *size = volume->grid.size;
    struct vec3 origin = volume->grid.lps_mm_from_ijk.origin, spacing = grid_spacing_mm(&volume->grid);
    if (!out)
        return NULL;
    fprintf(out,
            "{\"file\":\"%s\",\"type\":\"int16\",\"size\":[%u,%u,%u],\"spacing_mm\":[%.17g,%.17g,%.17g],"
            "\"origin_mm\":[%.17g,%.17g,%.17g],\"is_shaded\":%s,\"points\":[",
            vtk->voxels, size[0], size[1], size[2], spacing.x, spacing.y, spacing.z, origin.x, origin.y, origin.z,
            is_shaded ? "true" : "false");
    for (size_t i = 0; i < n_points; i++)
        fprintf(out, "%s{\"value\":%.17g,\"color\":[%.4f,%.4f,%.4f],\"opacity\":%.17g}", i ? "," : "", points[i].value,
                (double)(points[i].color_rgb >> 16) / 255, (double)(points[i].color_rgb >> 8 & 255) / 255,
                (double)(points[i].color_rgb & 255) / 255, points[i].opacity);
    fputs("]}\n", out);
    if (fclose(out) == 0)
        return text;
    free(text);
    return NULL;
}

bool vtk_volume_start(struct vtk_volume *vtk, const struct volume *volume, const struct scene_transfer_point *points,
                      size_t n_points, bool is_shaded)
{
    char line[128];
    *vtk = (struct vtk_volume){ 0 };
    bool is_good =
        peer_write_file(vtk->voxels, volume->voxels, grid_n_voxels(&volume->grid) * voxel_size(volume->type));
    char *setup = is_good ? write_setup(vtk, volume, points, n_points, is_shaded) : NULL;
    is_good = setup && peer_write_file(vtk->setup, setup, strlen(setup));
    free(setup);
    const char *arguments[] = { peer_python(), "tests/bench/vtk_volume.py", vtk->setup, NULL };
    if (is_good && peer_start(&vtk->peer, arguments, line, sizeof line) &&
        sscanf(line, "%15s %*d %63s", vtk->version, vtk->gl) == 2) {
        for (char *c = vtk->gl; *c; c++)
            *c = *c == '_' ? ' ' : *c;
        return true;
    }
    vtk_volume_end(vtk);
    return false;
}

void vtk_volume_end(struct vtk_volume *vtk)
{
    (void)peer_end(&vtk->peer);
    unlink(vtk->voxels);
    unlink(vtk->setup);
}

bool vtk_volume_draw(struct vtk_volume *vtk, const char *mapper, const char *method, double step_mm,
                     const int size_px[2], const struct scene_camera *camera, struct vtk_volume_time *time)
{
    char question[512], line[128];
    struct vec3 eye = camera->position_mm, target = camera->target_mm, up = camera->up;
    (void)snprintf(question, sizeof question,
                   "%s %s %.17g %d %d %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g\n", mapper, method,
                   step_mm, size_px[0], size_px[1], eye.x, eye.y, eye.z, target.x, target.y, target.z, up.x, up.y, up.z,
                   camera->fov_deg);
    return peer_ask(&vtk->peer, question, line, sizeof line) &&
           sscanf(line, "%lf %lf %ld", &time->ms, &time->busy_ms, &time->n_covered_px) == 3;
}
