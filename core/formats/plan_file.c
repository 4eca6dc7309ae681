/* The content of plan.json and of lists of label names, as plain structs. */
#include "core/formats/plan_file.h"

#include <stdlib.h>

void plan_file_destroy(struct plan_file *file)
{
    if (!file)
        return;
    free(file->regions);
    free(file->pairs);
    free(file);
}

void label_names_finish(struct label_names *names)
{
    free(names->labels);
    *names = (struct label_names){ 0 };
}
