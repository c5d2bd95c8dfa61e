// SPDX-License-Identifier: GPL-3.0-or-later
#include "measured.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

void measured_open(measured_cells *cells, double cell_mm, int32_t capacity, double start_c,
                   cau_bioheat_material tissue, double perfusion, double boiling)
{
	*cells = (measured_cells){.tissue = tissue};
	cells->tissue.perfusion_w_m3k *= perfusion;
	cells->tissue.water *= boiling;
	cau_bioheat *bioheat = &cells->bioheat;
	if (cau_bioheat_create(bioheat, cell_mm * 1e-3, capacity, &cells->tissue, 1, start_c,
	                       &cells->arena, NULL) ||
	    cau_current_create(&cells->current, bioheat, &cells->arena, NULL)) {
		fprintf(stderr, "no memory for %d cells\n", capacity);
		exit(1);
	}
}

void measured_close(measured_cells *cells)
{
	cau_arena_finish(&cells->arena);
}

int32_t measured_add(measured_cells *cells, int32_t x, int32_t y, int32_t z, double fill)
{
	int32_t place[] = {x, y, z}, cell = cau_bioheat_add(&cells->bioheat, place, 0, (float)fill);
	if (cell < 0) {
		fprintf(stderr, "too many cells\n");
		exit(1);
	}
	return cell;
}

// Heats tissue that does not boil: all power heats the cells, and the cells keep their water.
static void warm_without_boiling(cau_bioheat *bioheat, double step_s)
{
	for (int32_t i = 0; i < bioheat->cells.count; i++) {
		bioheat->temperature[i] += bioheat->power_w[i] * step_s / cau_bioheat_capacity(bioheat, i);
		bioheat->power_w[i] = 0;
	}
}

void measured_step(measured_cells *cells, cau_blade *blade, int32_t blade_count, double step_s)
{
	cau_bioheat *bioheat = &cells->bioheat;
	bool boils = cells->tissue.water > 0;
	if (!boils)
		warm_without_boiling(bioheat, step_s);
	if (!cau_bioheat_step(bioheat, blade, blade_count, step_s)) {
		measured_step(cells, blade, blade_count, step_s / 2);
		measured_step(cells, blade, blade_count, step_s / 2);
	}
	for (int32_t i = 0; i < bioheat->cells.count && !boils; i++)
		bioheat->water[i] = 1;
}

bool measured_parts(const measured_cells *cells, int32_t cell, double parted_water)
{
	return cells->tissue.water > 0 ? cells->bioheat.water[cell] <= parted_water
	                               : cells->bioheat.temperature[cell] >= CAU_BOILING_C;
}

bool measured_warm(const measured_cells *cells)
{
	// Temperature above which damage increases, degC, as in core/bioheat/bioheat.c.
	static const double damage_from_c = 43;
	for (int32_t i = 0; i < cells->bioheat.cells.count; i++)
		if (cells->bioheat.temperature[i] > damage_from_c)
			return true;
	return false;
}

double measured_gap(const measured_cells *cells, double *came_in_j)
{
	const cau_energy_ledger *ledger = &cells->bioheat.ledger;
	*came_in_j = ledger->delivered_j + ledger->blade_j;
	double found = ledger->stored_j + ledger->boiled_j + ledger->perfused_j + ledger->ambient_j +
	               ledger->shed_j;
	double size = fmax(fabs(ledger->delivered_j), fabs(ledger->blade_j));
	return size > 0 ? fabs(*came_in_j - found) / size : 0;
}

double measured_depth(const double *damage, int32_t count)
{
	int32_t dead = 0;
	while (dead < count && damage[dead] >= measured_gone)
		dead++;
	if (dead == 0 || dead == count)
		return dead;
	double last = log(damage[dead - 1]), next = log(fmax(damage[dead], 1e-9));
	return dead - 0.5 + last / (last - next);
}
