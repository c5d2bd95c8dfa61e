// SPDX-License-Identifier: GPL-3.0-or-later
// Vectors of reals, and simple loops over them: copies between the session's doubles and the
// solver's reals. vectors.c is compiled once per precision, for every processor, and without fused
// multiply-add. So its results do not depend on the instruction set. A session's kernels contain
// the table of their precision.
#pragma once

#include <stddef.h>
#include <stdint.h>

// An array of floats or doubles, depending on the session's precision. Only code that is compiled
// for one precision reads it; other code passes pointers.
typedef struct cau_reals cau_reals;

typedef struct cau_sweep cau_sweep;
typedef struct cau_step_solver cau_step_solver;

// Operations on vectors with four reals for each vertex: x, y, z and 0.
typedef struct cau_vectors {
	size_t real_bytes;
	double rounding; // largest rounding error of a sum, relative to its terms

	// ---- any vector
	double (*at)(const cau_reals *array, int64_t index);
	void (*read)(const cau_reals *vector, int32_t vertex, double value[3]);
	void (*add)(cau_reals *vector, int32_t vertex, const double value[3]);
	// Returns the length of the longest of `count` vertices' values.
	double (*longest)(const cau_reals *vector, int32_t count);
	// column[v] = coordinate c of vertex v, for v below `count`
	void (*take_coordinate)(cau_reals *column, const cau_reals *vector, int c, int32_t count);

	// ---- the solver's own vectors, of vertices [first, last)
	// displacement = position - rest
	void (*displace)(const cau_step_solver *solver, int32_t first, int32_t last);
	// position = iterate.before + scale * iterate.trial
	void (*step)(const cau_step_solver *solver, double scale, int32_t first, int32_t last);
	// gradient += m / dt^2 (position - predicted); the gradient is set to 0 at fixed vertices.
	// Returns the energy of inertia, J.
	double (*add_inertia)(const cau_step_solver *solver, int32_t first, int32_t last);
	// Sums over the free vertices: mass; and mass times the squares of the trial increment, of the
	// increment, and of the step's motion with the trial increment. kg, kg m^2
	void (*measure)(const cau_step_solver *solver, int32_t first, int32_t last, double sums[4]);

	// ---- A^-1 of a vector
	// out = sign * in / diagonal, for all vertices; 0 at fixed vertices
	void (*divide)(const cau_step_solver *solver, const cau_reals *in, cau_reals *out, double sign);
	// permute fills the sweep's field at rows [first, last) with `sign` times `in` (by vertex).
	// unpermute copies the field to `out`, with 0 at fixed vertices.
	void (*permute)(const cau_step_solver *solver, const cau_reals *in, double sign, int32_t first,
	                int32_t last);
	void (*unpermute)(const cau_step_solver *solver, cau_reals *out, int32_t first, int32_t last);
	// A task's sums for the rows above it: clear_sums sets them to 0, add_sums adds them to the
	// rows.
	void (*clear_sums)(const cau_sweep *sweep, int32_t task);
	void (*add_sums)(const cau_sweep *sweep, int32_t task);
} cau_vectors;
