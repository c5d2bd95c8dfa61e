// SPDX-License-Identifier: GPL-3.0-or-later
// The possible sizes of tissue, and the most likely unit of a file with another size.
#include <math.h>
#include <stddef.h>

#include "cautery/assert.h"
#include "mesh/mesh.h"

// Possible sizes of tissue: from a piece of a vessel's wall to a whole body.
static const double tissue_least_m = 0.0005, tissue_most_m = 3;
// Most frequent sizes in files: from a gall bladder to a torso.
static const double organ_least_m = 0.02, organ_most_m = 0.8;

static const struct {
	double unit_m;
	const char *name;
} units[] = {{1e-3, "millimetres"}, {1e-2, "centimetres"}, {1, "metres"},
             {1e-6, "micrometres"}, {0.1, "decimetres"},   {1e3, "kilometres"}};

bool cau_is_tissue_size(double longest_m)
{
	return longest_m >= tissue_least_m && longest_m <= tissue_most_m;
}

double cau_guess_unit(double longest)
{
	CAU_ASSERT(longest > 0, "a mesh of length %g", longest);
	for (size_t i = 0; i < sizeof units / sizeof *units; i++)
		if (longest * units[i].unit_m >= organ_least_m && longest * units[i].unit_m <= organ_most_m)
			return units[i].unit_m;
	return pow(10, floor(log10(organ_most_m / longest)));
}

const char *cau_unit_name(double unit_m)
{
	for (size_t i = 0; i < sizeof units / sizeof *units; i++)
		if (fabs(unit_m / units[i].unit_m - 1) < 1e-6)
			return units[i].name;
	return "another unit";
}
