// SPDX-License-Identifier: GPL-3.0-or-later
// Heat, water and damage of the cells, by Pennes' equation with water that boils off. Cells may
// touch a metal body (blade or jaw). README.md describes the model.
#pragma once

#include <stdbool.h>

#include "bioheat/cells.h"
#include "cautery/session.h"

enum { CAU_BLADES = 8 }; // most blades

#define CAU_BOILING_C 100.0
#define CAU_BODY_C 37.0

// Properties of one kind of living tissue. Sources: README.md.
typedef struct cau_bioheat_material {
	double conductivity_w_mk; // thermal conductivity
	double density_kg_m3;
	double specific_heat_j_kgk;
	double water;               // mass fraction of water
	double electric_s_m;        // electric conductivity at 37 degC, at the generator's frequency
	double perfusion_w_m3k;     // blood flow times its heat capacity
	double damage_log_rate;     // ln(A), A in 1/s: rate of damage (Arrhenius)
	double damage_energy_j_mol; // activation energy E_a of damage
	bool sheet;                 // current spreads in a plane, not in space
} cau_bioheat_material;

// A body of metal with one temperature.
typedef struct cau_blade {
	double temperature_c;
	double heat_capacity_j_k; // above 0
	double cooling_w_k;       // conductance to the surroundings
} cau_blade;

typedef struct cau_contact_cell { // contact of a blade with a cell
	int32_t blade, cell;
	// area of contact over the length from the contact to the middle of the cell
	double over_length_m;
} cau_contact_cell;

typedef struct cau_bioheat {
	cau_cells cells;
	int32_t material_count;
	const cau_bioheat_material *material;
	double ambient_c; // temperature of blood and of tissue that was not heated
	// Conductance per area to gas at ambient_c, through sides without a neighbour; 0 at first.
	double surface_w_m2k;
	double *temperature; // degC, (capacity)
	double *water;       // share of a cell's initial water that is left, (capacity)
	double *damage;      // damage integral Omega, no unit, (capacity)
	// Power from outside into each cell in the next step, (capacity); set by callers.
	double *power_w;
	int32_t contact_count;
	cau_contact_cell *contact; // (capacity)
	cau_energy_ledger ledger;
	double boiled_w; // power of boiling, mean of the last step, from the ledger's boiled_j
	bool cold;       // every cell is at ambient_c and no power is set
	// Scratch: (capacity) each; face_w_k is (capacity x 6).
	double *own_w_mk, *flow_w, *open_w_k, *face_w_k;
} cau_bioheat;

// Makes an empty set of cells. `material` is borrowed and has material_count entries, at most
// CAU_CELL_MATERIALS. Error: CAU_NO_MEMORY.
cau_status cau_bioheat_create(cau_bioheat *bioheat, double side_m, int32_t capacity,
                              const cau_bioheat_material *material, int32_t material_count,
                              double ambient_c, cau_arena *arena, cau_error *error);

// Adds a cell at ambient temperature, with all its water. Returns the same results as
// cau_cells_add.
int32_t cau_bioheat_add(cau_bioheat *bioheat, const int32_t place[3], uint8_t material, float fill);

// Removes a cell's heat, and severs the cell. Call this once for a cell.
void cau_bioheat_take_out(cau_bioheat *bioheat, int32_t cell);

// Advances by duration_s: conduction, perfusion, gas at the surface, the set power, and blades
// through `contact`. Water boils at CAU_BOILING_C. A cell takes no more of its set power than dries
// the cell; the ledger counts the power that was taken. The step is explicit, in as many equal
// parts as stability needs. If that is more than CAU_BIOHEAT_PARTS, the function changes nothing
// and returns false.
enum { CAU_BIOHEAT_PARTS = 512 };
bool cau_bioheat_step(cau_bioheat *bioheat, cau_blade *blade, int32_t blade_count,
                      double duration_s);

// These functions return the present properties of a cell: conductivity (W/(m K)), electric
// conductivity (S/m) and heat capacity (J/K).
double cau_bioheat_conductivity(const cau_bioheat *bioheat, int32_t cell);
double cau_bioheat_electric(const cau_bioheat *bioheat, int32_t cell);
double cau_bioheat_capacity(const cau_bioheat *bioheat, int32_t cell);

// Returns the rate at which water boils off, kg/s, mean of the last step.
double cau_bioheat_vapour(const cau_bioheat *bioheat);

// Returns the energy, J, that a cell takes up until it is dry at CAU_BOILING_C.
double cau_bioheat_until_dry(const cau_bioheat *bioheat, int32_t cell);

// Returns thermal and electric properties of `tissue` (CAU_LIVING_*). Sources: README.md. `sheet`
// is false: current spreads in space.
cau_bioheat_material cau_living_tissue(int tissue);
