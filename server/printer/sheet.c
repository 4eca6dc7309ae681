/* Text on a sheet, and its head and foot. */
#include "server/printer/sheet.h"

#include <math.h>
#include <pango/pangocairo.h>
#include <stdio.h>

/* ---- text --------------------------------------------------------------------------------------------------------- */

PangoLayout *sheet_text(const struct sheet *sheet, const char *text, const struct ink *ink, double width)
{
    PangoLayout *layout = pango_cairo_create_layout(sheet->cairo);
    PangoFontDescription *font = pango_font_description_new();
    pango_font_description_set_family_static(font, ink->is_code ? "DejaVu Sans Mono" : "DejaVu Sans");
    pango_font_description_set_absolute_size(font, ink->size * PANGO_SCALE);
    if (ink->is_bold)
        pango_font_description_set_weight(font, PANGO_WEIGHT_BOLD);
    pango_layout_set_font_description(layout, font);
    pango_font_description_free(font);
    pango_layout_set_text(layout, text, -1); /* never as markup */
    pango_layout_set_width(layout, (int)(fmax(width, 1) * PANGO_SCALE));
    pango_layout_set_wrap(layout, PANGO_WRAP_WORD_CHAR);
    pango_layout_set_auto_dir(layout, true);
    pango_layout_set_alignment(layout, ink->is_right ? PANGO_ALIGN_RIGHT : PANGO_ALIGN_LEFT);
    return layout;
}

double layout_height(PangoLayout *layout)
{
    int width, height;
    pango_layout_get_size(layout, &width, &height);
    return (double)height / PANGO_SCALE;
}

static void use_color(const struct sheet *sheet, unsigned rgb)
{
    cairo_set_source_rgb(sheet->cairo, (rgb >> 16 & 0xff) / 255.0, (rgb >> 8 & 0xff) / 255.0, (rgb & 0xff) / 255.0);
}

void sheet_show(const struct sheet *sheet, PangoLayout *layout, double x, double y, unsigned rgb)
{
    use_color(sheet, rgb);
    cairo_move_to(sheet->cairo, x, y);
    pango_cairo_show_layout(sheet->cairo, layout);
}

void sheet_line(const struct sheet *sheet, double x0, double y0, double x1, double y1, unsigned rgb, double width)
{
    use_color(sheet, rgb);
    cairo_set_line_width(sheet->cairo, width);
    cairo_move_to(sheet->cairo, x0, y0);
    cairo_line_to(sheet->cairo, x1, y1);
    cairo_stroke(sheet->cairo);
}

void sheet_write(struct sheet *sheet, const char *text, const struct ink *ink)
{
    PangoLayout *layout = sheet_text(sheet, text, ink, sheet->right - sheet->left);
    PangoLayoutIter *lines = pango_layout_get_iter(layout);
    do {
        int from, to;
        pango_layout_iter_get_line_yrange(lines, &from, &to);
        const double height = (double)(to - from) / PANGO_SCALE;
        sheet_need(sheet, height);
        PangoRectangle extents;
        pango_layout_iter_get_line_extents(lines, NULL, &extents);
        use_color(sheet, ink->rgb);
        cairo_move_to(sheet->cairo, sheet->left + (double)extents.x / PANGO_SCALE,
                      sheet->y + (double)(pango_layout_iter_get_baseline(lines) - from) / PANGO_SCALE);
        pango_cairo_show_layout_line(sheet->cairo, pango_layout_iter_get_line_readonly(lines));
        sheet->y += height;
    } while (pango_layout_iter_next_line(lines));
    pango_layout_iter_free(lines);
    g_object_unref(layout);
}

/* ---- pages -------------------------------------------------------------------------------------------------------- */

static const char *text_of(const cJSON *object, const char *name)
{
    const char *text = json_text(object, name);
    return text ? text : "";
}

/* The strip of a server that is open, and whose record it is. */
static double draw_head(const struct sheet *sheet)
{
    static const struct ink label = { 6.5, 0x3f474f, false, false, false }, name = { 9, 0x14181d, true, false, false },
                            small = { 7, 0x14181d, false, false, false }, red = { 7.5, 0xb3261e, true, false, false };
    const cJSON *paper = sheet->input->paper, *field;
    static const double parts[] = { 0, 0.24, 0.48, 0.66, 1 };
    const double wide = sheet->right - sheet->left;
    double y = SHEET_HEAD, height = 0;
    if (text_of(paper, "strip")[0]) {
        PangoLayout *strip = sheet_text(sheet, text_of(paper, "strip"), &red, wide);
        sheet_show(sheet, strip, sheet->left, y, red.rgb);
        y += layout_height(strip) + 4;
        g_object_unref(strip);
    }
    int i = 0;
    cJSON_ArrayForEach(field,
                       cJSON_GetObjectItemCaseSensitive(cJSON_GetObjectItemCaseSensitive(paper, "identity"), "fields"))
    {
        const double x = sheet->left + parts[i] * wide, width = (parts[i + 1] - parts[i]) * wide - 10;
        PangoLayout *layouts[] = { sheet_text(sheet, text_of(field, "label"), &label, width),
                                   sheet_text(sheet, text_of(field, "text"), &name, width),
                                   sheet_text(sheet, text_of(field, "more"), &small, width) };
        double at = y + 4;
        for (int k = 0; k < 3; k++) {
            if (k < 2 || text_of(field, "more")[0]) {
                pango_layout_set_height(layouts[k], -2); /* a longer name ends in an ellipsis */
                pango_layout_set_ellipsize(layouts[k], PANGO_ELLIPSIZE_END);
                sheet_show(sheet, layouts[k], x + 5, at, k == 0 ? label.rgb : name.rgb);
                at += layout_height(layouts[k]);
            }
            g_object_unref(layouts[k]);
        }
        height = fmax(height, at + 4 - y);
        if (++i == 4)
            break;
    }
    for (int k = 1; k < 4; k++)
        sheet_line(sheet, sheet->left + parts[k] * wide, y, sheet->left + parts[k] * wide, y + height, 0xc3cad1, 0.5);
    use_color(sheet, 0x14181d);
    cairo_set_line_width(sheet->cairo, 0.8);
    cairo_rectangle(sheet->cairo, sheet->left, y, wide, height);
    cairo_stroke(sheet->cairo);
    return y + height + 8;
}

static void draw_foot(const struct sheet *sheet)
{
    static const struct ink ink = { 6.5, 0x3f474f, false, false, false }, bold = { 6.5, 0x3f474f, true, false, false },
                            right = { 6.5, 0x3f474f, false, true, false };
    const cJSON *paper = sheet->input->paper;
    const double y = sheet->height - SHEET_FOOT + 4, wide = sheet->right - sheet->left, share = 0.66 * wide;
    char line[1200], page[64];
    (void)snprintf(line, sizeof line, "%.600s \xc2\xb7 %.300s",
                   text_of(cJSON_GetObjectItemCaseSensitive(paper, "identity"), "line"), text_of(paper, "foot"));
    (void)snprintf(page, sizeof page, "Page %d of %d", sheet->page, sheet->n_pages);
    PangoLayout *layouts[] = { sheet_text(sheet, line, &ink, share),
                               sheet_text(sheet, text_of(paper, "use"), &bold, share),
                               sheet_text(sheet, page, &right, wide - share),
                               sheet_text(sheet, text_of(paper, "printed"), &right, wide - share) };
    sheet_line(sheet, sheet->left, y - 3, sheet->right, y - 3, 0xd3d8dd, 0.5);
    for (int i = 0; i < 4; i++) {
        pango_layout_set_height(layouts[i], -1);
        pango_layout_set_ellipsize(layouts[i], PANGO_ELLIPSIZE_END);
        sheet_show(sheet, layouts[i], sheet->left + (i < 2 ? 0 : share), y + (i % 2) * 9, ink.rgb);
        g_object_unref(layouts[i]);
    }
}

void sheet_begin(struct sheet *sheet)
{
    sheet->page++;
    sheet->y = sheet->top = draw_head(sheet);
}

void sheet_end(struct sheet *sheet)
{
    draw_foot(sheet);
    cairo_show_page(sheet->cairo);
}

void sheet_new_page(struct sheet *sheet)
{
    sheet_end(sheet);
    sheet_begin(sheet);
}

void sheet_need(struct sheet *sheet, double height)
{
    if (sheet->y + height > sheet->bottom && sheet->y > sheet->top && sheet->page < PRINTER_MAX_PAGES)
        sheet_new_page(sheet);
}
