// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/writers.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

// All columns but the last, the stages' times, depend only on the scene and the commands: two runs
// write the same bytes there.

// Columns: name, format, value. `frame`, `balance` and `ledger` are members of `row`; `s` is the
// statistics.
#define COLUMNS(X)                                                                                 \
	X("tick", PRIu64, frame->tick)                                                                 \
	X("time_s", ".9g", frame->time_s)                                                              \
	X("moved_vertices", PRId32, frame->moved_count)                                                \
	X("iterations", PRId32, s->iterations)                                                         \
	X("residual", ".6g", s->residual)                                                              \
	X("backtracks", PRId32, s->backtracks)                                                         \
	X("inverted", PRId32, s->inverted)                                                             \
	X("long_inverted", PRId32, long_inverted(s))                                                   \
	X("edges_parted", PRId32, s->edges_parted)                                                     \
	X("elements_removed", PRId32, s->elements_removed)                                             \
	X("elements_torn", PRId32, s->elements_torn)                                                   \
	X("pending_downdates", PRId32, s->pending_downdates)                                           \
	X("deferred_max_s", ".6g", s->deferred_max_s)                                                  \
	X("refactorisations", PRId32, s->refactorisations)                                             \
	X("factor_operations", PRId32, s->factor_operations)                                           \
	X("contacts", PRId32, s->contacts)                                                             \
	X("contacts_left_out", PRId32, s->contacts_left_out)                                           \
	X("touching_cut_short", PRId32, s->touching_cut_short)                                         \
	X("frozen_vertices", PRId32, s->frozen_vertices)                                               \
	X("energy_gain_j", ".6g", s->energy_gain_j)                                                    \
	X("energy_scale_j", ".6g", s->energy_scale_j)                                                  \
	X("error", ".6g", s->error)                                                                    \
	X("resting", "d", s->resting)                                                                  \
	X("tool_force_max_n", ".6g", largest_force(frame))                                             \
	X("tip_temperature_max_c", ".6g", hottest_tip(frame))                                          \
	X("kinetic_j", ".9g", balance->kinetic_j)                                                      \
	X("elastic_j", ".9g", balance->elastic_j)                                                      \
	X("gravitational_j", ".9g", balance->gravitational_j)                                          \
	X("delivered_j", ".9g", ledger->delivered_j)                                                   \
	X("far_j", ".9g", ledger->far_j)                                                               \
	X("blade_j", ".9g", ledger->blade_j)                                                           \
	X("stored_j", ".9g", ledger->stored_j)                                                         \
	X("boiled_j", ".9g", ledger->boiled_j)                                                         \
	X("perfused_j", ".9g", ledger->perfused_j)                                                     \
	X("ambient_j", ".9g", ledger->ambient_j)                                                       \
	X("shed_j", ".9g", ledger->shed_j)                                                             \
	X("coagulated_m3", ".9g", row->coagulated_m3)                                                  \
	X("vaporised_m3", ".9g", row->vaporised_m3)                                                    \
	X("vapour_kg_s", ".9g", row->vapour_kg_s)

// Columns of a tool: suffix, value of `tool`.
#define TOOL_COLUMNS(X)                                                                            \
	X("force_x_n", tool->raw_force_n[0])                                                           \
	X("force_y_n", tool->raw_force_n[1])                                                           \
	X("force_z_n", tool->raw_force_n[2])                                                           \
	X("torque_x_nm", tool->raw_torque_nm[0])                                                       \
	X("torque_y_nm", tool->raw_torque_nm[1])                                                       \
	X("torque_z_nm", tool->raw_torque_nm[2])                                                       \
	X("temperature_c", tool->tip_temperature_c)                                                    \
	X("energy_j", tool->energy_j)                                                                  \
	X("delivered_w", tool->delivered_w)                                                            \
	X("load_ohm", tool->load_ohm)                                                                  \
	X("filtered_force_x_n", tool->force_n[0])                                                      \
	X("filtered_force_y_n", tool->force_n[1])                                                      \
	X("filtered_force_z_n", tool->force_n[2])                                                      \
	X("filtered_torque_x_nm", tool->torque_nm[0])                                                  \
	X("filtered_torque_y_nm", tool->torque_nm[1])                                                  \
	X("filtered_torque_z_nm", tool->torque_nm[2])

// Columns of a vessel: suffix, value of `vessel`.
#define VESSEL_COLUMNS(X)                                                                          \
	X("parted", (double)((vessel->flags & CAU_VESSEL_CUT) != 0))                                   \
	X("sealed", (double)((vessel->flags & CAU_VESSEL_SEALED) != 0))                                \
	X("bleeding_m3_s", vessel->bleeding_m3_s)                                                      \
	X("shed_m3", vessel->shed_m3)                                                                  \
	X("burst_pa", vessel->burst_pa)

static int32_t long_inverted(const cau_statistics *statistics)
{
	int32_t count = 0;
	for (int i = 0; i < CAU_MAX_LAYERS; i++)
		count += statistics->long_inverted[i];
	return count;
}

static double largest_force(const cau_frame *frame)
{
	double largest = 0.0;
	for (int32_t i = 0; i < frame->tool_count; i++) {
		const double *f = frame->tools[i].force_n;
		largest = fmax(largest, sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]));
	}
	return largest;
}

static double hottest_tip(const cau_frame *frame)
{
	double hottest = 0.0;
	for (int32_t i = 0; i < frame->tool_count; i++)
		hottest = fmax(hottest, frame->tools[i].tip_temperature_c);
	return hottest;
}

void sim_csv_begin(FILE *file, const cau_scene_def *scene)
{
	const char *comma = "";
#define HEAD(column, format, value)                                                                \
	fprintf(file, "%s%s", comma, column);                                                          \
	comma = ",";
	COLUMNS(HEAD)
#undef HEAD
	for (int32_t i = 0; i < scene->tool_count; i++) {
#define HEAD(suffix, value) fprintf(file, ",%s_" suffix, scene->tools[i].name);
		TOOL_COLUMNS(HEAD)
#undef HEAD
	}
	for (int32_t i = 0; i < scene->vessel_count; i++) {
#define HEAD(suffix, value) fprintf(file, ",%s_" suffix, scene->vessels[i].name);
		VESSEL_COLUMNS(HEAD)
#undef HEAD
	}
#define HEAD(code, name) fputs(",stage_" name "_s", file);
	CAU_STAGE_TABLE(HEAD)
#undef HEAD
	fputc('\n', file);
}

// Returns the tool's state; NULL if the tool was removed.
static const cau_tool_state *find_tool(const cau_frame *frame, const char *name)
{
	for (int32_t i = 0; i < frame->tool_count; i++)
		if (strcmp(frame->tools[i].name, name) == 0)
			return &frame->tools[i];
	return NULL;
}

static void write_tool(FILE *file, const cau_tool_state *tool)
{
#define CELL(suffix, value)                                                                        \
	if (tool)                                                                                      \
		fprintf(file, ",%.6g", value);                                                             \
	else                                                                                           \
		fputc(',', file);
	TOOL_COLUMNS(CELL)
#undef CELL
}

static void write_vessel(FILE *file, const cau_vessel_state *vessel)
{
#define CELL(suffix, value) fprintf(file, ",%.6g", value);
	VESSEL_COLUMNS(CELL)
#undef CELL
}

void sim_csv_tick(FILE *file, const cau_scene_def *scene, const sim_csv_row *row)
{
	const cau_frame *frame = row->frame;
	const cau_balance *balance = &row->balance;
	const cau_energy_ledger *ledger = &row->ledger;
	const cau_statistics *s = &frame->statistics;
	const char *comma = "";
#define CELL(column, format, value)                                                                \
	fprintf(file, "%s%" format, comma, value);                                                     \
	comma = ",";
	COLUMNS(CELL)
#undef CELL
	for (int32_t i = 0; i < scene->tool_count; i++)
		write_tool(file, find_tool(frame, scene->tools[i].name));
	for (int32_t i = 0; i < frame->vessel_count; i++)
		write_vessel(file, frame->vessels[i]);
	for (int stage = 0; stage < CAU_STAGE_COUNT; stage++)
		fprintf(file, ",%.6g", s->seconds[stage]);
	fputc('\n', file);
}
