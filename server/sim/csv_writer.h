// SPDX-License-Identifier: GPL-3.0-or-later
// Every tick as comma-separated values: statistics, energies, the ledger of instruments' energy,
// what each tool that the scene has bears and gives, and last the time that each stage took.
// README.md has the columns.
#pragma once

#include <stdio.h>

#include "cautery/session.h"

// The columns' names; those of a tool begin with its name. `scene` is the one that the ticks are
// of.
void sim_csv_begin(FILE *file, const cau_scene_def *scene);
// One line: the values of one tick.
typedef struct sim_csv_row {
	const cau_frame *frame;
	cau_balance balance;
	cau_energy_ledger ledger;
	double coagulated_m3; // cau_session_coagulated
	double vaporised_m3;  // cau_session_vaporised
	double vapour_kg_s;   // cau_session_vapour
} sim_csv_row;

// Stage times are the machine's, and 0 unless the session has a clock. Cells of a tool that is gone
// are empty.
void sim_csv_tick(FILE *file, const cau_scene_def *scene, const sim_csv_row *row);
