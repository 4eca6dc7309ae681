/* Destroys and compresses a request's picture. */
#include "core/pipeline/picture.h"

#include <stdlib.h>

#include "core/annotate/marks.h"
#include "core/base/log.h"

void pipeline_annotation_destroy(struct pipeline_annotation *annotation)
{
    if (annotation) {
        free(annotation->text);
        free(annotation->words);
    }
    free(annotation);
}

void picture_destroy(struct picture *picture)
{
    if (!picture)
        return;
    snapshot_unref(picture->request.snapshot);
    pipeline_annotation_destroy(picture->request.annotation);
    film_unref(picture->request.film);
    image_destroy(picture->image);
    free(picture->frame.picture.bytes);
    for (int i = 0; i < IMAGE_N_REDUCED; i++)
        free(picture->frame.reduced[i].bytes);
    free(picture->frame.marked.bytes);
    free(picture);
}

/* Replaces the image by one with letters, scale bar and caption. */
static bool annotate(struct picture *picture, struct error *err)
{
    const struct pipeline_annotation *annotation = picture->request.annotation;
    struct annotations annotations;
    struct image *annotated = NULL;
    if (annotations_describe(&annotations, picture->request.snapshot, picture->image->width_px, annotation->date,
                             err) &&
        (!annotation->words || annotations_add_words(&annotations, annotation->words, err))) {
        if (annotation->is_named)
            annotations_name_patient(&annotations, picture->request.snapshot->plan);
        if (annotation->has_crosshair)
            marks_add_crosshair(&annotations, picture->request.snapshot);
        annotations.has_no_caption = annotation->is_caption_apart;
        annotated = annotate_image(picture->image, &annotations, err);
    }
    annotations_finish(&annotations);
    image_destroy(picture->image);
    picture->image = annotated;
    return annotated != NULL;
}

static bool add_to_film(struct picture *picture)
{
    const struct pipeline_request *request = &picture->request;
    struct pipeline_frame *frame = &picture->frame;
    int size_px[2];
    return film_add(request->film, picture->image, request->n_film_times, &frame->error) &&
           (!request->ends_film || film_finish(request->film, &frame->picture, size_px, &frame->error));
}

static bool compress(struct encoder *encoder, struct picture *picture)
{
    const struct pipeline_request *request = &picture->request;
    struct pipeline_frame *frame = &picture->frame;
    if (request->annotation && !annotate(picture, &frame->error))
        return false;
    if (request->film)
        return add_to_film(picture);
    return request->annotation && request->encode.codec == ENCODE_PNG
               ? encode_png_with_text(picture->image, request->annotation->keyword, request->annotation->text,
                                      &frame->picture, &frame->error)
               : encode_image(encoder, picture->image, &request->encode, &frame->picture, &frame->error);
}

/* A reduced picture for which there is no memory is left out: the picture itself will do. */
static void compress_reduced(struct encoder *encoder, struct picture *picture)
{
    const struct pipeline_request *request = &picture->request;
    for (int i = 0; i < IMAGE_N_REDUCED; i++) {
        if (!request->is_reduced[i] || request->annotation)
            continue;
        struct error err = { 0 };
        struct image *image = image_reduce(picture->image, image_divisor(i), &err);
        if (!image || !encode_image(encoder, image, &request->encode, &picture->frame.reduced[i], &err))
            log_warn("a picture is not made smaller: %s", err.text);
        image_destroy(image);
    }
}

/* Paints on the image itself, which nobody needs any more. */
static void compress_marked(struct encoder *encoder, struct picture *picture)
{
    const struct pipeline_request *request = &picture->request;
    struct error err = { 0 };
    if (!request->mark || request->annotation)
        return;
    if (!annotate_mark(picture->image, request->mark, &err) ||
        !encode_image(encoder, picture->image, &request->encode, &picture->frame.marked, &err))
        log_warn("a picture is not made with the words \"%s\": %s", request->mark, err.text);
}

void picture_compress(struct encoder *encoder, struct picture *picture)
{
    if (!compress(encoder, picture) || picture->request.film)
        return;
    compress_reduced(encoder, picture);
    compress_marked(encoder, picture);
}
