// SPDX-License-Identifier: GPL-3.0-or-later
#include "bioheat/tissue_cells.h"

#include <math.h>
#include <string.h>

#include "base/hash.h"
#include "cautery/assert.h"

enum {
	SUBPOINTS = 3, // along each axis of a cell: its fill is counted in 27ths
	BOUND_CELLS =
		2, // the middle of an element's cell is less than one outside; stretch may double it
};

// Places of subpoints are shifted by so much of a cell, so that none lies on a face of a regular
// mesh, which two elements would count.
static const double shift[] = {0.0137, -0.0071, 0.0043};
// ---- materials (README.md)

static const cau_bioheat_material sheet_tissue = {.conductivity_w_mk = 0.49,
                                                  .density_kg_m3 = 1090,
                                                  .specific_heat_j_kgk = 3421,
                                                  .water = 0.75,
                                                  .electric_s_m = 0.4,
                                                  .perfusion_w_m3k = 12960,
                                                  .damage_log_rate = 91.8, // of 7.39e39 1/s
                                                  .damage_energy_j_mol = 2.577e5,
                                                  .sheet = true};
static const cau_bioheat_material fat_tissue = {.conductivity_w_mk = 0.21,
                                                .density_kg_m3 = 911,
                                                .specific_heat_j_kgk = 2348,
                                                .water = 0.2,
                                                .electric_s_m = 0.03,
                                                .perfusion_w_m3k = 8065,
                                                .damage_log_rate = 91.8,
                                                .damage_energy_j_mol = 2.577e5};

// A strand of connective tissue. Its current spreads with that of what it joins.
static const cau_bioheat_material strand_tissue = {.conductivity_w_mk = 0.49,
                                                   .density_kg_m3 = 1090,
                                                   .specific_heat_j_kgk = 3421,
                                                   .water = 0.75,
                                                   .electric_s_m = 0.4,
                                                   .perfusion_w_m3k = 12960,
                                                   .damage_log_rate = 91.8,
                                                   .damage_energy_j_mol = 2.577e5};

static const double surface_w_m2k = 20; // still gas, with radiation

// ---- elements at rest

typedef struct element_corners {
	int count; // 2: a link, 3: a triangle, 4: a tetrahedron
	const int32_t *vertex;
} element_corners;

static int32_t first_link(const cau_tissue *tissue)
{
	return tissue->triangle_count + tissue->tetrahedron_count;
}

static element_corners corners_of(const cau_tissue *tissue, int32_t element)
{
	if (element < tissue->triangle_count)
		return (element_corners){3, tissue->triangle + 3 * (size_t)element};
	if (element < first_link(tissue))
		return (element_corners){4, tissue->tetrahedron +
		                                4 * (size_t)(element - tissue->triangle_count)};
	return (element_corners){2, tissue->link + 2 * (size_t)(element - first_link(tissue))};
}

static cau_vec3 normal_of(const cau_vec3 corner[3])
{
	cau_vec3 normal = cau_cross(cau_sub(corner[1], corner[0]), cau_sub(corner[2], corner[0]));
	return cau_unit_or(normal, (cau_vec3){0, 0, 1});
}

// Of length 1, and square to `axis`. Like axes have like ones, but where two of their entries
// change places as the least: a link's cells turn around its axis there.
static cau_vec3 square_to(cau_vec3 axis)
{
	double x = fabs(axis.x), y = fabs(axis.y), z = fabs(axis.z);
	cau_vec3 least = x <= y && x <= z ? (cau_vec3){1, 0, 0}
	                 : y <= z         ? (cau_vec3){0, 1, 0}
	                                  : (cau_vec3){0, 0, 1};
	return cau_unit_or(cau_cross(axis, least), (cau_vec3){0, 0, 1});
}

// The edges from the first corner. A triangle's third one is its normal. A link's second and third
// have length 1 and are square to it.
static void edges_of(const element_corners *corners, const double *position, cau_vec3 *first,
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

// Rows of the inverse of the matrix with these columns. Returns its determinant.
static double invert(const cau_vec3 edge[3], cau_vec3 row[3])
{
	double volume = cau_dot(edge[0], cau_cross(edge[1], edge[2]));
	for (int i = 0; i < 3; i++)
		row[i] = cau_scale(1 / volume, cau_cross(edge[(i + 1) % 3], edge[(i + 2) % 3]));
	return volume;
}

typedef struct element_shape {
	element_corners corners;
	cau_vec3 first, edge[3]; // at rest
	cau_vec3 row[3];         // of the inverse of the edges: a point's coordinates along them
	cau_vec3 reach;          // from a cell's middle to its corners, in such coordinates
	double half_m;           // of a sheet's thickness; a link's radius
	double reach_m;
} element_shape;

static double half_of(const cau_tissue_cells *cells, int32_t element)
{
	const cau_tissue *tissue = cells->tissue;
	if (element < tissue->triangle_count)
		return cells->half_m[element];
	int32_t link = element - first_link(tissue);
	return link >= 0 ? cells->half_m[tissue->triangle_count + link] : 0;
}

static element_shape shape_of(const cau_tissue_cells *cells, int32_t element)
{
	element_shape shape = {.corners = corners_of(cells->tissue, element)};
	edges_of(&shape.corners, cells->tissue->rest, &shape.first, shape.edge);
	invert(shape.edge, shape.row);
	shape.reach_m = sqrt(0.75) * cells->bioheat.cells.side_m;
	shape.reach = (cau_vec3){shape.reach_m * cau_length(shape.row[0]),
	                         shape.reach_m * cau_length(shape.row[1]),
	                         shape.reach_m * cau_length(shape.row[2])};
	shape.half_m = half_of(cells, element);
	return shape;
}

int32_t cau_tissue_cells_layer(const cau_tissue *tissue, int32_t element)
{
	if (element < tissue->triangle_count)
		return tissue->triangle_layer[element];
	if (element < first_link(tissue))
		return tissue->tetrahedron_layer[element - tissue->triangle_count];
	return tissue->link_layer[element - first_link(tissue)];
}

// Coordinates of a point along the edges.
static cau_vec3 coordinates(const element_shape *shape, cau_vec3 point)
{
	cau_vec3 from = cau_sub(point, shape->first);
	return (cau_vec3){cau_dot(from, shape->row[0]), cau_dot(from, shape->row[1]),
	                  cau_dot(from, shape->row[2])};
}

static cau_vec3 corner_at_rest(const element_shape *shape, int corner)
{
	return corner ? cau_add(shape->first, shape->edge[corner - 1]) : shape->first;
}

// `margin_m`: by which a sheet counts as thicker on each side, and a link's radius as longer.
static bool is_inside(const element_shape *shape, cau_vec3 point, double margin_m)
{
	cau_vec3 at = coordinates(shape, point);
	if (shape->corners.count == 2)
		return at.x >= 0 && at.x <= 1 && hypot(at.y, at.z) <= shape->half_m + margin_m;
	if (at.x < 0 || at.y < 0)
		return false;
	if (shape->corners.count == 3)
		return at.x + at.y <= 1 && fabs(at.z) <= shape->half_m + margin_m;
	return at.z >= 0 && at.x + at.y + at.z <= 1;
}

typedef struct cell_box {
	int32_t least[3], most[3];
} cell_box;

static cell_box box_of(const element_shape *shape, double side_m)
{
	cell_box box;
	for (int axis = 0; axis < 3; axis++) {
		double least = INFINITY, most = -INFINITY;
		for (int i = 0; i < shape->corners.count; i++) {
			cau_vec3 corner = corner_at_rest(shape, i);
			double at = axis == 0 ? corner.x : axis == 1 ? corner.y : corner.z;
			least = fmin(least, at);
			most = fmax(most, at);
		}
		box.least[axis] = (int32_t)floor((least - shape->half_m) / side_m);
		box.most[axis] = (int32_t)floor((most + shape->half_m) / side_m);
	}
	return box;
}

// Goes to the box's next place; false: there is none.
static bool next_place(const cell_box *box, int32_t place[3])
{
	for (int axis = 0; axis < 3; axis++) {
		if (++place[axis] <= box->most[axis])
			return true;
		place[axis] = box->least[axis];
	}
	return false;
}

static cau_vec3 point_in(const int32_t place[3], double side_m, const double within[3])
{
	return (cau_vec3){(place[0] + within[0]) * side_m, (place[1] + within[1]) * side_m,
	                  (place[2] + within[2]) * side_m};
}

static const double in_the_middle[] = {0.5, 0.5, 0.5};

// ---- filling

static cau_bioheat_material material_of_kind(cau_layer_kind kind)
{
	return kind == CAU_LAYER_FAT     ? fat_tissue
	       : kind == CAU_LAYER_LINKS ? strand_tissue
	                                 : sheet_tissue;
}

static size_t half_count(const cau_tissue *tissue)
{
	return (size_t)tissue->triangle_count + (size_t)tissue->link_count;
}

static void measure_halves(cau_tissue_cells *cells)
{
	static const double pi = 3.14159265358979323846;
	const cau_tissue *tissue = cells->tissue;
	for (int32_t t = 0; t < tissue->triangle_count; t++)
		cells->half_m[t] = cau_triangle_material(tissue, t)->thickness_m / 2;
	for (int32_t l = 0; l < tissue->link_count; l++) {
		double area_m2 = tissue->layer[tissue->link_layer[l]].def.link.area_m2;
		cells->half_m[tissue->triangle_count + l] = sqrt(area_m2 / pi);
	}
}

cau_status cau_tissue_cells_create(cau_tissue_cells *cells, const cau_tissue *tissue, double side_m,
                                   int32_t capacity, double ambient_c, cau_arena *arena,
                                   cau_error *error)
{
	size_t most = (size_t)capacity;
	*cells = (cau_tissue_cells){.tissue = tissue};
	for (int32_t i = 0; i < tissue->layer_count; i++)
		cells->material[i] = material_of_kind(tissue->layer[i].def.kind);
	cau_status status = cau_bioheat_create(&cells->bioheat, side_m, capacity, cells->material,
	                                       tissue->layer_count, ambient_c, arena, error);
	if (!status)
		status = cau_current_create(&cells->current, &cells->bioheat, arena, error);
	if (status)
		return status;
	size_t elements = (size_t)cau_tissue_cells_elements(cells);
	cells->half_m = cau_arena_array(arena, half_count(tissue), sizeof(double));
	cells->filled = cau_arena_array(arena, elements, sizeof(int32_t));
	cells->is_filled = cau_arena_array(arena, elements, 1);
	cells->is_near = cau_arena_array(arena, elements, 1);
	cells->owner = cau_arena_array(arena, most, sizeof(int32_t));
	cells->local = cau_arena_array(arena, 3 * most, sizeof(float));
	cells->member = cau_arena_array(arena, most, sizeof(int32_t));
	cells->stamp = cau_arena_array(arena, most, sizeof(int32_t));
	if (!cells->half_m || !cells->filled || !cells->is_filled || !cells->is_near || !cells->owner ||
	    !cells->local || !cells->member || !cells->stamp)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for %d cells of tissue", capacity);
	cells->bioheat.surface_w_m2k = surface_w_m2k;
	measure_halves(cells);
	return CAU_OK;
}

cau_status cau_tissue_cells_create_like(cau_tissue_cells *cells, const cau_tissue_cells *other,
                                        cau_arena *arena, cau_error *error)
{
	const cau_bioheat *bioheat = &other->bioheat;
	cau_status status =
		cau_tissue_cells_create(cells, other->tissue, bioheat->cells.side_m,
	                            bioheat->cells.capacity, bioheat->ambient_c, arena, error);
	if (!status)
		memcpy(cells->half_m, other->half_m, half_count(other->tissue) * sizeof *cells->half_m);
	return status;
}

int32_t cau_tissue_cells_elements(const cau_tissue_cells *cells)
{
	return first_link(cells->tissue) + cells->tissue->link_count;
}

int32_t cau_tissue_cells_element(const cau_tissue *tissue, int kind, int32_t index)
{
	CAU_ASSERT(kind <= CAU_ELEMENT_LINK, "elements of kind %d have no cells", kind);
	return index + (kind == CAU_ELEMENT_TRIANGLE      ? 0
	                : kind == CAU_ELEMENT_TETRAHEDRON ? tissue->triangle_count
	                                                  : first_link(tissue));
}

int cau_tissue_cells_kind(const cau_tissue *tissue, int32_t element, int32_t *index)
{
	int kind = element < tissue->triangle_count ? CAU_ELEMENT_TRIANGLE
	           : element < first_link(tissue)   ? CAU_ELEMENT_TETRAHEDRON
	                                            : CAU_ELEMENT_LINK;
	*index = element - cau_tissue_cells_element(tissue, kind, 0);
	return kind;
}

// Whether all of a cell lies in the element: its middle is farther in than its corners are away.
static bool holds_all(const element_shape *shape, const int32_t place[3], double side_m)
{
	cau_vec3 at = coordinates(shape, point_in(place, side_m, in_the_middle));
	cau_vec3 reach = shape->reach;
	if (shape->corners.count == 2)
		return at.x >= reach.x && at.x <= 1 - reach.x &&
		       hypot(at.y, at.z) <= shape->half_m - shape->reach_m;
	if (at.x < reach.x || at.y < reach.y)
		return false;
	if (shape->corners.count == 3)
		return fabs(at.z) <= shape->half_m - shape->reach_m && at.x + at.y <= 1 - reach.x - reach.y;
	return at.z >= reach.z && at.x + at.y + at.z <= 1 - reach.x - reach.y - reach.z;
}

// Share of a cell that lies in the element.
static float share_of(const element_shape *shape, const int32_t place[3], double side_m)
{
	if (holds_all(shape, place, side_m))
		return 1;
	int inside = 0;
	for (int k = 0; k < SUBPOINTS * SUBPOINTS * SUBPOINTS; k++) {
		const int step[] = {k % SUBPOINTS, k / SUBPOINTS % SUBPOINTS, k / SUBPOINTS / SUBPOINTS};
		double within[3];
		for (int axis = 0; axis < 3; axis++)
			within[axis] = (step[axis] + 0.5) / SUBPOINTS + shift[axis];
		inside += is_inside(shape, point_in(place, side_m, within), 0);
	}
	return (float)inside / (SUBPOINTS * SUBPOINTS * SUBPOINTS);
}

// Whether a cell may have a part in the element: its middle is not farther from it than its
// corners.
static bool may_meet(const element_shape *shape, const int32_t place[3], double side_m)
{
	cau_vec3 at = coordinates(shape, point_in(place, side_m, in_the_middle));
	cau_vec3 reach = shape->reach;
	if (shape->corners.count == 2)
		return at.x >= -reach.x && at.x <= 1 + reach.x &&
		       hypot(at.y, at.z) <= shape->half_m + shape->reach_m;
	if (at.x < -reach.x || at.y < -reach.y)
		return false;
	if (shape->corners.count == 3)
		return fabs(at.z) <= shape->half_m + shape->reach_m && at.x + at.y <= 1 + reach.x + reach.y;
	return at.z >= -reach.z && at.x + at.y + at.z <= 1 + reach.x + reach.y + reach.z;
}

// What is added is at ambient temperature and mixes with what is there. Tissue that has lost water
// takes nothing in.
static void fill_further(cau_bioheat *bioheat, int32_t cell, float share)
{
	if (bioheat->cells.severed[cell] || bioheat->water[cell] < 1)
		return;
	float *fill = &bioheat->cells.fill[cell], before = *fill;
	*fill = fminf(before + share, 1);
	bioheat->temperature[cell] =
		bioheat->ambient_c + (bioheat->temperature[cell] - bioheat->ambient_c) * before / *fill;
}

static void fill_cell(cau_tissue_cells *cells, int32_t element, const element_shape *shape,
                      const int32_t place[3], float share)
{
	cau_cells *grid = &cells->bioheat.cells;
	int32_t cell = cau_cells_find(grid, place);
	if (cell >= 0) {
		fill_further(&cells->bioheat, cell, share);
		return;
	}
	cell = cau_bioheat_add(&cells->bioheat, place,
	                       (uint8_t)cau_tissue_cells_layer(cells->tissue, element), share);
	CAU_ASSERT(cell >= 0, "no room for a cell of element %d", element);
	cau_vec3 at = coordinates(shape, point_in(place, grid->side_m, in_the_middle));
	cells->owner[cell] = element;
	cells->local[cau_cell_axis(cell, 0)] = (float)at.x;
	cells->local[cau_cell_axis(cell, 1)] = (float)at.y;
	cells->local[cau_cell_axis(cell, 2)] = (float)at.z;
}

int32_t cau_tissue_cells_places(const cau_tissue_cells *cells, int32_t element)
{
	element_shape shape = shape_of(cells, element);
	cell_box box = box_of(&shape, cells->bioheat.cells.side_m);
	int64_t places = 1;
	for (int axis = 0; axis < 3; axis++)
		places *= box.most[axis] - box.least[axis] + 1;
	return (int32_t)(places < INT32_MAX ? places : INT32_MAX);
}

bool cau_tissue_cells_fill(cau_tissue_cells *cells, int32_t element)
{
	CAU_ASSERT_INDEX(element, cau_tissue_cells_elements(cells));
	if (cells->is_filled[element])
		return true;
	double side_m = cells->bioheat.cells.side_m;
	element_shape shape = shape_of(cells, element);
	cell_box box = box_of(&shape, side_m);
	int32_t place[3], wanted = 0;
	memcpy(place, box.least, sizeof place);
	do
		wanted += may_meet(&shape, place, side_m);
	while (next_place(&box, place));
	if (wanted > cells->bioheat.cells.capacity - cells->bioheat.cells.count)
		return false;
	memcpy(place, box.least, sizeof place);
	do {
		float share = may_meet(&shape, place, side_m) ? share_of(&shape, place, side_m) : 0;
		if (share > 0)
			fill_cell(cells, element, &shape, place, share);
	} while (next_place(&box, place));
	cells->is_filled[element] = 1;
	cells->filled[cells->filled_count++] = element;
	return true;
}

// ---- where they are

cau_vec3 cau_tissue_cells_at(const cau_tissue_cells *cells, int32_t cell, const double *position)
{
	element_corners corners = corners_of(cells->tissue, cells->owner[cell]);
	const float *local = cells->local + cau_cell_axis(cell, 0);
	cau_vec3 at, edge[3];
	edges_of(&corners, position, &at, edge);
	for (int i = 0; i < 3; i++)
		at = cau_add(at, cau_scale(local[i], edge[i]));
	return at;
}

void cau_tissue_cells_bound(const cau_tissue_cells *cells, int32_t element, const double *position,
                            cau_vec3 *middle, double *radius_m)
{
	element_corners corners = corners_of(cells->tissue, element);
	*middle = (cau_vec3){0};
	for (int i = 0; i < corners.count; i++)
		*middle =
			cau_add(*middle, cau_scale(1.0 / corners.count,
		                               cau_vec3_of(position + 3 * (size_t)corners.vertex[i])));
	*radius_m = 0;
	for (int i = 0; i < corners.count; i++) {
		cau_vec3 corner = cau_vec3_of(position + 3 * (size_t)corners.vertex[i]);
		*radius_m = fmax(*radius_m, cau_length(cau_sub(corner, *middle)));
	}
	*radius_m += BOUND_CELLS * cells->bioheat.cells.side_m + half_of(cells, element);
}

// F takes an edge at rest to the edge in the world, so row `axis` of F^-1 is the sum of the rest
// edges' entries times the rows of the inverse in the world. Its square is the entry of F^-1 F^-T.
void cau_tissue_cells_stretch(cau_tissue_cells *cells, int32_t cell, const double *position)
{
	element_corners corners = corners_of(cells->tissue, cells->owner[cell]);
	cau_vec3 first, rest[3], edge[3], across[3];
	edges_of(&corners, cells->tissue->rest, &first, rest);
	edges_of(&corners, position, &first, edge);
	if (corners.count == 3) // a sheet keeps its volume: what it gains in area it loses in thickness
		edge[2] = cau_scale(cau_length(cau_cross(rest[0], rest[1])) /
		                        cau_length(cau_cross(edge[0], edge[1])),
		                    edge[2]);
	double before = cau_dot(rest[0], cau_cross(rest[1], rest[2]));
	double ratio = invert(edge, across) / before;
	if (!(ratio > 0) || !isfinite(ratio))
		return; // inside out or flat: the last value stays
	for (int axis = 0; axis < 3; axis++) {
		cau_vec3 row = {0};
		for (int i = 0; i < 3; i++) {
			double along = axis == 0 ? rest[i].x : axis == 1 ? rest[i].y : rest[i].z;
			row = cau_add(row, cau_scale(along, across[i]));
		}
		double pull = ratio * cau_dot(row, row);
		cells->bioheat.cells.pull[cau_cell_axis(cell, axis)] =
			(float)fmax(fmin(pull, CAU_PULL_MOST), 1 / CAU_PULL_MOST);
	}
}

// ---- what holds together

// Lists the cells whose middles are in the element. A sheet's may be up to half a cell outside.
static int32_t list_members(cau_tissue_cells *cells, const element_shape *shape)
{
	const cau_cells *grid = &cells->bioheat.cells;
	cell_box box = box_of(shape, grid->side_m);
	int32_t place[3], count = 0;
	memcpy(place, box.least, sizeof place);
	do {
		int32_t cell = cau_cells_find(grid, place);
		if (cell >= 0 && !grid->severed[cell] &&
		    is_inside(shape, point_in(place, grid->side_m, in_the_middle), grid->side_m / 2))
			cells->member[count++] = cell;
	} while (next_place(&box, place));
	return count;
}

// Returns a new stamp. It marks the members that are joined with cell `from`.
static int32_t mark_joined(cau_tissue_cells *cells, int32_t count, int32_t from)
{
	int32_t members = ++cells->last_stamp, joined = ++cells->last_stamp, done = 0, found = 0;
	for (int32_t i = 0; i < count; i++)
		cells->stamp[cells->member[i]] = members;
	cells->stamp[from] = joined;
	cells->member[found++] = from;
	while (done < found) {
		int32_t cell = cells->member[done++];
		for (int side = 0; side < CAU_CELL_SIDES; side++) {
			int32_t other = cells->bioheat.cells.neighbour[cau_cell_side(cell, side)];
			if (other < 0 || cells->stamp[other] != members)
				continue;
			cells->stamp[other] = joined;
			cells->member[found++] = other;
		}
	}
	return joined;
}

static int32_t cell_at(const cau_cells *grid, cau_vec3 rest)
{
	const int32_t place[] = {(int32_t)floor(rest.x / grid->side_m),
	                         (int32_t)floor(rest.y / grid->side_m),
	                         (int32_t)floor(rest.z / grid->side_m)};
	return cau_cells_find(grid, place);
}

// The cell of an element's corner: between the corner and the element's middle. -1: it is gone.
static int32_t corner_cell(const cau_tissue_cells *cells, const element_shape *shape, int corner)
{
	static const double inwards = 0.4;
	const cau_cells *grid = &cells->bioheat.cells;
	cau_vec3 middle = {0};
	for (int i = 0; i < shape->corners.count; i++)
		middle = cau_add(middle, cau_scale(1.0 / shape->corners.count, corner_at_rest(shape, i)));
	cau_vec3 at =
		cau_add(cau_scale(1 - inwards, corner_at_rest(shape, corner)), cau_scale(inwards, middle));
	int32_t cell = cell_at(grid, at);
	return cell >= 0 && !grid->severed[cell] ? cell : -1;
}

bool cau_tissue_cells_separated(cau_tissue_cells *cells, int32_t element)
{
	if (!cells->is_filled[element])
		return false;
	element_shape shape = shape_of(cells, element);
	int32_t first = corner_cell(cells, &shape, 0);
	if (first < 0)
		return true;
	int32_t count = list_members(cells, &shape);
	int32_t joined = mark_joined(cells, count, first);
	for (int corner = 1; corner < shape.corners.count; corner++) {
		int32_t cell = corner_cell(cells, &shape, corner);
		if (cell < 0 || cells->stamp[cell] != joined)
			return true;
	}
	return false;
}

bool cau_tissue_cells_meets(const cau_tissue_cells *cells, int32_t element, const int32_t least[3],
                            const int32_t most[3])
{
	element_shape shape = shape_of(cells, element);
	cell_box box = box_of(&shape, cells->bioheat.cells.side_m);
	for (int axis = 0; axis < 3; axis++)
		if (box.least[axis] > most[axis] || box.most[axis] < least[axis])
			return false;
	return true;
}

int32_t cau_tissue_cells_between(const cau_tissue_cells *cells, int32_t a, int32_t b)
{
	const double *rest = cells->tissue->rest;
	cau_vec3 sum = cau_add(cau_vec3_of(rest + 3 * (size_t)a), cau_vec3_of(rest + 3 * (size_t)b));
	return cell_at(&cells->bioheat.cells, cau_scale(0.5, sum));
}

void cau_tissue_cells_remove(cau_tissue_cells *cells, int32_t element)
{
	if (!cells->is_filled[element])
		return;
	element_shape shape = shape_of(cells, element);
	int32_t count = list_members(cells, &shape);
	bool link = shape.corners.count == 2; // its ends are in what it joins
	for (int32_t i = 0; i < count; i++)
		if (!link || cells->owner[cells->member[i]] == element)
			cau_bioheat_take_out(&cells->bioheat, cells->member[i]);
}

// ---- snapshots

static void copy_cells(cau_cells *to, const cau_cells *from)
{
	size_t count = (size_t)from->count;
	to->count = from->count;
	memcpy(to->place, from->place, 3 * count * sizeof *to->place);
	memcpy(to->neighbour, from->neighbour, CAU_CELL_SIDES * count * sizeof *to->neighbour);
	memcpy(to->material, from->material, count);
	memcpy(to->fill, from->fill, count * sizeof *to->fill);
	memcpy(to->pull, from->pull, 3 * count * sizeof *to->pull);
	memcpy(to->severed, from->severed, count);
	memcpy(to->bucket, from->bucket, (size_t)from->bucket_count * sizeof *to->bucket);
}

void cau_tissue_cells_copy(cau_tissue_cells *to, const cau_tissue_cells *from)
{
	CAU_ASSERT(to->bioheat.cells.capacity == from->bioheat.cells.capacity, "%d cells, not %d",
	           to->bioheat.cells.capacity, from->bioheat.cells.capacity);
	size_t count = (size_t)from->bioheat.cells.count;
	copy_cells(&to->bioheat.cells, &from->bioheat.cells);
	memcpy(to->bioheat.temperature, from->bioheat.temperature, count * sizeof(double));
	memcpy(to->bioheat.water, from->bioheat.water, count * sizeof(double));
	memcpy(to->bioheat.damage, from->bioheat.damage, count * sizeof(double));
	memcpy(to->current.potential, from->current.potential, count * sizeof(double));
	to->bioheat.ledger = from->bioheat.ledger;
	to->bioheat.cold = from->bioheat.cold;
	memcpy(to->owner, from->owner, count * sizeof *to->owner);
	memcpy(to->local, from->local, 3 * count * sizeof *to->local);
	to->filled_count = from->filled_count;
	memcpy(to->filled, from->filled, (size_t)from->filled_count * sizeof *to->filled);
	memcpy(to->is_filled, from->is_filled, (size_t)cau_tissue_cells_elements(from));
}

uint64_t cau_tissue_cells_hash(const cau_tissue_cells *cells, uint64_t hash)
{
	const cau_bioheat *bioheat = &cells->bioheat;
	size_t bytes = (size_t)bioheat->cells.count * sizeof(double);
	hash = cau_hash_word(hash, (uint64_t)bioheat->cells.count);
	hash = cau_hash_bytes(hash, bioheat->temperature, bytes);
	hash = cau_hash_bytes(hash, bioheat->water, bytes);
	return cau_hash_bytes(hash, bioheat->damage, bytes);
}

double cau_tissue_cells_temperature(const cau_tissue_cells *cells, int32_t vertex)
{
	const cau_cells *grid = &cells->bioheat.cells;
	const double *rest = cells->tissue->rest + 3 * (size_t)vertex;
	double sum = 0;
	int count = 0;
	for (int corner = 0; corner < 8; corner++) { // the eight cells around it
		const int32_t place[] = {(int32_t)floor(rest[0] / grid->side_m + (corner & 1) - 0.5),
		                         (int32_t)floor(rest[1] / grid->side_m + (corner >> 1 & 1) - 0.5),
		                         (int32_t)floor(rest[2] / grid->side_m + (corner >> 2) - 0.5)};
		int32_t cell = cau_cells_find(grid, place);
		if (cell < 0 || grid->severed[cell])
			continue;
		sum += cells->bioheat.temperature[cell];
		count++;
	}
	return count ? sum / count : cells->bioheat.ambient_c;
}
