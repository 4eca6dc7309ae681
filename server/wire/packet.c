/* Packets between daemon and renderer: bytes to checked structs and back. */
#include "server/wire/packet.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

#define PACKET_MAGIC 0x4b505242u /* "BRPK" */
enum { READ_STEP = 256 << 10, LEAST_SPACE = 64 << 10, MAX_PARTS = 4, N_MATRIX = 16 };

struct head {
    uint32_t magic, json_bytes, blob_bytes;
};

struct packet_reader {
    enum packet_direction direction;
    uint8_t *bytes; /* heads and JSON; the packets before `at` are taken */
    size_t at, used, room;
    /* a packet whose blob is being read, to where it stays */
    struct packet coming; /* json NULL: none */
    size_t n_come;
};

/* ---- tables ----------------------------------------------------------------------------------------------------- */

enum packet_type packet_type_find(const char *name)
{
    for (int type = 0; name && type < PACKET_N_TYPES; type++)
        if (strcmp(packet_descriptions[type].name, name) == 0)
            return (enum packet_type)type;
    return PACKET_N_TYPES;
}

/* The sizes no packet of a direction exceeds: all that can be checked before a packet's type is known. */
static void find_largest(enum packet_direction direction, uint32_t *max_json, uint32_t *max_blob)
{
    *max_json = *max_blob = 0;
    for (const struct packet_description *d = packet_descriptions; d < packet_descriptions + PACKET_N_TYPES; d++) {
        if (d->direction != direction)
            continue;
        *max_json = d->max_json > *max_json ? d->max_json : *max_json;
        *max_blob = d->max_blob > *max_blob ? d->max_blob : *max_blob;
    }
}

int64_t packet_id(const struct packet *packet)
{
    const struct packet_description *description = &packet_descriptions[packet->type];
    int64_t id = -1;
    if (description->has_id)
        memcpy(&id, (const char *)packet + description->id_offset, sizeof id);
    return id;
}

void packet_set_id(struct packet *packet, int64_t id)
{
    const struct packet_description *description = &packet_descriptions[packet->type];
    if (description->has_id)
        memcpy((char *)packet + description->id_offset, &id, sizeof id);
}

const struct packet_snapshot *packet_snapshot_of(const struct packet *packet)
{
    const struct packet_description *description = &packet_descriptions[packet->type];
    const void *at = (const char *)packet + description->snapshot_offset;
    return description->has_snapshot ? at : NULL;
}

/* ---- JSON to a packet ------------------------------------------------------------------------------------------- */

static bool refuse_part(const struct packet_part *part, const char *code, const char *expected, struct problem *problem)
{
    char pointer[48];
    (void)snprintf(pointer, sizeof pointer, "/%s", part->name);
    return problem_set(problem, PROBLEM_VALIDATION, pointer, code, "%s %s", pointer, expected);
}

static bool read_matrix(const struct packet_part *part, const cJSON *json, char *at, struct problem *problem)
{
    float values[N_MATRIX];
    int n = 0;
    if (!cJSON_IsArray(json) || cJSON_GetArraySize(json) != N_MATRIX)
        return refuse_part(part, "type", "is not 16 numbers", problem);
    for (const cJSON *item = json->child; item; item = item->next) {
        if (!cJSON_IsNumber(item) || !isfinite((float)item->valuedouble))
            return refuse_part(part, "range", "holds what is not a finite number", problem);
        values[n++] = (float)item->valuedouble;
    }
    memcpy(at, values, sizeof values);
    return true;
}

static bool read_part(const struct packet_part *part, const cJSON *json, char *fields, struct problem *problem)
{
    char *at = fields + part->offset;
    if (!json || cJSON_IsNull(json))
        return !part->is_required || refuse_part(part, "required", "is missing", problem);
    switch (part->type) {
    case PACKET_PART_DOCUMENT:
        if (!cJSON_IsObject(json))
            return refuse_part(part, "type", "is not an object", problem);
        memcpy(at, &json, sizeof json);
        return true;
    case PACKET_PART_LIST:
        if (!cJSON_IsArray(json))
            return refuse_part(part, "type", "is not a list", problem);
        memcpy(at, &json, sizeof json);
        return true;
    case PACKET_PART_PROBLEM: {
        struct problem value = { 0 };
        if (!problem_from_json(json, &value))
            return refuse_part(part, "type", "is not a problem", problem);
        memcpy(at, &value, sizeof value);
        return true;
    }
    case PACKET_PART_MATRIX: return read_matrix(part, json, at, problem);
    }
    return false;
}

/* The fields of packet->json. Parts are not copied: they leave the object while the other fields are read, and are put
 * back, which costs nothing. */
static bool read_fields(struct packet *packet, struct problem *problem)
{
    const struct packet_description *description = &packet_descriptions[packet->type];
    char *fields = (char *)packet + description->offset;
    cJSON *parts[MAX_PARTS];
    for (size_t i = 0; i < description->n_parts; i++)
        parts[i] = cJSON_DetachItemFromObjectCaseSensitive(packet->json, description->parts[i].name);
    bool is_good = fields_read(description->object, packet->json, "type", fields, problem);
    for (size_t i = 0; i < description->n_parts; i++) {
        is_good = is_good && read_part(&description->parts[i], parts[i], fields, problem);
        if (parts[i])
            cJSON_AddItemToArray(packet->json, parts[i]); /* the part keeps its name */
    }
    return is_good;
}

static bool find_type(const cJSON *json, enum packet_direction direction, enum packet_type *type,
                      struct problem *problem)
{
    const char *name = json_text(json, "type");
    *type = packet_type_find(name);
    if (*type == PACKET_N_TYPES || packet_descriptions[*type].direction != direction)
        return problem_set(problem, PROBLEM_VALIDATION, "/type", name ? "enum" : "required",
                           "there is no packet \"%.40s\" %s", name ? name : "",
                           direction == PACKET_TO_DAEMON ? "to the daemon" : "to a renderer");
    return true;
}

static bool has_good_size(enum packet_type type, size_t n_json, size_t n_blob, struct problem *problem)
{
    const struct packet_description *description = &packet_descriptions[type];
    if (n_json > description->max_json || n_blob > description->max_blob)
        return problem_set(problem, PROBLEM_LIMIT, "", "",
                           "a packet \"%s\" of %zu + %zu bytes, at most %" PRIu32 " + %" PRIu32 " are allowed",
                           description->name, n_json, n_blob, description->max_json, description->max_blob);
    if (n_blob == 0 && description->needs_blob)
        return problem_set(problem, PROBLEM_VALIDATION, "", "required", "a packet \"%s\" has no blob",
                           description->name);
    return true;
}

bool packet_from_json(cJSON *json, enum packet_direction direction, size_t n_blob, struct packet *packet,
                      struct problem *problem)
{
    enum packet_type type;
    *packet = (struct packet){ .json = json };
    bool is_good = find_type(json, direction, &type, problem) && has_good_size(type, 0, n_blob, problem);
    if (is_good) {
        packet->type = type;
        is_good = read_fields(packet, problem);
    }
    if (!is_good)
        packet_finish(packet);
    return is_good;
}

cJSON *packet_take_document(struct packet *packet, const cJSON *document)
{
    return document ? cJSON_DetachItemViaPointer(packet->json, (cJSON *)(uintptr_t)document) : NULL;
}

void packet_finish(struct packet *packet)
{
    cJSON_Delete(packet->json);
    free(packet->blob);
    *packet = (struct packet){ 0 };
}

/* ---- a packet to bytes ------------------------------------------------------------------------------------------ */

void packet_init(struct packet *packet, enum packet_type type)
{
    const struct packet_description *description = &packet_descriptions[type];
    *packet = (struct packet){ .type = type };
    memcpy((char *)packet + description->offset, description->object->defaults, description->object->size);
}

void packet_put_text(char *field, size_t size, const char *text)
{
    size_t most = (size - 1) / 4, n = 0; /* a byte that is not UTF-8 is written as one character */
    for (; text && text[n] && n < most; n++)
        field[n] = (unsigned char)text[n] < 0x20 || text[n] == 0x7f ? '?' : text[n];
    field[n] = 0;
}

static void add_part(cJSON *json, const struct packet_part *part, const char *fields)
{
    const char *at = fields + part->offset;
    cJSON *value = NULL;
    switch (part->type) {
    case PACKET_PART_DOCUMENT: {
        cJSON *document;
        memcpy(&document, at, sizeof document);
        value = document ? cJSON_CreateObjectReference(document->child) : NULL;
        break;
    }
    case PACKET_PART_LIST: {
        cJSON *list;
        memcpy(&list, at, sizeof list);
        if (!list)
            return;
        value = cJSON_CreateArrayReference(list->child);
        break;
    }
    case PACKET_PART_PROBLEM: {
        struct problem problem;
        memcpy(&problem, at, sizeof problem);
        value = problem.type == PROBLEM_NONE ? NULL : problem_to_json(&problem);
        break;
    }
    case PACKET_PART_MATRIX: {
        float values[N_MATRIX];
        memcpy(values, at, sizeof values);
        value = cJSON_CreateFloatArray(values, N_MATRIX);
        break;
    }
    }
    json_add(json, part->name, value ? value : cJSON_CreateNull());
}

cJSON *packet_to_json(const struct packet *packet)
{
    const struct packet_description *description = &packet_descriptions[packet->type];
    const char *fields = (const char *)packet + description->offset;
    cJSON *json = fields_write(description->object, fields);
    cJSON_AddStringToObject(json, "type", description->name);
    for (size_t i = 0; i < description->n_parts; i++)
        add_part(json, &description->parts[i], fields);
    return json;
}

/* Head, JSON and blob. */
static uint8_t *join(const char *text, size_t n_json, const uint8_t *blob, size_t n_blob, size_t n)
{
    struct head head = { PACKET_MAGIC, (uint32_t)n_json, (uint32_t)n_blob };
    uint8_t *bytes = malloc(n);
    if (!bytes)
        return NULL;
    memcpy(bytes, &head, sizeof head);
    memcpy(bytes + sizeof head, text, n_json);
    if (n_blob)
        memcpy(bytes + sizeof head + n_json, blob, n_blob);
    return bytes;
}

uint8_t *packet_encode(const struct packet *packet, const uint8_t *blob, size_t n_blob, size_t *n_bytes,
                       struct problem *problem)
{
    const char *name = packet_descriptions[packet->type].name;
    struct packet check = { .type = packet->type, .json = packet_to_json(packet) };
    char *text = json_print(check.json); /* NULL also when there was no memory for a part of it */
    size_t n_json = text ? strlen(text) : 0, n = sizeof(struct head) + n_json + n_blob;
    uint8_t *bytes = NULL;
    if (!text)
        (void)problem_set(problem, PROBLEM_MEMORY, "", "", "no memory for the JSON of a packet \"%s\"", name);
    else if (read_fields(&check, problem) && has_good_size(packet->type, n_json, n_blob, problem) &&
             !(bytes = join(text, n_json, blob, n_blob, n)))
        (void)problem_set(problem, PROBLEM_MEMORY, "", "", "no memory for a packet \"%s\" of %zu bytes", name, n);
    *n_bytes = bytes ? n : 0;
    free(text);
    cJSON_Delete(check.json);
    return bytes;
}

/* ---- a stream of packets ---------------------------------------------------------------------------------------- */

struct packet_reader *packet_reader_create(enum packet_direction direction)
{
    struct packet_reader *reader = mem_new(sizeof *reader);
    reader->direction = direction;
    return reader;
}

void packet_reader_destroy(struct packet_reader *reader)
{
    if (!reader)
        return;
    packet_finish(&reader->coming);
    free(reader->bytes);
    free(reader);
}

size_t packet_reader_held(const struct packet_reader *reader)
{
    return reader->room + reader->coming.n_blob;
}

/* The head of the next packet, once it is there. 1 there and good, 0 not yet, -1 bad. */
static int read_head(const struct packet_reader *reader, struct head *head, struct error *err)
{
    if (reader->used - reader->at < sizeof *head)
        return 0;
    memcpy(head, reader->bytes + reader->at, sizeof *head);
    if (head->magic != PACKET_MAGIC) {
        error_set(err, ERROR_FORMAT, "a packet begins with 0x%08" PRIx32 ", expected 0x%08x", head->magic,
                  PACKET_MAGIC);
        return -1;
    }
    uint32_t max_json, max_blob;
    find_largest(reader->direction, &max_json, &max_blob);
    if (head->json_bytes > max_json || head->blob_bytes > max_blob) {
        error_set(err, ERROR_LIMIT,
                  "a packet of %" PRIu32 " + %" PRIu32 " bytes, at most %" PRIu32 " + %" PRIu32 " are allowed",
                  head->json_bytes, head->blob_bytes, max_json, max_blob);
        return -1;
    }
    return 1;
}

uint8_t *packet_reader_space(struct packet_reader *reader, size_t *n, struct error *err)
{
    if (reader->coming.json) {
        *n = reader->coming.n_blob - reader->n_come;
        return reader->coming.blob + reader->n_come;
    }
    if (reader->at > 0) {
        memmove(reader->bytes, reader->bytes + reader->at, reader->used - reader->at);
        reader->used -= reader->at;
        reader->at = 0;
    }
    struct head head;
    size_t want = reader->used + READ_STEP, least = reader->used + LEAST_SPACE;
    /* the checked head gives the size of the JSON: one allocation */
    if (read_head(reader, &head, NULL) == 1 && sizeof head + head.json_bytes > least) {
        least = sizeof head + head.json_bytes;
        want = want > least ? want : least;
    }
    if (least > reader->room ||
        reader->room > want + READ_STEP) { /* a large packet's memory is not kept for small ones */
        uint8_t *changed = realloc(reader->bytes, want);
        if (!changed) {
            error_set(err, ERROR_MEMORY, "no memory for a packet of %zu bytes", want);
            return NULL;
        }
        reader->bytes = changed;
        reader->room = want;
    }
    *n = reader->room - reader->used;
    return reader->bytes + reader->used;
}

void packet_reader_added(struct packet_reader *reader, size_t n)
{
    if (reader->coming.json)
        reader->n_come += n;
    else
        reader->used += n;
}

static bool refuse_packet(struct error *err, const struct problem *problem)
{
    return error_set(err, problem->type == PROBLEM_LIMIT ? ERROR_LIMIT : ERROR_FORMAT, "%.230s", problem->detail);
}

/* Checks head and JSON and takes them from the buffer, with the bytes of the blob that have come already. */
static bool begin_packet(struct packet_reader *reader, const struct head *head, struct error *err)
{
    struct problem problem = { 0 };
    enum packet_type type;
    const char *text = (const char *)reader->bytes + reader->at + sizeof *head;
    struct packet *coming = &reader->coming;
    cJSON *json = json_read(text, head->json_bytes, &problem);
    if (!json && problem.type == PROBLEM_INTERNAL)
        return error_set(err, ERROR_MEMORY, "no memory for the JSON of a packet, %" PRIu32 " bytes", head->json_bytes);
    if (!json || !cJSON_IsObject(json)) {
        cJSON_Delete(json);
        return error_set(err, ERROR_FORMAT, "a packet without a JSON object");
    }
    if (!find_type(json, reader->direction, &type, &problem) ||
        !has_good_size(type, head->json_bytes, head->blob_bytes, &problem)) {
        cJSON_Delete(json);
        return refuse_packet(err, &problem);
    }
    if (!packet_from_json(json, reader->direction, head->blob_bytes, coming, &problem))
        return error_set(err, ERROR_RANGE, "a wrong \"%s\": %.180s", packet_descriptions[type].name, problem.detail);
    coming->n_blob = head->blob_bytes;
    reader->at += sizeof *head + head->json_bytes;
    size_t left = reader->used - reader->at;
    reader->n_come = left < coming->n_blob ? left : coming->n_blob;
    if (coming->n_blob == 0)
        return true;
    coming->blob = malloc(coming->n_blob);
    if (!coming->blob) {
        size_t n = coming->n_blob;
        packet_finish(coming);
        return error_set(err, ERROR_MEMORY, "no memory for %zu bytes of a packet", n);
    }
    memcpy(coming->blob, reader->bytes + reader->at, reader->n_come);
    reader->at += reader->n_come;
    return true;
}

static void give_back_buffer(struct packet_reader *reader)
{
    if (reader->at < reader->used || reader->room <= 2 * READ_STEP)
        return;
    free(reader->bytes);
    reader->bytes = NULL;
    reader->at = reader->used = reader->room = 0;
}

int packet_reader_take(struct packet_reader *reader, struct packet *packet, struct error *err)
{
    if (!reader->coming.json) {
        struct head head;
        int state = read_head(reader, &head, err);
        if (state != 1)
            return state;
        if (reader->used - reader->at < sizeof head + head.json_bytes)
            return 0;
        if (!begin_packet(reader, &head, err))
            return -1;
        give_back_buffer(reader);
    }
    if (reader->n_come < reader->coming.n_blob)
        return 0;
    *packet = reader->coming;
    reader->coming.json = NULL;
    reader->coming.blob = NULL;
    reader->coming.n_blob = 0;
    reader->n_come = 0;
    return 1;
}
