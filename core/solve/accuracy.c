// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/accuracy.h"

#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "solve/contact.h"
#include "solve/solver.h"

// Largest error, m, that is allowed in a chunk that hardly moves. The chunk's motion also limits
// this error (least_share).
static const double least_error_m = 0.5e-6;
// Largest share of a chunk's motion that the error least_error_m may be.
static const double least_share = 0.25;
static const double still_error_m = 2e-8; // error, m, that is allowed however small the motion is
// Error of a tool's force, N, that is always allowed: a hundredth of the least force that viewers
// show.
static const double least_force_n = 1e-4;
// Factor by which the relative error of a tool's force may exceed the vertices' relative error.
static const double force_share = 2;
// Relative change of a tool's force, from step to step, up to which the force counts as steady.
static const double steady = 0.25;
// Relative change of a tool's force, from step to step, above which the step teaches something.
static const double still_force = 0.002;
// Factor on the learned force error, because contact constraints of this step may have a larger
// error than those of earlier steps.
static const double force_slack = 3;
static const double untaught = 3; // amplification before any step has shown one
// Relative force error before any step has shown one: all of the force may be wrong.
static const double untaught_force = 1;
static const double most_amplified = 300;
// Least error that is reported, as a share of the wanted accuracy. A few increments cannot resolve
// smaller errors.
static const double resolved = 0.2;
// Safety factor on the error that follows from a measured contraction, which is a little too
// optimistic.
static const double slack = 1.2;
// Largest contraction factor. A measured factor nearer to 1 cannot be distinguished from no
// contraction.
static const double slowest = 0.999;
// Factor on the bound by the energy. An error of a single mode would reach the bound, but an error
// mostly consists of several modes.
static const double bound_share = 0.5;
// Share of the way, in the logarithm, by which an amplification moves towards a smaller one that a
// step shows.
static const double forgetting = 0.1;
// Least length, relative to the allowed error, of a step's longest increment from which the step
// learns. Shorter increments are rounding.
static const double worth_learning = 0.05;
// Length of the first increment, relative to the allowed error, up to which nothing moves.
static const double all_rounding = 0.02;
enum {
	// sums of a chunk: mass, and mass times the squares of trial increment, increment and motion
	SUMS = 4,
	DEEP = 4, // least number of increments of a step from which all amplifications are learned
	// steps with fewer than DEEP increments in a row, after which a step takes DEEP increments
	SHALLOW = 12,
};

cau_status cau_accuracy_create(cau_accuracy *accuracy, int32_t chunk_count, cau_arena *arena,
                               cau_error *error)
{
	CAU_ASSERT(chunk_count > 0, "%d chunks of vertices", chunk_count);
	cau_accuracy_forget(accuracy);
	accuracy->sums = cau_arena_array(arena, SUMS * (size_t)chunk_count, sizeof(double));
	if (!accuracy->sums)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the solver");
	return CAU_OK;
}

void cau_accuracy_forget(cau_accuracy *accuracy)
{
	accuracy->shallow_steps = 0;
	accuracy->force_left = untaught_force;
	memset(accuracy->force_before, 0, sizeof accuracy->force_before);
	for (int k = 0; k < CAU_ACCURACY_DEPTHS; k++)
		accuracy->amplification[k] = untaught;
}

void cau_accuracy_begin(cau_accuracy *accuracy)
{
	CAU_ASSERT(accuracy->wanted >= 0, "an accuracy of %g is wanted", accuracy->wanted);
	accuracy->count = 0;
	accuracy->left = accuracy->error = 0;
	accuracy->moves = false;
	memset(accuracy->force, 0, sizeof accuracy->force);
}

// ---- lengths
static void measure_part(void *context, int32_t chunk)
{
	cau_step_solver *solver = context;
	int32_t first = chunk * CAU_VERTEX_CHUNK, last = first + CAU_VERTEX_CHUNK;
	CAU_ASSERT_INDEX(chunk, solver->chunks.count);
	if (last > solver->tissue->vertex_count)
		last = solver->tissue->vertex_count;
	solver->kernels->vectors->measure(solver, first, last,
	                                  solver->accuracy.sums + SUMS * (size_t)chunk);
}

// Root mean squares, m, over the vertices of a chunk or over all vertices.
typedef struct lengths {
	double trial, increment;
	// divisor that makes a length a reported error: the motion, but at least least_error_m /
	// `wanted`
	double told;
	double allowed; // largest error with which the step may end
} lengths;

// Half a micrometre is not a visible error. But if every tick of slow tissue had that error, the
// tissue would move far too slowly. Hence the limit least_share.
static lengths lengths_of(const double sums[SUMS], double wanted)
{
	CAU_ASSERT(sums[0] > 0, "%g kg of free vertices", sums[0]);
	double motion = sqrt(sums[3] / sums[0]);
	double slow = fmax(fmin(least_error_m, least_share * motion), still_error_m);
	return (lengths){.trial = sqrt(sums[1] / sums[0]),
	                 .increment = sqrt(sums[2] / sums[0]),
	                 .told = fmax(motion, least_error_m / wanted),
	                 .allowed = fmax(wanted * motion, slow)};
}

// The trial increment of a step. `length` is relative to the allowed error; `told` is relative to
// the motion, as errors are reported. Both are the largest values over all chunks and over all
// vertices. `all` has the lengths over all vertices.
typedef struct trial {
	double length, told, mass;
	lengths all;
} trial;

static trial measure(cau_step_solver *solver)
{
	cau_accuracy *accuracy = &solver->accuracy;
	double total[SUMS] = {0};
	trial of = {0};
	cau_pool_run(solver->pool, solver->chunks.count, measure_part, solver);
	for (int32_t chunk = 0; chunk <= solver->chunks.count; chunk++) {
		const double *sums =
			chunk < solver->chunks.count ? accuracy->sums + SUMS * (size_t)chunk : total;
		if (!(sums[0] > 0))
			continue;
		of.all = lengths_of(sums, accuracy->wanted); // after the loop, of.all is over all vertices
		of.length = fmax(of.length, of.all.trial / of.all.allowed);
		of.told = fmax(of.told, of.all.trial / of.all.told);
		for (int k = 0; k < SUMS && chunk < solver->chunks.count; k++)
			total[k] += sums[k];
	}
	of.mass = total[0];
	return of;
}

// ---- forces
static void sum_forces(const cau_contact_set *set, double force[CAU_ACCURACY_TOOLS][3])
{
	memset(force, 0, CAU_ACCURACY_TOOLS * sizeof force[0]);
	for (int32_t i = 0; set && i < set->row_count; i++) {
		CAU_ASSERT_INDEX(set->row[i].tool, CAU_ACCURACY_TOOLS);
		for (int c = 0; c < 3; c++)
			force[set->row[i].tool][c] += set->row[i].reaction[c];
	}
}

// Returns the largest difference of a tool's force between `of` and `from`, relative to the force
// in `of`. If that force is less than least_n, the difference is relative to least_n.
static double difference(double of[CAU_ACCURACY_TOOLS][3], double from[CAU_ACCURACY_TOOLS][3],
                         double least_n)
{
	CAU_ASSERT(least_n > 0, "forces relative to %g N", least_n);
	double most = 0;
	for (int32_t tool = 0; tool < CAU_ACCURACY_TOOLS; tool++) {
		double size2 = 0, change2 = 0;
		for (int c = 0; c < 3; c++) {
			double change = of[tool][c] - from[tool][c];
			size2 += of[tool][c] * of[tool][c];
			change2 += change * change;
		}
		most = fmax(most, sqrt(change2) / fmax(sqrt(size2), least_n));
	}
	return most;
}

// Returns the force, N, whose allowed error is least_force_n.
static double least_told(const cau_accuracy *accuracy)
{
	return least_force_n / (force_share * accuracy->wanted);
}

// Returns the change of the tools' forces since the last increment, relative to the allowed error
// of forces. After the first increment, this is the change from zero force.
static double force_change(cau_step_solver *solver)
{
	cau_accuracy *accuracy = &solver->accuracy;
	double force[CAU_ACCURACY_TOOLS][3];
	sum_forces(solver->contact, force);
	double change = difference(force, accuracy->force, least_told(accuracy));
	memcpy(accuracy->force, force, sizeof force);
	if (accuracy->count == 1)
		memcpy(accuracy->force_first, force, sizeof force);
	return change / (force_share * accuracy->wanted);
}

// Returns the relative difference of the tools' forces from the end of the last step.
static double force_drift(cau_accuracy *accuracy)
{
	return difference(accuracy->force, accuracy->force_before, least_told(accuracy));
}

// ---- estimates

// Returns the factor by which the norms of the last increments shrink in one iteration; 0 if it is
// not known.
static double contraction(const cau_accuracy *accuracy)
{
	int32_t last = accuracy->count - 1;
	const double *norm = accuracy->norm;
	CAU_ASSERT(last >= 0, "a contraction of %d increments", accuracy->count);
	double a = 0;
	if (last >= 3 && norm[last - 2] > 0)
		a = sqrt(norm[last] / norm[last - 2]);
	else if (last == 2 && norm[1] > 0)
		a = norm[2] / norm[1];
	return fmin(a, slowest);
}

static double amplification(const cau_accuracy *accuracy, int32_t count)
{
	CAU_ASSERT(count >= 1, "an amplification of %d increments", count);
	return accuracy->amplification[(count < CAU_ACCURACY_DEPTHS ? count : CAU_ACCURACY_DEPTHS) - 1];
}

// Estimates the error after the increments so far, relative to the allowed error. Stores the
// estimate from this step alone in accuracy->left.
static double estimate(cau_accuracy *accuracy, double bound)
{
	int32_t last = accuracy->count - 1;
	double a = contraction(accuracy), alone = a / (1 - a), length = accuracy->length[last];
	double carried = amplification(accuracy, accuracy->count);
	// long and short increments alternate, so the increment before the last counts too
	if (last >= 2)
		length = fmax(length, a * accuracy->length[last - 1]);
	bound = fmax(bound, length);
	double error = fmin(fmax(slack * alone, carried) * length, bound);
	accuracy->left = last >= 2 ? fmin(alone * length, bound) : error;
	return error;
}

// Estimates the error of the tools' forces, relative to the allowed error. `changed` is the last
// change of the forces, also relative to the allowed error. `drift` is the change since the last
// step. `amplification` is the vertices' error over the length of the increment.
static double estimate_forces(const cau_accuracy *accuracy, double changed, double drift,
                              double amplification)
{
	CAU_ASSERT(changed >= 0, "forces that changed by %g", changed);
	if (accuracy->count > 1)
		return changed * amplification;
	return changed * (drift <= steady ? force_slack * accuracy->force_left
	                                  : fmax(amplification, untaught_force));
}

bool cau_accuracy_is_reached(cau_step_solver *solver, double norm)
{
	cau_accuracy *accuracy = &solver->accuracy;
	if (accuracy->wanted == 0 || !solver->position_start || accuracy->count == CAU_ACCURACY_STEPS)
		return false;
	int32_t at = accuracy->count++;
	trial of = measure(solver);
	if (!(of.mass > 0))
		return true;
	double changed = force_change(solver), drift = force_drift(accuracy), bound = 0, smooth = 0;
	if (of.all.increment > 0) {
		smooth = of.all.increment / of.all.allowed;
		bound = bound_share * solver->inertia_s * solver->inertia_s * norm * norm /
		        (of.mass * of.all.increment * of.all.allowed);
	}
	// In an iteration that stalls, the mixed increment can be almost 0 while the increments stay
	// large. So the length of the increment counts, too.
	double length = accuracy->length[at] = at >= 2 ? fmax(of.length, smooth) : of.length;
	accuracy->norm[at] = norm;
	double error = estimate(accuracy, bound);
	if (length > 0) {
		double told = at >= 2 ? fmax(of.told, accuracy->wanted * smooth) : of.told;
		// One or two increments cannot resolve a smaller error. Some ticks with a smaller reported
		// error had a true error of three times the reported one and more.
		accuracy->error = fmax(error * told / length, resolved * accuracy->wanted);
		error = fmax(error, estimate_forces(accuracy, changed, drift, error / length));
	}
	if (!at)
		accuracy->moves = length > all_rounding || drift > still_force;
	bool learns = accuracy->shallow_steps >= SHALLOW && accuracy->count < DEEP && accuracy->moves;
	return error <= 1 && !learns;
}

// ---- from step to step
static void teach(double *amplification, double shown)
{
	CAU_ASSERT(*amplification > 0, "an amplification of %g", *amplification);
	if (shown > *amplification)
		*amplification = shown;
	else
		*amplification *= pow(fmax(shown, 1e-6) / *amplification, forgetting);
}

void cau_accuracy_learn(cau_accuracy *accuracy)
{
	double most = 0, left = accuracy->left;
	if (accuracy->wanted == 0)
		return;
	if (accuracy->count > 1)
		teach(&accuracy->force_left,
		      difference(accuracy->force, accuracy->force_first, least_told(accuracy)));
	memcpy(accuracy->force_before, accuracy->force, sizeof accuracy->force);
	accuracy->shallow_steps = accuracy->count < DEEP ? accuracy->shallow_steps + 1 : 0;
	for (int32_t i = 0; i < accuracy->count; i++)
		most = fmax(most, accuracy->length[i]);
	if (!(most > worth_learning))
		return;
	// The error that an increment left is the sum of all later increments. It is learned if at
	// least two increments came later.
	for (int32_t count = accuracy->count - 1; count >= 1; count--) {
		int32_t depth = count < CAU_ACCURACY_DEPTHS ? count : CAU_ACCURACY_DEPTHS;
		left += accuracy->length[count];
		if (accuracy->count - count >= 2 && accuracy->length[count - 1] > 0)
			teach(&accuracy->amplification[depth - 1],
			      fmin(left / accuracy->length[count - 1], most_amplified));
	}
}
