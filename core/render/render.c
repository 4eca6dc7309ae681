#include "core/render/render.h"

#include <string.h>

static const char *const words[RENDER_N_BACK_ENDS] = {
    [RENDER_AUTO] = "auto",
    [RENDER_EGL_DEVICE] = "egl-device",
    [RENDER_EGL_SURFACELESS] = "egl-surfaceless",
    [RENDER_OSMESA] = "osmesa",
};

const char *render_back_end_word(enum render_back_end back_end)
{
    return words[back_end];
}

bool render_back_end_from_word(const char *word, enum render_back_end *back_end)
{
    for (int i = 0; i < RENDER_N_BACK_ENDS; i++)
        if (strcmp(word, words[i]) == 0) {
            *back_end = (enum render_back_end)i;
            return true;
        }
    return false;
}
