#pragma once
/* Scene and view as JSON documents and as structs: merge patches with their checks, defaults, a view's override. Pure
 * functions on documents. Thread: any. */
#include "wire_gen.h"

/* Largest number of rooms of one daemon (--max-rooms), and so of scenes that one renderer keeps: all rooms may be on
 * one plan. */
enum { SCENE_MAX_ROOMS = 10000 };

/* current with patch applied, as a new document: patch_apply of patch.h. defaults is the scene the renderer gave for
 * the plan. NULL with problem, current untouched. */
NODISCARD cJSON *scene_document_patch(const cJSON *plan, const cJSON *defaults, const cJSON *current,
                                      const cJSON *patch, struct problem *problem);
/* current for a plan that was loaded again and may have changed: patch_renew of patch.h. NULL: no memory. */
NODISCARD cJSON *scene_document_renew(const cJSON *plan, const cJSON *defaults, const cJSON *current);
/* Like scene_document_patch, for a view; current NULL: a new view. The override is checked by scene_document_for_view.
 */
NODISCARD cJSON *view_document_patch(const cJSON *current, const cJSON *patch, struct problem *problem);
/* The scene that a view shows: scene with the view's override applied, checked as a patch on the scene; the pointer of
 * a problem then begins with /override. */
NODISCARD cJSON *scene_document_for_view(const cJSON *plan, const cJSON *defaults, const cJSON *scene,
                                         const cJSON *view, struct problem *problem);

/* To structs for core; scene_finish and view_finish free them. */
NODISCARD bool scene_read(const cJSON *json, struct scene *scene, struct problem *problem);
NODISCARD bool view_read(const cJSON *json, struct view *view, struct problem *problem);
NODISCARD cJSON *scene_write(const struct scene *scene);
NODISCARD cJSON *camera_write(const struct scene_camera *camera);
