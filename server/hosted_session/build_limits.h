// SPDX-License-Identifier: GPL-3.0-or-later
// The time and memory that a session, or a second core of it, needs to be built, and the limits on
// them. `held` is the caller's current share, in bytes, of the memory that all sessions may take. A
// new amount replaces the old share.
#pragma once

#include "cautery/session.h"
#include "hosted_session/hosted.h"

// Returns the estimated time to build the scene, s.
double cau_building_expects_s(const cau_scene_def *scene);
// Sets the share *held to `bytes`. Returns CAU_LIMIT if all sessions together would exceed
// max_sessions_bytes. `holder` is the subject of the error's reason.
cau_status cau_building_hold(const cau_surroundings *around, int64_t *held, int64_t bytes,
                             const char *holder, cau_error *error);
void cau_building_release(const cau_surroundings *around, int64_t *held);
// Sets a session's share *held to `bytes`. A single session must also stay below max_session_bytes.
cau_status cau_building_hold_session(const cau_surroundings *around, int64_t *held, int64_t bytes,
                                     cau_error *error);
// Called between two stages of building. Checks the vertex and element counts, then sets the share
// *held to the memory that the session will take. Returns CAU_LIMIT if a limit is exceeded.
cau_status cau_building_check_limits(const cau_surroundings *around, int64_t *held,
                                     const cau_build_border *border, cau_error *error);
