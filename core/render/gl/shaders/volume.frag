// A volume with the translucent layers: along the ray of a sample from front to back, as core/render/visible/draw.h describes
// DRAW_VOLUME. Alpha of the result is the share of the picture below that still shows, for blending.
#include "light.glsl"
#include "tone.glsl"
#if WASH
#include "corners.glsl"
#include "wash.glsl"
uniform int is_face_washed; // cut faces; samples of rays and slices
uniform int is_ray_washed;
#endif
uniform sampler2DArray source; // layers
uniform sampler2DArray depths;
uniform sampler2D before; // depth of what is opaque
uniform int n_layers;
uniform float rank_depth;

uniform sampler3D grid;
uniform sampler2D table; // rows: colour and absorption per mm; colour of the image's levels
uniform int method;      // enum scene_volume_method
uniform vec4 picture;    // of the picture: columns and rows of samples; first row of the band
uniform vec4 unproject;  // z along forward = (y - depth w) / (depth z - x), depth -1 .. 1
uniform vec4 ray_eye;    // LPS; w: 1 in parallel projection
uniform vec4 ray_forward;
uniform vec4 ray_right; // a half picture
uniform vec4 ray_up;
uniform mat3 eye_from_lps;
uniform mat3 ijk_from_lps;
uniform vec4 eye_ijk;
uniform vec4 size;     // of the grid, voxels
uniform vec4 values;   // value = texture value * x + y; place in the table = (value - z) * w
uniform vec4 march;    // voxels a step, mm a step at most, nearest mm along forward, gradient of half the light
uniform vec4 sheets;   // method slices: z of the first along forward, mm between them, how many
uniform vec4 clips[8]; // normal, height of the eye
uniform int n_clips;
uniform int capped; // bit i: clip plane i is closed
uniform int is_linear;
uniform int samples; // along a side of a pixel
uniform int is_shaded;
uniform float cull; // in the image's unit
uniform vec2 grey;  // grey = value * x + y
uniform vec2 ends;
uniform float tone;
out vec4 result;

vec3 origin_ijk, step_ijk, towards; // of the ray: index = origin + t step, t in mm
vec3 light_sum = vec3(0.0);
float passed = 1.0;

float jitter() {
    uint shift = samples > 1 ? 1u : 0u, x = uint(gl_FragCoord.x), y = uint(gl_FragCoord.y) + uint(picture.z);
    uint hash = (x >> shift) * JITTER_X + (y >> shift) * JITTER_Y;
    float pixel = float(hash >> 8u) * (1.0 / 16777216.0);
    return samples > 1 ? 0.25 * (float(((x ^ y) & 1u) + 2u * (x & 1u)) + pixel) : pixel;
}

float linear_at(vec3 ijk) { return texture(grid, (ijk + 0.5) / size.xyz).r * values.x + values.y; }
float value_at(vec3 ijk) {
    if (is_linear != 0) return linear_at(ijk);
    return texelFetch(grid, ivec3(clamp(ijk + 0.5, vec3(0.0), size.xyz - 0.5)), 0).r * values.x + values.y;
}
bool is_there(float value) { return value >= cull && !isinf(value); }
vec3 image_color(float value) {
    float level = toned(mix(ends.x, ends.y, clamp(value * grey.x + grey.y, 0.0, 1.0)), tone);
    return texelFetch(table, ivec2(int(level * 255.0 + 0.5), 1), 0).rgb;
}
vec4 transfer(float value) {
    return texelFetch(table, ivec2(int(clamp((value - values.z) * values.w, 0.0, TABLE - 1.0) + 0.5), 0), 0);
}

vec3 lit(vec3 rgb, vec3 ijk) {
    vec3 g = vec3(linear_at(ijk + vec3(1.0, 0.0, 0.0)) - linear_at(ijk - vec3(1.0, 0.0, 0.0)),
                  linear_at(ijk + vec3(0.0, 1.0, 0.0)) - linear_at(ijk - vec3(0.0, 1.0, 0.0)),
                  linear_at(ijk + vec3(0.0, 0.0, 1.0)) - linear_at(ijk - vec3(0.0, 0.0, 1.0))) * 0.5 * ijk_from_lps;
    float square = dot(g, g);
    if (!(square > 0.0)) return rgb * FLAT;
    vec3 n = g * inversesqrt(square);
    float facing = dot(n, towards), part = square / (square + march.w * march.w);
    if (facing < 0.0) { n = -n; facing = -facing; }
    vec2 terms = light_terms(eye_from_lps * n, min(facing, 1.0), lights.z);
    return min(rgb * mix(FLAT, terms.x, part) + part * terms.y, 1.0);
}

vec3 washed(vec3 rgb, vec3 ijk, bool is_washed) {
#if WASH
    if (is_washed) {
        vec4 over = wash_at(ijk);
        return mix(rgb, over.rgb, over.a);
    }
#endif
    return rgb;
}
#if WASH
#define FACE_WASHED (is_face_washed != 0)
#define RAY_WASHED (is_ray_washed != 0)
#else
#define FACE_WASHED false
#define RAY_WASHED false
#endif

// Hides what is behind a distance, in the colours of the image.
void hide_at(float t, bool is_washed) {
    vec3 ijk = origin_ijk + t * step_ijk;
    light_sum += passed * washed(max(image_color(value_at(ijk)), DARKEST_GREY), ijk, is_washed);
    passed = 0.0;
}

// Absorbs the light between two distances.
void march_ray(float first, float end, float h, float at) {
    for (float k = 0.0; passed > LEAST_LEFT; k += 1.0) {
        float begin = first + k * h, d = min(h, end - begin);
        if (!(d > 0.0)) break;
        vec3 ijk = origin_ijk + (begin + at * d) * step_ijk;
        float value = value_at(ijk);
        if (!is_there(value)) continue;
        vec4 entry = transfer(value);
        if (entry.a <= 0.0) continue;
        float passes = exp(-entry.a * d), weight = passed * (1.0 - passes);
        vec3 rgb = is_shaded == 0 ? entry.rgb : weight > LEAST_LIT ? lit(entry.rgb, ijk) : entry.rgb * FLAT;
        light_sum += weight * washed(rgb, ijk, RAY_WASHED);
        passed *= passes;
    }
}

#if DEPTH
// The distance where half of the light is absorbed, before end; else end. x: the distance, and the interval around it: y, its
// start; z: the light there.
vec3 find_half(float first, float end, float h, float light) {
    for (float k = 0.0;; k += 1.0) {
        float begin = first + k * h, d = min(h, end - begin);
        if (!(d > 0.0)) break;
        float value = value_at(origin_ijk + (begin + 0.5 * d) * step_ijk);
        if (!is_there(value)) continue;
        float left = light * exp(-transfer(value).a * d);
        if (left < 0.5) return vec3(begin + d * (light - 0.5) / (light - left), begin, light);
        light = left;
    }
    return vec3(end, end, light);
}

// The distance of half light to 1 / 64 of an interval h of the picture: normals come from depths of neighbouring pixels.
float half_light(float entry, float end, float h) {
    vec3 found = find_half(entry, end, h / 4.0, 1.0);
    if (found.x >= end) return end;
    float first = max(found.y - (found.z >= 1.0 ? h / 8.0 : 0.0), entry);
    return find_half(first, min(found.y + h / 2.0, end), h / 64.0, found.z).x;
}
#endif

// The largest value between two distances, or the mean: x; y: the length of what is there.
vec2 gather(float first, float end, float h, float at) {
    vec2 sum = vec2(0.0);
    for (float k = 0.0;; k += 1.0) {
        float begin = first + k * h, d = min(h, end - begin);
        if (!(d > 0.0)) break;
        float value = value_at(origin_ijk + (begin + at * d) * step_ijk);
        if (!is_there(value)) continue;
        if (method == METHOD_AVERAGE) sum.x += value * d;
        else if (sum.y == 0.0 || value > sum.x) sum.x = value;
        sum.y += d;
    }
    return method == METHOD_AVERAGE && sum.y > 0.0 ? vec2(sum.x / sum.y, sum.y) : sum;
}

// The distance of the nearest slice that is there; end: none is.
float nearest_sheet(float first, float end, float mm_per_z) {
    float spacing = sheets.y * mm_per_z, start = sheets.x * mm_per_z;
    for (float k = max(ceil((first - start) / spacing), 0.0); k < sheets.z; k += 1.0) {
        float t = start + k * spacing;
        if (t >= end) break;
        if (is_there(value_at(origin_ijk + t * step_ijk))) return t;
    }
    return end;
}

// The nearest layer behind the last one that is not behind what is opaque; -1: there is none. Nearest first is the
// order of compose.frag backwards.
int next_layer(ivec2 at, float opaque, inout float last, inout int last_layer) {
    float least = 4.0, depth;
    int nearest = -1;
    for (int i = 0; i < n_layers; i++) {
        depth = texelFetch(depths, ivec3(at, i), 0).r;
        if (depth >= opaque) continue;
        depth -= rank_depth * float(i);
        if (depth <= least && (depth > last || (depth == last && i < last_layer))) { least = depth; nearest = i; }
    }
    last = least;
    last_layer = nearest;
    return nearest;
}

float depth_of(float z) {
    return 0.5 * (unproject.y + z * unproject.x) / (z * unproject.z + unproject.w) + 0.5;
}
float z_of(float depth) {
    float ndc = 2.0 * depth - 1.0;
    return (unproject.y - ndc * unproject.w) / (ndc * unproject.z - unproject.x);
}

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    float x = 2.0 * gl_FragCoord.x / picture.x - 1.0, y = 1.0 - 2.0 * (gl_FragCoord.y + picture.z) / picture.y;
    vec3 aside = x * ray_right.xyz + y * ray_up.xyz, forward = ray_forward.xyz + (1.0 - ray_eye.w) * aside;
    float mm_per_z = length(forward);
    vec3 offset = ray_eye.w * aside, along = forward / mm_per_z;
    origin_ijk = eye_ijk.xyz + ijk_from_lps * offset;
    step_ijk = ijk_from_lps * along;
    towards = -along;

    float opaque = texelFetch(before, at, 0).r;
    float entry = march.z * mm_per_z, before_mm = opaque < 1.0 ? z_of(opaque) * mm_per_z : 1e30, end = before_mm;
    bool is_cut_face = false; // the ray enters through a closed clip plane at what is seen: the plane shows the image
    for (int a = 0; a < 3; a++) {
        float low = -0.5 - origin_ijk[a], high = size[a] - 0.5 - origin_ijk[a];
        if (abs(step_ijk[a]) < 1e-9) {
            if (low > 0.0 || high < 0.0) end = -1e30;
            continue;
        }
        float t0 = low / step_ijk[a], t1 = high / step_ijk[a];
        entry = max(entry, min(t0, t1));
        end = min(end, max(t0, t1));
    }
    for (int i = 0; i < n_clips; i++) {
        float height = clips[i].w + dot(clips[i].xyz, offset), rise = dot(clips[i].xyz, along), t = -height / rise;
        if (abs(rise) < 1e-9) {
            if (height > 0.0) end = -1e30;
        } else if (rise > 0.0) end = min(end, t);
        else if (t > entry) {
            entry = t;
            is_cut_face = (capped >> i & 1) != 0;
        }
    }
    is_cut_face = is_cut_face && method == METHOD_RAY && entry < end && entry + 1e-3 < before_mm; // a cap may lie there
    if (is_cut_face) {
        float value = value_at(origin_ijk + entry * step_ijk);
        is_cut_face = is_there(value) && transfer(value).a > 0.0;
    }
    vec3 speed = abs(step_ijk);
    float h = min(march.x / max(max(speed.x, speed.y), speed.z), march.y), shift = jitter(), last = -4.0;
#if DEPTH
    float found = is_cut_face ? entry : half_light(entry, end, h);
    if (!is_cut_face && !(found < end)) discard;
    gl_FragDepth = 0.5 * clamp(depth_of(found / mm_per_z), 0.0, 1.0) + (is_cut_face ? 0.5 : 0.0);
    result = vec4(0.0);
    return;
#endif
    float sheet = method == METHOD_SLICES && entry < end ? nearest_sheet(entry, end, mm_per_z) : end;
    bool has_sheet = method == METHOD_SLICES && entry < end && sheet < end;
    int last_layer = -1;
    while (passed > LEAST_LEFT) {
        int layer = next_layer(at, opaque, last, last_layer);
        float t = layer < 0 ? 1e30 : z_of(texelFetch(depths, ivec3(at, layer), 0).r) * mm_per_z;
        if (is_cut_face && t > entry) hide_at(entry, FACE_WASHED);
        if (method == METHOD_RAY && entry < min(t, end)) {
            march_ray(entry, min(t, end), h, shift);
            entry = min(t, end);
        }
        if (has_sheet && t > sheet) hide_at(sheet, RAY_WASHED);
        if (layer < 0 || passed <= LEAST_LEFT) break;
        vec4 over = texelFetch(source, ivec3(at, layer), 0);
        light_sum += passed * over.a * over.rgb;
        passed *= 1.0 - over.a;
    }
    if ((method == METHOD_MIP || method == METHOD_AVERAGE) && entry < end) {
        vec2 found = gather(entry, end, h, shift);
        if (found.y > 0.0) {
            vec3 rgb = image_color(found.x);
            float behind = 1.0 - max(max(rgb.r, rgb.g), rgb.b);
            light_sum = rgb + behind * light_sum;
            passed *= behind;
        }
    }
    if (passed == 1.0) discard;
    result = vec4(light_sum, passed);
}
