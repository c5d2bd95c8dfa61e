// SPDX-License-Identifier: GPL-3.0-or-later
// Labels of voxels as a domain. The nearest voxel alone would make stairs of every surface. So the
// 64 voxels around a place vote, each with the weight of a cubic B-spline there.
#include <math.h>

#include "cautery/assert.h"
#include "mesh/geometry.h"
#include "solid/domain.h"

enum { REACH = 4 }; // voxels along each axis that vote
// A box with more voxels is never called uniform. A block of the lattice has 64 corners and 64
// centres, and label_at() reads eight voxels for each.
enum { READ_MOST = 8 * 128 };
static const double rounding = 1e-6; // of an index, in voxels; the two ways to it differ by 1e-10

static int32_t voxel_at(const cau_volume *volume, const int64_t index[3])
{
	int64_t place = 0;
	for (int c = 2; c >= 0; c--) {
		if (index[c] < 0 || index[c] >= volume->size[c])
			return 0;
		place = place * volume->size[c] + index[c];
	}
	return volume->voxel[place];
}

static void weights_of(double t, double weight[REACH])
{
	double s = 1 - t;
	weight[0] = s * s * s / 6;
	weight[1] = (4 - 6 * t * t + 3 * t * t * t) / 6;
	weight[2] = (4 - 6 * s * s + 3 * s * s * s) / 6;
	weight[3] = t * t * t / 6;
}

// The label of the eight voxels next to the place, where it is the same: they have more than half
// of all weights. Else -1.
static int32_t label_of_inner(const cau_volume *volume, const int64_t first[3])
{
	int32_t label = -1;
	for (int i = 0; i < 8; i++) {
		const int64_t index[3] = {first[0] + 1 + (i & 1), first[1] + 1 + (i >> 1 & 1),
		                          first[2] + 1 + (i >> 2)};
		int32_t own = voxel_at(volume, index);
		if (i && own != label)
			return -1;
		label = own;
	}
	return label;
}

static int32_t vote(const cau_volume *volume, const int64_t first[3], double weight[3][REACH],
                    const bool *passed)
{
	double votes[CAU_SOLID_LABEL_MAX + 1] = {0};
	for (int k = 0; k < REACH; k++)
		for (int j = 0; j < REACH; j++)
			for (int i = 0; i < REACH; i++) {
				const int64_t index[3] = {first[0] + i, first[1] + j, first[2] + k};
				votes[voxel_at(volume, index)] += weight[0][i] * weight[1][j] * weight[2][k];
			}
	int32_t best = 0;
	double most = passed && passed[0] ? 0 : votes[0];
	for (int32_t label = 1; label <= volume->label_count; label++)
		if (votes[label] > most && !(passed && passed[label])) {
			most = votes[label];
			best = label;
		}
	return best;
}

static int32_t label_at(const cau_domain *domain, const double x[3], const bool *passed)
{
	const cau_volume *volume = domain->own;
	int64_t first[3];
	double weight[3][REACH];
	for (int i = 0; i < 3; i++) {
		double index = 0;
		for (int c = 0; c < 3; c++)
			index += volume->inverse[i][c] * (x[c] - volume->origin[c]);
		if (!(index > -REACH && index < volume->size[i] + REACH))
			return 0;
		first[i] = (int64_t)floor(index) - 1;
		weights_of(index - floor(index), weight[i]);
	}
	int32_t inner = label_of_inner(volume, first);
	if (inner >= 0 && !(passed && passed[inner]))
		return inner;
	return vote(volume, first, weight, passed);
}

// The voxels that vote anywhere in a box, along axis i of the indices. The range is cut to the
// volume; *outside is set where voxels beyond it vote. False: not finite.
static bool voters_in(const cau_volume *volume, int i, const double least[3], const double most[3],
                      int64_t range[2], bool *outside)
{
	double middle = 0, half = rounding;
	for (int c = 0; c < 3; c++) {
		middle += volume->inverse[i][c] * ((least[c] + most[c]) / 2 - volume->origin[c]);
		half += fabs(volume->inverse[i][c]) * (most[c] - least[c]) / 2;
	}
	double size = volume->size[i], first = floor(middle - half) - 1;
	double last = floor(middle + half) + REACH - 2;
	*outside |= !(first >= 0 && last < size);
	range[0] = (int64_t)fmin(fmax(first, 0), size);
	range[1] = (int64_t)fmin(fmax(last, -1), size - 1);
	return isfinite(first) && isfinite(last);
}

static bool is_uniform(const cau_domain *domain, const double least[3], const double most[3],
                       int32_t *label)
{
	const cau_volume *volume = domain->own;
	int64_t range[3][2];
	bool outside = false;
	double count = 1;
	for (int i = 0; i < 3; i++) {
		if (!voters_in(volume, i, least, most, range[i], &outside))
			return false;
		count *= fmax((double)(range[i][1] - range[i][0] + 1), 0);
	}
	*label = 0;
	if (count == 0 || count > READ_MOST)
		return count == 0;
	const int64_t first[3] = {range[0][0], range[1][0], range[2][0]};
	*label = outside ? 0 : voxel_at(volume, first);
	for (int64_t k = range[2][0]; k <= range[2][1]; k++)
		for (int64_t j = range[1][0]; j <= range[1][1]; j++) {
			const uint8_t *row = volume->voxel + (k * volume->size[1] + j) * volume->size[0];
			for (int64_t i = range[0][0]; i <= range[0][1]; i++)
				if (row[i] != *label)
					return false;
		}
	return true;
}

// The volume of a voxel.
static double cell_of(const cau_volume *volume)
{
	double normal[3];
	cau_cross3(volume->axis[0], volume->axis[1], normal);
	return fabs(cau_dot3(normal, volume->axis[2]));
}

void cau_domain_of_volume(const cau_volume *volume, cau_domain *domain)
{
	*domain = (cau_domain){.label_count = volume->label_count,
	                       .label_at = label_at,
	                       .is_uniform = is_uniform,
	                       .own = (void *)volume};
	int32_t least[3] = {INT32_MAX, INT32_MAX, INT32_MAX}, most[3] = {-1, -1, -1};
	const uint8_t *at = volume->voxel;
	for (int32_t k = 0; k < volume->size[2]; k++)
		for (int32_t j = 0; j < volume->size[1]; j++)
			for (int32_t i = 0; i < volume->size[0]; i++) {
				const int32_t index[3] = {i, j, k};
				if (!*at++)
					continue;
				for (int c = 0; c < 3; c++) {
					least[c] = index[c] < least[c] ? index[c] : least[c];
					most[c] = index[c] > most[c] ? index[c] : most[c];
				}
			}
	for (int32_t label = 1; label <= volume->label_count; label++)
		domain->volume += (double)volume->label[label].voxel_count * cell_of(volume);
	CAU_ASSERT(most[0] >= 0, "a volume of %d labels without a voxel", volume->label_count);
	for (int c = 0; c < 3; c++) {
		domain->least[c] = INFINITY;
		domain->most[c] = -INFINITY;
	}
	for (int corner = 0; corner < 8; corner++)
		for (int c = 0; c < 3; c++) {
			double x = volume->origin[c];
			for (int i = 0; i < 3; i++)
				x += volume->axis[i][c] * (corner >> i & 1 ? most[i] + 1 : least[i] - 1);
			domain->least[c] = fmin(domain->least[c], x);
			domain->most[c] = fmax(domain->most[c], x);
		}
}
