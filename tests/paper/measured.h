// SPDX-License-Identifier: GPL-3.0-or-later
// Exposures as published measurements have them, on the cells of core/bioheat alone: no mechanics.
// The set-ups are in setups.json, and their comparison is measured.py.
#pragma once

#include "bioheat/bioheat.h"
#include "bioheat/current.h"
#include "bioheat/generator.h"

// ---- a cross-section of jaws, and of a wire that lies on tissue
// A slice of cells, one thick, across the jaws: half of it, for it is symmetric. Between the jaws
// tissue is thin, and beside them as thick as it is. The upper jaw is a blade that rubs, or an
// electrode. The lower one is an electrode, or a pad that no heat enters. A value of 0 turns off
// what its name says.
#define SECTION_TABLE(X)                                                                           \
	X(cell_mm)                                                                                     \
	X(step_s)                                                                                      \
	X(inside_mm)  /* thickness of the tissue between the jaws */                                   \
	X(outside_mm) /* and beside them */                                                            \
	X(beside_mm)  /* width of the tissue beside, to one side */                                    \
	X(jaw_mm)     /* width of the jaws */                                                          \
	X(length_mm)  /* of the jaws: power and metal are shared by so much */                         \
	X(groove_mm)  /* width of each groove and ridge; the middle is a groove's */                   \
	X(start_c)    /* of tissue, blood, metal and gas */                                            \
	X(perfusion)  /* times the tissue's */                                                         \
	X(boiling)    /* times the tissue's water; 0: nothing boils, and water stays */                \
	X(friction_w) /* heat of the upper blade */                                                    \
	X(voltage_v)  /* given, root mean square; else the generator's */                              \
	X(power_w)    /* of the generator */                                                           \
	X(peak_v)                                                                                      \
	X(current_a)                                                                                   \
	X(crest)                                                                                       \
	X(far)       /* 1: the return electrode is far away, not the lower jaw */                      \
	X(upper_j_k) /* heat capacity */                                                               \
	X(upper_w_k) /* and cooling */                                                                 \
	X(lower_j_k)                                                                                   \
	X(lower_w_k)                                                                                   \
	X(held_c) /* both jaws have it all the time */                                                 \
	X(on_s)                                                                                        \
	X(pause_s)                                                                                     \
	X(again_s)                                                                                     \
	X(pause_open)   /* 1: the jaws are open in the pause */                                        \
	X(hold_s)       /* closed after energy */                                                      \
	X(cool_s)       /* open */                                                                     \
	X(parted_water) /* energy ends when no cell between the jaws has more water left, */           \
	X(reaction_s)   /* and so much later */                                                        \
	X(rise)         /* energy ends when the load is so many times its least */

#define MEASURED_NUMBER(name) double name;

typedef struct section_def {
	SECTION_TABLE(MEASURED_NUMBER)
} section_def;

#define SECTION_RESULTS(X)                                                                         \
	X(necrosis_mm)  /* beside the jaws, after cooling down */                                      \
	X(blade_peak_c) /* the upper jaw's greatest temperature */                                     \
	X(tissue_peak_c)                                                                               \
	X(off_c)    /* the upper jaw's temperature when energy ended */                                \
	X(energy_s) /* how long energy was on */                                                       \
	X(parted)   /* 1: no cell between the jaws has more than parted_water */                       \
	X(to_60_s)  /* from the end of energy to a blade of 60 degC */                                 \
	X(to_42_s)  /* and of 42 degC */                                                               \
	X(fusion)   /* damage of collagen while closed: of the coldest layer, at the best place */     \
	X(first_ohm)                                                                                   \
	X(last_ohm)                                                                                    \
	X(came_in_j)                                                                                   \
	X(boiled_j)                                                                                    \
	X(ledger_gap) /* share of what came in */

typedef struct section_found {
	SECTION_RESULTS(MEASURED_NUMBER)
} section_found;

// Ends the program if there is no memory.
section_found section_run(const section_def *def, cau_bioheat_material tissue);

// ---- an electrode that is drawn through a sheet, with sparks
#define CUT_TABLE(X)                                                                               \
	X(cell_mm)                                                                                     \
	X(step_s)                                                                                      \
	X(thick_mm)                                                                                    \
	X(wide_mm)   /* to one side: it is symmetric */                                                \
	X(way_mm)    /* of the electrode */                                                            \
	X(radius_mm) /* of the electrode, which goes through the sheet */                              \
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
	X(parted_water) /* a cell that sparks reach is gone when it has no more left */                \
	X(cool_s)

typedef struct cut_def {
	CUT_TABLE(MEASURED_NUMBER)
} cut_def;

#define CUT_RESULTS(X)                                                                             \
	X(necrosis_mm) /* beside the cut, mean over the middle half of the way */                      \
	X(kerf_mm)     /* mean width of the cut, both sides */                                         \
	X(cut_share)   /* share of the middle line that is gone */                                     \
	X(came_in_j)                                                                                   \
	X(boiled_j)                                                                                    \
	X(ledger_gap)

typedef struct cut_found {
	CUT_RESULTS(MEASURED_NUMBER)
} cut_found;

cut_found cut_run(const cut_def *def, cau_bioheat_material tissue);

// ---- a cooled needle in an organ
// A wedge of cells around the needle, above its middle: cells farther from the axis are fuller.
#define NEEDLE_TABLE(X)                                                                            \
	X(cell_mm)                                                                                     \
	X(step_s)                                                                                      \
	X(radius_mm)                                                                                   \
	X(active_mm)                                                                                   \
	X(reach_mm) /* of the tissue, from the axis and from the needle's middle */                    \
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
	X(from_mm) /* a thermometer, from the needle's surface at its middle */

typedef struct needle_def {
	NEEDLE_TABLE(MEASURED_NUMBER)
} needle_def;

#define NEEDLE_RESULTS(X)                                                                          \
	X(temperature_c) /* at the thermometer when energy ended */                                    \
	X(dead_cm3)      /* after cooling down */                                                      \
	X(peak_c)                                                                                      \
	X(first_ohm)                                                                                   \
	X(last_ohm)                                                                                    \
	X(last_w)                                                                                      \
	X(far_share) /* of the power at last: beyond the cells */                                      \
	X(came_in_j)                                                                                   \
	X(boiled_j)                                                                                    \
	X(ledger_gap)

typedef struct needle_found {
	NEEDLE_RESULTS(MEASURED_NUMBER)
} needle_found;

needle_found needle_run(const needle_def *def, cau_bioheat_material tissue);

// ---- shared
static const double measured_gone = 1; // Omega from which tissue is dead

typedef struct measured_cells {
	cau_arena arena;
	cau_bioheat_material tissue;
	cau_bioheat bioheat;
	cau_current current;
} measured_cells;

// Ends the program if there is no memory. `cells` stays where it is.
void measured_open(measured_cells *cells, double cell_mm, int32_t capacity, double start_c,
                   cau_bioheat_material tissue, double perfusion, double boiling);

void measured_close(measured_cells *cells);

// Adds a cell, full of tissue but for `fill`.
int32_t measured_add(measured_cells *cells, int32_t x, int32_t y, int32_t z, double fill);

// Whether the cell has no more water left than tissue that parts; where nothing boils, whether it
// is at 100 degC.
bool measured_parts(const measured_cells *cells, int32_t cell, double parted_water);

// Steps, in halves where stability asks it. `blades` may be none.
void measured_step(measured_cells *cells, cau_blade *blade, int32_t blade_count, double step_s);

// Whether a cell is so warm that damage counts.
bool measured_warm(const measured_cells *cells);

// Greatest gap of the ledger as a share of what came in. `came_in_j` is that.
double measured_gap(const measured_cells *cells, double *came_in_j);

// How far from a border tissue is dead, in cells: `damage` of the cells from the border on.
// Between the last dead cell and the first that lives the border is where the logarithm of Omega
// is 0, by a straight line.
double measured_depth(const double *damage, int32_t count);
