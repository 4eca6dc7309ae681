#pragma once
/* The smallest RT Dose, for tests that need many of them. */
#include "tests/unit/made_dicom.h"

/* 2 x 2 x 1 voxels of 2 mm at the patient's origin, 0.5 to 2 Gy. Each number gives another object that refers to
 * another treatment plan, so that no two of them become components of one dose. The caller calls made_finish. */
void made_dose(struct made_dicom *made, int number);
/* Makes the dose in two parts; elements behind the grid's scaling (3004,000e) go between them. */
void made_dose_begin(struct made_dicom *made, int number);
void made_dose_end(struct made_dicom *made, int number);
