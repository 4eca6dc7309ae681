#pragma once
/* What daemon and renderer say to each other over their socket pair: a 12-byte head (u32 magic "BRPK", u32 json_bytes,
 * u32 blob_bytes, host order), a JSON object with "type", then an optional blob (a picture, a mesh). The renderer may be taken
 * over by a hostile file: the daemon bounds and checks everything it says.
 *
 * daemon to renderer
 *   scene    {type, room, revision, scene}            the room's scene document, complete; replaces the room's last
 *   forget   {type, room}                             a room is gone
 *   render   {type, id, room | scene, scene_revision?, view, scale_percent, quality, codec: "jpeg"|"png", full_color, detail: "full"|"light", still, source}
 *            scene: a complete document for this picture alone (HTTP render, overrides); else the room's. scene_revision comes back
 *            in frame; left out: the room's, or 0
 *            source: a text of at most 143 bytes; pictures of the same source share its turn. "ROOM/MEMBER" for a member's own views, "ROOM/" for
 *            the views a room shares; left out by all of HTTP, whose pictures count together
 *   query    {type, id, what: "surface"|"probe"|"pick"|"ready", ...arguments}   ready: answered with an empty body;
 *            surface with format "stl", "ply" or "glb": answered with the file as blob
 *   ping     {type}                                   answered with pong at once, by the main thread
 * renderer to daemon
 *   gl       {type, back_end, vendor, renderer, version, is_software} or {type, problem}
 *   progress {type, phase, percent}
 *   ready    {type, plan, scene, confined, memory_bytes, load_ms} plan: as the API gives it; scene: the plan's default scene
 *   failed   {type, problem}                          the plan cannot be loaded; the process then ends with status 3
 *   frame    {type, id, width_px, height_px, scene_revision, render_us, encode_us, pixels_per_mm, clip_from_lps_mm[16], is_light,
 *             n_triangles, missing?: {n, regions: [{region, reason}]}} + blob: regions that cannot be drawn, the first of n
 *   answer   {type, id, body} + blob?
 *   problem  {type, id, problem}                      instead of frame or answer
 *   pong     {type}
 */
#include "server/wire/json.h"

enum { PACKET_HEAD_BYTES = 12, PACKET_MAX_JSON = 8 << 20, PACKET_MAX_BLOB = 512 << 20 };

struct packet {
    cJSON *json;
    uint8_t *blob; /* NULL when n_blob is 0 */
    size_t n_blob;
};
void packet_finish(struct packet *packet);

/* Bytes to send for a packet; free(). blob is copied. */
NODISCARD uint8_t *packet_write(const cJSON *json, const uint8_t *blob, size_t n_blob, size_t *n_bytes);

/* Collects bytes from a stream and gives whole packets. */
struct packet_reader;
struct packet_reader *packet_reader_create(void);
void packet_reader_destroy(struct packet_reader *reader);
/* Room for the next bytes from the socket: *n of them at most. NULL: ERROR_MEMORY. */
NODISCARD uint8_t *packet_reader_space(struct packet_reader *reader, size_t *n, struct error *err);
/* After n bytes were put there. */
void packet_reader_added(struct packet_reader *reader, size_t n);
/* 1 a packet (the caller's to finish), 0 more bytes needed, -1 broken (bad head, too large, no JSON): err says why, close the stream. */
int packet_reader_take(struct packet_reader *reader, struct packet *packet, struct error *err);
