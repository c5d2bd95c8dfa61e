// SPDX-License-Identifier: GPL-3.0-or-later
// The factor's values in the panels of the sweeps: supernode by supernode, so that a downdate
// renews only those on the paths that it changed.
#include <math.h>
#include <string.h>

#include "solve/kernels.h"

cau_status cau_sweep_create_panels(const cau_sweep *sweep, cau_sweep_panels *panels,
                                   cau_error *error)
{
	size_t size = cau_real_bytes(sweep->single);
	size_t panel = (size_t)sweep->panel_entries * (size_t)sweep->kernels->stored_bytes;
	*panels = (cau_sweep_panels){0};
	if (!cau_pages_take(&panels->pages, 2 * panel + 2 * (size_t)sweep->padded_n * size))
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the packed factor");
	panels->forward = panels->pages.start;
	panels->backward = (char *)panels->forward + panel; // whole lanes, so aligned to them
	panels->d_inverse = (char *)panels->backward + panel;
	panels->scale = (char *)panels->d_inverse + (size_t)sweep->padded_n * size;
	return CAU_OK;
}

void cau_sweep_finish_panels(cau_sweep_panels *panels)
{
	cau_pages_give_back(&panels->pages);
	*panels = (cau_sweep_panels){0};
}

static cau_sweep_panels panels_of(const cau_sweep *sweep)
{
	return (cau_sweep_panels){sweep->pages, sweep->forward, sweep->backward, sweep->d_inverse,
	                          sweep->scale};
}

void cau_sweep_swap_panels(cau_sweep *sweep, cau_sweep_panels *panels)
{
	cau_sweep_panels old = panels_of(sweep);
	sweep->pages = panels->pages;
	sweep->forward = panels->forward;
	sweep->backward = panels->backward;
	sweep->d_inverse = panels->d_inverse;
	sweep->scale = panels->scale;
	*panels = old;
}

void cau_sweep_pack_panels(const cau_sweep *sweep, cau_sweep_panels *panels,
                           const cau_factor *factor)
{
	for (int32_t s = 0; s < sweep->supernode_count; ++s)
		sweep->kernels->pack(sweep, s, factor, panels);
}

double cau_sweep_pack(const cau_sweep *sweep, const cau_factor *factor, const uint8_t *touched)
{
	cau_sweep_panels panels = panels_of(sweep);
	double least = INFINITY;
	for (int32_t s = 0; s < sweep->supernode_count; ++s)
		if (!touched || touched[s])
			least = fmin(least, sweep->kernels->pack(sweep, s, factor, &panels));
	return least;
}

void cau_sweep_mark_path(const cau_sweep *sweep, int32_t column, uint8_t *touched)
{
	for (int32_t s = sweep->column_node[column]; s >= 0 && !touched[s];
	     s = sweep->supernode[s].parent)
		touched[s] = 1;
}
