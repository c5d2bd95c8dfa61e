// SPDX-License-Identifier: GPL-3.0-or-later
// Tetrahedra while they are made.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "solid/domain.h"

enum { CAU_UNDECIDED = -1 }; // a tetrahedron that no label has taken yet

typedef struct cau_tets {
	double *position;      // (vertex_count x 3)
	uint8_t *on_interface; // (vertex_count): of a label that was cut before
	int32_t vertex_count, vertex_capacity;
	int32_t *vertex; // (count x 4), positive volume
	int32_t *label;  // (count): of the domain, 0 outside, or CAU_UNDECIDED
	int32_t count, capacity;
	double spacing; // of the lattice
	bool failed;    // memory ran out, or there would be too many
} cau_tets;

// The tetrahedra of a list around each vertex: of vertex v, item[first[v] .. first[v + 1]).
typedef struct cau_around {
	int32_t *first; // (vertex_count + 1)
	int32_t *item;
} cau_around;

// Elements of `corners` vertices each. False: no memory.
bool cau_around_make(cau_around *around, const int32_t *element, int32_t count, int corners,
                     int32_t vertex_count);
void cau_around_finish(cau_around *around);

int32_t cau_tets_vertex(cau_tets *tets, const double position[3], bool on_interface);
// Turned where its volume would be negative.
void cau_tets_add(cau_tets *tets, const int32_t vertex[4], int32_t label);
void cau_tets_finish(cau_tets *tets);

// The least sine of an angle between two faces, negative where it is inside out: 1 at best
// [Labelle and Shewchuk 2007].
double cau_tet_quality(const double *position, const int32_t vertex[4]);
// The least of all tetrahedra around a vertex; `most` ends the search below it.
double cau_least_around(const cau_tets *tets, const cau_around *around, int32_t vertex,
                        double enough);
// The least angle between faces of all tetrahedra, in degrees.
double cau_least_angle_deg(const cau_tets *tets);

// A body-centred cubic lattice over the domain, without tetrahedra that lie outside at all corners.
// CAU_LIMIT at "edge".
cau_status cau_lattice(const cau_domain *domain, double spacing, cau_tets *tets, cau_error *error);
// Cuts the lattice along the surface of the tissue, then the tissue along each label. Tetrahedra
// outside the tissue are left out (isosurface stuffing, Labelle and Shewchuk 2007).
cau_status cau_stuff(const cau_domain *domain, cau_tets *tets,
                     void (*progress)(void *user, double share), void *user, cau_error *error);
// Moves vertices where that makes the worst tetrahedron around them better; those of an interface
// stay on it.
cau_status cau_smooth(const cau_domain *domain, cau_tets *tets, cau_error *error);
