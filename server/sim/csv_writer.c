// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/csv_writer.h"

#include <inttypes.h>
#include <math.h>

// column, format, value of `frame` and `s`, its statistics
#define COLUMNS(X)                                                                                 \
	X("tick", PRIu64, frame->tick)                                                                 \
	X("time_s", ".9g", frame->time_s)                                                              \
	X("moved_vertices", PRId32, frame->moved_count)                                                \
	X("iterations", PRId32, s->iterations)                                                         \
	X("residual", ".6g", s->residual)                                                              \
	X("backtracks", PRId32, s->backtracks)                                                         \
	X("inverted", PRId32, s->inverted)                                                             \
	X("edges_parted", PRId32, s->edges_parted)                                                     \
	X("elements_removed", PRId32, s->elements_removed)                                             \
	X("pending_downdates", PRId32, s->pending_downdates)                                           \
	X("deferred_max_s", ".6g", s->deferred_max_s)                                                  \
	X("refactorisations", PRId32, s->refactorisations)                                             \
	X("factor_operations", PRId32, s->factor_operations)                                           \
	X("contacts", PRId32, s->contacts)                                                             \
	X("frozen_vertices", PRId32, s->frozen_vertices)                                               \
	X("energy_gain_j", ".6g", s->energy_gain_j)                                                    \
	X("error", ".6g", s->error)                                                                    \
	X("resting", "d", s->resting)                                                                  \
	X("tool_force_max_n", ".6g", largest_force(frame))                                             \
	X("tip_temperature_max_c", ".6g", hottest_tip(frame))

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

void sim_csv_begin(FILE *file)
{
	const char *comma = "";
#define HEAD(column, format, value)                                                                \
	fprintf(file, "%s%s", comma, column);                                                          \
	comma = ",";
	COLUMNS(HEAD)
#undef HEAD
	fputc('\n', file);
}

void sim_csv_tick(FILE *file, const cau_frame *frame)
{
	const cau_statistics *s = &frame->statistics;
	const char *comma = "";
#define CELL(column, format, value)                                                                \
	fprintf(file, "%s%" format, comma, value);                                                     \
	comma = ",";
	COLUMNS(CELL)
#undef CELL
	fputc('\n', file);
}
