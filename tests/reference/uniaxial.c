// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/uniaxial.h"

#include <string.h>

#include "cautery/scene.h"

static cau_status read_row(FILE *file, int32_t index, cau_reference_uniaxial *row, cau_error *error)
{
	char model[CAU_NAME_BYTES];
	int found = fscanf(file, "%48s %lf %lf %lf %lf %lf", model, &row->young_modulus_pa,
	                   &row->poisson_ratio, &row->stretch, &row->lateral_stretch, &row->stress_pa);
	if (found == 6 && strcmp(model, "stvk") == 0)
		row->model = CAU_MODEL_STVK;
	else if (found == 6 && strcmp(model, "neohookean") == 0)
		row->model = CAU_MODEL_NEOHOOKEAN;
	else
		return cau_fail(error, CAU_BAD_SYNTAX, "rows", "row %d", index);
	return CAU_OK;
}

cau_status cau_reference_uniaxial_read(const char *path, int32_t capacity,
                                       cau_reference_uniaxial *rows, int32_t *row_count,
                                       cau_error *error)
{
	int version = 0, count = 0;
	*row_count = 0;
	FILE *file = fopen(path, "r");
	if (!file)
		return cau_fail(error, CAU_IO, NULL, "cannot open %s", path);
	cau_status status = CAU_OK;
	if (fscanf(file, "cautery-uniaxial %d rows %d", &version, &count) != 2 || version != 1)
		status = cau_fail(error, CAU_BAD_SYNTAX, "cautery-uniaxial", "not as README.md has it");
	else if (count > capacity)
		status = cau_fail(error, CAU_LIMIT, "rows", "%d of at most %d", count, capacity);
	for (int32_t i = 0; !status && i < count; ++i) {
		status = read_row(file, i, &rows[i], error);
		if (!status)
			*row_count = i + 1;
	}
	fclose(file);
	return status;
}
