// SPDX-License-Identifier: GPL-3.0-or-later
// The kernels of one precision and instruction set. Compiled several times with these macros:
// CAU_SINGLE is the precision, CAU_TABLE the name of the table, CAU_ISA the instruction set's name,
// CAU_VECTORS the table of vectors.c.
#include "solve/kernels.h"

#include <string.h>

#include "cautery/assert.h"
#include "constraint/fat_kernel.h"
#include "constraint/link_kernel.h"
#include "constraint/plasticity_kernel.h"
#include "constraint/sheet_kernel.h"
#include "constraint/viscous_kernel.h"
#include "solve/newton_kernel.h"
#include "solve/pack_kernel.h"
#include "solve/spread_kernel.h"
#include "solve/sweep_kernel.h"

// Copies the displacements (m) of the share's records to `taken`.
INLINE void take_displacement(const cau_elements *elements, const cau_local_work *work,
                              const cau_reals *displacement, real *taken)
{
	CAU_ASSERT(work->record_count <= CAU_SHARE_RECORDS, "%d records in a share of at most %d",
	           work->record_count, CAU_SHARE_RECORDS);
	CAU_ASSERT(work->first_record + work->record_count <= elements->record_count,
	           "records %d + %d of %d", work->first_record, work->record_count,
	           elements->record_count);
	const int32_t *vertex = elements->record_vertex + work->first_record;
	for (int32_t r = 0; r < work->record_count; r++)
		((vertex_reals *)taken)[r] =
			*(const vertex_reals *)((const real *)displacement + vertex[r]);
}

// Adds viscosity's forces and energy, after the laws have written records and energy.
INLINE void add_viscosity(const cau_elements *elements, const cau_local_work *work,
                          const real *taken, real *records)
{
	double rate_per_s = elements->rate_per_s, viscous_j = 0;
	if (work->kind == CAU_ELEMENT_TRIANGLE && elements->sheet.group[work->group].viscosity_s > 0)
		viscous_j = sheet_viscous_kernel(&elements->sheet, &elements->sheet.group[work->group],
		                                 rate_per_s, work->first, work->last, taken, records);
	if (work->kind == CAU_ELEMENT_TETRAHEDRON && elements->fat.group[work->group].viscous_mu > 0)
		viscous_j = fat_viscous_kernel(&elements->fat, &elements->fat.group[work->group],
		                               rate_per_s, work->first, work->last, taken, records);
	elements->viscous_j[work->number] = viscous_j;
	elements->energy[work->number] += viscous_j;
}

static void local(const cau_elements *elements, const cau_local_work *work,
                  const cau_reals *displacement, bool diagonal)
{
	CAU_ASSERT_INDEX(work->kind, CAU_ELEMENT_KINDS);
	CAU_ASSERT(work->last - work->first <= CAU_SHARE, "a share of slots %d to %d", work->first,
	           work->last);
	real taken[4 * CAU_SHARE_RECORDS] __attribute__((aligned(64)));
	real *records = (real *)elements->gradient + 4 * (int64_t)work->first_record;
	double *energy = &elements->energy[work->number];
	take_displacement(elements, work, displacement, taken);
	memset(records, 0, (size_t)work->record_count * sizeof(vertex_reals));
	switch (work->kind) {
	case CAU_ELEMENT_TRIANGLE:
		*energy =
			sheet_kernel(elements, &elements->sheet.group[work->group], work->first, work->last,
		                 taken, records, diagonal, &elements->slack[work->number]);
		break;
	case CAU_ELEMENT_TETRAHEDRON:
		*energy = fat_kernel(elements, &elements->fat.group[work->group], work->first, work->last,
		                     taken, records, diagonal);
		break;
	case CAU_ELEMENT_LINK:
		*energy = link_kernel(elements, work->first, work->last, taken, records, diagonal);
		break;
	default:
		*energy = hinge_kernel(elements, work->first, work->last, taken, records, diagonal);
		break;
	}
	if (elements->rate_per_s > 0)
		add_viscosity(elements, work, taken, records);
}

static void take_strain(const cau_elements *elements, const cau_local_work *work,
                        const cau_reals *displacement, double share)
{
	real taken[4 * CAU_SHARE_RECORDS] __attribute__((aligned(64)));
	CAU_ASSERT(elements->viscous_j, "a share %d without viscosity", work->number);
	take_displacement(elements, work, displacement, taken);
	if (work->kind == CAU_ELEMENT_TRIANGLE)
		sheet_strain_kernel(&elements->sheet, work->first, work->last, taken, share);
	else if (work->kind == CAU_ELEMENT_TETRAHEDRON)
		fat_strain_kernel(&elements->fat, work->first, work->last, taken, share);
}

static int32_t settle(const cau_elements *elements, const cau_local_work *work,
                      const cau_reals *displacement)
{
	if (work->kind != CAU_ELEMENT_TETRAHEDRON)
		return 0;
	real taken[4 * CAU_SHARE_RECORDS] __attribute__((aligned(64)));
	take_displacement(elements, work, displacement, taken);
	return settle_kernel(elements, &elements->fat.group[work->group], work->first, work->last,
	                     taken);
}

static void sum(const cau_elements *elements, const cau_incidence *incidence, int32_t first,
                int32_t last, cau_reals *gradient)
{
	CAU_ASSERT(first <= last, "vertices %d to %d", first, last);
	enum { NEAR = (1 << 20) / sizeof(vertex_reals) };
	const vertex_reals *record = elements->gradient;
	int far = elements->record_count > NEAR; // the records are larger than the inner caches
	vertex_reals *out = (vertex_reals *)gradient;
	for (int32_t v = first; v < last; v++) {
		vertex_reals total = {0};
		for (int32_t k = incidence->first[v]; k < incidence->first[v + 1]; k++) {
			CAU_ASSERT_INDEX(incidence->record[k], elements->record_count);
			if (far)
				__builtin_prefetch(record + incidence->record[k + CAU_RECORDS_AHEAD]);
			total += record[incidence->record[k]];
		}
		out[v] = total;
	}
}

static void forward(const cau_sweep *sweep, int32_t supernode)
{
	CAU_ASSERT_INDEX(supernode, sweep->supernode_count);
	const cau_supernode *node = &sweep->supernode[supernode];
	if (CAU_SINGLE && sweep->narrow)
		sweep_forward_node(sweep, node, 1);
	else
		sweep_forward_node(sweep, node, 0);
}

static void backward(const cau_sweep *sweep, int32_t supernode)
{
	CAU_ASSERT_INDEX(supernode, sweep->supernode_count);
	const cau_supernode *node = &sweep->supernode[supernode];
	if (CAU_SINGLE && sweep->narrow)
		sweep_backward_node(sweep, node, 1);
	else
		sweep_backward_node(sweep, node, 0);
}

static double pack(const cau_sweep *sweep, int32_t supernode, const cau_factor *factor,
                   const cau_sweep_panels *panels, int32_t part)
{
	CAU_ASSERT_INDEX(supernode, sweep->supernode_count);
	CAU_ASSERT_INDEX(part, CAU_PACK_PARTS);
	CAU_ASSERT(sweep->supernode[supernode].columns <= CAU_NODE_COLUMNS, "a supernode of %d columns",
	           sweep->supernode[supernode].columns);
	return pack_node(sweep, &sweep->supernode[supernode], factor, panels, part);
}

enum { STRIP = 64 * LANES }; // reals in one sum; few enough that sums in float stay accurate

static double dot(const cau_reals *a, const cau_reals *b, int64_t first, int64_t n)
{
	const real *x = (const real *)a + first, *y = (const real *)b + first;
	double total = 0;
	int64_t i = 0;
	for (; i + STRIP <= n; i += STRIP) {
		vreal strip = v_set(0);
		for (int k = 0; k < STRIP; k += LANES)
			strip += v_load(x + i, k) * v_load(y + i, k);
		total += v_sum(strip);
	}
	for (; i < n; i++)
		total += (double)x[i] * (double)y[i];
	return total;
}

static void add_scaled(cau_reals *y, double s, const cau_reals *x, int64_t n)
{
	real *out = (real *)y;
	const real *in = (const real *)x;
	real scale = (real)s;
	for (int64_t i = 0; i < n; i++)
		out[i] += scale * in[i];
}

// Adds one strip to add_column's products. Subtracts df_j . (g - g_last) from dot[j] and df_j . g
// from dot[window + j].
INLINE void add_strip(const cau_history *history, int64_t at, int32_t n, double *dot)
{
	real dg[STRIP] __attribute__((aligned(64))) = {0};
	const real *f = (const real *)history->increment + at,
			   *g = (const real *)history->gradient + at,
			   *f_last = (const real *)history->last_increment + at,
			   *g_last = (const real *)history->last_gradient + at,
			   *step = (const real *)history->step + at;
	real *df = (real *)history->df[history->newest] + at,
		 *h = (real *)history->h[history->newest] + at;
	for (int32_t k = 0; k < n; k++) {
		real d = f[k] - f_last[k];
		df[k] = d;
		h[k] = step[k] + d;
		dg[k] = g[k] - g_last[k];
	}
	for (int32_t j = 0; j < history->count; j++) {
		const real *column = (const real *)history->df[j] + at;
		vreal with_dg = v_set(0), with_g = v_set(0);
		int32_t k = 0;
		for (; k + LANES <= n; k += LANES) {
			vreal c = v_load(column, k);
			with_dg += c * v_load(dg, k);
			with_g += c * v_load(g, k);
		}
		double tail_dg = 0, tail_g = 0;
		for (; k < n; k++) {
			tail_dg += (double)column[k] * (double)dg[k];
			tail_g += (double)column[k] * (double)g[k];
		}
		dot[j] -= v_sum(with_dg) + tail_dg;
		dot[CAU_ANDERSON_WINDOW + j] -= v_sum(with_g) + tail_g;
	}
}

static void add_column(const cau_history *history, int64_t first, int64_t n, double *dot)
{
	CAU_ASSERT_INDEX(history->newest, history->count);
	for (int32_t j = 0; j < 2 * CAU_ANDERSON_WINDOW; j++)
		dot[j] = 0;
	for (int64_t at = 0; at < n; at += STRIP)
		add_strip(history, first + at, (int32_t)(n - at < STRIP ? n - at : STRIP), dot);
}

static void combine(const cau_history *history, int64_t first, int64_t n, const double *weight)
{
	CAU_ASSERT(history->count >= 0 && history->count <= CAU_ANDERSON_WINDOW, "%d columns",
	           history->count);
	const real *f = (const real *)history->increment + first;
	real *step = (real *)history->step + first;
	memcpy(step, f, (size_t)n * sizeof *step);
	for (int32_t j = 0; j < history->count; j++) {
		const real *h = (const real *)history->h[j] + first;
		real w = (real)weight[j];
		for (int64_t k = 0; k < n; k++)
			step[k] -= w * h[k];
	}
}

extern const cau_vectors CAU_VECTORS;
extern const cau_kernels CAU_TABLE;
const cau_kernels CAU_TABLE = {
	.instruction_set = CAU_ISA,
	.single = CAU_SINGLE,
	.vectors = &CAU_VECTORS,
	.local = local,
	.take_strain = take_strain,
	.settle = settle,
	.sum = sum,
	.forward = forward,
	.backward = backward,
	.pack = pack,
	.newton_factor = newton_factor,
	.newton_solve = newton_solve,
	.dot = dot,
	.spread = spread,
	.add_scaled = add_scaled,
	.add_column = add_column,
	.combine = combine,
};
