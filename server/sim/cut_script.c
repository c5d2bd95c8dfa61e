// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/scene.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/command_json.h"
#include "cautery/defaults.h"

static const double approach_s = 1.0; // time from the first pose to the point above the tissue
// time from that point down to the tissue, and back up at the end
static const double descent_s = 0.5;
static const double hover_m = 0.02; // height of the point above the tissue, along the shaft

enum { TICKS_BETWEEN_MOVES = 3, LINE_BYTES = 1024 };

typedef struct pen {
	char *text;
	size_t bytes, capacity;
	uint64_t tick;
	double step_s;
	const char *tool;
	cau_status status;
	cau_error *error;
} pen;

static void reserve_line(pen *p)
{
	if (p->status || p->capacity - p->bytes > LINE_BYTES)
		return;
	char *larger = realloc(p->text, p->capacity * 2);
	if (!larger) {
		p->status = cau_fail(p->error, CAU_NO_MEMORY, NULL, "no memory for the script");
		return;
	}
	p->text = larger;
	p->capacity *= 2;
}

static void put_command(pen *p, cau_command *command)
{
	size_t written;
	command->tick = p->tick;
	snprintf(command->tool, sizeof command->tool, "%s", p->tool);
	reserve_line(p);
	if (p->status)
		return;
	p->status = cau_command_to_json(command, p->text + p->bytes, p->capacity - p->bytes, &written,
	                                p->error);
	if (p->status)
		return;
	p->bytes += written;
	p->text[p->bytes++] = '\n';
}

static void put_energy(pen *p, bool on)
{
	cau_command command;
	cau_default_command(&command, CAU_COMMAND_TOOL_ENERGIZE);
	command.as.energized = on;
	put_command(p, &command);
}

// Rounds to five decimals (a hundredth of a millimetre), to keep the lines short.
static double rounded(double value)
{
	return nearbyint(value * 1e5) / 1e5;
}

// Writes a move to the pose at `share` of the way. Rotations are interpolated along the shorter arc
// and normalised.
static void put_pose(pen *p, const cau_pose *from, const cau_pose *to, double share)
{
	cau_command command;
	cau_default_command(&command, CAU_COMMAND_TOOL_MOVE);
	cau_pose *pose = &command.as.move.pose;
	double dot = 0.0, square = 0.0;
	for (int i = 0; i < 4; i++)
		dot += from->rotation[i] * to->rotation[i];
	for (int i = 0; i < 3; i++)
		pose->position_m[i] =
			rounded(from->position_m[i] + share * (to->position_m[i] - from->position_m[i]));
	for (int i = 0; i < 4; i++) {
		double end = dot < 0.0 ? -to->rotation[i] : to->rotation[i];
		pose->rotation[i] = from->rotation[i] + share * (end - from->rotation[i]);
		square += pose->rotation[i] * pose->rotation[i];
	}
	for (int i = 0; i < 4; i++)
		pose->rotation[i] = rounded(pose->rotation[i] / sqrt(square));
	put_command(p, &command);
}

// Moves from `from` to `to`, with a smooth start and end or at constant speed.
static void move(pen *p, const cau_pose *from, const cau_pose *to, double duration_s, bool smooth)
{
	uint64_t ticks = (uint64_t)ceil(duration_s / p->step_s);
	for (uint64_t i = TICKS_BETWEEN_MOVES; !p->status; i += TICKS_BETWEEN_MOVES) {
		uint64_t done = i < ticks ? i : ticks;
		double share = ticks ? (double)done / (double)ticks : 1.0;
		if (smooth)
			share *= share * (3.0 - 2.0 * share);
		p->tick += done < i ? TICKS_BETWEEN_MOVES - (i - done) : TICKS_BETWEEN_MOVES;
		put_pose(p, from, to, share);
		if (done == ticks)
			break;
	}
}

// Returns `pose` drawn back along its shaft (the tool's z axis).
static cau_pose above(const cau_pose *pose)
{
	const double *q = pose->rotation; // a quaternion: w, x, y, z
	cau_pose raised = *pose;
	raised.position_m[0] += hover_m * 2.0 * (q[1] * q[3] + q[0] * q[2]);
	raised.position_m[1] += hover_m * 2.0 * (q[2] * q[3] - q[0] * q[1]);
	raised.position_m[2] += hover_m * (1.0 - 2.0 * (q[1] * q[1] + q[2] * q[2]));
	return raised;
}

static const cau_tool_def *find_tool(const cau_scene_def *scene)
{
	for (int32_t i = 0; i < scene->tool_count; i++)
		if (strcmp(scene->tools[i].name, scene->cut.tool) == 0)
			return &scene->tools[i];
	return NULL;
}

static void write_cut(pen *p, const cau_cut_def *cut, const cau_tool_def *tool)
{
	cau_pose from, to;
	double square = 0.0;
	memcpy(from.position_m, cut->from_m, sizeof from.position_m);
	memcpy(from.rotation, cut->rotation, sizeof from.rotation);
	to = from;
	memcpy(to.position_m, cut->to_m, sizeof to.position_m);
	for (int i = 0; i < 3; i++)
		square += (cut->to_m[i] - cut->from_m[i]) * (cut->to_m[i] - cut->from_m[i]);
	cau_pose over_from = above(&from), over_to = above(&to);

	move(p, &tool->pose, &over_from, approach_s, true);
	put_energy(p, true);
	move(p, &over_from, &from, descent_s, true);
	p->tick += (uint64_t)ceil(cut->dwell_s / p->step_s);
	move(p, &from, &to, sqrt(square) / cut->speed_m_s, false);
	put_energy(p, false);
	move(p, &to, &over_to, descent_s, true);
}

cau_status sim_cut_script(const cau_scene_def *scene, char **text, size_t *bytes, cau_error *error)
{
	*text = NULL;
	*bytes = 0;
	if (!scene->cut.present)
		return cau_fail(error, CAU_BAD_VALUE, "cut", "the scene has no member cut");
	const cau_tool_def *tool = find_tool(scene);
	if (!tool)
		return cau_fail(error, CAU_BAD_VALUE, "cut.tool", "the scene has no tool \"%s\"",
		                scene->cut.tool);
	pen p = {
		.capacity = 2 * LINE_BYTES, .step_s = scene->step_s, .tool = tool->name, .error = error};
	p.text = malloc(p.capacity);
	if (!p.text)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the script");
	write_cut(&p, &scene->cut, tool);
	if (p.status) {
		free(p.text);
		return p.status;
	}
	*text = p.text;
	*bytes = p.bytes;
	return CAU_OK;
}
