// A grey by the window's gamma, as core/render/visible/draw_tones.h has it. tone: 1 / gamma.
float toned(float grey, float tone) { return tone == 1.0 ? grey : pow(grey, tone); }
