#pragma once
/* The coordinate spaces, and the suffix that a variable holding a point in each of them carries.
 *
 *   _lps_mm   patient, DICOM: +x to the patient's Left, +y to the Posterior, +z to the Superior side; millimetres.
 *             Everything lives here unless its name says otherwise.
 *   _ijk      index into one grid: i fastest; the centre of a voxel is at whole numbers, so a grid of n voxels
 *             spans -0.5 .. n - 0.5.
 *   _ras_mm   NIfTI's world: x = -L, y = -P, z = S. Only inside core/formats/nifti.c.
 *   _rpi_mm   SERA's (RL, PA, IS): RL+ left, PA+ anterior, IS+ superior: L = RL, P = -PA, S = IS. Only inside
 *             core/formats (SERA's readers) and the phantom's track writer.
 *   _clip     after projection: x right, y up, z from -1 (near) to 1 (far), each in -1 .. 1.
 *   _px       pixels of a picture: x right, y DOWN, (0, 0) is the top left corner of the top left pixel. */
