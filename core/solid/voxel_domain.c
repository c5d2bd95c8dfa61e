// SPDX-License-Identifier: GPL-3.0-or-later
// Labels of voxels as a domain. If only the nearest voxel counted, every surface would have stairs.
// So the 64 voxels around a point vote, each with its weight of a cubic B-spline at that point.
#include <math.h>

#include "cautery/assert.h"
#include "mesh/geometry.h"
#include "solid/mesher.h"

enum { REACH = 4 }; // voxels along each axis that vote
// Largest number of voxels that is_uniform() reads for a box; it returns false for larger boxes. A
// block of the lattice has 64 corners and 64 centres, and label_at() reads eight or all 64 voxels
// for each. So 512 is half of the least number of reads for a block.
enum { READ_MOST = 512 };
// Margin for rounding of an index, in voxels, and of votes; both have errors of about 1e-10.
static const double rounding = 1e-6;

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

// Returns the label of the eight voxels next to the point, if all eight have the same. They have
// more than half of all weights. Returns -1 if their labels differ.
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

// ---- boxes
// The voxels that vote anywhere in a box, along one axis: the first of them, their number, and the
// limits of the weight of each.
typedef struct voters {
	int64_t first;
	int32_t count;
	double least[READ_MOST], most[READ_MOST];
} voters;

// Returns the cubic B-spline at a distance.
static double weight_at(double distance)
{
	double t = fabs(distance);
	return t < 1 ? (4 - 6 * t * t + 3 * t * t * t) / 6 : t < 2 ? pow(2 - t, 3) / 6 : 0;
}

// Finds the voters along axis i of the indices. Returns false if they are not finite, or too many.
static bool find_voters(const cau_volume *volume, int i, const double least[3],
                        const double most[3], voters *of)
{
	double middle = 0, half = rounding;
	for (int c = 0; c < 3; c++) {
		middle += volume->inverse[i][c] * ((least[c] + most[c]) / 2 - volume->origin[c]);
		half += fabs(volume->inverse[i][c]) * (most[c] - least[c]) / 2;
	}
	double first = floor(middle - half) - 1, count = floor(middle + half) + REACH - 1 - first;
	if (!(count <= READ_MOST && fabs(first) < 1e9))
		return false;
	of->first = (int64_t)first;
	of->count = (int32_t)count;
	for (int32_t k = 0; k < of->count; k++) {
		double away = fabs(first + k - middle);
		of->most[k] = weight_at(fmax(away - half, 0));
		of->least[k] = weight_at(away + half);
	}
	return true;
}

// Whether the winner has more votes than any other label everywhere in the box. The vote of each
// label is bounded by the limits of its voxels' weights. The winner also has at least the votes
// that the other labels leave.
static bool wins(const cau_volume *volume, const voters axis[3], int32_t winner)
{
	double most[CAU_SOLID_LABEL_MAX + 1] = {0}, least = 0, others = 0;
	for (int32_t k = 0; k < axis[2].count; k++)
		for (int32_t j = 0; j < axis[1].count; j++)
			for (int32_t i = 0; i < axis[0].count; i++) {
				int32_t label =
					voxel_at(volume, (const int64_t[3]){axis[0].first + i, axis[1].first + j,
				                                        axis[2].first + k});
				double weight = axis[0].most[i] * axis[1].most[j] * axis[2].most[k];
				if (label == winner)
					least += axis[0].least[i] * axis[1].least[j] * axis[2].least[k];
				else
					most[label] += weight;
				others += label == winner ? 0 : weight;
			}
	least = fmax(least, 1 - others);
	for (int32_t label = 0; label <= volume->label_count; label++)
		if (label != winner && !(most[label] < least - rounding))
			return false;
	return true;
}

static bool is_uniform(const cau_domain *domain, const double least[3], const double most[3],
                       int32_t *label)
{
	const cau_volume *volume = domain->own;
	voters axis[3];
	double middle[3], count = 1;
	bool beyond = false;
	for (int i = 0; i < 3; i++) {
		middle[i] = (least[i] + most[i]) / 2;
		if (!find_voters(volume, i, least, most, &axis[i]))
			return false;
		count *= axis[i].count;
		beyond |= axis[i].first >= volume->size[i] || axis[i].first + axis[i].count <= 0;
	}
	*label = 0;
	if (beyond || count > READ_MOST)
		return beyond;
	*label = label_at(domain, middle, NULL);
	return wins(volume, axis, *label);
}

// Returns the volume of a voxel.
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
