// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/case.h"

#include <stdlib.h>
#include <string.h>

enum { MOST_ROWS = 1000000 };

// A file that is being read, and the error to fill.
typedef struct reader {
	FILE *file;
	cau_error *error;
} reader;

static cau_status bad(const reader *in, const char *section)
{
	return cau_fail(in->error, CAU_BAD_SYNTAX, section, "not as README.md describes it");
}

// Reads the next word, which must be `name`.
static cau_status read_name(const reader *in, const char *name)
{
	char word[64];
	if (fscanf(in->file, "%63s", word) != 1 || strcmp(word, name) != 0)
		return bad(in, name);
	return CAU_OK;
}

static cau_status read_doubles(const reader *in, const char *section, double *out, int count)
{
	for (int i = 0; i < count; ++i)
		if (fscanf(in->file, "%lf", &out[i]) != 1)
			return bad(in, section);
	return CAU_OK;
}

// Reads the word `name` and then `count` numbers.
static cau_status read_field(const reader *in, const char *name, double *out, int count)
{
	cau_status status = read_name(in, name);
	return status ? status : read_doubles(in, name, out, count);
}

static cau_status read_text(const reader *in, const char *name, char out[CAU_NAME_BYTES])
{
	cau_status status = read_name(in, name);
	if (status)
		return status;
	_Static_assert(CAU_NAME_BYTES == 49, "the width below");
	return fscanf(in->file, "%48s", out) == 1 ? CAU_OK : bad(in, name);
}

// Reads `name` and the number of lines of a section. If wanted, allocates `columns` integers and
// `reals` numbers for each line.
static cau_status open_section(const reader *in, const char *name, int32_t *rows, int columns,
                               int32_t **indices, int reals, double **numbers)
{
	cau_status status = read_name(in, name);
	if (status)
		return status;
	if (fscanf(in->file, "%d", rows) != 1 || *rows < 0 || *rows > MOST_ROWS)
		return bad(in, name);
	// + 1, because a section without lines is not a failed allocation
	size_t room = (size_t)*rows + 1;
	if (columns && !(*indices = calloc(room * (size_t)columns, sizeof **indices)))
		return cau_fail(in->error, CAU_NO_MEMORY, name, "%d rows", *rows);
	if (reals && !(*numbers = calloc(room * (size_t)reals, sizeof **numbers)))
		return cau_fail(in->error, CAU_NO_MEMORY, name, "%d rows", *rows);
	return CAU_OK;
}

// Reads a section. Each line has `columns` vertices and then `reals` numbers.
static cau_status read_section(const reader *in, const char *name, int32_t vertex_count,
                               int32_t *rows, int columns, int32_t **indices, int reals,
                               double **numbers)
{
	cau_status status = open_section(in, name, rows, columns, indices, reals, numbers);
	if (status)
		return status;
	for (int32_t row = 0; row < *rows; ++row) {
		for (int c = 0; c < columns; ++c) {
			int32_t *vertex = *indices + (ptrdiff_t)row * columns + c;
			if (fscanf(in->file, "%d", vertex) != 1)
				return bad(in, name);
			if (*vertex < 0 || *vertex >= vertex_count)
				return cau_fail(in->error, CAU_BAD_VALUE, name, "row %d: vertex %d", row, *vertex);
		}
		if (reals) {
			status = read_doubles(in, name, *numbers + (ptrdiff_t)row * reals, reals);
			if (status)
				return status;
		}
	}
	return CAU_OK;
}

static cau_status read_model(const reader *in, int *model)
{
	char word[CAU_NAME_BYTES];
	cau_status status = read_text(in, "model", word);
	if (status)
		return status;
	if (strcmp(word, "stvk") == 0)
		*model = CAU_MODEL_STVK;
	else if (strcmp(word, "neohookean") == 0)
		*model = CAU_MODEL_NEOHOOKEAN;
	else
		return cau_fail(in->error, CAU_BAD_VALUE, "model", "%s", word);
	return CAU_OK;
}

static cau_status read_head(const reader *in, cau_reference_case *out)
{
	double version, sphere[4];
	cau_status status = read_field(in, "cautery-reference", &version, 1);
	if (!status && !(version >= 1 && version <= 1))
		status = cau_fail(in->error, CAU_UNSUPPORTED, "cautery-reference", "version %g", version);
	if (!status)
		status = read_text(in, "name", out->name);
	if (!status)
		status = read_model(in, &out->model);
	struct {
		const char *name;
		double *value;
		int count;
	} fields[] = {
		{"young_modulus_pa", &out->young_modulus_pa, 1},
		{"poisson_ratio", &out->poisson_ratio, 1},
		{"density_kg_m3", &out->density_kg_m3, 1},
		{"gravity_m_s2", out->gravity_m_s2, 3},
		{"sphere_m", sphere, 4},
		{"residual", &out->residual, 1},
		{"measure", &out->measure, 1},
		{"measure_converged", &out->measure_converged, 1},
		{"reaction_n", out->reaction_n, 3},
		{"hold_n", out->hold_n, 3},
		{"contact_n", out->contact_n, 3},
	};
	for (size_t i = 0; !status && i < sizeof fields / sizeof *fields; ++i)
		status = read_field(in, fields[i].name, fields[i].value, fields[i].count);
	if (status)
		return status;
	memcpy(out->sphere_center_m, sphere, sizeof out->sphere_center_m);
	out->sphere_radius_m = sphere[3];
	return CAU_OK;
}

static cau_status read_body(const reader *in, cau_reference_case *out)
{
	int32_t moved = 0;
	cau_status status =
		read_section(in, "vertices", 0, &out->vertex_count, 0, NULL, 3, &out->position);
	int32_t n = out->vertex_count;
	if (!status)
		status = read_section(in, "tetrahedra", n, &out->tetrahedron_count, 4, &out->tetrahedron, 0,
		                      NULL);
	if (!status)
		status = read_section(in, "fixed", n, &out->fixed_count, 1, &out->fixed, 0, NULL);
	if (!status)
		status = read_section(in, "prescribed", n, &out->prescribed_count, 1, &out->prescribed, 3,
		                      &out->prescribed_move);
	if (!status)
		status = read_section(in, "contacts", n, &out->contact_count, 1, &out->contact, 1,
		                      &out->contact_force_n);
	if (!status)
		status = read_section(in, "displacements", 0, &moved, 0, NULL, 3, &out->displacement);
	if (!status && moved != n)
		status =
			cau_fail(in->error, CAU_BAD_VALUE, "displacements", "%d for %d vertices", moved, n);
	return status ? status : read_name(in, "end");
}

cau_status cau_reference_case_read(const char *path, cau_reference_case *reference,
                                   cau_error *error)
{
	memset(reference, 0, sizeof *reference);
	reader in = {fopen(path, "r"), error};
	if (!in.file)
		return cau_fail(error, CAU_IO, NULL, "cannot open %s", path);
	cau_status status = read_head(&in, reference);
	if (!status)
		status = read_body(&in, reference);
	fclose(in.file);
	return status;
}

int32_t cau_reference_case_top(const cau_reference_case *reference, int32_t *vertex)
{
	const double rounding_m = 1e-9;
	int32_t count = 0;
	for (int32_t v = 0; v < reference->vertex_count; v++)
		if (reference->position[3 * (size_t)v + 2] > -rounding_m)
			vertex[count++] = v;
	return count;
}

void cau_reference_case_finish(cau_reference_case *reference)
{
	free(reference->position);
	free(reference->tetrahedron);
	free(reference->fixed);
	free(reference->prescribed);
	free(reference->prescribed_move);
	free(reference->contact);
	free(reference->contact_force_n);
	free(reference->displacement);
	memset(reference, 0, sizeof *reference);
}
