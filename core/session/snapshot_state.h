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

typedef struct snapshot_head {
	uint32_t version;
	bool single;
	char instruction_set[CAU_SNAPSHOT_ISA_BYTES];
	uint64_t build;           // hash of the compiler's version and the build date
	uint64_t definition_hash; // hash of the session's definition: create.c
	uint64_t tick, swap_tick, longest_wait, factor_version;
	int32_t vertex_count, edge_count;
	int32_t tool_count, command_count, active_count, column_count, memory_count, over_count;
	int32_t waiting_count, operation_count, group_count, waiting_at_start;
	int32_t refactorisations, inverted, edges_parted, elements_removed, elements_torn, quiet_ticks;
	bool making, faulted, resting;
	double gravity_m_s2[3];
	// From here on: values that the solver learned from steps (solve/accuracy.h).
	int32_t shallow_steps;
	double accuracy, amplification[CAU_ACCURACY_DEPTHS], force_left;
	double force_before[CAU_ACCURACY_TOOLS][3];
} snapshot_head;

// The arrays. For writing they are the session's own; for reading, copies of the same sizes.
typedef struct snapshot_state {
	snapshot_head head;
	// (vertex_count): 1 for a pinned vertex; 1 for a pinned or frozen vertex.
	uint8_t *pinned, *fixed;
	double *position, *velocity, *external; // (vertex_count x 3)
	double *diagonal;                       // N/m, (vertex_count): matrix A of the diagonal solver
	double *exposure;                       // (edge_count): exposure of each edge
	// (edge_count): a bit for each layer in which the edge has parted.
	uint16_t *parted;
	// (dose_count): exposure of each element, if elements part one by one.
	double *dose;
	uint8_t *gone;         // (dose_count): 1 for a parted element
	uint8_t *shrunk[2];    // by triangle, by tetrahedron: 1 for a shrunk element
	cau_shrinking *active; // (active_count): elements that are shrinking
	cau_command *command;  // (command_count): queued commands
	cau_layer_def *layer;  // (layer_count): the layers' materials
	// The elements' targets, rotations, plastic strain and marks.
	cau_elements elements;
	// (waiting_count): removed elements that are still in the factor.
	cau_waiting *waiting;
	cau_operation *operation;   // (operation_count): elements removed from the factor
	cau_tool *tool;             // (tool_count): the tools
	cau_contact_memory *memory; // (memory_count): faces that tools pushed
	cau_over *over;             // (over_count): elements loaded above their tear limit
	int32_t *column_vertex;     // (column_count): vertex of each contact column
	uint64_t *column_version;   // (column_count): factor version of each contact column
	cau_reals **column;         // the columns themselves, at most CAU_WHOLE_COLUMNS
	// Compliance matrix S of the columns, (CAU_MAX_COLUMNS x CAU_MAX_COLUMNS).
	double *inverse;
	// m, (vertex_count x 3): positions when the quiet ticks began.
	double *quiet_from;
	// (vertex_count): 1 for a vertex that was excluded from contact. Only with a contact thickness.
	uint8_t *exempt_before;
	cau_tissue_cells *cells;         // the cells, with energy `tissue`
	double *fusion;                  // (station_count): seal of each station, with vessels
	double *blood_m3;                // (vertex_count): blood on the tissue, with vessels
	double shed_m3[CAU_MAX_VESSELS]; // blood shed by each vessel, with vessels
	cau_arena copies;                // for reading: the memory of all copies
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
