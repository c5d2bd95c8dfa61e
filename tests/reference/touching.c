// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/touching.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Largest distance from the ball at which a point may come to push, as a share of the ball's
// radius.
static const double near = 0.01;

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void minus(const double a[3], const double b[3], double out[3])
{
	for (int c = 0; c < 3; c++)
		out[c] = a[c] - b[c];
}

static void cross(const double a[3], const double b[3], double out[3])
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

static const double *corner(const double *position, const cau_touching_point *p, int k)
{
	return position + 3 * (size_t)p->vertex[k];
}

// ---- nearest points

// Finds the nearest point on the line of two corners. Returns false if it is at or beyond a corner.
static bool find_on_edge(const double *position, const double middle[3], cau_touching_point *p)
{
	double edge[3], to[3];
	minus(corner(position, p, 1), corner(position, p, 0), edge);
	minus(middle, corner(position, p, 0), to);
	double square = dot(edge, edge), share = dot(to, edge) / square;
	p->weight[0] = 1 - share;
	p->weight[1] = share;
	for (int c = 0; c < 3; c++) {
		p->slope[1][c] = edge[c] / square;
		p->slope[0][c] = -p->slope[1][c];
	}
	return share > 0 && share < 1;
}

// Finds the nearest point on the plane of three corners. Returns false if it is on or beyond a
// side.
static bool find_on_face(const double *position, const double middle[3], cau_touching_point *p)
{
	double side[3][3], across[3], to[3];
	for (int k = 0; k < 3; k++)
		minus(corner(position, p, (k + 2) % 3), corner(position, p, (k + 1) % 3), side[k]);
	cross(side[1], side[2], across);
	double square = dot(across, across); // square of twice the area
	bool inside = true;
	for (int k = 0; k < 3; k++) {
		cross(across, side[k], p->slope[k]);
		for (int c = 0; c < 3; c++)
			p->slope[k][c] /= square;
		minus(middle, corner(position, p, (k + 1) % 3), to);
		p->weight[k] = dot(to, p->slope[k]);
		inside = inside && p->weight[k] > 0;
	}
	return inside;
}

static void measure(const cau_indenting_ball *ball, const double *position, cau_touching_point *p)
{
	double x[3] = {0, 0, 0};
	for (int k = 0; k < p->corners; k++)
		for (int c = 0; c < 3; c++)
			x[c] += p->weight[k] * corner(position, p, k)[c];
	minus(x, ball->centre_m, p->normal);
	p->distance_m = sqrt(dot(p->normal, p->normal));
	for (int c = 0; c < 3; c++)
		p->normal[c] /= p->distance_m;
	p->gap_m = p->distance_m - ball->radius_m + (p->corners > 1 ? ball->dip_m : 0);
}

static void order(cau_touching_point *p)
{
	for (int a = 0; a < p->corners; a++)
		for (int b = 0; b + 1 < p->corners - a; b++)
			if (p->vertex[b] > p->vertex[b + 1]) {
				int32_t v = p->vertex[b];
				p->vertex[b] = p->vertex[b + 1];
				p->vertex[b + 1] = v;
			}
}

// Finds the nearest point of a face: inside the face, or else on its nearest edge. Returns false if
// a vertex is nearest.
static bool find_nearest(const cau_indenting_ball *ball, const double *position,
                         const int32_t face[3], cau_touching_point *out)
{
	cau_touching_point p = {.corners = 3, .vertex = {face[0], face[1], face[2]}};
	order(&p);
	if (find_on_face(position, ball->centre_m, &p)) {
		measure(ball, position, &p);
		*out = p;
		return true;
	}
	bool found = false;
	for (int k = 0; k < 3; k++) {
		cau_touching_point edge = {.corners = 2, .vertex = {face[k], face[(k + 1) % 3]}};
		order(&edge);
		if (!find_on_edge(position, ball->centre_m, &edge))
			continue;
		measure(ball, position, &edge);
		if (!found || edge.distance_m < out->distance_m)
			*out = edge;
		found = true;
	}
	return found;
}

// ---- the list

static int place_of(const cau_touching_point *list, int count, const cau_touching_point *p)
{
	int k = 0;
	while (k < count && (list[k].corners != p->corners ||
	                     memcmp(list[k].vertex, p->vertex, sizeof p->vertex) != 0))
		k++;
	return k;
}

typedef struct lists {
	const cau_indenting_ball *ball;
	const cau_touching_point *before;
	int before_count;
	cau_touching_point *now;
	int count, most;
} lists;

static void add(lists *l, cau_touching_point p)
{
	if (p.gap_m > near * l->ball->radius_m || l->count == l->most ||
	    place_of(l->now, l->count, &p) < l->count)
		return;
	int k = place_of(l->before, l->before_count, &p);
	p.reaction_n = k < l->before_count ? l->before[k].reaction_n : 0;
	l->now[l->count++] = p;
}

int cau_touching_find(const cau_indented_body *body, const cau_indenting_ball *ball,
                      const double *position, cau_touching_point *list, int count, int most)
{
	cau_touching_point *before = malloc((size_t)count * sizeof *before + 1);
	memcpy(before, list, (size_t)count * sizeof *before);
	lists l = {.ball = ball, .before = before, .before_count = count, .now = list, .most = most};
	for (int32_t k = 0; k < body->surface_count; k++) {
		cau_touching_point p = {.corners = 1, .vertex = {body->surface[k]}, .weight = {1}};
		if (body->fixed[body->surface[k]])
			continue;
		measure(ball, position, &p);
		add(&l, p);
	}
	for (int32_t k = 0; k < body->face_count; k++) {
		cau_touching_point p;
		if (find_nearest(ball, position, body->face + 3 * (size_t)k, &p))
			add(&l, p);
	}
	free(before);
	return l.count;
}

// ---- curvature of the distance

// Computes the second derivative of the distance. Where the point can slide, its distance is that
// to a line or a plane. The line or plane turns when a corner moves along the normal, and the point
// slides in proportion to the distance. In all other directions the point moves along with the
// corner, and the direction from the middle to the point turns.
void cau_touching_bend(const cau_touching_point *p, int a, int b, double bend[3][3])
{
	const double *n = p->normal, *ga = p->slope[a], *gb = p->slope[b];
	double along[3] = {0, 0, 0}; // direction of the edge
	if (p->corners == 2) {
		double length = sqrt(dot(p->slope[0], p->slope[0]));
		for (int c = 0; c < 3; c++)
			along[c] = p->slope[0][c] / length;
	}
	double carried = p->corners < 3 ? p->weight[a] * p->weight[b] / p->distance_m : 0;
	double turned = -p->distance_m * dot(ga, gb);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			bend[i][j] = carried * ((i == j) - n[i] * n[j] - along[i] * along[j]) +
			             turned * n[i] * n[j] - p->weight[b] * n[i] * ga[j] -
			             p->weight[a] * gb[i] * n[j];
}
