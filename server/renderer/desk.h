#pragma once
/* What other threads lay on the main thread's desk, and the bell that says so. */
#include <stdatomic.h>

#include "core/pipeline/pipeline.h"
#include "core/pipeline/waiting_request.h"
#include "server/wire/json.h"

enum note_type {
    NOTE_GL,
    NOTE_PROGRESS,
    NOTE_LOADED,
    NOTE_FAILED,
    NOTE_BUILT,
    NOTE_FRAME,
    NOTE_ANSWER,
    NOTE_SHAPES_BUILT
};

struct note {
    enum note_type type;
    struct render_facts facts; /* gl: when error.code is ERROR_NONE */
    struct error error;        /* gl, failed */
    char phase[200];           /* progress */
    double percent;
    struct plan *plan;      /* loaded: the receiver's to destroy, after derived */
    struct derive *derived; /* loaded: the plan's store, the receiver's to destroy */
    struct pipeline_frame frame;
    uint64_t id;   /* answer */
    cJSON *body;   /* answer: the receiver's; NULL: problem says why */
    uint8_t *blob; /* answer: bytes beside the body, the receiver's; NULL when there are none */
    size_t n_blob;
    struct problem problem;
    struct waiting_request *waiting; /* SHAPES_BUILT: the receiver's */
};

struct desk;
struct desk *desk_create(void); /* NULL: the system gives no more files */
void desk_destroy(struct desk *desk);
int desk_bell(const struct desk *desk); /* readable when a note may lie there */
/* Copies note; what it owns goes along. Any thread; waits while the desk is full. */
void desk_put(struct desk *desk, const struct note *note);
/* The same, but when the desk is busy the note is dropped; only for notes that own nothing. */
void desk_offer(struct desk *desk, const struct note *note);
struct note *desk_take(struct desk *desk); /* NULL when there is none; rearms the bell */
void note_destroy(struct note *note);
