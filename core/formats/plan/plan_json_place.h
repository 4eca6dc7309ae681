#pragma once
/* Reads the values of JSON objects of a plan's folder; every error sentence names the file and the place in the
 * document, "doses[1].components[0].path". Only plan_json*.c include it. */
#include <cjson/cJSON.h>

#include "core/formats/folder.h"
#include "core/math/vec.h"
#include "core/report/report.h"

/* Where in a document an object lies. */
struct json_place {
    const char *file;
    char path[120];
    struct report *report;
    struct error *err;
};

/* The place of an entry of a list in the object at up. */
struct json_place place_at(const struct json_place *up, const char *list, int index);
/* Sets the error with the place of the key; returns false. key "": the object itself. */
bool place_fail(const struct json_place *place, enum error_code code, const char *key, const char *what);
/* Parses a document, which must be an object. The caller deletes it. errors ERROR_FORMAT, with the line */
NODISCARD cJSON *place_document(const uint8_t *data, size_t size, const char *file, struct error *err);

/* The value of a key. An absent key gives "", false or no list. Returns false for a value of the wrong kind or out of
 * range, with the error set. */
NODISCARD bool place_text(const struct json_place *place, const cJSON *object, const char *key, char *out, size_t size);
NODISCARD bool place_path(const struct json_place *place, const cJSON *object, const char *key, bool is_required,
                          char out[FOLDER_NAME_SIZE]);
NODISCARD bool place_bool(const struct json_place *place, const cJSON *object, const char *key, bool *out);
NODISCARD bool place_point(const struct json_place *place, const cJSON *object, const char *key, struct vec3 *out);
/* A list of at most `most` objects. */
NODISCARD bool place_list(const struct json_place *place, const cJSON *object, const char *key, size_t most,
                          const cJSON **list);
/* The value of "color": "#rrggbb", or three numbers of 0 to 1 or 0 to 255. */
NODISCARD bool place_color(const struct json_place *place, const cJSON *object, bool *has_color, uint8_t rgb[3]);
/* Reports every key that is not in the list; known ends with NULL. */
void place_note_keys(const struct json_place *place, const cJSON *object, const char *const *known);
