// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/snapshot_state.h"

#include <stdio.h>
#include <string.h>

#include "base/hash.h"
#include "cautery/assert.h"

static const char magic[8] = "CAUSNAP";

// ---- the head

static uint64_t build_hash(void)
{
	static const char words[] = __VERSION__ " " __DATE__;
	return cau_hash_bytes(CAU_HASH_START, words, sizeof words);
}

static int32_t kept_columns(const cau_session *session)
{
	CAU_ASSERT_INDEX(session->contact.columns.count, CAU_MAX_COLUMNS + 1);
	return session->contact.columns.epoch == session->solver.age.epoch
	           ? session->contact.columns.count
	           : 0;
}

static snapshot_sizes view_sizes(const cau_session *session)
{
	return (snapshot_sizes){.vertices = session->tissue.vertex_count,
	                        .edges = session->tissue.edges.edge_count,
	                        .tools = session->tool_count,
	                        .commands = session->queue.count,
	                        .active = session->shrink.active_count,
	                        .columns = kept_columns(session),
	                        .memory = session->contact.sides.memory_count,
	                        .over = session->dissection.tears.over_count,
	                        .waiting = session->update.waiting_count,
	                        .operations = session->update.operation_count};
}

static snapshot_factor view_factor(const cau_session *session)
{
	const cau_matrix_update *update = &session->update;
	return (snapshot_factor){.swap_tick = update->making ? update->swap_tick : 0,
	                         .longest_wait = update->longest_wait,
	                         .version = session->solver.age.version,
	                         .group_count = update->group_count,
	                         .waiting_at_start = update->making ? update->waiting_at_start : 0,
	                         .refactorisations = update->refactorisations,
	                         .making = update->making};
}

static void view_head(const cau_session *session, snapshot_head *head)
{
	const cau_accuracy *accuracy = &session->solver.accuracy;
	const cau_dissection *dissection = &session->dissection;
	*head = (snapshot_head){.version = CAU_SNAPSHOT_VERSION,
	                        .single = session->solver.elements.single,
	                        .build = build_hash(),
	                        .definition_hash = session->definition_hash,
	                        .tick = session->tick,
	                        .sizes = view_sizes(session),
	                        .factor = view_factor(session),
	                        .inverted = session->inversion.count,
	                        .edges_parted = dissection->edges_parted,
	                        .elements_removed = dissection->elements_removed,
	                        .elements_torn = dissection->tears.elements_torn,
	                        .quiet_ticks = session->rest.quiet_ticks,
	                        .faulted = session->faulted,
	                        .resting = session->rest.resting,
	                        .learned = {.shallow_steps = accuracy->shallow_steps,
	                                    .accuracy = accuracy->wanted,
	                                    .force_left = accuracy->force_left}};
	snprintf(head->instruction_set, sizeof head->instruction_set, "%s",
	         session->solver.kernels->instruction_set);
	memcpy(head->gravity_m_s2, session->scene->gravity_m_s2, sizeof head->gravity_m_s2);
	memcpy(head->learned.amplification, accuracy->amplification,
	       sizeof head->learned.amplification);
	memcpy(head->learned.force_before, accuracy->force_before, sizeof head->learned.force_before);
}

bool cau_snapshot_is_exact(const cau_session *session, const snapshot_head *head)
{
	return head->build == build_hash() &&
	       head->learned.accuracy == session->solver.accuracy.wanted &&
	       !strcmp(head->instruction_set, session->solver.kernels->instruction_set);
}

// Largest value of a growing counter: half of an integer's range, so that no counter overflows
// soon.
enum { MOST_COUNTED = INT32_MAX / 2 };

static void pass_counts(snapshot_archive *archive, snapshot_head *head)
{
	struct {
		const char *what;
		int32_t *count;
		int64_t most;
	} counts[] = {
		{"vertices", &head->sizes.vertices, MOST_COUNTED},
		{"edges", &head->sizes.edges, MOST_COUNTED},
		{"tools", &head->sizes.tools, CAU_MAX_TOOLS},
		{"commands", &head->sizes.commands, MOST_COUNTED},
		{"shrinking elements", &head->sizes.active, MOST_COUNTED},
		{"columns", &head->sizes.columns, CAU_MAX_COLUMNS},
		{"faces at tools", &head->sizes.memory, CAU_MAX_MEMORY},
		{"stretched elements", &head->sizes.over, MOST_COUNTED},
		{"waiting elements", &head->sizes.waiting, MOST_COUNTED},
		{"factor operations", &head->sizes.operations, CAU_DOWNDATES_AT_MOST},
		{"operation groups", &head->factor.group_count, CAU_DOWNDATES_AT_MOST},
		{"waiting elements at the start", &head->factor.waiting_at_start, MOST_COUNTED},
		{"refactorisations", &head->factor.refactorisations, MOST_COUNTED},
		{"inverted elements", &head->inverted, MOST_COUNTED},
		{"parted edges", &head->edges_parted, MOST_COUNTED},
		{"removed elements", &head->elements_removed, MOST_COUNTED},
		{"torn elements", &head->elements_torn, MOST_COUNTED},
		{"quiet ticks", &head->quiet_ticks, MOST_COUNTED},
		{"shallow steps", &head->learned.shallow_steps, MOST_COUNTED},
	};
	for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
		cau_snapshot_ints(archive, counts[i].what, counts[i].count, 1, 0, counts[i].most);
}

void cau_snapshot_pass_head(snapshot_archive *archive, snapshot_head *head)
{
	static const double least_learned = 1e-12, most_learned = 1e12, most_gravity = 1000;
	char word[sizeof magic];
	memcpy(word, magic, sizeof word);
	cau_snapshot_text(archive, "first bytes", word, sizeof word);
	if (memcmp(word, magic, sizeof word) != 0)
		cau_snapshot_refuse(archive, "first bytes");
	int32_t version = (int32_t)head->version;
	cau_snapshot_ints(archive, "version", &version, 1, CAU_SNAPSHOT_VERSION, CAU_SNAPSHOT_VERSION);
	head->version = (uint32_t)version;
	cau_snapshot_bool(archive, "precision", &head->single);
	cau_snapshot_text(archive, "instruction set", head->instruction_set,
	                  sizeof head->instruction_set);
	uint64_t *words[] = {&head->build, &head->definition_hash};
	for (size_t i = 0; i < sizeof words / sizeof *words; i++)
		cau_snapshot_words(archive, "hash", words[i], 1, UINT64_MAX);
	uint64_t *ticks[] = {&head->tick, &head->factor.swap_tick, &head->factor.longest_wait,
	                     &head->factor.version};
	for (size_t i = 0; i < sizeof ticks / sizeof *ticks; i++)
		cau_snapshot_words(archive, "tick", ticks[i], 1, UINT64_MAX / 2);
	pass_counts(archive, head);
	bool *flags[] = {&head->factor.making, &head->faulted, &head->resting};
	for (size_t i = 0; i < sizeof flags / sizeof *flags; i++)
		cau_snapshot_bool(archive, "flag", flags[i]);
	cau_snapshot_doubles(archive, "gravity", head->gravity_m_s2, 3, -most_gravity, most_gravity);
	cau_snapshot_doubles(archive, "accuracy", &head->learned.accuracy, 1, 0, 1);
	cau_snapshot_doubles(archive, "amplification", head->learned.amplification, CAU_ACCURACY_DEPTHS,
	                     least_learned, most_learned);
	cau_snapshot_doubles(archive, "force_left", &head->learned.force_left, 1, least_learned,
	                     most_learned);
	cau_snapshot_doubles(archive, "force_before", head->learned.force_before[0],
	                     3 * CAU_ACCURACY_TOOLS, -most_learned, most_learned);
}

// ---- the arrays

void cau_snapshot_view(const cau_session *session, cau_layer_def *layer, snapshot_state *state)
{
	cau_session *own = (cau_session *)(uintptr_t)session; // the view is only read: see the header
	for (int32_t i = 0; i < session->tissue.layer_count; i++)
		layer[i] = session->tissue.layer[i].def;
	*state = (snapshot_state){.vertices = {.pinned = own->vertices.pinned,
	                                       .fixed = own->vertices.fixed,
	                                       .position = own->vertices.position,
	                                       .velocity = own->vertices.velocity,
	                                       .external = own->vertices.external,
	                                       .diagonal = own->solver.system.diagonal,
	                                       .quiet_from = own->rest.from,
	                                       .exempt_before = own->collide.search.exempt_before},
	                          .dissection = {.exposure = own->dissection.exposure,
	                                         .parted = own->dissection.parted,
	                                         .dose = own->dissection.doses.dose,
	                                         .gone = own->dissection.doses.gone,
	                                         .over = own->dissection.tears.over},
	                          .shrunk = {own->shrink.shrunk[0], own->shrink.shrunk[1]},
	                          .active = own->shrink.active,
	                          .command = own->queue.command,
	                          .layer = layer,
	                          .elements = own->solver.elements,
	                          .waiting = own->update.waiting,
	                          .operation = own->update.operation,
	                          .tool = own->tool,
	                          .memory = own->contact.sides.memory,
	                          .columns = {.vertex = own->contact.columns.vertex,
	                                      .version = own->contact.columns.version,
	                                      .whole = own->contact.columns.whole,
	                                      .inverse = own->contact.columns.inverse},
	                          .cells = own->heat.cells};
	if (own->vessels) {
		state->vessels.fusion = own->vessels->fusion;
		state->vessels.blood_m3 = own->vessels->blood.volume_m3;
		for (int32_t i = 0; i < own->vessels->vessel_count; i++)
			state->vessels.shed_m3[i] = own->vessels->vessel[i].state.shed_m3;
	}
	view_head(session, &state->head);
}

static void pass_vertices(snapshot_archive *archive, const cau_session *session,
                          snapshot_state *state)
{
	static const double farthest_m = 1e6, fastest_m_s = 1e9, most_force_n = 1e6;
	size_t n = (size_t)session->tissue.vertex_count;
	cau_snapshot_octets(archive, "pinned vertex", state->vertices.pinned, n, 1);
	cau_snapshot_octets(archive, "fixed vertex", state->vertices.fixed, n, 1);
	cau_snapshot_doubles(archive, "position", state->vertices.position, 3 * n, -farthest_m,
	                     farthest_m);
	cau_snapshot_doubles(archive, "velocity", state->vertices.velocity, 3 * n, -fastest_m_s,
	                     fastest_m_s);
	cau_snapshot_doubles(archive, "force", state->vertices.external, 3 * n, -most_force_n,
	                     most_force_n);
	cau_snapshot_doubles(archive, "diagonal", state->vertices.diagonal, n, 1e-30, SNAPSHOT_ANY);
	if (state->head.quiet_ticks && !state->head.resting)
		cau_snapshot_doubles(archive, "position at rest", state->vertices.quiet_from, 3 * n,
		                     -farthest_m, farthest_m);
	if (session->scene->contact_thickness_m > 0)
		cau_snapshot_octets(archive, "vertex excluded from contact", state->vertices.exempt_before,
		                    n, 1);
}

static void pass_dissection(snapshot_archive *archive, const cau_session *session,
                            snapshot_state *state)
{
	const cau_tissue *tissue = &session->tissue;
	size_t edges = (size_t)tissue->edges.edge_count;
	size_t doses = (size_t)cau_dissection_dose_count(&session->dissection);
	cau_snapshot_doubles(archive, "exposure", state->dissection.exposure, edges, 0, SNAPSHOT_ANY);
	cau_snapshot_shorts(archive, "parted edge", state->dissection.parted, edges,
	                    (uint16_t)((1u << tissue->layer_count) - 1));
	cau_snapshot_doubles(archive, "dose", state->dissection.dose, doses, 0, SNAPSHOT_ANY);
	cau_snapshot_octets(archive, "parted element", state->dissection.gone, doses, 1);
	for (int32_t i = 0; i < state->head.sizes.over && !archive->wrong; i++) {
		cau_snapshot_ints(archive, "stretched element", &state->dissection.over[i].place, 1, 0,
		                  (int64_t)cau_tears_capacity(tissue) - 1);
		cau_snapshot_ints(archive, "ticks of a stretched element",
		                  &state->dissection.over[i].counted, 1, 0, INT32_MAX / 2);
	}
}

// Passes the shrunk elements: triangles and tetrahedra are the kinds that shrink.
static void pass_shrinking(snapshot_archive *archive, const cau_session *session,
                           snapshot_state *state)
{
	static const double most_stretch = 1e3, oldest_s = 1;
	size_t count[] = {(size_t)session->tissue.triangle_count,
	                  (size_t)session->tissue.tetrahedron_count};
	for (int k = 0; k < 2; k++)
		cau_snapshot_octets(archive, "shrunk element", state->shrunk[k], count[k], 1);
	for (int32_t i = 0; i < state->head.sizes.active && !archive->wrong; i++) {
		cau_shrinking *active = &state->active[i];
		cau_snapshot_ints(archive, "kind of a shrinking element", &active->kind, 1,
		                  CAU_ELEMENT_TRIANGLE, CAU_ELEMENT_TETRAHEDRON);
		if (archive->wrong)
			return;
		cau_snapshot_ints(archive, "shrinking element", &active->element, 1, 0,
		                  (int64_t)cau_tissue_element_count(&session->tissue, active->kind) - 1);
		cau_snapshot_doubles(archive, "target of shrinkage", active->from, 6, -most_stretch,
		                     most_stretch);
		cau_snapshot_doubles(archive, "target of shrinkage", active->to, 6, -most_stretch,
		                     most_stretch);
		cau_snapshot_doubles(archive, "age of shrinkage", &active->age_s, 1, 0, oldest_s);
	}
}

// Passes, for each element, the mark of its whole batch.
static void pass_marks(snapshot_archive *archive, const char *what, uint8_t *mark,
                       const int32_t *slot_of, int32_t count)
{
	for (int32_t e = 0; e < count && !archive->wrong; e++)
		cau_snapshot_octets(archive, what, &mark[slot_of[e] / CAU_BATCH], 1, 1);
}

static void pass_elements(snapshot_archive *archive, const cau_session *session,
                          snapshot_state *state)
{
	static const double most_stretch = 1e3, unit = 2;
	const struct {
		const char *what;
		void *const *array;
		int count, kind;
		double least, most;
	} fields[] = {
		{"target of a triangle", state->elements.sheet.target, 3, CAU_ELEMENT_TRIANGLE,
	     -most_stretch, most_stretch},
		{"rotation of a triangle", state->elements.sheet.polar, 6, CAU_ELEMENT_TRIANGLE, -unit,
	     unit},
		{"limit of a tetrahedron", &state->elements.fat.limit_weight, 1, CAU_ELEMENT_TETRAHEDRON, 0,
	     SNAPSHOT_ANY},
		{"target of a tetrahedron", state->elements.fat.target, 6, CAU_ELEMENT_TETRAHEDRON,
	     -most_stretch, most_stretch},
		{"rotation of a tetrahedron", state->elements.fat.polar, 4, CAU_ELEMENT_TETRAHEDRON, -unit,
	     unit},
		{"plastic strain", state->elements.fat.plastic, 6, CAU_ELEMENT_TETRAHEDRON, -most_stretch,
	     most_stretch},
		{"plastic strain", state->elements.fat.plastic_strain, 6, CAU_ELEMENT_TETRAHEDRON,
	     -most_stretch, most_stretch},
	};
	int32_t *const *slot_of = session->solver.slots.slot_of;
	for (size_t f = 0; f < sizeof fields / sizeof *fields; f++)
		for (int i = 0; i < fields[f].count; i++)
			cau_snapshot_slots(archive, fields[f].what, fields[f].array[i], state->elements.single,
			                   slot_of[fields[f].kind],
			                   (size_t)cau_tissue_element_count(&session->tissue, fields[f].kind),
			                   fields[f].least, fields[f].most);
	const int32_t *fat = slot_of[CAU_ELEMENT_TETRAHEDRON];
	int32_t count = session->tissue.tetrahedron_count;
	pass_marks(archive, "mark of a limit", state->elements.fat.limited, fat, count);
	pass_marks(archive, "mark of plastic strain", state->elements.fat.flowed, fat, count);
}

static void pass_element(snapshot_archive *archive, const cau_session *session, const char *what,
                         int32_t *kind, int32_t *element)
{
	cau_snapshot_ints(archive, what, kind, 1, 0, CAU_ELEMENT_KINDS - 1);
	if (!archive->wrong)
		cau_snapshot_ints(archive, what, element, 1, 0,
		                  (int64_t)cau_tissue_element_count(&session->tissue, *kind) - 1);
}

static void pass_update(snapshot_archive *archive, const cau_session *session,
                        snapshot_state *state)
{
	for (int32_t i = 0; i < state->head.sizes.waiting && !archive->wrong; i++) {
		cau_waiting *waiting = &state->waiting[i];
		pass_element(archive, session, "waiting element", &waiting->kind, &waiting->element);
		cau_snapshot_words(archive, "tick of a waiting element", &waiting->tick, 1,
		                   state->head.tick);
	}
	for (int32_t i = 0; i < state->head.sizes.operations && !archive->wrong; i++) {
		cau_operation *operation = &state->operation[i];
		pass_element(archive, session, "factor operation", &operation->kind, &operation->element);
		cau_snapshot_ints(archive, "operation group", &operation->group, 1, 0,
		                  CAU_DOWNDATES_AT_MOST - 1);
	}
}

// Passes the columns. Their compliance matrix S (`inverse`) is symmetric, so only the lower
// triangle is passed, in the columns' order.
static void pass_columns(snapshot_archive *archive, const cau_session *session,
                         snapshot_state *state)
{
	int32_t count = state->head.sizes.columns;
	cau_snapshot_ints(archive, "vertex of a column", state->columns.vertex, (size_t)count, 0,
	                  session->tissue.vertex_count - 1);
	cau_snapshot_words(archive, "version of a column", state->columns.version, (size_t)count,
	                   state->head.factor.version);
	for (int32_t i = 0; i < count && i < CAU_WHOLE_COLUMNS; i++)
		cau_snapshot_reals(archive, "column", state->columns.whole[i], state->elements.single,
		                   (size_t)session->tissue.vertex_count);
	for (int32_t i = 0; i < count; i++) {
		double *row = state->columns.inverse + (size_t)i * CAU_MAX_COLUMNS;
		cau_snapshot_doubles(archive, "compliance", row, (size_t)i, -SNAPSHOT_ANY, SNAPSHOT_ANY);
		cau_snapshot_doubles(archive, "compliance", row + i, 1, 1e-30, SNAPSHOT_ANY);
	}
}

static void pass_memory(snapshot_archive *archive, const cau_session *session,
                        snapshot_state *state)
{
	for (int32_t i = 0; i < state->head.sizes.memory && !archive->wrong; i++) {
		cau_contact_memory *memory = &state->memory[i];
		cau_snapshot_ints(archive, "tool at a face", &memory->tool, 1, 0,
		                  (int64_t)state->head.sizes.tools - 1);
		cau_snapshot_ints(archive, "face at a tool", &memory->face, 1, 0,
		                  (int64_t)session->tissue.faces.face_count - 1);
		cau_snapshot_ints(archive, "pushed face", &memory->pushed, 1, 0, 1);
		cau_snapshot_ints(archive, "side of a face", &memory->above, 1, -1, 1);
		cau_snapshot_ints(archive, "points of a face", &memory->point_count, 1, 0, CAU_MAX_POINTS);
		cau_snapshot_doubles(archive, "point of a face", memory->point[0], 3 * CAU_MAX_POINTS, 0,
		                     1);
	}
}

static void pass_filled(snapshot_archive *archive, cau_tissue_cells *cells)
{
	int32_t most = cau_tissue_cells_elements(cells), count = cells->filled_count;
	cau_snapshot_ints(archive, "elements with cells", &count, 1, 0, most);
	for (int32_t k = 0; k < count && !archive->wrong; k++) {
		int32_t element = archive->mode == SNAPSHOT_READ ? 0 : cells->filled[k];
		cau_snapshot_ints(archive, "element with cells", &element, 1, 0, (int64_t)most - 1);
		if (archive->mode != SNAPSHOT_READ || archive->wrong)
			continue;
		if (cells->is_filled[element] || !cau_tissue_cells_fill(cells, element))
			cau_snapshot_refuse(archive, "element with cells");
	}
}

// Passes the element with which each cell moves. It is not the element that created the cell if
// that element was removed.
static void pass_owners(snapshot_archive *archive, cau_tissue_cells *cells)
{
	int32_t most = cau_tissue_cells_elements(cells);
	for (int32_t cell = 0; cell < cells->bioheat.cells.count && !archive->wrong; cell++) {
		int32_t owner = cells->owner[cell];
		cau_snapshot_ints(archive, "element of a cell", &owner, 1, 0, (int64_t)most - 1);
		if (archive->mode == SNAPSHOT_READ && !archive->wrong && owner != cells->owner[cell])
			cau_tissue_cells_give(cells, cell, owner);
	}
}

// Passes the cells. Which cells exist follows from the elements and their order; reading creates
// them.
static void pass_cells(snapshot_archive *archive, cau_tissue_cells *cells)
{
	static const double coldest_c = -100, hottest_c = 1e5;
	pass_filled(archive, cells);
	cau_bioheat *bioheat = &cells->bioheat;
	size_t count = (size_t)bioheat->cells.count;
	int32_t announced = (int32_t)count;
	cau_snapshot_ints(archive, "cells", &announced, 1, (int64_t)count, (int64_t)count);
	if (archive->wrong)
		return;
	cau_snapshot_octets(archive, "severed cell", bioheat->cells.severed, count, 1);
	pass_owners(archive, cells);
	cau_snapshot_floats(archive, "fill of a cell", bioheat->cells.fill, count, 1e-6, 1);
	cau_snapshot_floats(archive, "pull of a cell", bioheat->cells.pull, 3 * count,
	                    1 / CAU_PULL_MOST, CAU_PULL_MOST);
	cau_snapshot_doubles(archive, "temperature of a cell", bioheat->temperature, count, coldest_c,
	                     hottest_c);
	cau_snapshot_doubles(archive, "water of a cell", bioheat->water, count, 0, 1);
	cau_snapshot_doubles(archive, "damage of a cell", bioheat->damage, count, 0, SNAPSHOT_ANY);
	cau_snapshot_doubles(archive, "potential of a cell", cells->current.potential, count, 0, 1);
	cau_snapshot_bool(archive, "cold cells", &bioheat->cold);
	cau_energy_ledger *ledger = &bioheat->ledger;
	double *energy[] = {&ledger->delivered_j, &ledger->far_j,    &ledger->blade_j,
	                    &ledger->stored_j,    &ledger->boiled_j, &ledger->perfused_j,
	                    &ledger->ambient_j,   &ledger->shed_j};
	for (size_t i = 0; i < sizeof energy / sizeof *energy; i++)
		cau_snapshot_doubles(archive, "energy", energy[i], 1, -SNAPSHOT_ANY, SNAPSHOT_ANY);
	if (archive->mode == SNAPSHOT_READ)
		bioheat->boiled_w = 0; // there is no step yet
}

static void pass_vessels(snapshot_archive *archive, const cau_vessels *vessels,
                         snapshot_state *state)
{
	cau_snapshot_doubles(archive, "seal of a vessel", state->vessels.fusion,
	                     (size_t)vessels->station_count, 0, SNAPSHOT_ANY);
	cau_snapshot_doubles(archive, "blood at a vertex", state->vessels.blood_m3,
	                     (size_t)vessels->blood.vertex_count, 0, SNAPSHOT_ANY);
	cau_snapshot_doubles(archive, "blood of a vessel", state->vessels.shed_m3,
	                     (size_t)vessels->vessel_count, 0, SNAPSHOT_ANY);
}

void cau_snapshot_pass_state(snapshot_archive *archive, const cau_session *session,
                             snapshot_state *state)
{
	pass_vertices(archive, session, state);
	pass_dissection(archive, session, state);
	pass_shrinking(archive, session, state);
	for (int32_t i = 0; i < session->tissue.layer_count; i++)
		cau_snapshot_pass_layer(archive, &state->layer[i]);
	pass_elements(archive, session, state);
	pass_update(archive, session, state);
	pass_columns(archive, session, state);
	pass_memory(archive, session, state);
	if (state->cells)
		pass_cells(archive, state->cells);
	if (session->vessels)
		pass_vessels(archive, session->vessels, state);
	for (int32_t i = 0; i < state->head.sizes.commands && !archive->wrong; i++)
		cau_snapshot_pass_command(archive, &state->command[i]);
	for (int32_t i = 0; i < state->head.sizes.tools && !archive->wrong; i++)
		cau_snapshot_pass_tool(archive, session, &state->tool[i]);
}

void cau_snapshot_pass_grids(snapshot_archive *archive, snapshot_state *state)
{
	for (int32_t i = 0; i < state->head.sizes.tools && !archive->wrong; i++)
		cau_snapshot_pass_grid(archive, &state->tool[i].grid);
}

uint64_t cau_snapshot_hash(const void *bytes, size_t count)
{
	return cau_hash_bytes(CAU_HASH_START, bytes, count);
}
