// SPDX-License-Identifier: GPL-3.0-or-later
// What a snapshot holds: counts and single numbers (the head), and the arrays that these measure.
// The layout of the bytes is cau_snapshot_pass_head and cau_snapshot_pass_state, in that order,
// then the hash of all of it.
//
// A snapshot holds only what cannot be found from the rest. Which elements live follows from what
// has parted; weights follow from materials and from that; the elements of the last canonical
// factorisation are those that live, those that wait and those that were taken out of the factor.
#pragma once

#include "session/session_internal.h"
#include "session/snapshot_bytes.h"

enum {
	// 15: the elements that cells move with, a tool's blade and load_rise_off. No release wrote
	// earlier
	// versions, and none is read.
	CAU_SNAPSHOT_VERSION = 15,
	CAU_SNAPSHOT_HASH_BYTES = 8, // the last
	CAU_SNAPSHOT_ISA_BYTES = 16,
};

typedef struct snapshot_head {
	uint32_t version;
	bool single;
	char instruction_set[CAU_SNAPSHOT_ISA_BYTES];
	uint64_t build;           // hash of the compiler's own words
	uint64_t definition_hash; // create.c
	uint64_t tick, swap_tick, longest_wait, factor_version;
	int32_t vertex_count, edge_count;
	int32_t tool_count, command_count, active_count, column_count, memory_count, over_count;
	int32_t waiting_count, operation_count, group_count, waiting_at_start;
	int32_t refactorisations, inverted, edges_parted, elements_removed, elements_torn, quiet_ticks;
	bool making, faulted, resting;
	double gravity_m_s2[3];
	int32_t shallow_steps; // what steps have taught: solve/accuracy.h
	double accuracy, amplification[CAU_ACCURACY_DEPTHS], force_left;
	double force_before[CAU_ACCURACY_TOOLS][3];
} snapshot_head;

// The arrays: a session's own, to be written, or copies of the same sizes, to be read into.
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
	cau_layer_def *layer;                   // (layer_count): its materials
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
	cau_arena copies;                       // read: what all of this lies in
} snapshot_state;

// Of the session as it is. The arrays are borrowed; writing does not change them. `layer` is the
// caller's, (layer_count), and is filled.
void cau_snapshot_view(const cau_session *session, cau_layer_def *layer, snapshot_state *state);

// Head and arrays, as counted, written or read. Reading needs state->head for the sizes of the
// arrays, which must be there already.
void cau_snapshot_pass_head(snapshot_archive *archive, snapshot_head *head);
void cau_snapshot_pass_state(snapshot_archive *archive, const cau_session *session,
                             snapshot_state *state);
// The tools' heat grids come last: reading makes them once it knows the tools.
void cau_snapshot_pass_grids(snapshot_archive *archive, snapshot_state *state);

// Reads all of it into copies of its own, and checks what goes together, before anything of the
// session is touched. CAU_CORRUPT, with what is wrong; CAU_NO_MEMORY. The caller drops the state,
// on failure too.
cau_status cau_snapshot_read(const cau_session *session, const void *bytes, size_t byte_count,
                             snapshot_state *state, cau_error *error);
void cau_snapshot_drop(snapshot_state *state);

// Hash of `count` bytes of head and arrays.
uint64_t cau_snapshot_hash(const void *bytes, size_t count);

// Whether a session restored from it goes on with the bits of the one that wrote it.
bool cau_snapshot_is_exact(const cau_session *session, const snapshot_head *head);
