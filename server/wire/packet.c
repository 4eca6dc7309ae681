#include "server/wire/packet.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

#define PACKET_MAGIC 0x4b505242u /* "BRPK" */
enum { READ_STEP = 256 << 10 };

struct head {
    uint32_t magic, json_bytes, blob_bytes;
};

struct packet_reader {
    uint8_t *bytes;
    size_t used, room;
};

void packet_finish(struct packet *packet)
{
    cJSON_Delete(packet->json);
    free(packet->blob);
    *packet = (struct packet){ 0 };
}

uint8_t *packet_write(const cJSON *json, const uint8_t *blob, size_t n_blob, size_t *n_bytes)
{
    char *text = json_write(json);
    size_t n_json = strlen(text);
    struct head head = { PACKET_MAGIC, (uint32_t)n_json, (uint32_t)n_blob };
    *n_bytes = sizeof head + n_json + n_blob;
    uint8_t *bytes = mem_new(*n_bytes);
    memcpy(bytes, &head, sizeof head);
    memcpy(bytes + sizeof head, text, n_json);
    if (n_blob)
        memcpy(bytes + sizeof head + n_json, blob, n_blob);
    free(text);
    return bytes;
}

struct packet_reader *packet_reader_create(void)
{
    return mem_new(sizeof(struct packet_reader));
}

void packet_reader_destroy(struct packet_reader *reader)
{
    if (!reader)
        return;
    free(reader->bytes);
    free(reader);
}

/* The head at the start of the buffer, once it is there. 1 there and good, 0 not yet, -1 bad. */
static int read_head(const struct packet_reader *reader, struct head *head, struct error *err)
{
    if (reader->used < sizeof *head)
        return 0;
    memcpy(head, reader->bytes, sizeof *head);
    if (head->magic != PACKET_MAGIC) {
        error_set(err, ERROR_FORMAT, "a packet begins with 0x%08" PRIx32 ", expected 0x%08x", head->magic, PACKET_MAGIC);
        return -1;
    }
    if (head->json_bytes > PACKET_MAX_JSON || head->blob_bytes > PACKET_MAX_BLOB) {
        error_set(err, ERROR_LIMIT, "a packet of %" PRIu32 " + %" PRIu32 " bytes, at most %d + %d are allowed", head->json_bytes,
                  head->blob_bytes, PACKET_MAX_JSON, PACKET_MAX_BLOB);
        return -1;
    }
    return 1;
}

uint8_t *packet_reader_space(struct packet_reader *reader, size_t *n, struct error *err)
{
    struct head head;
    size_t want = reader->used + READ_STEP;
    /* a good head says how much is coming: one allocation for it; memory grows only with a checked head */
    if (read_head(reader, &head, NULL) == 1) {
        size_t whole = sizeof head + (size_t)head.json_bytes + head.blob_bytes;
        if (whole > want)
            want = whole;
    }
    if (want > reader->room) {
        uint8_t *larger = realloc(reader->bytes, want);
        if (!larger) {
            error_set(err, ERROR_MEMORY, "no memory for a packet of %zu bytes", want);
            return NULL;
        }
        reader->bytes = larger;
        reader->room = want;
    }
    *n = reader->room - reader->used;
    return reader->bytes + reader->used;
}

void packet_reader_added(struct packet_reader *reader, size_t n)
{
    reader->used += n;
}

int packet_reader_take(struct packet_reader *reader, struct packet *packet, struct error *err)
{
    struct head head;
    int state = read_head(reader, &head, err);
    if (state != 1)
        return state;
    size_t whole = sizeof head + (size_t)head.json_bytes + head.blob_bytes;
    if (reader->used < whole)
        return 0;
    struct problem problem;
    cJSON *json = json_read((const char *)reader->bytes + sizeof head, head.json_bytes, &problem);
    if (!json || !cJSON_IsObject(json)) {
        cJSON_Delete(json);
        error_set(err, ERROR_FORMAT, "a packet without a JSON object");
        return -1;
    }
    *packet = (struct packet){ .json = json };
    if (head.blob_bytes) {
        packet->blob = mem_array(head.blob_bytes, 1, PACKET_MAX_BLOB, err);
        if (!packet->blob) {
            packet_finish(packet);
            return -1;
        }
        memcpy(packet->blob, reader->bytes + sizeof head + head.json_bytes, head.blob_bytes);
        packet->n_blob = head.blob_bytes;
    }
    reader->used -= whole;
    memmove(reader->bytes, reader->bytes + whole, reader->used);
    return 1;
}
