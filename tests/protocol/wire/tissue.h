// SPDX-License-Identifier: GPL-3.0-or-later
// An artificial tissue for tests of streams. It is a grid in smooth motion with a little noise. A
// cut runs across it, with exposure that rises along the cut. The tissue has one or two tools, and
// later a vessel and the contact of a tool. All this is the same in every run.
#pragma once

#include "cautery/stream.h"

typedef struct tissue {
	int32_t columns, rows;
	int32_t vertex_count, face_count, tick;
	double *position;
	uint8_t *visible;
	uint32_t *mask;
	CAU_SCALAR_MEMBERS(float);
	cau_stream_tool tools[2];
	cau_stream_statistics statistics;
	cau_vessel_state vessel;
	const cau_vessel_state *vessels[1]; // points to `vessel`
	cau_tool_contact contact;
} tissue;

// Allocates the arrays. tissue_finish frees them and sets them to NULL.
void tissue_init(tissue *made, int32_t columns, int32_t rows);
void tissue_finish(tissue *made);

// Moves the tissue to `tick` at 60 ticks a second. `speed_m_s` is the largest speed of a vertex.
void tissue_move(tissue *moved, int32_t tick, double speed_m_s);

// Returns a stream definition with all channels, and the sample of the present state; the sample is
// borrowed.
cau_stream_def tissue_stream_def(const tissue *of);
cau_stream_sample tissue_sample(const tissue *of);
