// SPDX-License-Identifier: GPL-3.0-or-later
// The structure of a session, shared by the files of core/session.
#pragma once

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

// Capacity of one tool's jaws, in attachments. All tools together have CAU_MAX_HELD (contact.h).
enum { CAU_MAX_GRASPED = 96, CAU_MAX_REFUSALS = 32 };

typedef struct cau_grasp { // one attached vertex, or a point of a face between vertices
	int32_t face;          // face of the point; -1: a vertex is attached
	int32_t vertex[3];     // the face's corners; or the vertex and -1, -1
	double weight[3];      // weights of the corners at the point
	double local[3];       // m, anchor in the tool's frame
	double start[3];       // m, anchor when the grasp began
} cau_grasp;

typedef struct cau_tool {
	cau_tool_state state;
	cau_pose target; // commanded by the driver; state.asked_pose follows within the speed limits
	double jaw_target;
	double jaw_before;    // opening at the start of the tick
	cau_pose pose_before; // actual pose at the start of the tick
	// proxy.c: the other end of the virtual coupling, at the end and the start of the tick
	cau_pose anchor, anchor_before;
	cau_pose led;          // pose to which the anchor is led in the substep
	cau_pose asked_before; // state.asked_pose at the start of the tick
	// The tick's pose_before and jaw_before, kept during its second substep.
	cau_pose tick_pose;
	double tick_jaw;
	// Share of the motion to `led` that the anchor makes in a tick; below 1 while the tool is held
	// back.
	double pace;
	cau_heat_grid grid;
	cau_blade blade; // the metal of the hot part, with energy `tissue`: electrosurgery.c
	// Least load since energy came on, ohm; 0: no current yet; below 0: load_rise_off was reached.
	double least_ohm;
	int32_t grasp_count;
	cau_grasp grasp[CAU_MAX_GRASPED];
	double least_open_rad; // pinch.c: smallest opening that the held tissue permits, rad
} cau_tool;

// energy.c: energy gain of a tick, and the shares whose material law the tick changed.
typedef struct cau_energy {
	double gain_j; // energy gain of the last tick
	// Energy at the tick's start and work in it (cautery/session.h: energy_scale_j).
	double scale_j;
	double elastic_j; // elastic energy at the tick's start
	double end_j;     // elastic energy at the tick's end
	bool stale;       // every share must be evaluated before the next tick
	bool marked;      // the shares that are `dirty` must be evaluated before the next tick
	uint8_t *dirty;   // (work_count): 1 for a share whose material law changed
	double *sum_j;    // (chunk_count x 4): scratch for sums
} cau_energy;

// possible.c: inverted tetrahedra. Snapshots do not hold the ticks, so a count begins at 0 after a
// restore.
typedef struct cau_inversion {
	int32_t count;                      // inverted after the last tick
	int32_t long_count[CAU_MAX_LAYERS]; // by layer: inverted for half a second or longer
	uint16_t *ticks;     // (tetrahedron_count): consecutive ticks as inverted, at most long_ticks
	uint16_t long_ticks; // number of ticks in half a second
	bool followed;       // `ticks` may contain numbers other than 0
} cau_inversion;

// rest.c: whether the tissue is at rest, and for how long it has been quiet.
typedef struct cau_rest {
	bool resting;
	int32_t quiet_ticks; // ticks without motion; 0: something moves
	double *from;        // m, (n x 3): positions when the quiet ticks began
} cau_rest;

// spin.c: the pieces of tissue that are connected by living elements.
typedef struct cau_spin {
	bool stale;      // the pieces must be found again before use
	int32_t removed; // number of removed elements when the pieces were found
	int32_t piece_count;
	int32_t *piece;  // (n): piece of a vertex
	int32_t *member; // (n): vertices, ordered by piece
	int32_t *first;  // (piece_count + 1): index of a piece's first vertex in `member`
} cau_spin;

// motion.c: the present substep of a tick. If a tick has one substep, the arrays are NULL.
typedef struct cau_substep {
	int32_t index, count;
	double part;     // length as a share of the tick
	double length_s; // length in s
	// Used only with two substeps:
	double *tick_start; // m, (n x 3): x at the tick's start, from the second substep on
	double *base;       // m, (n x 3): x + q v1
	// N, (n x 3): force of the tools in the first substep, times the substep's share in the tick's
	// mean.
	double *push;
	bool disturbed;                 // a substep did not end at its solution
	double touching_j;              // energy of tissue on tissue at the tick's start
	int32_t iterations, backtracks; // statistics of the first substep, also on the next line
	double local_s, contact_s, residual, error;
} cau_substep;

typedef struct cau_contact_watch cau_contact_watch; // contact records of tools: tool_contact.c

// Results of the last check of edge lengths (possible.c), and its scratch memory.
typedef struct cau_watch {
	double size_m;        // diagonal of the tissue's box at rest: possible.c
	double left_m;        // least length by which an edge may still grow before it is too long
	double *farthest2_m2; // by chunk of vertices: squared farthest motion in the tick
	int32_t *astray;      // by chunk of vertices: a vertex that moved too far, or -1
	int32_t chunk_count;  // number of chunks of edges
	double *room_m; // by chunk of edges: least length by which one of its edges may still grow
	int32_t *edge;  // by chunk of edges: the edge with that least length
} cau_watch;

// Memory of a session.
typedef struct cau_session_memory {
	cau_arena arena;
	cau_arena rebuilt; // system that was built when the pins last changed: pins.c
	cau_image *image;  // create.c: memory shared with other sessions, or NULL
} cau_session_memory;

// State of the tissue's n vertices.
typedef struct cau_vertices {
	double *position, *velocity; // m, m/s, (n x 3)
	double *start;               // m, (n x 3): position at the start of the tick
	double *external;            // N, (n x 3): forces set by commands
	uint8_t *pinned;             // (n): pinned by the scene and by commands
	uint8_t *fixed;              // (n): 1 for a vertex that is pinned or frozen
	uint8_t *chosen;             // (n): scratch for selections
	int32_t frozen_count;
} cau_vertices;

// Where tools heat tissue, and the temperatures of the tissue itself.
typedef struct cau_heating {
	cau_near near;
	cau_tissue_cells *cells; // cells of energy `tissue`; NULL: energy `paper`
} cau_heating;

// touch.c: search for contact of tools with tissue.
typedef struct cau_touch {
	struct cau_candidate *candidate; // reach.c: scratch memory
	cau_drag *drag;                  // (n): drag of energized tools on vertices
	double *unheld;                  // m, (n x 3): solution before missed faces were added
	// Result of cau_session_farthest after the last solve, and before missed faces were added.
	double farthest_m, unheld_farthest_m;
} cau_touch;

// pins.c: pinned vertices that the next step moves.
typedef struct cau_driven {
	int32_t count;
	int32_t *vertex;  // (n)
	double *position; // m, (n x 3), in the order of `vertex`
} cau_driven;

// command.c: commands that wait for their tick, and the refusals of the last step.
typedef struct cau_queue {
	int32_t count, capacity;
	cau_command *command; // in order of submission
	int32_t refusal_count;
	cau_error refusal[CAU_MAX_REFUSALS];
} cau_queue;

// view.c: arrays of frames and of a session's description.
typedef struct cau_view {
	cau_frame_state frame;
	cau_tool_state *tool; // (CAU_MAX_TOOLS): states for the frame
	int32_t *face_layer;  // (face_count): layer of each face
	float *face_texture;  // (face_count x 3 x 2): texture coordinates
	int32_t fat_first_face[CAU_MAX_LAYERS], fat_face_count[CAU_MAX_LAYERS];
	uint32_t watched;           // watched channels: CAU_CHANNEL_* bits
	cau_contact_watch *contact; // tool_contact.c; NULL: the contact was never watched
} cau_view;

// Times of the stages of a step.
typedef struct cau_timing {
	double (*now_s)(void); // NULL: no times are measured
	double stage_s[CAU_STAGE_COUNT];
	double stage_start;
} cau_timing;

struct cau_session {
	cau_session_memory memory;
	cau_scene_def *scene;
	uint64_t definition_hash;
	cau_tissue tissue;
	cau_pool *pool;
	uint64_t tick;
	bool faulted;
	cau_vertices vertices;
	cau_step_solver solver;
	cau_matrix_update update;
	cau_dissection dissection;
	cau_shrink shrink;
	cau_heating heat;
	cau_vessels *vessels; // the scene's vessels, or NULL if it has none
	cau_contact_set contact;
	cau_collide collide; // meet.c: solver.collide points here, or is NULL
	cau_touch touch;
	int32_t tool_count;
	cau_tool *tool; // (CAU_MAX_TOOLS), of which tool_count are in use
	cau_driven driven;
	cau_queue queue;
	cau_inversion inversion;
	cau_watch watch;
	cau_energy energy;
	cau_rest rest;
	cau_spin spin;
	cau_substep substep;
	cau_view view;
	cau_timing timing;
};

// command.c: applies the queued commands whose tick has come.
cau_status cau_session_apply_commands(cau_session *session, cau_error *error);
// command.c: checks the ranges of a command's values. The kind of the command must be valid.
cau_status cau_command_check(const cau_session *session, const cau_command *command,
                             cau_error *error);
// level.c: whether the command repeats the present level, or will be refused. For a CONFIGURE
// has_definition decides this, for a SET_MATERIAL has_material.
bool cau_session_changes_nothing(cau_session *session, const cau_command *command);
bool cau_session_has_definition(const cau_tool *tool, const cau_tool_def *def);
bool cau_session_has_material(const cau_session *session, const cau_command *command);
// still.c: removes commands about the tool from a queue. LIMITS removes the automatic ends of
// enables; ENABLES removes enables and their ends; ALL removes every command about the tool.
// Returns how many of `count` remain.
typedef enum cau_void { CAU_VOID_LIMITS, CAU_VOID_ENABLES, CAU_VOID_ALL } cau_void;
int32_t cau_session_void(cau_command *queue, int32_t count, const char *tool, cau_void which);
// Fills *end with the command that ends the enable after its `ticks`. The enable acts at `tick`.
// Returns false if the enable has no end.
bool cau_session_limit_energy(const cau_command *enable, uint64_t tick, cau_command *end);
// cau_session_stay sets the tool's target to its actual pose. cau_session_stays returns whether the
// target is the actual pose already.
void cau_session_stay(cau_tool *tool);
bool cau_session_stays(const cau_tool *tool);
// level.c: puts the material of a SET_MATERIAL into the layer. Returns false if the
// material is for another kind of layer.
bool cau_layer_take_material(cau_layer_def *def, const cau_command *command);
// motion.c. A tick's motion is: begin_substeps; for each substep the prediction, contact and the
// solve, with next_substep before the second; end_substeps. end_substeps is also called after a
// failed solve, and has no effect if the tick has one substep. Afterwards vertices.start is again
// the tick's start.
cau_status cau_session_make_substeps(cau_session *session, cau_error *error);
void cau_session_begin_substeps(cau_session *session);
void cau_session_next_substep(cau_session *session);
void cau_session_end_substeps(cau_session *session);
// Changes the velocities after end_substeps. They become a mixture: `share` of the tick's mean
// velocity, as with implicit Euler, and the rest of their present value.
void cau_session_take_mean(cau_session *session, double share);
// Returns the distance, m, that a vertex would move in a tick along axis c at its velocity at the
// tick's end.
double cau_session_way(const cau_session *session, int32_t vertex, int c);
// Returns the share of the last substep's forces in the tick's mean.
double cau_session_last_share(const cau_session *session);
// tool_motion.c: tools follow their drivers within their speed limits. lead_tools_on makes the rest
// of the motion in the second substep. keep_tick_poses then sets pose_before and jaw_before to
// those of the tick's start.
void cau_session_move_tools(cau_session *session);
void cau_session_lead_tools_on(cau_session *session);
void cau_session_keep_tick_poses(cau_session *session);
cau_status cau_session_add_tool(cau_session *session, const cau_tool_def *def, cau_error *error);
void cau_session_drop_tool(cau_session *session, int32_t index);
int32_t cau_session_find_tool(const cau_session *session, const char *name);
// proxy.c, in this order. cau_session_lead_tool moves a tool's anchor to the commanded pose, and
// shifts the start of the actual pose with the anchor. cau_session_couple gives anchor and pose to
// the solve. cau_session_take_poses reads the tools' poses from the solve. cau_session_hold_back
// begins the tick again if tools would pass tissue that is not held. Such tools then make only a
// part of their motion; on the last attempt they do not move. The function returns false if there
// is no such tool, or no attempt left. cau_session_let_follow speeds up tools that were not held
// back in a tick.
enum { CAU_ATTEMPTS = 2 };
void cau_session_lead_tool(cau_session *session, cau_tool *tool, const cau_pose *asked_before);
void cau_session_lead_tool_on(cau_session *session, cau_tool *tool);
void cau_session_couple(cau_session *session);
void cau_session_take_poses(cau_session *session);
bool cau_session_hold_back(cau_session *session, int attempt);
void cau_session_let_follow(cau_session *session);
// touch.c: finds contact constraints, attachments and drag before the solve.
void cau_session_find_contacts(cau_session *session);
// Returns, after the solve, whether tissue is inside a tool at its contact constraints, or met a
// tool without having a constraint. Adds the missing constraints.
bool cau_session_find_missed(cau_session *session);
// Whether tissue diverged because faces were held: it moved farther than without these constraints,
// by more than a tip's width and the tip's own motion. Then the faces were not really held, even if
// they are outside the tool. All tools count as passing.
bool cau_session_find_thrown(cau_session *session);
// Restores the step as it was before the first missed face was found, and forgets all sides. So a
// tool passes where tissue cannot be held.
void cau_session_let_through(cau_session *session);

// touch.c, thin.c: a vertex near a tool, with its signed distance, m. If there are more vertices
// than CAU_MAX_TOUCHING, the deepest are listed.
enum { CAU_MAX_TOUCHING = 2048 };
typedef struct cau_touching {
	int32_t vertex, place; // place: position along the broad phase's Morton curve
	double gap;
} cau_touching;
// thin.c: the distance, m, from a tool within which tissue may touch it in a tick.
double cau_session_margin(const cau_tool_def *def);
// Moves the vertices that get a contact constraint to the front of the list. `taken` constraints
// exist already. Touching vertices may fill CAU_MAX_VERTEX_ROWS constraints in all, vertices that
// are only near CAU_NEAR_ROWS. The deepest come first, unless the choice is spread (thin.c).
// Returns the number of chosen vertices; *left_out gets the number of touching vertices without a
// constraint.
int32_t cau_session_thin(const cau_session *session, cau_touching *list, int32_t count,
                         int32_t taken, int32_t *left_out);

// Depth inside a tool beyond which a face counts as missed, as a share of the tip's radius.
static const double cau_missed_share = 0.5;
// reach.c: contact with faces.

// Returns the greatest distance, m, of a vertex from its position at the tick's start. The result
// is not a number if a position is not a number.
double cau_session_farthest(const cau_session *session);
// Whether a tool has contact with faces as well as with vertices. A grasping tool has no contact
// with faces, because tissue is between and inside its jaws.
bool cau_session_feels_faces(const cau_tool *tool);
// Whether the part may be within the margin, m, of any point of the box. It uses that the distance
// changes by at most the motion of the point.
bool cau_session_may_meet(const cau_tool *tool, cau_tool_part part, const cau_box *box,
                          double margin_m);
// Allocates the scratch memory of reach.c. NULL if memory ran out.
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
// grasp.c. hold_vertex returns a hold on a vertex. row_of_hold returns the contact constraint of a
// hold, without its anchor. hold_of_row returns the hold of a constraint, or NULL. hold_is_left
// returns whether the held vertex or face still exists.
cau_grasp cau_session_hold_vertex(int32_t vertex);
cau_contact_row cau_session_row_of_hold(const cau_session *session, const cau_grasp *grasp,
                                        int32_t tool);
cau_grasp *cau_session_hold_of_row(cau_tool *tool, const cau_contact_row *row);
bool cau_session_hold_is_left(const cau_session *session, const cau_grasp *grasp);
// Grasps the faces between the jaws that have no held corner.
void cau_session_grasp_faces(const cau_session *session, cau_tool *tool);
// pinch.c. begin_pinch is called when jaws have grasped. turn_jaws turns the jaws towards their
// commanded opening as a tick begins, as far as the held tissue permits, and moves the held tissue
// along. read_pinch reads the jaws' force after the solve.
void cau_session_begin_pinch(const cau_session *session, cau_tool *tool);
void cau_session_turn_jaws(cau_tool *tool, double step_s, double part);
void cau_session_read_pinch(cau_session *session, cau_tool *tool, int32_t index);
// meet.c: tissue contact. make_collide allocates its arrays if the scene has tissue contact.
// begin_collide finds the touching pairs as the tick begins, and filters the first guess by them.
cau_status cau_session_make_collide(cau_session *session, cau_error *error);
void cau_session_begin_collide(cau_session *session);
// electrosurgery.c: energy `tissue`. make_cells creates the cells if the scene has this energy.
// blade_of returns the blade of a tool that is added. operate computes power, heat and parting of a
// tick. has_cooled returns whether all tissue and tools have cooled down.
cau_status cau_session_make_cells(cau_session *session, cau_error *error);
cau_blade cau_session_blade_of(const cau_session *session, const cau_tool_def *def);
void cau_session_operate(cau_session *session);
bool cau_session_has_cooled(const cau_session *session);
// bleed.c. make_vessels creates the scene's vessels. look_at_vessels finds their present state, as
// after a restore. bleed advances seals, bleeding and blood by a tick. bleeds returns whether blood
// leaves a vessel or flows on the tissue.
cau_status cau_session_make_vessels(cau_session *session, cau_error *error);
void cau_session_look_at_vessels(cau_session *session);
void cau_session_bleed(cau_session *session);
bool cau_session_bleeds(const cau_session *session);
// burn.c. burn computes heat, exposure and parting with energy `paper`. end_burn follows with
// either energy, and shrinks the tissue beside removed elements.
void cau_session_burn(cau_session *session);
void cau_session_end_burn(cau_session *session);
// Removes the tick's removed elements, from number `first` on, from the local step. Queues them for
// removal from the factor.
void cau_session_take_out(cau_session *session, int32_t first);
// burn.c: tears elements that are stretched more than their layer permits.
void cau_session_tear(cau_session *session);
// relax.c: brings built-in tension to its equilibrium.
cau_status cau_session_relax(cau_session *session, cau_error *error);
// pins.c: sets the pinned vertices, and builds the systems that depend on them.
cau_status cau_session_set_pins(cau_session *session, const cau_selection *selection, int pin,
                                cau_error *error);
// Analyses and factors the system for session->vertices.pinned. The order of its rows depends on
// the pins only.
cau_status cau_session_rebuild_system(cau_session *session, cau_error *error);
// view.c. show_scalars computes the watched scalars of the vertices that changed in a tick.
// renew_scalars computes those of all vertices, after a restore.
void cau_session_show_scalars(cau_session *session);
void cau_session_renew_scalars(cau_session *session);
// tool_contact.c. watch_contact begins or ends the computation of the tools' contact.
// unwatch_contact frees its memory. forget_contact drops the last tick's result, as after a
// restore. read_contact computes the contact after a step, if it is watched. show_contact returns
// the records for a frame (tool_count), or NULL.
void cau_session_watch_contact(cau_session *session, bool watched);
void cau_session_unwatch_contact(cau_session *session);
void cau_session_forget_contact(cau_session *session);
void cau_session_read_contact(cau_session *session);
const cau_tool_contact *cau_session_show_contact(const cau_session *session);
// view.c: finds layer and texture coordinates of the faces.
cau_status cau_session_make_faces(cau_session *session, cau_error *error);
// pins.c: moves pinned vertices to the positions given by cau_session_drive, in this tick.
void cau_session_lead_driven(cau_session *session);
// possible.c. stop_strays stops vertices that have moved too far. size returns the diagonal of all
// tissue's box at rest, m.
void cau_session_stop_strays(cau_session *session);
double cau_session_size(const cau_session *session);
// Returns the greatest allowed distance of a vertex from its rest position, m.
double cau_session_farthest_from_rest(const cau_session *session);
// possible.c. make_inversion allocates its array. follow_inversion counts, after a tick's solve,
// the tetrahedra that stay inverted. is_inverted returns whether a tetrahedron's volume is 0 or
// less; `position` in m, (n x 3).
cau_status cau_session_make_inversion(cau_session *session, cau_error *error);
void cau_session_follow_inversion(cau_session *session);
void cau_session_forget_inversion(cau_session *session); // called after a restore
bool cau_session_is_inverted(const double *position, const int32_t vertex[4]);
// possible.c. make_watch allocates its arrays. check_motion refuses impossible motions of vertices
// and lengths of edges; check_inverted refuses too many inverted elements. The error is
// CAU_NUMERICAL, with the tick and the layer.
cau_status cau_session_make_watch(cau_session *session, cau_error *error);
cau_status cau_session_check_motion(cau_session *session, cau_error *error);
cau_status cau_session_check_inverted(const cau_session *session, cau_error *error);
// Adds the tick and the layer to the solver's refusal in *error.
cau_status cau_session_locate(const cau_session *session, cau_error *error);
// energy.c. make_energy allocates its arrays. begin_energy finds the elastic energy at a tick's
// start. end_energy finds the energy gain after the solve, before velocities are updated.
// mark_changed marks the elements that the tick has cut or shrinks.
cau_status cau_session_make_energy(cau_session *session, cau_error *error);
void cau_session_begin_energy(cau_session *session);
void cau_session_end_energy(cau_session *session);
void cau_session_mark_changed(cau_session *session);
// rest.c. make_rest allocates its array. rests returns whether the coming tick is a tick at rest;
// commands that are due wake the tissue. rest_tick makes a tick at rest. fall_asleep decides, at
// the end of any other tick, whether the tissue rests from the next tick on.
cau_status cau_session_make_rest(cau_session *session, cau_error *error);
bool cau_session_rests(cau_session *session);
cau_status cau_session_rest_tick(cau_session *session, cau_error *error);
void cau_session_fall_asleep(cau_session *session);
// spin.c. make_spin allocates its arrays. turn_prediction corrects the prediction of pieces that
// turn freely, after all vertices are predicted.
cau_status cau_session_make_spin(cau_session *session, cau_error *error);
void cau_session_turn_prediction(cau_session *session);
// Restores, after two substeps, the angular momentum of freely turning pieces to that at the tick's
// start, by changing v2. This is done only if no tool is near and no tissue touches tissue.
void cau_session_keep_momentum(cau_session *session);
// motion.c: factor from a tick's displacement to the velocity after it, 1/s (eq. 2 and damping).
double cau_session_velocity_scale(const cau_session *session);
// motion.c. predict finds s of eq. 4 before a solve. update_velocities sets the velocities after
// it.
void cau_session_predict(cau_session *session);
void cau_session_update_velocities(cau_session *session);
// step.c: computes plastic flow and counts inverted tetrahedra after a solve.
void cau_session_settle(cau_session *session);
// create.c: lists the pages of the session's large arrays, in the same order for equal scenes.
// Returns their count.
int32_t cau_session_pages(const cau_session *session, cau_pages pages[CAU_IMAGE_PARTS]);
// Measure the time of the stages of a step.
void cau_session_stage_begin(cau_session *session);
void cau_session_stage_end(cau_session *session, int stage);
// check.c: checks the values of a tool's definition.
cau_status cau_tool_check(const cau_tool_def *tool, const char *path, double step_s,
                          cau_error *error);
// Returns one of a layer's materials, of the layer's kind.
const void *cau_layer_material(const cau_layer_def *layer, int32_t index);
cau_status cau_material_check(int kind, const void *material, const char *path, cau_error *error);
cau_status cau_selection_check(const cau_selection *selection, const char *path, cau_error *error);
cau_status cau_pose_check(const cau_pose *pose, const char *path, cau_error *error);
