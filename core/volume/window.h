#pragma once
/* Windows a scene can have (proto/scene.json): center and width in the image's own values, from neutrons per source
 * particle to becquerels. A wider window of a file is cut to them. */
#define WINDOW_CENTER_FARTHEST 1e12 /* center lies within plus or minus this */
#define WINDOW_NARROWEST 1e-15
#define WINDOW_WIDEST 2e12
