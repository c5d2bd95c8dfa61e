// SPDX-License-Identifier: GPL-3.0-or-later
// Packs the factor's values into the panels of the sweeps, supernode by supernode. So after a
// downdate, only the supernodes on the changed paths are packed again.
#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "solve/kernels.h"

size_t cau_sweep_entry_bytes(const cau_sweep *sweep)
{
	return sweep->narrow ? sizeof(int16_t) : sweep->kernels->vectors->real_bytes;
}

cau_status cau_sweep_create_panels(const cau_sweep *sweep, cau_sweep_panels *panels,
                                   cau_error *error)
{
	CAU_ASSERT(sweep->panel_entries > 0 && sweep->padded_n >= sweep->n,
	           "%lld entries, %d of %d columns", (long long)sweep->panel_entries, sweep->padded_n,
	           sweep->n);
	size_t size = sweep->kernels->vectors->real_bytes;
	size_t panel = (size_t)sweep->panel_entries * cau_sweep_entry_bytes(sweep);
	*panels = (cau_sweep_panels){0};
	if (!cau_pages_take(&panels->pages, panel + 2 * (size_t)sweep->padded_n * size))
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the packed factor");
	panels->panel = panels->pages.start;
	// the panel has whole vectors of lanes, so d_inverse is aligned
	char *d_inverse = (char *)panels->panel + panel;
	panels->d_inverse = (cau_reals *)d_inverse;
	panels->scale = (cau_reals *)(d_inverse + (size_t)sweep->padded_n * size);
	return CAU_OK;
}

void cau_sweep_finish_panels(cau_sweep_panels *panels)
{
	cau_pages_give_back(&panels->pages);
	*panels = (cau_sweep_panels){0};
}

static cau_sweep_panels panels_of(const cau_sweep *sweep)
{
	return (cau_sweep_panels){sweep->pages, sweep->panel, sweep->d_inverse, sweep->scale};
}

void cau_sweep_swap_panels(cau_sweep *sweep, cau_sweep_panels *panels)
{
	cau_sweep_panels old = panels_of(sweep);
	sweep->pages = panels->pages;
	sweep->panel = panels->panel;
	sweep->d_inverse = panels->d_inverse;
	sweep->scale = panels->scale;
	*panels = old;
}

void cau_sweep_pack_panels(const cau_sweep *sweep, cau_sweep_panels *panels,
                           const cau_factor *factor)
{
	CAU_ASSERT(panels->panel != NULL, "no panels for %d supernodes", sweep->supernode_count);
	CAU_ASSERT(cau_factor_size(factor) == sweep->n, "a factor of %d rows for panels of %d",
	           cau_factor_size(factor), sweep->n);
	for (int32_t s = 0; s < sweep->supernode_count; s++)
		sweep->kernels->pack(sweep, s, factor, panels, 0);
}

void cau_sweep_pack(const cau_sweep *sweep, const cau_factor *factor)
{
	cau_sweep_panels panels = panels_of(sweep);
	cau_sweep_pack_panels(sweep, &panels, factor);
}

typedef struct packing {
	const cau_sweep *sweep;
	const cau_factor *factor;
	uint8_t *touched; // 1 + index of the part that packs the supernode; 0: not packed
	double least[CAU_PACK_PARTS];
} packing;

// Assigns each supernode to the part that has less work so far. The largest supernodes are last in
// order, and are assigned first.
static void share_out(const packing *work)
{
	int64_t load[CAU_PACK_PARTS] = {0};
	for (int32_t s = work->sweep->supernode_count - 1; s >= 0; s--) {
		const cau_supernode *node = &work->sweep->supernode[s];
		int part = 0;
		if (!work->touched[s])
			continue;
		for (int k = 1; k < CAU_PACK_PARTS; k++)
			part = load[k] < load[part] ? k : part;
		load[part] += (int64_t)node->columns * node->columns * (node->columns + node->rows);
		work->touched[s] = (uint8_t)(1 + part);
	}
}

static void pack_part(void *context, int32_t part)
{
	CAU_ASSERT_INDEX(part, CAU_PACK_PARTS);
	packing *work = context;
	cau_sweep_panels panels = panels_of(work->sweep);
	work->least[part] = INFINITY;
	for (int32_t s = 0; s < work->sweep->supernode_count; s++)
		if (work->touched[s] == 1 + part)
			work->least[part] =
				fmin(work->least[part],
			         work->sweep->kernels->pack(work->sweep, s, work->factor, &panels, part));
}

double cau_sweep_pack_touched(const cau_sweep *sweep, const cau_factor *factor, uint8_t *touched,
                              cau_pool *pool)
{
	CAU_ASSERT(cau_factor_size(factor) == sweep->n, "a factor of %d rows for panels of %d",
	           cau_factor_size(factor), sweep->n);
	packing work = {.sweep = sweep, .factor = factor, .touched = touched};
	share_out(&work);
	cau_pool_run(pool, CAU_PACK_PARTS, pack_part, &work);
	memset(touched, 0, (size_t)sweep->supernode_count);
	double least = INFINITY;
	for (int part = 0; part < CAU_PACK_PARTS; part++)
		least = fmin(least, work.least[part]);
	return least;
}

void cau_sweep_mark_path(const cau_sweep *sweep, int32_t column, uint8_t *touched)
{
	CAU_ASSERT_INDEX(column, sweep->n);
	for (int32_t s = sweep->column_node[column]; s >= 0 && !touched[s];
	     s = sweep->supernode[s].parent)
		touched[s] = 1;
}
