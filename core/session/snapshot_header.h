// SPDX-License-Identifier: GPL-3.0-or-later
// What stands at the beginning of a snapshot: which build wrote it, of which tissue, every count
// that its payload needs, and a hash of both.
#pragma once

#include "session/session_internal.h"

enum {
	// 9 has what touches no tissue. Still read are 8, without it; 7, without jaws that stop at what
	// they hold; 6, without columns
	// of A^-1 of which only S is kept; 5, without nested heat fields, tears, what materials bear,
	// what tools' forces have taught and the poses that tools are asked to take; 4, without the
	// sides of faces; 3, without rest and accuracy; 1, elements by slot.
	CAU_SNAPSHOT_VERSION = 9,
	CAU_SNAPSHOT_EXEMPT = 9,   // the first with what touches no tissue
	CAU_SNAPSHOT_JAWS = 8,     // the first with jaws that stop at what they hold
	CAU_SNAPSHOT_WIDE = 7,     // the first with columns of S alone
	CAU_SNAPSHOT_NESTED = 6,   // the first with nested heat fields
	CAU_SNAPSHOT_NODES = 4096, // along a heat grid's side at most: far more than a tool may have
};

typedef struct snapshot_header {
	char magic[8];
	uint32_t version;
	uint32_t single;
	char instruction_set[16];
	uint64_t build;           // hash of the compiler's own words
	uint64_t definition_hash; // create.c
	uint64_t hash;            // of the header with this member 0, then the payload
	uint64_t payload_bytes;
	uint64_t tick, swap_tick, longest_wait, factor_version;
	int32_t vertex_count, edge_count, row_count;
	int32_t tool_count, command_count, active_count, column_count;
	int32_t waiting_count, operation_count, group_count, waiting_at_start;
	int32_t making, refactorisations, frozen_count, inverted, edges_parted, elements_removed;
	int32_t grid_nodes[CAU_MAX_TOOLS];
	int32_t faulted;
	double gravity_m_s2[3];
	// since version 4
	int32_t resting, quiet_ticks;
	int32_t shallow_steps, unused;
	double accuracy, amplification[CAU_ACCURACY_DEPTHS];
	// since version 5
	int32_t memory_count, unused_since_5;
	// since version 6
	double force_left, force_before[CAU_ACCURACY_TOOLS][3];
	int32_t over_count, elements_torn; // tears
} snapshot_header;

// What all versions' headers have, the version and payload_bytes among it.
size_t cau_snapshot_common_bytes(void);

// How long the header of a snapshot of byte_count bytes is, by its version. The first builds of
// version 4 wrote none of what steps have taught: theirs is known by its length.
size_t cau_snapshot_header_bytes(const snapshot_header *common, size_t byte_count);

// What steps have taught, as far as a header so long has it.
void cau_snapshot_read_learned(const snapshot_header *header, size_t header_bytes,
                               cau_accuracy *accuracy);

// Of the session as it is; hash and payload_bytes are left 0.
void cau_snapshot_fill_header(const cau_session *session, snapshot_header *header);
uint64_t cau_snapshot_hash(const snapshot_header *header, size_t header_bytes,
                           const unsigned char *payload, size_t bytes);

// Whether it is whole and of this tissue, with counts that there is room for. CAU_CORRUPT.
cau_status cau_snapshot_check_header(const cau_session *session, const snapshot_header *header,
                                     size_t header_bytes, const unsigned char *payload,
                                     size_t payload_bytes, cau_error *error);
cau_status cau_snapshot_corrupt(cau_error *error, const char *why);

// Whether a session restored from it goes on with the bits of the one that wrote it.
bool cau_snapshot_is_exact(const cau_session *session, const snapshot_header *header);

// Columns of A^-1 that contacts keep: they lag behind cuts, so they cannot be made again.
int32_t cau_snapshot_kept_columns(const cau_session *session);
