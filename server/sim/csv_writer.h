// SPDX-License-Identifier: GPL-3.0-or-later
// Writes every tick as comma-separated values: statistics, energies, the energy ledger of the
// instruments, forces and heat of each tool in the scene, and last the time of each stage.
// README.md has the columns.
#pragma once

#include <stdio.h>

#include "cautery/session.h"

// Writes the columns' names. A tool's columns begin with its name. `scene` is the scene of the
// ticks.
void sim_csv_begin(FILE *file, const cau_scene_def *scene);
// The values of one tick, for one line.
typedef struct sim_csv_row {
	const cau_frame *frame;
	cau_balance balance;
	cau_energy_ledger ledger;
	double coagulated_m3; // from cau_session_coagulated
	double vaporised_m3;  // from cau_session_vaporised
	double vapour_kg_s;   // from cau_session_vapour
} sim_csv_row;

// Writes the line of one tick. Times of stages depend on the machine, and are 0 if the session has
// no clock. Cells of a removed tool are empty.
void sim_csv_tick(FILE *file, const cau_scene_def *scene, const sim_csv_row *row);
