// SPDX-License-Identifier: GPL-3.0-or-later
#include "bioheat/bioheat.h"

#include <math.h>

#include "cautery/assert.h"

// ---- properties of kinds of tissue
// The damage constants of liver, which are used for all tissues: ln of 7.39e39 1/s, and E_a.
// README.md says what that means for fat.
#define DAMAGE .damage_log_rate = 91.8, .damage_energy_j_mol = 2.577e5

#define MUSCLE                                                                                     \
	{                                                                                              \
		.conductivity_w_mk = 0.49, .density_kg_m3 = 1090, .specific_heat_j_kgk = 3421,             \
		.water = 0.75, .electric_s_m = 0.4, .perfusion_w_m3k = 12960, DAMAGE                       \
	}

static const cau_bioheat_material tissues[CAU_LIVING_COUNT] = {
	[CAU_LIVING_CONNECTIVE] = MUSCLE,
	[CAU_LIVING_FAT] = {.conductivity_w_mk = 0.21,
                        .density_kg_m3 = 911,
                        .specific_heat_j_kgk = 2348,
                        .water = 0.2,
                        .electric_s_m = 0.03,
                        .perfusion_w_m3k = 8065,
                        DAMAGE},
	[CAU_LIVING_LIVER] = {.conductivity_w_mk = 0.52,
                          .density_kg_m3 = 1079,
                          .specific_heat_j_kgk = 3540,
                          .water = 0.7,
                          .electric_s_m = 0.15,
                          .perfusion_w_m3k = 40000,
                          DAMAGE},
	[CAU_LIVING_MUSCLE] = MUSCLE,
};

cau_bioheat_material cau_living_tissue(int tissue)
{
	CAU_ASSERT_INDEX(tissue, CAU_LIVING_COUNT);
	return tissues[tissue];
}

// ---- the heat of cells
static const double water_heat_j_kgk = 4186; // specific heat of water
static const double boiling_j_kg = 2.257e6;  // enthalpy of evaporation at 100 degC
static const double dry_w_mk = 0.2;          // conductivity of dried tissue
// Rise of the electric conductivity per kelvin, as a share of the conductivity at 37 degC; of
// bovine liver.
static const double electric_per_k = 0.0182;
static const double gas_j_molk = 8.314462618;
static const double zero_k = 273.15;
// Temperature, degC, above which damage is computed. Below it, the constants that are known for
// burns do not hold.
static const double damage_from_c = 43;
static const double stable_share = 0.9; // share of the longest stable step that is used
// Largest distance from ambient, K, of tissue that is set to ambient. Such tissue is not damaged,
// and the difference is visible in no picture.
static const double cold_k = 0.5;

cau_status cau_bioheat_create(cau_bioheat *bioheat, double side_m, int32_t capacity,
                              const cau_bioheat_material *material, int32_t material_count,
                              double ambient_c, cau_arena *arena, cau_error *error)
{
	CAU_ASSERT(material_count > 0 && material_count <= CAU_CELL_MATERIALS, "%d materials",
	           material_count);
	*bioheat = (cau_bioheat){.material = material,
	                         .material_count = material_count,
	                         .ambient_c = ambient_c,
	                         .cold = true};
	cau_status status = cau_cells_create(&bioheat->cells, side_m, capacity, arena, error);
	if (status)
		return status;
	size_t most = (size_t)capacity;
	double **fields[] = {&bioheat->temperature, &bioheat->water,    &bioheat->damage,
	                     &bioheat->power_w,     &bioheat->own_w_mk, &bioheat->flow_w,
	                     &bioheat->open_w_k};
	bool missing = false;
	for (size_t i = 0; i < sizeof fields / sizeof *fields; i++) {
		*fields[i] = cau_arena_array(arena, most, sizeof(double));
		missing |= !*fields[i];
	}
	bioheat->face_w_k = cau_arena_array(arena, CAU_CELL_SIDES * most, sizeof(double));
	bioheat->contact = cau_arena_array(arena, most, sizeof *bioheat->contact);
	if (missing || !bioheat->face_w_k || !bioheat->contact)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for %d cells of tissue", capacity);
	return CAU_OK;
}

int32_t cau_bioheat_add(cau_bioheat *bioheat, const int32_t place[3], uint8_t material, float fill)
{
	CAU_ASSERT_INDEX(material, bioheat->material_count);
	int32_t cell = cau_cells_add(&bioheat->cells, place, material, fill);
	if (cell < 0)
		return -1;
	bioheat->temperature[cell] = bioheat->ambient_c;
	bioheat->water[cell] = 1;
	bioheat->damage[cell] = bioheat->power_w[cell] = 0;
	return cell;
}

// ---- present properties of a cell

static const cau_bioheat_material *material_of(const cau_bioheat *bioheat, int32_t cell)
{
	CAU_ASSERT_INDEX(cell, bioheat->cells.count);
	return &bioheat->material[bioheat->cells.material[cell]];
}

static double mass_of(const cau_bioheat *bioheat, int32_t cell)
{
	return material_of(bioheat, cell)->density_kg_m3 * cau_cells_volume(&bioheat->cells, cell);
}

double cau_bioheat_conductivity(const cau_bioheat *bioheat, int32_t cell)
{
	double wet = material_of(bioheat, cell)->conductivity_w_mk;
	return dry_w_mk + (wet - dry_w_mk) * bioheat->water[cell];
}

// Returns the electric conductivity, S/m. It rises until the cell boils. It also falls with the
// square of the water that is left (Archie's law).
double cau_bioheat_electric(const cau_bioheat *bioheat, int32_t cell)
{
	double warm = fmin(bioheat->temperature[cell], CAU_BOILING_C) - CAU_BODY_C;
	double wet = bioheat->water[cell];
	return material_of(bioheat, cell)->electric_s_m * (1 + electric_per_k * warm) * wet * wet;
}

// Returns the heat capacity of a cell, J/K. The dry mass keeps its heat capacity. The water that
// boils off takes its heat capacity along.
double cau_bioheat_capacity(const cau_bioheat *bioheat, int32_t cell)
{
	const cau_bioheat_material *material = material_of(bioheat, cell);
	double lost = material->water * water_heat_j_kgk * (1 - bioheat->water[cell]);
	return mass_of(bioheat, cell) * (material->specific_heat_j_kgk - lost);
}

static double water_mass(const cau_bioheat *bioheat, int32_t cell)
{
	return mass_of(bioheat, cell) * material_of(bioheat, cell)->water;
}

double cau_bioheat_until_dry(const cau_bioheat *bioheat, int32_t cell)
{
	double kelvin = CAU_BOILING_C - bioheat->temperature[cell];
	return fmax(kelvin, 0) * cau_bioheat_capacity(bioheat, cell) +
	       bioheat->water[cell] * water_mass(bioheat, cell) * boiling_j_kg;
}

void cau_bioheat_take_out(cau_bioheat *bioheat, int32_t cell)
{
	CAU_ASSERT(!bioheat->cells.severed[cell], "cell %d is taken out twice", cell);
	double content =
		cau_bioheat_capacity(bioheat, cell) * (bioheat->temperature[cell] - bioheat->ambient_c);
	bioheat->ledger.stored_j -= content;
	bioheat->ledger.shed_j += content;
	bioheat->temperature[cell] = bioheat->ambient_c;
	bioheat->power_w[cell] = 0;
	cau_cells_sever(&bioheat->cells, cell);
}

// Returns the rate of vapour, kg/s. Water that boils off takes its own heat along, besides the
// enthalpy of evaporation.
double cau_bioheat_vapour(const cau_bioheat *bioheat)
{
	double warmth = water_heat_j_kgk * (CAU_BOILING_C - bioheat->ambient_c);
	return bioheat->boiled_w / (boiling_j_kg + warmth);
}

// ---- one step

// Computes the conductances of all faces from the harmonic mean of both cells' conductivities. Each
// face is computed once, from the cell on its lower side. A face without a neighbour has 0.
static void find_faces(cau_bioheat *bioheat)
{
	const cau_cells *cells = &bioheat->cells;
	double *own = bioheat->own_w_mk;
	for (int32_t i = 0; i < cells->count; i++)
		own[i] = cau_bioheat_conductivity(bioheat, i);
	for (int32_t i = 0; i < cells->count; i++)
		for (int side = 0; side < CAU_CELL_SIDES; side++) {
			int64_t face = cau_cell_side(i, side);
			int32_t other = cells->neighbour[face];
			if (other < 0) {
				bioheat->face_w_k[face] = 0;
			} else if (side % 2) {
				double mean = 2 * own[i] * own[other] / (own[i] + own[other]);
				bioheat->face_w_k[face] = bioheat->face_w_k[cau_cell_side(other, side ^ 1)] =
					cau_cells_face(cells, i, side) * mean;
			}
		}
}

// Sets open_w_k: the conductance of a cell to gas, through its sides without a neighbour. Returns
// the sum of open_w_k and the conductances of all faces, W/K.
static double open_and_faces(cau_bioheat *bioheat, int32_t cell)
{
	const cau_cells *cells = &bioheat->cells;
	double sum = 0;
	int open = 0;
	for (int64_t face = cau_cell_side(cell, 0); face < cau_cell_side(cell + 1, 0); face++) {
		open += cells->neighbour[face] < 0;
		sum += bioheat->face_w_k[face];
	}
	bioheat->open_w_k[cell] = open * bioheat->surface_w_m2k * cells->side_m * cells->side_m;
	return sum + bioheat->open_w_k[cell];
}

static double contact_w_k(const cau_bioheat *bioheat, const cau_contact_cell *contact)
{
	return cau_bioheat_conductivity(bioheat, contact->cell) * contact->over_length_m;
}

// Returns the longest part of a step in which no blade passes the mean temperature of its
// surroundings: the cells that it touches, and the shaft that cools it.
static double longest_of_blades_s(const cau_bioheat *bioheat, const cau_blade *blade,
                                  int32_t blade_count)
{
	double longest = INFINITY, flow_w_k[CAU_BLADES] = {0};
	for (int32_t k = 0; k < bioheat->contact_count; k++) {
		CAU_ASSERT_INDEX(bioheat->contact[k].blade, blade_count);
		flow_w_k[bioheat->contact[k].blade] += contact_w_k(bioheat, &bioheat->contact[k]);
	}
	for (int32_t b = 0; b < blade_count; b++) {
		double out_w_k = flow_w_k[b] + blade[b].cooling_w_k;
		if (out_w_k > 0)
			longest = fmin(longest, blade[b].heat_capacity_j_k / out_w_k);
	}
	return longest;
}

// Returns the longest part of a step that is stable. Explicit steps are stable while no cell and no
// blade passes the mean temperature of its neighbours in one part.
static double longest_part_s(cau_bioheat *bioheat, const cau_blade *blade, int32_t blade_count)
{
	double longest = longest_of_blades_s(bioheat, blade, blade_count);
	find_faces(bioheat);
	for (int32_t i = 0; i < bioheat->cells.count; i++)
		bioheat->flow_w[i] = open_and_faces(bioheat, i);
	for (int32_t k = 0; k < bioheat->contact_count; k++)
		bioheat->flow_w[bioheat->contact[k].cell] += contact_w_k(bioheat, &bioheat->contact[k]);
	for (int32_t i = 0; i < bioheat->cells.count; i++)
		if (bioheat->flow_w[i] > 0)
			longest = fmin(longest, cau_bioheat_capacity(bioheat, i) / bioheat->flow_w[i]);
	return stable_share * longest;
}

// Boils water of a cell at 100 degC that has taken up `over_j` more energy. If the cell gets dry,
// the rest of the energy warms the cell.
static void boil(cau_bioheat *bioheat, int32_t cell, double over_j)
{
	double *wet = &bioheat->water[cell], mass = water_mass(bioheat, cell);
	double share = fmin(over_j / (mass * boiling_j_kg), *wet);
	double sensible = share * mass * water_heat_j_kgk * (CAU_BOILING_C - bioheat->ambient_c);
	*wet = share == *wet ? 0 : *wet - share;
	bioheat->ledger.boiled_j += share * mass * boiling_j_kg + sensible;
	double left = fmax(over_j - share * mass * boiling_j_kg, 0);
	bioheat->temperature[cell] = CAU_BOILING_C + left / cau_bioheat_capacity(bioheat, cell);
	bioheat->ledger.stored_j += left - sensible;
}

// Adds energy to a cell, J. The energy first warms the cell to 100 degC, then boils its water, then
// warms the dry cell. A cell that cools keeps its remaining water.
static void take_energy(cau_bioheat *bioheat, int32_t cell, double energy_j)
{
	double capacity = cau_bioheat_capacity(bioheat, cell), *kelvin = &bioheat->temperature[cell];
	double warmed = *kelvin + energy_j / capacity;
	if (warmed <= CAU_BOILING_C || bioheat->water[cell] <= 0) {
		*kelvin = warmed;
		bioheat->ledger.stored_j += energy_j;
		return;
	}
	bioheat->ledger.stored_j += capacity * (CAU_BOILING_C - *kelvin);
	boil(bioheat, cell, (warmed - CAU_BOILING_C) * capacity);
}

static void find_flows(cau_bioheat *bioheat)
{
	const int32_t *neighbour = bioheat->cells.neighbour;
	for (int32_t i = 0; i < bioheat->cells.count; i++) {
		double flow = 0;
		for (int64_t face = cau_cell_side(i, 0); face < cau_cell_side(i + 1, 0); face++)
			if (neighbour[face] >= 0)
				flow += bioheat->face_w_k[face] *
				        (bioheat->temperature[neighbour[face]] - bioheat->temperature[i]);
		bioheat->flow_w[i] = flow;
	}
}

static double perfusion_w(const cau_bioheat *bioheat, int32_t cell)
{
	if (bioheat->damage[cell] >= 1) // the cell's blood vessels have closed
		return 0;
	return material_of(bioheat, cell)->perfusion_w_m3k * cau_cells_volume(&bioheat->cells, cell) *
	       (bioheat->temperature[cell] - bioheat->ambient_c);
}

static void touch_blades(cau_bioheat *bioheat, cau_blade *blade, int32_t blade_count, double part_s)
{
	double given_w[CAU_BLADES] = {0};
	for (int32_t k = 0; k < bioheat->contact_count; k++) {
		const cau_contact_cell *contact = &bioheat->contact[k];
		double flow = contact_w_k(bioheat, contact) *
		              (blade[contact->blade].temperature_c - bioheat->temperature[contact->cell]);
		bioheat->flow_w[contact->cell] += flow;
		given_w[contact->blade] += flow;
	}
	for (int32_t b = 0; b < blade_count; b++) {
		double cooled = blade[b].cooling_w_k * (blade[b].temperature_c - bioheat->ambient_c);
		bioheat->ledger.blade_j += given_w[b] * part_s;
		blade[b].temperature_c -= (given_w[b] + cooled) * part_s / blade[b].heat_capacity_j_k;
	}
}

static void damage_cell(cau_bioheat *bioheat, int32_t cell, double part_s)
{
	double kelvin = bioheat->temperature[cell];
	const cau_bioheat_material *material = material_of(bioheat, cell);
	if (kelvin > damage_from_c)
		bioheat->damage[cell] +=
			part_s * exp(material->damage_log_rate -
		                 material->damage_energy_j_mol / (gas_j_molk * (kelvin + zero_k)));
}

// Returns the energy, J, that a cell takes from its set power in one part. A dry cell takes no
// more.
static double power_into(cau_bioheat *bioheat, int32_t cell, double part_s)
{
	double energy = bioheat->power_w[cell] * part_s;
	double taken = fmin(energy, cau_bioheat_until_dry(bioheat, cell));
	bioheat->ledger.delivered_j += taken;
	return taken;
}

static void step_part(cau_bioheat *bioheat, cau_blade *blade, int32_t blade_count, double part_s)
{
	find_flows(bioheat);
	touch_blades(bioheat, blade, blade_count, part_s);
	for (int32_t i = 0; i < bioheat->cells.count; i++) {
		if (bioheat->cells.severed[i])
			continue;
		double perfused = perfusion_w(bioheat, i) * part_s;
		double lost =
			bioheat->open_w_k[i] * (bioheat->temperature[i] - bioheat->ambient_c) * part_s;
		double power = bioheat->power_w[i] > 0 ? power_into(bioheat, i, part_s) : 0;
		bioheat->ledger.perfused_j += perfused;
		bioheat->ledger.ambient_j += lost;
		take_energy(bioheat, i, bioheat->flow_w[i] * part_s - perfused - lost + power);
		damage_cell(bioheat, i, part_s);
	}
}

static bool is_cold(const cau_bioheat *bioheat, const cau_blade *blade)
{
	for (int32_t k = 0; k < bioheat->contact_count; k++)
		if (fabs(blade[bioheat->contact[k].blade].temperature_c - bioheat->ambient_c) > cold_k)
			return false;
	for (int32_t i = 0; i < bioheat->cells.count; i++)
		if (fabs(bioheat->temperature[i] - bioheat->ambient_c) > cold_k || bioheat->power_w[i] > 0)
			return false;
	return true;
}

// Sets all cells to ambient. Perfusion would take minutes for the last half degree.
static void forget_rest(cau_bioheat *bioheat)
{
	for (int32_t i = 0; i < bioheat->cells.count; i++)
		bioheat->temperature[i] = bioheat->ambient_c;
	bioheat->ledger.perfused_j += bioheat->ledger.stored_j;
	bioheat->ledger.stored_j = 0;
}

bool cau_bioheat_step(cau_bioheat *bioheat, cau_blade *blade, int32_t blade_count,
                      double duration_s)
{
	CAU_ASSERT(duration_s > 0, "a step of %g s", duration_s);
	CAU_ASSERT(blade_count >= 0 && blade_count <= CAU_BLADES, "%d blades", blade_count);
	double parts = fmax(ceil(duration_s / longest_part_s(bioheat, blade, blade_count)), 1);
	if (!(parts <= CAU_BIOHEAT_PARTS))
		return false;
	double boiled_before_j = bioheat->ledger.boiled_j;
	for (int part = 0; part < (int)parts; part++)
		step_part(bioheat, blade, blade_count, duration_s / parts);
	bioheat->boiled_w = (bioheat->ledger.boiled_j - boiled_before_j) / duration_s;
	bioheat->cold = is_cold(bioheat, blade);
	if (bioheat->cold)
		forget_rest(bioheat);
	return true;
}
