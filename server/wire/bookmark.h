#pragma once
/* Bookmarks: saved views of a plan, kept as the body of an item of kind "bookmark". A bookmark outlives the version
 * that made it and the plan's files, so opening one never fails for a field: what cannot be shown any more is left out
 * and named in a report. Pure functions on documents.
 *
 * {
 *   format: "beamroom-bookmark", version: 1,
 *   name,          1 to 80 characters
 *   plan,          id of the plan
 *   order,         place in the list: ascending
 *   scene,         merge patch on the plan's default scene (scene.json)
 *   views,         [{view: number on the page, document: view (scene.json) without size and override}]
 *   layout,        {layout, cells: [views in their panes], maximised, active}: of the page alone, not looked into here
 *   token          of its permalink; random, given by the server
 * }
 *
 * Thread: any. */
#include "server/wire/json.h"

#define BOOKMARK_FORMAT "beamroom-bookmark"
enum {
    BOOKMARK_VERSION = 1,
    BOOKMARK_MAX_NAME = 80, /* characters */
    BOOKMARK_MAX_VIEWS = 8,
    BOOKMARK_MAX_LAYOUT = 8,       /* members of layout, and of a list in it */
    BOOKMARK_MAX_BYTES = 60 << 10, /* of the body as compact text: less than a message of a client */
    BOOKMARK_MAX_REPORT = 32,      /* lines; further ones are counted */
    BOOKMARK_TOKEN_CHARS = 20      /* 100 random bits */
};

/* The form of a body: format, version, name, plan, order, views, layout, size. Fields that this version does not know
 * are no problem, here and in scene and views: they come from another version, and bookmark_open names them. scene and
 * token may be absent. */
NODISCARD bool bookmark_check(const cJSON *body, struct problem *problem);

/* Applies a bookmark to this plan: {name, version, scene: complete, views: [{view, document: complete}], layout,
 * report: [{pointer, code, detail}], n_report}. The pointers of the report are of the bookmark; code is that of a
 * validation problem, or "version" for a bookmark of a newer version. body passed bookmark_check. defaults: the plan's
 * default scene. NULL with problem when there is no memory. In time that grows with the document. */
NODISCARD cJSON *bookmark_open(const cJSON *body, const cJSON *plan, const cJSON *defaults, struct problem *problem);

/* The views of a bookmark without its plan: [{view, document: complete}]. NULL: no memory. */
NODISCARD cJSON *bookmark_views(const cJSON *body);

/* The smallest merge patch that makes scene from defaults; both complete documents. NULL: no memory. */
NODISCARD cJSON *bookmark_difference(const cJSON *defaults, const cJSON *scene);

/* The letters i, l and o and the digit 1 are left out: they are misread. Returns false when the system gives no random
 * numbers. */
NODISCARD bool bookmark_make_token(char token[BOOKMARK_TOKEN_CHARS + 1]);
/* True if the body's token is this one; in a time that does not tell how much of it is right. */
bool bookmark_has_token(const cJSON *body, const char *token);
