// SPDX-License-Identifier: GPL-3.0-or-later
// The values of a session that never change after its creation. Any thread reads them without a
// lock.
#pragma once

#include "hosted_session/hosted.h"

typedef struct cau_hosted_identity {
	char id[CAU_NAME_BYTES];
	uint32_t number;
	const cau_surroundings *around; // outlives the session
	cau_scene_def *scene;           // as it was at creation; owned
	void *meshes;                   // source bytes of the scene's meshes; owned
	size_t mesh_bytes;
	cau_asker creator;
	int64_t creator_sequence; // 0: no sequence number
} cau_hosted_identity;
