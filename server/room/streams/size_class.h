#pragma once
/* Size classes of shared pictures: whole, half and quarter. A shared view is drawn once, in the presenter's size; the
 * renderer reduces and compresses that picture once for each class in which somebody follows, and all in a class are
 * sent the same bytes. A member's class is the smallest picture that has at least as many pixels as the member's pane
 * shows of it: where the picture fits into the pane (letterboxed), it is reduced by 4 or 2 while each pixel of the
 * screen still has a pixel of its own. So no class looks worse than the whole, and a change of class is not seen.
 *   - The whole picture is always made: it is there for who comes, for whose pane grows, and for displays. A pane that
 * grows is sent a larger picture of what is there, the next ones in its own class; one that shrinks keeps what it has.
 * Nobody's pane makes anything be drawn or compressed again, so panes that change size all the time cost nothing, and
 * no hysteresis is needed.
 *   - Of moving pictures, a member whose link is slow (lag.h) gets those of the next smaller class; stills are as sharp
 * as for others.
 *   - A room that plays a recording sends whole pictures only.
 *
 * Measured on the demo plan, 1440 x 900, two cores (bench_render): in 3-D 49, 16 and 5 kB while it moves, 84, 27 and 9
 * kB as a still; as an axial pane 61, 19 and 6 kB, 108, 36 and 10 kB. A moving one in 3-D is drawn by our own
 * rasteriser in 3.8 ms and compressed in 2.1; the half of it is reduced and compressed in 0.9 ms, the quarter in 0.4.
 *
 * Internal to server/room. */
#include "server/room/state/room_state.h"

/* Fills in the reduced pictures that viewers of the stream need of a picture at scale_percent of the view's size. */
void size_classes_needed(const struct room *room, const struct stream *stream, int scale_percent, bool is_still,
                         bool is_reduced[IMAGE_N_REDUCED]);
/* The picture of the view's class; a larger one where that was not made. Borrowed from picture. */
struct frame *size_class_picture(const struct room *room, const struct member_view *view, struct frame *picture,
                                 bool is_still);
