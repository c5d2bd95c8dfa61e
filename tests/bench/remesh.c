// SPDX-License-Identifier: GPL-3.0-or-later
// Measures a cut by a method that changes the topology, and the same cut by Cautery's method
// (section 7.1).
//
// The method that changes the topology follows the tip along the scene's line of cut, with the
// vertical plane through the line. Behind the tip it refines elements that the plane crosses. It
// bisects their crossed edges at the plane, in all elements around the edge, so that the mesh stays
// conforming. Vertices in the plane behind the tip are doubled, and the elements on one side take
// the double. After each change the method must assemble, order, analyse and factorise the system
// of the new size. It must also write vertex and index buffers of new sizes. The system has only
// elements of the cut layer, without pins and links, which favours this method.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/bench.h"
#include "session/session_internal.h"

enum { MOST_CORNERS = 4, VERTEX_BYTES = 12, INDEX_BYTES = 4, GROWTH = 4 };
// Largest distance from the plane at which a vertex is in the plane, as a share of the longest edge
// of its element.
static const double NEAR_PLANE = 0.05;
// Least area or volume of a well-shaped element, as a share of the area or volume of a regular
// element with the same longest edge.
static const double ILL_SHAPED = 0.05;

typedef struct remesh {
	int corners; // corners of an element: 3 or 4
	int32_t vertices, elements, most_vertices, most_elements;
	double *rest;      // m, (most_vertices x 3)
	double *off;       // distance in m from the plane, 0 in the plane, (most_vertices)
	double *along;     // position in m along the line of cut, (most_vertices)
	double *mass;      // kg, (most_vertices)
	int32_t *element;  // (most_elements x corners)
	double *stiffness; // stiffness in N m over m^dimension, (most_elements)
	int32_t *head;     // (most_vertices): first entry of each vertex's list
	// (most_elements x corners): next entry of the list; an entry is element x corners + corner
	int32_t *next;
	uint8_t *doubled; // (most_vertices)
	bench_remesh_result *result;
	double step_s;
} remesh;

// ---- the mesh
static void link_corner(remesh *r, int32_t entry)
{
	int32_t vertex = r->element[entry];
	r->next[entry] = r->head[vertex];
	r->head[vertex] = entry;
	r->result->inserts++;
}

static void unlink_corner(remesh *r, int32_t entry)
{
	int32_t *at = &r->head[r->element[entry]];
	while (*at != entry)
		at = &r->next[*at];
	*at = r->next[entry];
	r->result->deletes++;
}

static void give_corner(remesh *r, int32_t entry, int32_t vertex)
{
	unlink_corner(r, entry);
	r->element[entry] = vertex;
	link_corner(r, entry);
}

static void difference(const remesh *r, int32_t a, int32_t b, double out[3])
{
	for (int c = 0; c < 3; c++)
		out[c] = r->rest[3 * (size_t)b + (size_t)c] - r->rest[3 * (size_t)a + (size_t)c];
}

static double distance(const remesh *r, int32_t a, int32_t b)
{
	double d[3];
	difference(r, a, b, d);
	return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

static double longest_edge(const remesh *r, const int32_t *v)
{
	double longest = 0;
	for (int i = 0; i < r->corners; i++)
		for (int j = 0; j < i; j++)
			longest = fmax(longest, distance(r, v[i], v[j]));
	return longest;
}

// Computes the gradients of the barycentric coordinates (1/m) by dimension and corner. Returns area
// or volume. A sheet lies in a plane z = const.
static double gradients(const remesh *r, const int32_t *v, double g[3][MOST_CORNERS])
{
	double e[3][3] = {{0}, {0}, {0, 0, 1}}, cross[3][3], determinant = 0;
	for (int i = 1; i < r->corners; i++)
		difference(r, v[0], v[i], e[i - 1]);
	for (int i = 0; i < 3; i++)
		for (int c = 0; c < 3; c++) {
			const double *a = e[(i + 1) % 3], *b = e[(i + 2) % 3];
			cross[i][c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
		}
	for (int c = 0; c < 3; c++)
		determinant += e[0][c] * cross[0][c];
	for (int c = 0; c < 3; c++) {
		g[c][0] = 0;
		for (int i = 1; i < r->corners; i++) {
			g[c][i] = cross[i - 1][c] / determinant;
			g[c][0] -= g[c][i];
		}
	}
	return fabs(determinant) / (r->corners == 4 ? 6 : 2);
}

static void test_shape(remesh *r, int32_t element)
{
	double g[3][MOST_CORNERS];
	const int32_t *v = r->element + (size_t)element * (size_t)r->corners;
	double longest = longest_edge(r, v);
	double regular =
		r->corners == 4 ? pow(longest, 3) / (6 * sqrt(2)) : sqrt(3) / 4 * pow(longest, 2);
	r->result->ill_shaped += gradients(r, v, g) < ILL_SHAPED * regular;
}

// ---- refinement
// Splits one element at `middle`, the vertex on its edge from corner `a` to corner `b`.
static void split_element(remesh *r, int32_t element, int a, int b, int32_t middle)
{
	int32_t first = element * r->corners, child = r->elements++, to = child * r->corners;
	CAU_ASSERT(r->elements <= r->most_elements, "%d elements", r->elements);
	for (int c = 0; c < r->corners; c++) {
		r->element[to + c] = c == a ? middle : r->element[first + c];
		link_corner(r, to + c);
	}
	r->stiffness[child] = r->stiffness[element];
	give_corner(r, first + b, middle);
	r->result->elements_added++;
	test_shape(r, element);
	test_shape(r, child);
}

static int32_t add_vertex(remesh *r)
{
	CAU_ASSERT(r->vertices < r->most_vertices, "%d vertices", r->vertices);
	r->head[r->vertices] = -1;
	r->doubled[r->vertices] = 0;
	r->result->vertices_added++;
	return r->vertices++;
}

static int corner_of(const remesh *r, int32_t element, int32_t vertex)
{
	for (int c = 0; c < r->corners; c++)
		if (r->element[element * r->corners + c] == vertex)
			return c;
	return -1;
}

// Bisects an edge at the plane, in all elements around the edge.
static void bisect(remesh *r, int32_t a, int32_t b)
{
	double share = r->off[a] / (r->off[a] - r->off[b]);
	int32_t middle = add_vertex(r), around[256], count = 0;
	for (size_t c = 0; c < 3; c++)
		r->rest[3 * (size_t)middle + c] =
			(1 - share) * r->rest[3 * (size_t)a + c] + share * r->rest[3 * (size_t)b + c];
	r->off[middle] = 0;
	r->along[middle] = (1 - share) * r->along[a] + share * r->along[b];
	r->mass[middle] = (r->mass[a] + r->mass[b]) / 2;
	for (int32_t entry = r->head[a]; entry >= 0 && count < 256; entry = r->next[entry])
		if (corner_of(r, entry / r->corners, b) >= 0)
			around[count++] = entry / r->corners;
	for (int32_t k = 0; k < count; k++)
		split_element(r, around[k], corner_of(r, around[k], a), corner_of(r, around[k], b), middle);
}

// Finds the first edge of an element that the plane crosses behind the tip. Returns false if there
// is none.
static bool crossed_edge(const remesh *r, int32_t element, double tip_m, int32_t edge[2])
{
	const int32_t *v = r->element + (size_t)element * (size_t)r->corners;
	for (int i = 0; i < r->corners; i++)
		for (int j = 0; j < i; j++) {
			double p = r->off[v[i]], q = r->off[v[j]];
			if (!((p > 0 && q < 0) || (p < 0 && q > 0)))
				continue;
			double at = r->along[v[i]] + p / (p - q) * (r->along[v[j]] - r->along[v[i]]);
			edge[0] = v[i];
			edge[1] = v[j];
			if (at >= 0 && at <= tip_m)
				return true;
		}
	return false;
}

static int side_of(const remesh *r, int32_t element)
{
	double sum = 0;
	for (int c = 0; c < r->corners; c++)
		sum += r->off[r->element[element * r->corners + c]];
	return sum > 0;
}

// True if the whole neighbourhood of the vertex is behind the tip and no element there crosses the
// plane.
static bool is_free(const remesh *r, int32_t vertex, double tip_m)
{
	int sides = 0;
	for (int32_t entry = r->head[vertex]; entry >= 0; entry = r->next[entry]) {
		int32_t element = entry / r->corners, edge[2];
		const int32_t *v = r->element + (size_t)element * (size_t)r->corners;
		sides |= 1 << side_of(r, element);
		for (int c = 0; c < r->corners; c++)
			if (r->off[v[c]] == 0 && (r->along[v[c]] < 0 || r->along[v[c]] > tip_m))
				return false;
		if (crossed_edge(r, element, INFINITY, edge))
			return false;
	}
	return sides == 3;
}

static void open_vertex(remesh *r, int32_t vertex)
{
	int32_t twin = add_vertex(r);
	memcpy(r->rest + 3 * (size_t)twin, r->rest + 3 * (size_t)vertex, 3 * sizeof *r->rest);
	r->off[twin] = 0;
	r->along[twin] = r->along[vertex];
	r->mass[twin] = r->mass[vertex] /= 2;
	r->doubled[twin] = r->doubled[vertex] = 1;
	for (int32_t entry = r->head[vertex], next; entry >= 0; entry = next) {
		next = r->next[entry];
		if (side_of(r, entry / r->corners))
			give_corner(r, entry, twin);
	}
}

// Follows the tip to `tip_m`. Returns true if the mesh has changed.
static bool follow(remesh *r, double tip_m)
{
	int32_t before = r->vertices, edge[2];
	for (int32_t e = 0; e < r->elements; e++)
		while (crossed_edge(r, e, tip_m, edge))
			bisect(r, edge[0], edge[1]);
	for (int32_t v = 0, last = r->vertices; v < last; v++)
		if (r->off[v] == 0 && !r->doubled[v] && r->along[v] >= 0 && r->along[v] <= tip_m &&
		    is_free(r, v, tip_m))
			open_vertex(r, v);
	return r->vertices > before;
}

// ---- the system of the present mesh: M/dt^2 + sum of w G^T G
static int by_number(const void *a, const void *b)
{
	int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
	return (x > y) - (x < y);
}

static void add_column(const remesh *r, int32_t v, cau_matrix *m, int32_t *place)
{
	int32_t first = m->first[v], count = first;
	m->row[count++] = v;
	place[v] = v;
	for (int32_t entry = r->head[v]; entry >= 0; entry = r->next[entry])
		for (int c = 0; c < r->corners; c++) {
			int32_t other = r->element[entry / r->corners * r->corners + c];
			if (other > v && place[other] != v) {
				place[other] = v;
				m->row[count++] = other;
			}
		}
	qsort(m->row + first, (size_t)(count - first), sizeof *m->row, by_number);
	m->first[v + 1] = count;
}

static void add_values(const remesh *r, int32_t v, cau_matrix *m, int32_t *place)
{
	double g[3][MOST_CORNERS];
	for (int32_t k = m->first[v]; k < m->first[v + 1]; k++) {
		place[m->row[k]] = k;
		m->value[k] = k == m->first[v] ? r->mass[v] / (r->step_s * r->step_s) : 0;
	}
	for (int32_t entry = r->head[v]; entry >= 0; entry = r->next[entry]) {
		int32_t element = entry / r->corners;
		const int32_t *corner = r->element + (size_t)element * (size_t)r->corners;
		double weight = r->stiffness[element] * gradients(r, corner, g);
		for (int c = 0; c < r->corners; c++)
			for (int d = 0; d < 3 && corner[c] >= v; d++)
				m->value[place[corner[c]]] += weight * g[d][entry % r->corners] * g[d][c];
	}
}

static int factor_anew(remesh *r)
{
	size_t n = (size_t)r->vertices, most = n + (size_t)r->elements * 6;
	cau_matrix m = {.n = r->vertices,
	                .first = calloc(n + 1, sizeof(int32_t)),
	                .row = malloc(most * sizeof(int32_t)),
	                .value = malloc(most * sizeof(double))};
	int32_t *place = malloc(n * sizeof *place);
	cau_factor *factor = NULL;
	int failed = !m.first || !m.row || !m.value || !place;
	double start = bench_now_s();
	for (int32_t v = 0; v < r->vertices && !failed; v++)
		place[v] = -1;
	for (int32_t v = 0; v < r->vertices && !failed; v++)
		add_column(r, v, &m, place);
	for (int32_t v = 0; v < r->vertices && !failed; v++)
		add_values(r, v, &m, place);
	double assembled = bench_now_s();
	failed = failed || cau_factor_create(&factor, &m, NULL, NULL) != CAU_OK;
	r->result->assemble_s += assembled - start;
	r->result->factor_s += bench_now_s() - assembled;
	if (!failed)
		r->result->system_bytes += 12.0 * m.first[m.n] + 12.0 * (double)cau_factor_entries(factor);
	cau_factor_destroy(factor);
	free(m.first);
	free(m.row);
	free(m.value);
	free(place);
	return failed;
}

// ---- a run
static void finish(remesh *r)
{
	free(r->rest);
	free(r->off);
	free(r->along);
	free(r->mass);
	free(r->element);
	free(r->stiffness);
	free(r->head);
	free(r->next);
	free(r->doubled);
}

static bool reserve(remesh *r)
{
	size_t n = (size_t)r->most_vertices, m = (size_t)r->most_elements;
	r->rest = malloc(3 * n * sizeof(double));
	r->off = malloc(n * sizeof(double));
	r->along = malloc(n * sizeof(double));
	r->mass = malloc(n * sizeof(double));
	r->element = malloc(m * MOST_CORNERS * sizeof(int32_t));
	r->stiffness = malloc(m * sizeof(double));
	r->head = malloc(n * sizeof(int32_t));
	r->next = malloc(m * MOST_CORNERS * sizeof(int32_t));
	r->doubled = calloc(n, 1);
	return r->rest && r->off && r->along && r->mass && r->element && r->stiffness && r->head &&
	       r->next && r->doubled;
}

static void place_vertices(remesh *r, const cau_tissue *tissue, const cau_cut_def *cut)
{
	double x = cut->to_m[0] - cut->from_m[0], y = cut->to_m[1] - cut->from_m[1];
	double length = hypot(x, y);
	for (int32_t v = 0; v < r->vertices; v++) {
		const double *at = tissue->rest + 3 * (size_t)v;
		double dx = at[0] - cut->from_m[0], dy = at[1] - cut->from_m[1];
		memcpy(r->rest + 3 * (size_t)v, at, 3 * sizeof *at);
		r->off[v] = (x * dy - y * dx) / length;
		r->along[v] = (x * dx + y * dy) / length;
		r->mass[v] = tissue->mass[v];
		r->head[v] = -1;
	}
}

static void place_elements(remesh *r, const cau_tissue *tissue, int kind)
{
	double g[3][MOST_CORNERS];
	for (int32_t e = 0; e < r->elements; e++) {
		cau_element_map map;
		int32_t *corner = r->element + (size_t)e * (size_t)r->corners;
		cau_tissue_element_map(tissue, kind, e, &map);
		memcpy(corner, map.vertex, (size_t)r->corners * sizeof *corner);
		r->stiffness[e] = map.weight / gradients(r, corner, g);
		for (int c = 0; c < r->corners; c++) {
			link_corner(r, e * r->corners + c);
			if (fabs(r->off[corner[c]]) < NEAR_PLANE * longest_edge(r, corner))
				r->off[corner[c]] = 0;
		}
	}
}

static int begin(remesh *r, const cau_session *session, const cau_scene_def *scene)
{
	const cau_tissue *tissue = &session->tissue;
	bool solid = tissue->tetrahedron_count > 0;
	r->corners = solid ? 4 : 3;
	r->vertices = tissue->vertex_count;
	r->elements = solid ? tissue->tetrahedron_count : tissue->triangle_count;
	r->most_vertices = GROWTH * r->vertices;
	r->most_elements = GROWTH * r->elements;
	r->step_s = scene->step_s;
	if (!reserve(r))
		return 1;
	place_vertices(r, tissue, &scene->cut);
	place_elements(r, tissue, solid ? CAU_ELEMENT_TETRAHEDRON : CAU_ELEMENT_TRIANGLE);
	bench_remesh_result *result = r->result;
	result->vertices = r->vertices;
	result->elements = r->elements;
	result->inserts = 0;
	return 0;
}

static int change(remesh *r, double tip_m)
{
	double start = bench_now_s();
	bool changed = follow(r, tip_m);
	double took = bench_now_s() - start;
	if (!changed)
		return 0; // a search without a change is not counted
	r->result->remesh_s += took;
	r->result->changes++;
	r->result->buffer_bytes +=
		(double)VERTEX_BYTES * r->vertices + (double)INDEX_BYTES * r->corners * r->elements;
	return factor_anew(r);
}

static int follow_cut(remesh *r, const cau_scene_def *scene)
{
	double length =
		hypot(scene->cut.to_m[0] - scene->cut.from_m[0], scene->cut.to_m[1] - scene->cut.from_m[1]);
	double step = scene->cut.speed_m_s * scene->step_s;
	int32_t ticks = (int32_t)ceil(length / step), failed = 0;
	for (int32_t tick = 1; tick <= ticks && !failed; tick++)
		failed = change(r, fmin(length, tick * step));
	return failed;
}

// Returns the area or volume of all elements, which refinement must not change.
static double whole_measure(const remesh *r)
{
	double g[3][MOST_CORNERS], sum = 0;
	for (int32_t e = 0; e < r->elements; e++)
		sum += gradients(r, r->element + (size_t)e * (size_t)r->corners, g);
	return sum;
}

static int cut_whole(remesh *r, const cau_session *session, const cau_scene_def *scene)
{
	if (begin(r, session, scene))
		return 1;
	double before = whole_measure(r);
	if (follow_cut(r, scene))
		return 1;
	return fabs(whole_measure(r) - before) > 1e-9 * before;
}

int bench_remesh(const bench_options *options, bench_remesh_result *result)
{
	memset(result, 0, sizeof *result);
	cau_scene_def *scene = bench_scene(options);
	cau_session *session = scene && scene->cut.present ? bench_session(scene, options, 1) : NULL;
	remesh r = {.result = result};
	int failed =
		!session || cut_whole(&r, session, scene) || bench_cut_ours(session, scene, result);
	if (failed)
		fprintf(stderr, "cautery-bench: the cut of %s could not be re-meshed\n", options->scene);
	finish(&r);
	cau_session_destroy(session);
	free(scene);
	return failed;
}
