// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the tissue as VTK unstructured grids (.vtu, appended raw binary), with a collection (.pvd)
// that has their times. ParaView opens both.
#pragma once

#include "cautery/session.h"

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
