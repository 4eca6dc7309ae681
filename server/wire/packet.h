#pragma once
/* Packets between daemon and renderer (proto/packets.json): their bytes on the socket pair to checked structs and back.
 * A renderer may have been taken over by a hostile file: every packet is checked whole, and against the limits of its
 * type, before memory is taken for its blob. Thread: any; a packet and a reader have one owner. */
#include "server/wire/json.h"

enum packet_direction { PACKET_TO_RENDERER, PACKET_TO_DAEMON };

#include "packets_gen.h" /* struct packet, one struct for each type, PACKET_MAX_... */

enum { PACKET_HEAD_BYTES = 12 };

/* ---- tables made from proto/packets.json ------------------------------------------------------------------------ */

/* Fields that fields.h does not know. */
enum packet_part_type {
    PACKET_PART_DOCUMENT, /* const cJSON *: an object; NULL when there is none */
    PACKET_PART_LIST,     /* const cJSON *: an array; NULL when there is none: the key is left out */
    PACKET_PART_PROBLEM,  /* struct problem; PROBLEM_NONE when there is none */
    PACKET_PART_MATRIX    /* float[16], finite */
};

struct packet_part {
    const char *name;
    enum packet_part_type type;
    size_t offset; /* in the struct of the packet's type */
    bool is_required;
};

/* An argument of a question and the HTTP parameters it is read from: one; of a vec3 three, or one that is written
 * "x,y,z". */
struct packet_parameter {
    const char *field, *names[3];
};

struct packet_question {
    const char *path;       /* of the HTTP GET; NULL: no HTTP call */
    const char *path_field; /* the field that the path's second id gives; NULL: none */
    bool has_own_handler;   /* its HTTP call has code of its own in server/http */
    bool is_slow;           /* may take longer than some milliseconds */
    const struct packet_parameter *parameters;
    size_t n_parameters;
};

struct packet_description {
    const char *name;
    enum packet_direction direction;
    uint32_t max_json, max_blob; /* bytes */
    bool needs_blob;
    size_t offset; /* of the type's struct in struct packet */
    const struct field_object *object;
    const struct packet_part *parts;
    size_t n_parts;
    bool has_id;
    size_t id_offset; /* in struct packet */
    bool is_request;  /* is answered with `answer` or a problem */
    enum packet_type answer;
    bool has_snapshot;
    size_t snapshot_offset;                 /* of its struct packet_snapshot in struct packet */
    const struct packet_question *question; /* NULL: it is no question */
};
extern const struct packet_description packet_descriptions[PACKET_N_TYPES];

/* Finds a type by its name; PACKET_N_TYPES if there is none. name may be NULL. */
enum packet_type packet_type_find(const char *name);
/* The id of a packet; -1 for a type without one. */
int64_t packet_id(const struct packet *packet);
void packet_set_id(struct packet *packet, int64_t id);
/* Returns the scene and view that a request is about; NULL for types without them. */
const struct packet_snapshot *packet_snapshot_of(const struct packet *packet);

/* ---- writing ---------------------------------------------------------------------------------------------------- */

/* A packet of defaults, to be filled in and written. */
void packet_init(struct packet *packet, enum packet_type type);
/* Fills a text field of size bytes: cuts longer texts, replaces control characters by '?'. text NULL: "". */
void packet_put_text(char *field, size_t size, const char *text);
/* The packet's JSON as a new object. Refers to its documents: delete it before them. */
NODISCARD cJSON *packet_to_json(const struct packet *packet);
/* Bytes to send; free(). Documents and blob are read, not taken.
 *   errors  PROBLEM_VALIDATION a field is out of its range, PROBLEM_LIMIT larger than the type may be, PROBLEM_MEMORY
 */
NODISCARD uint8_t *packet_encode(const struct packet *packet, const uint8_t *blob, size_t n_blob, size_t *n_bytes,
                                 struct problem *problem);

/* ---- reading ---------------------------------------------------------------------------------------------------- */

/* A packet from its JSON, checked whole. Takes json, also on failure. n_blob: bytes of the blob that follows. False
 * with PROBLEM_VALIDATION (pointer names the field) or PROBLEM_LIMIT. */
NODISCARD bool packet_from_json(cJSON *json, enum packet_direction direction, size_t n_blob, struct packet *packet,
                                struct problem *problem);
/* The only member of an answer's body that is sent as text/csv instead of JSON: a string with the whole table. */
#define ANSWER_CSV "text/csv"
/* The member of an answer's body that says in which format the blob beside it is, a word of mesh_export.h. */
#define ANSWER_MESH "mesh"

/* Takes a document out of a packet that was read: the caller's to delete. NULL when document is NULL. */
NODISCARD cJSON *packet_take_document(struct packet *packet, const cJSON *document);
void packet_finish(struct packet *packet);

/* Collects bytes of one direction from a stream and gives whole packets. The bytes of a blob are read to where they
 * stay. */
struct packet_reader;
struct packet_reader *packet_reader_create(enum packet_direction direction);
void packet_reader_destroy(struct packet_reader *reader);
/* Where the next bytes from the socket go: at most *n of them. NULL: ERROR_MEMORY. */
NODISCARD uint8_t *packet_reader_space(struct packet_reader *reader, size_t *n, struct error *err);
/* After n bytes were put there. */
void packet_reader_added(struct packet_reader *reader, size_t n);
/* 1 a packet (the caller's to finish), 0 more bytes needed, -1 broken (no packet, of the other direction, a field or a
 * size out of its range, no memory) with err: close the stream. */
int packet_reader_take(struct packet_reader *reader, struct packet *packet, struct error *err);
/* Bytes of memory it holds now. The memory of a large packet is given back with the packet. */
size_t packet_reader_held(const struct packet_reader *reader);
