// SPDX-License-Identifier: GPL-3.0-or-later
// The mesher: the region to mesh, and the tetrahedra made of it.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "mesh/mesh.h"
#include "solid/volume.h"

// ---- the region to mesh
// The region is a function that gives the label of each point. The mesher uses nothing else. So
// open surfaces, crossing surfaces, partly turned surfaces and voxels are all meshed in the same
// way.
typedef struct cau_domain cau_domain;

// Labels are numbered from 1; 0 is outside.
struct cau_domain {
	int32_t label_count;
	double least[3], most[3]; // a box around all labels
	double volume;            // approximate volume of all labels
	// Returns the label at x. Labels with passed[label] set are not candidates, and passed[0]
	// excludes the outside. If no candidate is near, the result is 0. If `passed` is NULL, all are
	// candidates.
	int32_t (*label_at)(const cau_domain *domain, const double x[3], const bool *passed);
	// Whether label_at(), with all candidates, surely returns *label at every point of a box.
	// Returns false if that is not known. A call for a box must cost less than calls for its
	// points.
	bool (*is_uniform)(const cau_domain *domain, const double least[3], const double most[3],
	                   int32_t *label);
	void (*finish)(cau_domain *domain);
	void *own;
};

// Makes the domain inside a surface: points with a generalized winding number above a half
// [Jacobson et al. 2013; far triangles as dipoles, Barill et al. 2018]. The triangles are borrowed.
// They are turned in place so that they face outward. *turned is the number of turned triangles.
cau_status cau_domain_of_surface(cau_mesh *surface, cau_domain *domain, int32_t *turned,
                                 cau_error *error);
// Makes the domain of a volume. The voxels around a point vote for its label, with the weights of a
// cubic B-spline. The volume is borrowed.
void cau_domain_of_volume(const cau_volume *volume, cau_domain *domain);

static inline void cau_domain_finish(cau_domain *domain)
{
	if (domain->finish)
		domain->finish(domain);
}

// Turns triangles so that two triangles that alone share an edge have the same orientation. Each
// piece then encloses a positive volume, unless the piece is inside another piece. Such a cavity
// keeps its own orientation. *turned is the number of turned triangles.
cau_status cau_orient(cau_mesh *surface, int32_t *turned, cau_error *error);

// ---- a growing list of tetrahedra
enum { CAU_UNDECIDED = -1 }; // a tetrahedron that has no label yet

typedef struct cau_tets {
	double *position; // (vertex_count x 3)
	// (vertex_count): the vertex is on the interface of a label that was cut before.
	uint8_t *on_interface;
	int32_t vertex_count, vertex_capacity;
	int32_t *vertex; // (count x 4), positive volume
	int32_t *label;  // (count): label of the domain, 0 for outside, or CAU_UNDECIDED
	int32_t count, capacity;
	double spacing; // spacing of the lattice
	bool failed;    // memory ran out, or there would be too many tetrahedra
} cau_tets;

// The elements of a list around each vertex. Vertex v has item[first[v] .. first[v + 1]).
typedef struct cau_around {
	int32_t *first; // (vertex_count + 1)
	int32_t *item;
} cau_around;

// Lists the elements around each vertex. Each element has `corners` vertices. Returns false if
// memory ran out.
bool cau_around_make(cau_around *around, const int32_t *element, int32_t count, int corners,
                     int32_t vertex_count);
void cau_around_finish(cau_around *around);

// Adds a vertex and returns its index, or 0 after a failure.
int32_t cau_tets_vertex(cau_tets *tets, const double position[3], bool on_interface);
// Adds a tetrahedron. If its volume would be negative, two of its vertices are exchanged.
void cau_tets_add(cau_tets *tets, const int32_t vertex[4], int32_t label);
void cau_tets_finish(cau_tets *tets);

// Returns the least sine of an angle between two faces. The best value is 1. The result is negative
// if the tetrahedron is inverted [Labelle and Shewchuk 2007].
double cau_tet_quality(const double *position, const int32_t vertex[4]);
// Returns the least quality of all tetrahedra around a vertex. The search ends early once the
// quality is not above `enough`.
double cau_least_around(const cau_tets *tets, const cau_around *around, int32_t vertex,
                        double enough);
// Returns the least angle between faces of all tetrahedra, in degrees.
double cau_least_angle_deg(const cau_tets *tets);

// Makes a body-centred cubic lattice over the domain. Tetrahedra with all corners outside are left
// out. Fails with CAU_LIMIT at "edge".
cau_status cau_lattice(const cau_domain *domain, double spacing, cau_tets *tets, cau_error *error);
// Cuts the lattice along the surface of the tissue, then the tissue along each label. Tetrahedra
// outside the tissue are removed (isosurface stuffing, Labelle and Shewchuk 2007).
cau_status cau_stuff(const cau_domain *domain, cau_tets *tets,
                     void (*progress)(void *user, double share), void *user, cau_error *error);
// Moves a vertex if that improves the worst tetrahedron around it. Vertices of an interface stay on
// the interface.
cau_status cau_smooth(const cau_domain *domain, cau_tets *tets, cau_error *error);
