#pragma once
/* The parts of the record of a review that are items: entries of the checklist, decisions, signatures. Each stands
 * under the revision of the plan's files that it was written for, which the server gives it, as the role of who wrote
 * it. Decisions and signatures are never changed or deleted: a correction is a new one that names the old. Knows
 * nothing of the list of items' limits. Internal to server/room. */
#include "server/room/items/item_list.h"

enum {
    RECORD_MAX_TEXT = 2000,              /* characters of what is said about an entry or a decision */
    RECORD_MAX_ENTRY = 200,              /* of an entry's own words */
    RECORD_MAX_NAME = 80,                /* of a name that signs */
    RECORD_PROOF_MS = 5 * 60 * 1000,     /* how long before signing a person has proved who they are */
    RECORD_IDENTITY_MS = 15 * 60 * 1000, /* how long who has read whom the plan is of may say that it is OK */
    RECORD_MAX_BYTES = 16384
};

/* Like note_body_read. A check: {entry, text, state, comment}, entry "" for one that members added; a decision:
 * {decision, text, corrects}; a signature: {name, meaning, corrects}, of who has signed in without name. Read are also
 * plan_revision, statement_ms and role, which the server adds, of a signature signed_in, user and proved_ms, and of the
 * check "identity" that is OK whom its writer was told, masked: seen. */
NODISCARD cJSON *record_read_check(const struct room *room, const cJSON *body, const struct item *before,
                                   bool is_restored, struct problem *problem);
NODISCARD cJSON *record_read_decision(const struct room *room, const cJSON *body, const struct item *before,
                                      bool is_restored, struct problem *problem);
NODISCARD cJSON *record_read_signature(const struct room *room, const cJSON *body, const struct item *before,
                                       bool is_restored, struct problem *problem);
/* When it was said what the plan counts by now, of whom it is of; 0: it counts by its files alone. A part of the record
 * stands under it as under the revision, as statement_ms. */
double record_statement_ms(const struct room *room);
/* Whether this member may write an item of this kind now; true for kinds that are not of the record. */
bool record_may_write(const struct room *room, const struct member *member, enum wire_item_kind kind,
                      struct problem *problem);
/* Whether this member may change or delete an item, if anybody may; true for kinds that are not of the record. */
bool record_may_change(const struct room *room, const struct member *member, const struct item *item,
                       struct problem *problem);
/* Records in the audit that `by` put this item: its id, version and the SHA-256 of its row; of a decision or signature
 * also its words, and the SHA-256 of the record of that moment (record; NULL: there is none). */
void record_audit(struct room *room, const struct item *item, const struct member *by, const char *record);
/* Tells a member who has come that the plan's files have changed, if they have. */
void files_show(struct room *room, struct member *member);
/* Whether a record of the room is kept with an item of this kind: it is a decision or signature. */
bool record_is_wanted(enum wire_item_kind kind);
/* The record of the room at this moment, with the item, scene and views, as JSON for free(). NULL: of another kind;
 * with problem: no memory. */
NODISCARD char *record_of(const struct room *room, const struct item *item, struct problem *problem);
void record_audit_deleted(struct room *room, const struct item *item, const struct member *by);
