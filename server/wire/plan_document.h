#pragma once
/* A loaded plan as the API gives it: GET /api/v1/plans/{id}, the messages `welcome` and `plan`, `beamroom info --json`.
 * Only numbers and names, no voxels.
 *
 *   { id, name, note, phantom, load_ms, bounds_mm: {low, high} | null,
 *     home: {"3d": camera, axial, coronal, sagittal},                 where a view without a camera is taken from; as
 * in a view images:  [ {id, modality, unit, grid, low, high, window: {center, width}, is_inverted} ], regions: [ {id,
 * name, color: "#rrggbb", color_from_file, parent: id | null, depth, grid, label, voxels, volume_cm3, center_mm,
 * bounds_mm, touches_edge, tissue: {boron_ratio, cbe_boron, rbe_nitrogen, rbe_fast, rbe_gamma} } ],    null: the plan
 * does not say hierarchy: "none" | "file" | "derived", doses:   [ {id, unit, per, frame_of_reference: "same" |
 * "unknown" | "differs" | null, masked,     DICOM's, beside the image's; null: not DICOM components: [ {quantity, unit,
 * per_ppm, boron_ppm, grid, low, high, reference, body_high} ]} ], boron_ppm: of a total, the boron in blood that is in
 * it; null: not known beams:   [ {id, entry_mm, target_mm, aperture_mm | null} ], tracks:  {segments, classes:
 * {"neutron-high": n, ...}}, curves:  [ {id, name, unit, per, depth_mm: [low, high], radius_mm: [low, high], reference
 * curves along a beam quantities: [ {quantity, unit, per_ppm, peak, peak_depth_mm} ]} ],               peaks are those
 * on the axis preferences: {levels: [ {percent, color} ], colors: ["#rrggbb"]},                        of the program
 * the plan comes from report:  {lines: [ {severity: "note" | "warning" | "error", code, where, sentence} ], dropped} }
 *
 *   grid       {size: [i, j, k], spacing_mm: [i, j, k], orientation: "LPS", lps_mm_from_ijk: 3 rows of 4, bounds_mm}
 *   low, high  smallest and largest finite value; points are [L, P, S] in mm; a region without voxels has no center or
 * bounds (null)
 *
 * Regions are in file order. Numbers that are not finite are null. */
#include "core/plan/plan.h"
#include "server/wire/json.h"

/* A new object, the caller's to cJSON_Delete. Never NULL. */
NODISCARD cJSON *plan_document(const struct plan *plan);
