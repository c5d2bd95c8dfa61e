// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "measured.h"

enum { UPPER, LOWER, JAWS };
enum { ITERATIONS = 200 };
static const double reach_m = 5e-3; // range of the current around the electrodes, m
static const double residual_most = 1e-5;
static const double spark_v = 200;

// Rate of collagen's fusion, measured by the loss of birefringence (Maitland and Walsh 1997). The
// values are those of core/vessel/vessels.c: log of the rate, and activation energy.
static const double fusion_log_rate = 130, fusion_energy_j_mol = 89 * 4184.0;
static const double gas_j_molk = 8.314462618, zero_k = 273.15;

typedef struct section_state {
	const section_def *def;
	measured_cells cells;
	// numbers of cells: half of a jaw's width, tissue's thickness between and beside the jaws, and
	// the width of the tissue beside the jaws
	int32_t across, inside, outside, beside;
	int32_t below; // index of the lowest layer between the jaws
	double share;  // share of all power and metal that the half slice has
	cau_blade blade[JAWS];
	double *fusion; // (cells) damage of collagen
	double least_ohm;
	bool closed;
	section_found found;
} section_state;

static int32_t cells_of(const section_def *def, double mm)
{
	int32_t count = (int32_t)lround(mm / def->cell_mm);
	return count > 0 ? count : 1;
}

static int32_t find(const section_state *section, int32_t x, int32_t z)
{
	return cau_cells_find(&section->cells.bioheat.cells, (int32_t[]){x, 0, z});
}

static bool is_between(const section_state *section, int32_t cell)
{
	return section->cells.bioheat.cells.place[3 * (size_t)cell] < section->across;
}

static void open_section(section_state *section, const section_def *def,
                         cau_bioheat_material tissue)
{
	*section = (struct section_state){.def = def, .closed = true, .least_ohm = INFINITY};
	section->across = cells_of(def, def->jaw_mm / 2);
	section->inside = cells_of(def, def->inside_mm);
	section->outside = cells_of(def, def->outside_mm);
	section->beside = cells_of(def, def->beside_mm);
	// A wire lies on the tissue. Jaws have the same thickness of tissue above and below.
	section->below = def->far > 0 ? section->outside - section->inside
	                              : (section->outside - section->inside) / 2;
	section->share = def->cell_mm / def->length_mm / 2;
	tissue.sheet = true; // current spreads in the plane of the slice
	int32_t capacity = section->across * section->inside + section->beside * section->outside;
	measured_open(&section->cells, def->cell_mm, capacity, def->start_c, tissue, def->perfusion,
	              def->boiling);
	for (int32_t x = 0; x < section->across; x++)
		for (int32_t z = 0; z < section->inside; z++)
			measured_add(&section->cells, x, 0, section->below + z, 1);
	for (int32_t x = 0; x < section->beside; x++)
		for (int32_t z = 0; z < section->outside; z++)
			measured_add(&section->cells, section->across + x, 0, z, 1);
	const double capacity_j_k[] = {def->upper_j_k, def->lower_j_k},
				 cooling_w_k[] = {def->upper_w_k, def->lower_w_k};
	for (int jaw = 0; jaw < JAWS; jaw++)
		section->blade[jaw] =
			(cau_blade){.temperature_c = def->held_c > 0 ? def->held_c : def->start_c,
		                .heat_capacity_j_k = fmax(capacity_j_k[jaw], 1e-12) * section->share,
		                .cooling_w_k = cooling_w_k[jaw] * section->share};
	section->fusion = cau_arena_array(&section->cells.arena, (size_t)capacity, sizeof(double));
	if (!section->fusion)
		exit(1);
}

// ---- contact and power

static bool is_groove(const section_state *section, int32_t x)
{
	double at_mm = (x + 0.5) * section->def->cell_mm, groove = section->def->groove_mm;
	return groove > 0 && (int)floor(at_mm / groove + 0.5) % 2 == 0;
}

static void touch(section_state *section, int32_t x, int32_t z, int jaw)
{
	cau_bioheat *bioheat = &section->cells.bioheat;
	cau_current *current = &section->cells.current;
	int32_t cell = find(section, x, z);
	// Area of a cell's side over half the length of a cell, m.
	double over = 2 * bioheat->cells.side_m;
	bioheat->contact[bioheat->contact_count++] =
		(cau_contact_cell){.blade = jaw, .cell = cell, .over_length_m = over};
	current->electrode[current->electrode_count++] = (cau_electrode_cell){
		.cell = cell, .over_length_m = over, .potential = jaw == UPPER ? 1 : 0};
}

static void find_contacts(section_state *section)
{
	section->cells.bioheat.contact_count = section->cells.current.electrode_count = 0;
	if (!section->closed)
		return;
	for (int32_t x = 0; x < section->across; x++) {
		if (is_groove(section, x))
			continue;
		touch(section, x, section->below + section->inside - 1, UPPER);
		if (section->def->lower_j_k > 0)
			touch(section, x, section->below, LOWER);
	}
}

static void give_current(section_state *section)
{
	const section_def *def = section->def;
	cau_current *current = &section->cells.current;
	cau_current_solve(current, &section->cells.bioheat, reach_m, def->far > 0, residual_most,
	                  ITERATIONS);
	double conductance = fmax(current->conductance_s, 0) / section->share;
	cau_generator generator = {.power_w = def->power_w,
	                           .peak_v = fmin(def->peak_v, def->far > 0 ? INFINITY : spark_v),
	                           .current_a = def->current_a,
	                           .crest_factor = def->crest};
	double voltage =
		def->voltage_v > 0 ? def->voltage_v : cau_generator_into(&generator, conductance).voltage_v;
	cau_current_heat(current, &section->cells.bioheat, voltage);
	double ohm = conductance > 0 ? 1 / conductance : INFINITY;
	if (!(section->found.first_ohm > 0))
		section->found.first_ohm = ohm;
	section->found.last_ohm = ohm;
	section->least_ohm = fmin(section->least_ohm, ohm);
}

// ---- time

static void fuse(section_state *section, double step_s)
{
	const cau_bioheat *bioheat = &section->cells.bioheat;
	for (int32_t i = 0; i < bioheat->cells.count; i++)
		section->fusion[i] +=
			step_s * exp(fusion_log_rate -
		                 fusion_energy_j_mol / (gas_j_molk * (bioheat->temperature[i] + zero_k)));
}

static void step(section_state *section, bool energy, double step_s)
{
	const section_def *def = section->def;
	cau_bioheat *bioheat = &section->cells.bioheat;
	memset(bioheat->power_w, 0, (size_t)bioheat->cells.count * sizeof *bioheat->power_w);
	find_contacts(section);
	if (energy && def->friction_w > 0)
		section->blade[UPPER].temperature_c +=
			def->friction_w * section->share * step_s / section->blade[UPPER].heat_capacity_j_k;
	else if (energy && (def->power_w > 0 || def->voltage_v > 0))
		give_current(section);
	for (int jaw = 0; jaw < JAWS && def->held_c > 0; jaw++)
		section->blade[jaw].temperature_c = def->held_c;
	section->found.blade_peak_c =
		fmax(section->found.blade_peak_c, section->blade[UPPER].temperature_c);
	measured_step(&section->cells, section->blade, JAWS, step_s);
	for (int32_t i = 0; i < bioheat->cells.count; i++)
		section->found.tissue_peak_c = fmax(section->found.tissue_peak_c, bioheat->temperature[i]);
	if (section->closed)
		fuse(section, step_s);
}

static bool has_parted(const section_state *section)
{
	for (int32_t i = 0; i < section->cells.bioheat.cells.count; i++)
		if (is_between(section, i) &&
		    !measured_parts(&section->cells, i, section->def->parted_water))
			return false;
	return true;
}

// Turns energy on for `seconds`, or until a rule ends it.
static void energize(section_state *section, double seconds)
{
	const section_def *def = section->def;
	double left = seconds;
	bool ends = false;
	while (left > 1e-9) {
		double part = fmin(left, def->step_s);
		step(section, true, part);
		left -= part;
		section->found.energy_s += part;
		if (def->rise > 0 && section->found.last_ohm >= def->rise * section->least_ohm)
			break;
		if (def->parted_water > 0 && !ends && has_parted(section)) {
			ends = true;
			left = fmin(left, def->reaction_s);
		}
	}
	section->found.off_c = section->blade[UPPER].temperature_c;
}

static void wait(section_state *section, double seconds)
{
	double left = seconds;
	while (left > 1e-9) {
		step(section, false, fmin(left, section->def->step_s));
		left -= section->def->step_s;
	}
}

// Cools until no more tissue dies.
static void cool(section_state *section)
{
	double left = section->def->cool_s;
	section->closed = false;
	while (left > 1e-9 && measured_warm(&section->cells)) {
		step(section, false, fmin(left, section->def->step_s));
		left -= section->def->step_s;
	}
}

// Returns the time until the blade has cooled to to_c. The blade is in gas, so its temperature
// above that of the gas falls with exp(-cooling t / capacity).
static double seconds_to(const section_state *section, double to_c)
{
	const cau_blade *blade = &section->blade[UPPER];
	double gas_c = section->def->start_c, now_c = blade->temperature_c;
	if (now_c <= to_c)
		return 0;
	if (to_c <= gas_c || blade->cooling_w_k <= 0)
		return INFINITY;
	return log((now_c - gas_c) / (to_c - gas_c)) * blade->heat_capacity_j_k / blade->cooling_w_k;
}

static double deepest_mm(const section_state *section)
{
	double deepest = 0, *damage = calloc((size_t)section->beside, sizeof *damage);
	if (!damage)
		exit(1);
	for (int32_t z = 0; z < section->outside; z++) {
		for (int32_t x = 0; x < section->beside; x++)
			damage[x] = section->cells.bioheat.damage[find(section, section->across + x, z)];
		deepest = fmax(deepest, measured_depth(damage, section->beside));
	}
	free(damage);
	return deepest * section->def->cell_mm;
}

// Returns the fusion of the seal: the fusion of the coldest part of the wall, at the best place
// along the jaws (core/vessel/vessels.c).
static double best_fusion(const section_state *section)
{
	double best = 0;
	for (int32_t x = 0; x < section->across; x++) {
		double coldest = INFINITY;
		for (int32_t z = 0; z < section->inside; z++)
			coldest = fmin(coldest, section->fusion[find(section, x, section->below + z)]);
		best = fmax(best, coldest);
	}
	return best;
}

section_found section_run(const section_def *def, cau_bioheat_material tissue)
{
	section_state section;
	open_section(&section, def, tissue);
	section_found *found = &section.found;
	energize(&section, def->on_s);
	if (def->again_s > 0) {
		section.closed = !(def->pause_open > 0);
		wait(&section, def->pause_s);
		section.closed = true;
		energize(&section, def->again_s);
	}
	wait(&section, def->hold_s);
	found->parted = has_parted(&section);
	found->fusion = best_fusion(&section);
	found->to_60_s = def->hold_s + seconds_to(&section, 60);
	found->to_42_s = def->hold_s + seconds_to(&section, 42);
	cool(&section);
	found->necrosis_mm = deepest_mm(&section);
	found->ledger_gap = measured_gap(&section.cells, &found->came_in_j);
	found->came_in_j /= section.share;
	found->boiled_j = section.cells.bioheat.ledger.boiled_j / section.share;
	measured_close(&section.cells);
	return *found;
}
