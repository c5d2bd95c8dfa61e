// SPDX-License-Identifier: GPL-3.0-or-later
// What a load on a row of contact moves: S W^T, by the columns' places.
#include <string.h>

#include "cautery/assert.h"
#include "solve/contact.h"

void cau_contact_find_answer(cau_contact_set *set, int32_t row)
{
	const cau_contact_row *of = &set->row[row];
	if (of->answer < 0 || of->answer == CAU_MAX_POINT_ROWS)
		return;
	double *answer = set->answer + (size_t)of->answer * CAU_MAX_COLUMNS;
	memset(answer, 0, (size_t)set->column_count * sizeof *answer);
	for (int32_t k = 0; k < of->corner_count; k++) {
		if (of->column[k] < 0 || of->weight[k] == 0)
			continue;
		const double *s = set->inverse + (size_t)of->column[k] * CAU_MAX_COLUMNS;
		for (int32_t c = 0; c < set->column_count; c++)
			answer[c] += of->weight[k] * s[c];
	}
}

const double *cau_contact_answer(const cau_contact_set *set, const cau_contact_row *row)
{
	if (row->answer < 0)
		return set->inverse + (size_t)row->column[0] * CAU_MAX_COLUMNS;
	return set->answer + (size_t)row->answer * CAU_MAX_COLUMNS;
}

void cau_contact_move(cau_contact_set *set, const cau_contact_row *row, cau_vec3 by)
{
	const double *answer = cau_contact_answer(set, row);
	double *x = set->step, *y = x + CAU_MAX_COLUMNS, *z = y + CAU_MAX_COLUMNS;
	for (int32_t c = 0; c < set->column_count; c++) {
		x[c] += answer[c] * by.x;
		y[c] += answer[c] * by.y;
		z[c] += answer[c] * by.z;
	}
}
