// SPDX-License-Identifier: GPL-3.0-or-later
// A surface as a domain: the winding number of the surface around a point decides.
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "mesh/geometry.h"
#include "solid/mesher.h"

enum { LEAF = 8, STACK = 160, UNEVEN = 8 }; // UNEVEN = 8 keeps the depth of the tree below 125
// Distance, in radii of a node, from which on the node counts as one dipole.
static const double far_radii = 2.5;
// Margin for rounding of lengths and winding numbers; sums have errors of about 1e-10.
static const double rounding = 1e-6;

typedef struct node {
	double centre[3];     // mean of the triangles' centres by area
	double dipole[3];     // sum of area normals
	double radius;        // largest distance of a corner from the centre
	int32_t first, count; // triangles; if count is 0, the children are at `first` and `first` + 1
} node;

typedef struct tree {
	const cau_mesh *surface;
	int32_t *order; // triangles, in the order of the nodes
	double *middle; // (triangle_count x 3): centre of each triangle
	node *node;
	int32_t node_count;
} tree;

// ---- building
static void fill_node(tree *of, node *at)
{
	const double *x = of->surface->position;
	double area = 0;
	for (int32_t i = at->first; i < at->first + at->count; i++) {
		double normal[3];
		cau_triangle_normal(x, of->surface->triangle + 3 * (size_t)of->order[i], normal);
		double own = sqrt(cau_dot3(normal, normal)) / 2;
		area += own;
		for (int c = 0; c < 3; c++) {
			at->dipole[c] += normal[c] / 2;
			at->centre[c] += own * of->middle[3 * (size_t)of->order[i] + (size_t)c];
		}
	}
	for (int c = 0; c < 3; c++)
		at->centre[c] = area > 0 ? at->centre[c] / area
		                         : of->middle[3 * (size_t)of->order[at->first] + (size_t)c];
	for (int32_t i = at->first; i < at->first + at->count; i++)
		for (int k = 0; k < 3; k++) {
			double away[3];
			int32_t corner = of->surface->triangle[3 * (size_t)of->order[i] + (size_t)k];
			cau_subtract3(x + 3 * (size_t)corner, at->centre, away);
			at->radius = fmax(at->radius, sqrt(cau_dot3(away, away)));
		}
}

// Returns the axis along which the triangles' centres spread most. *middle is the middle of that
// spread.
static int widest_axis(const tree *of, const node *at, double *middle)
{
	int axis = 0;
	double widest = -1;
	for (int c = 0; c < 3; c++) {
		double least = INFINITY, most = -INFINITY;
		for (int32_t i = at->first; i < at->first + at->count; i++) {
			double x = of->middle[3 * (size_t)of->order[i] + (size_t)c];
			least = fmin(least, x);
			most = fmax(most, x);
		}
		if (most - least > widest) {
			widest = most - least;
			axis = c;
			*middle = (least + most) / 2;
		}
	}
	return axis;
}

// Puts the triangles below the middle first and returns their number. If one side would have almost
// no triangles, each side gets half of them, so that the depth of the tree is bounded.
static int32_t divide(tree *of, const node *at)
{
	double middle = 0;
	size_t axis = (size_t)widest_axis(of, at, &middle);
	int32_t low = at->first;
	for (int32_t i = at->first; i < at->first + at->count; i++)
		if (of->middle[3 * (size_t)of->order[i] + axis] < middle) {
			int32_t own = of->order[i];
			of->order[i] = of->order[low];
			of->order[low++] = own;
		}
	int32_t below = low - at->first;
	bool even = below > at->count / UNEVEN && below < at->count - at->count / UNEVEN;
	return even ? below : at->count / 2;
}

static void build(tree *of)
{
	of->node[0] = (node){.count = of->surface->triangle_count};
	of->node_count = 1;
	for (int32_t n = 0; n < of->node_count; n++) {
		node *at = &of->node[n];
		fill_node(of, at);
		if (at->count <= LEAF)
			continue;
		int32_t below = divide(of, at), child = of->node_count;
		CAU_ASSERT(below > 0 && below < at->count, "%d of %d triangles below", below, at->count);
		of->node[child] = (node){.first = at->first, .count = below};
		of->node[child + 1] = (node){.first = at->first + below, .count = at->count - below};
		at->first = child;
		at->count = 0;
		of->node_count += 2;
	}
}

// ---- winding number of a point
// Returns the solid angle of a triangle over 4 pi [van Oosterom and Strackee 1983].
static double wind(const tree *of, int32_t triangle, const double x[3])
{
	double r[3][3], length[3], normal[3];
	for (int k = 0; k < 3; k++) {
		int32_t corner = of->surface->triangle[3 * (size_t)triangle + (size_t)k];
		cau_subtract3(of->surface->position + 3 * (size_t)corner, x, r[k]);
		length[k] = sqrt(cau_dot3(r[k], r[k]));
	}
	cau_cross3(r[1], r[2], normal);
	double above = cau_dot3(r[0], normal);
	double below = length[0] * length[1] * length[2] + cau_dot3(r[0], r[1]) * length[2] +
	               cau_dot3(r[1], r[2]) * length[0] + cau_dot3(r[2], r[0]) * length[1];
	return atan2(above, below) / (2 * M_PI);
}

static double winding_number(const tree *of, const double x[3])
{
	int32_t stack[STACK], depth = 0;
	double sum = 0;
	stack[depth++] = 0;
	while (depth) {
		const node *at = &of->node[stack[--depth]];
		double away[3];
		cau_subtract3(at->centre, x, away);
		double distance2 = cau_dot3(away, away), reach = far_radii * at->radius;
		if (distance2 > reach * reach && distance2 > 0) {
			sum += cau_dot3(at->dipole, away) / (4 * M_PI * distance2 * sqrt(distance2));
		} else if (at->count) {
			for (int32_t i = at->first; i < at->first + at->count; i++)
				sum += wind(of, of->order[i], x);
		} else {
			CAU_ASSERT(depth + 2 <= STACK, "a tree deeper than %d", depth);
			stack[depth++] = at->first;
			stack[depth++] = at->first + 1;
		}
	}
	return sum;
}

static int32_t label_at(const cau_domain *domain, const double x[3], const bool *passed)
{
	(void)passed; // there is only one label, and it is never passed
	for (int c = 0; c < 3; c++)
		if (x[c] < domain->least[c] || x[c] > domain->most[c])
			return 0;
	return winding_number(domain->own, x) > 0.5;
}

// ---- winding numbers in a box
// An interval that contains every result of winding_number() in a box. If winding_number() uses
// dipoles, the interval bounds the dipoles. So no bound is needed for the difference between
// dipoles and the exact winding number.
typedef struct interval {
	double low, high;
} interval;

typedef struct box {
	double least[3], most[3], middle[3];
	double half;  // half of the diagonal: no point of the box is farther from the middle
	double doubt; // sum of the half widths of all intervals so far
} box;

static interval around(box *in, double value, double change)
{
	in->doubt += change;
	return (interval){value - change, value + change};
}

// Returns the least distance between the origin and the edge a b.
static double edge_distance(const double a[3], const double b[3])
{
	double along[3], nearest[3];
	cau_subtract3(b, a, along);
	double length2 = cau_dot3(along, along);
	double share = length2 > 0 ? fmin(fmax(-cau_dot3(a, along) / length2, 0), 1) : 0;
	for (int c = 0; c < 3; c++)
		nearest[c] = a[c] + share * along[c];
	return sqrt(cau_dot3(nearest, nearest));
}

// Whether the point of the triangle's plane that is nearest to the origin is in the triangle.
static bool is_over(double corner[3][3], const double normal[3])
{
	for (int k = 0; k < 3; k++) {
		double along[3], across[3];
		cau_subtract3(corner[(k + 1) % 3], corner[k], along);
		cau_cross3(normal, along, across);
		if (cau_dot3(across, corner[k]) > 0)
			return false;
	}
	return true;
}

// Bounds the share of a triangle in the winding number. Let r be the least distance to the box. The
// share is at most area / 4 pi r^2. Its gradient has two bounds. One is 2 area / 4 pi r^3, as for a
// layer of dipoles. The other is the sum of 2 / 4 pi r over the edges, each with its own r, as for
// a current along the edges (law of Biot and Savart). The second bound is for large triangles.
static interval triangle_in(box *in, const tree *of, int32_t triangle)
{
	double corner[3][3], side[2][3], normal[3], r = INFINITY, per_length = 0;
	for (int k = 0; k < 3; k++) {
		int32_t vertex = of->surface->triangle[3 * (size_t)triangle + (size_t)k];
		cau_subtract3(of->surface->position + 3 * (size_t)vertex, in->middle, corner[k]);
	}
	for (int k = 0; k < 3; k++) {
		double own = edge_distance(corner[k], corner[(k + 1) % 3]);
		per_length += 1 / (2 * M_PI * (own - in->half));
		r = fmin(r, own);
	}
	cau_subtract3(corner[1], corner[0], side[0]);
	cau_subtract3(corner[2], corner[0], side[1]);
	cau_cross3(side[0], side[1], normal);
	double size = sqrt(cau_dot3(normal, normal));
	if (size > 0 && is_over(corner, normal))
		r = fabs(cau_dot3(corner[0], normal)) / size;
	r -= in->half;
	if (!(r > 0))
		return around(in, 0, 0.5); // the triangle meets the box
	double most = size / 2 / (4 * M_PI * r * r);
	double change = in->half * fmin(per_length, 2 * most / r);
	return most < change ? around(in, 0, most) : around(in, wind(of, triangle, in->middle), change);
}

// Bounds the share of a dipole p in the winding number. The share is at most p / 4 pi r^2, its
// gradient 2 p / 4 pi r^3. `r` is the least distance to the box. Points nearer than `reach` do not
// use the dipole.
static interval dipole_in(box *in, const node *at, double r, double reach)
{
	double away[3], size = sqrt(cau_dot3(at->dipole, at->dipole)) / (4 * M_PI);
	cau_subtract3(at->centre, in->middle, away);
	double distance2 = cau_dot3(away, away), apart = fmax(r, reach);
	double most = size / (apart * apart), change = 2 * in->half * size / (r * r * r);
	if (!(change < most))
		return around(in, 0, most);
	return around(in, cau_dot3(at->dipole, away) / (4 * M_PI * distance2 * sqrt(distance2)),
	              change);
}

// Computes the least and the largest distance of a point to the box.
static void distances(const box *to, const double x[3], double *least, double *most)
{
	double near2 = 0, far2 = 0;
	for (int c = 0; c < 3; c++) {
		double below = to->least[c] - x[c], above = x[c] - to->most[c];
		double near = fmax(fmax(below, above), 0);
		double far = fmax(fabs(to->most[c] - x[c]), fabs(to->least[c] - x[c]));
		near2 += near * near;
		far2 += far * far;
	}
	*least = sqrt(near2);
	*most = sqrt(far2);
}

// Bounds the share of a node in the winding number. For each point of the box, winding_number()
// uses the node's dipole or its parts. If both occur in the box, the interval contains both. Ends
// early if the doubt is too large for a result.
static interval node_in(box *in, const tree *of, int32_t number)
{
	const node *at = &of->node[number];
	double reach = far_radii * at->radius, least, most;
	distances(in, at->centre, &least, &most);
	if (least > reach * (1 + rounding))
		return dipole_in(in, at, least, reach);
	interval sum = {0, 0};
	for (int32_t i = at->first; i < at->first + at->count && in->doubt < 0.5; i++) {
		interval own = triangle_in(in, of, of->order[i]);
		sum = (interval){sum.low + own.low, sum.high + own.high};
	}
	if (!at->count) {
		double away[2][3];
		for (int k = 0; k < 2; k++)
			cau_subtract3(of->node[at->first + k].centre, in->middle, away[k]);
		int nearer = cau_dot3(away[1], away[1]) < cau_dot3(away[0], away[0]);
		for (int k = 0; k < 2 && in->doubt < 0.5; k++) {
			interval own = node_in(in, of, at->first + (k ? !nearer : nearer));
			sum = (interval){sum.low + own.low, sum.high + own.high};
		}
	}
	if (in->doubt >= 0.5 || most < reach * (1 - rounding))
		return sum;
	double doubt = in->doubt;
	interval dipole = dipole_in(in, at, least, reach);
	in->doubt = doubt; // a point uses the dipole or the parts, not both
	return (interval){fmin(sum.low, dipole.low), fmax(sum.high, dipole.high)};
}

static bool is_uniform(const cau_domain *domain, const double least[3], const double most[3],
                       int32_t *label)
{
	box in = {0};
	bool within = true;
	*label = 0;
	for (int c = 0; c < 3; c++) {
		if (most[c] < domain->least[c] || least[c] > domain->most[c])
			return true;
		within &= least[c] >= domain->least[c] && most[c] <= domain->most[c];
		in.least[c] = least[c];
		in.most[c] = most[c];
		in.middle[c] = (least[c] + most[c]) / 2;
		in.half += (most[c] - least[c]) * (most[c] - least[c]) / 4;
	}
	in.half = sqrt(in.half) * (1 + rounding);
	interval all = node_in(&in, domain->own, 0);
	if (in.doubt >= 0.5)
		return false;
	*label = all.low > 0.5 + rounding;
	return *label ? within : all.high < 0.5 - rounding;
}

static void finish(cau_domain *domain)
{
	tree *of = domain->own;
	if (of) {
		free(of->order);
		free(of->middle);
		free(of->node);
	}
	free(of);
	domain->own = NULL;
}

static void measure(const cau_mesh *surface, cau_domain *domain, double *middle)
{
	for (int c = 0; c < 3; c++) {
		domain->least[c] = INFINITY;
		domain->most[c] = -INFINITY;
	}
	for (size_t v = 0; v < 3 * (size_t)surface->vertex_count; v++) {
		domain->least[v % 3] = fmin(domain->least[v % 3], surface->position[v]);
		domain->most[v % 3] = fmax(domain->most[v % 3], surface->position[v]);
	}
	double six = 0; // six times the enclosed volume
	for (size_t t = 0; t < (size_t)surface->triangle_count; t++) {
		double normal[3], from[3];
		for (size_t c = 0; c < 3; c++)
			for (size_t k = 0; k < 3; k++)
				middle[3 * t + c] +=
					surface->position[3 * (size_t)surface->triangle[3 * t + k] + c] / 3;
		cau_triangle_normal(surface->position, surface->triangle + 3 * t, normal);
		cau_subtract3(middle + 3 * t, domain->least, from);
		six += cau_dot3(from, normal);
	}
	domain->volume = fabs(six) / 6;
}

cau_status cau_domain_of_surface(cau_mesh *surface, cau_domain *domain, int32_t *turned,
                                 cau_error *error)
{
	size_t count = (size_t)surface->triangle_count;
	CAU_ASSERT(count > 0, "a surface of %zu triangles", count);
	*domain = (cau_domain){
		.label_count = 1, .label_at = label_at, .is_uniform = is_uniform, .finish = finish};
	cau_status status = cau_orient(surface, turned, error);
	if (status)
		return status;
	tree *of = domain->own = calloc(1, sizeof *of);
	if (of) {
		of->surface = surface;
		of->order = malloc(count * sizeof *of->order);
		of->middle = calloc(3 * count, sizeof *of->middle);
		of->node = malloc(2 * count * sizeof *of->node);
	}
	if (!of || !of->order || !of->middle || !of->node) {
		cau_domain_finish(domain);
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a tree of %zu triangles", count);
	}
	for (size_t t = 0; t < count; t++)
		of->order[t] = (int32_t)t;
	measure(surface, domain, of->middle);
	build(of);
	return CAU_OK;
}
