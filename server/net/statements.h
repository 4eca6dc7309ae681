#pragma once
/* Statements of people of whom plans are of: that the patients of a plan's files are one person, or who the patient
 * is that they do not name. One statement a plan, kept in the database, given to the plan's renderer, withdrawn when
 * the plan's files change. Net thread. */
#include "server/net/net.h"

enum { NET_MAX_STATEMENTS = STORE_MAX_STATEMENTS };

/* Called once: when the change is on disk, and the plan is being read anew. problem: nothing has changed. */
typedef void net_statement_done(void *context, const struct problem *problem);

/* {kind: "one-person" | "identity", revision, key, patients, by, time_ms, words, name, id, birth_date, withdrawn_ms}:
 * name to birth_date of "identity" alone; withdrawn_ms: since then it does not count, as the files have changed. NULL:
 * there is none. Of the plan, by either of its ids. */
const cJSON *net_statement_on(const struct net *net, const char *plan_id);
/* Writes the plan's statement (taken; NULL: withdraws it), which counts when it is on disk. by: who says it, as people
 * read it. False with problem: storage; busy, while another one is being written; limit. */
NODISCARD bool net_statement_put(struct net *net, const char *plan_id, cJSON *statement, const struct identity *who,
                                 const char *by, const char *address, net_statement_done *done, void *context,
                                 struct problem *problem);
/* The plan was deleted. other: its other id; "": not known. */
void net_statement_forget(struct net *net, const char *plan_id, const char *other);

/* ---- of server/net alone ---------------------------------------------------------------------------------------- */

struct store_answer;
/* struct fleet_options; context is the net */
const cJSON *statements_find(void *context, const char *plan_id);
/* The plan's state has changed: a statement that its files made void is withdrawn. */
void statements_plan_changed(struct net *net, const char *plan_id);
void statements_add_all(struct net *net, const struct store_answer *opened);
bool statements_written(struct net *net, const struct store_answer *answer); /* true: it was the answer to one */
void statements_write_due(struct net *net);
void statements_end(struct net *net); /* answers who still waits */
void statements_finish(struct net *net);
