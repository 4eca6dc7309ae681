/* Reads SERA's hierarchy of regions, body_containment.info. */
#include "core/formats/hierarchy.h"

#include "core/formats/text.h"

size_t hierarchy_parse(const uint8_t *data, size_t size, const char *name, struct plan_file_pair *pairs, size_t most,
                       struct report *report)
{
    struct text text;
    char line[TEXT_LINE_SIZE], *outer, *inner;
    size_t n = 0;
    text_start(&text, data, size);
    while (text_line(&text, line)) {
        if (line[0] == 0)
            continue;
        if (!text_split(line, ">", &outer, &inner) || !outer[0] || !inner[0]) {
            report_add(report, REPORT_WARNING, "hierarchy.line", name, "Line %zu is not \"outer > inner\".", text.line);
            continue;
        }
        if (n >= most) {
            report_add(report, REPORT_WARNING, "hierarchy.line", name,
                       "More than %zu lines; those from line %zu on were left out.", most, text.line);
            break;
        }
        text_clean(outer, pairs[n].outer, sizeof pairs[n].outer);
        text_clean(inner, pairs[n].inner, sizeof pairs[n].inner);
        n++;
    }
    return n;
}
