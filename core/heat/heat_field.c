// SPDX-License-Identifier: GPL-3.0-or-later
// One temperature field: the step of the heat equation, and nested fields.
#include "heat/heat_field.h"

#include <string.h>

#include "cautery/assert.h"

// ---- one step of the heat equation
// Sum of the six nodes around node i. `row` and `plane` are the distances in memory to the next
// node along y and z.
#define SIX(u, i, row, plane)                                                                      \
	(u[i - 1] + u[i + 1] + u[i - row] + u[i + row] + u[i - plane] + u[i + plane])

// Computes one row of inner nodes along x. `u` and `next` point at the first inner node of the row.
static void diffuse_row(const float *restrict u, float rate, float *restrict next, int64_t count,
                        int64_t row, int64_t plane)
{
	CAU_ASSERT(count >= 1 && row == count + 2, "%lld inner nodes in a row of %lld",
	           (long long)count, (long long)row);
	for (int64_t x = 0; x < count; x++)
		next[x] = u[x] + rate * (SIX(u, x, row, plane) - 6.0F * u[x]);
}

static void diffuse_row_around(const float *restrict u, const float *restrict rate,
                               const float *restrict pull, float held_c, float *restrict next,
                               int64_t count, int64_t row, int64_t plane)
{
	CAU_ASSERT(count >= 1 && row == count + 2, "%lld inner nodes in a row of %lld",
	           (long long)count, (long long)row);
	for (int64_t x = 0; x < count; x++)
		next[x] =
			u[x] + rate[x] * (SIX(u, x, row, plane) - 6.0F * u[x] + pull[x] * (held_c - u[x]));
}

void cau_diffuse(const float *temperature, float rate, float *next, int32_t nodes)
{
	CAU_ASSERT(nodes >= 3 && temperature != next, "a grid of %d nodes, into itself", nodes);
	int64_t row = nodes, plane = row * row;
	for (int64_t z = 1; z < nodes - 1; z++)
		for (int64_t y = 1; y < nodes - 1; y++) {
			int64_t first = 1 + y * row + z * plane;
			diffuse_row(temperature + first, rate, next + first, nodes - 2, row, plane);
		}
}

void cau_diffuse_around(const float *temperature, const float *rate, const float *pull,
                        float held_c, float *next, int32_t nodes)
{
	CAU_ASSERT(nodes >= 3 && temperature != next, "a grid of %d nodes, into itself", nodes);
	int64_t row = nodes, plane = row * row;
	for (int64_t z = 1; z < nodes - 1; z++)
		for (int64_t y = 1; y < nodes - 1; y++) {
			int64_t first = 1 + y * row + z * plane;
			diffuse_row_around(temperature + first, rate + first, pull + first, held_c,
			                   next + first, nodes - 2, row, plane);
		}
}

// Uses 16 lanes instead of one running value, so that the compiler can vectorise the loop without
// reordering operations.
void cau_extremes(const float *values, int64_t count, float *least, float *greatest)
{
	CAU_ASSERT(count >= 1, "the extremes of %lld values", (long long)count);
	enum { LANES = 16 };
	float low[LANES], high[LANES];
	for (int lane = 0; lane < LANES; lane++)
		low[lane] = high[lane] = values[0];
	int64_t whole = count - count % LANES;
	for (int64_t i = 0; i < whole; i += LANES)
		for (int lane = 0; lane < LANES; lane++) {
			float value = values[i + lane];
			low[lane] = value < low[lane] ? value : low[lane];
			high[lane] = value > high[lane] ? value : high[lane];
		}
	for (int64_t i = whole; i < count; i++) {
		low[0] = values[i] < low[0] ? values[i] : low[0];
		high[0] = values[i] > high[0] ? values[i] : high[0];
	}
	*least = low[0];
	*greatest = high[0];
	for (int lane = 1; lane < LANES; lane++) {
		*least = low[lane] < *least ? low[lane] : *least;
		*greatest = high[lane] > *greatest ? high[lane] : *greatest;
	}
}

// ---- the field
void cau_heat_field_fill(cau_heat_field *field, int32_t nodes, float value)
{
	CAU_ASSERT(field->temperature && field->next, "a field of %d nodes without room", nodes);
	int64_t count = (int64_t)nodes * nodes * nodes;
	for (int64_t i = 0; i < count; i++)
		field->temperature[i] = field->next[i] = value;
}

void cau_heat_field_swap(cau_heat_field *field)
{
	float *old = field->temperature;
	field->temperature = field->next;
	field->next = old;
}

// ---- between two nested fields

// Computes in cells of the finer field: twice the middle of this field is 2 finer + N - 1.
void cau_heat_field_origin_around(const int64_t finer[3], int32_t nodes, int64_t origin[3])
{
	for (int axis = 0; axis < 3; axis++) {
		int64_t quarters = 2 * finer[axis] - nodes + 3;
		origin[axis] = (quarters - (quarters & 3)) / 4;
	}
}

// Returns the value of the coarser field at a node of the finer field. This node is also a node of
// the coarser field, or is half way between some of the coarser nodes. Values are added in pairs,
// so that the mean of eight equal values is exactly that value.
static float sample(const cau_heat_field *coarser, int64_t n, int64_t x, int64_t y, int64_t z)
{
	const int64_t node[3] = {x, y, z}, stride[3] = {1, n, n * n};
	int64_t at = 0, on[3];
	for (int axis = 0; axis < 3; axis++) {
		int64_t odd = node[axis] & 1, cell = (node[axis] - odd) / 2 - coarser->origin[axis];
		CAU_ASSERT(cell >= 0 && cell + odd < n, "cell %lld of %lld", (long long)cell, (long long)n);
		at += cell * stride[axis];
		on[axis] = odd * stride[axis];
	}
	const float *u = coarser->temperature + at, *v = u + on[2];
	float below = (u[0] + u[on[0]]) + (u[on[1]] + u[on[0] + on[1]]);
	float above = (v[0] + v[on[0]]) + (v[on[1]] + v[on[0] + on[1]]);
	return 0.125F * (below + above);
}

static int64_t clamp(int64_t node, int64_t least, int64_t most)
{
	return node < least ? least : node > most ? most : node;
}

// Returns the value of a node that is new after a move: from the coarser field, or else from the
// nearest former node.
static float incoming(const cau_heat_field *field, int64_t n, const int64_t origin[3],
                      const int64_t node[3], const cau_heat_field *coarser)
{
	int64_t x = origin[0] + node[0], y = origin[1] + node[1], z = origin[2] + node[2];
	if (coarser)
		return sample(coarser, n, x, y, z);
	x = clamp(x - field->origin[0], 0, n - 1);
	y = clamp(y - field->origin[1], 0, n - 1);
	z = clamp(z - field->origin[2], 0, n - 1);
	return field->temperature[(z * n + y) * n + x];
}

static void move_row(cau_heat_field *field, int64_t n, const int64_t origin[3], int64_t y,
                     int64_t z, const cau_heat_field *coarser)
{
	int64_t shift = origin[0] - field->origin[0];
	int64_t from_y = y + origin[1] - field->origin[1], from_z = z + origin[2] - field->origin[2];
	bool had = from_y >= 0 && from_y < n && from_z >= 0 && from_z < n;
	// First and last x of nodes that were in the field before the move.
	int64_t first = had ? clamp(-shift, 0, n) : n;
	int64_t last = had ? clamp(n - shift, first, n) : n;
	float *to = field->next + (z * n + y) * n;
	if (last > first)
		memcpy(to + first, field->temperature + (from_z * n + from_y) * n + first + shift,
		       (size_t)(last - first) * sizeof *to);
	for (int64_t x = 0; x < first; x++)
		to[x] = incoming(field, n, origin, (const int64_t[3]){x, y, z}, coarser);
	for (int64_t x = last; x < n; x++)
		to[x] = incoming(field, n, origin, (const int64_t[3]){x, y, z}, coarser);
}

void cau_heat_field_move(cau_heat_field *field, int32_t nodes, const int64_t origin[3],
                         const cau_heat_field *coarser)
{
	int64_t n = nodes;
	CAU_ASSERT(n >= 3, "a field of %d nodes", nodes);
	if (!memcmp(field->origin, origin, sizeof field->origin))
		return;
	for (int64_t z = 0; z < n; z++)
		for (int64_t y = 0; y < n; y++)
			move_row(field, n, origin, y, z, coarser);
	memcpy(field->origin, origin, sizeof field->origin);
	cau_heat_field_swap(field);
}

static bool is_outer(int64_t n, int64_t y, int64_t z)
{
	return y == 0 || z == 0 || y == n - 1 || z == n - 1;
}

// Interpolates a whole row along x into `to`. Results equal those of `sample`, but a sum over y and
// z that two nodes need is computed once.
static void sample_row(const cau_heat_field *coarser, int64_t n, const int64_t first[3], float *to)
{
	int64_t odd_y = first[1] & 1, odd_z = first[2] & 1, odd_x = first[0] & 1;
	int64_t x = (first[0] - odd_x) / 2 - coarser->origin[0];
	int64_t y = (first[1] - odd_y) / 2 - coarser->origin[1];
	int64_t z = (first[2] - odd_z) / 2 - coarser->origin[2];
	int64_t along_y = odd_y * n, along_z = odd_z * n * n;
	const float *u = coarser->temperature + (z * n + y) * n + x, *v = u + along_z;
	float here = (u[0] + u[along_y]) + (v[0] + v[along_y]);
	for (int64_t i = 0; i < n; i++) {
		if ((odd_x + i) & 1) { // half way to the next node
			u++, v++;
			float there = (u[0] + u[along_y]) + (v[0] + v[along_y]);
			to[i] = 0.125F * (here + there);
			here = there;
		} else {
			to[i] = 0.25F * here;
		}
	}
}

void cau_heat_field_take_boundary(cau_heat_field *field, int32_t nodes,
                                  const cau_heat_field *coarser)
{
	int64_t n = nodes;
	CAU_ASSERT(n >= 3, "a field of %d nodes", nodes);
	const int64_t *o = field->origin;
	for (int64_t z = 0; z < n; z++)
		for (int64_t y = 0; y < n; y++) {
			int64_t first = (z * n + y) * n, last = first + n - 1;
			float *u = field->temperature, *next = field->next;
			if (is_outer(n, y, z)) {
				sample_row(coarser, n, (const int64_t[3]){o[0], o[1] + y, o[2] + z}, u + first);
				memcpy(next + first, u + first, (size_t)n * sizeof *u);
				continue;
			}
			u[first] = next[first] = sample(coarser, n, o[0], o[1] + y, o[2] + z);
			u[last] = next[last] = sample(coarser, n, o[0] + n - 1, o[1] + y, o[2] + z);
		}
}

void cau_heat_field_take_inner(cau_heat_field *coarser, int32_t nodes, const cau_heat_field *finer)
{
	int64_t n = nodes, least[3], most[3]; // inner nodes of the finer field with even indices
	for (int axis = 0; axis < 3; axis++) {
		int64_t odd = finer->origin[axis] & 1;
		least[axis] = 2 - odd;
		most[axis] = n - 2;
	}
	for (int64_t z = least[2]; z <= most[2]; z += 2)
		for (int64_t y = least[1]; y <= most[1]; y += 2) {
			int64_t x = (finer->origin[0] + least[0]) / 2 - coarser->origin[0];
			int64_t to_y = (finer->origin[1] + y) / 2 - coarser->origin[1];
			int64_t to_z = (finer->origin[2] + z) / 2 - coarser->origin[2];
			CAU_ASSERT(x > 0 && to_y > 0 && to_z > 0 && to_y < n - 1 && to_z < n - 1,
			           "a field reaches out of the one around it");
			float *to = coarser->temperature + (to_z * n + to_y) * n + x;
			const float *from = finer->temperature + (z * n + y) * n;
			for (int64_t k = least[0]; k <= most[0]; k += 2)
				*to++ = from[k];
		}
}

// ---- the outermost field

void cau_heat_field_fall(int32_t nodes, float *fall)
{
	CAU_ASSERT(nodes >= 3, "a field of %d nodes", nodes);
	double middle = (nodes - 1) / 2.0, inner = middle - 1;
	for (int32_t p = 0; p < nodes; p++)
		for (int32_t q = 0; q < nodes; q++) {
			double a = p - middle, b = q - middle;
			double c = fmin(fmax(a, -inner), inner), d = fmin(fmax(b, -inner), inner);
			double within = inner * inner + c * c + d * d, here = middle * middle + a * a + b * b;
			fall[p * nodes + q] = (float)sqrt(within / here);
		}
}

void cau_heat_field_open_boundary(cau_heat_field *field, int32_t nodes, float ambient_c,
                                  const float *fall)
{
	int64_t n = nodes;
	CAU_ASSERT(n >= 3, "a field of %d nodes", nodes);
	for (int64_t z = 0; z < n; z++)
		for (int64_t y = 0; y < n; y++) {
			int64_t in_y = clamp(y, 1, n - 2), in_z = clamp(z, 1, n - 2);
			float *u = field->temperature + (z * n + y) * n;
			const float *within = field->temperature + (in_z * n + in_y) * n;
			const float *side = fall + y * n + z; // value of `fall` for a face across x
			if (in_y != y || in_z != z) {
				const float *row = fall + (in_z != z ? y : z) * n;
				for (int64_t x = 1; x < n - 1; x++)
					u[x] = ambient_c + row[x] * (within[x] - ambient_c);
			}
			u[0] = ambient_c + *side * (within[1] - ambient_c);
			u[n - 1] = ambient_c + *side * (within[n - 2] - ambient_c);
		}
}

// ---- reading

bool cau_heat_field_find(const cau_heat_field *field, int32_t nodes, cau_vec3 point,
                         cau_heat_cell *cell)
{
	const double position[3] = {point.x, point.y, point.z};
	int64_t n = nodes, stride = 1;
	double s[3];
	cell->first = 0;
	for (int axis = 0; axis < 3; axis++) {
		double at = position[axis] / field->step_m - (double)field->origin[axis];
		if (!(at >= 0 && at <= (double)(n - 1)))
			return false;
		double whole = fmin(floor(at), (double)(n - 2));
		cell->first += (int64_t)whole * stride;
		s[axis] = at - whole;
		stride *= n;
	}
	for (int i = 0; i < 8; i++)
		cell->weight[i] =
			(i & 1 ? s[0] : 1 - s[0]) * (i & 2 ? s[1] : 1 - s[1]) * (i & 4 ? s[2] : 1 - s[2]);
	return true;
}

double cau_heat_cell_mean(const cau_heat_cell *cell, const cau_heat_field *field, int32_t nodes)
{
	double sum = 0;
	for (int i = 0; i < 8; i++)
		sum += cell->weight[i] * (double)field->temperature[cau_heat_cell_node(cell, nodes, i)];
	return sum;
}
