// SPDX-License-Identifier: GPL-3.0-or-later
// A scene made in C, with its tissue, laws and solver, but without a session. Tests of laws, of the
// solver and of other core folders use it. If a module refuses its input, the functions of this
// file fail the running test.
#pragma once

// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on

#include "core/rig/matrix.h"
#include "core/tool/tools.h"
#include "dissect/dissection.h"
#include "dissect/shrink.h"
#include "solve/matrix_update.h"
#include "solve/solver.h"

typedef struct rig {
	cau_arena arena;
	cau_scene_def *scene;
	cau_tissue tissue;
	cau_dissection dissection; // dissection.alive is the set of live elements
	cau_shrink shrink;
	cau_step_solver solver; // the position is the rest position at first
	cau_matrix_update update;
	uint8_t *fixed;
} rig;

// Begins an empty scene: double precision, no gravity, steps of 1/60 s.
void rig_begin(rig *r);

// Adds a layer with its own mesh, named "layer<i>", with the defaults of its kind. The result
// points into the scene. Change the layer before rig_build.
cau_layer_def *rig_add_sheet(rig *r, int32_t cells_x, int32_t cells_y); // size 0.1 x 0.08 m
cau_layer_def *rig_add_slab(rig *r, int32_t x, int32_t y, int32_t z);   // size 0.1 x 0.08 x 0.03 m
// Adds a layer of triangles (count x 3) or tetrahedra (count x 4) over points (m, point_count x 3).
cau_layer_def *rig_add_triangles(rig *r, int32_t point_count, const double *points, int32_t count,
                                 const int32_t *vertex);
cau_layer_def *rig_add_tetrahedra(rig *r, int32_t point_count, const double *points, int32_t count,
                                  const int32_t *vertex);
// Adds trusses from layer `of` to layer `to`.
cau_layer_def *rig_add_links(rig *r, int32_t of, int32_t to, double reach_m);
// Pins the vertices whose rest position is inside the box.
void rig_pin_box(rig *r, const double least_m[3], const double most_m[3]);

// Builds tissue, laws and solver. Kernels are of `tier` at most (NULL: test_tier() of rig/tier.h).
// The pool has `threads`.
void rig_build(rig *r, const char *tier, int32_t threads);
// Computes the factor, and starts its updates after cuts.
void rig_factor(rig *r);
void rig_finish(rig *r);

// Returns the energy (J) of the elements at position x (m, n x 3). If `gradient` is not NULL, also
// computes its gradient (N, n x 3) by the kernels.
double rig_local(rig *r, const double *x, double *gradient);

// Returns the energy (J) of the elements of one kind (CAU_ELEMENT_*) at the last rig_local.
double rig_energy_of(const rig *r, int work_kind);

// rig_record returns the record of the i-th vertex of an element, rig_vertex the vertex itself.
int32_t rig_record(const rig *r, int kind, int32_t slot, int i);
int32_t rig_vertex(const rig *r, int kind, int32_t slot, int i);
int rig_vertex_count(int kind);
// Computes the gradient (N) of one element's energy at its vertices (vertices x 3), by the kernels,
// at the displacement of the last rig_local. The other elements of its share have the weight 0
// meanwhile.
void rig_element_gradient(rig *r, int kind, int32_t slot, double *gradient);

// Removes the element from dissection, laws and factor, as a cut does.
void rig_remove(rig *r, int kind, int32_t element, uint64_t tick);

// Does one tick of the factor's update, without a step.
void rig_update_factor(rig *r, uint64_t tick);

// Maps rest positions by x -> A x, and moves them by random noise (m) in each coordinate.
void rig_deform(const rig *r, double a[3][3], double noise_m, uint64_t *random, double *x);

// Computes a random matrix I + H, with entries of H from -size to size.
void rig_random_gradient(uint64_t *random, double size, double a[3][3]);

// Returns the largest |a_i - b_i| over n numbers, relative to the largest |b_i|.
double rig_difference(const double *a, const double *b, size_t n);
