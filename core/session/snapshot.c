// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the whole state at a tick border as bytes, and restores it.
//
// A downdated factor differs in its last bits from a factor that is computed again. So a snapshot
// holds the history of the factor: the ordered updates since the last canonical factorisation, and
// those that still wait. The whole snapshot is read and checked (snapshot_read.c) before the
// session is changed.
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "cautery/assert.h"
#include "session/snapshot_state.h"

// ---- writing

static void write_all(snapshot_archive *archive, const cau_session *session)
{
	cau_layer_def layer[CAU_MAX_LAYERS];
	snapshot_state state;
	cau_snapshot_view(session, layer, &state);
	cau_snapshot_pass_head(archive, &state.head);
	cau_snapshot_pass_state(archive, session, &state);
	cau_snapshot_pass_grids(archive, &state);
}

size_t cau_session_snapshot_bytes(const cau_session *session)
{
	snapshot_archive archive = {.mode = SNAPSHOT_COUNT};
	write_all(&archive, session);
	return archive.at + CAU_SNAPSHOT_HASH_BYTES;
}

cau_status cau_session_snapshot(const cau_session *session, void *bytes, size_t capacity,
                                size_t *byte_count, cau_error *error)
{
	size_t needed = cau_session_snapshot_bytes(session);
	if (capacity < needed)
		return cau_fail(error, CAU_LIMIT, NULL, "a snapshot needs %zu bytes, %zu are given", needed,
		                capacity);
	snapshot_archive archive = {.mode = SNAPSHOT_WRITE, .bytes = bytes, .capacity = needed};
	write_all(&archive, session);
	CAU_ASSERT(archive.at + CAU_SNAPSHOT_HASH_BYTES == needed, "%zu bytes written of %zu announced",
	           archive.at, needed);
	uint64_t hash = cau_snapshot_hash(bytes, archive.at);
	cau_snapshot_words(&archive, "hash", &hash, 1, UINT64_MAX);
	*byte_count = archive.at;
	return CAU_OK;
}

// ---- restoring the parts of the state

static void take_counts(cau_session *session, const snapshot_head *head)
{
	CAU_ASSERT(!session->update.making, "counts are restored while a factor is made for tick %llu",
	           (unsigned long long)session->update.swap_tick);
	cau_matrix_update *update = &session->update;
	cau_accuracy *accuracy = &session->solver.accuracy;
	session->tick = head->tick;
	session->faulted = head->faulted;
	session->rest.resting = head->resting;
	session->rest.quiet_ticks = head->quiet_ticks;
	cau_session_forget_inversion(session);
	session->inversion.count = head->inverted;
	session->driven.count = session->queue.refusal_count = 0;
	session->solver.age.version = head->factor.version;
	update->group_count = head->factor.group_count;
	update->waiting_at_start = head->factor.waiting_at_start;
	update->longest_wait = head->factor.longest_wait;
	update->refactorisations = head->factor.refactorisations;
	accuracy->shallow_steps = head->learned.shallow_steps;
	accuracy->force_left = head->learned.force_left;
	memcpy(accuracy->amplification, head->learned.amplification,
	       sizeof head->learned.amplification);
	memcpy(accuracy->force_before, head->learned.force_before, sizeof head->learned.force_before);
	memcpy(session->scene->gravity_m_s2, head->gravity_m_s2, sizeof head->gravity_m_s2);
}

static void take_vertices(cau_session *session, const snapshot_state *state)
{
	size_t n = (size_t)session->tissue.vertex_count;
	memcpy(session->vertices.fixed, state->vertices.fixed, n);
	session->vertices.frozen_count = 0;
	for (size_t v = 0; v < n; v++)
		session->vertices.frozen_count += state->vertices.fixed[v] && !state->vertices.pinned[v];
	memcpy(session->vertices.position, state->vertices.position, 3 * n * sizeof(double));
	memcpy(session->vertices.velocity, state->vertices.velocity, 3 * n * sizeof(double));
	memcpy(session->vertices.external, state->vertices.external, 3 * n * sizeof(double));
	memcpy(session->solver.system.diagonal, state->vertices.diagonal, n * sizeof(double));
	if (state->head.quiet_ticks && !state->head.resting)
		memcpy(session->rest.from, state->vertices.quiet_from, 3 * n * sizeof(double));
	if (session->scene->contact_thickness_m > 0) {
		cau_collide_forget(&session->collide);
		memcpy(session->collide.search.exempt_before, state->vertices.exempt_before, n);
	}
}

static void take_dissection(cau_session *session, const snapshot_state *state)
{
	cau_dissection *dissection = &session->dissection;
	size_t edges = (size_t)session->tissue.edges.edge_count;
	size_t doses = (size_t)cau_dissection_dose_count(dissection);
	memcpy(dissection->exposure, state->dissection.exposure, edges * sizeof(double));
	memcpy(dissection->parted, state->dissection.parted, edges * sizeof(uint16_t));
	if (doses) {
		memcpy(dissection->doses.dose, state->dissection.dose, doses * sizeof(double));
		memcpy(dissection->doses.gone, state->dissection.gone, doses);
	}
	cau_dissection_begin(dissection);
	cau_dissection_recount(dissection);
	dissection->edges_parted = state->head.edges_parted;
	dissection->elements_removed = state->head.elements_removed;
	dissection->tears.elements_torn = state->head.elements_torn;
	dissection->tears.over_count = state->head.sizes.over;
	memcpy(dissection->tears.over, state->dissection.over,
	       (size_t)state->head.sizes.over * sizeof *state->dissection.over);
}

static void take_cells(cau_session *session, snapshot_state *state)
{
	if (!session->heat.cells)
		return;
	cau_tissue_cells *cells = state->cells;
	for (int32_t cell = 0; cell < cells->bioheat.cells.count; cell++)
		if (cells->bioheat.cells.severed[cell])
			cau_cells_sever(&cells->bioheat.cells, cell);
	cau_tissue_cells_copy(session->heat.cells, cells);
}

static void take_vessels(cau_session *session, const snapshot_state *state)
{
	cau_vessels *vessels = session->vessels;
	if (!vessels)
		return;
	memcpy(vessels->fusion, state->vessels.fusion, (size_t)vessels->station_count * sizeof(double));
	memcpy(vessels->blood.volume_m3, state->vessels.blood_m3,
	       (size_t)vessels->blood.vertex_count * sizeof(double));
	for (int32_t i = 0; i < vessels->vessel_count; i++)
		vessels->vessel[i].state.shed_m3 = state->vessels.shed_m3[i];
}

static void take_reals(void *const *to, void *const *from, int count, int32_t slots, bool single)
{
	for (int i = 0; i < count; i++)
		memcpy(to[i], from[i], (size_t)slots * cau_real_bytes(single));
}

// Sets the elements' weights and laws from the materials. Then restores what changed during the
// session.
static void take_elements(cau_session *session, const snapshot_state *state)
{
	cau_elements *to = &session->solver.elements;
	const cau_elements *from = &state->elements;
	int32_t sheets = to->sheet.slot_count, fat = to->fat.slot_count;
	for (int32_t i = 0; i < session->tissue.layer_count; i++)
		session->tissue.layer[i].def = state->layer[i];
	memcpy(session->shrink.shrunk[0], state->shrunk[0], (size_t)session->tissue.triangle_count);
	memcpy(session->shrink.shrunk[1], state->shrunk[1], (size_t)session->tissue.tetrahedron_count);
	session->shrink.active_count = state->head.sizes.active;
	memcpy(session->shrink.active, state->active,
	       (size_t)state->head.sizes.active * sizeof *state->active);
	cau_elements_set_materials(to, &session->solver.slots, &session->tissue,
	                           session->dissection.alive.element, session->shrink.shrunk);
	take_reals(to->sheet.target, from->sheet.target, 3, sheets, to->single);
	take_reals(to->sheet.polar, from->sheet.polar, 6, sheets, to->single);
	take_reals(&to->fat.limit_weight, &from->fat.limit_weight, 1, fat, to->single);
	take_reals(to->fat.target, from->fat.target, 6, fat, to->single);
	take_reals(to->fat.polar, from->fat.polar, 4, fat, to->single);
	take_reals(to->fat.plastic, from->fat.plastic, 6, fat, to->single);
	take_reals(to->fat.plastic_strain, from->fat.plastic_strain, 6, fat, to->single);
	memcpy(to->fat.limited, from->fat.limited, (size_t)(fat / CAU_BATCH));
	memcpy(to->fat.flowed, from->fat.flowed, (size_t)(fat / CAU_BATCH));
	cau_elements_mark_targets(to, &session->solver.slots);
	session->solver.settings.conservative =
		cau_solver_is_conservative(&session->tissue, session->solver.settings.diagonal);
}

static void take_contact(cau_session *session, const snapshot_state *state)
{
	cau_contact_set *set = &session->contact;
	size_t count = (size_t)state->head.sizes.columns;
	size_t bytes =
		(size_t)session->tissue.vertex_count * session->solver.kernels->vectors->real_bytes;
	cau_contact_clear(set);
	set->columns.epoch = session->solver.age.epoch;
	set->columns.count = (int32_t)count;
	memcpy(set->columns.vertex, state->columns.vertex, count * sizeof *set->columns.vertex);
	memcpy(set->columns.version, state->columns.version, count * sizeof *set->columns.version);
	for (size_t i = 0; i < count && i < CAU_WHOLE_COLUMNS; i++)
		memcpy(set->columns.whole[i], state->columns.whole[i], bytes);
	for (size_t i = 0; i < count; i++)
		for (size_t k = 0; k <= i; k++)
			set->columns.inverse[i * CAU_MAX_COLUMNS + k] =
				set->columns.inverse[k * CAU_MAX_COLUMNS + i] =
					state->columns.inverse[i * CAU_MAX_COLUMNS + k];
	set->sides.memory_count = state->head.sizes.memory;
	memcpy(set->sides.memory, state->memory,
	       (size_t)set->sides.memory_count * sizeof *set->sides.memory);
}

// Takes the tools with their heat grids from `state`.
static void take_tools(cau_session *session, snapshot_state *state)
{
	while (session->tool_count)
		cau_session_drop_tool(session, session->tool_count - 1);
	session->tool_count = state->head.sizes.tools;
	for (int32_t i = 0; i < session->tool_count; i++) {
		cau_tool *tool = &session->tool[i];
		*tool = state->tool[i];
		state->tool[i].grid = (cau_heat_grid){0};
		cau_heat_grid_take_over(&tool->grid, &tool->state.definition, &tool->state.pose,
		                        tool->state.jaw, tool->state.energized);
	}
	session->queue.count = state->head.sizes.commands;
	memcpy(session->queue.command, state->command,
	       (size_t)session->queue.count * sizeof *session->queue.command);
}

// ---- the factor

// Restores the lists of the matrix update. The last canonical factorisation had the elements that
// live now, wait, or were removed from the factor since. A factorisation in progress has the
// elements that live now or were removed since it began.
static void take_lists(cau_session *session, const snapshot_state *state)
{
	cau_matrix_update *update = &session->update;
	update->waiting_count = state->head.sizes.waiting;
	update->operation_count = state->head.sizes.operations;
	memcpy(update->waiting, state->waiting, (size_t)update->waiting_count * sizeof *state->waiting);
	memcpy(update->operation, state->operation,
	       (size_t)update->operation_count * sizeof *state->operation);
	for (int kind = 0; kind < CAU_ELEMENT_KINDS; kind++) {
		size_t count = (size_t)cau_tissue_element_count(&session->tissue, kind);
		memcpy(update->canonical[kind], session->dissection.alive.element[kind], count);
		memcpy(update->next_canonical[kind], session->dissection.alive.element[kind], count);
	}
	for (int32_t k = 0; k < update->waiting_count; k++) {
		const cau_waiting *waiting = &update->waiting[k];
		update->canonical[waiting->kind][waiting->element] = 1;
		if (k >= update->waiting_at_start)
			update->next_canonical[waiting->kind][waiting->element] = 1;
	}
	for (int32_t k = 0; k < update->operation_count; k++)
		update->canonical[update->operation[k].kind][update->operation[k].element] = 1;
}

// Computes the canonical factor, unless the present factor is that one already. The factor's bits
// depend on the matrix values only, so the values are compared.
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
	cau_system_assemble(&solver->system, &session->tissue, &canonical, solver->inertia_s,
	                    matrix->value);
	bool same = made_from && memcmp(made_from, matrix->value, bytes) == 0;
	free(made_from);
	return same ? CAU_OK : cau_factor_refactor(solver->factor, matrix, error);
}

// Removes the elements of one recorded update from the factor, beginning at operation[k]. *k gets
// the first operation of the next update.
static cau_status replay_group(cau_matrix_update *update, int32_t *k, cau_error *error)
{
	// A group also counts elements with pinned vertices, which add no rank.
	cau_waiting list[CAU_DOWNDATES_AT_MOST];
	int32_t count = 0, group = update->operation[*k].group;
	for (; *k < update->operation_count && update->operation[*k].group == group; ++*k) {
		CAU_ASSERT_INDEX(count, CAU_DOWNDATES_AT_MOST);
		list[count++] = (cau_waiting){update->operation[*k].kind, update->operation[*k].element, 0};
	}
	cau_status status = CAU_OK;
	for (int32_t done = 0, taken = 0; done < count && !status; done += taken)
		status = cau_matrix_update_downdate(update, list + done, count - done, &taken, error);
	return status;
}

// Restores the factor: the canonical factor, then the recorded updates in their groups.
static cau_status replay_factor(cau_session *session, const snapshot_head *head, cau_error *error)
{
	cau_step_solver *solver = &session->solver;
	cau_matrix_update *update = &session->update;
	if (!solver->factor)
		return CAU_OK;
	cau_status status = make_canonical(session, error);
	for (int32_t k = 0; k < update->operation_count && !status;)
		status = replay_group(update, &k, error);
	memset(update->touched, 0, (size_t)solver->sweep.supernode_count);
	if (!status)
		cau_sweep_pack(&solver->sweep, solver->factor);
	if (!status && head->factor.making)
		cau_matrix_update_start(update, head->factor.swap_tick);
	return status;
}

// Sets the pinned vertices. If they differ, the system is analysed again; its order depends on the
// pins only.
static cau_status take_pins(cau_session *session, const uint8_t *pinned, cau_error *error)
{
	size_t n = (size_t)session->tissue.vertex_count;
	cau_step_solver *solver = &session->solver;
	bool has_system = solver->factor || session->scene->solver == CAU_SOLVER_DIAGONAL;
	bool same = has_system && !memcmp(pinned, session->vertices.pinned, n);
	memcpy(session->vertices.pinned, pinned, n);
	return same ? CAU_OK : cau_session_rebuild_system(session, error);
}

// ---- the whole snapshot

static cau_status take(cau_session *session, snapshot_state *state, cau_error *error)
{
	cau_matrix_update_stop(&session->update);
	take_dissection(session, state);
	cau_status status = take_pins(session, state->vertices.pinned, error);
	if (status)
		return status;
	take_tools(session, state);
	take_counts(session, &state->head);
	take_vertices(session, state);
	take_elements(session, state);
	take_contact(session, state);
	take_cells(session, state);
	take_vessels(session, state);
	take_lists(session, state);
	session->watch.left_m = 0;
	session->energy.stale = session->spin.stale = true;
	status = replay_factor(session, &state->head, error);
	cau_frame_rebuild(&session->view.frame, &session->dissection);
	cau_session_look_at_vessels(session);
	cau_session_renew_scalars(session);
	cau_session_forget_contact(session);
	return status;
}

cau_status cau_session_restore(cau_session *session, const void *bytes, size_t byte_count,
                               bool *exact, cau_error *error)
{
	snapshot_state state;
	cau_matrix_update_await(&session->update); // the checks read the session
	cau_status status = cau_snapshot_read(session, bytes, byte_count, &state, error);
	if (!status) {
		if (exact)
			*exact = cau_snapshot_is_exact(session, &state.head);
		status = take(session, &state, error);
		if (status) // the state is half restored, so the session must not continue
			session->faulted = true;
	}
	cau_snapshot_drop(&state);
	return status;
}

uint64_t cau_session_hash(const cau_session *session)
{
	const cau_tissue *tissue = &session->tissue;
	const cau_elements *elements = &session->solver.elements;
	size_t n = (size_t)tissue->vertex_count, edges = (size_t)tissue->edges.edge_count;
	uint64_t hash = cau_hash_word(CAU_HASH_START, session->tick);
	hash = cau_hash_bytes(hash, session->vertices.position, 3 * n * sizeof(double));
	hash = cau_hash_bytes(hash, session->vertices.velocity, 3 * n * sizeof(double));
	hash = cau_hash_bytes(hash, session->dissection.exposure, edges * sizeof(double));
	hash = cau_hash_bytes(hash, session->dissection.parted, edges * sizeof(uint16_t));
	size_t doses = (size_t)cau_dissection_dose_count(&session->dissection);
	hash = cau_hash_bytes(hash, session->dissection.doses.dose, doses * sizeof(double));
	hash = cau_hash_bytes(hash, session->dissection.doses.gone, doses);
	if (session->heat.cells)
		hash = cau_tissue_cells_hash(session->heat.cells, hash);
	if (session->vessels)
		hash = cau_vessels_hash(session->vessels, hash);
	const cau_tears *tears = &session->dissection.tears;
	if (tears->over_count) // a session without tears has the same hash as before tears existed
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
