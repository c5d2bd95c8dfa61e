// SPDX-License-Identifier: GPL-3.0-or-later
#include "dissect/shrink.h"

#include <string.h>

#include "base/vector.h"
#include "cautery/assert.h"

static const double ramp_s = 0.2;
// least coagulated share of an element that shrinks as denatured
static const double denatured_share = 0.5;

// Returns the capacity: an eighth of all elements, but at least the smaller of CAU_SHRINKING_LEAST
// and all elements.
static int32_t most_active(const cau_tissue *tissue)
{
	int32_t all = tissue->triangle_count + tissue->tetrahedron_count;
	int32_t share = all / CAU_SHRINKING_SHARE;
	if (share < CAU_SHRINKING_LEAST)
		return all < CAU_SHRINKING_LEAST ? all : CAU_SHRINKING_LEAST;
	return share;
}

cau_status cau_shrink_create(cau_shrink *shrink, const cau_tissue *tissue, cau_arena *arena,
                             cau_error *error)
{
	size_t triangles = (size_t)tissue->triangle_count, fat = (size_t)tissue->tetrahedron_count;
	shrink->shrunk[0] = cau_arena_array(arena, triangles, 1);
	shrink->shrunk[1] = cau_arena_array(arena, fat, 1);
	shrink->active_capacity = most_active(tissue);
	shrink->active =
		cau_arena_array(arena, (size_t)shrink->active_capacity, sizeof *shrink->active);
	shrink->active_count = 0;
	if (!shrink->shrunk[0] || !shrink->shrunk[1] || !shrink->active)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for shrinkage");
	return CAU_OK;
}

static cau_vec3 at(const double *position, int32_t vertex)
{
	return cau_vec3_of(position + 3 * (size_t)vertex);
}

// The gradient N_c of the tool's distance at the element's contact point. `away` is the direction
// from the contact point to the centroid, used where N_c is perpendicular to the sheet.
typedef struct contact_frame {
	cau_vec3 normal, away;
} contact_frame;

static contact_frame contact_of(cau_vec3 centroid, const cau_tool_def *tool, const cau_pose *pose,
                                double jaw)
{
	contact_frame frame;
	cau_vec3 gradient;
	double distance = cau_tool_distance_at(tool, pose, jaw, CAU_PART_HOT, centroid, &gradient);
	cau_vec3 contact = cau_add_scaled(centroid, -distance, gradient);
	cau_tool_distance_at(tool, pose, jaw, CAU_PART_HOT, contact, &frame.normal);
	frame.away = cau_unit_or(cau_sub(centroid, contact), frame.normal);
	return frame;
}

// ---- triangles

// Computes the columns f_1, f_2 of F.
static void triangle_gradient(const cau_tissue *tissue, const double *position, int32_t triangle,
                              cau_vec3 f[2])
{
	const int32_t *v = tissue->triangle + 3 * (size_t)triangle;
	const double *m = tissue->triangle_dm_inverse + 4 * (size_t)triangle;
	cau_vec3 d1 = cau_sub(at(position, v[1]), at(position, v[0]));
	cau_vec3 d2 = cau_sub(at(position, v[2]), at(position, v[0]));
	f[0] = cau_add_scaled(cau_scale(m[0], d1), m[2], d2);
	f[1] = cau_add_scaled(cau_scale(m[1], d1), m[3], d2);
}

// Computes root A root for 2x2 matrices, where A is diag(S) in the axes (c, s), (-s, c).
static void sandwich2(const double root[3], double c, double s, const double shrink[2],
                      double out[3])
{
	CAU_ASSERT(fabs(c * c + s * s - 1) < 1e-9, "axes (%g, %g) are not of unit length", c, s);
	double a = c * c * shrink[0] + s * s * shrink[1], b = s * s * shrink[0] + c * c * shrink[1];
	double d = c * s * (shrink[0] - shrink[1]);
	double p00 = root[0] * a + root[2] * d, p01 = root[0] * d + root[2] * b;
	double p10 = root[2] * a + root[1] * d, p11 = root[2] * d + root[1] * b;
	out[0] = p00 * root[0] + p01 * root[2];
	out[1] = p10 * root[2] + p11 * root[1];
	out[2] = p00 * root[2] + p01 * root[1];
}

// Returns F^T N_c of a triangle. If N_c is perpendicular to the sheet, uses the direction away from
// the contact point instead.
static cau_vec3 triangle_axis(const cau_tissue *tissue, const double *position, int32_t triangle,
                              const cau_tool_def *tool, const cau_pose *pose, double jaw)
{
	const int32_t *v = tissue->triangle + 3 * (size_t)triangle;
	cau_vec3 f[2],
		sum = cau_add(cau_add(at(position, v[0]), at(position, v[1])), at(position, v[2]));
	contact_frame frame = contact_of(cau_scale(1.0 / 3.0, sum), tool, pose, jaw);
	triangle_gradient(tissue, position, triangle, f);
	double x = cau_dot(f[0], frame.normal), y = cau_dot(f[1], frame.normal);
	double scale = cau_length(f[0]) + cau_length(f[1]);
	if (!(hypot(x, y) > 1e-3 * scale)) { // N_c is perpendicular to the sheet
		x = cau_dot(f[0], frame.away);
		y = cau_dot(f[1], frame.away);
	}
	return (cau_vec3){x, y, 0};
}

static void triangle_target(const cau_tissue *tissue, int32_t triangle, cau_vec3 axis,
                            const double from[6], double to[6])
{
	double length = hypot(axis.x, axis.y), target[3];
	if (!(length > 0))
		axis.x = length = 1, axis.y = 0;
	sandwich2(from, axis.x / length, axis.y / length,
	          cau_triangle_material(tissue, triangle)->shrink, target);
	cau_symmetric_power2(target, 0.5, 1e-6, to);
	CAU_ASSERT(to[0] > 0 && to[1] > 0, "triangle %d shrinks to %g, %g", triangle, to[0], to[1]);
}

// ---- tetrahedra
static cau_vec3 tetrahedron_transpose_times(const cau_tissue *tissue, const double *position,
                                            int32_t tetrahedron, cau_vec3 n)
{
	const int32_t *v = tissue->tetrahedron + 4 * (size_t)tetrahedron;
	const double *m = tissue->tetrahedron_dm_inverse + 9 * (size_t)tetrahedron;
	double out[3] = {0, 0, 0};
	for (int i = 0; i < 3; i++) {
		double along = cau_dot(cau_sub(at(position, v[i + 1]), at(position, v[0])), n);
		for (int c = 0; c < 3; c++)
			out[c] += m[3 * i + c] * along;
	}
	return cau_vec3_of(out);
}

// Computes root A root for symmetric 3x3 matrices as six numbers.
static void sandwich3(const double root[6], const double a[6], double out[6])
{
	static const int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
	static const int place[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
	for (int k = 0; k < 6; k++) {
		out[k] = 0;
		for (int i = 0; i < 3; i++)
			for (int j = 0; j < 3; j++)
				out[k] += root[place[row[k]][i]] * a[place[i][j]] * root[place[j][column[k]]];
	}
}

// Returns F^T N_c and F^T N_a of a tetrahedron, with N_a = N_f x N_c.
static void tetrahedron_axes(const cau_tissue *tissue, const double *position, int32_t tetrahedron,
                             cau_vec3 face_normal, const cau_tool_def *tool, const cau_pose *pose,
                             double jaw, cau_vec3 axis[2])
{
	const int32_t *v = tissue->tetrahedron + 4 * (size_t)tetrahedron;
	cau_vec3 sum = cau_add(cau_add(at(position, v[0]), at(position, v[1])),
	                       cau_add(at(position, v[2]), at(position, v[3])));
	contact_frame frame = contact_of(cau_scale(0.25, sum), tool, pose, jaw);
	axis[0] = tetrahedron_transpose_times(tissue, position, tetrahedron, frame.normal);
	if (!(cau_length(axis[0]) > 1e-6))
		axis[0] = tetrahedron_transpose_times(tissue, position, tetrahedron, frame.away);
	axis[1] = tetrahedron_transpose_times(tissue, position, tetrahedron,
	                                      cau_cross(face_normal, frame.normal));
}

// Computes the target of a tetrahedron. First makes the two axes orthogonal.
static void tetrahedron_target(const cau_tissue *tissue, int32_t tetrahedron,
                               const cau_vec3 axis[2], const double from[6], double to[6])
{
	static const int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
	const double *s = cau_tetrahedron_material(tissue, tetrahedron)->shrink;
	cau_vec3 a = cau_unit_or(axis[0], (cau_vec3){1, 0, 0});
	cau_vec3 b = cau_add_scaled(axis[1], -cau_dot(a, axis[1]), a);
	if (!(cau_length(b) > 1e-6))
		b = cau_cross(fabs(a.x) < 0.9 ? (cau_vec3){1, 0, 0} : (cau_vec3){0, 1, 0}, a);
	b = cau_unit_or(b, (cau_vec3){0, 1, 0});
	cau_vec3 c = cau_cross(a, b);
	const double axes[3][3] = {{a.x, a.y, a.z}, {b.x, b.y, b.z}, {c.x, c.y, c.z}};
	double turned[6], target[6];
	for (int k = 0; k < 6; k++) {
		turned[k] = 0;
		for (int i = 0; i < 3; i++)
			turned[k] += axes[i][row[k]] * s[i] * axes[i][column[k]];
	}
	sandwich3(from, turned, target);
	cau_symmetric_power3(target, 0.5, 1e-6, to);
	CAU_ASSERT(to[0] > 0 && to[1] > 0 && to[2] > 0, "tetrahedron %d shrinks to %g, %g, %g",
	           tetrahedron, to[0], to[1], to[2]);
}

// ---- one element
static bool may_shrink(const cau_shrink *shrink, const cau_dissection *dissection, int kind,
                       int32_t element)
{
	CAU_ASSERT(kind == CAU_ELEMENT_TRIANGLE || kind == CAU_ELEMENT_TETRAHEDRON,
	           "element %d of kind %d shrinks", element, kind);
	if (!dissection->alive.element[kind][element] || shrink->shrunk[kind][element])
		return false;
	const cau_tissue *tissue = dissection->tissue;
	if (kind == CAU_ELEMENT_TRIANGLE) {
		const double *s = cau_triangle_material(tissue, element)->shrink;
		return s[0] != 1 || s[1] != 1;
	}
	const double *s = cau_tetrahedron_material(tissue, element)->shrink;
	return s[0] != 1 || s[1] != 1 || s[2] != 1;
}

// Starts to shrink an element. `axis` has the axes of S in the element at rest; for a triangle only
// the first axis is used.
static void start_shrinking(cau_shrink *shrink, const cau_tissue *tissue, int kind, int32_t element,
                            const cau_vec3 axis[2], cau_elements *elements,
                            const cau_element_slots *slots)
{
	cau_shrinking shrinking = {.kind = kind, .element = element};
	cau_elements_target(elements, slots, kind, element, shrinking.from);
	if (!(shrinking.from[0] > 0)) { // the element had no target: T = I
		shrinking.from[0] = shrinking.from[1] = 1;
		shrinking.from[2] = kind == CAU_ELEMENT_TETRAHEDRON;
	}
	if (kind == CAU_ELEMENT_TRIANGLE)
		triangle_target(tissue, element, axis[0], shrinking.from, shrinking.to);
	else
		tetrahedron_target(tissue, element, axis, shrinking.from, shrinking.to);
	shrink->shrunk[kind][element] = 1;
	if (shrink->active_count < shrink->active_capacity)
		shrink->active[shrink->active_count++] = shrinking;
	else
		cau_elements_set_target(elements, slots, tissue, kind, element, shrinking.to);
}

// ---- denatured tissue

// Returns the gradient, in the element at rest, of a field with these values at its corners.
static cau_vec3 gradient(const cau_tissue *tissue, int kind, int32_t element, const double value[4])
{
	if (kind == CAU_ELEMENT_TRIANGLE) {
		const double *m = tissue->triangle_dm_inverse + 4 * (size_t)element;
		double along[2] = {value[1] - value[0], value[2] - value[0]};
		return (cau_vec3){m[0] * along[0] + m[2] * along[1], m[1] * along[0] + m[3] * along[1], 0};
	}
	const double *m = tissue->tetrahedron_dm_inverse + 9 * (size_t)element;
	double out[3] = {0, 0, 0};
	for (int i = 0; i < 3; i++)
		for (int c = 0; c < 3; c++)
			out[c] += m[3 * i + c] * (value[i + 1] - value[0]);
	return cau_vec3_of(out);
}

void cau_shrink_denatured(cau_shrink *shrink, const cau_dissection *dissection, int kind,
                          int32_t element, const double temperature[4], cau_elements *elements,
                          const cau_element_slots *slots)
{
	if (!may_shrink(shrink, dissection, kind, element) ||
	    cau_dissection_coagulated(dissection, kind, element) < denatured_share)
		return;
	const cau_vec3 axis[2] = {gradient(dissection->tissue, kind, element, temperature)};
	start_shrinking(shrink, dissection->tissue, kind, element, axis, elements, slots);
}

// ---- exposed elements
typedef struct expose {
	cau_shrink *shrink;
	const cau_dissection *dissection;
	const double *position;
	const cau_tool_def *tool;
	const cau_pose *pose;
	double jaw;
	cau_elements *elements;
	const cau_element_slots *slots;
} expose;

static void expose_element(const expose *work, int kind, int32_t element, cau_vec3 face_normal)
{
	const cau_tissue *tissue = work->dissection->tissue;
	cau_vec3 axis[2] = {{0, 0, 0}};
	if (!may_shrink(work->shrink, work->dissection, kind, element))
		return;
	if (kind == CAU_ELEMENT_TRIANGLE)
		axis[0] = triangle_axis(tissue, work->position, element, work->tool, work->pose, work->jaw);
	else
		tetrahedron_axes(tissue, work->position, element, face_normal, work->tool, work->pose,
		                 work->jaw, axis);
	start_shrinking(work->shrink, tissue, kind, element, axis, work->elements, work->slots);
}

static void expose_triangle(const expose *work, int32_t triangle)
{
	CAU_ASSERT_INDEX(triangle, work->dissection->tissue->triangle_count);
	const cau_tissue *tissue = work->dissection->tissue;
	const cau_edge_table *edges = &tissue->edges;
	const int32_t *first = edges->first[CAU_PRIMITIVE_TRIANGLE];
	for (int i = 0; i < 3; i++) {
		int32_t e = edges->triangle_edge[3 * (size_t)triangle + (size_t)i];
		for (int32_t k = first[e]; k < first[e + 1]; k++) {
			int32_t other = edges->sharer[CAU_PRIMITIVE_TRIANGLE][k];
			if (tissue->triangle_layer[other] == tissue->triangle_layer[triangle])
				expose_element(work, CAU_ELEMENT_TRIANGLE, other, (cau_vec3){0, 0, 0});
		}
	}
}

static void expose_tetrahedron(const expose *work, int32_t tetrahedron)
{
	CAU_ASSERT_INDEX(tetrahedron, work->dissection->tissue->tetrahedron_count);
	const cau_face_table *faces = &work->dissection->tissue->faces;
	for (int i = 0; i < 4; i++) {
		int32_t face = faces->tetrahedron_face[4 * (size_t)tetrahedron + (size_t)i];
		const int32_t *v = faces->vertex + 3 * (size_t)face;
		cau_vec3 j = cau_sub(at(work->position, v[1]), at(work->position, v[0]));
		cau_vec3 k = cau_sub(at(work->position, v[2]), at(work->position, v[0]));
		cau_vec3 normal = cau_unit_or(cau_cross(j, k), (cau_vec3){0, 0, 1});
		for (int o = 0; o < 2; o++) {
			int32_t other = faces->owner[2 * (size_t)face + (size_t)o];
			if (other >= 0 && other != tetrahedron)
				expose_element(work, CAU_ELEMENT_TETRAHEDRON, other, normal);
		}
	}
}

void cau_shrink_expose(cau_shrink *shrink, const cau_dissection *dissection, int32_t first,
                       const double *position, const cau_tool_def *tool, const cau_pose *pose,
                       double jaw, cau_elements *elements, const cau_element_slots *slots)
{
	CAU_ASSERT(first >= 0 && first <= dissection->removed_count, "from element %d on of %d removed",
	           first, dissection->removed_count);
	expose work = {shrink, dissection, position, tool, pose, jaw, elements, slots};
	for (int32_t k = first; k < dissection->removed_count; k++) {
		const cau_removed *removed = &dissection->removed[k];
		if (removed->kind == CAU_ELEMENT_TRIANGLE)
			expose_triangle(&work, removed->element);
		else if (removed->kind == CAU_ELEMENT_TETRAHEDRON)
			expose_tetrahedron(&work, removed->element);
	}
}

void cau_shrink_advance(cau_shrink *shrink, const cau_tissue *tissue, double step_s,
                        cau_elements *elements, const cau_element_slots *slots)
{
	CAU_ASSERT(step_s > 0, "a step of %g s", step_s);
	int32_t kept = 0;
	for (int32_t k = 0; k < shrink->active_count; k++) {
		cau_shrinking *active = &shrink->active[k];
		CAU_ASSERT(shrink->shrunk[active->kind][active->element],
		           "element %d of kind %d shrinks and is not marked", active->element,
		           active->kind);
		active->age_s += step_s;
		double s = fmin(active->age_s / ramp_s, 1), root[6];
		for (int i = 0; i < 6; i++)
			root[i] = active->from[i] + s * (active->to[i] - active->from[i]);
		cau_elements_set_target(elements, slots, tissue, active->kind, active->element, root);
		if (s < 1)
			shrink->active[kept++] = *active;
	}
	shrink->active_count = kept;
}
