// SPDX-License-Identifier: GPL-3.0-or-later
// The files of a run.
#pragma once

#include <stdio.h>

#include "cautery/session.h"

// ---- comma-separated values
// Every tick: statistics, energies, the energy ledger of the instruments, forces and heat of each
// tool in the scene, and last the time of each stage. README.md has the columns.

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

// ---- VTK files
// The tissue as VTK unstructured grids (.vtu, appended raw binary), with a collection (.pvd) that
// has their times. ParaView opens both.

typedef struct sim_vtu {
	const char *folder; // borrowed
	int32_t file_count;
	uint64_t *tick; // (file_count): tick of each file
	double *time_s; // (file_count): time of each file
} sim_vtu;

// Begins a series. Makes the folder if it is missing. The caller finishes *vtu.
cau_status sim_vtu_begin(const char *folder, sim_vtu *vtu, cau_error *error);

// Writes two files for the present tick. tissue-<tick>.vtu has the live tetrahedra and links and
// the drawn triangles of sheets. Each cell has its kind (0 tetrahedron, 1 link, 2 triangle) and, if
// it is a triangle, its layer (else -1). Each vertex has velocity, exposure, charring, temperature
// and stress. tools-<tick>.vtu has a line for each tool, from its tip along its shaft. The line has
// the tool's number in the tick, and the force and torque of the tissue on it (as computed, about
// the tip). It also has the temperature of the tip, the heat that tissue took up, and whether
// energy is on. The quantities that the session must observe are requested here and released
// afterwards.
cau_status sim_vtu_write(sim_vtu *vtu, cau_session *session, cau_error *error);

// Writes cautery.pvd and frees the series.
cau_status sim_vtu_finish(sim_vtu *vtu, cau_error *error);
