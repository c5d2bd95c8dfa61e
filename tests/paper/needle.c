// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "measured.h"

static const double pi = 3.14159265358979323846;
static const double reach_m = 0.025; // range of the current around the electrode, m
static const double residual_most = 1e-4;
enum { ITERATIONS = 200, HALVES = 2 };

typedef struct needle_state {
	const needle_def *def;
	measured_cells cells;
	int32_t out, up, active; // numbers of cells
	double angle;            // angle of the wedge
	double share;            // share of the whole organ that the wedge represents
	cau_blade blade;
	needle_found found;
} needle_state;

static double radius_of(const needle_state *needle, int32_t x)
{
	return 1e-3 * (needle->def->radius_mm + (x + 0.5) * needle->def->cell_mm);
}

static int32_t find(const needle_state *needle, int32_t x, int32_t z)
{
	return cau_cells_find(&needle->cells.bioheat.cells, (int32_t[]){x, 0, z});
}

// Corrects the area of the faces between the rings of the wedge. The true area is that of a ring
// half way between the middles of two rings, but cells.h uses the area of the ring with less
// tissue. The pull-back is a factor on the conduction: its mean over both cells is 1 + h / (2 r),
// with an error of order h^4.
static void widen(needle_state *needle, int32_t cell, int32_t x)
{
	double ratio = needle->cells.bioheat.cells.side_m / radius_of(needle, x);
	needle->cells.bioheat.cells.pull[3 * (size_t)cell] = (float)(1 + ratio / 2 + ratio * ratio / 4);
}

static void open_needle(needle_state *needle, const needle_def *def, cau_bioheat_material tissue)
{
	*needle = (struct needle_state){.def = def};
	needle->out = (int32_t)lround((def->reach_mm - def->radius_mm) / def->cell_mm);
	needle->up = (int32_t)lround((def->reach_mm + def->active_mm / 2) / def->cell_mm);
	needle->active = (int32_t)lround(def->active_mm / 2 / def->cell_mm);
	double most_m = radius_of(needle, needle->out - 1);
	needle->angle = def->cell_mm * 1e-3 / most_m;
	needle->share = needle->angle / (2 * pi) / HALVES;
	measured_open(&needle->cells, def->cell_mm, needle->out * needle->up, def->start_c, tissue,
	              def->perfusion, def->boiling);
	for (int32_t x = 0; x < needle->out; x++)
		for (int32_t z = 0; z < needle->up; z++)
			widen(needle, measured_add(&needle->cells, x, 0, z, radius_of(needle, x) / most_m), x);
	// The capacity is so large that the water keeps its temperature.
	needle->blade = (cau_blade){.temperature_c = def->water_c, .heat_capacity_j_k = 1e9};
	cau_bioheat *bioheat = &needle->cells.bioheat;
	cau_current *current = &needle->cells.current;
	double over =
		needle->angle * bioheat->cells.side_m / log(radius_of(needle, 0) / (1e-3 * def->radius_mm));
	for (int32_t z = 0; z < needle->active; z++) {
		int32_t cell = find(needle, 0, z);
		bioheat->contact[bioheat->contact_count++] =
			(cau_contact_cell){.blade = 0, .cell = cell, .over_length_m = over};
		current->electrode[current->electrode_count++] =
			(cau_electrode_cell){.cell = cell, .over_length_m = over, .potential = 1};
	}
}

static void give_current(needle_state *needle)
{
	const needle_def *def = needle->def;
	cau_current *current = &needle->cells.current;
	cau_current_solve(current, &needle->cells.bioheat, reach_m, true, residual_most, ITERATIONS);
	double conductance = fmax(current->conductance_s, 0) / needle->share;
	cau_generator generator = {.power_w = def->power_w,
	                           .peak_v = def->peak_v,
	                           .current_a = def->current_a,
	                           .crest_factor = def->crest};
	cau_output output = cau_generator_into(&generator, conductance);
	cau_current_heat(current, &needle->cells.bioheat, output.voltage_v);
	needle->found.last_ohm = conductance > 0 ? 1 / conductance : INFINITY;
	if (!(needle->found.first_ohm > 0))
		needle->found.first_ohm = needle->found.last_ohm;
	needle->found.last_w = output.power_w;
	needle->found.far_share = current->far_w / fmax(current->conductance_s, 1e-30);
}

static void step(needle_state *needle, bool energy, double step_s)
{
	cau_bioheat *bioheat = &needle->cells.bioheat;
	memset(bioheat->power_w, 0, (size_t)bioheat->cells.count * sizeof *bioheat->power_w);
	if (energy)
		give_current(needle);
	measured_step(&needle->cells, &needle->blade, 1, step_s);
	for (int32_t i = 0; i < bioheat->cells.count; i++)
		needle->found.peak_c = fmax(needle->found.peak_c, bioheat->temperature[i]);
}

// Returns the thermometer's temperature by linear interpolation between the middles of two cells.
static double at_thermometer(const needle_state *needle)
{
	double at = needle->def->from_mm / needle->def->cell_mm - 0.5;
	int32_t x = (int32_t)floor(at);
	const double *kelvin = needle->cells.bioheat.temperature;
	return kelvin[find(needle, x, 0)] +
	       (at - x) * (kelvin[find(needle, x + 1, 0)] - kelvin[find(needle, x, 0)]);
}

static double dead_cm3(const needle_state *needle)
{
	const cau_bioheat *bioheat = &needle->cells.bioheat;
	double volume_m3 = 0;
	for (int32_t i = 0; i < bioheat->cells.count; i++)
		if (bioheat->damage[i] >= measured_gone)
			volume_m3 += cau_cells_volume(&bioheat->cells, i);
	return 1e6 * volume_m3 / needle->share;
}

static void steps(needle_state *needle, bool powered, double seconds)
{
	double left = seconds;
	while (left > 1e-9) {
		step(needle, powered, fmin(left, needle->def->step_s));
		left -= needle->def->step_s;
	}
}

needle_found needle_run(const needle_def *def, cau_bioheat_material tissue)
{
	needle_state needle;
	open_needle(&needle, def, tissue);
	steps(&needle, true, def->seconds);
	needle.found.temperature_c = at_thermometer(&needle);
	steps(&needle, false, def->cool_s);
	needle.found.dead_cm3 = dead_cm3(&needle);
	needle.found.ledger_gap = measured_gap(&needle.cells, &needle.found.came_in_j);
	needle.found.came_in_j /= needle.share;
	needle.found.boiled_j = needle.cells.bioheat.ledger.boiled_j / needle.share;
	measured_close(&needle.cells);
	return needle.found;
}
