/* Encodes test images with OpenJPEG. */
#include "tests/unit/made_j2k.h"

#include <openjpeg-2.5/openjpeg.h>

#include "tests/check.h"

struct sink {
    uint8_t *data;
    size_t size, room, at;
};

static OPJ_SIZE_T sink_write(void *from, OPJ_SIZE_T n, void *context)
{
    struct sink *sink = context;
    if (sink->at + n > sink->room) {
        sink->room = 2 * (sink->at + n);
        sink->data = realloc(sink->data, sink->room);
        assert_non_null(sink->data);
    }
    memcpy(sink->data + sink->at, from, n);
    sink->at += n;
    sink->size = sink->at > sink->size ? sink->at : sink->size;
    return n;
}

static OPJ_BOOL sink_seek(OPJ_OFF_T at, void *context)
{
    ((struct sink *)context)->at = (size_t)at;
    return OPJ_TRUE;
}

static OPJ_OFF_T sink_skip(OPJ_OFF_T n, void *context)
{
    ((struct sink *)context)->at += (size_t)n;
    return n;
}

uint8_t *made_j2k_bytes(const struct made_j2k *like, int32_t (*value)(uint32_t x, uint32_t y), size_t *size)
{
    opj_image_cmptparm_t component = {
        .dx = 1, .dy = 1, .w = like->columns, .h = like->rows, .prec = like->bits, .sgnd = like->is_signed
    };
    opj_image_t *image = opj_image_create(1, &component, OPJ_CLRSPC_GRAY);
    assert_non_null(image);
    image->x1 = like->columns;
    image->y1 = like->rows;
    for (uint32_t y = 0; y < like->rows; y++)
        for (uint32_t x = 0; x < like->columns; x++)
            image->comps[0].data[y * like->columns + x] = value(x, y);
    opj_cparameters_t parameters;
    opj_set_default_encoder_parameters(&parameters);
    parameters.tcp_numlayers = 1;
    parameters.cp_disto_alloc = 1;
    parameters.numresolution = 3;
    while (parameters.numresolution > 1 &&
           1u << (parameters.numresolution - 1) > (like->rows < like->columns ? like->rows : like->columns))
        parameters.numresolution--;
    parameters.irreversible = like->is_lossy;
    parameters.tcp_rates[0] = like->is_lossy ? 4 : 0;
    if (like->tile > 0) {
        parameters.tile_size_on = OPJ_TRUE;
        parameters.cp_tdx = parameters.cp_tdy = (int)like->tile;
    }
    struct sink sink = { 0 };
    opj_codec_t *codec = opj_create_compress(like->is_boxed ? OPJ_CODEC_JP2 : OPJ_CODEC_J2K);
    opj_stream_t *stream = opj_stream_default_create(OPJ_FALSE);
    opj_stream_set_user_data(stream, &sink, NULL);
    opj_stream_set_write_function(stream, sink_write);
    opj_stream_set_seek_function(stream, sink_seek);
    opj_stream_set_skip_function(stream, sink_skip);
    assert_true(opj_setup_encoder(codec, &parameters, image));
    assert_true(opj_start_compress(codec, image, stream));
    assert_true(opj_encode(codec, stream));
    assert_true(opj_end_compress(codec, stream));
    opj_stream_destroy(stream);
    opj_destroy_codec(codec);
    opj_image_destroy(image);
    *size = sink.size;
    return sink.data;
}
