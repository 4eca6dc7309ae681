#pragma once
/* Inside core/formats/dicom: stored values out of the cells that a file keeps them in. */
#include "core/formats/dicom/dicom_basic.h"

/* Makes n stored values of this machine out of those of a file: byte order, place of the bits, sign. In place. */
void dicom_pixels_unpack(const struct dicom_pixels *pixels, bool is_swapped, void *values, size_t n);

/* Widens range[2] (smallest, largest) to n cells: uint8, or int16 or uint16 by is_signed; cell_size is 1 or 2 bytes.
 * Any other cell_size leaves it as it is. */
void dicom_cells_measure(size_t cell_size, bool is_signed, const void *cells, size_t n, int32_t range[2]);
