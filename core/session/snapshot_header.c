// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/snapshot_header.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "base/hash.h"
#include "cautery/assert.h"

static const char magic[8] = "CAUSNAP";

size_t cau_snapshot_common_bytes(void)
{
	return offsetof(snapshot_header, resting);
}

size_t cau_snapshot_header_bytes(const snapshot_header *common, size_t byte_count)
{
	const size_t unlearned = offsetof(snapshot_header, shallow_steps);
	if (common->version < 4)
		return cau_snapshot_common_bytes();
	if (common->version > 5)
		return sizeof(snapshot_header);
	if (common->version == 5)
		return offsetof(snapshot_header, force_left);
	return byte_count - common->payload_bytes == unlearned
	           ? unlearned
	           : offsetof(snapshot_header, memory_count);
}

static bool has_learned(size_t header_bytes)
{
	return header_bytes > offsetof(snapshot_header, shallow_steps);
}

static bool has_forces(size_t header_bytes)
{
	return header_bytes > offsetof(snapshot_header, force_left);
}

void cau_snapshot_read_learned(const snapshot_header *header, size_t header_bytes,
                               cau_accuracy *accuracy)
{
	cau_accuracy_forget(accuracy);
	if (!has_learned(header_bytes))
		return;
	accuracy->shallow_steps = header->shallow_steps;
	memcpy(accuracy->amplification, header->amplification, sizeof header->amplification);
	if (!has_forces(header_bytes))
		return;
	accuracy->force_left = header->force_left;
	memcpy(accuracy->force_before, header->force_before, sizeof header->force_before);
}

int32_t cau_snapshot_kept_columns(const cau_session *session)
{
	CAU_ASSERT_INDEX(session->contact.column_count, CAU_MAX_COLUMNS + 1);
	return session->contact.epoch == session->solver.factor_epoch ? session->contact.column_count
	                                                              : 0;
}

static uint64_t build_hash(void)
{
	static const char words[] = __VERSION__ " " __DATE__;
	return cau_hash_bytes(CAU_HASH_START, words, sizeof words);
}

void cau_snapshot_fill_header(const cau_session *session, snapshot_header *header)
{
	memset(header, 0, sizeof *header);
	memcpy(header->magic, magic, sizeof header->magic);
	header->version = CAU_SNAPSHOT_VERSION;
	header->single = (uint32_t)session->solver.elements.single;
	snprintf(header->instruction_set, sizeof header->instruction_set, "%s",
	         session->solver.kernels->instruction_set);
	header->build = build_hash();
	header->definition_hash = session->definition_hash;
	header->tick = session->tick;
	header->vertex_count = session->tissue.vertex_count;
	header->edge_count = session->tissue.edges.edge_count;
	header->row_count = session->solver.factor ? session->solver.system.row_count : 0;
	header->tool_count = session->tool_count;
	header->command_count = session->command_count;
	header->active_count = session->shrink.active_count;
	header->factor_version = session->solver.factor_version;
	header->column_count = cau_snapshot_kept_columns(session);
	header->memory_count = session->contact.memory_count;
	header->over_count = session->dissection.tears.over_count;
	header->elements_torn = session->dissection.tears.elements_torn;
	header->waiting_count = session->update.waiting_count;
	header->operation_count = session->update.operation_count;
	header->group_count = session->update.group_count;
	header->waiting_at_start = session->update.waiting_at_start;
	header->making = session->update.making;
	header->swap_tick = session->update.swap_tick;
	header->longest_wait = session->update.longest_wait;
	header->refactorisations = session->update.refactorisations;
	header->frozen_count = session->frozen_count;
	header->inverted = session->inverted;
	header->edges_parted = session->dissection.edges_parted;
	header->elements_removed = session->dissection.elements_removed;
	header->faulted = session->faulted;
	header->resting = session->rest.resting;
	header->quiet_ticks = session->rest.quiet_ticks;
	header->shallow_steps = session->solver.accuracy.shallow_steps;
	header->accuracy = session->solver.accuracy.wanted;
	memcpy(header->amplification, session->solver.accuracy.amplification,
	       sizeof header->amplification);
	header->force_left = session->solver.accuracy.force_left;
	memcpy(header->force_before, session->solver.accuracy.force_before,
	       sizeof header->force_before);
	for (int32_t i = 0; i < session->tool_count; i++)
		header->grid_nodes[i] = session->tool[i].grid.nodes;
	memcpy(header->gravity_m_s2, session->scene->gravity_m_s2, sizeof header->gravity_m_s2);
}

uint64_t cau_snapshot_hash(const snapshot_header *header, size_t header_bytes,
                           const unsigned char *payload, size_t bytes)
{
	snapshot_header unsigned_header;
	memcpy(&unsigned_header, header, sizeof unsigned_header); // with its padding, which is zero
	unsigned_header.hash = 0;
	return cau_hash_bytes(cau_hash_bytes(CAU_HASH_START, &unsigned_header, header_bytes), payload,
	                      bytes);
}

cau_status cau_snapshot_corrupt(cau_error *error, const char *why)
{
	return cau_fail(error, CAU_CORRUPT, NULL, "this is no snapshot of this session: %s", why);
}

// Whether what steps have taught is what they can teach.
static bool is_taught(const snapshot_header *header, size_t header_bytes)
{
	if (has_forces(header_bytes) && !(header->force_left > 0 && header->force_left < INFINITY))
		return false;
	for (int k = 0; k < CAU_ACCURACY_DEPTHS; k++)
		if (!(header->amplification[k] > 0 && header->amplification[k] < INFINITY))
			return false;
	return header->shallow_steps >= 0;
}

// Versions before 7 had columns that are whole only, and half the faces.
static bool has_room_for_contact(const snapshot_header *header)
{
	bool older = header->version < CAU_SNAPSHOT_WIDE;
	int32_t columns = older ? CAU_WHOLE_COLUMNS : CAU_MAX_COLUMNS;
	int32_t faces = older ? CAU_MAX_MEMORY / 2 : CAU_MAX_MEMORY;
	return header->column_count <= columns && header->memory_count >= 0 &&
	       header->memory_count <= faces;
}

cau_status cau_snapshot_check_header(const cau_session *session, const snapshot_header *header,
                                     size_t header_bytes, const unsigned char *payload,
                                     size_t payload_bytes, cau_error *error)
{
	const cau_matrix_update *update = &session->update;
	if (memcmp(header->magic, magic, sizeof magic) != 0)
		return cau_snapshot_corrupt(error, "it does not begin like one");
	if (header->version != 1 && (header->version < 3 || header->version > CAU_SNAPSHOT_VERSION))
		return cau_fail(
			error, CAU_CORRUPT, NULL,
			"the snapshot is of version %u and this build reads 1 and 3 to %u: restore it with "
			"the build that wrote it",
			(unsigned)header->version, (unsigned)CAU_SNAPSHOT_VERSION);
	if (header->single != (uint32_t)session->solver.elements.single)
		return cau_snapshot_corrupt(error, "it is of another precision");
	if (header->definition_hash != session->definition_hash ||
	    header->vertex_count != session->tissue.vertex_count ||
	    header->edge_count != session->tissue.edges.edge_count)
		return cau_snapshot_corrupt(error, "it is of another tissue");
	if (header->tool_count < 0 || header->tool_count > CAU_MAX_TOOLS || header->command_count < 0 ||
	    header->command_count > session->command_capacity || header->active_count < 0 ||
	    header->active_count > session->shrink.active_capacity || header->waiting_count < 0 ||
	    header->waiting_count > update->waiting_capacity || header->operation_count < 0 ||
	    header->operation_count > CAU_DOWNDATES_AT_MOST || header->column_count < 0 ||
	    header->waiting_at_start < 0 || !has_room_for_contact(header) || header->over_count < 0 ||
	    header->over_count > cau_tears_capacity(&session->tissue) || header->row_count < 0 ||
	    header->row_count > header->vertex_count || header->quiet_ticks < 0 ||
	    (header->resting && !header->quiet_ticks) ||
	    (has_learned(header_bytes) && !is_taught(header, header_bytes)))
		return cau_snapshot_corrupt(error, "a count is out of its range");
	if (header->payload_bytes != payload_bytes)
		return cau_snapshot_corrupt(error, "bytes are missing");
	if (header->hash != cau_snapshot_hash(header, header_bytes, payload, payload_bytes))
		return cau_snapshot_corrupt(error, "its bytes have changed");
	return CAU_OK;
}

bool cau_snapshot_is_exact(const cau_session *session, const snapshot_header *header)
{
	return header->version == CAU_SNAPSHOT_VERSION && header->build == build_hash() &&
	       header->accuracy == session->solver.accuracy.wanted &&
	       !strncmp(header->instruction_set, session->solver.kernels->instruction_set,
	                sizeof header->instruction_set);
}
