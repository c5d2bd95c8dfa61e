// SPDX-License-Identifier: GPL-3.0-or-later
#include "bioheat/element_shape.h"

#include <math.h>

// Points along each axis of a cell. With three, the share of tissue is counted in 27ths.
enum { SUBPOINTS = 3 };

// Shift of a cell's points, as a share of the cell along each axis. So no point is on a face of a
// regular mesh, where two elements would count it.
static const double shift[] = {0.0137, -0.0071, 0.0043};

// ---- edges

static cau_vec3 normal_of(const cau_vec3 corner[3])
{
	cau_vec3 normal = cau_cross(cau_sub(corner[1], corner[0]), cau_sub(corner[2], corner[0]));
	return cau_unit_or(normal, (cau_vec3){0, 0, 1});
}

// Returns a unit vector at a right angle to `axis`. If the axis turns, the vector turns with it,
// but jumps when another entry of the axis becomes the least. The cells of a link then turn around
// the link.
static cau_vec3 square_to(cau_vec3 axis)
{
	double x = fabs(axis.x), y = fabs(axis.y), z = fabs(axis.z);
	cau_vec3 least = x <= y && x <= z ? (cau_vec3){1, 0, 0}
	                 : y <= z         ? (cau_vec3){0, 1, 0}
	                                  : (cau_vec3){0, 0, 1};
	return cau_unit_or(cau_cross(axis, least), (cau_vec3){0, 0, 1});
}

void cau_corners_edges(const cau_corners *corners, const double *position, cau_vec3 *first,
                       cau_vec3 edge[3])
{
	cau_vec3 at[4];
	for (int i = 0; i < corners->count; i++)
		at[i] = cau_vec3_of(position + 3 * (size_t)corners->vertex[i]);
	*first = at[0];
	edge[0] = cau_sub(at[1], at[0]);
	if (corners->count == 2) {
		edge[1] = square_to(edge[0]);
		edge[2] = cau_unit_or(cau_cross(edge[0], edge[1]), (cau_vec3){0, 0, 1});
		return;
	}
	edge[1] = cau_sub(at[2], at[0]);
	edge[2] = corners->count == 4 ? cau_sub(at[3], at[0]) : normal_of(at);
}

double cau_edges_invert(const cau_vec3 edge[3], cau_vec3 row[3])
{
	double volume = cau_dot(edge[0], cau_cross(edge[1], edge[2]));
	for (int i = 0; i < 3; i++)
		row[i] = cau_scale(1 / volume, cau_cross(edge[(i + 1) % 3], edge[(i + 2) % 3]));
	return volume;
}

// ---- shape

cau_element_shape cau_element_shape_of(const cau_tissue *tissue, int primitive, int32_t index,
                                       double half_m, double side_m)
{
	cau_element_shape shape = {.half_m = half_m, .side_m = side_m, .reach_m = sqrt(0.75) * side_m};
	shape.corners.vertex = cau_tissue_vertices_of(tissue, primitive, index, &shape.corners.count);
	cau_corners_edges(&shape.corners, tissue->rest, &shape.first, shape.edge);
	cau_edges_invert(shape.edge, shape.row);
	shape.reach = (cau_vec3){shape.reach_m * cau_length(shape.row[0]),
	                         shape.reach_m * cau_length(shape.row[1]),
	                         shape.reach_m * cau_length(shape.row[2])};
	return shape;
}

cau_vec3 cau_element_coordinates(const cau_element_shape *shape, cau_vec3 point)
{
	cau_vec3 from = cau_sub(point, shape->first);
	return (cau_vec3){cau_dot(from, shape->row[0]), cau_dot(from, shape->row[1]),
	                  cau_dot(from, shape->row[2])};
}

cau_vec3 cau_element_corner(const cau_element_shape *shape, int corner)
{
	return corner ? cau_add(shape->first, shape->edge[corner - 1]) : shape->first;
}

// True if the element contains a point at these coordinates. The element is enlarged by `margin` in
// coordinates, and by margin_m in thickness or radius. A margin below 0 makes the element smaller.
static bool holds(const cau_element_shape *shape, cau_vec3 at, cau_vec3 margin, double margin_m)
{
	if (shape->corners.count == 2)
		return at.x >= -margin.x && at.x <= 1 + margin.x &&
		       hypot(at.y, at.z) <= shape->half_m + margin_m;
	if (at.x < -margin.x || at.y < -margin.y)
		return false;
	if (shape->corners.count == 3)
		return fabs(at.z) <= shape->half_m + margin_m && at.x + at.y <= 1 + margin.x + margin.y;
	return at.z >= -margin.z && at.x + at.y + at.z <= 1 + margin.x + margin.y + margin.z;
}

bool cau_element_holds(const cau_element_shape *shape, cau_vec3 point, double margin_m)
{
	return holds(shape, cau_element_coordinates(shape, point), (cau_vec3){0}, margin_m);
}

// ---- cells

cau_cell_box cau_element_box(const cau_element_shape *shape)
{
	cau_cell_box box;
	for (int axis = 0; axis < 3; axis++) {
		double least = INFINITY, most = -INFINITY;
		for (int i = 0; i < shape->corners.count; i++) {
			cau_vec3 corner = cau_element_corner(shape, i);
			double at = axis == 0 ? corner.x : axis == 1 ? corner.y : corner.z;
			least = fmin(least, at);
			most = fmax(most, at);
		}
		box.least[axis] = (int32_t)floor((least - shape->half_m) / shape->side_m);
		box.most[axis] = (int32_t)floor((most + shape->half_m) / shape->side_m);
	}
	return box;
}

bool cau_cell_box_next(const cau_cell_box *box, int32_t place[3])
{
	for (int axis = 0; axis < 3; axis++) {
		if (++place[axis] <= box->most[axis])
			return true;
		place[axis] = box->least[axis];
	}
	return false;
}

static cau_vec3 point_in(const cau_element_shape *shape, const int32_t place[3],
                         const double within[3])
{
	return (cau_vec3){(place[0] + within[0]) * shape->side_m,
	                  (place[1] + within[1]) * shape->side_m,
	                  (place[2] + within[2]) * shape->side_m};
}

cau_vec3 cau_element_cell_middle(const cau_element_shape *shape, const int32_t place[3])
{
	static const double in_the_middle[] = {0.5, 0.5, 0.5};
	return point_in(shape, place, in_the_middle);
}

bool cau_element_may_meet(const cau_element_shape *shape, const int32_t place[3])
{
	cau_vec3 at = cau_element_coordinates(shape, cau_element_cell_middle(shape, place));
	return holds(shape, at, shape->reach, shape->reach_m);
}

static bool holds_all(const cau_element_shape *shape, const int32_t place[3])
{
	cau_vec3 at = cau_element_coordinates(shape, cau_element_cell_middle(shape, place));
	return holds(shape, at, cau_scale(-1, shape->reach), -shape->reach_m);
}

float cau_element_share(const cau_element_shape *shape, const int32_t place[3])
{
	if (!cau_element_may_meet(shape, place))
		return 0;
	if (holds_all(shape, place))
		return 1;
	int inside = 0;
	for (int k = 0; k < SUBPOINTS * SUBPOINTS * SUBPOINTS; k++) {
		const int step[] = {k % SUBPOINTS, k / SUBPOINTS % SUBPOINTS, k / SUBPOINTS / SUBPOINTS};
		double within[3];
		for (int axis = 0; axis < 3; axis++)
			within[axis] = (step[axis] + 0.5) / SUBPOINTS + shift[axis];
		inside += cau_element_holds(shape, point_in(shape, place, within), 0);
	}
	return (float)inside / (SUBPOINTS * SUBPOINTS * SUBPOINTS);
}
