#pragma once
/* Scene and view as JSON documents: merge patches, defaults, overrides. Pure functions on documents. */
#include "wire_gen.h"

/* Rooms of one daemon at most (--max-rooms), and so scenes that one renderer keeps: all rooms may be on one plan. */
enum { SCENE_MAX_ROOMS = 10000 };

/* current with patch applied, checked whole: fields by proto/scene.json, and every id by plan, the document of the plan
 * (plan_document.h). What patch sets to null gets its value from defaults, the scene the renderer gave for the plan.
 * Returns the complete new document; NULL with problem, current untouched. An id the plan does not have is a validation
 * problem at its field. */
NODISCARD cJSON *scene_document_patch(const cJSON *plan, const cJSON *defaults, const cJSON *current,
                                      const cJSON *patch, struct problem *problem);
/* current for a plan that was loaded again and may have changed: ids it lost are left out, and what else no longer fits
 * gives the whole defaults. Never NULL. */
NODISCARD cJSON *scene_document_renew(const cJSON *plan, const cJSON *defaults, const cJSON *current);
/* What to tell those who keep a copy of document, into which patch has gone: patch, with what it gave its default back
 * as it is there. */
NODISCARD cJSON *document_told_patch(const cJSON *document, const cJSON *patch);
/* As scene_document_patch, for a view; current NULL: a new one. */
NODISCARD cJSON *view_document_patch(const cJSON *current, const cJSON *patch, struct problem *problem);
/* The scene a view shows: scene with the view's override applied, checked as above. */
NODISCARD cJSON *scene_document_for_view(const cJSON *plan, const cJSON *defaults, const cJSON *scene,
                                         const cJSON *view, struct problem *problem);

/* To structs for core; scene_finish / view_finish free them. */
NODISCARD bool scene_read(const cJSON *json, struct scene *scene, struct problem *problem);
NODISCARD bool view_read(const cJSON *json, struct view *view, struct problem *problem);
NODISCARD cJSON *scene_write(const struct scene *scene);
NODISCARD cJSON *camera_write(const struct scene_camera *camera);
