// SPDX-License-Identifier: GPL-3.0-or-later
// Helpers for tests of whole sessions: scenes made in C or read from deploy/scenes, commands in one
// line, numbers of the whole body. Functions fail the running test if core refuses.
#pragma once

// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "cautery/session.h"

// Numbers that no field accepts.
extern const double stage_absurd[];
enum { STAGE_ABSURD_COUNT = 5 };

// ---- scenes: on the heap, the caller frees them with free()

// Returns an empty scene: no gravity, ticks of 1/60 s, the given precision.
cau_scene_def *stage_scene(int precision);
// Returns the scene deploy/scenes/NAME.json.
cau_scene_def *stage_scene_named(const char *name);
// Returns the scene deploy/scenes/NAME.json, but under sanitizers with half as many cells along
// each axis. Use this scene in tests whose bounds do not depend on the resolution.
cau_scene_def *stage_scene_light(const char *name);

// Add a layer on its own generated mesh, with the defaults of its kind. The results point into the
// scene.
cau_layer_def *stage_add_sheet(cau_scene_def *scene, const char *name, double x_m, double y_m,
                               int32_t cells_x, int32_t cells_y);
cau_layer_def *stage_add_slab(cau_scene_def *scene, const char *name, const double size_m[3],
                              const int32_t cells[3]);
void stage_add_membrane(cau_scene_def *scene, const char *name, const char *of);
cau_layer_def *stage_add_links(cau_scene_def *scene, const char *name, const char *of,
                               const char *to);
// Adds a taut sheet of 60 x 50 mm, pinned at its rim.
void stage_add_taut_sheet(cau_scene_def *scene);
cau_mesh_def *stage_mesh_of(cau_scene_def *scene, const cau_layer_def *layer);
void stage_pin_box(cau_scene_def *scene, const double least_m[3], const double most_m[3]);
cau_tool_def *stage_add_tool(cau_scene_def *scene, const char *name, int shape, double x, double y,
                             double z);
// Returns a scene with fascia that is linked to the membrane of a slab of fat, whose floor is
// pinned. The tools `hook` and `jaws` (a grasper) are above it.
cau_scene_def *stage_layered(void);
cau_selection stage_box(const double least_m[3], const double most_m[3]);
cau_selection stage_everything(void);

// ---- sessions
// Creates a session with the kernels of test_tier() (rig/tier.h).
cau_session *stage_open(const cau_scene_def *scene, int32_t threads);
// Expects that the creation is refused with this status; *error gets the reason.
void stage_refuse(const cau_scene_def *scene, cau_status status, cau_error *error);
void stage_step(cau_session *session, int32_t ticks);
cau_frame stage_frame(const cau_session *session);
cau_session_info stage_info(const cau_session *session);
cau_balance stage_balance(cau_session *session);
// Returns a tool's state from the present frame.
const cau_tool_state *stage_tool(const cau_session *session, const char *name);

// ---- commands, for the next tick
// Returns a command with defaults, about the tool `hook` or the layer `fascia`.
cau_command stage_command(int kind);
void stage_submit(cau_session *session, const cau_command *command);
void stage_move(cau_session *session, const char *tool, double x, double y, double z);
void stage_turn(cau_session *session, const char *tool, const cau_pose *pose);
void stage_energize(cau_session *session, const char *tool, int on);
void stage_grasp(cau_session *session, const char *tool);
void stage_release(cau_session *session, const char *tool);
void stage_gravity(cau_session *session, double x, double y, double z);
void stage_force(cau_session *session, cau_selection selection, double x, double y, double z);

// Submits one tick of the scene's own cut. The tool is put at its start in the first second, stays
// there energized, moves to the end and stays. `tick` counts from the cut's beginning.
void stage_cut_tick(cau_session *session, const cau_cut_def *cut, const cau_pose *first, int tick);
int stage_cut_ticks(const cau_cut_def *cut, double step_s);

// ---- numbers
double stage_mean_edge_m(const cau_session_info *info);
// Returns the largest distance (m) of a vertex of the frame from its position in `from` (m, n x 3).
double stage_farthest(const cau_frame *frame, const double *from, int32_t vertex_count);
double stage_seconds(void); // wall clock, for reports

typedef struct stage_bytes {
	unsigned char *bytes;
	size_t count;
} stage_bytes;
stage_bytes stage_snapshot(const cau_session *session); // the caller frees bytes
