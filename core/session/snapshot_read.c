// SPDX-License-Identifier: GPL-3.0-or-later
// Reads a snapshot into copies, and checks that its parts are consistent. A snapshot may come from
// another machine. A right hash is no reason to trust its content.
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "session/snapshot_state.h"

static cau_status corrupt(cau_error *error, const char *why)
{
	return cau_fail(error, CAU_CORRUPT, NULL, "this is not a snapshot of this session: %s", why);
}

static cau_status refuse(const snapshot_archive *archive, cau_error *error)
{
	if (!strcmp(archive->wrong, "version"))
		return cau_fail(error, CAU_CORRUPT, NULL,
		                "the snapshot does not have version %d, which this build reads: "
		                "restore it with the build that wrote it",
		                CAU_SNAPSHOT_VERSION);
	return cau_fail(
		error, CAU_CORRUPT, NULL,
		"this is not a snapshot of this session: %s, at byte %zu, is missing or outside "
		"its range",
		archive->wrong, archive->at);
}

// ---- copies

typedef struct copier {
	cau_arena *arena;
	bool missing;
} copier;

static void *array(copier *copies, size_t count, size_t size)
{
	void *made = cau_arena_array(copies->arena, count, size);
	copies->missing |= !made;
	return made;
}

// Copies the session's arrays, so that the padding has values too.
static void copy_reals(copier *copies, void **reals, int count, int32_t slots, bool single)
{
	for (int i = 0; i < count; i++) {
		reals[i] = cau_arena_copy(copies->arena, reals[i], (size_t)slots, cau_real_bytes(single));
		copies->missing |= !reals[i];
	}
}

static void copy_elements(copier *copies, cau_elements *elements)
{
	cau_sheet_set *sheet = &elements->sheet;
	cau_fat_set *fat = &elements->fat;
	bool single = elements->single;
	copy_reals(copies, sheet->target, 3, sheet->slot_count, single);
	copy_reals(copies, sheet->polar, 6, sheet->slot_count, single);
	copy_reals(copies, &fat->limit_weight, 1, fat->slot_count, single);
	copy_reals(copies, fat->target, 6, fat->slot_count, single);
	copy_reals(copies, fat->polar, 4, fat->slot_count, single);
	copy_reals(copies, fat->plastic, 6, fat->slot_count, single);
	copy_reals(copies, fat->plastic_strain, 6, fat->slot_count, single);
	fat->limited = array(copies, (size_t)(fat->slot_count / CAU_BATCH), 1);
	fat->flowed = array(copies, (size_t)(fat->slot_count / CAU_BATCH), 1);
}

static void make_columns(copier *copies, const cau_session *session, snapshot_state *state)
{
	size_t count = (size_t)state->head.sizes.columns;
	size_t n = (size_t)session->tissue.vertex_count;
	state->columns.vertex = array(copies, count, sizeof(int32_t));
	state->columns.version = array(copies, count, sizeof(uint64_t));
	state->columns.whole = array(copies, CAU_WHOLE_COLUMNS, sizeof *state->columns.whole);
	state->columns.inverse = array(copies, count * CAU_MAX_COLUMNS, sizeof(double));
	for (size_t i = 0; i < count && i < CAU_WHOLE_COLUMNS && !copies->missing; i++)
		state->columns.whole[i] = array(copies, n, cau_real_bytes(state->elements.single));
}

// Allocates the arrays with the sizes in the head. cau_snapshot_read has compared these sizes with
// the session's capacities.
static cau_status make_copies(const cau_session *session, snapshot_state *state, cau_error *error)
{
	copier copies = {.arena = &state->copies};
	const snapshot_head *head = &state->head;
	const cau_tissue *tissue = &session->tissue;
	size_t n = (size_t)tissue->vertex_count, edges = (size_t)tissue->edges.edge_count;
	size_t doses = (size_t)cau_dissection_dose_count(&session->dissection);
	state->vertices.pinned = array(&copies, n, 1);
	state->vertices.fixed = array(&copies, n, 1);
	state->vertices.exempt_before = array(&copies, n, 1);
	state->vertices.position = array(&copies, 3 * n, sizeof(double));
	state->vertices.velocity = array(&copies, 3 * n, sizeof(double));
	state->vertices.external = array(&copies, 3 * n, sizeof(double));
	state->vertices.quiet_from = array(&copies, 3 * n, sizeof(double));
	state->vertices.diagonal = array(&copies, n, sizeof(double));
	state->dissection.exposure = array(&copies, edges, sizeof(double));
	state->dissection.parted = array(&copies, edges, sizeof(uint16_t));
	state->dissection.dose = array(&copies, doses, sizeof(double));
	state->dissection.gone = array(&copies, doses, 1);
	state->shrunk[0] = array(&copies, (size_t)tissue->triangle_count, 1);
	state->shrunk[1] = array(&copies, (size_t)tissue->tetrahedron_count, 1);
	state->active = array(&copies, (size_t)head->sizes.active, sizeof *state->active);
	state->command = array(&copies, (size_t)head->sizes.commands, sizeof *state->command);
	state->waiting = array(&copies, (size_t)head->sizes.waiting, sizeof *state->waiting);
	state->operation = array(&copies, (size_t)head->sizes.operations, sizeof *state->operation);
	state->tool = array(&copies, (size_t)head->sizes.tools, sizeof *state->tool);
	state->memory = array(&copies, (size_t)head->sizes.memory, sizeof *state->memory);
	state->dissection.over =
		array(&copies, (size_t)head->sizes.over, sizeof *state->dissection.over);
	state->layer = array(&copies, (size_t)tissue->layer_count, sizeof *state->layer);
	for (int32_t i = 0; i < tissue->layer_count && state->layer; i++)
		state->layer[i] = tissue->layer[i].def;
	state->elements = session->solver.elements;
	copy_elements(&copies, &state->elements);
	state->cells = session->heat.cells ? array(&copies, 1, sizeof *state->cells) : NULL;
	if (state->cells &&
	    cau_tissue_cells_create_like(state->cells, session->heat.cells, &state->copies, error))
		copies.missing = true;
	if (session->vessels) {
		state->vessels.fusion =
			array(&copies, (size_t)session->vessels->station_count, sizeof(double));
		state->vessels.blood_m3 = array(&copies, n, sizeof(double));
	}
	make_columns(&copies, session, state);
	return copies.missing ? cau_fail(error, CAU_NO_MEMORY, NULL, "no memory to restore") : CAU_OK;
}

void cau_snapshot_drop(snapshot_state *state)
{
	for (int32_t i = 0; i < state->head.sizes.tools && state->tool; i++)
		cau_heat_grid_finish(&state->tool[i].grid);
	cau_arena_finish(&state->copies);
	*state = (snapshot_state){0};
}

// ---- the head

static cau_status check_head(const cau_session *session, const snapshot_head *head,
                             cau_error *error)
{
	const cau_matrix_update *update = &session->update;
	if (head->single != session->solver.elements.single)
		return corrupt(error, "the snapshot has another precision than the session");
	if (head->definition_hash != session->definition_hash ||
	    head->sizes.vertices != session->tissue.vertex_count ||
	    head->sizes.edges != session->tissue.edges.edge_count)
		return corrupt(error, "the snapshot is of another scene or mesh");
	if (head->sizes.commands > session->queue.capacity ||
	    head->sizes.active > session->shrink.active_capacity ||
	    head->sizes.over > cau_tears_capacity(&session->tissue) ||
	    head->sizes.waiting > update->waiting_capacity ||
	    head->factor.waiting_at_start > head->sizes.waiting ||
	    head->inverted > session->tissue.tetrahedron_count || (head->resting && !head->quiet_ticks))
		return corrupt(error, "a count is outside its range");
	if (head->factor.making &&
	    (session->scene->solver == CAU_SOLVER_DIAGONAL || head->factor.swap_tick < head->tick))
		return corrupt(error, "it has a factor under way, which this session cannot have");
	return CAU_OK;
}

// ---- consistency of the parts

// Whether a vertex is within the distance from its rest position at which strays are stopped
// (possible.c). Its velocity must not lead farther than twice that distance in a tick.
static bool is_near(const cau_session *session, const snapshot_state *state, int32_t vertex)
{
	const double rounding = 1 + 1e-9;
	double most = rounding * cau_session_farthest_from_rest(session);
	cau_vec3 at = cau_vec3_of(state->vertices.position + 3 * (size_t)vertex);
	cau_vec3 way = cau_sub(at, cau_vec3_of(session->tissue.rest + 3 * (size_t)vertex));
	cau_vec3 velocity = cau_vec3_of(state->vertices.velocity + 3 * (size_t)vertex);
	return cau_length(way) <= most && cau_length(velocity) * session->solver.step_s <= 2 * most;
}

static bool are_vertices_right(const cau_session *session, const snapshot_state *state)
{
	int32_t free_count = 0;
	for (int32_t v = 0; v < state->head.sizes.vertices; v++) {
		if ((state->vertices.pinned[v] && !state->vertices.fixed[v]) || !is_near(session, state, v))
			return false;
		free_count += !state->vertices.pinned[v];
	}
	return free_count > 0;
}

// Finds the living elements by kind, from the parted edges: 1 for an element that is still there.
// Returns their memory, which the caller frees.
static uint8_t *find_alive(const cau_session *session, const snapshot_state *state,
                           uint8_t *alive[CAU_ELEMENT_KINDS])
{
	size_t total = 1;
	for (int kind = 0; kind < CAU_ELEMENT_KINDS; kind++)
		total += (size_t)cau_tissue_element_count(&session->tissue, kind);
	uint8_t *marks = malloc(total), *next = marks;
	for (int kind = 0; kind < CAU_ELEMENT_KINDS && marks; kind++) {
		alive[kind] = next;
		next += cau_tissue_element_count(&session->tissue, kind);
	}
	const uint8_t *gone =
		cau_dissection_dose_count(&session->dissection) ? state->dissection.gone : NULL;
	if (marks)
		cau_dissection_find_alive(&session->tissue, state->dissection.parted, gone, alive);
	return marks;
}

// Marks an element that left the factor, or will leave it. Returns false if the element lives or
// was marked before, because such an element must be dead and listed once.
static bool takes(uint8_t *const alive[CAU_ELEMENT_KINDS], int32_t kind, int32_t element)
{
	bool dead = !alive[kind][element];
	alive[kind][element] = 1;
	return dead;
}

// Checks the lists, and marks the listed elements in `alive`. Afterwards `alive` is scratch memory.
static bool are_lists_right(const snapshot_state *state, uint8_t *const alive[CAU_ELEMENT_KINDS])
{
	for (int32_t k = 0; k < state->head.sizes.waiting; k++)
		if (!takes(alive, state->waiting[k].kind, state->waiting[k].element) ||
		    (k && state->waiting[k].tick < state->waiting[k - 1].tick))
			return false;
	for (int32_t k = 0; k < state->head.sizes.operations; k++)
		if (!takes(alive, state->operation[k].kind, state->operation[k].element) ||
		    state->operation[k].group >= state->head.factor.group_count ||
		    (k && state->operation[k].group < state->operation[k - 1].group))
			return false;
	for (int32_t k = 1; k < state->head.sizes.over; k++)
		if (state->dissection.over[k].place <= state->dissection.over[k - 1].place)
			return false;
	return true;
}

static int compare_shrinking(const void *a, const void *b)
{
	const cau_shrinking *x = a, *y = b;
	if (x->kind != y->kind)
		return x->kind < y->kind ? -1 : 1;
	return (x->element > y->element) - (x->element < y->element);
}

static bool is_shrinkage_right(const snapshot_state *state)
{
	for (int32_t k = 0; k < state->head.sizes.active; k++) {
		const cau_shrinking *active = &state->active[k];
		if (!state->shrunk[active->kind][active->element])
			return false;
		int diagonal = active->kind == CAU_ELEMENT_TRIANGLE ? 2 : 3;
		for (int i = 0; i < diagonal; i++)
			if (!(active->from[i] > 0 && active->to[i] > 0))
				return false;
	}
	size_t count = (size_t)state->head.sizes.active;
	cau_shrinking *sorted = malloc((count + 1) * sizeof *sorted);
	if (!sorted)
		return false;
	memcpy(sorted, state->active, count * sizeof *sorted);
	qsort(sorted, count, sizeof *sorted, compare_shrinking);
	bool once = true;
	for (size_t k = 1; k < count; k++)
		once &= compare_shrinking(&sorted[k - 1], &sorted[k]) != 0;
	free(sorted);
	return once;
}

// Whether a column moves a pinned vertex, which no load can do.
static bool moves_a_pin(const cau_session *session, const snapshot_state *state, int32_t column)
{
	const cau_vectors *vectors = session->solver.kernels->vectors;
	for (int32_t v = 0; v < session->tissue.vertex_count; v++)
		if (state->vertices.pinned[v] && vectors->at(state->columns.whole[column], v) != 0)
			return true;
	return false;
}

// Whether the columns belong to different vertices, none of them pinned.
static bool are_columns_right(const cau_session *session, const snapshot_state *state)
{
	uint8_t *taken = calloc((size_t)session->tissue.vertex_count + 1, 1);
	bool right = taken != NULL;
	for (int32_t k = 0; k < state->head.sizes.columns && right; k++) {
		int32_t vertex = state->columns.vertex[k];
		right = !state->vertices.pinned[vertex] && !taken[vertex] &&
		        (k >= CAU_WHOLE_COLUMNS || !moves_a_pin(session, state, k));
		taken[vertex] = 1;
	}
	free(taken);
	return right;
}

static bool are_sides_right(const snapshot_state *state)
{
	for (int32_t k = 0; k < state->head.sizes.memory; k++) {
		const cau_contact_memory *memory = &state->memory[k], *before = memory - 1;
		if (!memory->above)
			return false;
		if (k && (memory->tool < before->tool ||
		          (memory->tool == before->tool && memory->face <= before->face)))
			return false;
	}
	return true;
}

static cau_status check_arrays(const cau_session *session, const snapshot_state *state,
                               cau_error *error)
{
	if (!are_vertices_right(session, state))
		return corrupt(error, "a vertex has impossible pins or an impossible position");
	uint8_t *alive[CAU_ELEMENT_KINDS], *marks = find_alive(session, state, alive);
	if (!marks)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory to restore");
	bool right = are_lists_right(state, alive);
	free(marks);
	if (!right)
		return corrupt(error, "an element is both in the factor and removed from it");
	if (!is_shrinkage_right(state))
		return corrupt(error, "an element shrinks twice, or to size 0");
	if (!are_columns_right(session, state) || !are_sides_right(state))
		return corrupt(error, "the list of faces at tools is damaged");
	return CAU_OK;
}

// ---- records

static bool is_grasp_right(const cau_session *session, const cau_grasp *grasp)
{
	const int32_t *corner =
		session->tissue.faces.vertex + 3 * (size_t)(grasp->face < 0 ? 0 : grasp->face);
	if (grasp->face < 0)
		return grasp->vertex[1] == -1 && grasp->vertex[2] == -1;
	double sum = 0;
	for (int k = 0; k < 3; k++) {
		if (grasp->vertex[k] != corner[k])
			return false;
		sum += grasp->weight[k];
	}
	return sum > 0.99 && sum < 1.01;
}

// Whether all poses of the tool have valid rotations, as commands require.
static bool are_poses_right(const cau_tool *tool)
{
	const cau_pose *poses[] = {&tool->state.pose, &tool->state.asked_pose, &tool->target,
	                           &tool->anchor, &tool->pose_before};
	cau_error why = {0};
	for (size_t i = 0; i < sizeof poses / sizeof *poses; i++)
		if (cau_pose_check(poses[i], "", &why))
			return false;
	return true;
}

static bool has_jaws(const cau_tool_def *def)
{
	static const bool jaws[] = {
#define JAWS(code, word, hot, jaws, text) jaws,
		CAU_TOOL_SHAPE_TABLE(JAWS)
#undef JAWS
	};
	return jaws[def->shape];
}

static cau_status check_tool(const cau_session *session, const snapshot_state *state, int32_t index,
                             cau_error *error)
{
	const cau_tool *tool = &state->tool[index];
	cau_error why = {0};
	if (cau_tool_check(&tool->state.definition, "tool", session->solver.step_s, &why))
		return corrupt(error, why.reason);
	if (strcmp(tool->state.name, tool->state.definition.name) != 0 || !are_poses_right(tool))
		return corrupt(error, "the name or the pose of a tool is damaged");
	for (int32_t i = 0; i < index; i++)
		if (!strcmp(state->tool[i].state.name, tool->state.name))
			return corrupt(error, "two tools have the same name");
	if ((tool->state.grasping && !has_jaws(&tool->state.definition)) ||
	    (tool->grasp_count && !tool->state.grasping))
		return corrupt(error, "the grasp of a tool is damaged");
	for (int32_t k = 0; k < tool->grasp_count; k++)
		if (!is_grasp_right(session, &tool->grasp[k]))
			return corrupt(error, "the grasp of a tool is damaged");
	return CAU_OK;
}

static cau_status check_command(const cau_session *session, const cau_command *command,
                                cau_error *error)
{
	cau_error why = {0};
	if (cau_command_check(session, command, &why))
		return corrupt(error, why.reason);
	return CAU_OK;
}

static cau_status check_records(const cau_session *session, const snapshot_state *state,
                                cau_error *error)
{
	cau_status status = CAU_OK;
	cau_error why = {0};
	for (int32_t i = 0; i < session->tissue.layer_count && !status; i++) {
		const cau_layer_def *layer = &state->layer[i];
		for (int32_t m = 0; m < layer->material_count && !status; m++)
			if (cau_material_check(layer->kind, cau_layer_material(layer, m), "material", &why))
				status = corrupt(error, why.reason);
	}
	for (int32_t i = 0; i < state->head.sizes.tools && !status; i++)
		status = check_tool(session, state, i, error);
	for (int32_t i = 0; i < state->head.sizes.commands && !status; i++)
		status = check_command(session, &state->command[i], error);
	return status;
}

static cau_status make_grids(const cau_session *session, snapshot_state *state, cau_error *error)
{
	cau_status status = CAU_OK;
	for (int32_t i = 0; i < state->head.sizes.tools && !status; i++) {
		cau_tool *tool = &state->tool[i];
		status =
			cau_heat_grid_create(&tool->grid, &tool->state.definition, session->scene->ambient_c,
		                         session->solver.step_s, &tool->state.pose, error);
	}
	return status;
}

// ---- the whole snapshot

static cau_status read_arrays(const cau_session *session, snapshot_archive *archive,
                              snapshot_state *state, cau_error *error)
{
	cau_snapshot_pass_state(archive, session, state);
	if (archive->wrong)
		return refuse(archive, error);
	cau_status status = check_arrays(session, state, error);
	if (!status)
		status = check_records(session, state, error);
	if (!status)
		status = make_grids(session, state, error);
	if (status)
		return status;
	cau_snapshot_pass_grids(archive, state);
	if (archive->wrong)
		return refuse(archive, error);
	return archive->at == archive->capacity
	           ? CAU_OK
	           : corrupt(error, "the snapshot is longer than its content");
}

cau_status cau_snapshot_read(const cau_session *session, const void *bytes, size_t byte_count,
                             snapshot_state *state, cau_error *error)
{
	*state = (snapshot_state){0};
	if (byte_count < CAU_SNAPSHOT_HASH_BYTES)
		return corrupt(error, "the snapshot is too short");
	snapshot_archive archive = {.mode = SNAPSHOT_READ,
	                            .bytes = (unsigned char *)(uintptr_t)bytes,
	                            .capacity = byte_count - CAU_SNAPSHOT_HASH_BYTES};
	snapshot_head head = {0};
	cau_snapshot_pass_head(&archive, &head);
	if (archive.wrong)
		return refuse(&archive, error);
	snapshot_archive end = archive;
	uint64_t hash = 0;
	end.at = archive.capacity;
	end.capacity = byte_count;
	cau_snapshot_words(&end, "hash", &hash, 1, UINT64_MAX);
	if (hash != cau_snapshot_hash(bytes, archive.capacity))
		return corrupt(error, "the checksum does not match the bytes");
	cau_status status = check_head(session, &head, error);
	if (status)
		return status;
	state->head = head;
	status = make_copies(session, state, error);
	return status ? status : read_arrays(session, &archive, state, error);
}
