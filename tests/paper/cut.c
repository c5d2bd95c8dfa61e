// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "measured.h"

// Constants with the names, values and meanings of core/session/electrosurgery.c: range of the
// current, least peak voltage and field of a spark, radius of its spot, and residual of the
// potential.
static const double reach_m = 3e-3, spark_v = 200, spark_v_m = 3e6, spot_m = 1e-4;
static const double residual_most = 1e-3;
// Length of the sheet before the start and beyond the end of the motion, mm.
static const double margin_mm = 2;
enum { ITERATIONS = 60, HALVES = 2 };

typedef struct cut_state {
	const cut_def *def;
	measured_cells cells;
	int32_t along, wide, thick, margin; // numbers of cells
	cau_blade blade;
	cut_found found;
} cut_state;

static int32_t cells_of(const cut_def *def, double mm)
{
	int32_t count = (int32_t)lround(mm / def->cell_mm);
	return count > 0 ? count : 1;
}

static int32_t find(const cut_state *cut, int32_t x, int32_t y, int32_t z)
{
	return cau_cells_find(&cut->cells.bioheat.cells, (int32_t[]){x, y, z});
}

static void open_cut(cut_state *cut, const cut_def *def, cau_bioheat_material tissue)
{
	*cut = (struct cut_state){.def = def};
	cut->margin = cells_of(def, margin_mm);
	cut->along = cells_of(def, def->way_mm) + 2 * cut->margin;
	cut->wide = cells_of(def, def->wide_mm);
	cut->thick = cells_of(def, def->thick_mm);
	tissue.sheet = true;
	measured_open(&cut->cells, def->cell_mm, cut->along * cut->wide * cut->thick, def->start_c,
	              tissue, def->perfusion, def->boiling);
	for (int32_t x = 0; x < cut->along; x++)
		for (int32_t y = 0; y < cut->wide; y++)
			for (int32_t z = 0; z < cut->thick; z++)
				measured_add(&cut->cells, x, y, z, 1);
	cut->blade = (cau_blade){.temperature_c = def->start_c,
	                         .heat_capacity_j_k = def->upper_j_k / HALVES,
	                         .cooling_w_k = def->upper_w_k / HALVES};
}

// Finds the cells that sparks reach, and among these cells those that the metal touches. All cells
// that an arc reaches share the arc's spot.
static void find_contacts(cut_state *cut, double at_m)
{
	cau_bioheat *bioheat = &cut->cells.bioheat;
	cau_current *current = &cut->cells.current;
	double side = bioheat->cells.side_m, spark_m = cut->def->peak_v / spark_v_m;
	double reach = fmax(cut->def->peak_v >= spark_v ? spark_m : 0, side / 2);
	bioheat->contact_count = current->electrode_count = 0;
	for (int32_t i = 0; i < bioheat->cells.count; i++) {
		const int32_t *place = bioheat->cells.place + 3 * (size_t)i;
		double distance = hypot((place[0] + 0.5) * side - at_m, (place[1] + 0.5) * side) -
		                  cut->def->radius_mm * 1e-3;
		if (bioheat->cells.severed[i] || distance > reach)
			continue;
		double over = side * side / fmax(distance, side / 2);
		current->electrode[current->electrode_count++] =
			(cau_electrode_cell){.cell = i, .over_length_m = over, .potential = 1};
		bioheat->contact[bioheat->contact_count++] = (cau_contact_cell){
			.blade = 0, .cell = i, .over_length_m = distance <= side / 2 ? over : 0};
	}
	for (int32_t k = 0; k < current->electrode_count && cut->def->peak_v >= spark_v; k++)
		current->electrode[k].over_length_m = 4 * spot_m / HALVES / current->electrode_count;
}

static void give_current(cut_state *cut)
{
	const cut_def *def = cut->def;
	cau_current *current = &cut->cells.current;
	if (!current->electrode_count)
		return;
	cau_current_solve(current, &cut->cells.bioheat, reach_m, true, residual_most, ITERATIONS);
	cau_generator generator = {.power_w = def->power_w,
	                           .peak_v = def->peak_v,
	                           .current_a = def->current_a,
	                           .crest_factor = def->crest};
	cau_output output = cau_generator_into(&generator, HALVES * fmax(current->conductance_s, 0));
	cau_current_heat(current, &cut->cells.bioheat, output.voltage_v);
}

static void vaporise(cut_state *cut)
{
	cau_bioheat *bioheat = &cut->cells.bioheat;
	for (int32_t k = 0; k < bioheat->contact_count && cut->def->peak_v >= spark_v; k++) {
		int32_t cell = bioheat->contact[k].cell;
		if (measured_parts(&cut->cells, cell, cut->def->parted_water) &&
		    !bioheat->cells.severed[cell])
			cau_bioheat_take_out(bioheat, cell);
	}
}

static void step(cut_state *cut, bool energy, double at_m, double step_s)
{
	cau_bioheat *bioheat = &cut->cells.bioheat;
	memset(bioheat->power_w, 0, (size_t)bioheat->cells.count * sizeof *bioheat->power_w);
	bioheat->contact_count = 0;
	if (energy) {
		find_contacts(cut, at_m);
		give_current(cut);
	}
	measured_step(&cut->cells, &cut->blade, 1, step_s);
	if (energy)
		vaporise(cut);
}

// Measures one line of cells outwards from the middle: the border of the cut, and the dead tissue
// beyond it.
static void measure_line(cut_state *cut, int32_t x, int32_t z, double *damage)
{
	const cau_bioheat *bioheat = &cut->cells.bioheat;
	int32_t border = 0, count = 0;
	while (border < cut->wide && bioheat->cells.severed[find(cut, x, border, z)])
		border++;
	for (int32_t y = border; y < cut->wide; y++)
		damage[count++] = bioheat->damage[find(cut, x, y, z)];
	cut->found.necrosis_mm += measured_depth(damage, count) * cut->def->cell_mm;
	cut->found.kerf_mm += 2 * border * cut->def->cell_mm;
	cut->found.cut_share += border > 0;
}

static void measure(cut_state *cut)
{
	int32_t way = cut->along - 2 * cut->margin, lines = 0;
	double *damage = calloc((size_t)cut->wide, sizeof *damage);
	if (!damage)
		exit(1);
	for (int32_t x = cut->margin + way / 4; x < cut->margin + way - way / 4; x++)
		for (int32_t z = 0; z < cut->thick; z++, lines++)
			measure_line(cut, x, z, damage);
	free(damage);
	cut->found.necrosis_mm /= lines;
	cut->found.kerf_mm /= lines;
	cut->found.cut_share /= lines;
}

cut_found cut_run(const cut_def *def, cau_bioheat_material tissue)
{
	cut_state cut;
	open_cut(&cut, def, tissue);
	double seconds = def->way_mm / def->speed_mm_s, at_s = 0, left = def->cool_s;
	while (at_s < seconds) {
		step(&cut, true, 1e-3 * (margin_mm + at_s * def->speed_mm_s), def->step_s);
		at_s += def->step_s;
	}
	while (left > 1e-9 && measured_warm(&cut.cells)) {
		step(&cut, false, 0, fmin(left, def->step_s));
		left -= def->step_s;
	}
	measure(&cut);
	cut.found.ledger_gap = measured_gap(&cut.cells, &cut.found.came_in_j);
	cut.found.came_in_j *= HALVES;
	cut.found.boiled_j = HALVES * cut.cells.bioheat.ledger.boiled_j;
	measured_close(&cut.cells);
	return cut.found;
}
