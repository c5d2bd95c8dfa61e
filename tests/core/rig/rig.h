// SPDX-License-Identifier: GPL-3.0-or-later
// A scene made in C, its tissue, laws and solver, without a session: what the tests of base rooms,
// laws and solver stand on. Functions fail the running test where a module refuses.
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
	cau_dissection dissection; // its alive set is the rig's
	cau_shrink shrink;
	cau_step_solver solver; // position starts at rest
	cau_matrix_update update;
	uint8_t *fixed;
} rig;

// An empty scene: double precision, no gravity, steps of 1/60 s.
void rig_begin(rig *r);

// A layer on a mesh of its own, named "layer<i>", with the defaults of its kind. The pointer is
// into the scene, to be changed before rig_build.
cau_layer_def *rig_add_sheet(rig *r, int32_t cells_x, int32_t cells_y); // 0.1 x 0.08 m
cau_layer_def *rig_add_slab(rig *r, int32_t x, int32_t y, int32_t z);   // 0.1 x 0.08 x 0.03 m
// Triangles (count x 3) or tetrahedra (count x 4) over points (m, point_count x 3).
cau_layer_def *rig_add_triangles(rig *r, int32_t point_count, const double *points, int32_t count,
                                 const int32_t *vertex);
cau_layer_def *rig_add_tetrahedra(rig *r, int32_t point_count, const double *points, int32_t count,
                                  const int32_t *vertex);
// Trusses from layer `of` to layer `to`.
cau_layer_def *rig_add_links(rig *r, int32_t of, int32_t to, double reach_m);
// Pins the vertices at rest inside the box.
void rig_pin_box(rig *r, const double least_m[3], const double most_m[3]);

// Tissue, laws and solver; kernels up to `tier` (NULL: test_tier() of rig/tier.h), a pool of
// `threads`.
void rig_build(rig *r, const char *tier, int32_t threads);
// The factor and what keeps it in step with cuts.
void rig_factor(rig *r);
void rig_finish(rig *r);

// Energy (J) of the elements at position x (m, n x 3) and, where `gradient` is not NULL, its
// gradient (N, n x 3) as the kernels give it.
double rig_local(rig *r, const double *x, double *gradient);

// Energy (J) of the elements of one work kind (CAU_WORK_*) at the last rig_local.
double rig_energy_of(const rig *r, int work_kind);

// Gradient (N) of one element's energy on its vertices (vertices x 3) at the displacement of the
// Of the i-th of an element's vertices: its record, the vertex.
int32_t rig_record(const rig *r, int kind, int32_t slot, int i);
int32_t rig_vertex(const rig *r, int kind, int32_t slot, int i);
int rig_vertex_count(int kind);
// last rig_local, by the kernels: the other elements of its share are silenced meanwhile.
void rig_element_gradient(rig *r, int kind, int32_t slot, double *gradient);

// Takes the element out of dissection, laws and factor's books, as a cut does.
void rig_remove(rig *r, int kind, int32_t element, uint64_t tick);

// A tick of the factor's books, without a step.
void rig_update_factor(rig *r, uint64_t tick);

// Rest positions carried along by x -> A x and moved by noise (m) in each coordinate.
void rig_deform(const rig *r, double a[3][3], double noise_m, uint64_t *random, double *x);

// A random matrix I + H, entries of H in +-size.
void rig_random_gradient(uint64_t *random, double size, double a[3][3]);

// Largest |a_i - b_i| over n numbers, relative to the largest |b_i|.
double rig_difference(const double *a, const double *b, size_t n);
