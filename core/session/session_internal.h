// SPDX-License-Identifier: GPL-3.0-or-later
// What a session is made of, between the files of this room.
#pragma once

#include "base/image.h"
#include "base/memory.h"
#include "base/pool.h"
#include "bioheat/tissue_cells.h"
#include "cautery/session.h"
#include "dissect/dissection.h"
#include "dissect/shrink.h"
#include "frame/frame_state.h"
#include "heat/exposure.h"
#include "solve/contact.h"
#include "solve/matrix_update.h"
#include "solve/solver.h"
#include "tissue/tissue.h"
#include "vessel/vessels.h"

enum { CAU_MAX_GRASPED = 96, CAU_MAX_REFUSALS = 32 };

typedef struct cau_grasp { // one attached vertex, or a point of a face between vertices
	int32_t face;          // -1: a vertex
	int32_t vertex[3];     // the face's corners; the vertex
	double weight[3];      // their shares in the point
	double local[3];       // m, anchor in the tool's frame
	double start[3];       // m, where the grasp began
} cau_grasp;

typedef struct cau_tool {
	cau_tool_state state;
	cau_pose target; // wanted by the driver; state.asked_pose follows within its speed limits
	double jaw_target;
	double jaw_before;    // at the start of the tick
	cau_pose pose_before; // at the start of the tick
	// proxy.c: the other end of the virtual coupling, at the end and the start of the tick
	cau_pose anchor, anchor_before;
	cau_pose led;          // where the anchor is led to in the substep
	cau_pose asked_before; // state.asked_pose at the start of the tick
	cau_pose tick_pose;    // pose_before and jaw_before of the tick, during its second substep
	double tick_jaw;
	double pace; // share of the anchor's motion that it follows in a tick; below 1 when held back
	cau_heat_grid grid;
	cau_blade blade; // with energy `tissue`: electrosurgery.c
	// Least load since energy came on, ohm; 0: no current yet; below 0: load_rise_off was reached.
	double least_ohm;
	int32_t grasp_count;
	cau_grasp grasp[CAU_MAX_GRASPED];
	double least_open_rad; // pinch.c: held tissue keeps the jaws open at least so far
} cau_tool;

// energy.c: energy that a tick added without a source, and the shares whose laws it changed.
typedef struct cau_energy {
	double gain_j;    // of the last tick
	double scale_j;   // energy at its start and work in it (cautery/session.h: energy_scale_j)
	double elastic_j; // at its start
	double end_j;     // and at its end
	bool stale;       // every share is to be evaluated before the next tick
	bool marked;      // some are: those that are dirty
	uint8_t *dirty;   // (work_count)
	double *sum_j;    // (chunk_count x 4): scratch
} cau_energy;

// inversion.c: tetrahedra that are inside out. Snapshots do not hold the ticks. After a restore the
// count begins at 0.
typedef struct cau_inversion {
	int32_t count;                      // after the last tick
	int32_t long_count[CAU_MAX_LAYERS]; // by layer: those that have been so for half a second
	uint16_t *ticks;     // (tetrahedron_count): consecutive ticks inside out, at most long_ticks
	uint16_t long_ticks; // of half a second
	bool followed;       // some of `ticks` may not be 0
} cau_inversion;

// rest.c: whether the tissue is at rest, and since when it has been quiet.
typedef struct cau_rest {
	bool resting;
	int32_t quiet_ticks; // 0: something moves
	double *from;        // m, (n x 3): positions as the quiet began
} cau_rest;

// spin.c: the pieces that living elements join.
typedef struct cau_spin {
	bool stale;      // the pieces must be found again
	int32_t removed; // elements that were removed when they were found
	int32_t piece_count;
	int32_t *piece;  // (n): of a vertex
	int32_t *member; // (n): vertices, by piece
	int32_t *first;  // (piece_count + 1): into `member`
} cau_spin;

// substep.c: the part of a tick that a solve leads on. Of a tick with one part the arrays are NULL.
typedef struct cau_substep {
	int32_t index, count;
	double part;     // of the tick
	double length_s; // the same in s
	// A tick with two parts:
	double *tick_start; // m, (n x 3): x at the tick's start, once the second has begun
	double *base;       // m, (n x 3): x + q v1
	double *push;       // N, (n x 3): share of the tick's mean that tools pushed with in the first
	bool disturbed;     // a substep ended elsewhere than at its solution
	double touching_j;  // energy of tissue on tissue at the tick's start
	int32_t iterations, backtracks; // of the first part, as those below
	double local_s, contact_s, residual, error;
} cau_substep;

typedef struct cau_contact_watch cau_contact_watch; // tool_contact.c

// Results of possible.c's last check of the edges, and its scratch.
typedef struct cau_watch {
	double left_m;        // vertices may still go half as far before an edge can be too long
	double *farthest2_m2; // by chunk of vertices: square of the farthest move of the tick
	int32_t *astray;      // by chunk of vertices: one that moved too far, or -1
	int32_t chunk_count;  // of edges
	double *room_m;       // by chunk of edges: least length that one may still grow by
	int32_t *edge;        // by chunk of edges: the one
} cau_watch;

struct cau_session {
	cau_arena arena;
	cau_arena rebuilt_arena; // the system since pins last changed: pins.c
	cau_image *image;        // share.c: memory shared with other sessions; NULL: none
	cau_scene_def *scene;
	uint64_t definition_hash;
	cau_tissue tissue;
	cau_pool *pool;
	cau_step_solver solver;
	cau_matrix_update update;
	cau_dissection dissection;
	cau_shrink shrink;
	cau_near near;
	cau_tissue_cells *cells; // of energy `tissue`; NULL: energy `paper`
	cau_vessels *vessels;    // NULL: the scene has none
	cau_contact_set contact;
	cau_collide collide;             // meet.c: where solver.collide points, if anywhere
	struct cau_candidate *candidate; // reach.c: scratch
	double *position_unheld;         // m, (n x 3): touch.c, as a step was before faces were missed
	// touch.c: cau_session_farthest as a solve ended, and as it had ended before faces were missed
	double farthest_m, unheld_farthest_m;
	cau_frame_state frame;

	uint64_t tick;
	bool faulted;
	double *position, *velocity; // (n x 3)
	double *position_start;      // x at the start of the tick
	double *external;            // N, (n x 3), set by commands
	uint8_t *pinned;             // (n): by scene and commands
	uint8_t *fixed;              // (n): pinned or frozen
	uint8_t *chosen;             // (n): scratch of selections
	cau_drag *drag;              // (n)
	cau_inversion inversion;
	int32_t frozen_count;
	cau_watch watch;
	cau_energy energy;
	cau_rest rest;
	cau_spin spin;
	cau_substep substep;
	double size_m;           // diagonal of the tissue's box at rest
	int32_t driven_count;    // pinned vertices that the next step moves
	int32_t *driven;         // (n)
	double *driven_position; // m, (n x 3), by place in `driven`

	int32_t tool_count;
	cau_tool *tool;            // (CAU_MAX_TOOLS)
	cau_tool_state *tool_view; // (CAU_MAX_TOOLS), for the frame

	int32_t command_count, command_capacity;
	cau_command *command; // queued, in order of submission
	int32_t refusal_count;
	cau_error refusal[CAU_MAX_REFUSALS];

	int32_t *face_layer; // (face_count)
	float *face_texture; // (face_count x 3 x 2)
	int32_t fat_first_face[CAU_MAX_LAYERS], fat_face_count[CAU_MAX_LAYERS];

	double (*now_s)(void);
	double stage_s[CAU_STAGE_COUNT];
	double stage_start;
	uint32_t watched;                 // CAU_CHANNEL_* bits
	cau_contact_watch *contact_watch; // tool_contact.c; NULL: the contact was never watched
};

// command.c: applies the queued commands that are due.
cau_status cau_session_apply_commands(cau_session *session, cau_error *error);
// command.c: whether the values of a command of a known kind are in their ranges.
cau_status cau_command_check(const cau_session *session, const cau_command *command,
                             cau_error *error);
// level.c: whether the command states what holds already, or will be refused. The second is for a
// CONFIGURE's definition, the third for a SET_MATERIAL.
bool cau_session_changes_nothing(cau_session *session, const cau_command *command);
bool cau_session_has_definition(const cau_tool *tool, const cau_tool_def *def);
bool cau_session_has_material(const cau_session *session, const cau_command *command);
// still.c: removes commands about the tool from a queue, and returns how many of `count` remain. It
// removes those that end an enable's ticks; enables and these; or all.
typedef enum cau_void { CAU_VOID_LIMITS, CAU_VOID_ENABLES, CAU_VOID_ALL } cau_void;
int32_t cau_session_void(cau_command *queue, int32_t count, const char *tool, cau_void which);
// Of an enable with `ticks` that acts at this tick, the command that ends it. False: it has none.
bool cau_session_limit_energy(const cau_command *enable, uint64_t tick, cau_command *end);
// Makes the tool's actual pose its target; whether it is that already.
void cau_session_stay(cau_tool *tool);
bool cau_session_stays(const cau_tool *tool);
// sound.c: checks the rules about tools, energy and waiting commands as a step begins, in every
// build.
cau_status cau_session_check_sound(const cau_session *session, cau_error *error);
// layer_material.c: puts the material of a SET_MATERIAL into the layer; false: it is of another
// kind of tissue.
bool cau_layer_take_material(cau_layer_def *def, const cau_command *command);
// Whether the command would change nothing of the layer.
bool cau_layer_has_material(const cau_layer_def *def, const cau_command *command);
// substep.c. A tick's motion is: begin_substeps; for each substep the prediction, contact and the
// solve, with next_substep before the second; end_substeps. The last also follows a failed solve,
// and does nothing where the tick has one substep. Then position_start is the tick's start.
cau_status cau_session_make_substeps(cau_session *session, cau_error *error);
void cau_session_begin_substeps(cau_session *session);
void cau_session_next_substep(cau_session *session);
void cau_session_end_substeps(cau_session *session);
// After that: velocities become a share of the tick's mean, as with implicit Euler, and the rest of
// what they were.
void cau_session_take_mean(cau_session *session, double share);
// The prediction of the second substep.
void cau_session_predict_on(cau_session *session);
// How far (m) a vertex would go in a tick along axis c at its velocity at the tick's end.
double cau_session_way(const cau_session *session, int32_t vertex, int c);
// The share that the last substep's forces have in the tick's mean.
double cau_session_last_share(const cau_session *session);
// tool_motion.c: tools follow their drivers, within their speed limits. In the second substep they
// go the rest of their way. At its end pose_before and jaw_before are of the tick again.
void cau_session_move_tools(cau_session *session);
void cau_session_lead_tools_on(cau_session *session);
void cau_session_keep_tick_poses(cau_session *session);
cau_status cau_session_add_tool(cau_session *session, const cau_tool_def *def, cau_error *error);
void cau_session_drop_tool(cau_session *session, int32_t index);
int32_t cau_session_find_tool(const cau_session *session, const char *name);
// proxy.c, in this order. cau_session_lead_tool moves a tool's anchor to its commanded pose, and
// the start of its pose with it. cau_session_couple gives both to the solve. cau_session_take_poses
// reads the tools' poses from the solve. cau_session_hold_back begins the tick again for tools that
// would pass tissue that is not held: they move a part of their motion, on the last attempt none.
// It returns false if there is no such tool, or no attempt left. cau_session_let_follow speeds up
// tools that were not held back in a tick.
enum { CAU_ATTEMPTS = 2 };
void cau_session_lead_tool(cau_session *session, cau_tool *tool, const cau_pose *asked_before);
void cau_session_lead_tool_on(cau_session *session, cau_tool *tool);
void cau_session_couple(cau_session *session);
void cau_session_take_poses(cau_session *session);
bool cau_session_hold_back(cau_session *session, int attempt);
void cau_session_let_follow(cau_session *session);
// touch.c: contact constraints, attachments and drag before the solve; forces after it.
void cau_session_find_contacts(cau_session *session);
// After the solve: whether tissue is inside a tool by its contact constraints, or met a tool
// without a constraint; it then adds one.
bool cau_session_find_missed(cau_session *session);
// Whether tissue diverged because faces were held: it moved farther than without that, by more than
// a tip's width and the tip's own motion. Then the faces were not held, even if they are outside
// the tool, and all tools count as passing.
bool cau_session_find_thrown(cau_session *session);
// Restores the step as it was before the first missed face was found, and forgets all sides. So
// tools pass where tissue would not be held.
void cau_session_let_through(cau_session *session);

// touch.c, thin.c: a vertex at a tool, with its signed distance, m; of many the deepest are listed.
enum { CAU_MAX_TOUCHING = 2048 };
typedef struct cau_touching {
	int32_t vertex, place; // place: along the broad phase's curve
	double gap;
} cau_touching;
// thin.c: the distance, m, from a tool within which tissue may touch it in a tick.
double cau_session_margin(const cau_tool_def *def);
// Moves to the front of the list the vertices that get a contact constraint, where `taken` exist
// already. At most CAU_NEAR_ROWS of all get one, and CAU_MAX_VERTEX_ROWS of those that touch. The
// deepest come first unless they are spread. Returns their number; *left_out gets the number of
// touching vertices without one.
int32_t cau_session_thin(const cau_session *session, cau_touching *list, int32_t count,
                         int32_t taken, int32_t *left_out);

// Share of the tip's radius. A face that is deeper inside counts as missed.
static const double cau_missed_share = 0.5;
// reach.c: contact with faces.

// The greatest distance, m, of a vertex from its position at the tick's start; not a number if a
// position is none.
double cau_session_farthest(const cau_session *session);
// Whether a tool has contact with faces as well as with vertices. Tools with jaws have not, because
// tissue lies between and inside jaws.
bool cau_session_feels_faces(const cau_tool *tool);
// Whether the part may be within the margin, m, of any point of the box. The distance changes by no
// more than the point moves.
bool cau_session_may_meet(const cau_tool *tool, cau_tool_part part, const cau_box *box,
                          double margin_m);
// Allocates the scratch of reach.c; NULL when memory ran out.
struct cau_candidate *cau_session_make_reach(cau_arena *arena);
// Adds contact constraints for the faces that the part of a tool pushed in the last step.
void cau_session_reach_again(cau_session *session, int32_t index, cau_tool_part part);
// After the solve: adds contact constraints for the faces that the part has passed, or that are
// deep inside it.
void cau_session_reach(cau_session *session, int32_t index, cau_tool_part part);
void cau_session_read_forces(cau_session *session);
cau_status cau_session_grasp(cau_session *session, cau_tool *tool, cau_error *error);
void cau_session_release(cau_tool *tool);
void cau_session_drop_frozen_grasps(cau_session *session);
// grasp.c: a hold on a vertex; the contact constraint of a hold, without its anchor; the hold of a
// constraint, or NULL; whether the held vertex or face still exists.
cau_grasp cau_session_hold_vertex(int32_t vertex);
cau_contact_row cau_session_row_of_hold(const cau_session *session, const cau_grasp *grasp,
                                        int32_t tool);
cau_grasp *cau_session_hold_of_row(cau_tool *tool, const cau_contact_row *row);
bool cau_session_hold_is_left(const cau_session *session, const cau_grasp *grasp);
// Grasps faces between the jaws of which no corner is held.
void cau_session_grasp_faces(const cau_session *session, cau_tool *tool);
// pinch.c: begins when jaws have grasped. As a tick begins, turns the jaws towards their commanded
// opening, as far as the held tissue allows, and takes it along. After the solve, reads the force
// with which they press.
void cau_session_begin_pinch(const cau_session *session, cau_tool *tool);
void cau_session_turn_jaws(cau_tool *tool, double step_s, double part);
void cau_session_read_pinch(cau_session *session, cau_tool *tool, int32_t index);
// meet.c: tissue contact. Makes its arrays if the scene asks for it. As the tick begins, finds the
// touching pairs and filters the start of the step by them.
cau_status cau_session_make_collide(cau_session *session, cau_error *error);
void cau_session_begin_collide(cau_session *session);
// exempt.c: excludes vertices from contact for this tick, as those whose `guess` (m, n x 3) is
// farther than `most_m` away. *told: whether a diverged or inverted vertex is among them. Returns
// false if tissue contact is off for the tick.
bool cau_session_exempt(cau_session *session, const double *guess, double most_m, bool *told);
// electrosurgery.c: energy `tissue`. Makes the cells if the scene asks for it; the blade of a tool
// that is added; a tick of power, heat and parting; whether all of it has cooled down.
cau_status cau_session_make_cells(cau_session *session, cau_error *error);
cau_blade cau_session_blade_of(const cau_session *session, const cau_tool_def *def);
void cau_session_operate(cau_session *session);
bool cau_session_has_cooled(const cau_session *session);
// bleed.c: makes the scene's vessels; finds their present state, as after a restore; advances
// seals, bleeding and blood by a tick; whether blood leaves a vessel or flows on the tissue.
cau_status cau_session_make_vessels(cau_session *session, cau_error *error);
void cau_session_look_at_vessels(cau_session *session);
void cau_session_bleed(cau_session *session);
bool cau_session_bleeds(const cau_session *session);
// burn.c. cau_session_burn is energy `paper`: heat, exposure, parting. cau_session_end_burn follows
// with either energy, and shrinks the tissue beside removed elements.
void cau_session_burn(cau_session *session);
void cau_session_end_burn(cau_session *session);
// Removes the elements from number `first` of the tick's list on from the local step, and puts them
// on the list of the factor.
void cau_session_take_out(cau_session *session, int32_t first);
// tear.c: tears elements that are stretched more than their layer bears.
void cau_session_tear(cau_session *session);
// relax.c: built-in tension brought to its equilibrium.
cau_status cau_session_relax(cau_session *session, cau_error *error);
// pins.c: a new set of pinned vertices, and the systems that follow from it.
cau_status cau_session_set_pins(cau_session *session, const cau_selection *selection, int pin,
                                cau_error *error);
// Analyses and factors the system of session->pinned. Its order follows from the pins alone.
cau_status cau_session_rebuild_system(cau_session *session, cau_error *error);
// view.c: computes the watched scalars of the vertices that changed in a tick; all of them again
// after a restore.
void cau_session_show_scalars(cau_session *session);
void cau_session_renew_scalars(cau_session *session);
// tool_contact.c: begins or ends to compute the contact of tools; frees what that takes; forgets
// the last tick's, as after a restore; computes it after a step, if it is watched; what a frame
// shows of it (tool_count), or NULL.
void cau_session_watch_contact(cau_session *session, bool watched);
void cau_session_unwatch_contact(cau_session *session);
void cau_session_forget_contact(cau_session *session);
void cau_session_read_contact(cau_session *session);
const cau_tool_contact *cau_session_show_contact(const cau_session *session);
// view.c: layer and texture of the faces.
cau_status cau_session_make_faces(cau_session *session, cau_error *error);
// drive.c: moves pinned vertices to the positions of cau_session_drive in this tick.
void cau_session_lead_driven(cau_session *session);
// stray.c: stops vertices that have moved too far; the size of all tissue at rest, m.
void cau_session_stop_strays(cau_session *session);
double cau_session_size(const cau_session *session);
// Greatest allowed distance of a vertex from its rest position, m.
double cau_session_farthest_from_rest(const cau_session *session);
// inversion.c: allocates its array. After a tick's solve, counts the tetrahedra that stay inside
// out. Whether a tetrahedron's volume is 0 or less; position is m, (n x 3).
cau_status cau_session_make_inversion(cau_session *session, cau_error *error);
void cau_session_follow_inversion(cau_session *session);
void cau_session_forget_inversion(cau_session *session); // after a restore
bool cau_session_is_inverted(const double *position, const int32_t vertex[4]);
// possible.c: its arrays; refuses a state that no tissue can have (CAU_NUMERICAL, with the tick and
// the layer), by the vertices' moves and the edges' lengths, and by the count of inverted elements.
cau_status cau_session_make_watch(cau_session *session, cau_error *error);
cau_status cau_session_check_motion(cau_session *session, cau_error *error);
cau_status cau_session_check_inverted(const cau_session *session, cau_error *error);
// Adds the tick and the layer to the solver's refusal in *error.
cau_status cau_session_locate(const cau_session *session, cau_error *error);
// energy.c: its arrays; elastic energy at a tick's start; the balance once it is solved, before
// velocities follow; marks what the tick has cut or shrinks.
cau_status cau_session_make_energy(cau_session *session, cau_error *error);
void cau_session_begin_energy(cau_session *session);
void cau_session_end_energy(cau_session *session);
void cau_session_mark_changed(cau_session *session);
// rest.c: its array; whether the coming tick is spent at rest (what is due wakes it); that tick;
// and at the end of one that was not, whether the next will be.
cau_status cau_session_make_rest(cau_session *session, cau_error *error);
bool cau_session_rests(cau_session *session);
cau_status cau_session_rest_tick(cau_session *session, cau_error *error);
void cau_session_fall_asleep(cau_session *session);
// spin.c: its arrays; prediction of what turns freely, once the rest is predicted.
cau_status cau_session_make_spin(cau_session *session, cau_error *error);
void cau_session_turn_prediction(cau_session *session);
// After two substeps: v2 of a piece that turns freely gets the angular momentum that the tick began
// with, where no tool is near and no tissue touches tissue.
void cau_session_keep_momentum(cau_session *session);
// motion.c: what turns a tick's way into the velocity after it, 1/s (eq. 2 and damping).
double cau_session_velocity_scale(const cau_session *session);
// motion.c: predicts s of eq. 4 before a solve; velocities after it.
void cau_session_predict(cau_session *session);
void cau_session_update_velocities(cau_session *session);
// step.c: plastic flow after a solve.
void cau_session_settle(cau_session *session);
// share.c: lists the pages of the session's large arrays, in the same order for equal scenes.
// Returns their count.
int32_t cau_session_pages(const cau_session *session, cau_pages pages[CAU_IMAGE_PARTS]);
// stage timing
void cau_session_stage_begin(cau_session *session);
void cau_session_stage_end(cau_session *session, int stage);
// check.c
cau_status cau_tool_check(const cau_tool_def *tool, const char *path, double step_s,
                          cau_error *error);
// One of a layer's materials, of the layer's kind.
const void *cau_layer_material(const cau_layer_def *layer, int32_t index);
cau_status cau_material_check(int kind, const void *material, const char *path, cau_error *error);
cau_status cau_selection_check(const cau_selection *selection, const char *path, cau_error *error);
cau_status cau_pose_check(const cau_pose *pose, const char *path, cau_error *error);
