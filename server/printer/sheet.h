#pragma once
/* The sheet that is being drawn on: where the next block goes, and what stands on each page. All lengths are points, 72
 * an inch, y down. Internal to server/printer. */
#include "server/printer/draw.h"

/* of Pango and Cairo */
typedef struct _PangoLayout PangoLayout;
typedef struct _cairo cairo_t;
typedef struct _cairo_surface cairo_surface_t;

enum { SHEET_SIDE = 45, SHEET_HEAD = 34, SHEET_FOOT = 40 }; /* margins */

struct sheet {
    const struct drawing_input *input;
    cairo_surface_t *surface;
    cairo_t *cairo;
    double width, height;               /* of the page */
    double left, right, top, bottom, y; /* of what blocks may take; y: where the next one begins */
    int page, n_pages;                  /* n_pages 0: they are only counted */
};

struct ink {
    double size;
    unsigned rgb;
    bool is_bold, is_right, is_code;
};

/* A text set to this width, for g_object_unref; its height in points. */
PangoLayout *sheet_text(const struct sheet *sheet, const char *text, const struct ink *ink, double width);
double layout_height(PangoLayout *layout);
void sheet_show(const struct sheet *sheet, PangoLayout *layout, double x, double y, unsigned rgb);
/* Text at the next place, over as many pages as it takes. */
void sheet_write(struct sheet *sheet, const char *text, const struct ink *ink);
void sheet_line(const struct sheet *sheet, double x0, double y0, double x1, double y1, unsigned rgb, double width);
/* Goes on to a new page where less than this is left on this one. */
void sheet_need(struct sheet *sheet, double height);
void sheet_begin(struct sheet *sheet); /* a page: with its head */
void sheet_end(struct sheet *sheet);   /* with its foot */
void sheet_new_page(struct sheet *sheet);
void block_draw(struct sheet *sheet, const cJSON *block);
