#pragma once
/* The settings on who comes in, as far as answers tell them. */
#include <stdbool.h>

struct api_doors {
    bool is_alone; /* only this machine is answered */
    bool is_open;  /* to everybody, though nobody signs in */
};
