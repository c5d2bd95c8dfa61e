// SPDX-License-Identifier: GPL-3.0-or-later
// Vectors of reals, and the loops over them that are no kernels: what lies between the session's
// doubles and the solver's reals. vectors.c is compiled once per precision, for every processor and
// without fused multiply-add, so its results do not depend on the instruction set. The kernels of a
// session name the table of their precision.
#pragma once

#include <stddef.h>
#include <stdint.h>

// Floats or doubles, as the session's precision says. Only what is compiled for one precision looks
// inside; all else hands pointers on.
typedef struct cau_reals cau_reals;

typedef struct cau_sweep cau_sweep;
typedef struct cau_step_solver cau_step_solver;

// A vector has four reals a vertex: x, y, z and 0.
typedef struct cau_vectors {
	size_t real_bytes;
	double rounding; // what rounding can do to a sum, relative to its terms

	// ---- anywhere
	double (*at)(const cau_reals *array, int64_t index);
	void (*read)(const cau_reals *vector, int32_t vertex, double value[3]);
	void (*add)(cau_reals *vector, int32_t vertex, const double value[3]);
	// The length of the longest of `count` vertices' values.
	double (*longest)(const cau_reals *vector, int32_t count);
	// column[v] = coordinate c of vertex v, for v below `count`
	void (*take_coordinate)(cau_reals *column, const cau_reals *vector, int c, int32_t count);

	// ---- the solver's own vectors, of vertices [first, last)
	// displacement = position - rest
	void (*displace)(const cau_step_solver *solver, int32_t first, int32_t last);
	// position = position_before + scale * trial_increment
	void (*step)(const cau_step_solver *solver, double scale, int32_t first, int32_t last);
	// gradient += m / dt^2 (position - predicted), and zero where a vertex is fixed; returns the
	// energy of that, J
	double (*add_inertia)(const cau_step_solver *solver, int32_t first, int32_t last);
	// mass, and mass times the squares of trial increment, increment, and of the motion that the
	// trial increment makes of the step, over the free vertices: kg, kg m^2
	void (*measure)(const cau_step_solver *solver, int32_t first, int32_t last, double sums[4]);

	// ---- A^-1 of a vector
	// out = sign * in / diagonal, of all vertices; zero where a vertex is fixed
	void (*divide)(const cau_step_solver *solver, const cau_reals *in, cau_reals *out, double sign);
	// The sweep's field at places [first, last) from `in`, by vertex, times sign; and back to
	// `out`, zero where a vertex is fixed.
	void (*permute)(const cau_step_solver *solver, const cau_reals *in, double sign, int32_t first,
	                int32_t last);
	void (*unpermute)(const cau_step_solver *solver, cau_reals *out, int32_t first, int32_t last);
	// A task's sums for the rows above it: begun anew; added to those rows.
	void (*clear_sums)(const cau_sweep *sweep, int32_t task);
	void (*add_sums)(const cau_sweep *sweep, int32_t task);
} cau_vectors;
