// SPDX-License-Identifier: GPL-3.0-or-later
// The tissue as VTK unstructured grids (.vtu, appended raw binary), with a collection (.pvd) that
// gives their times: what ParaView opens.
#pragma once

#include "cautery/session.h"

typedef struct sim_vtu {
	const char *folder; // borrowed
	int32_t file_count;
	uint64_t *tick; // (file_count)
	double *time_s; // (file_count)
} sim_vtu;

// Makes the folder if it is missing. The caller finishes *vtu.
cau_status sim_vtu_begin(const char *folder, sim_vtu *vtu, cau_error *error);

// Writes tissue-<tick>.vtu: live tetrahedra and links and the drawn triangles of sheets, each with
// its kind (0 tetrahedron, 1 link, 2 triangle) and the layer of triangles (else -1); velocity,
// exposure, charring, temperature and stress of vertices.
// And tools-<tick>.vtu: a line for each tool from its tip along its shaft, with the tool's number
// in the tick, force and torque of the tissue on it (as computed, about the tip), its tip's
// temperature, the heat that tissue took up from it, and whether it is energized.
// What the session is asked to watch is asked for here, and no longer watched afterwards.
cau_status sim_vtu_write(sim_vtu *vtu, cau_session *session, cau_error *error);

// Writes cautery.pvd and frees.
cau_status sim_vtu_finish(sim_vtu *vtu, cau_error *error);
