#pragma once
/* A question: a number about the plan or a scene of it. Its row in proto/packets.json gives its packet, its checks, its
 * HTTP call and its description; answer_<name> in answers.h answers it. */
#include "core/scene/snapshot.h"
#include "server/wire/packet.h"

struct question {
    struct packet packet;      /* owned; its fields are checked */
    struct snapshot *snapshot; /* of a question about a scene: one reference; else NULL */
    uint8_t *file;             /* set by the answer: sent beside its body; NULL when there is none */
    size_t n_file;
};

/* Takes packet's contents and snapshot. */
struct question *question_create(struct packet *packet, struct snapshot *snapshot);
void question_destroy(struct question *question);
/* May take longer than some milliseconds. */
bool question_is_slow(const struct question *question);
