// SPDX-License-Identifier: GPL-3.0-or-later
// The whole state at a tick border as bytes, and back.
//
// A downdated factor differs in its last bits from a fresh one, so a snapshot holds what the factor
// was made of: the live elements at the last canonical factorisation and the ordered updates since,
// and likewise the factor in the making. A header comes first (snapshot_header.h): a damaged
// snapshot is refused before anything is touched, and so is one whose counts are not those of its
// bytes.
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "cautery/assert.h"
#include "session/snapshot_archive.h"
#include "session/snapshot_header.h"

static void pass_columns(snapshot_archive *archive, cau_session *session)
{
	cau_contact_set *set = &session->contact;
	int32_t count = cau_snapshot_kept_columns(session);
	size_t bytes =
		(size_t)session->tissue.vertex_count * session->solver.kernels->vectors->real_bytes;
	snapshot_pass(archive, set->column_vertex, (size_t)count * sizeof *set->column_vertex);
	snapshot_pass(archive, set->column_version, (size_t)count * sizeof *set->column_version);
	for (int32_t i = 0; i < count && i < CAU_WHOLE_COLUMNS; i++)
		snapshot_pass(archive, set->column[i], bytes);
	for (int32_t i = 0; i < count; i++)
		snapshot_pass(archive, set->inverse + (size_t)i * CAU_MAX_COLUMNS,
		              (size_t)count * sizeof *set->inverse);
}

// The points at which faces were pushed came with version 6.
static void pass_memory(snapshot_archive *archive, cau_contact_set *set)
{
	size_t bytes =
		archive->version >= 6 ? sizeof *set->memory : offsetof(cau_contact_memory, point_count);
	if (archive->reading)
		memset(set->memory, 0, (size_t)set->memory_count * sizeof *set->memory);
	for (int32_t i = 0; i < set->memory_count; i++)
		snapshot_pass(archive, &set->memory[i], bytes);
}

static void pass_update(snapshot_archive *archive, cau_session *session)
{
	CAU_ASSERT(session->update.waiting_count <= session->update.waiting_capacity,
	           "%d elements wait in room for %d", session->update.waiting_count,
	           session->update.waiting_capacity);
	cau_matrix_update *update = &session->update;
	snapshot_pass(archive, update->waiting,
	              (size_t)update->waiting_count * sizeof *update->waiting);
	snapshot_pass(archive, update->operation,
	              (size_t)update->operation_count * sizeof *update->operation);
	for (int kind = 0; kind < CAU_ELEMENT_KINDS; kind++) {
		size_t count = (size_t)cau_tissue_element_count(&session->tissue, kind);
		snapshot_pass(archive, update->canonical[kind], count);
		snapshot_pass(archive, update->next_canonical[kind], count);
	}
}

// Everything but the tools and what decides the system's shape, which restoring needs first.
static cau_status pass_state(snapshot_archive *archive, cau_session *session, cau_error *error)
{
	size_t n = (size_t)session->tissue.vertex_count,
		   edges = (size_t)session->tissue.edges.edge_count;
	snapshot_pass(archive, session->position, 3 * n * sizeof(double));
	snapshot_pass(archive, session->velocity, 3 * n * sizeof(double));
	snapshot_pass(archive, session->external, 3 * n * sizeof(double));
	snapshot_pass(archive, session->fixed, n);
	snapshot_pass(archive, session->solver.system.diagonal, n * sizeof(double));
	snapshot_pass(archive, session->dissection.exposure, edges * sizeof(double));
	snapshot_pass(archive, session->dissection.parted, edges * sizeof(uint16_t));
	size_t doses = (size_t)cau_dissection_dose_count(&session->dissection);
	snapshot_pass(archive, session->dissection.doses.dose, doses * sizeof(double));
	snapshot_pass(archive, session->dissection.doses.gone, doses);
	snapshot_pass(archive, session->shrink.shrunk[0], (size_t)session->tissue.triangle_count);
	snapshot_pass(archive, session->shrink.shrunk[1], (size_t)session->tissue.tetrahedron_count);
	snapshot_pass(archive, session->shrink.active,
	              (size_t)session->shrink.active_count * sizeof *session->shrink.active);
	for (int32_t i = 0; i < session->command_count; i++)
		cau_snapshot_pass_command(archive, &session->command[i]);
	for (int32_t i = 0; i < session->tissue.layer_count; i++) {
		cau_layer_def *def = &session->tissue.layer[i].def;
		snapshot_pass(archive, def, offsetof(cau_layer_def, sheet));
		cau_snapshot_pass_materials(archive, def->sheet, def->fat, &def->link, CAU_MAX_MATERIALS);
	}
	cau_status status = cau_snapshot_pass_elements(archive, session, error);
	pass_update(archive, session);
	pass_columns(archive, session);
	pass_memory(archive, &session->contact);
	if (session->rest.quiet_ticks && !session->rest.resting)
		snapshot_pass(archive, session->rest.from, 3 * n * sizeof(double));
	if (archive->version >= 6) {
		cau_snapshot_pass_tears(archive, session);
		cau_snapshot_pass_faces_held(archive, session);
	}
	if (archive->version >= CAU_SNAPSHOT_EXEMPT && session->scene->contact_thickness_m > 0)
		snapshot_pass(archive, session->collide.exempt_before, n);
	return status;
}

static void write_payload(cau_session *session, snapshot_archive *archive)
{
	snapshot_pass(archive, session->pinned, (size_t)session->tissue.vertex_count);
	if (session->solver.factor)
		snapshot_pass(archive, (void *)(uintptr_t)cau_factor_permutation(session->solver.factor),
		              (size_t)session->solver.system.row_count * sizeof(int32_t));
	for (int32_t i = 0; i < session->tool_count; i++)
		cau_snapshot_pass_tool(archive, &session->tool[i]);
	pass_state(archive, session, NULL); // writing does not fail
}

size_t cau_session_snapshot_bytes(const cau_session *session)
{
	snapshot_archive archive = {.version = CAU_SNAPSHOT_VERSION};
	write_payload((cau_session *)(uintptr_t)session, &archive); // only counts
	return sizeof(snapshot_header) + archive.at;
}

cau_status cau_session_snapshot(const cau_session *session, void *bytes, size_t capacity,
                                size_t *byte_count, cau_error *error)
{
	size_t needed = cau_session_snapshot_bytes(session);
	if (capacity < needed)
		return cau_fail(error, CAU_LIMIT, NULL, "a snapshot needs %zu bytes, %zu are given", needed,
		                capacity);
	snapshot_header header;
	cau_snapshot_fill_header(session, &header);
	snapshot_archive archive = {.bytes = (unsigned char *)bytes + sizeof header,
	                            .capacity = capacity - sizeof header,
	                            .version = CAU_SNAPSHOT_VERSION};
	write_payload((cau_session *)(uintptr_t)session, &archive);
	header.payload_bytes = archive.at;
	CAU_ASSERT(sizeof header + archive.at == needed, "%zu bytes written of %zu announced",
	           sizeof header + archive.at, needed);
	header.hash = cau_snapshot_hash(&header, sizeof header, archive.bytes, archive.at);
	memcpy(bytes, &header, sizeof header);
	*byte_count = sizeof header + archive.at;
	return CAU_OK;
}

// ---- restoring

// The counts of a header in place of the session's own, to walk over its payload. The arrays are
// the session's: the walk only counts.
static cau_session *imagine(const cau_session *session, const snapshot_header *header)
{
	cau_session *imagined = malloc(sizeof *imagined);
	if (!imagined)
		return NULL;
	cau_matrix_update_await(&session->update);
	memcpy(imagined, session, sizeof *imagined);
	imagined->command_count = header->command_count;
	imagined->tool_count = header->tool_count;
	imagined->shrink.active_count = header->active_count;
	imagined->contact.column_count = header->column_count;
	imagined->contact.memory_count = header->memory_count;
	imagined->dissection.tears.over_count = header->over_count;
	imagined->contact.epoch = imagined->solver.factor_epoch;
	imagined->update.waiting_count = header->waiting_count;
	imagined->update.operation_count = header->operation_count;
	imagined->rest.resting = header->resting;
	imagined->rest.quiet_ticks = header->quiet_ticks;
	return imagined;
}

// Each tool says how large its heat grid is, and so does the header.
static cau_status check_tools(const snapshot_header *header, const unsigned char *payload,
                              snapshot_archive *counted, cau_error *error)
{
	for (int32_t i = 0; i < header->tool_count; i++) {
		cau_tool_state state = {0};
		snapshot_archive ahead = *counted;
		ahead.bytes = (unsigned char *)(uintptr_t)payload;
		ahead.reading = 1;
		cau_snapshot_pass_tool_state(&ahead, &state);
		if (ahead.at > ahead.capacity)
			return cau_snapshot_corrupt(error, "bytes are missing");
		double cells = state.definition.grid_cells; // a whole number of nodes is made of it
		if (!(cells >= header->grid_nodes[i] && cells < header->grid_nodes[i] + 1.0))
			return cau_snapshot_corrupt(error, "a heat grid has another size");
		cau_tool tool = {.grid.nodes = header->grid_nodes[i]};
		cau_snapshot_pass_tool(counted, &tool);
	}
	return CAU_OK;
}

// Whether the payload is what the header says, before anything of the session is touched.
static cau_status check_payload(const cau_session *session, const snapshot_header *header,
                                const unsigned char *payload, size_t payload_bytes,
                                cau_error *error)
{
	snapshot_archive counted = {.capacity = payload_bytes, .version = header->version};
	for (int32_t i = 0; i < header->tool_count; i++)
		if (header->grid_nodes[i] < 0 || header->grid_nodes[i] > CAU_SNAPSHOT_NODES)
			return cau_snapshot_corrupt(error, "a count is out of its range");
	cau_session *imagined = imagine(session, header);
	if (!imagined)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory to restore");
	counted.at = (size_t)session->tissue.vertex_count + (size_t)header->row_count * sizeof(int32_t);
	cau_status status = check_tools(header, payload, &counted, error);
	if (!status)
		status = pass_state(&counted, imagined, error);
	if (!status && counted.at != payload_bytes)
		status = cau_snapshot_corrupt(error, "its counts are not those of its bytes");
	free(imagined);
	return status;
}

static cau_status restore_tools(cau_session *session, const snapshot_header *header,
                                snapshot_archive *archive, cau_error *error)
{
	while (session->tool_count)
		cau_session_drop_tool(session, session->tool_count - 1);
	for (int32_t i = 0; i < header->tool_count; i++) {
		cau_tool *tool = &session->tool[i];
		CAU_ASSERT(session->tool_count == i && i < CAU_MAX_TOOLS, "tool %d comes after %d", i,
		           session->tool_count);
		memset(tool, 0, sizeof *tool);
		cau_tool_state state = {0};
		snapshot_archive ahead = *archive;
		cau_snapshot_pass_tool_state(&ahead, &state);
		cau_status status =
			cau_heat_grid_create(&tool->grid, &state.definition, session->scene->ambient_c,
		                         session->solver.step_s, &state.pose, error);
		if (status)
			return status;
		session->tool_count++;
		cau_snapshot_pass_tool(archive, tool);
		if (header->version < CAU_SNAPSHOT_NESTED)
			cau_heat_grid_fill_outer(&tool->grid);
		cau_heat_grid_take_over(&tool->grid, &state.definition, &state.pose, state.jaw,
		                        state.energized);
	}
	return CAU_OK;
}

static void restore_counts(cau_session *session, const snapshot_header *header, size_t header_bytes)
{
	CAU_ASSERT(!session->update.making, "counts are restored while a factor is made for tick %llu",
	           (unsigned long long)session->update.swap_tick);
	cau_matrix_update *update = &session->update;
	session->command_count = header->command_count;
	session->driven_count = 0;
	session->shrink.active_count = header->active_count;
	session->contact.column_count = header->column_count;
	session->contact.memory_count = header->memory_count;
	session->dissection.tears.over_count = header->over_count;
	session->dissection.tears.elements_torn = header->elements_torn;
	session->contact.epoch = session->solver.factor_epoch;
	session->solver.factor_version = header->factor_version;
	update->waiting_count = header->waiting_count;
	update->operation_count = header->operation_count;
	update->group_count = header->group_count;
	update->waiting_at_start = header->waiting_at_start;
	update->longest_wait = header->longest_wait;
	session->tick = header->tick;
	session->faulted = header->faulted;
	session->rest.resting = header->resting;
	session->rest.quiet_ticks = header->quiet_ticks;
	cau_snapshot_read_learned(header, header_bytes, &session->solver.accuracy);
	session->frozen_count = header->frozen_count;
	session->inverted = header->inverted;
	memcpy(session->scene->gravity_m_s2, header->gravity_m_s2, sizeof header->gravity_m_s2);
}

// The canonical factor, unless that is what there is: its bits depend on the matrix alone, whose
// values are those that it was last made from.
static cau_status make_canonical(cau_session *session, cau_error *error)
{
	cau_step_solver *solver = &session->solver;
	cau_matrix *matrix = &solver->system.matrix;
	size_t bytes = (size_t)matrix->first[matrix->n] * sizeof *matrix->value;
	double *made_from = cau_factor_is_canonical(solver->factor) ? malloc(bytes) : NULL;
	if (made_from)
		memcpy(made_from, matrix->value, bytes);
	cau_alive canonical;
	memcpy(canonical.element, session->update.canonical, sizeof canonical.element);
	cau_system_assemble(&solver->system, &session->tissue, &canonical, solver->step_s,
	                    matrix->value);
	bool same = made_from && memcmp(made_from, matrix->value, bytes) == 0;
	free(made_from);
	return same ? CAU_OK : cau_factor_refactor(solver->factor, matrix, error);
}

// The factor as it was: canonical, then the recorded updates in their groups.
static cau_status replay_factor(cau_session *session, const snapshot_header *header,
                                cau_error *error)
{
	cau_step_solver *solver = &session->solver;
	cau_matrix_update *update = &session->update;
	update->refactorisations = header->refactorisations;
	if (!solver->factor)
		return CAU_OK;
	cau_status status = make_canonical(session, error);
	for (int32_t k = 0; k < update->operation_count && !status;) {
		cau_waiting list[CAU_DOWNDATES_AT_MOST]; // elements between pins fill a group, not its rank
		int32_t count = 0, taken = 0, group = update->operation[k].group;
		for (; k < update->operation_count && update->operation[k].group == group; k++) {
			CAU_ASSERT_INDEX(count, CAU_DOWNDATES_AT_MOST);
			list[count++] =
				(cau_waiting){update->operation[k].kind, update->operation[k].element, 0};
		}
		status = cau_matrix_update_downdate(update, list, count, &taken, error);
		CAU_ASSERT(status || taken == count, "%d elements of group %d are taken out, of %d", taken,
		           group, count);
	}
	memset(update->touched, 0, (size_t)solver->sweep.supernode_count);
	if (!status)
		cau_sweep_pack(&solver->sweep, solver->factor);
	if (!status && header->making)
		cau_matrix_update_start(update, header->swap_tick);
	return status;
}

static cau_status restore_system(cau_session *session, const snapshot_header *header,
                                 snapshot_archive *archive, cau_error *error)
{
	size_t n = (size_t)session->tissue.vertex_count;
	int32_t *permutation = malloc((size_t)header->row_count * sizeof *permutation + 1);
	uint8_t *pinned = malloc(n);
	cau_status status = CAU_OK;
	if (!permutation || !pinned) {
		status = cau_fail(error, CAU_NO_MEMORY, NULL, "no memory to restore");
		goto done;
	}
	snapshot_pass(archive, pinned, n);
	snapshot_pass(archive, permutation, (size_t)header->row_count * sizeof *permutation);
	const cau_factor *factor = session->solver.factor;
	int32_t rows = factor ? session->solver.system.row_count : 0; // none after a failed rebuild
	int same = !memcmp(pinned, session->pinned, n) && rows == header->row_count &&
	           (!rows || !memcmp(permutation, cau_factor_permutation(factor),
	                             (size_t)rows * sizeof *permutation));
	memcpy(session->pinned, pinned, n);
	if (!same)
		status = cau_session_rebuild_system(session, header->row_count ? permutation : NULL, error);
done:
	free(permutation);
	free(pinned);
	return status;
}

cau_status cau_session_restore(cau_session *session, const void *bytes, size_t byte_count,
                               bool *exact, cau_error *error)
{
	snapshot_header header = {0};
	size_t head = cau_snapshot_common_bytes();
	if (byte_count >= head) {
		memcpy(&header, bytes, head);
		head = cau_snapshot_header_bytes(&header, byte_count);
	}
	if (byte_count < head)
		return cau_snapshot_corrupt(error, "it is too short");
	memcpy(&header, bytes, head);
	unsigned char *payload = (unsigned char *)(uintptr_t)bytes + head;
	size_t payload_bytes = byte_count - head;
	cau_status status =
		cau_snapshot_check_header(session, &header, head, payload, payload_bytes, error);
	if (!status)
		status = check_payload(session, &header, payload, payload_bytes, error);
	if (status)
		return status;
	snapshot_archive archive = {
		.bytes = payload, .capacity = payload_bytes, .reading = 1, .version = header.version};
	cau_matrix_update_stop(&session->update);
	status = restore_system(session, &header, &archive, error);
	if (!status)
		status = restore_tools(session, &header, &archive, error);
	if (!status) {
		restore_counts(session, &header, head);
		if (session->scene->contact_thickness_m > 0)
			cau_collide_forget(&session->collide);
		status = pass_state(&archive, session, error);
		cau_elements_set_laws(&session->solver.elements, &session->tissue);
		cau_elements_mark_targets(&session->solver.elements, &session->solver.slots);
		session->solver.conservative =
			cau_solver_is_conservative(&session->tissue, session->solver.diagonal);
		cau_dissection_begin(&session->dissection);
		cau_dissection_recount(&session->dissection);
		session->dissection.edges_parted = header.edges_parted;
		session->dissection.elements_removed = header.elements_removed;
		cau_contact_clear(&session->contact);
		session->refusal_count = 0;
		session->watch.left_m = 0;
		session->energy.stale = session->spin.stale = true;
		if (!status)
			status = replay_factor(session, &header, error);
		cau_frame_rebuild(&session->frame, &session->dissection);
		cau_session_renew_scalars(session);
	}
	if (status) // half restored: say so instead of going on
		session->faulted = true;
	if (exact)
		*exact = cau_snapshot_is_exact(session, &header);
	return status;
}

uint64_t cau_session_hash(const cau_session *session)
{
	const cau_tissue *tissue = &session->tissue;
	const cau_elements *elements = &session->solver.elements;
	size_t n = (size_t)tissue->vertex_count, edges = (size_t)tissue->edges.edge_count;
	uint64_t hash = cau_hash_word(CAU_HASH_START, session->tick);
	hash = cau_hash_bytes(hash, session->position, 3 * n * sizeof(double));
	hash = cau_hash_bytes(hash, session->velocity, 3 * n * sizeof(double));
	hash = cau_hash_bytes(hash, session->dissection.exposure, edges * sizeof(double));
	hash = cau_hash_bytes(hash, session->dissection.parted, edges * sizeof(uint16_t));
	size_t doses = (size_t)cau_dissection_dose_count(&session->dissection);
	hash = cau_hash_bytes(hash, session->dissection.doses.dose, doses * sizeof(double));
	hash = cau_hash_bytes(hash, session->dissection.doses.gone, doses);
	const cau_tears *tears = &session->dissection.tears;
	if (tears->over_count) // what tears nothing has the hash that it had before there were tears
		hash = cau_hash_bytes(hash, tears->over, (size_t)tears->over_count * sizeof *tears->over);
	for (int i = 0; i < 6; i++)
		hash = cau_hash_bytes(hash, elements->fat.plastic_strain[i],
		                      (size_t)elements->fat.slot_count * cau_real_bytes(elements->single));
	for (int32_t i = 0; i < session->tool_count; i++) {
		const cau_tool *tool = &session->tool[i];
		size_t nodes =
			(size_t)tool->grid.nodes * (size_t)tool->grid.nodes * (size_t)tool->grid.nodes;
		const cau_pose *pose = &tool->state.pose, *asked = &tool->state.asked_pose;
		hash = cau_hash_bytes(hash, pose, sizeof *pose);
		if (!cau_pose_is_same_place(pose, asked))
			hash = cau_hash_bytes(hash, asked, sizeof *asked);
		const double jaws[] = {tool->state.jaw, tool->state.asked_jaw};
		if (jaws[0] != jaws[1])
			hash = cau_hash_bytes(hash, jaws, sizeof jaws);
		hash = cau_hash_bytes(hash, tool->state.force_n, sizeof tool->state.force_n);
		hash = cau_hash_word(hash,
		                     (uint64_t)tool->state.energized << 32 | (uint32_t)tool->grasp_count);
		for (int k = 0; k < CAU_HEAT_FIELDS; k++)
			hash = cau_hash_bytes(hash, tool->grid.field[k].temperature, nodes * sizeof(float));
	}
	return hash;
}
