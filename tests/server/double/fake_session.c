// SPDX-License-Identifier: GPL-3.0-or-later
// A test double of the core. It implements cautery/session.h with a small deterministic sheet, so
// that the server is tested without physics. An energized tool removes nearby faces. Positions move
// in waves with time and gravity. Everything is a function of the definition and the commands. Only
// tests link it.
#include "fake_session.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "cautery/defaults.h"
#include "cautery/mesh_scene.h"
#include "cautery/session.h"
#include "cautery/solid.h"

#ifndef CAU_FAKE_CELLS
#define CAU_FAKE_CELLS 16
#endif

enum {
	CELLS = CAU_FAKE_CELLS, // cells along each side of the sheet
	SIDE = CELLS + 1,
	VERTICES = SIDE * SIDE,
	FACES = 2 * CELLS * CELLS,
	WORDS = (FACES + 31) / 32,
	QUEUE = 64,
	MAGIC = 0x46414b45,
};

typedef struct fake_state { // everything that a snapshot holds
	uint64_t tick;
	double gravity[3];
	double position[VERTICES * 3];
	uint32_t mask[WORDS];
	float exposure[VERTICES], charring[VERTICES];
	int32_t removed;
	int32_t tool_count;
	cau_tool_state tools[CAU_MAX_TOOLS];
	cau_pose target[CAU_MAX_TOOLS];
	// A force of 1000 N along x faults the session at this tick, which is the tick after the force.
	uint64_t trouble_tick;
	bool faulted;
	int32_t queued;
	cau_command queue[QUEUE]; // must be last: snapshots hold only its used part
} fake_state;

#define SLOW_STEP_S 0.05 // wall time of a slow step, s: three times the period of 60 Hz

struct cau_session {
	fake_state state;
	char name[CAU_NAME_BYTES], description[CAU_TEXT_BYTES];
	double step_s;
	bool tension;
	uint64_t tissue_hash;
	bool slow; // steps take SLOW_STEP_S; set by a force of 1000 N along y, cleared by another force
	double velocity[VERTICES * 3], rest[VERTICES * 3];
	int32_t face[FACES * 3], face_layer[FACES];
	int32_t moved[VERTICES], mask_changed[WORDS];
	int32_t moved_count, mask_changed_count;
	uint8_t visible[VERTICES], alive[FACES];
	cau_error refusals[QUEUE];
	int32_t refusal_count;
	uint32_t watched;
	float scalar[VERTICES]; // values of every watched scalar
};

cau_fake_hooks cau_fake_hooks_set;

cau_session_def cau_default_session_def(void)
{
	return (cau_session_def){.thread_count = 1, .command_capacity = QUEUE};
}

cau_status cau_scene_check(const cau_scene_def *scene, cau_error *error)
{
	return scene->layer_count ? CAU_OK : cau_fail(error, CAU_BAD_VALUE, "layers", "none");
}

static void build_sheet(cau_session *s)
{
	for (int32_t y = 0, v = 0; y < SIDE; y++)
		for (int32_t x = 0; x < SIDE; x++, v++) {
			s->rest[3 * v] = 0.12 * ((double)x / CELLS - 0.5);
			s->rest[3 * v + 1] = 0.12 * ((double)y / CELLS - 0.5);
			s->visible[v] = 1;
		}
	for (int32_t y = 0, f = 0; y < CELLS; y++)
		for (int32_t x = 0; x < CELLS; x++, f += 2) {
			int32_t a = y * SIDE + x, c = a + SIDE;
			const int32_t corner[6] = {a, a + 1, c, a + 1, c + 1, c};
			memcpy(&s->face[3 * f], corner, sizeof corner);
			s->alive[f] = s->alive[f + 1] = 1;
		}
	memcpy(s->state.position, s->rest, sizeof s->rest);
}

static void add_tool(cau_session *s, const cau_tool_def *definition)
{
	int32_t i = s->state.tool_count++;
	cau_tool_state *tool = &s->state.tools[i];
	memset(tool, 0, sizeof *tool);
	memcpy(tool->name, definition->name, sizeof tool->name);
	tool->definition = *definition;
	tool->pose = tool->asked_pose = s->state.target[i] = definition->pose;
	tool->tip_temperature_c = 37;
}

static void come_to(cau_build_stage next)
{
	if (cau_fake_hooks_set.build)
		cau_fake_hooks_set.build(next);
}

// Calls the border function of each stage, with the sizes of this sheet.
static cau_status pass_borders(const cau_session_def *def, cau_error *error)
{
	cau_status status = CAU_OK;
	for (int next = 0; next < CAU_BUILD_STAGE_COUNT && !status; next++) {
		come_to((cau_build_stage)next);
		cau_build_border border = {.next = (cau_build_stage)next,
		                           .vertex_count = VERTICES,
		                           .element_count = FACES,
		                           .bytes = sizeof(cau_session)};
		status = def->border ? def->border(def->user, &border, error) : CAU_OK;
	}
	if (!status)
		come_to(CAU_BUILD_STAGE_COUNT);
	return status;
}

cau_status cau_session_create(const cau_session_def *def, cau_session **made, cau_error *error)
{
	cau_status status = cau_scene_check(def->scene, error);
	*made = NULL;
	if (!status)
		status = pass_borders(def, error);
	if (status)
		return status;
	cau_session *s = calloc(1, sizeof *s);
	if (!s)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory");
	memcpy(s->name, def->scene->name, sizeof s->name);
	memcpy(s->description, def->scene->description, sizeof s->description);
	s->step_s = def->scene->step_s;
	memcpy(s->state.gravity, def->scene->gravity_m_s2, sizeof s->state.gravity);
	s->tension = cau_fake_hooks_set.tension;
	s->tissue_hash = cau_fake_hooks_set.tissue_hash;
	build_sheet(s);
	for (int32_t i = 0; i < def->scene->tool_count; i++)
		add_tool(s, &def->scene->tools[i]);
	*made = s;
	if (cau_fake_hooks_set.made)
		cau_fake_hooks_set.made(def, s);
	return CAU_OK;
}

bool cau_session_has_tension(const cau_session *s)
{
	return s->tension;
}

size_t cau_session_share(cau_session *s)
{
	(void)s;
	return 0;
}

uint64_t cau_session_tissue_hash(const cau_session *s)
{
	return s->tissue_hash;
}

void cau_session_destroy(cau_session *s)
{
	if (s && cau_fake_hooks_set.going)
		cau_fake_hooks_set.going(s);
	free(s);
}

cau_status cau_session_adopt(cau_session *s, cau_error *error)
{
	(void)s;
	(void)error;
	return CAU_OK;
}

void cau_session_set_threads(cau_session *s, int32_t thread_count)
{
	(void)s, (void)thread_count;
}

static int32_t find_tool(const cau_session *s, const char *name)
{
	for (int32_t i = 0; i < s->state.tool_count; i++)
		if (strcmp(s->state.tools[i].name, name) == 0)
			return i;
	return -1;
}

static bool is_about_tool(const cau_command *c)
{
	return (c->kind >= CAU_COMMAND_TOOL_REMOVE && c->kind <= CAU_COMMAND_TOOL_RELEASE) ||
	       c->kind == CAU_COMMAND_TOOL_HOLD;
}

static bool is_off(const cau_command *c)
{
	return c->kind == CAU_COMMAND_TOOL_ENERGIZE && !c->as.energized;
}

static void take_out(cau_session *s, const char *tool, bool enables_only)
{
	int32_t kept = 0;
	for (int32_t i = 0; i < s->state.queued; i++) {
		const cau_command *c = &s->state.queue[i];
		bool which = !enables_only || c->kind == CAU_COMMAND_TOOL_ENERGIZE;
		if (!is_about_tool(c) || strcmp(c->tool, tool) != 0 || !which)
			s->state.queue[kept++] = *c;
	}
	s->state.queued = kept;
}

void cau_session_energy_off(cau_session *s, const char *tool, uint64_t sequence)
{
	int32_t i = find_tool(s, tool);
	if (cau_fake_hooks_set.breaks_off && cau_fake_hooks_set.breaks_off())
		return;
	take_out(s, tool, true);
	if (i < 0)
		return;
	s->state.tools[i].energized = false;
	s->state.tools[i].tip_temperature_c = 37;
	if (sequence)
		s->state.tools[i].sequence = sequence;
}

void cau_session_hold_still(cau_session *s, const char *tool, uint64_t sequence)
{
	int32_t i = find_tool(s, tool);
	take_out(s, tool, false);
	if (i < 0)
		return;
	s->state.target[i] = s->state.tools[i].pose;
	if (sequence)
		s->state.tools[i].sequence = sequence;
}

int32_t cau_session_waiting(const cau_session *s, const char *tool)
{
	int32_t count = 0;
	for (int32_t i = 0; i < s->state.queued; i++)
		count += is_about_tool(&s->state.queue[i]) && strcmp(s->state.queue[i].tool, tool) == 0;
	return count;
}

static bool is_among(const char *name, const char *const *names, int32_t count)
{
	for (int32_t i = 0; i < count; i++)
		if (strcmp(names[i], name) == 0)
			return true;
	return false;
}

const char *cau_session_heats_beyond(const cau_session *s, const char *const *allowed,
                                     int32_t count)
{
	for (int32_t i = 0; i < s->state.tool_count; i++)
		if (s->state.tools[i].energized && !is_among(s->state.tools[i].name, allowed, count))
			return s->state.tools[i].name;
	for (int32_t i = 0; i < s->state.queued; i++) {
		const cau_command *c = &s->state.queue[i];
		if (c->kind == CAU_COMMAND_TOOL_ENERGIZE && c->as.energized &&
		    !is_among(c->tool, allowed, count))
			return c->tool;
	}
	return NULL;
}

cau_status cau_session_may_submit(const cau_session *s, const cau_command *commands, int32_t count,
                                  int32_t *index, cau_error *error)
{
	for (*index = 0; *index < count; ++*index)
		if (is_about_tool(&commands[*index]) && find_tool(s, commands[*index].tool) < 0)
			return cau_fail(error, CAU_NOT_FOUND, "tool", "no tool %s", commands[*index].tool);
	if (s->state.queued + count > QUEUE)
		return cau_fail(error, CAU_LIMIT, NULL, "queue full");
	return CAU_OK;
}

cau_status cau_session_submit(cau_session *s, const cau_command *c, cau_error *error)
{
	if (cau_fake_hooks_set.submit)
		cau_fake_hooks_set.submit(c);
	if (cau_fake_hooks_set.taking)
		cau_fake_hooks_set.taking(s, c);
	bool about_tool = is_about_tool(c);
	if (about_tool && find_tool(s, c->tool) < 0)
		return cau_fail(error, CAU_NOT_FOUND, "tool", "no tool %s", c->tool);
	if (c->kind == CAU_COMMAND_TOOL_ADD && find_tool(s, c->as.definition.name) >= 0)
		return cau_fail(error, CAU_ALREADY_EXISTS, "name", "taken");
	if (is_off(c) && c->tick <= s->state.tick) {
		cau_session_energy_off(s, c->tool, c->sequence);
		return CAU_OK;
	}
	if (c->kind == CAU_COMMAND_TOOL_HOLD && c->tick <= s->state.tick) {
		cau_session_hold_still(s, c->tool, c->sequence);
		return CAU_OK;
	}
	if (s->state.queued == QUEUE)
		return cau_fail(error, CAU_LIMIT, NULL, "queue full");
	s->state.queue[s->state.queued++] = *c;
	return CAU_OK;
}

static void apply(cau_session *s, const cau_command *c)
{
	int32_t i = find_tool(s, c->tool);
	fake_state *state = &s->state;
	if (c->kind == CAU_COMMAND_TOOL_ADD && state->tool_count < CAU_MAX_TOOLS)
		add_tool(s, &c->as.definition);
	else if (c->kind == CAU_COMMAND_SET_GRAVITY)
		memcpy(state->gravity, c->as.gravity_m_s2, sizeof state->gravity);
	else if (c->kind == CAU_COMMAND_SET_FORCE && c->as.force.force_n[0] >= 1000)
		state->trouble_tick = state->tick + 1;
	else if (c->kind == CAU_COMMAND_SET_FORCE)
		s->slow = c->as.force.force_n[1] >= 1000;
	if (i < 0)
		return;
	state->tools[i].sequence = c->sequence;
	if (c->kind == CAU_COMMAND_TOOL_MOVE) {
		state->target[i] = c->as.move.pose;
		state->tools[i].jaw = c->as.move.jaw;
	} else if (c->kind == CAU_COMMAND_TOOL_ENERGIZE) {
		state->tools[i].energized = c->as.energized;
		state->tools[i].tip_temperature_c = c->as.energized ? 170 : 37;
	} else if (c->kind == CAU_COMMAND_TOOL_GRASP || c->kind == CAU_COMMAND_TOOL_RELEASE) {
		state->tools[i].grasping = c->kind == CAU_COMMAND_TOOL_GRASP;
	} else if (c->kind == CAU_COMMAND_TOOL_CONFIGURE) {
		state->tools[i].definition = c->as.definition;
	} else if (c->kind == CAU_COMMAND_TOOL_REMOVE) {
		for (int32_t j = i; j + 1 < state->tool_count; j++) {
			state->tools[j] = state->tools[j + 1];
			state->target[j] = state->target[j + 1];
		}
		state->tool_count--;
	}
}

static void apply_due(cau_session *s)
{
	int32_t kept = 0;
	for (int32_t i = 0; i < s->state.queued; i++) {
		cau_command *c = &s->state.queue[i];
		if (c->tick <= s->state.tick)
			apply(s, c);
		else
			s->state.queue[kept++] = *c;
	}
	s->state.queued = kept;
}

static void move_tool(cau_session *s, int32_t i)
{
	cau_tool_state *tool = &s->state.tools[i];
	double most_m = tool->definition.max_speed_m_s * s->step_s, length = 0, way[3];
	for (int k = 0; k < 3; k++) {
		way[k] = s->state.target[i].position_m[k] - tool->pose.position_m[k];
		length += way[k] * way[k];
	}
	length = sqrt(length);
	double share = length > most_m ? most_m / length : 1;
	for (int k = 0; k < 3; k++)
		tool->pose.position_m[k] += share * way[k];
	memcpy(tool->pose.rotation, s->state.target[i].rotation, sizeof tool->pose.rotation);
	// the double has no contact, so the tool reaches its commanded pose
	tool->asked_pose = tool->pose;
	tool->asked_jaw = tool->jaw;
}

static void cut(cau_session *s, const cau_tool_state *tool)
{
	double reach = tool->definition.hot_radius_m;
	for (int32_t f = 0; f < FACES; f++) {
		const double *p = &s->state.position[3 * s->face[3 * f]];
		double x = p[0] - tool->pose.position_m[0], y = p[1] - tool->pose.position_m[1];
		if (!s->alive[f] || x * x + y * y > reach * reach)
			continue;
		s->alive[f] = 0;
		s->state.mask[f / 32] |= 1u << (f % 32);
		s->state.removed++;
		s->state.exposure[s->face[3 * f]] = 1;
		s->state.charring[s->face[3 * f]] = 0.5f;
	}
}

static void wave(cau_session *s)
{
	double time_s = (double)s->state.tick * s->step_s;
	s->moved_count = 0;
	for (int32_t v = 0; v < VERTICES; v++) {
		double z = 1e-3 * sin(40 * s->rest[3 * v] + 2 * time_s) * (s->state.gravity[2] / -9.81);
		if (z == s->state.position[3 * v + 2])
			continue;
		s->state.position[3 * v + 2] = z;
		s->moved[s->moved_count++] = v;
	}
}

cau_status cau_session_step(cau_session *s, cau_error *error)
{
	uint32_t before[WORDS];
	if (s->state.faulted)
		return cau_fail(error, CAU_FAULTED, NULL, "faulted");
	memcpy(before, s->state.mask, sizeof before);
	apply_due(s);
	if (cau_fake_hooks_set.step)
		cau_fake_hooks_set.step(s);
	if (s->slow)
		nanosleep(&(struct timespec){0, (long)(SLOW_STEP_S * 1e9)}, NULL);
	if (s->state.trouble_tick && s->state.tick >= s->state.trouble_tick) {
		s->state.faulted = true;
		return cau_fail(error, CAU_NUMERICAL, NULL, "a force beyond reason");
	}
	for (int32_t i = 0; i < s->state.tool_count; i++) {
		move_tool(s, i);
		if (s->state.tools[i].energized)
			cut(s, &s->state.tools[i]);
	}
	s->state.tick++;
	wave(s);
	s->mask_changed_count = 0;
	for (int32_t w = 0; w < WORDS; w++)
		if (before[w] != s->state.mask[w])
			s->mask_changed[s->mask_changed_count++] = w;
	return CAU_OK;
}

void cau_session_describe(const cau_session *s, cau_session_info *info)
{
	*info = (cau_session_info){.step_s = s->step_s,
	                           .vertex_count = VERTICES,
	                           .face_count = FACES,
	                           .triangle_count = FACES,
	                           .edge_count = FACES + VERTICES - 1,
	                           .layer_count = 1,
	                           .face = s->face,
	                           .face_layer = s->face_layer,
	                           .rest_position = s->rest,
	                           .instruction_set = "double"};
	memcpy(info->name, s->name, sizeof info->name);
	memcpy(info->description, s->description, sizeof info->description);
	info->layers[0] =
		(cau_session_layer){.name = "sheet", .face_count = FACES, .element_count = FACES};
}

void cau_session_frame(const cau_session *s, cau_frame *frame)
{
	*frame = (cau_frame){.tick = s->state.tick,
	                     .time_s = (double)s->state.tick * s->step_s,
	                     .position = s->state.position,
	                     .velocity = s->velocity,
	                     .moved_count = s->moved_count,
	                     .moved = s->moved,
	                     .face_mask = s->state.mask,
	                     .mask_changed_count = s->mask_changed_count,
	                     .mask_changed = s->mask_changed,
	                     .vertex_visible = s->visible,
	                     .tool_count = s->state.tool_count,
	                     .tools = s->state.tools,
	                     .statistics = {.elements_removed = s->state.removed}};
	for (int i = 0; i < CAU_SCALAR_COUNT; i++)
		frame->scalar[i] = s->watched & cau_scalar_channel((cau_scalar)i) ? s->scalar : NULL;
	frame->exposure = s->state.exposure;
	frame->charring = s->state.charring;
}

void cau_session_set_clock(cau_session *s, double (*now_s)(void))
{
	(void)s, (void)now_s;
}

// Writes the present state to the scene. Of queued commands, only gravity is included.
void cau_session_present(const cau_session *s, cau_scene_def *scene)
{
	memcpy(scene->gravity_m_s2, s->state.gravity, sizeof scene->gravity_m_s2);
	scene->tool_count = s->state.tool_count;
	for (int32_t i = 0; i < s->state.tool_count; i++) {
		const cau_tool_state *tool = &s->state.tools[i];
		scene->tools[i] = tool->definition;
		memcpy(scene->tools[i].name, tool->name, sizeof tool->name);
		scene->tools[i].pose = tool->pose;
	}
	for (int32_t i = 0; i < s->state.queued; i++)
		if (s->state.queue[i].kind == CAU_COMMAND_SET_GRAVITY)
			memcpy(scene->gravity_m_s2, s->state.queue[i].as.gravity_m_s2,
			       sizeof scene->gravity_m_s2);
}

void cau_session_watch(cau_session *s, uint32_t channels)
{
	s->watched = channels;
	for (int32_t v = 0; v < VERTICES; v++)
		s->scalar[v] = 37;
}

void cau_session_alive(const cau_session *s, const uint8_t **tetrahedron, const uint8_t **triangle,
                       const uint8_t **link)
{
	*tetrahedron = *link = NULL;
	*triangle = s->alive;
}

void cau_session_damage(const cau_session *s, const cau_selection *region, cau_damage *inside,
                        cau_damage *outside)
{
	(void)s, (void)region;
	*inside = *outside = (cau_damage){0};
}

size_t cau_session_snapshot_bytes(const cau_session *s)
{
	return sizeof(int32_t) + sizeof s->state;
}

static size_t used_bytes(const fake_state *state)
{
	return offsetof(fake_state, queue) + (size_t)state->queued * sizeof *state->queue;
}

cau_status cau_session_snapshot(const cau_session *s, void *bytes, size_t capacity, size_t *count,
                                cau_error *error)
{
	int32_t magic = MAGIC;
	*count = sizeof magic + used_bytes(&s->state);
	if (capacity < *count)
		return cau_fail(error, CAU_LIMIT, NULL, "too small");
	memcpy(bytes, &magic, sizeof magic);
	memcpy((char *)bytes + sizeof magic, &s->state, used_bytes(&s->state));
	return CAU_OK;
}

cau_status cau_session_restore(cau_session *s, const void *bytes, size_t count, bool *exact,
                               cau_error *error)
{
	int32_t magic = 0, queued = -1;
	const char *state = (const char *)bytes + sizeof magic;
	if (count >= sizeof magic + offsetof(fake_state, queue)) {
		memcpy(&magic, bytes, sizeof magic);
		memcpy(&queued, state + offsetof(fake_state, queued), sizeof queued);
	}
	bool whole = queued >= 0 && queued <= QUEUE &&
	             count == sizeof magic + offsetof(fake_state, queue) +
	                          (size_t)queued * sizeof *s->state.queue;
	if (magic != MAGIC || !whole)
		return cau_fail(error, CAU_CORRUPT, NULL, "not a snapshot");
	cau_status status = cau_fake_hooks_set.restore ? cau_fake_hooks_set.restore() : CAU_OK;
	if (status) {
		memset(&s->state.position, 0, sizeof s->state.position);
		return cau_fail(error, status, NULL, "half restored");
	}
	memcpy(&s->state, state, count - sizeof magic);
	for (int32_t f = 0; f < FACES; f++)
		s->alive[f] = !(s->state.mask[f / 32] >> (f % 32) & 1);
	*exact = true;
	return CAU_OK;
}

const double *cau_fake_gravity(const cau_session *s)
{
	const double *gravity = s->state.gravity;
	for (int32_t i = 0; i < s->state.queued; i++)
		if (s->state.queue[i].kind == CAU_COMMAND_SET_GRAVITY)
			gravity = s->state.queue[i].as.gravity_m_s2;
	return gravity;
}

uint64_t cau_session_hash(const cau_session *s)
{
	const unsigned char *byte = (const unsigned char *)&s->state;
	uint64_t hash = 14695981039346656037u;
	for (size_t i = 0; i < offsetof(fake_state, trouble_tick); i++)
		hash = (hash ^ byte[i]) * 1099511628211u;
	return hash;
}

cau_status cau_session_balance(cau_session *s, cau_balance *balance)
{
	(void)s;
	*balance = (cau_balance){0};
	return CAU_OK;
}

double cau_session_coagulated(const cau_session *s)
{
	(void)s;
	return 0;
}

double cau_session_vaporised(const cau_session *s)
{
	(void)s;
	return 0;
}

double cau_session_vapour(const cau_session *s)
{
	(void)s;
	return 0;
}

void cau_session_read_ledger(const cau_session *s, cau_energy_ledger *ledger)
{
	(void)s;
	*ledger = (cau_energy_ledger){0};
}

cau_status cau_mesh_scene(const cau_mesh_wish *wish, cau_scene_def *scene, cau_mesh_report *report,
                          cau_error *error)
{
	(void)scene;
	(void)report;
	return cau_fail(error, CAU_UNSUPPORTED, "", "the double reads no mesh, not %s", wish->file);
}

bool cau_solid_is_volume(const void *bytes, size_t byte_count)
{
	(void)bytes;
	(void)byte_count;
	return false; // the double knows only surface meshes
}

void cau_mesh_report_text(const cau_mesh_report *report, char bytes[static CAU_MESH_TEXT_BYTES])
{
	(void)report;
	bytes[0] = 0;
}
