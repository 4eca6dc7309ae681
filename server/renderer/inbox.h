#pragma once
/* Events from the other threads of the renderer to its main thread: a queue, and a descriptor to poll that becomes
 * readable when an event was put in. */
#include <stdatomic.h>

#include "core/pipeline/pipeline.h"
#include "core/pipeline/waiting_request.h"
#include "server/wire/json.h"

enum inbox_event_type {
    INBOX_GL_STARTED,  /* graphics have started, or could not: error */
    INBOX_PROGRESS,    /* of loading */
    INBOX_LOADED,      /* the plan is read */
    INBOX_LOAD_FAILED, /* it cannot be read */
    INBOX_BUILT,       /* the surfaces of a first picture are built */
    INBOX_FRAME,       /* a picture is drawn and compressed, or failed */
    INBOX_ANSWER,      /* to a question */
    INBOX_SHAPES_BUILT /* the shapes of a picture that waits for them are built */
};

struct inbox_event {
    enum inbox_event_type type;
    struct render_facts facts; /* GL_STARTED, when error.code is ERROR_NONE */
    struct error error;        /* GL_STARTED, LOAD_FAILED */
    char phase[200];           /* PROGRESS */
    double percent;            /* PROGRESS */
    struct plan *plan;         /* LOADED: the receiver's to destroy, after derived */
    char seen[65];             /* LOADED: patients_seen */
    struct derive *derived;    /* LOADED: the plan's store, the receiver's to destroy */
    struct pipeline_frame frame;
    int64_t id;    /* ANSWER: of the question */
    cJSON *body;   /* ANSWER: the receiver's; NULL: problem says why */
    uint8_t *blob; /* ANSWER: a file beside the body, the receiver's; NULL when there is none */
    size_t n_blob;
    struct problem problem;          /* ANSWER, when body is NULL */
    struct waiting_request *waiting; /* SHAPES_BUILT: the receiver's */
};

struct inbox;
struct inbox *inbox_create(void); /* NULL: the system gives no more files */
void inbox_destroy(struct inbox *inbox);
int inbox_wake_fd(const struct inbox *inbox); /* readable when an event may be there */
/* Copies event; takes what it owns. Any thread; waits while the inbox is full. */
void inbox_put(struct inbox *inbox, const struct inbox_event *event);
/* Like inbox_put, but drops the event when many are waiting; only for events that own nothing. */
void inbox_offer(struct inbox *inbox, const struct inbox_event *event);
struct inbox_event *inbox_take(struct inbox *inbox); /* NULL when there is none; clears wake_fd then */
void inbox_event_destroy(struct inbox_event *event);
