// SPDX-License-Identifier: GPL-3.0-or-later
// The region to mesh: a function that gives the label of each point. The mesher uses nothing else.
// So open surfaces, crossing surfaces, partly turned surfaces and voxels are all meshed in the same
// way.
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
