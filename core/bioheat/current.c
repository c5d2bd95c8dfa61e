// SPDX-License-Identifier: GPL-3.0-or-later
#include "bioheat/current.h"

#include <math.h>
#include <string.h>

#include "base/vector.h"
#include "cautery/assert.h"

// Approximate distance to the return electrode, m. The current of a sheet spreads in the sheet's
// plane, where the potential falls with the logarithm of the distance. So the result depends on
// this distance.
static const double return_m = 0.03;
// Share of its initial conductivity that dry tissue still has. With 0, the matrix would be
// singular.
static const double dry_share = 1e-4;

cau_status cau_current_create(cau_current *current, const cau_bioheat *bioheat, cau_arena *arena,
                              cau_error *error)
{
	size_t most = (size_t)bioheat->cells.capacity;
	*current = (cau_current){0};
	current->electrode = cau_arena_array(arena, most, sizeof *current->electrode);
	current->cell = cau_arena_array(arena, most, sizeof(int32_t));
	current->slot = cau_arena_array(arena, most, sizeof(int32_t));
	current->seed = cau_arena_array(arena, most, sizeof(int32_t));
	current->face_s = cau_arena_array(arena, CAU_CELL_SIDES * most, sizeof(double));
	double **vectors[] = {&current->potential,  &current->to_electrode_s, &current->to_far_s,
	                      &current->diagonal_s, &current->source,         &current->vector[0],
	                      &current->vector[1],  &current->vector[2],      &current->vector[3]};
	bool missing = !current->electrode || !current->cell || !current->slot || !current->seed ||
	               !current->face_s;
	for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++) {
		*vectors[i] = cau_arena_array(arena, most, sizeof(double));
		missing |= !*vectors[i];
	}
	if (missing)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the potential");
	return CAU_OK;
}

// ---- region

static cau_vec3 middle_of(const cau_cells *cells, int32_t cell)
{
	const int32_t *place = cells->place + 3 * (size_t)cell;
	return cau_scale(cells->side_m, (cau_vec3){place[0] + 0.5, place[1] + 0.5, place[2] + 0.5});
}

static cau_vec3 electrodes_middle(const cau_current *current, const cau_cells *cells)
{
	cau_vec3 sum = {0};
	double weight = 0;
	for (int32_t k = 0; k < current->electrode_count; k++) {
		double over = current->electrode[k].over_length_m;
		sum = cau_add(sum, cau_scale(over, middle_of(cells, current->electrode[k].cell)));
		weight += over;
	}
	return cau_scale(1 / weight, sum);
}

static void enter(cau_current *current, int32_t cell, int32_t seed)
{
	if (current->slot[cell])
		return;
	current->seed[current->count] = seed;
	current->cell[current->count++] = cell;
	current->slot[cell] = current->count;
}

// Lists the cells that are connected to an electrode and within reach_m of it, the nearest first.
static void find_region(cau_current *current, const cau_cells *cells, double reach_m)
{
	for (int32_t i = 0; i < current->count; i++)
		current->slot[current->cell[i]] = 0;
	current->count = 0;
	for (int32_t k = 0; k < current->electrode_count; k++)
		enter(current, current->electrode[k].cell, current->electrode[k].cell);
	for (int32_t i = 0; i < current->count; i++) {
		cau_vec3 from = middle_of(cells, current->seed[i]);
		for (int side = 0; side < CAU_CELL_SIDES; side++) {
			int32_t other = cells->neighbour[cau_cell_side(current->cell[i], side)];
			if (other >= 0 && cau_length(cau_sub(middle_of(cells, other), from)) <= reach_m)
				enter(current, other, current->seed[i]);
		}
	}
}

// ---- equations

static double conductivity(const cau_bioheat *bioheat, int32_t cell)
{
	double wet = bioheat->material[bioheat->cells.material[cell]].electric_s_m;
	return fmax(cau_bioheat_electric(bioheat, cell), dry_share * wet);
}

// Returns the conductance to 0 V through a face at the border of the region, S. Beyond the border
// the potential is assumed to fall as around a point at `middle`: as 1/r in a solid, as ln(return_m
// / r) in a sheet.
static double far_conductance(const cau_bioheat *bioheat, int32_t cell, int side, cau_vec3 middle)
{
	const cau_cells *cells = &bioheat->cells;
	bool sheet = bioheat->material[cells->material[cell]].sheet;
	cau_vec3 away = cau_sub(middle_of(cells, cell), middle);
	const double component[] = {away.x, away.y, away.z};
	double outwards = side % 2 ? component[side / 2] : -component[side / 2];
	double radius = cau_length(away), half = cells->side_m / 2;
	if (outwards <= 0)
		return 0;
	double length = radius * radius / outwards;
	if (sheet)
		length *= log(return_m / radius);
	double area = cells->side_m * cells->side_m * cells->fill[cell];
	return conductivity(bioheat, cell) * area * cells->pull[cau_cell_axis(cell, side / 2)] /
	       (half + fmax(length - half, half));
}

static void add_faces(cau_current *current, const cau_bioheat *bioheat, int32_t i, bool grounded,
                      cau_vec3 middle)
{
	const cau_cells *cells = &bioheat->cells;
	int32_t cell = current->cell[i];
	double own = conductivity(bioheat, cell), sum = 0;
	current->to_far_s[i] = current->to_electrode_s[i] = current->source[i] = 0;
	for (int side = 0; side < CAU_CELL_SIDES; side++) {
		int64_t face = cau_cell_side(i, side);
		int32_t other = cells->neighbour[cau_cell_side(cell, side)];
		current->face_s[face] = 0;
		if (other < 0)
			continue;
		if (!current->slot[other]) {
			if (grounded)
				current->to_far_s[i] += far_conductance(bioheat, cell, side, middle);
			continue;
		}
		double others = conductivity(bioheat, other);
		current->face_s[face] =
			cau_cells_face(cells, cell, side) * 2 * own * others / (own + others);
		sum += current->face_s[face];
	}
	current->diagonal_s[i] = sum + current->to_far_s[i];
}

static void add_electrodes(cau_current *current, const cau_bioheat *bioheat)
{
	for (int32_t k = 0; k < current->electrode_count; k++) {
		const cau_electrode_cell *electrode = &current->electrode[k];
		int32_t i = current->slot[electrode->cell] - 1;
		double g = conductivity(bioheat, electrode->cell) * electrode->over_length_m;
		current->to_electrode_s[i] += g;
		current->source[i] += g * electrode->potential;
		current->diagonal_s[i] += g;
	}
}

// ---- conjugate gradients, preconditioned by the diagonal

static int32_t slot_beyond(const cau_current *current, const cau_cells *cells, int32_t i, int side)
{
	return current->slot[cells->neighbour[cau_cell_side(current->cell[i], side)]] - 1;
}

static void multiply(const cau_current *current, const cau_cells *cells, const double *x, double *y)
{
	for (int32_t i = 0; i < current->count; i++) {
		double sum = current->diagonal_s[i] * x[i];
		for (int side = 0; side < CAU_CELL_SIDES; side++) {
			double g = current->face_s[cau_cell_side(i, side)];
			if (g > 0)
				sum -= g * x[slot_beyond(current, cells, i, side)];
		}
		y[i] = sum;
	}
}

static double dot(const double *a, const double *b, int32_t count)
{
	double sum = 0;
	for (int32_t i = 0; i < count; i++)
		sum += a[i] * b[i];
	return sum;
}

// Iterates from the present values of x. Stops as described at cau_current_solve.
static void iterate(cau_current *current, const cau_cells *cells, double *x, double tolerance,
                    int32_t most)
{
	double *r = current->vector[1], *p = current->vector[2], *q = current->vector[3];
	int32_t n = current->count;
	double entering = sqrt(dot(current->source, current->source, n)), before = 0;
	multiply(current, cells, x, r);
	for (int32_t i = 0; i < n; i++)
		r[i] = current->source[i] - r[i];
	for (current->iterations = 0;; current->iterations++) {
		current->residual = sqrt(dot(r, r, n)) / entering;
		if (current->residual <= tolerance || current->iterations == most)
			return;
		double now = 0;
		for (int32_t i = 0; i < n; i++)
			now += r[i] * r[i] / current->diagonal_s[i];
		double keep = current->iterations ? now / before : 0;
		for (int32_t i = 0; i < n; i++)
			p[i] = r[i] / current->diagonal_s[i] + keep * p[i];
		multiply(current, cells, p, q);
		double along = now / dot(p, q, n);
		for (int32_t i = 0; i < n; i++) {
			x[i] += along * p[i];
			r[i] -= along * q[i];
		}
		before = now;
	}
}

// ---- results

// Returns the heat of a cell at 1 V, W. The heat of a face is divided equally between the face's
// two cells. The heat of a contact is added to the contact's cell.
static double heat_at_1v(const cau_current *current, const cau_cells *cells, int32_t i)
{
	const double *x = current->vector[0];
	double from = current->source[i], back = current->to_electrode_s[i] - from;
	double heat = from * (1 - x[i]) * (1 - x[i]) + back * x[i] * x[i];
	for (int side = 0; side < CAU_CELL_SIDES; side++) {
		double g = current->face_s[cau_cell_side(i, side)];
		if (g > 0) {
			double drop = x[i] - x[slot_beyond(current, cells, i, side)];
			heat += g * drop * drop / 2;
		}
	}
	return heat;
}

// Computes conductance and returned current. The conductance is the heat at 1 V, so heat and power
// agree at any residual.
static void read_currents(cau_current *current, const cau_cells *cells)
{
	const double *x = current->vector[0];
	current->conductance_s = current->returned_s = current->far_w = 0;
	for (int32_t i = 0; i < current->count; i++) {
		double back = current->to_electrode_s[i] - current->source[i];
		current->conductance_s += heat_at_1v(current, cells, i);
		current->returned_s += (back + current->to_far_s[i]) * x[i];
		current->far_w += current->to_far_s[i] * x[i] * x[i];
	}
	current->conductance_s += current->far_w;
}

void cau_current_solve(cau_current *current, const cau_bioheat *bioheat, double reach_m,
                       bool grounded, double tolerance, int32_t most)
{
	CAU_ASSERT(current->electrode_count > 0, "no electrode");
	CAU_ASSERT(reach_m < return_m, "a reach of %g m", reach_m);
	cau_vec3 middle = electrodes_middle(current, &bioheat->cells);
	find_region(current, &bioheat->cells, reach_m);
	for (int32_t i = 0; i < current->count; i++)
		add_faces(current, bioheat, i, grounded, middle);
	add_electrodes(current, bioheat);
	double *x = current->vector[0];
	for (int32_t i = 0; i < current->count; i++) {
		if (!(current->diagonal_s[i] > 0))
			current->diagonal_s[i] = 1; // a cell without connections stays at 0 V
		x[i] = current->potential[current->cell[i]];
	}
	iterate(current, &bioheat->cells, x, tolerance, most);
	// the least and the greatest potential are at electrodes
	for (int32_t i = 0; i < current->count; i++)
		current->potential[current->cell[i]] = x[i] = fmax(fmin(x[i], 1), 0);
	read_currents(current, &bioheat->cells);
}

void cau_current_heat(const cau_current *current, cau_bioheat *bioheat, double voltage)
{
	CAU_ASSERT(voltage >= 0, "%g V", voltage);
	for (int32_t i = 0; i < current->count; i++)
		bioheat->power_w[current->cell[i]] +=
			heat_at_1v(current, &bioheat->cells, i) * voltage * voltage;
}

// ---- the generator
cau_output cau_generator_into(const cau_generator *generator, double conductance_s)
{
	CAU_ASSERT(conductance_s >= 0, "a load of %g S", conductance_s);
	CAU_ASSERT(generator->crest_factor >= 1, "a crest factor of %g", generator->crest_factor);
	double voltage = generator->peak_v / generator->crest_factor;
	if (conductance_s > 0) {
		voltage = fmin(voltage, sqrt(generator->power_w / conductance_s));
		voltage = fmin(voltage, generator->current_a / conductance_s);
	}
	double current = voltage * conductance_s;
	return (cau_output){.voltage_v = voltage, .current_a = current, .power_w = voltage * current};
}
