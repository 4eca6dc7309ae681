#pragma once
/* Text as pixels, by FreeType, with the font DejaVu Sans, which is compiled in, and for characters that it lacks
 * (Chinese, Japanese, Korean) with Debian's fonts-droid-fallback, where that is installed. The only file with FreeType.
 * Text is any bytes: what is not UTF-8, and control characters, are drawn as U+FFFD; other characters that do not show
 * as tags, «RLO» (core/base/invisible.h); characters of neither font as numbers, <U+816B>. No shaping: each character
 * is drawn on its own, left to right. */
#include <stdint.h>

#include "core/base/error.h"

struct font;
/* Opens the files of the fallback fonts, as far as they are there. Call it before the process gives up access
 * to files; the first text that needs these fonts calls it if it has not run yet. BEAMROOM_FALLBACK_FONT names another
 * file. Any thread. */
void font_prepare(void);
/* errors ERROR_MEMORY. thread: one at a time for each font. */
NODISCARD struct font *font_create(int size_px, struct error *err);
void font_destroy(struct font *font);
int font_size_px(const struct font *font);
int font_ascent_px(const struct font *font);  /* from the baseline to above the highest letter */
int font_descent_px(const struct font *font); /* from the baseline to below the lowest */

enum { FONT_MAX_CHARACTERS = 256 };
/* A line of text, laid out. */
struct font_line {
    uint32_t characters[FONT_MAX_CHARACTERS];
    int advance_px[FONT_MAX_CHARACTERS];
    int n;
    int width_px; /* sum of the advances */
};
/* Lays out text so that it is at most max_width_px wide: characters in the middle give way to one "…". Text of more
 * than FONT_MAX_CHARACTERS is shortened in the same way. errors ERROR_MEMORY */
NODISCARD bool font_lay_out(struct font *font, const char *text, int max_width_px, struct font_line *line,
                            struct error *err);

/* Coverage of pixels, 0..255; what lies outside is left out. */
struct coverage {
    uint8_t *pixels; /* [height][width] */
    int width_px, height_px;
};
/* Draws the line from (x, baseline). Where it covers a pixel more than before, the pixel is raised to that.
 *   errors ERROR_MEMORY */
NODISCARD bool font_draw(struct font *font, const struct font_line *line, int x_px, int baseline_px,
                         struct coverage *coverage, struct error *err);
