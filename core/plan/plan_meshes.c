#include "core/plan/plan_meshes.h"

#include <stdlib.h>

#include "core/base/mem.h"

struct plan_meshes *plan_meshes_create(size_t n_regions)
{
    struct plan_meshes *meshes = mem_new(sizeof *meshes);
    meshes->n_regions = n_regions;
    meshes->of_region = mem_new((n_regions + 1) * sizeof *meshes->of_region);
    for (int algorithm = 0; algorithm < SURFACE_N_ALGORITHMS; algorithm++) {
        pthread_mutex_init(&meshes->light[algorithm].lock, NULL);
        for (size_t r = 0; r < n_regions; r++)
            for (int detail = 0; detail < 2; detail++)
                pthread_mutex_init(&meshes->of_region[r][algorithm][detail].lock, NULL);
    }
    return meshes;
}

void plan_meshes_destroy(struct plan_meshes *meshes)
{
    if (!meshes)
        return;
    for (int algorithm = 0; algorithm < SURFACE_N_ALGORITHMS; algorithm++) {
        for (size_t r = 0; r < meshes->n_regions; r++)
            for (int detail = 0; detail < 2; detail++) {
                struct plan_mesh *slot = &meshes->of_region[r][algorithm][detail];
                pthread_mutex_destroy(&slot->lock);
                mesh_unref(slot->mesh);
            }
        pthread_mutex_destroy(&meshes->light[algorithm].lock);
    }
    free(meshes->of_region);
    free(meshes);
}
