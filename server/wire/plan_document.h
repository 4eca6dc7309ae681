#pragma once
/* A loaded plan as JSON: what GET /api/v1/plans/{id}, the messages `welcome` and `plan` and `beamroom info --json`
 * give. Names and numbers, no voxels. Regions are in file order. Numbers that are not finite are null.
 *
 * {
 *   id, name, note, is_phantom,
 *   load_ms,
 *   bounds_mm: box | null,
 *   home: {"3d": camera, axial, coronal, sagittal, oblique, beam, "beam-slice"},  of views without a camera; each
 *     as the camera of a view; of beam, place and direction do not count
 *   images: [ {id, name, modality, unit, grid, low, high, window: {center, width}, is_inverted} ],
 *   regions: [ {
 *     id, name, is_target, color: "#rrggbb", color_from_file, parent: id | null, depth,
 *     grid, label, voxels, volume_cm3, center_mm: point | null, bounds_mm: box | null,  null: it has no voxels
 *     touches_edge,
 *     tissue: {boron_ratio, cbe_boron, rbe_nitrogen, rbe_fast, rbe_gamma}  null: not in the plan
 *   } ],
 *   hierarchy: "none" | "file" | "derived",
 *   doses: [ {
 *     id, name, unit, per, masked,
 *     frame_of_reference: "same" | "unknown" | "differs" | null,  DICOM: compared with the image's; null: no DICOM
 *     fit, fit_reason,  with the first image: relation and reason as in fits
 *     components: [ {
 *       quantity, unit, per_ppm, grid, low, high,
 *       boron_ppm,  boron in blood that a total includes; null: not known
 *       reference, body_high  null: not known
 *     } ]
 *   } ],
 *   beams: [ {id, name, entry_mm, target_mm, aperture_mm | null, delivery: {number, radiation, machine, ...} | null} ],
 *   tracks: {
 *     segments, classes: {"neutron-high": n, ...},
 *     looks: [ {class, color: "#rrggbb", dash_px: [on, off] | null, has_cross} ]  of the classes with segments
 *   },
 *   curves: [ {  reference curves along a beam
 *     id, name, unit, per, depth_mm: [low, high], radius_mm: [low, high],
 *     quantities: [ {quantity, unit, per_ppm, peak, peak_depth_mm} ]  peaks on the axis
 *   } ],
 *   fits: [ {thing, with, relation, reasons, reason, needs} ],  which parts may be combined: plan_fits.h
 *   preferences: {levels: [ {percent, color} ], colors: ["#rrggbb"]},  of the program that the plan comes from
 *   report: {lines: [ {severity: "note" | "warning" | "error", code, where, sentence} ], dropped},
 *   patients: [ {masked, has_identity: true, has_conflict} ],  "A. V. ...417"; empty: no patient identity in the files
 *   statement: {kind: "one-person" | "identity", state: "used" | "outdated" | "contradicted", by, time_ms, words}
 *     | null,  what a person has stated of whom the plan is of: core/plan/statement.h
 *   treatment_plans: [ {
 *     label, name, date, time, approval, review_date, reviewer, fractions | null, prescription_gy | null, patient,
 *     structs, is_structs_absent,
 *     beams | null,  number of beams for treatment
 *     beam_doses: [id]  doses of single beams that add up to the plan's, by the beams' order; empty: not each has one
 *   } ],
 *   shown_patient, shown_plan: index in patients, in treatment_plans | null
 * }
 *
 * Each image, region, dose and beam has its origins: patient and plan, indices in patients and treatment_plans;
 * is_plan_absent: its files name a treatment plan that is not here; frame and study, numbers of its frame of reference
 * and its study; a region, and a treatment plan, also structs, the number of its structure set; a region that has the
 * name of one of another file also set, the label of its structure set, or its file. null: not stated, or
 * not here. Equal numbers mean the same frame, study or set.
 *
 *   point      [L, P, S] in mm
 *   box        {low: point, high: point}
 *   grid       {size: [i, j, k], spacing_mm: [i, j, k], orientation: "LPS", lps_mm_from_ijk: 3 rows of 4, bounds_mm}
 *   low, high  smallest and largest finite value
 *
 * Thread: any; the plan is frozen. */
#include "core/plan/plan.h"
#include "server/wire/json.h"

/* A new object, for cJSON_Delete. NULL: no memory. */
NODISCARD cJSON *plan_document(const struct plan *plan);
/* {kind: "jaws" | "leaves" | "blocks", polygons_mm: [[[x, y], ...], ...]} along the collimator axes; null for none. */
cJSON *beam_outline_object(const struct beam_outline *outline);
