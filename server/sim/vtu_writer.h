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
// its kind (0 tetrahedron, 1 link, 2 triangle) and the layer of triangles (else -1); velocity and
// exposure of vertices.
cau_status sim_vtu_write(sim_vtu *vtu, const cau_session *session, cau_error *error);

// Writes cautery.pvd and frees.
cau_status sim_vtu_finish(sim_vtu *vtu, cau_error *error);
