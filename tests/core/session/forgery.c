// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/session/forgery.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"

enum { HASH_BYTES = 8, CHANGE_BYTES = 9, MOST_CHANGES = 16, STEPS = 10 };

// ---- the scene

static void hot(cau_heat_material *heat)
{
	heat->absorption_per_s = 8;
	heat->tear_energy_j_m2 = 20;
}

static cau_tool_def *add_tool(cau_scene_def *scene, const char *name, int shape, double x)
{
	cau_tool_def *tool = stage_add_tool(scene, name, shape, x, 0, 0.004);
	tool->grid_cells = 8;
	tool->hot_radius_m = 1.5e-3;
	tool->shaft_radius_m = 1e-3;
	return tool;
}

static cau_scene_def *tiny_scene(int kind)
{
	const double size[3] = {0.02, 0.012, 0.006};
	const int32_t cells[3] = {4, 3, 1};
	const double least[3] = {-0.1, -0.1, -0.0061}, most[3] = {0.1, 0.1, -0.0059};
	cau_scene_def *scene = stage_scene(CAU_PRECISION_SINGLE);
	cau_default_gravity(scene->gravity_m_s2);
	scene->parting = kind == FORGERY_BY_POWER ? CAU_PARTING_ELEMENTS : kind;
	scene->energy = kind == FORGERY_BY_POWER ? CAU_ENERGY_TISSUE : CAU_ENERGY_PAPER;
	scene->cell_m = 2e-3; // large cells: each forged snapshot creates all of them
	scene->contact_thickness_m = 2e-4;
	cau_layer_def *fascia = stage_add_sheet(scene, "fascia", 0.02, 0.012, 5, 3);
	stage_mesh_of(scene, fascia)->translate_m[2] = 0.002;
	fascia->sheet[0].shrink[0] = 0.3;
	fascia->sheet[0].bending_stiffness_nm = 1e-5;
	hot(&fascia->sheet[0].heat);
	cau_layer_def *fat = stage_add_slab(scene, "fat", size, cells);
	fat->fat[0].limit = CAU_LIMIT_RANGE;
	fat->fat[0].shrink[0] = 0.3;
	fat->fat[0].yield_strain = 0.01;
	fat->fat[0].plastic_strain_max = 0.16;
	hot(&fat->fat[0].heat);
	stage_add_membrane(scene, "membrane", "fat");
	hot(&scene->layers[2].sheet[0].heat);
	hot(&stage_add_links(scene, "links", "fascia", "membrane")->link.heat);
	stage_pin_box(scene, least, most);
	add_tool(scene, "hook", CAU_TOOL_HOOK, -0.006);
	add_tool(scene, "jaws", CAU_TOOL_GRASPER, 0.006);
	return scene;
}

// Queues waiting commands of every kind, so that their bytes can be forged.
static void queue_commands(cau_session *session)
{
	for (int kind = 0; kind < CAU_COMMAND_COUNT; kind++) {
		cau_command command;
		cau_default_command(&command, kind);
		strcpy(command.tool, "hook");
		command.tick = 1000 + (uint64_t)kind;
		if (kind == CAU_COMMAND_TOOL_ADD)
			strcpy(command.as.definition.name, "later");
		if (kind == CAU_COMMAND_SET_MATERIAL) {
			command.as.material.kind = CAU_LAYER_FAT;
			strcpy(command.as.material.layer, "fat");
		}
		stage_submit(session, &command);
	}
}

static void step_scene(cau_session *session, int tick)
{
	double s = tick / 60.0;
	stage_move(session, "hook", -0.006 + 0.012 * s, 0, tick < 8 ? 0.004 - 0.0003 * tick : 0.0015);
	if (tick == 6)
		stage_energize(session, "hook", 1);
	if (tick < 10)
		stage_move(session, "jaws", 0.006, 0, 0.004 - 0.0004 * tick);
	if (tick == 11)
		stage_grasp(session, "jaws");
	if (tick > 14)
		stage_move(session, "jaws", 0.006, 0.002 * s, 0.0004 + 0.004 * s);
	stage_step(session, 1);
}

forgery *forgery_create(int kind)
{
	static const int at[FORGERY_SHOTS] = {0, 7, 13, 24, 40, 55};
	forgery *f = calloc(1, sizeof *f);
	f->scene = tiny_scene(kind);
	f->session = stage_open(f->scene, 1);
	size_t most = 0;
	for (int tick = 0, shot = 0; shot < FORGERY_SHOTS; tick++) {
		if (tick == at[shot]) {
			f->shot[shot] = stage_snapshot(f->session);
			most = f->shot[shot].count > most ? f->shot[shot].count : most;
			shot++;
		}
		if (tick == 20)
			queue_commands(f->session);
		step_scene(f->session, tick);
	}
	cau_energy_ledger ledger;
	cau_session_read_ledger(f->session, &ledger);
	assert_true((ledger.delivered_j > 0) == (kind == FORGERY_BY_POWER));
	f->bytes = malloc(most);
	return f;
}

void forgery_destroy(forgery *f)
{
	for (int k = 0; k < FORGERY_SHOTS; k++)
		free(f->shot[k].bytes);
	free(f->bytes);
	cau_session_destroy(f->session);
	free(f->scene);
	free(f);
}

// ---- changes

static void put(unsigned char *at, const void *value, size_t size)
{
	memcpy(at, value, size);
}

static void put_number(unsigned char *at, uint8_t choice)
{
	static const double doubles[] = {0, -1, 1, 1e-30, 1e30, -1e30, 1e308, 0.5, 1e6, -1e6, 1e-3, 2};
	static const int32_t ints[] = {0, -1, 1, 2, 3, 7, 64, 255, 4000, 1000000, INT32_MAX, INT32_MIN};
	enum { DOUBLES = sizeof doubles / sizeof *doubles, INTS = sizeof ints / sizeof *ints };
	const double nan = NAN, infinite = INFINITY;
	choice %= DOUBLES + INTS + DOUBLES + 2;
	if (choice < DOUBLES) {
		put(at, &doubles[choice], sizeof(double));
	} else if (choice < DOUBLES + INTS) {
		put(at, &ints[choice - DOUBLES], sizeof(int32_t));
	} else if (choice < 2 * DOUBLES + INTS) {
		float value = (float)doubles[choice - DOUBLES - INTS];
		put(at, &value, sizeof value);
	} else {
		put(at, choice & 1 ? &nan : &infinite, sizeof(double));
	}
}

// Makes a change described by nine bytes: the kind of change, the number or byte, the position, and
// the source position.
static void change(unsigned char *bytes, size_t room, const uint8_t how[CHANGE_BYTES])
{
	enum { HEAD = 320 };
	uint32_t where, from;
	memcpy(&where, how + 2, 4);
	memcpy(&from, how + 5, 4);
	size_t at = how[0] & 128 ? where % (room < HEAD ? room : HEAD) : where % room;
	switch (how[0] & 3) {
	case 0:
		bytes[at] ^= (unsigned char)(1u << how[1] % 8);
		break;
	case 1:
		bytes[at] = how[1];
		break;
	case 2:
		if (at + sizeof(double) <= room)
			put_number(bytes + at, how[1]);
		break;
	default: {
		size_t size = 1u << how[1] % 6;
		if (at + size <= room && from % room + size <= room)
			memmove(bytes + at, bytes + from % room, size);
		break;
	}
	}
}

size_t forgery_make(forgery *f, const uint8_t *data, size_t count)
{
	const stage_bytes *shot = &f->shot[count ? data[0] % FORGERY_SHOTS : 0];
	size_t room = shot->count - HASH_BYTES;
	memcpy(f->bytes, shot->bytes, shot->count);
	for (size_t k = 0; k < MOST_CHANGES && 1 + (k + 1) * CHANGE_BYTES <= count; k++)
		change(f->bytes, room, data + 1 + k * CHANGE_BYTES);
	uint64_t hash = cau_hash_bytes(CAU_HASH_START, f->bytes, room);
	memcpy(f->bytes + room, &hash, sizeof hash);
	return shot->count;
}

// ---- results

static void end_with(const char *what, const char *detail)
{
	fprintf(stderr, "a forged snapshot: %s (%s)\n", what, detail);
	abort();
}

cau_status forgery_restore(forgery *f, size_t count)
{
	cau_error error = {0};
	bool exact;
	uint64_t before = cau_session_hash(f->session);
	cau_status status = cau_session_restore(f->session, f->bytes, count, &exact, &error);
	if (status && status != CAU_CORRUPT)
		end_with("restoring it ends with", cau_status_name(status));
	if (status && !error.reason[0])
		end_with("it is refused", "without a reason");
	if (status && cau_session_hash(f->session) != before)
		end_with("a refusal changed the session", error.reason);
	return status;
}

void forgery_step(forgery *f)
{
	cau_error error = {0};
	for (int k = 0; k < STEPS; k++)
		if (cau_session_step(f->session, &error))
			return;
	cau_session_snapshot_bytes(f->session);
}
