/* Blocks of a paper. */
#include "server/paper/blocks.h"

#include <stdio.h>
#include <string.h>

static cJSON *block(struct paper *paper, const char *type)
{
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "type", type);
    json_append(paper->blocks, json);
    return json;
}

void block_heading(struct paper *paper, const char *text, const char *note)
{
    cJSON *json = block(paper, "heading");
    json_add(json, "text", written(text));
    json_add(json, "note", written(note));
}

void block_text(struct paper *paper, cJSON *text, const char *style)
{
    cJSON *json = block(paper, "text");
    json_add(json, "text", text);
    cJSON_AddStringToObject(json, "style", style);
}

void block_page(struct paper *paper)
{
    (void)block(paper, "page");
}

cJSON *block_table(struct paper *paper, const struct paper_column *columns, size_t n)
{
    cJSON *json = block(paper, "table"), *list = cJSON_AddArrayToObject(json, "columns");
    for (size_t i = 0; i < n; i++) {
        cJSON *column = cJSON_CreateObject();
        cJSON_AddStringToObject(column, "text", columns[i].words);
        cJSON_AddNumberToObject(column, "percent", columns[i].percent);
        cJSON_AddStringToObject(column, "side", columns[i].side == 'r' ? "right" : "left");
        json_append(list, column);
    }
    (void)cJSON_AddArrayToObject(json, "rows");
    return json;
}

cJSON *table_row(cJSON *table)
{
    cJSON *row = cJSON_CreateArray();
    json_append(cJSON_GetObjectItemCaseSensitive(table, "rows"), row);
    return row;
}

void row_add(cJSON *row, cJSON *text, const char *style)
{
    cJSON *cell = cJSON_CreateObject();
    json_add(cell, "text", text);
    cJSON_AddStringToObject(cell, "style", style);
    json_append(row, cell);
}

void table_end(struct paper *paper, cJSON *table, const char *without)
{
    if (cJSON_GetArraySize(cJSON_GetObjectItemCaseSensitive(table, "rows")))
        return;
    cJSON_Delete(cJSON_DetachItemViaPointer(paper->blocks, table));
    block_text(paper, written(without), "pale");
}
