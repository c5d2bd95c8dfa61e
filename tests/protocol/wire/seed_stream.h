// SPDX-License-Identifier: GPL-3.0-or-later
// The small stream for the seeds of the fuzz targets.
#pragma once

#include "cautery/frame_codec.h"

enum {
	SEED_COLUMNS = 6,
	SEED_ROWS = 5,
	SEED_VERTICES = SEED_COLUMNS * SEED_ROWS,
	SEED_FACES = 2 * (SEED_COLUMNS - 1) * (SEED_ROWS - 1),
	SEED_SESSION = 3,
	SEED_EPOCH = 0x5eed,
};

static inline cau_stream_def seed_stream_def(void)
{
	cau_stream_def def = cau_default_stream_def();
	def.session = SEED_SESSION;
	def.channels = CAU_CHANNEL_ALL;
	def.vertex_count = SEED_VERTICES;
	def.face_count = SEED_FACES;
	return def;
}
