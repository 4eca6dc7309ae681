#pragma once
/* Limits of a display window in a scene (proto/scene.json). Center and width are in the image's own values, which range
 * from neutrons per source particle to becquerels. A wider window from a file is clamped to them. */
#define WINDOW_CENTER_FARTHEST 1e12 /* center is within plus or minus this */
#define WINDOW_NARROWEST 1e-15
#define WINDOW_WIDEST 2e12
