#pragma once
/* Inside core/formats: reading JSON of a plan's folder with a place for every sentence. Only plan_json*.c include it.
 */
#include <cjson/cJSON.h>

#include "core/formats/plan_json.h"

/* Where we are in the document, for sentences. */
struct place {
    const char *file;
    char path[120];
    struct report *report;
    struct error *err;
};

struct place place_at(const struct place *up, const char *list, int index);
bool place_fail(const struct place *place, enum error_code code, const char *key, const char *what); /* false */
/* The document, an object; NULL after saying the line. The caller deletes it. */
NODISCARD cJSON *place_document(const uint8_t *data, size_t size, const char *file, struct error *err);
/* Values of keys; absent ones are "", false, an empty list. false: of the wrong kind, said. */
NODISCARD bool place_text(const struct place *place, const cJSON *object, const char *key, char *out, size_t size);
NODISCARD bool place_path(const struct place *place, const cJSON *object, const char *key, bool is_required,
                          char out[FOLDER_NAME_SIZE]);
NODISCARD bool place_bool(const struct place *place, const cJSON *object, const char *key, bool *out);
NODISCARD bool place_point(const struct place *place, const cJSON *object, const char *key, struct vec3 *out);
NODISCARD bool place_list(const struct place *place, const cJSON *object, const char *key, size_t most,
                          const cJSON **list);
NODISCARD bool place_color(const struct place *place, const cJSON *object, bool *has_color,
                           uint8_t rgb[3]); /* key "color" */
void place_note_keys(const struct place *place, const cJSON *object,
                     const char *const *known); /* reports those not known */

NODISCARD bool plan_json_beams(const struct place *top, const cJSON *root, struct plan_file *file); /* "beams" */
