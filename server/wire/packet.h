#pragma once
/* What daemon and renderer say to each other over their socket pair: a 12-byte head (u32 magic "BRPK", u32 json_bytes,
 * u32 blob_bytes, host order), a JSON object with "type", then an optional blob (a picture, a mesh). The renderer may
 * be taken over by a hostile file: the daemon bounds and checks everything it says.
 *
 * daemon to renderer
 *   scene    {type, room, revision, scene}            the room's scene document, complete; replaces the room's last
 *   forget   {type, room}                             a room is gone
 *   drop     {type, id}                               a picture is no longer wanted
 *   render   {type, id, room | scene, scene_revision?, view, scale_percent, quality, codec: "jpeg"|"png", full_color,
 * detail: "full"|"light", still, source} scene: a complete document for this picture alone (HTTP render, overrides);
 * else the room's. scene_revision comes back in frame; left out: the room's, or 0 source: a text of at most 143 bytes;
 * pictures of the same source share its turn. "ROOM/MEMBER" for a member's own views, "ROOM/" for the views a room
 * shares; left out by all of HTTP, whose pictures count together query    {type, id, what:
 * "surface"|"probe"|"pick"|"ready", ...arguments}   ready: answered with an empty body; surface with format "stl",
 * "ply" or "glb": answered with the file as blob ping     {type}                                   answered with pong
 * at once, by the main thread renderer to daemon gl       {type, back_end, vendor, renderer, version, is_software} or
 * {type, problem} progress {type, phase, percent} ready    {type, plan, scene, confined, memory_bytes, load_ms} plan:
 * as the API gives it; scene: the plan's default scene failed   {type, problem}                          the plan
 * cannot be loaded; the process then ends with status 3 frame    {type, id, width_px, height_px, scene_revision,
 * render_us, encode_us, pixels_per_mm, clip_from_lps_mm[16], is_light, n_triangles, missing?: {n, regions: [{region,
 * reason}]}} + blob: regions that cannot be drawn, the first of n answer   {type, id, body} + blob? problem  {type, id,
 * problem}                      instead of frame or answer pong     {type} How large each may be: packet_limits.h.
 */
#include "server/wire/json.h"
#include "server/wire/packet_limits.h"

enum { PACKET_HEAD_BYTES = 12 };

struct packet {
    cJSON *json;
    uint8_t *blob; /* NULL when n_blob is 0 */
    size_t n_blob;
};
void packet_finish(struct packet *packet);

/* Bytes to send for a packet; free(). blob is copied.
 *   errors ERROR_FORMAT a type there is no packet of, ERROR_LIMIT larger than its type may be, ERROR_MEMORY */
NODISCARD uint8_t *packet_write(const cJSON *json, const uint8_t *blob, size_t n_blob, size_t *n_bytes,
                                struct error *err);

/* What a frame says of its picture. */
struct packet_frame {
    uint16_t width_px, height_px;
    uint32_t scene_revision, render_us, encode_us;
    double pixels_per_mm;
    float clip_from_lps_mm[16];
    bool is_light;
};
/* The daemon's check of a "frame": every number within its bounds, a blob there. False: it breaks the rules. */
NODISCARD bool packet_frame_read(const struct packet *packet, struct packet_frame *frame);

/* Collects bytes of one direction from a stream and gives whole packets. Memory for a blob is taken when its packet's
 * type is known and allows it, and the bytes are read to where they stay. */
struct packet_reader;
struct packet_reader *packet_reader_create(enum packet_direction direction);
void packet_reader_destroy(struct packet_reader *reader);
/* Room for the next bytes from the socket: *n of them at most. NULL: ERROR_MEMORY. */
NODISCARD uint8_t *packet_reader_space(struct packet_reader *reader, size_t *n, struct error *err);
/* After n bytes were put there. */
void packet_reader_added(struct packet_reader *reader, size_t n);
/* 1 a packet (the caller's to finish), 0 more bytes needed, -1 broken (bad head, no JSON, a type of the other direction
 * or none, too large for its type, no memory): err says why, close the stream. */
int packet_reader_take(struct packet_reader *reader, struct packet *packet, struct error *err);
/* Bytes of memory it holds now. What a large packet needed is given back with the packet. */
size_t packet_reader_held(const struct packet_reader *reader);
