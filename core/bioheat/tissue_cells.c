// SPDX-License-Identifier: GPL-3.0-or-later
#include "bioheat/tissue_cells.h"

#include <math.h>
#include <string.h>

#include "base/hash.h"
#include "bioheat/bioheat.h"
#include "bioheat/element_shape.h"
#include "cautery/assert.h"

// Largest stretch between an element and its cells that lie outside: such a cell is at most this
// many times farther from the element than at rest. Tools miss cells that stretching moves farther
// away.
static const double stretch_most = 2;

static const double surface_w_m2k = 20; // conductance from the surface to still gas, with radiation

// ---- elements

int32_t cau_tissue_cells_elements(const cau_tissue_cells *cells)
{
	const cau_tissue *tissue = cells->tissue;
	return tissue->triangle_count + tissue->tetrahedron_count + tissue->link_count;
}

int32_t cau_tissue_cells_element(const cau_tissue *tissue, int primitive, int32_t index)
{
	for (int before = 0; before < primitive; before++)
		index += cau_tissue_element_count(tissue, before);
	return index;
}

int cau_tissue_cells_primitive(const cau_tissue *tissue, int32_t element, int32_t *index)
{
	int primitive = 0;
	for (; element >= cau_tissue_element_count(tissue, primitive); primitive++)
		element -= cau_tissue_element_count(tissue, primitive);
	CAU_ASSERT(primitive < CAU_PRIMITIVE_KINDS, "an element of kind %d has cells", primitive);
	*index = element;
	return primitive;
}

static double half_of(const cau_tissue_cells *cells, int32_t element)
{
	int32_t triangles = cells->tissue->triangle_count;
	int32_t link = element - triangles - cells->tissue->tetrahedron_count;
	if (element < triangles)
		return cells->half_m[element];
	return link >= 0 ? cells->half_m[triangles + link] : 0;
}

static cau_element_shape shape_of(const cau_tissue_cells *cells, int32_t element)
{
	int32_t index;
	int primitive = cau_tissue_cells_primitive(cells->tissue, element, &index);
	return cau_element_shape_of(cells->tissue, primitive, index, half_of(cells, element),
	                            cells->bioheat.cells.side_m);
}

static uint8_t layer_of(const cau_tissue *tissue, int32_t element)
{
	int32_t index;
	int primitive = cau_tissue_cells_primitive(tissue, element, &index);
	return (uint8_t)cau_tissue_layer_of(tissue, primitive, index);
}

static cau_corners corners_of(const cau_tissue *tissue, int32_t element)
{
	int32_t index;
	cau_corners corners;
	int primitive = cau_tissue_cells_primitive(tissue, element, &index);
	corners.vertex = cau_tissue_vertices_of(tissue, primitive, index, &corners.count);
	return corners;
}

// ---- filling

static cau_bioheat_material material_of(const cau_layer_def *layer)
{
	cau_bioheat_material material = cau_living_tissue(layer->tissue);
	material.perfusion_w_m3k *= layer->perfusion;
	material.sheet = layer->kind == CAU_LAYER_FASCIA || layer->kind == CAU_LAYER_MEMBRANE;
	return material;
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
		cells->material[i] = material_of(&tissue->layer[i].def);
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
	cells->owner = cau_arena_array(arena, most, sizeof(int32_t));
	cells->local = cau_arena_array(arena, 3 * most, sizeof(float));
	cells->member = cau_arena_array(arena, most, sizeof(int32_t));
	cells->stamp = cau_arena_array(arena, most, sizeof(int32_t));
	cells->beyond_m = cau_arena_array(arena, elements, sizeof(float));
	if (!cells->beyond_m || !cells->half_m || !cells->filled || !cells->is_filled ||
	    !cells->owner || !cells->local || !cells->member || !cells->stamp)
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

// Adds tissue of another element to a cell. This tissue has ambient temperature and mixes with the
// cell's tissue. A cell that has lost water gets no more tissue.
static void fill_further(cau_bioheat *bioheat, int32_t cell, float share)
{
	if (bioheat->cells.severed[cell] || bioheat->water[cell] < 1)
		return;
	float *fill = &bioheat->cells.fill[cell], before = *fill;
	*fill = fminf(before + share, 1);
	bioheat->temperature[cell] =
		bioheat->ambient_c + (bioheat->temperature[cell] - bioheat->ambient_c) * before / *fill;
}

static cau_vec3 rest_middle(const cau_element_shape *shape)
{
	cau_vec3 middle = {0};
	for (int i = 0; i < shape->corners.count; i++)
		middle =
			cau_add(middle, cau_scale(1.0 / shape->corners.count, cau_element_corner(shape, i)));
	return middle;
}

static void give(cau_tissue_cells *cells, int32_t cell, int32_t element,
                 const cau_element_shape *shape)
{
	const int32_t *place = cells->bioheat.cells.place + cau_cell_axis(cell, 0);
	cau_vec3 rest = cau_element_cell_middle(shape, place);
	cau_vec3 at = cau_element_coordinates(shape, rest);
	cau_vec3 middle = rest_middle(shape);
	double nearest_m = INFINITY;
	for (int i = 0; i < shape->corners.count; i++)
		nearest_m = fmin(nearest_m, cau_length(cau_sub(cau_element_corner(shape, i), middle)));
	double beyond_m = cau_length(cau_sub(rest, middle)) - nearest_m;
	cells->owner[cell] = element;
	cells->local[cau_cell_axis(cell, 0)] = (float)at.x;
	cells->local[cau_cell_axis(cell, 1)] = (float)at.y;
	cells->local[cau_cell_axis(cell, 2)] = (float)at.z;
	cells->beyond_m[element] = fmaxf(cells->beyond_m[element], (float)beyond_m);
}

void cau_tissue_cells_give(cau_tissue_cells *cells, int32_t cell, int32_t element)
{
	CAU_ASSERT_INDEX(cell, cells->bioheat.cells.count);
	cau_element_shape shape = shape_of(cells, element);
	give(cells, cell, element, &shape);
}

static void fill_cell(cau_tissue_cells *cells, int32_t element, const cau_element_shape *shape,
                      const int32_t place[3], float share)
{
	cau_cells *grid = &cells->bioheat.cells;
	int32_t cell = cau_cells_find(grid, place);
	if (cell >= 0) {
		fill_further(&cells->bioheat, cell, share);
		return;
	}
	cell = cau_bioheat_add(&cells->bioheat, place, layer_of(cells->tissue, element), share);
	CAU_ASSERT(cell >= 0, "no room for a cell of element %d", element);
	cells->current.potential[cell] = 0;
	give(cells, cell, element, shape);
}

bool cau_tissue_cells_fill(cau_tissue_cells *cells, int32_t element)
{
	CAU_ASSERT_INDEX(element, cau_tissue_cells_elements(cells));
	if (cells->is_filled[element])
		return true;
	cau_element_shape shape = shape_of(cells, element);
	cau_cell_box box = cau_element_box(&shape);
	int32_t place[3], wanted = 0;
	memcpy(place, box.least, sizeof place);
	do
		wanted += cau_element_may_meet(&shape, place);
	while (cau_cell_box_next(&box, place));
	if (wanted > cells->bioheat.cells.capacity - cells->bioheat.cells.count)
		return false;
	memcpy(place, box.least, sizeof place);
	do {
		float share = cau_element_share(&shape, place);
		if (share > 0)
			fill_cell(cells, element, &shape, place, share);
	} while (cau_cell_box_next(&box, place));
	cells->is_filled[element] = 1;
	cells->filled[cells->filled_count++] = element;
	return true;
}

// ---- positions of cells

cau_vec3 cau_tissue_cells_at(const cau_tissue_cells *cells, int32_t cell, const double *position)
{
	cau_corners corners = corners_of(cells->tissue, cells->owner[cell]);
	const float *local = cells->local + cau_cell_axis(cell, 0);
	cau_vec3 at, edge[3];
	cau_corners_edges(&corners, position, &at, edge);
	for (int i = 0; i < 3; i++)
		at = cau_add(at, cau_scale(local[i], edge[i]));
	return at;
}

void cau_tissue_cells_bound(const cau_tissue_cells *cells, int32_t element, const double *position,
                            cau_vec3 *middle, double *radius_m)
{
	cau_corners corners = corners_of(cells->tissue, element);
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
	*radius_m += stretch_most * (double)cells->beyond_m[element];
}

// F maps an edge at rest to the edge in the world. So row `axis` of F^-1 is a sum over the edges:
// an entry of the rest edge times the row of the inverse in the world. The square of this row is
// the entry of F^-1 F^-T.
void cau_tissue_cells_stretch(cau_tissue_cells *cells, int32_t cell, const double *position)
{
	cau_corners corners = corners_of(cells->tissue, cells->owner[cell]);
	cau_vec3 first, rest[3], edge[3], across[3];
	cau_corners_edges(&corners, cells->tissue->rest, &first, rest);
	cau_corners_edges(&corners, position, &first, edge);
	if (corners.count == 3) // a sheet keeps its volume, so more area means less thickness
		edge[2] = cau_scale(cau_length(cau_cross(rest[0], rest[1])) /
		                        cau_length(cau_cross(edge[0], edge[1])),
		                    edge[2]);
	double before = cau_dot(rest[0], cau_cross(rest[1], rest[2]));
	double ratio = cau_edges_invert(edge, across) / before;
	if (!(ratio > 0) || !isfinite(ratio))
		return; // inverted or flat: the last value remains
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

// ---- connections within an element

// Lists the cells whose middles are in the element. A cell of a sheet may be up to half a cell
// outside.
static int32_t list_members(cau_tissue_cells *cells, const cau_element_shape *shape)
{
	const cau_cells *grid = &cells->bioheat.cells;
	cau_cell_box box = cau_element_box(shape);
	int32_t place[3], count = 0;
	memcpy(place, box.least, sizeof place);
	do {
		int32_t cell = cau_cells_find(grid, place);
		if (cell >= 0 && !grid->severed[cell] &&
		    cau_element_holds(shape, cau_element_cell_middle(shape, place), grid->side_m / 2))
			cells->member[count++] = cell;
	} while (cau_cell_box_next(&box, place));
	return count;
}

// Marks the members that are connected to cell `from` with a new stamp, and returns that stamp.
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

// Returns the cell of an element's corner, between the corner and the element's middle. Returns -1
// if that cell is gone.
static int32_t corner_cell(const cau_tissue_cells *cells, const cau_element_shape *shape,
                           int corner)
{
	static const double inwards = 0.4;
	const cau_cells *grid = &cells->bioheat.cells;
	cau_vec3 at = cau_add(cau_scale(1 - inwards, cau_element_corner(shape, corner)),
	                      cau_scale(inwards, rest_middle(shape)));
	int32_t cell = cell_at(grid, at);
	return cell >= 0 && !grid->severed[cell] ? cell : -1;
}

bool cau_tissue_cells_separated(cau_tissue_cells *cells, int32_t element)
{
	if (!cells->is_filled[element])
		return false;
	cau_element_shape shape = shape_of(cells, element);
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
	cau_element_shape shape = shape_of(cells, element);
	cau_cell_box box = cau_element_box(&shape);
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

// ---- elements that are gone

static bool lives(const cau_tissue_cells *cells, uint8_t *const alive[CAU_PRIMITIVE_KINDS],
                  int32_t element)
{
	int32_t index;
	int primitive = cau_tissue_cells_primitive(cells->tissue, element, &index);
	return alive[primitive][index];
}

// Stamps the cells whose elements are gone. Returns whether there are any.
static bool stamp_orphans(cau_tissue_cells *cells, uint8_t *const alive[CAU_PRIMITIVE_KINDS],
                          int32_t stamp)
{
	const cau_cells *grid = &cells->bioheat.cells;
	int32_t last = -1;
	bool any = false, gone = false;
	for (int32_t cell = 0; cell < grid->count; cell++) {
		if (grid->severed[cell])
			continue;
		if (cells->owner[cell] != last) {
			last = cells->owner[cell];
			gone = !lives(cells, alive, last);
		}
		if (gone)
			cells->stamp[cell] = stamp;
		any = any || gone;
	}
	return any;
}

// Gives a cell to the element of its first neighbour whose element still exists. Returns whether
// there is such a neighbour.
static bool follow_neighbour(cau_tissue_cells *cells, int32_t cell, int32_t orphan)
{
	for (int side = 0; side < CAU_CELL_SIDES; side++) {
		int32_t other = cells->bioheat.cells.neighbour[cau_cell_side(cell, side)];
		if (other < 0 || cells->stamp[other] >= orphan)
			continue;
		cau_tissue_cells_give(cells, cell, cells->owner[other]);
		return true;
	}
	return false;
}

// Gives cells to the elements of their neighbours. The cells next to existing tissue are first,
// then their neighbours, and so on.
static void spread(cau_tissue_cells *cells, int32_t orphan, int32_t given, int32_t found)
{
	for (int32_t done = 0; done < found; done++)
		for (int side = 0; side < CAU_CELL_SIDES; side++) {
			int32_t cell = cells->member[done];
			int32_t other = cells->bioheat.cells.neighbour[cau_cell_side(cell, side)];
			if (other < 0 || cells->stamp[other] != orphan)
				continue;
			cau_tissue_cells_give(cells, other, cells->owner[cell]);
			cells->stamp[other] = given;
			cells->member[found++] = other;
		}
}

void cau_tissue_cells_reassign(cau_tissue_cells *cells, uint8_t *const alive[CAU_PRIMITIVE_KINDS])
{
	const cau_cells *grid = &cells->bioheat.cells;
	int32_t orphan = ++cells->last_stamp, given = ++cells->last_stamp, found = 0;
	if (!stamp_orphans(cells, alive, orphan))
		return;
	for (int32_t cell = 0; cell < grid->count; cell++)
		if (!grid->severed[cell] && cells->stamp[cell] == orphan &&
		    follow_neighbour(cells, cell, orphan))
			cells->member[found++] = cell;
	for (int32_t i = 0; i < found; i++)
		cells->stamp[cells->member[i]] = given;
	spread(cells, orphan, given, found);
	for (int32_t cell = 0; cell < grid->count; cell++)
		if (!grid->severed[cell] && cells->stamp[cell] == orphan)
			cau_bioheat_take_out(&cells->bioheat, cell);
}

// ---- snapshots

void cau_tissue_cells_copy(cau_tissue_cells *to, const cau_tissue_cells *from)
{
	size_t count = (size_t)from->bioheat.cells.count;
	cau_cells_copy(&to->bioheat.cells, &from->bioheat.cells);
	memcpy(to->bioheat.temperature, from->bioheat.temperature, count * sizeof(double));
	memcpy(to->bioheat.water, from->bioheat.water, count * sizeof(double));
	memcpy(to->bioheat.damage, from->bioheat.damage, count * sizeof(double));
	memcpy(to->current.potential, from->current.potential, count * sizeof(double));
	to->bioheat.ledger = from->bioheat.ledger;
	to->bioheat.boiled_w = from->bioheat.boiled_w;
	to->bioheat.cold = from->bioheat.cold;
	memcpy(to->owner, from->owner, count * sizeof *to->owner);
	memcpy(to->local, from->local, 3 * count * sizeof *to->local);
	memcpy(to->beyond_m, from->beyond_m, (size_t)cau_tissue_cells_elements(from) * sizeof(float));
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
	hash = cau_hash_bytes(hash, cells->owner, (size_t)bioheat->cells.count * sizeof *cells->owner);
	return cau_hash_bytes(hash, bioheat->damage, bytes);
}

double cau_tissue_cells_temperature(const cau_tissue_cells *cells, int32_t vertex)
{
	const cau_cells *grid = &cells->bioheat.cells;
	const double *rest = cells->tissue->rest + 3 * (size_t)vertex;
	double sum = 0;
	int count = 0;
	for (int corner = 0; corner < 8; corner++) { // the eight cells around the vertex
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
