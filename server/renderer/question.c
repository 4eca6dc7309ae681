/* Creates and destroys a question. */
#include "server/renderer/question.h"

#include <stdlib.h>

#include "core/base/mem.h"

struct question *question_create(struct packet *packet, struct snapshot *snapshot)
{
    struct question *question = mem_new(sizeof *question);
    question->packet = *packet;
    question->snapshot = snapshot;
    packet->json = NULL;
    packet->blob = NULL;
    packet->n_blob = 0;
    return question;
}

void question_destroy(struct question *question)
{
    if (!question)
        return;
    packet_finish(&question->packet);
    snapshot_unref(question->snapshot);
    free(question->file);
    free(question);
}

bool question_is_slow(const struct question *question)
{
    return packet_descriptions[question->packet.type].question->is_slow;
}
