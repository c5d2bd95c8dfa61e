// SPDX-License-Identifier: GPL-3.0-or-later
// Compiled several times: CAU_SINGLE is the precision, CAU_TABLE the name of the table it makes,
// CAU_ISA the instruction set's name.
#include "solve/kernels.h"

#include <string.h>

#include "constraint/fat_kernel.h"
#include "constraint/link_kernel.h"
#include "constraint/plasticity_kernel.h"
#include "constraint/sheet_kernel.h"
#include "solve/sweep_kernel.h"

typedef real vertex_reals __attribute__((vector_size(4 * sizeof(real)), may_alias));

static void local(const cau_elements *elements, const cau_local_work *work,
                  const void *displacement, int diagonal)
{
	memset((vertex_reals *)elements->gradient + work->first_record, 0,
	       (size_t)work->record_count * sizeof(vertex_reals));
	double *energy = &elements->energy[work->number];
	switch (work->kind) {
	case CAU_WORK_SHEET:
		*energy = sheet_kernel(elements, &elements->sheet.group[work->group], work->first,
		                       work->last, displacement, diagonal);
		break;
	case CAU_WORK_FAT:
		*energy = fat_kernel(elements, &elements->fat.group[work->group], work->first, work->last,
		                     displacement, diagonal);
		break;
	case CAU_WORK_LINK:
		*energy = link_kernel(elements, work->first, work->last, displacement, diagonal);
		break;
	default:
		*energy = hinge_kernel(elements, work->first, work->last, displacement, diagonal);
		break;
	}
}

static int32_t settle(const cau_elements *elements, const cau_local_work *work,
                      const void *displacement)
{
	if (work->kind != CAU_WORK_FAT)
		return 0;
	return settle_kernel(elements, &elements->fat.group[work->group], work->first, work->last,
	                     displacement);
}

static void sum(const cau_elements *elements, const cau_incidence *incidence, int32_t first,
                int32_t last, void *gradient)
{
	const vertex_reals *record = elements->gradient;
	vertex_reals *out = gradient;
	for (int32_t v = first; v < last; ++v) {
		vertex_reals total = {0};
		for (int32_t k = incidence->first[v]; k < incidence->first[v + 1]; ++k)
			total += record[incidence->record[k]];
		out[v] = total;
	}
}

static void forward(const cau_sweep *sweep, int32_t supernode, void *const rhs[3],
                    void *const above[3], void *work)
{
	real *const b[3] = {rhs[0], rhs[1], rhs[2]};
	real *const up[3] = {above[0], above[1], above[2]};
	sweep_forward_node(sweep, &sweep->supernode[supernode], b, up, work);
}

static void backward(const cau_sweep *sweep, int32_t supernode, void *const rhs[3], void *work)
{
	real *const b[3] = {rhs[0], rhs[1], rhs[2]};
	sweep_backward_node(sweep, &sweep->supernode[supernode], b, work);
}

static double dot(const void *a, const void *b, int64_t n)
{
	const real *x = a, *y = b;
	double total = 0;
	int64_t i = 0;
	enum { STRIP = 64 * LANES }; // short enough that float sums stay accurate
	for (; i + STRIP <= n; i += STRIP) {
		vreal strip = v_set(0);
		for (int k = 0; k < STRIP; k += LANES)
			strip += v_load(x + i, k) * v_load(y + i, k);
		total += v_sum(strip);
	}
	for (; i < n; ++i)
		total += (double)x[i] * (double)y[i];
	return total;
}

static void add_scaled(void *y, double s, const void *x, int64_t n)
{
	real *out = y;
	const real *in = x;
	real scale = (real)s;
	for (int64_t i = 0; i < n; ++i)
		out[i] += scale * in[i];
}

static void spread(void *increment, const void *column, const double force[3], int32_t first,
                   int32_t last)
{
	vertex_reals *out = increment;
	const real *weight = column;
	vertex_reals f = {(real)force[0], (real)force[1], (real)force[2], 0};
	for (int32_t v = first; v < last; ++v)
		out[v] += weight[v] * f;
}

extern const cau_kernels CAU_TABLE;
const cau_kernels CAU_TABLE = {
	.instruction_set = CAU_ISA,
	.single = CAU_SINGLE,
	.local = local,
	.settle = settle,
	.sum = sum,
	.forward = forward,
	.backward = backward,
	.dot = dot,
	.spread = spread,
	.add_scaled = add_scaled,
};
