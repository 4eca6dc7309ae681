#pragma once
/* Record in an annotated PNG beside its pixels, so that the picture can be made again: JSON in its iTXt chunk of the
 * keyword "beamroom".
 *
 * {
 *   version: 1,
 *   program: "Beamroom <version>",
 *   plan: {id, name},
 *   date: "2026-07-01T09:30:00Z",
 *   revision,     of the room's scene; 0: no room's
 *   scene, view   complete documents (scene.json); the view's override is applied to the scene, and left out
 * }
 *
 * Nothing of the patient but the plan's name. Thread: any. */
#include "core/scene/snapshot.h"
#include "server/wire/json.h"

enum { SNAPSHOT_RECORD_VERSION = 1 };
#define SNAPSHOT_RECORD_KEYWORD "beamroom"
/* Returns the record as text, for free(). view: the complete document that the snapshot's view was read from. NULL: no
 * memory. */
NODISCARD char *snapshot_record(const struct snapshot *snapshot, const cJSON *view, int64_t unix_s);
