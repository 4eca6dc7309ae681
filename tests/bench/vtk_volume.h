#pragma once
/* The other side of bench_volume.c: VTK's volume mappers, in a process of their own (vtk_volume.py). */
#include "core/volume/volume.h"
#include "scene.h"
#include "tests/bench/peer.h"

struct vtk_volume {
    struct peer peer;
    char voxels[PEER_PATH_SIZE], setup[PEER_PATH_SIZE]; /* its files */
    char version[16], gl[64];
};

/* A volume of int16 whose voxels are its values, with axes along the patient's. False: there is no VTK for Python, or
 * no Mesa to draw with; nothing is to be ended then. */
bool vtk_volume_start(struct vtk_volume *vtk, const struct volume *volume, const struct scene_transfer_point *points,
                      size_t n_points, bool is_shaded);
void vtk_volume_end(struct vtk_volume *vtk);

struct vtk_volume_time {
    double ms, busy_ms; /* until the picture is in memory; of all processors */
    long n_covered_px;
};
/* Draws a picture in perspective. mapper: fixed or smart; method: ray or mip. False: it failed. */
bool vtk_volume_draw(struct vtk_volume *vtk, const char *mapper, const char *method, double step_mm,
                     const int size_px[2], const struct scene_camera *camera, struct vtk_volume_time *time);
