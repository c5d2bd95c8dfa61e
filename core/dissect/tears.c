// SPDX-License-Identifier: GPL-3.0-or-later
// Tearing: tissue that is stretched beyond what its layer can bear parts without heat.
//
// A strength limit would make tears depend on the mesh. At the tip of a cut the stretch grows
// without bound as elements shrink. So a finer mesh would tear first, and with no work at all. A
// tear needs energy for its area, G_c. So an element is one band of a crack [Bazant and Oh 1983,
// Crack band theory for fracture of concrete]. It tears when its energy density times its size
// reaches G_c. The energy density near a tip falls with the distance as 1/r. So for elements of any
// size h, density times h is the same share of the energy that the tear would release (`share_of`).
// (Away from any tip or held edge, the stretch is even and there is no crack yet. There a finer
// mesh bears more, in proportion to 1 / sqrt(h).)
//
// The load of an element comes from its stretch beyond the rest shape, not from the energy of its
// law. A fascia whose target is 0.1 stores much energy at rest and is always taut, but does not
// tear. So with the principal stretches s of F
//     psi = E/2 sum (s - 1)+^2 + k/2 sum (s - s_free)+^2,
// where E is Young's modulus of fat and links, and k is the stiffness of the strain limit of sheets
// and fat. s_free is 1, or for a range, the largest stretch in the range along that axis.
// Compression adds nothing. Along one axis psi is the energy of the laws at small strain. psi
// leaves out what Poisson's ratio adds when two axes are stretched. It includes plastic strain as
// stored energy, although a band has spent that energy.
//
// If a layer's `coagulated_tear` is below 1, heat weakens the layer. G_c falls in proportion to the
// exposure of the element's edges. From an exposure of 0.5 on, G_c is `coagulated_tear` times its
// fresh value.
//
// An element tears after two consecutive converged ticks in which it was overloaded, or after six
// consecutive ticks of any kind. An iterate may be far from the solution, but not for a tenth of a
// second. And a flap that hangs by little may never converge. Of overloaded elements that share
// vertices, only the most loaded tears, because its loss unloads its neighbours. So a tear is one
// element wide.
#include <string.h>

#include "base/vector.h"
#include "cautery/assert.h"
#include "dissect/dissection_internal.h"

enum { PART = 2048 }; // elements that one part of the loop examines

// Counts that an overloaded element gets in a tick: COUNTS_CONVERGED if the step has converged,
// else COUNTS_AT_ALL. The element tears when the sum of its counts reaches TAKES.
enum { COUNTS_CONVERGED = 3, COUNTS_AT_ALL = 1, TAKES = 2 * COUNTS_CONVERGED };

int32_t cau_tears_capacity(const cau_tissue *tissue)
{
	return tissue->triangle_count + tissue->tetrahedron_count + tissue->link_count;
}

static int primitive_at(const cau_tissue *tissue, int32_t place, int32_t *index)
{
	CAU_ASSERT_INDEX(place, cau_tears_capacity(tissue));
	*index = place;
	if (place < tissue->triangle_count)
		return CAU_PRIMITIVE_TRIANGLE;
	*index -= tissue->triangle_count;
	if (*index < tissue->tetrahedron_count)
		return CAU_PRIMITIVE_TETRAHEDRON;
	*index -= tissue->tetrahedron_count;
	return CAU_PRIMITIVE_LINK;
}

// Returns the width of an element's crack band, m. For a triangle this is the leg of a right
// triangle of the same area. For a tetrahedron it is the edge of the cube that six such tetrahedra
// fill. For a link it is the whole length, because a torn fibre recoils whole.
static double size_of(const cau_tissue *tissue, int primitive, int32_t index)
{
	if (primitive == CAU_PRIMITIVE_TRIANGLE)
		return sqrt(2 * tissue->triangle_area[index]);
	if (primitive == CAU_PRIMITIVE_TETRAHEDRON)
		return cbrt(6 * tissue->tetrahedron_volume[index]);
	return tissue->link_length[index];
}

cau_status cau_tears_create(cau_tears *tears, const cau_tissue *tissue, cau_arena *arena,
                            cau_error *error)
{
	size_t total = (size_t)cau_tears_capacity(tissue);
	size_t parts = total / PART + CAU_MAX_LAYERS; // the last part of each layer may not be full
	tears->over = cau_arena_array(arena, total, sizeof *tears->over);
	tears->before = cau_arena_array(arena, total, sizeof *tears->before);
	tears->now = cau_arena_array(arena, parts * PART, sizeof *tears->now);
	tears->found = cau_arena_array(arena, parts, sizeof *tears->found);
	tears->load = cau_arena_array(arena, parts * PART, sizeof *tears->load);
	tears->most = cau_arena_array(arena, (size_t)tissue->vertex_count, sizeof *tears->most);
	if (!tears->over || !tears->before || !tears->now || !tears->found || !tears->load ||
	    !tears->most)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for tears");
	for (int32_t place = 0; place < cau_tears_capacity(tissue); place++) {
		int32_t index;
		int primitive = primitive_at(tissue, place, &index);
		double size = size_of(tissue, primitive, index);
		double *widest = &tears->widest_m[primitive];
		*widest = fmax(*widest, size);
	}
	return CAU_OK;
}

// ---- load of an element

// The properties of an element's law and layer that determine its load.
typedef struct bearing {
	double young_pa, limit_pa;
	double free[3];          // largest stretches below the strain limit, along the material axes
	double tear_j_m2;        // the element's share of G_c
	double coagulated_share; // share of tear_j_m2 that remains if the element is coagulated
} bearing;

// Share of the released energy that one element at the tip of a cut stores over its size: by kind
// of primitive. The shares were measured on strips of known energy, of triangles and of tetrahedra,
// within 4 % on three meshes (tests/core/session/tear_test.c). A fibre has no tip: it stores all
// the energy that it releases.
static const double share_of[CAU_PRIMITIVE_KINDS] = {0.4, 0.4, 1};

static void free_stretches(double out[3], int limit, const double *strain_max, int count)
{
	for (int i = 0; i < 3; i++)
		out[i] = limit == CAU_LIMIT_RANGE && i < count ? 1 + strain_max[i] : 1;
}

static bearing bearing_of(const cau_tissue *tissue, int primitive, int32_t index)
{
	double energy = cau_dissection_heat_of(tissue, primitive, index)->tear_energy_j_m2;
	int32_t layer = cau_tissue_layer_of(tissue, primitive, index);
	bearing b = {.tear_j_m2 = share_of[primitive] * energy,
	             .coagulated_share = tissue->layer[layer].def.coagulated_tear,
	             .free = {1, 1, 1}};
	if (b.tear_j_m2 == 0)
		return b;
	if (primitive == CAU_PRIMITIVE_TRIANGLE) {
		const cau_sheet_material *sheet = cau_triangle_material(tissue, index);
		b.limit_pa = sheet->limit_stiffness_pa;
		free_stretches(b.free, sheet->limit, sheet->strain_max, 2);
	} else if (primitive == CAU_PRIMITIVE_TETRAHEDRON) {
		const cau_fat_material *fat = cau_tetrahedron_material(tissue, index);
		b.young_pa = fat->young_modulus_pa;
		b.limit_pa = fat->limit != CAU_LIMIT_NONE ? fat->limit_stiffness_pa : 0;
		free_stretches(b.free, fat->limit, fat->strain_max, 3);
	} else {
		b.young_pa = tissue->layer[tissue->link_layer[index]].def.link.young_modulus_pa;
	}
	return b;
}

// Computes F^T F in the material axes: 00, 11, 22, 01, 02, 12. Entries of axes that the element
// does not have are 0. A link has only its squared stretch.
static void metric_of(const cau_tissue *tissue, int primitive, int32_t index,
                      const double *position, double metric[6])
{
	int count;
	const int32_t *v = cau_tissue_vertices_of(tissue, primitive, index, &count);
	cau_vec3 origin = cau_vec3_of(position + 3 * (size_t)v[0]);
	cau_vec3 f[3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
	int rank = count - 1;
	double whole = primitive == CAU_PRIMITIVE_LINK ? 1 / tissue->link_length[index] : 0;
	const double *inverse = primitive == CAU_PRIMITIVE_TRIANGLE
	                            ? tissue->triangle_dm_inverse + 4 * (size_t)index
	                        : primitive == CAU_PRIMITIVE_TETRAHEDRON
	                            ? tissue->tetrahedron_dm_inverse + 9 * (size_t)index
	                            : &whole;
	for (int i = 0; i < rank; i++) {
		cau_vec3 edge = cau_sub(cau_vec3_of(position + 3 * (size_t)v[i + 1]), origin);
		for (int c = 0; c < rank; c++)
			f[c] = cau_add_scaled(f[c], inverse[rank * i + c], edge);
	}
	static const int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
	for (int k = 0; k < 6; k++)
		metric[k] = cau_dot(f[row[k]], f[column[k]]);
}

static double square_above(double stretch, double free)
{
	return stretch > free ? (stretch - free) * (stretch - free) : 0;
}

// Returns psi, J/m^3.
static double stored_energy(const bearing *b, const double metric[6])
{
	double value[3], axis[3][3], twice = 0;
	cau_symmetric_eigen3(metric, value, axis);
	for (int k = 0; k < 3; k++) {
		double stretch = sqrt(fmax(value[k], 0)), free = 0;
		for (int i = 0; i < 3; i++)
			free += axis[i][k] * axis[i][k] * b->free[i] * b->free[i];
		twice += b->young_pa * square_above(stretch, 1) +
		         b->limit_pa * square_above(stretch, sqrt(free));
	}
	return twice / 2;
}

// Returns the stored energy density, J/m^3, at which an element of size_m has the load 1 and is
// overloaded.
static double borne_j_m3(const bearing *b, double size_m)
{
	return b->tear_j_m2 / size_m;
}

// Returns a limit for the sum of squared stretches. Below the limit, no element of a size up to
// widest_m can have a load of 1. For a given sum, psi is largest if all of the stretch is along one
// axis.
static double least_squared(const bearing *b, double widest_m)
{
	double borne = b->coagulated_share * borne_j_m3(b, widest_m);
	double most = 1 + sqrt(2 * borne / (b->young_pa + b->limit_pa));
	return most * most;
}

double cau_dissection_coagulated(const cau_dissection *dissection, int primitive, int32_t index)
{
	int count, edges = 0;
	const int32_t *v = cau_tissue_vertices_of(dissection->tissue, primitive, index, &count);
	double sum = 0;
	for (int i = 0; i < count; i++)
		for (int j = i + 1; j < count; j++) {
			int32_t edge = cau_edge_table_find(&dissection->tissue->edges, v[i], v[j]);
			CAU_ASSERT(edge >= 0, "element %d of kind %d lacks an edge", index, primitive);
			sum += fmin(2 * cau_dissection_heated(dissection, edge), 1);
			edges++;
		}
	return sum / edges;
}

// Returns the present G_c of the element as a share of the G_c of a fresh element.
static double strength_of(const cau_dissection *dissection, const bearing *b, int primitive,
                          int32_t index)
{
	double lost = 1 - b->coagulated_share;
	return lost > 0 ? 1 - lost * cau_dissection_coagulated(dissection, primitive, index) : 1;
}

static double load_of(const cau_dissection *dissection, const bearing *b, int primitive,
                      int32_t index, const double *position)
{
	double metric[6];
	const cau_tissue *tissue = dissection->tissue;
	metric_of(tissue, primitive, index, position, metric);
	return stored_energy(b, metric) / (borne_j_m3(b, size_of(tissue, primitive, index)) *
	                                   strength_of(dissection, b, primitive, index));
}

// ---- find overloaded elements

// Elements of one layer that can tear, and the first part of the loop that examines them.
typedef struct tearing {
	int primitive;
	int32_t first, count, first_part;
} tearing;

typedef struct looking {
	cau_dissection *dissection;
	const double *position;
	int32_t part_count, range_count;
	tearing range[CAU_MAX_LAYERS];
} looking;

// Returns the sum of the squared stretches, by a fast formula: most elements are far from overload.
static double squared_stretches(const cau_tissue *tissue, int primitive, int32_t index,
                                const double *position)
{
	if (primitive != CAU_PRIMITIVE_TRIANGLE) {
		double metric[6];
		metric_of(tissue, primitive, index, position, metric);
		return metric[0] + metric[1] + metric[2];
	}
	const int32_t *v = tissue->triangle + 3 * (size_t)index;
	const double *m = tissue->triangle_dm_inverse + 4 * (size_t)index;
	cau_vec3 origin = cau_vec3_of(position + 3 * (size_t)v[0]);
	cau_vec3 a = cau_sub(cau_vec3_of(position + 3 * (size_t)v[1]), origin);
	cau_vec3 b = cau_sub(cau_vec3_of(position + 3 * (size_t)v[2]), origin);
	return (m[0] * m[0] + m[1] * m[1]) * cau_dot(a, a) +
	       2 * (m[0] * m[2] + m[1] * m[3]) * cau_dot(a, b) +
	       (m[2] * m[2] + m[3] * m[3]) * cau_dot(b, b);
}

static int32_t material_of(const cau_tissue *tissue, int primitive, int32_t index)
{
	return primitive == CAU_PRIMITIVE_TRIANGLE      ? tissue->triangle_material[index]
	       : primitive == CAU_PRIMITIVE_TETRAHEDRON ? tissue->tetrahedron_material[index]
	                                                : 0;
}

static void look_at_part(void *context, int32_t part)
{
	const looking *work = context;
	const cau_tissue *tissue = work->dissection->tissue;
	cau_tears *tears = &work->dissection->tears;
	const tearing *range = work->range + work->range_count - 1;
	for (; range->first_part > part; range--)
		;
	int32_t first = range->first + (part - range->first_part) * PART, found = 0, material = -1;
	int32_t end = range->first + range->count, last = first + PART < end ? first + PART : end;
	int32_t before = range->primitive == CAU_PRIMITIVE_TRIANGLE ? 0 : tissue->triangle_count;
	before += range->primitive == CAU_PRIMITIVE_LINK ? tissue->tetrahedron_count : 0;
	bearing b = {0};
	double least = 0;
	for (int32_t index = first; index < last; index++) {
		if (!cau_dissection_lives(work->dissection, range->primitive, index))
			continue;
		if (material_of(tissue, range->primitive, index) != material) {
			material = material_of(tissue, range->primitive, index);
			b = bearing_of(tissue, range->primitive, index);
			least =
				b.tear_j_m2 > 0 ? least_squared(&b, tears->widest_m[range->primitive]) : HUGE_VAL;
		}
		if (!(squared_stretches(tissue, range->primitive, index, work->position) >= least))
			continue;
		double load = load_of(work->dissection, &b, range->primitive, index, work->position);
		if (!(load >= 1))
			continue;
		tears->now[part * PART + found] = before + index;
		tears->load[part * PART + found++] = load;
	}
	tears->found[part] = found;
}

static bool bears_all(const cau_tissue_layer *layer)
{
	for (int32_t m = 0; m < layer->def.material_count; m++)
		if (cau_layer_heat(layer, m)->tear_energy_j_m2 > 0)
			return false;
	return true;
}

static void add_range(looking *work, int primitive, int32_t first, int32_t count)
{
	if (!count)
		return;
	CAU_ASSERT_INDEX(work->range_count, CAU_MAX_LAYERS);
	work->range[work->range_count++] = (tearing){primitive, first, count, work->part_count};
	work->part_count += (count + PART - 1) / PART;
}

// Lists the ranges in the order of indices: triangles of all layers, then tetrahedra, then links.
static void list_ranges(looking *work)
{
	const cau_tissue *tissue = work->dissection->tissue;
	for (int primitive = 0; primitive < CAU_PRIMITIVE_KINDS; primitive++)
		for (int32_t i = 0; i < tissue->layer_count; i++) {
			const cau_tissue_layer *l = &tissue->layer[i];
			if (bears_all(l))
				continue;
			if (primitive == CAU_PRIMITIVE_TRIANGLE)
				add_range(work, primitive, l->first_triangle, l->triangle_count);
			else if (primitive == CAU_PRIMITIVE_TETRAHEDRON)
				add_range(work, primitive, l->first_tetrahedron, l->tetrahedron_count);
			else
				add_range(work, primitive, l->first_link, l->link_count);
		}
}

// Fills `now` and `load` in the order of indices. Returns the number of overloaded elements.
static int32_t look(cau_dissection *dissection, const double *position, cau_pool *pool)
{
	looking work = {.dissection = dissection, .position = position};
	cau_tears *tears = &dissection->tears;
	int32_t count = 0;
	list_ranges(&work);
	CAU_ASSERT(work.part_count <= CAU_POOL_PARTS, "%d parts", work.part_count);
	cau_pool_run(pool, work.part_count, look_at_part, &work);
	for (int32_t part = 0; part < work.part_count; part++)
		for (int32_t k = 0; k < tears->found[part]; k++, count++) {
			tears->now[count] = tears->now[part * PART + k];
			tears->load[count] = tears->load[part * PART + k];
		}
	return count;
}

// ---- choose the elements that tear

// Stores the `count` overloaded elements in `over`, with their counts so far. Keeps in `now` only
// the elements whose count is high enough to tear. Returns the number of elements in `now`.
static int32_t count_over(cau_tears *tears, int32_t count, bool converged)
{
	int32_t ready = 0, before = tears->over_count, at = 0;
	cau_over *kept = tears->over;
	tears->over = tears->before;
	tears->before = kept;
	tears->over_count = count;
	for (int32_t k = 0; k < count; k++) {
		int32_t place = tears->now[k], counted = converged ? COUNTS_CONVERGED : COUNTS_AT_ALL;
		while (at < before && kept[at].place < place)
			at++;
		if (at < before && kept[at].place == place)
			counted += kept[at].counted;
		tears->over[k] = (cau_over){place, counted < TAKES ? counted : TAKES};
		if (counted < TAKES)
			continue;
		tears->now[ready] = place;
		tears->load[ready++] = tears->load[k];
	}
	return ready;
}

// Stores for each vertex the most loaded element there, as 1 + its index in `now`. Of equally
// loaded elements, the first is stored.
static void mark_most(cau_dissection *dissection, int32_t count)
{
	cau_tears *tears = &dissection->tears;
	for (int32_t k = 0; k < count; k++) {
		int32_t index;
		int corners, primitive = primitive_at(dissection->tissue, tears->now[k], &index);
		const int32_t *v = cau_tissue_vertices_of(dissection->tissue, primitive, index, &corners);
		for (int i = 0; i < corners; i++) {
			int32_t best = tears->most[v[i]];
			if (!best || tears->load[k] > tears->load[best - 1])
				tears->most[v[i]] = k + 1;
		}
	}
}

static bool is_most(const cau_dissection *dissection, int32_t k)
{
	int32_t index;
	int corners, primitive = primitive_at(dissection->tissue, dissection->tears.now[k], &index);
	const int32_t *v = cau_tissue_vertices_of(dissection->tissue, primitive, index, &corners);
	for (int i = 0; i < corners; i++)
		if (dissection->tears.most[v[i]] != k + 1)
			return false;
	return true;
}

static void forget_most(cau_dissection *dissection, int32_t count)
{
	for (int32_t k = 0; k < count; k++) {
		int32_t index;
		int corners, primitive = primitive_at(dissection->tissue, dissection->tears.now[k], &index);
		const int32_t *v = cau_tissue_vertices_of(dissection->tissue, primitive, index, &corners);
		for (int i = 0; i < corners; i++)
			dissection->tears.most[v[i]] = 0;
	}
}

// Returns the edge with the largest stretch: its length over its length at rest.
static int32_t longest_edge(const cau_dissection *dissection, int primitive, int32_t index,
                            const double *position)
{
	const cau_tissue *tissue = dissection->tissue;
	int corners, at[2] = {0, 1};
	double most = 0;
	const int32_t *v = cau_tissue_vertices_of(tissue, primitive, index, &corners);
	for (int i = 0; i < corners; i++)
		for (int j = 0; j < i; j++) {
			size_t a = 3 * (size_t)v[i], b = 3 * (size_t)v[j];
			double stretch =
				cau_length(cau_sub(cau_vec3_of(position + a), cau_vec3_of(position + b))) /
				cau_length(cau_sub(cau_vec3_of(tissue->rest + a), cau_vec3_of(tissue->rest + b)));
			if (stretch > most)
				most = stretch, at[0] = i, at[1] = j;
		}
	int32_t edge = cau_edge_table_find(&tissue->edges, v[at[0]], v[at[1]]);
	CAU_ASSERT(edge >= 0, "element %d of kind %d has no edge", index, primitive);
	return edge;
}

static void tear(cau_dissection *dissection, int32_t place, const double *position)
{
	const cau_tissue *tissue = dissection->tissue;
	int32_t index;
	int primitive = primitive_at(tissue, place, &index);
	if (!cau_dissection_lives(dissection, primitive, index))
		return; // removed with an edge that has just torn
	int32_t layer = cau_tissue_layer_of(tissue, primitive, index);
	if (dissection->doses.dose && primitive != CAU_PRIMITIVE_LINK)
		cau_doses_lose(dissection, primitive, index);
	else
		cau_dissection_lose_edge(dissection, longest_edge(dissection, primitive, index, position),
		                         (uint16_t)(1u << layer));
}

void cau_dissection_tear(cau_dissection *dissection, const double *position, bool converged,
                         cau_pool *pool)
{
	cau_tears *tears = &dissection->tears;
	int32_t removed = dissection->elements_removed;
	int32_t count = count_over(tears, look(dissection, position, pool), converged);
	mark_most(dissection, count);
	for (int32_t k = 0; k < count; k++)
		if (is_most(dissection, k))
			tear(dissection, tears->now[k], position);
	forget_most(dissection, count);
	tears->elements_torn += dissection->elements_removed - removed;
}
