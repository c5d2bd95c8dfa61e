// SPDX-License-Identifier: GPL-3.0-or-later
// A tissue session: the whole interface of Cautery's core.
//
//     #include "cautery/session.h"
//
//     // Runs a checked scene for `ticks` ticks; the highest vertex at their end, m.
//     static cau_status run(const cau_scene_def *scene, int ticks, double *highest_m,
//                           cau_error *error)
//     {
//         cau_session_def def = cau_default_session_def();
//         cau_session *session = NULL;
//         cau_session_info info;
//         cau_frame frame;
//         def.scene = scene; // protocol reads it from JSON
//         cau_status status = cau_session_create(&def, &session, error);
//         if (status)
//             return status; // error says what is wrong, and where
//         for (int tick = 0; tick < ticks && !status; tick++)
//             status = cau_session_step(session, error); // commands: cau_session_submit
//         cau_session_describe(session, &info);
//         cau_session_frame(session, &frame); // what to draw, valid until the next step
//         *highest_m = frame.position[2];
//         for (int v = 1; v < info.vertex_count; v++)
//             if (frame.position[3 * v + 2] > *highest_m)
//                 *highest_m = frame.position[3 * v + 2];
//         cau_session_destroy(session);
//         return status;
//     }
//
// A session is used from one thread at a time; several sessions may be used from several threads.
// Determinism: the same definition and the same commands at the same ticks give the same bits, for
// one build and one instruction-set tier. thread_count and other work of the machine have no
// influence.
#pragma once

#include <stdbool.h>

#include "cautery/channels.h"
#include "cautery/command.h"
#include "cautery/defaults.h" // cau_default_*_def(): definitions with every member at its default
#include "cautery/energy_off.h"
#include "cautery/mesh_scene.h"
#include "cautery/scene.h"
#include "cautery/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cau_session cau_session; // one simulated tissue with its tools; opaque

// ---- definition -------------------------------------------------------------------------------
// The stages of creating a session, in this order. A stage cannot be interrupted. Before each stage
// the session calls `border`.
#define CAU_BUILD_STAGE_TABLE(X)                                                                   \
	X(MESH, "meshing")     /* meshes, layers, edges */                                             \
	X(ORDER, "ordering")   /* the system's pattern, its order and the factor's size */             \
	X(FACTOR, "factoring") /* the factor's numbers */                                              \
	X(REST, "settling")    /* built-in tension brought to its equilibrium */
// Number of a stage of the creation.
typedef enum cau_build_stage {
#define X(code, name) CAU_BUILD_##code,
	CAU_BUILD_STAGE_TABLE(X)
#undef X
		CAU_BUILD_STAGE_COUNT
} cau_build_stage;

// Known facts before the stage `next` begins. A count that is not known yet is 0.
typedef struct cau_build_border {
	cau_build_stage next;   // the stage that begins
	int64_t vertex_count;   // vertices of all meshes
	int64_t element_count;  // number of triangles, tetrahedra, links and hinges
	int64_t factor_entries; // entries of the factor, from its analysis; known from FACTOR on
	size_t bytes;           // estimated memory of the session, rough before FACTOR
} cau_build_border;

// Input of cau_session_create.
typedef struct cau_session_def {
	const cau_scene_def *scene; // borrowed until cau_session_create returns
	int32_t thread_count;       // threads used by a step, 1 to 16, including the caller's
	// Largest number of queued commands; further commands are refused with CAU_LIMIT.
	int32_t command_capacity;
	// Skips the stage REST, which usually takes longest, because a snapshot will be restored. The
	// session is faulted until a restore succeeds.
	bool unsettled;
	// Called before each stage, on the creating thread. Any result but CAU_OK ends the creation
	// with that status and *error.
	// May be NULL.
	cau_status (*border)(void *user, const cau_build_border *border, cau_error *error);
	void *user; // passed to `border`
	const char
		*instruction_set; // highest tier to use: "baseline", "avx2", "avx512"; NULL: the best
} cau_session_def;

// Returns a definition with every member at its default; `scene` is NULL.
cau_session_def cau_default_session_def(void);

// Checks every range, name and reference of a scene without building anything. The path in *error
// is the JSON path.
cau_status cau_scene_check(const cau_scene_def *scene, cau_error *error);

// ---- life ---------------------------------------------------------------------------------------
// Loads meshes, builds layers, factors the system and relaxes built-in tension to rest
// (core/DECISIONS.md, "Built-in tension"). The caller destroys *session. On an error *session is
// unchanged. Errors: CAU_BAD_VALUE, CAU_NOT_FOUND, CAU_BAD_MESH, CAU_IO, CAU_LIMIT, CAU_NO_MEMORY,
// CAU_NUMERICAL, and the status that `border` returned.
cau_status cau_session_create(const cau_session_def *def, cau_session **session, cau_error *error);
void cau_session_destroy(cau_session *session); // session may be NULL

// Whether the session's scene has built-in tension. Creation brings the tissue to rest, unless the
// session was created `unsettled`.
bool cau_session_has_tension(const cau_session *session);
// Returns a hash of the built meshes and of each element's material. Two sessions of equal scenes
// with an equal hash come to rest with the same bits.
uint64_t cau_session_tissue_hash(const cau_session *session);

// Shares memory with other sessions of equal tissue in this program that also called this function.
// Pages with equal bytes exist once; pages of zeros take no memory and are not counted. The first
// write to a shared page copies the page for the writer. Steps, results and hashes do not change.
// Call the function once, before the first step. Returns the number of bytes shared now; writes
// reduce it. Returns 0 if the system has no such memory.
size_t cau_session_share(cau_session *session);

// Creates the session's helper threads again, as threads of the caller, so that they have the
// priority of the thread that steps the session. First waits for their present work. Errors:
// CAU_NO_MEMORY.
cau_status cau_session_adopt(cau_session *session, cau_error *error);
// Sets the number of threads, 1 to 16, that steps use from now on. Results do not depend on the
// number.
void cau_session_set_threads(cau_session *session, int32_t thread_count);

// Queues a copy of the command. Errors: CAU_BAD_VALUE, CAU_NOT_FOUND (no such tool or layer),
// CAU_LIMIT (the queue is full). A command can also be refused at its tick, for example because its
// tool was removed meanwhile. Such refusals are in the frame.
cau_status cau_session_submit(cau_session *session, const cau_command *command, cau_error *error);

// Whether cau_session_submit would accept all of the commands, one after the other. Changes
// nothing. On an error *index is the first command that would be refused. Errors: as
// cau_session_submit.
cau_status cau_session_may_submit(const cau_session *session, const cau_command *commands,
                                  int32_t count, int32_t *index, cau_error *error);

// cau_session_energy_off and cau_session_hold_still cannot fail and need no capacity in the queue.
// They act at once; call them between steps. `sequence` becomes the sequence number of the tool's
// last applied command; 0 keeps the present number. If no tool has the name, they have no effect.

// Turns the tool's energy off. Removes the tool's queued enables and the queued ends of enables.
void cau_session_energy_off(cau_session *session, const char *tool, uint64_t sequence);
// Makes the tool's actual pose its commanded pose. Removes all queued commands about the tool.
void cau_session_hold_still(cau_session *session, const char *tool, uint64_t sequence);
// Returns the number of queued commands about the tool.
int32_t cau_session_waiting(const cau_session *session, const char *tool);
// Returns the name of the first tool that a step may heat and that is not among the `count` allowed
// names. A step may heat a tool if its energy is on, or if a queued command would turn it on. NULL:
// no such tool. The name is borrowed until the next call that changes the session.
const char *cau_session_heats_beyond(const cau_session *session, const char *const *allowed,
                                     int32_t count);

// Moves the pinned vertices `vertex` (count) to `position` (m, count x 3) during the next step, and
// leaves them there: a prescribed displacement. A later call before that step replaces this one.
// This is not a command: it is neither queued nor part of a snapshot. Errors: CAU_BAD_STATE, with a
// vertex that is not pinned.
cau_status cau_session_drive(cau_session *session, int32_t count, const int32_t *vertex,
                             const double *position, cau_error *error);

// Advances the session by one tick. Errors: CAU_NUMERICAL, after which the session is faulted;
// CAU_FAULTED, while it is faulted. A successful restore ends the fault.
cau_status cau_session_step(cau_session *session, cau_error *error);

// ---- constant parts of a session ----------------------------------------------------------------
// One layer of a session.
typedef struct cau_session_layer {
	char name[CAU_NAME_BYTES]; // the layer's name in the scene
	int32_t kind;              // a CAU_LAYER_* kind
	// Range of the layer's faces in the face list. FAT: each face of the tetrahedra once. LINKS
	// have no faces.
	int32_t first_face, face_count;
	int32_t element_count; // number of triangles, tetrahedra or links
} cau_session_layer;

// The constant parts of a session. Pointers are borrowed for the session's life.
typedef struct cau_session_info {
	char name[CAU_NAME_BYTES];        // the scene's name
	char description[CAU_TEXT_BYTES]; // the scene's description
	double step_s;                    // length of a tick
	int32_t vertex_count;             // vertices of the whole tissue
	int32_t face_count;               // all faces, drawn and hidden
	// Numbers at creation.
	int32_t triangle_count, tetrahedron_count, link_count, hinge_count, edge_count;
	int32_t layer_count;                      // number of layers, at most CAU_MAX_LAYERS
	cau_session_layer layers[CAU_MAX_LAYERS]; // (layer_count): the layers, in the scene's order
	// Vertices of each face, (face_count x 3); borrowed for the session's life.
	const int32_t *face;
	const int32_t *face_layer;   // layer of each face, (face_count)
	const double *rest_position; // m, (vertex_count x 3)
	const float *texture;        // (face_count x 3 x 2): UV of fascia and membrane corners, or NULL
	const int32_t *tetrahedron;  // vertices, (tetrahedron_count x 4), for export
	const int32_t *link;         // vertices, (link_count x 2)
	const char *instruction_set; // tier in use: "avx512", "avx2" or "baseline"
	const cau_mesh_report *mesh_report; // a report for each of the scene's meshes
} cau_session_info;

// Fills *info with the session's constant parts.
void cau_session_describe(const cau_session *session, cau_session_info *info);

// Updates `scene`, a copy of the session's definition, with the changes by commands: gravity,
// materials and tools, as they will be once the queued commands have acted. Tools have their
// present poses.
void cau_session_present(const cau_session *session, cau_scene_def *scene);

// ---- results of a tick --------------------------------------------------------------------------
// The state of a tool after a step.
typedef struct cau_tool_state {
	char name[CAU_NAME_BYTES]; // the tool's name
	cau_tool_def definition;   // as added, or as last configured
	cau_pose pose;             // actual pose: tissue can stop the tool
	double jaw;                // actual opening, 0 closed to 1 open: held tissue can stop the jaws
	bool energized;            // energy is on
	bool grasping;             // the jaws are commanded closed on tissue
	bool slipping;             // some of the held tissue slid in the last step
	int32_t grasped_vertices;  // held points, also of faces; 0 while grasping: the jaws are empty
	int32_t contact_vertices;  // number of contact constraints at vertices
	// A bit for each layer of which the tool parted something in the last step.
	int32_t touched_layers;
	// Force of the tissue on the tool and torque about its tip, filtered with force_filter_s. The
	// force is force_max_n at most, the torque force_max_n * tip_length_m.
	double force_n[3];
	double torque_nm[3]; // torque about the tip, N m
	// The same force and torque without filter and bound. Both pairs belong to the step that ended
	// at this tick.
	double raw_force_n[3];
	double raw_torque_nm[3];  // torque about the tip, N m
	double tip_temperature_c; // temperature of the hot part
	// Estimate of the heat that tissue took up; with energy `tissue`, the sum of delivered_w over
	// time.
	double energy_j;
	uint64_t sequence; // sequence number of the last applied command
	// Commanded pose, within the speed limits. The tool is pulled towards it with at most
	// force_max_n.
	cau_pose asked_pose;
	// Times that the tool was so far behind that it released the tissue that stopped it.
	int32_t slips;
	int32_t unused; // always 0
	// Commanded opening of the jaws, within their speed; and force of the jaws on the held tissue,
	// N at the tips, at most close_force_n.
	double asked_jaw, jaw_force_n;
	// With energy `tissue`, in the last tick: power given to tissue, W, and load, ohm, or 0.
	double delivered_w, load_ohm;
} cau_tool_state;

// Statistics of the last step.
typedef struct cau_statistics {
	// Time of each stage of the last step, s, see CAU_STAGE_TABLE; filled if timing is on.
	double seconds[8];
	int32_t iterations; // iterations of the last step
	double residual;    // relative residual after the last iteration
	int32_t backtracks; // increments that were refused because they raised the objective
	int32_t inverted;   // tetrahedra with negative volume after the step
	// By layer of the scene: number of tetrahedra that have been inverted for half a second. Such a
	// tetrahedron seldom recovers. The usual cause is the material's law (StVK) or its strain
	// limit.
	int32_t long_inverted[CAU_MAX_LAYERS];
	int32_t edges_parted;      // edges parted since creation
	int32_t elements_removed;  // elements removed since creation
	int32_t elements_torn;     // those of the removed elements that were torn by stretch
	int32_t pending_downdates; // removed elements that are still in the factor
	// Longest time that a removed element has stayed in the factor, in simulated seconds.
	double deferred_max_s;
	int32_t refactorisations;  // factorisations computed again since creation
	int32_t factor_operations; // changes of the factor since its last canonical factorisation
	// Contact constraints of the last step: vertices that are held or near tools, and faces.
	int32_t contacts;
	// Vertices and faces at a tool beyond the capacity for contact constraints. If it is not 0, the
	// step is not accurate, and a tool may be too deep in tissue.
	int32_t contacts_left_out;
	// Number of two events of tissue contact in the last step. First event: more pairs than the
	// capacity; tissue then moves less than it should, and none crosses. Second event: tissue
	// diverged, or too much of it was inverted; such tissue was then excluded from contact.
	int32_t touching_cut_short;
	// Vertices without a living element, or stopped far away; they do not move.
	int32_t frozen_vertices;
	// Energy that the step added without a source, J: kinetic, elastic and gravitational energy at
	// its end less those at its start, and less the work of tools, moved supports and commanded
	// forces. Changes by cuts, shrinkage and commands between steps do not count. Plastic flow
	// counts as loss. In a converged step the value is 0 or less, except for rounding (and
	// buckling). It is 0 if a law has no energy (linearised limits, model energy, the diagonal
	// system).
	double energy_gain_j;
	// Reference for the energy gain, J: elastic and kinetic energy at the start of the step, and
	// the absolute work of gravity, tools, moved supports and forces in it.
	double energy_scale_j;
	// Reported error: the step's estimated distance to its solution, relative to its own motion; of
	// all vertices, or of the worst chunk of them (solve/accuracy.h). Where tissue moves, it is at
	// least a fifth of the scene's accuracy. It is 0 if the scene's accuracy is 0.
	double error;
	// The tissue is at rest: the step changed nothing, and no step will until something wakes the
	// tissue.
	bool resting;
} cau_statistics;

// The stages of a step, in the order of cau_statistics.seconds.
#define CAU_STAGE_TABLE(X)                                                                         \
	X(COMMANDS, "commands")                                                                        \
	X(PREDICT, "predict")                                                                          \
	X(LOCAL, "local")                                                                              \
	X(GLOBAL, "global")                                                                            \
	X(CONTACT, "contact")                                                                          \
	X(HEAT, "heat")                                                                                \
	X(DISSECT, "dissect")                                                                          \
	X(FRAME, "frame")
// Number of a stage of a step.
typedef enum cau_stage {
#define X(code, name) CAU_STAGE_##code,
	CAU_STAGE_TABLE(X)
#undef X
		CAU_STAGE_COUNT
} cau_stage;

// A view into the session after a step: borrowed, valid until the next call that changes the
// session.
typedef struct cau_frame {
	uint64_t tick;                   // steps since creation
	double time_s;                   // simulated time
	const double *position;          // m, (vertex_count x 3)
	const double *velocity;          // m/s, (vertex_count x 3)
	int32_t moved_count;             // vertices whose position changed in this step
	const int32_t *moved;            // (moved_count), ascending
	const uint32_t *face_mask;       // (face_count + 31) / 32 words; a set bit hides the face
	int32_t mask_changed_count;      // words that changed in this step
	const int32_t *mask_changed;     // (mask_changed_count), ascending
	const uint8_t *vertex_visible;   // (vertex_count): 1 if on a drawn face
	CAU_SCALAR_MEMBERS(const float); // (vertex_count) each, in the channel's unit; NULL for a
	                                 // costly channel that is not watched
	int32_t tool_count;              // number of tools, at most CAU_MAX_TOOLS
	const cau_tool_state *tools;     // (tool_count): the tools' states
	int32_t vessel_count;            // number of vessels, at most CAU_MAX_VESSELS
	const cau_vessel_state *vessels[CAU_MAX_VESSELS]; // (vessel_count), in the scene's order
	const cau_tool_contact *contacts;                 // (tool_count), by tool; NULL: not watched
	int32_t refusal_count;                            // commands refused at their tick in this step
	const cau_error *refusals;                        // (refusal_count): reason of each refusal
	cau_statistics statistics;                        // statistics of this step
} cau_frame;

// Fills *frame with the state after the last step.
void cau_session_frame(const cau_session *session, cau_frame *frame);

// Turns stage timing on with the caller's clock `now_s` (s), or off with NULL, the default.
void cau_session_set_clock(cau_session *session, double (*now_s)(void));
// Sets the watched channels: CAU_CHANNEL_* bits of scalars and of tool_contact. Other bits are
// ignored; no channel is watched by default. Watched scalars that need extra work are computed at
// once, and after each step. The contact of tools is computed after each step that is not at rest,
// and is invalid before. Watching does not change any step.
void cau_session_watch(cau_session *session, uint32_t channels);

// Gives, for export, which elements exist, as bytes 0 or 1 (tetrahedron_count), (triangle_count),
// (link_count). The arrays are borrowed until the next call that changes the session.
void cau_session_alive(const cau_session *session, const uint8_t **tetrahedron,
                       const uint8_t **triangle, const uint8_t **link);

// Removed and damaged tissue, in volumes at rest. Links have no volume.
typedef struct cau_damage {
	int32_t removed_count; // number of removed tetrahedra and triangles
	double removed_m3;     // their volume at rest; of a triangle: area times thickness
	// Sum over the elements that are left: volume at rest times mean exposure of the vertices, m^3.
	double damaged_m3;
} cau_damage;
// Measures the damage inside and outside a region (CAU_SELECT_BOX or CAU_SELECT_SPHERE; its `layer`
// is not read). An element is inside if its middle is inside while the tissue is at rest.
void cau_session_damage(const cau_session *session, const cau_selection *region, cau_damage *inside,
                        cau_damage *outside);

// ---- snapshots

// A snapshot is the whole state at a tick border with the queued commands. A snapshot contains its
// version, the instruction set and a hash of the definition. Steps after a restore give the same
// bits as steps without it.
size_t cau_session_snapshot_bytes(const cau_session *session); // upper bound of a snapshot's size
// Writes a snapshot into the caller's bytes. Errors: CAU_LIMIT (capacity).
cau_status cau_session_snapshot(const cau_session *session, void *bytes, size_t capacity,
                                size_t *byte_count, cau_error *error);
// Restores a snapshot. *exact is false if another instruction set or build wrote the snapshot.
// Errors: CAU_CORRUPT (damaged, of another session or of another version): the session is
// unchanged. CAU_NO_MEMORY, CAU_NUMERICAL: the session may be half restored, and is faulted until a
// restore succeeds.
cau_status cau_session_restore(cau_session *session, const void *bytes, size_t byte_count,
                               bool *exact, cau_error *error);

// Returns a hash of the whole state (positions, velocities, heat, exposure, removed elements,
// tools).
uint64_t cau_session_hash(const cau_session *session);

// The energy ledger: where the energy of instruments went since creation, J
// (core/bioheat/README.md). delivered_j + blade_j equals stored_j + boiled_j + perfused_j +
// ambient_j + shed_j. All members are 0 with energy `paper`.
typedef struct cau_energy_ledger {
	double delivered_j; // heat of currents in tissue
	double far_j;       // heat of currents beyond the cells; not part of the sum
	double blade_j;     // heat from blades into tissue; below 0: from tissue into blades
	double stored_j;    // heat content of the tissue above ambient temperature
	double boiled_j;    // carried away by water that boiled off
	double perfused_j;  // carried away by blood
	double ambient_j;   // lost to the surroundings at surfaces
	double shed_j;      // heat content of tissue that was removed
} cau_energy_ledger;
// Writes the session's energy ledger to *ledger.
void cau_session_read_ledger(const cau_session *session, cau_energy_ledger *ledger);
// Returns the volume, m^3 at rest, of tissue that exists and was killed by heat (damage of 1 or
// more). 0 with energy `paper`. Divided by the area of a cut, this is the mean width of the
// coagulated tissue beside it.
double cau_session_coagulated(const cau_session *session);
// Returns the volume, m^3 at rest, of removed tissue that had lost at least half of its water.
// Sparks removed it, or it was removed with its element. 0 with energy `paper`. Divided by the
// severed area, this is the mean width of the kerf.
double cau_session_vaporised(const cau_session *session);
// Returns the rate at which water boiled off in the last step, kg/s. Its vapour is the source of
// smoke. 0 with energy `paper`, and from a restore to the next step.
double cau_session_vapour(const cau_session *session);

// Total mechanical quantities, for tests and plots.
typedef struct cau_balance {
	double momentum[3];          // kg m/s
	double net_force[3];         // sum of internal forces, N
	double net_torque[3];        // torque of internal forces about the origin, N m
	double force_sum;            // sum of |f_i|, N
	double torque_sum;           // sum of |r_i| |f_i|, N m
	double kinetic_j, elastic_j; // energies
	double gravitational_j;      // above the world's origin
	// |gradient of eq. 4| over the free vertices at the last step's end.
	double residual_n;
} cau_balance;
// Computes the total quantities. Changes no bit of the state. CAU_NO_MEMORY: *balance is all 0.
cau_status cau_session_balance(cau_session *session, cau_balance *balance);

#ifdef __cplusplus
}
#endif
