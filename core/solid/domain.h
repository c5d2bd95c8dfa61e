// SPDX-License-Identifier: GPL-3.0-or-later
// What is to be meshed: a label for each place. The mesher asks for nothing else, so that open,
// crossing and partly turned surfaces and voxels are all the same to it.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "mesh/mesh.h"
#include "solid/volume.h"

typedef struct cau_domain cau_domain;

// Labels are numbered from 1; 0 is outside.
struct cau_domain {
	int32_t label_count;
	double least[3], most[3]; // a box around all labels
	double volume;            // of all labels, about
	// The label at x. Labels with passed[label] set are not candidates. passed[0] does the same for
	// the outside. Where no candidate is near, the answer is 0. passed NULL: all are candidates.
	int32_t (*label_at)(const cau_domain *domain, const double x[3], const bool *passed);
	// Whether label_at() surely answers *label at every place of a box, with all candidates. False
	// where that is not known: asking for a box must cost less than asking for its places.
	bool (*is_uniform)(const cau_domain *domain, const double least[3], const double most[3],
	                   int32_t *label);
	void (*finish)(cau_domain *domain);
	void *own;
};

// Inside a surface: places with a generalized winding number above a half [Jacobson et al. 2013;
// far triangles as dipoles, Barill et al. 2018]. The triangles are borrowed, and turned in place so
// that they look outward; *turned: how many were.
cau_status cau_domain_of_surface(cau_mesh *surface, cau_domain *domain, int32_t *turned,
                                 cau_error *error);
// The voxels around a place vote, by a cubic B-spline's weights. The volume is borrowed.
void cau_domain_of_volume(const cau_volume *volume, cau_domain *domain);

static inline void cau_domain_finish(cau_domain *domain)
{
	if (domain->finish)
		domain->finish(domain);
}
