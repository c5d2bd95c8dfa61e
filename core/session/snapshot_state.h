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
	CAU_SNAPSHOT_HASH_BYTES = 8, // at the end of the snapshot
	CAU_SNAPSHOT_ISA_BYTES = 16,
};

typedef struct snapshot_head {
	uint32_t version;
	bool single;
	char instruction_set[CAU_SNAPSHOT_ISA_BYTES];
	uint64_t build;           // hash of the compiler's version and the build date
	uint64_t definition_hash; // create.c
	uint64_t tick, swap_tick, longest_wait, factor_version;
	int32_t vertex_count, edge_count;
	int32_t tool_count, command_count, active_count, column_count, memory_count, over_count;
	int32_t waiting_count, operation_count, group_count, waiting_at_start;
	int32_t refactorisations, inverted, edges_parted, elements_removed, elements_torn, quiet_ticks;
	bool making, faulted, resting;
	double gravity_m_s2[3];
	int32_t shallow_steps; // what the solver learned from steps: solve/accuracy.h
	double accuracy, amplification[CAU_ACCURACY_DEPTHS], force_left;
	double force_before[CAU_ACCURACY_TOOLS][3];
} snapshot_head;

// The arrays. For writing they are the session's own; for reading, copies of the same sizes.
typedef struct snapshot_state {
	snapshot_head head;
	uint8_t *pinned, *fixed;                // (vertex_count)
	double *position, *velocity, *external; // (vertex_count x 3)
	double *diagonal;                       // N/m, (vertex_count)
	double *exposure;                       // (edge_count)
	uint16_t *parted;                       // (edge_count)
	double *dose;                           // (dose_count)
	uint8_t *gone;                          // (dose_count)
	uint8_t *shrunk[2];                     // by triangle, by tetrahedron
	cau_shrinking *active;                  // (active_count)
	cau_command *command;                   // (command_count)
	cau_layer_def *layer;                   // (layer_count): the layers' materials
	cau_elements elements;                  // targets, rotations, plastic strain, marks
	cau_waiting *waiting;                   // (waiting_count)
	cau_operation *operation;               // (operation_count)
	cau_tool *tool;                         // (tool_count)
	cau_contact_memory *memory;             // (memory_count)
	cau_over *over;                         // (over_count)
	int32_t *column_vertex;                 // (column_count)
	uint64_t *column_version;               // (column_count)
	cau_reals **column;                     // (column_count, CAU_WHOLE_COLUMNS at most)
	double *inverse;                        // (CAU_MAX_COLUMNS x CAU_MAX_COLUMNS)
	double *quiet_from;                     // m, (vertex_count x 3)
	uint8_t *exempt_before;                 // (vertex_count), with a contact thickness
	cau_tissue_cells *cells;                // with energy `tissue`
	double *fusion;                         // (station_count), with vessels
	double *blood_m3;                       // (vertex_count), with vessels
	double shed_m3[CAU_MAX_VESSELS];        // with vessels
	cau_arena copies;                       // for reading: the memory of all copies
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

// Hash of `count` bytes, the head and the arrays.
uint64_t cau_snapshot_hash(const void *bytes, size_t count);

// Whether a session restored from the snapshot continues with the same bits as the session that
// wrote it.
bool cau_snapshot_is_exact(const cau_session *session, const snapshot_head *head);
