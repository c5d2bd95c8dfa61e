// SPDX-License-Identifier: GPL-3.0-or-later
// Simulates the exposures of published measurements with the cells of core/bioheat alone, without
// mechanics. The set-ups are in setups.json. measured.py compares the results.
#pragma once

#include "bioheat/bioheat.h"
#include "bioheat/current.h"

// ---- a cross-section of jaws, and of a wire that lies on tissue
// A slice across the jaws, one cell thick. Only half of it is simulated, because it is symmetric.
// Tissue is thin between the jaws, and has its full thickness beside them. The upper jaw is a blade
// that rubs, or an electrode. The lower jaw is an electrode, or a pad that no heat enters. A value
// of 0 turns off what its name says.
#define SECTION_TABLE(X)                                                                           \
	X(cell_mm)                                                                                     \
	X(step_s)                                                                                      \
	X(inside_mm)  /* thickness of the tissue between the jaws */                                   \
	X(outside_mm) /* thickness of the tissue beside the jaws */                                    \
	X(beside_mm)  /* width of the tissue beside the jaws, on one side */                           \
	X(jaw_mm)     /* width of the jaws */                                                          \
	X(length_mm)  /* length of the jaws, over which power and metal are spread */                  \
	X(groove_mm)  /* width of each groove and ridge; a groove is in the middle */                  \
	X(start_c)    /* initial temperature of tissue, blood, metal and gas */                        \
	X(perfusion)  /* factor on the tissue's perfusion */                                           \
	X(boiling)    /* factor on the tissue's water; 0: nothing boils, and water stays */            \
	X(friction_w) /* heat of the upper blade */                                                    \
	X(voltage_v)  /* root mean square of the voltage; 0: the generator decides */                  \
	X(power_w)    /* power of the generator */                                                     \
	X(peak_v)                                                                                      \
	X(current_a)                                                                                   \
	X(crest)                                                                                       \
	X(far)       /* 1: the return electrode is far away, not the lower jaw */                      \
	X(upper_j_k) /* heat capacity of the upper jaw */                                              \
	X(upper_w_k) /* cooling of the upper jaw */                                                    \
	X(lower_j_k)                                                                                   \
	X(lower_w_k)                                                                                   \
	X(held_c) /* constant temperature of both jaws */                                              \
	X(on_s)                                                                                        \
	X(pause_s)                                                                                     \
	X(again_s)                                                                                     \
	X(pause_open)   /* 1: the jaws are open in the pause */                                        \
	X(hold_s)       /* time that the jaws stay closed after energy */                              \
	X(cool_s)       /* time that the jaws are open after hold_s */                                 \
	X(parted_water) /* share of water: energy ends when no cell between the jaws has more water */ \
	X(reaction_s)   /* time from the moment of parted_water to the end of energy */                \
	X(rise)         /* load at which energy ends, as a multiple of its least value */

#define MEASURED_NUMBER(name) double name;

typedef struct section_def {
	SECTION_TABLE(MEASURED_NUMBER)
} section_def;

#define SECTION_RESULTS(X)                                                                         \
	X(necrosis_mm)  /* width of dead tissue beside the jaws, after cooling down */                 \
	X(blade_peak_c) /* highest temperature of the upper jaw */                                     \
	X(tissue_peak_c)                                                                               \
	X(off_c)    /* the upper jaw's temperature when energy ended */                                \
	X(energy_s) /* time with energy on */                                                          \
	X(parted)   /* 1: no cell between the jaws has more than parted_water */                       \
	X(to_60_s)  /* time from the end of energy to a blade of 60 degC */                            \
	X(to_42_s)  /* time from the end of energy to a blade of 42 degC */                            \
	X(fusion)   /* damage of collagen while closed, of the coldest layer at the best place */      \
	X(first_ohm)                                                                                   \
	X(last_ohm)                                                                                    \
	X(came_in_j)                                                                                   \
	X(boiled_j)                                                                                    \
	X(ledger_gap) /* largest gap of the energy ledger, as a share of the supplied energy */

typedef struct section_found {
	SECTION_RESULTS(MEASURED_NUMBER)
} section_found;

// Runs a section. Ends the program if there is no memory.
section_found section_run(const section_def *def, cau_bioheat_material tissue);

// ---- an electrode that is drawn through a sheet, with sparks
#define CUT_TABLE(X)                                                                               \
	X(cell_mm)                                                                                     \
	X(step_s)                                                                                      \
	X(thick_mm)                                                                                    \
	X(wide_mm)   /* width of the sheet on one side; the other side is symmetric */                 \
	X(way_mm)    /* length of the electrode's motion */                                            \
	X(radius_mm) /* radius of the electrode, which passes through the sheet */                     \
	X(speed_mm_s)                                                                                  \
	X(start_c)                                                                                     \
	X(perfusion)                                                                                   \
	X(boiling)                                                                                     \
	X(power_w)                                                                                     \
	X(peak_v)                                                                                      \
	X(current_a)                                                                                   \
	X(crest)                                                                                       \
	X(upper_j_k)                                                                                   \
	X(upper_w_k)                                                                                   \
	X(parted_water) /* share of water at which a cell that sparks reach parts */                   \
	X(cool_s)

typedef struct cut_def {
	CUT_TABLE(MEASURED_NUMBER)
} cut_def;

#define CUT_RESULTS(X)                                                                             \
	X(necrosis_mm) /* width of dead tissue beside the cut, mean over the middle half of the way */ \
	X(kerf_mm)     /* mean width of the cut, both sides */                                         \
	X(cut_share)   /* share of the middle line that has parted */                                  \
	X(came_in_j)                                                                                   \
	X(boiled_j)                                                                                    \
	X(ledger_gap)

typedef struct cut_found {
	CUT_RESULTS(MEASURED_NUMBER)
} cut_found;

cut_found cut_run(const cut_def *def, cau_bioheat_material tissue);

// ---- a cooled needle in an organ
// A wedge of cells around the needle, above its middle. Cells farther from the axis contain more
// tissue.
#define NEEDLE_TABLE(X)                                                                            \
	X(cell_mm)                                                                                     \
	X(step_s)                                                                                      \
	X(radius_mm)                                                                                   \
	X(active_mm)                                                                                   \
	X(reach_mm) /* size of the tissue, from the axis and from the middle of the needle */          \
	X(water_c)  /* the needle's temperature while it is cooled */                                  \
	X(start_c)                                                                                     \
	X(perfusion)                                                                                   \
	X(boiling)                                                                                     \
	X(power_w)                                                                                     \
	X(peak_v)                                                                                      \
	X(current_a)                                                                                   \
	X(crest)                                                                                       \
	X(seconds)                                                                                     \
	X(cool_s)                                                                                      \
	X(from_mm) /* distance of a thermometer from the needle's surface, at the needle's middle */

typedef struct needle_def {
	NEEDLE_TABLE(MEASURED_NUMBER)
} needle_def;

#define NEEDLE_RESULTS(X)                                                                          \
	X(temperature_c) /* temperature at the thermometer when energy ended */                        \
	X(dead_cm3)      /* volume of dead tissue after cooling down */                                \
	X(peak_c)                                                                                      \
	X(first_ohm)                                                                                   \
	X(last_ohm)                                                                                    \
	X(last_w)                                                                                      \
	X(far_share) /* share of the final power that heats tissue beyond the cells */                 \
	X(came_in_j)                                                                                   \
	X(boiled_j)                                                                                    \
	X(ledger_gap)

typedef struct needle_found {
	NEEDLE_RESULTS(MEASURED_NUMBER)
} needle_found;

needle_found needle_run(const needle_def *def, cau_bioheat_material tissue);

// ---- shared
static const double measured_gone = 1; // least damage Omega of dead tissue

typedef struct measured_cells {
	cau_arena arena;
	cau_bioheat_material tissue;
	cau_bioheat bioheat;
	cau_current current;
} measured_cells;

// Opens `cells`, which must not move afterwards. Ends the program if there is no memory.
void measured_open(measured_cells *cells, double cell_mm, int32_t capacity, double start_c,
                   cau_bioheat_material tissue, double perfusion, double boiling);

void measured_close(measured_cells *cells);

// Adds a cell with the share `fill` of tissue. Returns its index.
int32_t measured_add(measured_cells *cells, int32_t x, int32_t y, int32_t z, double fill);

// True if the cell has at most the water of parted tissue. If nothing boils, true if the cell is at
// 100 degC.
bool measured_parts(const measured_cells *cells, int32_t cell, double parted_water);

// Performs a step, in halves if stability requires it. `blade_count` may be 0.
void measured_step(measured_cells *cells, cau_blade *blade, int32_t blade_count, double step_s);

// True if some cell is so warm that damage increases.
bool measured_warm(const measured_cells *cells);

// Returns the largest gap of the energy ledger as a share of the supplied energy. Stores the
// supplied energy in *came_in_j.
double measured_gap(const measured_cells *cells, double *came_in_j);

// Returns the depth of dead tissue from a border, in cells. `damage` has the cells from the border
// on. Between the last dead and the first living cell, the depth is where the logarithm of Omega is
// 0 by linear interpolation.
double measured_depth(const double *damage, int32_t count);
