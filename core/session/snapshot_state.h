// SPDX-License-Identifier: GPL-3.0-or-later
// The content of a snapshot: counts and single numbers (the head), and the arrays with these sizes.
// The bytes are those of cau_snapshot_pass_head, then of cau_snapshot_pass_state, then a hash of
// both.
//
// A snapshot holds only what cannot be computed from the rest. The living elements follow from what
// has parted. The weights follow from materials and from the living elements. The last canonical
// factorisation had the elements that live, those that wait and those removed from the factor
// since.
#pragma once

#include "session/session_internal.h"
#include "session/snapshot_bytes.h"

enum {
	// Version 15 has the elements that cells move with, a tool's blade and load_rise_off. No
	// release wrote earlier versions, and none is read.
	CAU_SNAPSHOT_VERSION = 15,
	CAU_SNAPSHOT_HASH_BYTES = 8, // bytes of the hash at the end of the snapshot
	CAU_SNAPSHOT_ISA_BYTES = 16,
};

// Sizes of the arrays.
typedef struct snapshot_sizes {
	int32_t vertices, edges, tools, commands, active, columns, memory, over, waiting, operations;
} snapshot_sizes;

// The matrix update and the present factor (solve/matrix_update.h).
typedef struct snapshot_factor {
	uint64_t swap_tick, longest_wait, version;
	int32_t group_count, waiting_at_start, refactorisations;
	bool making;
} snapshot_factor;

// Values that the solver learned from steps (solve/accuracy.h).
typedef struct snapshot_learned {
	int32_t shallow_steps;
	double accuracy, amplification[CAU_ACCURACY_DEPTHS], force_left;
	double force_before[CAU_ACCURACY_TOOLS][3];
} snapshot_learned;

typedef struct snapshot_head {
	uint32_t version;
	bool single;
	char instruction_set[CAU_SNAPSHOT_ISA_BYTES];
	uint64_t build;           // hash of the compiler's version and the build date
	uint64_t definition_hash; // hash of the session's definition: create.c
	uint64_t tick;
	snapshot_sizes sizes;
	snapshot_factor factor;
	int32_t inverted, edges_parted, elements_removed, elements_torn, quiet_ticks;
	bool faulted, resting;
	double gravity_m_s2[3];
	snapshot_learned learned;
} snapshot_head;

// The vertices, sizes.vertices in number.
typedef struct snapshot_vertices {
	// 1 for a pinned vertex; 1 for a pinned or frozen vertex.
	uint8_t *pinned, *fixed;
	double *position, *velocity, *external; // (n x 3)
	double *diagonal;                       // N/m, (n): matrix A of the diagonal solver
	double *quiet_from;                     // m, (n x 3): positions when the quiet ticks began
	// (n): 1 for a vertex that was excluded from contact. Only with a contact thickness.
	uint8_t *exempt_before;
} snapshot_vertices;

// Exposure of the tissue to heat, and its parted edges and elements.
typedef struct snapshot_dissection {
	double *exposure; // (sizes.edges): exposure of each edge
	uint16_t *parted; // (sizes.edges): a bit for each layer in which the edge has parted
	double *dose;     // (dose_count): exposure of each element, if elements part one by one
	uint8_t *gone;    // (dose_count): 1 for a parted element
	cau_over *over;   // (sizes.over): elements loaded above their tear limit
} snapshot_dissection;

// The columns of contact (solve/contact.h), sizes.columns in number.
typedef struct snapshot_columns {
	int32_t *vertex;   // vertex of each column
	uint64_t *version; // factor version of each column
	cau_reals **whole; // the columns themselves, at most CAU_WHOLE_COLUMNS
	double *inverse;   // compliance matrix S of the columns, (CAU_MAX_COLUMNS x CAU_MAX_COLUMNS)
} snapshot_columns;

// The vessels, if the scene has any.
typedef struct snapshot_vessels {
	double *fusion;                  // (station_count): seal of each station
	double *blood_m3;                // (sizes.vertices): blood on the tissue
	double shed_m3[CAU_MAX_VESSELS]; // blood shed by each vessel
} snapshot_vessels;

// The arrays. For writing they are the session's own; for reading, copies of the same sizes.
typedef struct snapshot_state {
	snapshot_head head;
	snapshot_vertices vertices;
	snapshot_dissection dissection;
	uint8_t *shrunk[2];    // by triangle, by tetrahedron: 1 for a shrunk element
	cau_shrinking *active; // (sizes.active): elements that are shrinking
	cau_command *command;  // (sizes.commands): queued commands
	cau_layer_def *layer;  // (layer_count): the layers' materials
	// The elements' targets, rotations, plastic strain and marks.
	cau_elements elements;
	cau_waiting *waiting;       // (sizes.waiting): removed elements that are still in the factor
	cau_operation *operation;   // (sizes.operations): elements removed from the factor
	cau_tool *tool;             // (sizes.tools): the tools
	cau_contact_memory *memory; // (sizes.memory): faces that tools pushed
	snapshot_columns columns;
	cau_tissue_cells *cells; // the cells, with energy `tissue`
	snapshot_vessels vessels;
	cau_arena copies; // for reading: the memory of all copies
} snapshot_state;

// Returns the session's present state in *state. The arrays are borrowed, and writing does not
// change them. `layer` is the caller's array (layer_count), and is filled.
void cau_snapshot_view(const cau_session *session, cau_layer_def *layer, snapshot_state *state);

// Count, write or read the head and the arrays. Reading the arrays needs state->head for their
// sizes; their memory must be allocated.
void cau_snapshot_pass_head(snapshot_archive *archive, snapshot_head *head);
void cau_snapshot_pass_state(snapshot_archive *archive, const cau_session *session,
                             snapshot_state *state);
// Passes the tools' heat grids. They come last, because reading can create them only when the tools
// are known.
void cau_snapshot_pass_grids(snapshot_archive *archive, snapshot_state *state);

// Reads the whole snapshot into copies and checks its consistency, before the session is changed.
// Errors: CAU_CORRUPT, with the reason; CAU_NO_MEMORY. The caller drops the state, also after an
// error.
cau_status cau_snapshot_read(const cau_session *session, const void *bytes, size_t byte_count,
                             snapshot_state *state, cau_error *error);
void cau_snapshot_drop(snapshot_state *state);

// Returns the hash of `count` bytes: the head and the arrays.
uint64_t cau_snapshot_hash(const void *bytes, size_t count);

// Whether a session restored from the snapshot continues with the same bits as the session that
// wrote it.
bool cau_snapshot_is_exact(const cau_session *session, const snapshot_head *head);

// ---- snapshot_records.c: records that are not plain arrays, member by member

// Passes a tool without its heat grid. `session` has the tissue that the tool holds.
void cau_snapshot_pass_tool(snapshot_archive *archive, const cau_session *session, cau_tool *tool);
// Passes origin and temperatures of a created grid.
void cau_snapshot_pass_grid(snapshot_archive *archive, cau_heat_grid *grid);
// Passes a waiting command. Only the values of its kind are passed; reading sets all other values
// to zero.
void cau_snapshot_pass_command(snapshot_archive *archive, cau_command *command);
// Passes the materials of a layer, of the layer's kind.
void cau_snapshot_pass_layer(snapshot_archive *archive, cau_layer_def *layer);
