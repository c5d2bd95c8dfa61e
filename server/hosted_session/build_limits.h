// SPDX-License-Identifier: GPL-3.0-or-later
// What building a session, or a second core of it, takes and may take. `held` is what the holder
// has of the memory that all sessions may take, bytes; new bytes come in place of those.
#pragma once

#include "cautery/session.h"
#include "hosted_session/hosted.h"

// About how long it takes to build, s.
double cau_building_expects_s(const cau_scene_def *scene);
// CAU_LIMIT: all sessions would take more than they may. `holder` begins the reason.
cau_status cau_building_hold(const cau_surroundings *around, int64_t *held, int64_t bytes,
                             const char *holder, cau_error *error);
void cau_building_release(const cau_surroundings *around, int64_t *held);
// The same for a session, which has a limit of its own.
cau_status cau_building_hold_session(const cau_surroundings *around, int64_t *held, int64_t bytes,
                                     cau_error *error);
// Between two stages: holds what the session will take. CAU_LIMIT, also for its counts.
cau_status cau_building_check_limits(const cau_surroundings *around, int64_t *held,
                                     const cau_build_border *border, cau_error *error);
