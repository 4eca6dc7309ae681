#include "core/base/invisible.h"

#include <stddef.h>

const char *invisible_tag(uint32_t character)
{
    /* Abbreviations of the Unicode standard's names (NameAliases.txt, chapter 23). */
    static const struct {
        uint32_t character;
        const char *tag;
    } tags[] = {
        { 0xad, "SHY" },   { 0x61c, "ALM" },   { 0x180e, "MVS" },  { 0x200b, "ZWSP" }, { 0x200c, "ZWNJ" },
        { 0x200d, "ZWJ" }, { 0x200e, "LRM" },  { 0x200f, "RLM" },  { 0x2028, "LSEP" }, { 0x2029, "PSEP" },
        { 0x202a, "LRE" }, { 0x202b, "RLE" },  { 0x202c, "PDF" },  { 0x202d, "LRO" },  { 0x202e, "RLO" },
        { 0x2060, "WJ" },  { 0x2061, "FA" },   { 0x2062, "IT" },   { 0x2063, "IS" },   { 0x2064, "IP" },
        { 0x2066, "LRI" }, { 0x2067, "RLI" },  { 0x2068, "FSI" },  { 0x2069, "PDI" },  { 0x206a, "ISS" },
        { 0x206b, "ASS" }, { 0x206c, "IAFS" }, { 0x206d, "AAFS" }, { 0x206e, "NADS" }, { 0x206f, "NODS" },
        { 0xfeff, "BOM" },
    };
    for (size_t i = 0; i < sizeof tags / sizeof tags[0]; i++)
        if (tags[i].character == character)
            return tags[i].tag;
    return NULL;
}
