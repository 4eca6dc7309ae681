#pragma once
/* Writes a mesh as a file for other programs: binary STL, binary PLY, GLB (glTF 2.0). Positions stay in DICOM LPS, mm,
 * and every file says so. Knows no plan and no path; writes ids only, never the name of a person. */
#include "core/surface/mesh.h"

enum mesh_format { MESH_STL, MESH_PLY, MESH_GLB };

struct mesh_export_about {
    const char *plan_id, *region_id, *algorithm; /* at most 63 bytes of each are written */
    bool is_phantom;
    bool is_faceted; /* PLY and GLB without vertex normals, so that readers shade flat; STL always has one normal per
                        triangle */
    uint8_t rgb[3];  /* GLB: base colour, sRGB */
};

/* "stl", "ply" or "glb"; for any other word returns false and leaves *format */
NODISCARD bool mesh_format_from_word(const char *word, enum mesh_format *format);
const char *mesh_format_word(enum mesh_format format);

/* Makes the bytes of a file, little-endian; the caller frees them.
 *
 *   mesh     with normals, unless is_faceted or format is MESH_STL
 *   returns  STL: 84 bytes + 50 per triangle; normals by the right-hand rule, (0 0 0) for a triangle without area. PLY:
 *            float x y z [nx ny nz], faces as "list uchar int vertex_indices". GLB: one mesh in mm LPS below a node
 *            whose matrix converts to glTF's convention: metres, x to the patient's left, y up (superior), z to the
 *            front (anterior). Equal input gives equal bytes.
 *   errors   ERROR_RANGE the mesh has no triangle; ERROR_LIMIT more than max_bytes, or than the format can count (STL
 *            and GLB 2^32 - 1, PLY 2^31 - 1 vertices); ERROR_MEMORY
 *   thread   any
 *   source   STL: 3D Systems, StereoLithography Interface Specification, 1988. PLY: G. Turk, The PLY Polygon File
 *            Format, 1994. GLB: Khronos, glTF 2.0 Specification, 2.0.1. */
NODISCARD uint8_t *mesh_export(const struct mesh *mesh, enum mesh_format format, const struct mesh_export_about *about,
                               uint64_t max_bytes, size_t *n_bytes, struct error *err);
