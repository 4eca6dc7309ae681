#pragma once
/* Films that are being made of pictures, by their numbers: a renderer draws and compresses, the daemon asks for each
 * picture. Thread: the main thread. */
#include "core/encode/film.h"
#include "server/wire/packet.h"

enum {
    FILMS_MAX = 4,             /* at once; a further one takes the place of that which waits longest for a picture */
    FILM_MAX_BYTES = 32 << 20, /* of one; then it fails with PROBLEM_LIMIT */
    FILM_SPARE_LINES = 2,      /* of a caption that grows after the first picture */
    FILM_SPARE_LINES_WORDS = 6 /* likewise, where what is shown changes: of a meeting */
};

struct films;
struct films *films_create(void);
void films_destroy(struct films *films);
/* The film that the picture is to be added to, which the first picture begins: one reference, the caller's. NULL with
 * problem: PROBLEM_NOT_FOUND it has another number of pictures than the packet says, or one of them is under way;
 * PROBLEM_BUSY each of the others has one under way; PROBLEM_MEMORY. After success films_end_picture or
 * films_put_off_picture has to follow. */
NODISCARD struct film *films_begin_picture(struct films *films, const struct packet_render *render,
                                           struct problem *problem);
/* The picture is added; or it is not and the film, which has a gap, is forgotten, as is one that is whole. */
void films_end_picture(struct films *films, int64_t number, bool is_added, bool is_whole);
/* The picture is not even begun: the film waits for it still. */
void films_put_off_picture(struct films *films, int64_t number);
/* The film is forgotten, if there is one of this number. A picture under way ends as that of no film. */
void films_drop(struct films *films, int64_t number);
