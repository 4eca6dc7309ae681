#pragma once
/* Inside core/formats/dicom: turns pixel cells as stored in a file into stored values of this machine. Any thread. */
#include "core/formats/dicom/dicom_basic.h"

/* Converts n cells in place: byte order, position of the bits in the cell, sign. */
void dicom_pixels_unpack(const struct dicom_pixels *pixels, bool is_swapped, void *values, size_t n);

/* Widens range[2] (smallest, largest) to n cells: uint8 for a cell_size of 1 byte, int16 or uint16 by is_signed for 2
 * bytes. Any other cell_size leaves range unchanged. */
void dicom_cells_measure(size_t cell_size, bool is_signed, const void *cells, size_t n, int32_t range[2]);
