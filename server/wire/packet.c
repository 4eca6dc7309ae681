#include "server/wire/packet.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

#define PACKET_MAGIC 0x4b505242u /* "BRPK" */
#define MAX_PIXELS_PER_MM 4e6    /* the frame header counts thousandths in 32 bits */
enum { READ_STEP = 256 << 10, LEAST_SPACE = 64 << 10 };

struct head {
    uint32_t magic, json_bytes, blob_bytes;
};

struct packet_reader {
    enum packet_direction direction;
    uint8_t *bytes; /* heads and JSON; the packets before `at` are taken */
    size_t at, used, room;
    /* a packet whose blob is on its way: read to blob directly */
    struct packet coming; /* json NULL: none */
    size_t n_come;
};

void packet_finish(struct packet *packet)
{
    cJSON_Delete(packet->json);
    free(packet->blob);
    *packet = (struct packet){ 0 };
}

/* Of a size that its type allows; err names type, sizes and limits. */
static bool is_within_limit(const char *type, enum packet_direction direction, size_t n_json, size_t n_blob,
                            struct error *err)
{
    const struct packet_limit *limit = packet_limit_find(type);
    if (!limit || limit->direction != direction)
        return error_set(err, ERROR_FORMAT, "there is no packet \"%.40s\" %s", type ? type : "",
                         direction == PACKET_TO_DAEMON ? "to the daemon" : "to a renderer");
    if (n_json > limit->max_json || n_blob > limit->max_blob)
        return error_set(err, ERROR_LIMIT,
                         "a packet \"%s\" of %zu + %zu bytes, at most %" PRIu32 " + %" PRIu32 " are allowed", type,
                         n_json, n_blob, limit->max_json, limit->max_blob);
    return true;
}

uint8_t *packet_write(const cJSON *json, const uint8_t *blob, size_t n_blob, size_t *n_bytes, struct error *err)
{
    const char *type = json_text(json, "type");
    const struct packet_limit *limit = packet_limit_find(type);
    char *text = json_print(json);
    size_t n_json = text ? strlen(text) : 0;
    uint8_t *bytes = NULL;
    *n_bytes = 0;
    if (!text)
        error_set(err, ERROR_MEMORY, "no memory for the JSON of a packet");
    else if (is_within_limit(type, limit ? limit->direction : PACKET_TO_DAEMON, n_json, n_blob, err)) {
        size_t n = sizeof(struct head) + n_json + n_blob; /* within the limits: far from overflow */
        bytes = malloc(n);
        if (!bytes)
            error_set(err, ERROR_MEMORY, "no memory for a packet \"%s\" of %zu bytes", type, n);
        else
            *n_bytes = n;
    }
    if (bytes) {
        struct head head = { PACKET_MAGIC, (uint32_t)n_json, (uint32_t)n_blob };
        memcpy(bytes, &head, sizeof head);
        memcpy(bytes + sizeof head, text, n_json);
        if (n_blob)
            memcpy(bytes + sizeof head + n_json, blob, n_blob);
    }
    free(text);
    return bytes;
}

static bool is_number_within(const cJSON *json, const char *name, double least, double most, double *value)
{
    *value = json_number(json, name, NAN);
    return *value >= least && *value <= most;
}

bool packet_frame_read(const struct packet *packet, struct packet_frame *frame)
{
    double width, height, revision, render_us, encode_us;
    const cJSON *json = packet->json, *matrix = cJSON_GetObjectItemCaseSensitive(json, "clip_from_lps_mm"), *number;
    const char *type = json_text(json, "type");
    *frame = (struct packet_frame){ 0 };
    if (!type || strcmp(type, "frame") != 0 || packet->n_blob == 0 || packet->n_blob > PACKET_MAX_PICTURE ||
        !is_number_within(json, "width_px", 1, PACKET_MAX_SIDE_PX, &width) ||
        !is_number_within(json, "height_px", 1, PACKET_MAX_SIDE_PX, &height) ||
        !is_number_within(json, "scene_revision", 0, UINT32_MAX, &revision) ||
        !is_number_within(json, "render_us", 0, UINT32_MAX, &render_us) ||
        !is_number_within(json, "encode_us", 0, UINT32_MAX, &encode_us) ||
        !is_number_within(json, "pixels_per_mm", 0, MAX_PIXELS_PER_MM, &frame->pixels_per_mm) ||
        !cJSON_IsArray(matrix) || cJSON_GetArraySize(matrix) != 16)
        return false;
    frame->width_px = (uint16_t)width;
    frame->height_px = (uint16_t)height;
    frame->scene_revision = (uint32_t)revision;
    frame->render_us = (uint32_t)render_us;
    frame->encode_us = (uint32_t)encode_us;
    frame->is_light = json_flag(json, "is_light", false);
    int i = 0;
    cJSON_ArrayForEach(number, matrix)
    {
        if (!cJSON_IsNumber(number) || !isfinite((float)number->valuedouble))
            return false;
        frame->clip_from_lps_mm[i++] = (float)number->valuedouble;
    }
    return true;
}

/* ---- reading ---------------------------------------------------------------------------------------------------- */

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
    struct packet_limit largest = packet_limit_largest(reader->direction);
    if (head->json_bytes > largest.max_json || head->blob_bytes > largest.max_blob) {
        error_set(err, ERROR_LIMIT,
                  "a packet of %" PRIu32 " + %" PRIu32 " bytes, at most %" PRIu32 " + %" PRIu32 " are allowed",
                  head->json_bytes, head->blob_bytes, largest.max_json, largest.max_blob);
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
    /* a good head says how much JSON is coming: one allocation for it; memory grows only with a checked head */
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

/* Takes head and JSON from the buffer, and what is there of the blob. False: the packet breaks the rules. */
static bool begin_packet(struct packet_reader *reader, const struct head *head, struct error *err)
{
    struct problem problem = { 0 };
    const char *text = (const char *)reader->bytes + reader->at + sizeof *head;
    struct packet *coming = &reader->coming;
    cJSON *json = json_read(text, head->json_bytes, &problem);
    if (!json && problem.type == PROBLEM_INTERNAL)
        return error_set(err, ERROR_MEMORY, "no memory for the JSON of a packet, %" PRIu32 " bytes", head->json_bytes);
    if (!json || !cJSON_IsObject(json)) {
        cJSON_Delete(json);
        return error_set(err, ERROR_FORMAT, "a packet without a JSON object");
    }
    if (!is_within_limit(json_text(json, "type"), reader->direction, head->json_bytes, head->blob_bytes, err)) {
        cJSON_Delete(json);
        return false;
    }
    *coming = (struct packet){ .json = json, .n_blob = head->blob_bytes };
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
    reader->coming = (struct packet){ 0 };
    reader->n_come = 0;
    return 1;
}
