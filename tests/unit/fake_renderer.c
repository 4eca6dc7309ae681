/* The made-up renderer: reads "behave" in its plan folder, and does what each word there says. */
#include "tests/unit/fake_renderer.h"

#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "server/wire/packet.h"

static char behaviour[64];

static bool behaves(const char *word)
{
    return strcmp(behaviour, word) == 0;
}

static const char *argument(int argc, char **argv, const char *flag)
{
    for (int i = 1; i + 1 < argc; i++)
        if (strcmp(argv[i], flag) == 0)
            return argv[i + 1];
    return NULL;
}

static void read_behaviour(const char *folder)
{
    char path[512];
    snprintf(path, sizeof path, "%s/behave", folder);
    FILE *file = fopen(path, "r");
    if (file && !fgets(behaviour, sizeof behaviour, file))
        behaviour[0] = 0;
    if (file)
        fclose(file);
}

static void write_all(const void *bytes, size_t n)
{
    for (const char *at = bytes; n > 0;) {
        ssize_t wrote = write(3, at, n);
        if (wrote <= 0)
            _exit(0);
        at += wrote;
        n -= (size_t)wrote;
    }
}

/* Without any of packet.h's checks. */
static void send_packet(cJSON *json, const void *blob, size_t n_blob)
{
    char *text = json_write(json);
    const uint32_t head[3] = { 0x4b505242u, (uint32_t)strlen(text), (uint32_t)n_blob };
    write_all(head, sizeof head);
    write_all(text, strlen(text));
    write_all(blob, n_blob);
    free(text);
    cJSON_Delete(json);
}

static cJSON *word(const char *type)
{
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "type", type);
    return json;
}

static void send_progress(double percent)
{
    cJSON *json = word("progress");
    cJSON_AddStringToObject(json, "phase", "reading");
    cJSON_AddNumberToObject(json, "percent", percent);
    send_packet(json, NULL, 0);
}

static void send_ready(const char *id)
{
    cJSON *json = word("ready"), *plan = cJSON_AddObjectToObject(json, "plan");
    cJSON_AddStringToObject(plan, "id", behaves("other-id") ? "another" : id);
    cJSON *images = cJSON_AddArrayToObject(plan, "images");
    for (int i = 0, n = behaves("65-images") ? 65 : behaves("64-images") ? 64 : 1; i < n; i++) {
        cJSON *image = cJSON_CreateObject();
        cJSON_AddStringToObject(image, "id", behaves("image-id") ? "../ct" : "ct");
        cJSON_AddItemToArray(images, image);
    }
    cJSON *scene = cJSON_AddObjectToObject(json, "scene");
    if (behaves("wrong-scene"))
        cJSON_AddNumberToObject(scene, "regions", 7);
    cJSON_AddStringToObject(json, "confined", "not at all");
    cJSON_AddNumberToObject(json, "load_ms", 12);
    send_packet(json, NULL, 0);
}

static void send_frame(const cJSON *render)
{
    cJSON *json = word("frame");
    cJSON_AddNumberToObject(json, "id", json_number(render, "id", 0));
    cJSON_AddNumberToObject(json, "width_px", behaves("liar") ? -5 : 64);
    static const char *const others[] = { "height_px", "scene_revision", "render_us", "encode_us", "pixels_per_mm" };
    for (size_t i = 0; i < 5; i++)
        cJSON_AddNumberToObject(json, others[i], 48);
    cJSON *matrix = cJSON_AddArrayToObject(json, "clip_from_lps_mm");
    for (int i = 0; i < 16; i++)
        cJSON_AddItemToArray(matrix, cJSON_CreateNumber(i));
    send_packet(json, "picture", 7);
}

static void die(void)
{
    kill(getpid(), SIGKILL);
    pause();
}

/* Writes 80 MiB, and again when the file was removed while it still grew; ends with the process. */
static void *fill(void *path)
{
    for (;; nanosleep(&(struct timespec){ .tv_nsec = 20000000 }, NULL)) {
        int file = open(path, O_RDWR | O_CREAT, 0600);
        if (file >= 0) {
            (void)posix_fallocate(file, 0, 80 << 20);
            close(file);
        }
    }
    return NULL;
}

static cJSON *revisions; /* of each room's scene, the last that was told */

static void handle(const struct packet *in, const char *folder)
{
    const cJSON *packet = in->json;
    const char *type = json_text(packet, "type");
    char mark[512];
    snprintf(mark, sizeof mark, "%s/crashed", folder);
    if (strcmp(type, "ping") == 0) {
        send_packet(word("pong"), NULL, 0);
    } else if (strcmp(type, "render") == 0) {
        if (behaves("crash-on-render") || (behaves("crash-once") && access(mark, F_OK) != 0 && mkdir(mark, 0700) == 0))
            die();
        static int n_renders;
        if (!behaves("never-draws") && !behaves("late-and-never-draws") &&
            !(behaves("forgets-first") && n_renders++ == 0))
            send_frame(packet);
    } else if (packet_descriptions[in->type].question) {
        for (int64_t until_us = clock_now_us() + 2000000; behaves("computes") && clock_now_us() < until_us;)
            continue;
        cJSON *json = word("answer");
        cJSON_AddNumberToObject(json, "id", json_number(packet, "id", 0));
        cJSON_AddItemToObject(json, "body", cJSON_Duplicate(behaves("remembers-scenes") ? revisions : packet, true));
        send_packet(json, NULL, 0);
    } else if (behaves("remembers-scenes") && (strcmp(type, "scene") == 0 || strcmp(type, "forget") == 0)) {
        const char *room = json_text(packet, "room");
        revisions = revisions ? revisions : cJSON_CreateObject();
        cJSON_DeleteItemFromObjectCaseSensitive(revisions, room);
        if (strcmp(type, "scene") == 0)
            cJSON_AddNumberToObject(revisions, room, json_number(packet, "revision", -1));
    } else if (strcmp(type, "scene") == 0 && behaves("floods")) {
        for (;;)
            send_progress(1);
    }
}

static int renderer_main(const char *folder, const char *id, const char *cache)
{
    read_behaviour(folder);
    if (behaves("fills-its-cache")) {
        static char path[512];
        pthread_t filler;
        snprintf(path, sizeof path, "%s/large", cache);
        if (pthread_create(&filler, NULL, fill, path) != 0)
            return 8;
    }
    if (behaves("crash-loading"))
        die();
    if (behaves("takes-shared-memory")) { /* which counts for no limit of the kernel's */
        const size_t n = (size_t)300 << 20;
        void *memory = mmap(NULL, n, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
        if (memory == MAP_FAILED)
            return 8;
        memset(memory, 1, n);
        for (;;)
            pause();
    }
    if (behaves("huge-head")) {
        uint32_t head[3] = { 0x4b505242u, 0xffffffffu, 0xffffffffu };
        write_all(head, sizeof head);
    }
    if (behaves("garbage"))
        write_all("HTTP/1.1 200 OK\r\n\r\n", 19);
    if (behaves("no-type"))
        write_all("BRPK\2\0\0\0\0\0\0\0{}", 14); /* a little-endian machine's */
    if (behaves("large-frame")) {                /* within what an answer may have */
        uint32_t head[3] = { 0x4b505242u, 16, 400u << 20 };
        write_all(head, sizeof head);
        write_all("{\"type\":\"frame\"}", 16);
    }
    char read_mark[512], refused_mark[512];
    (void)snprintf(read_mark, sizeof read_mark, "%s/was-read", folder);
    (void)snprintf(refused_mark, sizeof refused_mark, "%s/was-refused", folder);
    bool lacks_memory =
        behaves("memory-at-second-start") && mkdir(read_mark, 0700) != 0 && mkdir(refused_mark, 0700) == 0;
    if (behaves("fails") || behaves("no-memory") || lacks_memory) {
        struct problem problem;
        if (behaves("fails"))
            problem_set(&problem, PROBLEM_VALIDATION, "", "format", "ct.nii: byte 40: 9 axes, expected 3");
        else if (lacks_memory)
            problem_set(&problem, PROBLEM_MEMORY, "", "", "ct.nii: no memory for 2000 bytes");
        else
            problem_set(&problem, PROBLEM_INTERNAL, "", "", "ct.nii: no memory for 1000 bytes");
        cJSON *json = word("failed");
        cJSON_AddItemToObject(json, "problem", problem_to_json(&problem));
        send_packet(json, NULL, 0);
        return 3;
    }
    cJSON *gl = word("gl");
    cJSON_AddStringToObject(gl, "back_end", "made-up");
    send_packet(gl, NULL, 0);
    send_progress(10);
    for (double percent = 20; behaves("loads-for-ever"); percent = percent < 90 ? percent + 0.01 : 20) {
        send_progress(percent);
        nanosleep(&(struct timespec){ .tv_nsec = 20000000 }, NULL);
    }
    while (behaves("stalls"))
        pause();
    if (behaves("late-and-never-draws"))
        nanosleep(&(struct timespec){ .tv_sec = 1, .tv_nsec = 500000000 }, NULL);
    send_ready(id);
    if (behaves("deaf"))
        raise(SIGSTOP);
    struct packet_reader *reader = packet_reader_create(PACKET_TO_RENDERER);
    for (;;) {
        size_t room;
        struct packet packet;
        uint8_t *space = packet_reader_space(reader, &room, NULL);
        ssize_t n = space ? read(3, space, room) : 0;
        if (n <= 0)
            break;
        packet_reader_added(reader, (size_t)n);
        while (packet_reader_take(reader, &packet, NULL) == 1) {
            handle(&packet, folder);
            packet_finish(&packet);
        }
    }
    packet_reader_destroy(reader);
    return 0;
}

static int scan_main(const char *folder)
{
    read_behaviour(folder);
    if (behaves("scan-crashes"))
        die();
    while (behaves("scan-hangs"))
        pause();
    if (behaves("no-memory"))
        nanosleep(&(struct timespec){ .tv_sec = 2 }, NULL); /* it is being looked at while it fails to load */
    if (behaves("scan-babbles"))
        for (;;)
            puts("more and more");
    printf(
        "{\"name\":\"A plan\",\"note\":\"n\",\"phantom\":true,\"readable\":%s,\"reason\":\"a DICOM folder\",\"parts\":[\"CT\"],\"n_bytes\":77}\n",
        behaves("unreadable") ? "false" : "true");
    return 0;
}

/* The archive's text says how it behaves; "NAME/WORDS" unpacks to a plan folder NAME whose behaviour is WORDS. */
static int unpack_main(const char *archive, const char *folder)
{
    char inside[256] = "", path[512];
    FILE *file = fopen(archive, "r");
    if (!file || !fgets(inside, sizeof inside, file))
        return 2;
    fclose(file);
    (void)setvbuf(stdout, NULL, _IOLBF, 0);
    puts("{\"percent\": 12.5}");
    snprintf(path, sizeof path, "%s/half", folder);
    if (strcmp(inside, "hangs") == 0) {
        (void)mkdir(path, 0700);
        for (;;)
            pause();
    }
    if (strcmp(inside, "refuses") == 0) {
        puts("{\"problem\": {\"type\": \"/problems/validation\", \"detail\": \"entry 3 leads out of the folder\"}}");
        return 3;
    }
    if (strcmp(inside, "dies") == 0)
        die();
    if (strcmp(inside, "says-nothing") == 0)
        return 0;
    if (strcmp(inside, "floods") == 0)
        for (;;)
            puts("{\"percent\": 13}");
    if (strcmp(inside, "one-line") == 0)
        for (;;)
            putchar('x');
    if (strcmp(inside, "lies") == 0)
        puts("{\"percent\": 1e999}\nnot JSON\n[]\n{\"percent\": 3}\n{\"percent\": 101}\n{\"percent\": 12.75}");
    while (strcmp(inside, "lies") == 0)
        pause();
    for (int i = 0; strcmp(inside, "slow") == 0 && i < 40; i++) {
        puts("{\"percent\": 14}");
        nanosleep(&(struct timespec){ .tv_nsec = 100000000 }, NULL);
    }
    char *slash = strchr(inside, '/');
    if (slash) {
        *slash = 0;
        snprintf(path, sizeof path, "%s/%s", folder, inside);
        (void)mkdir(path, 0700);
        snprintf(path, sizeof path, "%s/%s/behave", folder, inside);
    } else {
        snprintf(path, sizeof path, "%s/behave", folder);
    }
    file = fopen(path, "w");
    if (!file || fputs(slash ? slash + 1 : "", file) < 0 || fclose(file) != 0)
        return 2;
    puts("{\"done\": true, \"n_files\": 1, \"n_bytes\": 9}");
    return 0;
}

int fake_renderer_main(int argc, char **argv)
{
    const char *folder = argument(argc, argv, "--plan-folder"), *id = argument(argc, argv, "--plan-id");
    if (folder && id)
        return renderer_main(folder, id, argument(argc, argv, "--cache"));
    if (argument(argc, argv, "--unpack"))
        return unpack_main(argument(argc, argv, "--unpack"), argument(argc, argv, "--into"));
    if (argument(argc, argv, "--scan"))
        return scan_main(argument(argc, argv, "--scan"));
    return puts("{\"back_end\":\"made-up\",\"is_software\":true}") < 0;
}
