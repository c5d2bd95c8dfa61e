// SPDX-License-Identifier: GPL-3.0-or-later
// What the tests of whole sessions stand on: scenes made in C or read from deploy/scenes, commands
// in one line, numbers of the whole body. Functions fail the running test where core refuses.
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

// Numbers that no field takes.
extern const double stage_absurd[];
enum { STAGE_ABSURD_COUNT = 5 };

// ---- scenes: on the heap, the caller frees them with free()

// Empty: no gravity, one tick 1/60 s, the precision given.
cau_scene_def *stage_scene(int precision);
// deploy/scenes/NAME.json.
cau_scene_def *stage_scene_named(const char *name);
// The same, but under sanitizers with half as many cells along each axis: for tests whose bounds do
// not know the resolution.
cau_scene_def *stage_scene_light(const char *name);

// A layer on a generated mesh of its own, with the defaults of its kind; pointers into the scene.
cau_layer_def *stage_add_sheet(cau_scene_def *scene, const char *name, double x_m, double y_m,
                               int32_t cells_x, int32_t cells_y);
cau_layer_def *stage_add_slab(cau_scene_def *scene, const char *name, const double size_m[3],
                              const int32_t cells[3]);
void stage_add_membrane(cau_scene_def *scene, const char *name, const char *of);
cau_layer_def *stage_add_links(cau_scene_def *scene, const char *name, const char *of,
                               const char *to);
// A taut sheet of 60 x 50 mm, pinned at its rim.
void stage_add_taut_sheet(cau_scene_def *scene);
cau_mesh_def *stage_mesh_of(cau_scene_def *scene, const cau_layer_def *layer);
void stage_pin_box(cau_scene_def *scene, const double least_m[3], const double most_m[3]);
cau_tool_def *stage_add_tool(cau_scene_def *scene, const char *name, int shape, double x, double y,
                             double z);
// Fascia linked to the membrane of a slab of fat, its floor pinned; `hook` and the grasper `jaws`
// above.
cau_scene_def *stage_layered(void);
cau_selection stage_box(const double least_m[3], const double most_m[3]);
cau_selection stage_everything(void);

// ---- sessions
// On the kernels of test_tier() (rig/tier.h).
cau_session *stage_open(const cau_scene_def *scene, int32_t threads);
// The creation is refused with this status; *error says why.
void stage_refuse(const cau_scene_def *scene, cau_status status, cau_error *error);
void stage_step(cau_session *session, int32_t ticks);
cau_frame stage_frame(const cau_session *session);
cau_session_info stage_info(const cau_session *session);
cau_balance stage_balance(cau_session *session);
const cau_tool_state *stage_tool(const cau_session *session, const char *name); // of a fresh frame

// ---- commands, for the next tick
// With defaults, about the tool `hook` or the layer `fascia`.
cau_command stage_command(int kind);
void stage_submit(cau_session *session, const cau_command *command);
void stage_move(cau_session *session, const char *tool, double x, double y, double z);
void stage_turn(cau_session *session, const char *tool, const cau_pose *pose);
void stage_energize(cau_session *session, const char *tool, int on);
void stage_grasp(cau_session *session, const char *tool);
void stage_release(cau_session *session, const char *tool);
void stage_gravity(cau_session *session, double x, double y, double z);
void stage_force(cau_session *session, cau_selection selection, double x, double y, double z);

// One tick of the scene's own cut: the tool is put at its start in the first second, dwells there
// energized, is drawn to the end and stays. `tick` counts from the cut's beginning.
void stage_cut_tick(cau_session *session, const cau_cut_def *cut, const cau_pose *first, int tick);
int stage_cut_ticks(const cau_cut_def *cut, double step_s);

// ---- numbers
double stage_mean_edge_m(const cau_session_info *info);
// Largest distance (m) of a vertex of the frame from `from` (m, n x 3).
double stage_farthest(const cau_frame *frame, const double *from, int32_t vertex_count);
double stage_seconds(void); // wall clock, for reports

typedef struct stage_bytes {
	unsigned char *bytes;
	size_t count;
} stage_bytes;
stage_bytes stage_snapshot(const cau_session *session); // free(bytes)
