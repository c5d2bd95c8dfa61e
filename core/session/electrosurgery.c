// SPDX-License-Identifier: GPL-3.0-or-later
// Energy `tissue` (core/bioheat). A generator's current heats the tissue around a tool and boils
// its water. Sparks remove cells that have lost much of it. An element parts when its cells no
// longer join its vertices.
#include <string.h>

#include "bioheat/current.h"
#include "cautery/assert.h"
#include "session/session_internal.h"

enum {
	CELLS_MOST = 1 << 16,
	ADDED_A_TICK = 1000, // most cells that a tick adds; this takes half a millisecond
	// Number of cells from which on no more cells are added where heat spreads. The remaining
	// capacity is for cells near tools.
	FOLLOWED_MOST = CELLS_MOST / 4 * 3,
	FOLLOW_TURNS = 60, // ticks in which each element is visited once; heat is slow
	ITERATIONS = 60,   // most iterations for the potential, from that of the last tick
};

static const double filled_m = 3e-3; // elements nearer than this to a hot part get cells
// Elements nearer than this to a hot part get cells in this tick, beyond ADDED_A_TICK.
static const double urgent_m = 1e-3;
// Distance, m, around an electrode within which cells carry its current.
static const double reach_m = 3e-3;
static const double residual_most = 1e-3; // largest residual of the potential
static const double spark_v = 200;   // peak voltage above which a metal electrode sparks to tissue
static const double spark_v_m = 3e6; // breakdown field of air, V/m
// Least conductance, S, that a generator measures as a load. At this conductance the largest
// voltage of any generator, 10 kV, would give 0.1 mW.
static const double least_conductance_s = 1e-12;
// Radius, m, of the spot through which an arc enters tissue. No measurement was found. Most of the
// resistance and most of the heat are at the spot.
static const double spot_m = 1e-4;
static const double cold_k = 0.01; // K: a blade closer to the surroundings counts as cold
// Temperature above the surroundings, K. The neighbours of tissue that is warmer get cells too.
static const double warm_k = 3;
// Share of the water that tissue still has when it bursts. No measurement was found. Steam in
// tissue that holds 1 MPa has 180 degC. When the pressure is released, a sixth of such water boils
// at once. At the other extreme all water has boiled. A half is between the two.
static const double burst_share = 0.5;

// ---- blades

// Defaults of the hot part for tools whose definition has 0: heat capacity of the metal, J/K, and
// conductance along the shaft, W/K. A steel wire of 1 mm and 10 mm length has 0.03 J/K. Jaws have
// more than 100 mm^3 of metal.
static const struct {
	double heat_capacity_j_k, cooling_w_k;
} blades[CAU_TOOL_SHAPE_COUNT] = {
	[CAU_TOOL_SPHERE] = {0.4, 4e-3},  [CAU_TOOL_CAPSULE] = {0.05, 2e-3},
	[CAU_TOOL_HOOK] = {0.05, 2e-3},   [CAU_TOOL_SPATULA] = {0.1, 3e-3},
	[CAU_TOOL_BIPOLAR] = {0.5, 1e-2}, [CAU_TOOL_SHEARS] = {0.5, 1.5e-2},
	[CAU_TOOL_GRASPER] = {0.5, 1e-2},
};

cau_blade cau_session_blade_of(const cau_session *session, const cau_tool_def *def)
{
	CAU_ASSERT_INDEX(def->shape, CAU_TOOL_SHAPE_COUNT);
	double heat_j_k = def->blade_heat_j_k, cooling_w_k = def->blade_cooling_w_k;
	return (cau_blade){
		.temperature_c = session->scene->ambient_c,
		.heat_capacity_j_k = heat_j_k > 0 ? heat_j_k : blades[def->shape].heat_capacity_j_k,
		.cooling_w_k = cooling_w_k > 0 ? cooling_w_k : blades[def->shape].cooling_w_k};
}

cau_status cau_session_make_cells(cau_session *session, cau_error *error)
{
	const cau_scene_def *scene = session->scene;
	if (scene->energy != CAU_ENERGY_TISSUE)
		return CAU_OK;
	session->heat.cells = cau_arena_array(&session->memory.arena, 1, sizeof *session->heat.cells);
	if (!session->heat.cells)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for cells of tissue");
	return cau_tissue_cells_create(session->heat.cells, &session->tissue, scene->cell_m, CELLS_MOST,
	                               scene->ambient_c, &session->memory.arena, error);
}

double cau_session_coagulated(const cau_session *session)
{
	double volume_m3 = 0;
	const cau_bioheat *bioheat = session->heat.cells ? &session->heat.cells->bioheat : NULL;
	for (int32_t i = 0; bioheat && i < bioheat->cells.count; i++)
		if (bioheat->damage[i] >= 1 && !bioheat->cells.severed[i])
			volume_m3 += cau_cells_volume(&bioheat->cells, i);
	return volume_m3;
}

double cau_session_vaporised(const cau_session *session)
{
	double volume_m3 = 0;
	const cau_bioheat *bioheat = session->heat.cells ? &session->heat.cells->bioheat : NULL;
	for (int32_t i = 0; bioheat && i < bioheat->cells.count; i++)
		if (bioheat->cells.severed[i] && bioheat->water[i] <= burst_share)
			volume_m3 += cau_cells_volume(&bioheat->cells, i);
	return volume_m3;
}

double cau_session_vapour(const cau_session *session)
{
	return session->heat.cells ? cau_bioheat_vapour(&session->heat.cells->bioheat) : 0;
}

void cau_session_read_ledger(const cau_session *session, cau_energy_ledger *ledger)
{
	*ledger = session->heat.cells ? session->heat.cells->bioheat.ledger : (cau_energy_ledger){0};
}

bool cau_session_has_cooled(const cau_session *session)
{
	if (!session->heat.cells)
		return true;
	for (int32_t i = 0; i < session->tool_count; i++)
		if (fabs(session->tool[i].blade.temperature_c - session->scene->ambient_c) > cold_k)
			return false;
	return session->heat.cells->bioheat.cold;
}

// ---- distances from a tool

static bool has_hot_part(const cau_tool *tool)
{
	return tool->state.definition.shape != CAU_TOOL_GRASPER;
}

static bool is_bipolar(const cau_tool *tool)
{
	return tool->state.definition.shape == CAU_TOOL_BIPOLAR;
}

static double hot_distance(const cau_tool *tool, cau_vec3 point)
{
	return cau_tool_distance_at(&tool->state.definition, &tool->state.pose, tool->state.jaw,
	                            CAU_PART_HOT, point, NULL);
}

// Returns the largest distance of a cell's middle from metal that touches the cell: half a cell,
// and a fiftieth of that for rounding.
static double reach_of_metal_m(const cau_session *session)
{
	return 0.51 * session->scene->cell_m;
}

// Returns the distance from the hot part within which metal or sparks reach a cell's middle.
static double touch_m(const cau_session *session, const cau_tool *tool)
{
	double peak_v = tool->state.definition.peak_v;
	return reach_of_metal_m(session) + (peak_v >= spark_v ? peak_v / spark_v_m : 0);
}

// ---- cells around a tool

// State of a visit to the edges near a tool's hot part. The elements of these edges get cells.
typedef struct edge_visit {
	cau_session *session;
	int32_t left; // cells that may still be added in this tick to elements that are not urgent
	bool full;    // the capacity of cells is reached
	cau_vec3 least, most; // box, at rest, around the ends of the edges
} edge_visit;

static bool lives(const cau_session *session, int32_t element)
{
	int32_t index;
	int primitive = cau_tissue_cells_primitive(&session->tissue, element, &index);
	return session->dissection.alive.element[primitive][index];
}

static void grow(edge_visit *visit, cau_vec3 at)
{
	visit->least = (cau_vec3){fmin(visit->least.x, at.x), fmin(visit->least.y, at.y),
	                          fmin(visit->least.z, at.z)};
	visit->most =
		(cau_vec3){fmax(visit->most.x, at.x), fmax(visit->most.y, at.y), fmax(visit->most.z, at.z)};
}

// Gives cells to the elements at the edge. `urgent`: heat or sparks may reach them in the next
// ticks.
static void fill_sharers(edge_visit *visit, int32_t edge, bool urgent)
{
	cau_session *session = visit->session;
	const cau_edge_table *edges = &session->tissue.edges;
	const cau_cells *grid = &session->heat.cells->bioheat.cells;
	for (int p = 0; p < CAU_PRIMITIVE_KINDS; p++)
		for (int32_t k = edges->first[p][edge]; k < edges->first[p][edge + 1]; k++) {
			int32_t index = edges->sharer[p][k], before = grid->count;
			if (!session->dissection.alive.element[p][index] || visit->full ||
			    (visit->left <= 0 && !urgent))
				continue;
			visit->full = !cau_tissue_cells_fill(
				session->heat.cells, cau_tissue_cells_element(&session->tissue, p, index));
			visit->left -= grid->count - before;
		}
}

// Shows the heat of an edge as an exposure: 0.5 for coagulated tissue, rising to 1 for dry or
// removed tissue.
static void show_heat(cau_session *session, int32_t edge)
{
	const int32_t *end = session->tissue.edges.vertex + 2 * (size_t)edge;
	const cau_bioheat *bioheat = &session->heat.cells->bioheat;
	int32_t cell = cau_tissue_cells_between(session->heat.cells, end[0], end[1]);
	if (cell < 0)
		return;
	double coagulated = fmin(bioheat->damage[cell], 1) / 2, dried = 1 - bioheat->water[cell];
	cau_dissection_show_heated(&session->dissection, edge,
	                           bioheat->cells.severed[cell] ? 1 : fmax(coagulated, dried));
}

static void visit_edge(edge_visit *visit, const cau_tool *tool, int32_t edge)
{
	cau_session *session = visit->session;
	const int32_t *end = session->tissue.edges.vertex + 2 * (size_t)edge;
	cau_vec3 a = cau_vec3_of(session->vertices.position + 3 * (size_t)end[0]);
	cau_vec3 b = cau_vec3_of(session->vertices.position + 3 * (size_t)end[1]);
	cau_vec3 middle = cau_scale(0.5, cau_add(a, b));
	double half = cau_length(cau_sub(b, a)) / 2;
	double distance = hot_distance(tool, middle) - half;
	if (distance > filled_m)
		return;
	fill_sharers(visit, edge, distance <= urgent_m);
	show_heat(session, edge);
	grow(visit, cau_vec3_of(session->tissue.rest + 3 * (size_t)end[0]));
	grow(visit, cau_vec3_of(session->tissue.rest + 3 * (size_t)end[1]));
}

// Gives cells to elements near the tool, a limited number in a tick, and finds their box at rest.
static edge_visit look_around(cau_session *session, const cau_tool *tool)
{
	edge_visit visit = {.session = session,
	                    .left = ADDED_A_TICK,
	                    .least = {INFINITY, INFINITY, INFINITY},
	                    .most = {-INFINITY, -INFINITY, -INFINITY}};
	double radius;
	cau_vec3 center;
	cau_tool_bound(&tool->state.definition, CAU_PART_HOT, &center, &radius);
	center = cau_pose_to_world(&tool->state.pose, center);
	const cau_near *near = &session->heat.near;
	for (int32_t block = 0; block < near->block_count; block++) {
		if (!cau_box_meets(&near->edge_box[block], center, radius + filled_m))
			continue;
		for (int32_t k = near->edge_first[block]; k < near->edge_first[block + 1]; k++)
			visit_edge(&visit, tool, near->edge[k]);
	}
	return visit;
}

static void follow_element(edge_visit *visit, int32_t element)
{
	cau_session *session = visit->session;
	int32_t index, count;
	int primitive = cau_tissue_cells_primitive(&session->tissue, element, &index);
	const int32_t *vertex = cau_tissue_vertices_of(&session->tissue, primitive, index, &count);
	double temperature[4], warm_c = session->scene->ambient_c + warm_k;
	CAU_ASSERT(count <= 4, "an element of %d corners", count);
	for (int i = 0; i < count; i++)
		temperature[i] = cau_tissue_cells_temperature(session->heat.cells, vertex[i]);
	for (int i = 0; i < count; i++)
		for (int j = i + 1; j < count; j++) {
			if (temperature[i] <= warm_c && temperature[j] <= warm_c)
				continue;
			int32_t edge = cau_edge_table_find(&session->tissue.edges, vertex[i], vertex[j]);
			fill_sharers(visit, edge, false);
			show_heat(session, edge);
		}
	if (primitive != CAU_PRIMITIVE_LINK)
		cau_shrink_denatured(&session->shrink, &session->dissection, primitive, index, temperature,
		                     &session->solver.elements, &session->solver.slots);
}

// Gives cells to the elements that share an edge with a warm element. Without that, heat could not
// spread farther than 3 mm from the tool. Denatured elements begin to shrink.
static void follow_heat(cau_session *session)
{
	const cau_tissue_cells *cells = session->heat.cells;
	edge_visit visit = {.session = session, .left = ADDED_A_TICK};
	int32_t known = cells->filled_count;
	for (int32_t k = (int32_t)(session->tick % FOLLOW_TURNS); k < known; k += FOLLOW_TURNS)
		if (lives(session, cells->filled[k])) {
			visit.full = visit.full || cells->bioheat.cells.count >= FOLLOWED_MOST;
			follow_element(&visit, cells->filled[k]);
		}
}

static bool is_in_box(const cau_cells *grid, int32_t cell, const edge_visit *visit)
{
	const int32_t *place = grid->place + cau_cell_axis(cell, 0);
	double side = grid->side_m;
	return place[0] * side <= visit->most.x && (place[0] + 1) * side >= visit->least.x &&
	       place[1] * side <= visit->most.y && (place[1] + 1) * side >= visit->least.y &&
	       place[2] * side <= visit->most.z + side && (place[2] + 2) * side >= visit->least.z;
}

// Returns area over length, m, of the tissue between an electrode and the middle of a cell that
// touches the electrode: half a cell.
static double contact_over_length(const cau_session *session, int32_t cell, double distance_m)
{
	double side = session->scene->cell_m;
	return side * side * session->heat.cells->bioheat.cells.fill[cell] / fmax(distance_m, side / 2);
}

// Adds a cell to the contacts of tool `index`, if its hot part or its sparks reach the cell.
static void touch_cell(cau_session *session, int32_t index, int32_t cell)
{
	const cau_tool *tool = &session->tool[index];
	cau_bioheat *bioheat = &session->heat.cells->bioheat;
	cau_current *current = &session->heat.cells->current;
	cau_vec3 at = cau_tissue_cells_at(session->heat.cells, cell, session->vertices.position);
	double distance = hot_distance(tool, at);
	if (distance > touch_m(session, tool))
		return;
	double over = contact_over_length(session, cell, distance);
	double right = cau_pose_to_local(&tool->state.pose, at).x;
	current->electrode[current->electrode_count++] = (cau_electrode_cell){
		.cell = cell, .over_length_m = over, .potential = is_bipolar(tool) && right < 0 ? 0 : 1};
	// Sparks reach farther than the distance over which heat flows from metal to tissue.
	bool pressed = distance <= reach_of_metal_m(session);
	if (bioheat->contact_count < bioheat->cells.capacity)
		bioheat->contact[bioheat->contact_count++] =
			(cau_contact_cell){.blade = index, .cell = cell, .over_length_m = pressed ? over : 0};
}

// Number of ticks in which the pull-back of every cell is updated once. Each tick updates every
// eighth cell, because deformation changes little from tick to tick.
enum { STRETCH_TURNS = 8 };

// Arcs jump to all cells within their reach. Averaged over a tick, the cells share one spot
// equally.
static void strike(cau_current *current)
{
	for (int32_t k = 0; k < current->electrode_count; k++)
		current->electrode[k].over_length_m = 4 * spot_m / current->electrode_count;
}

// Whether the tool may reach a cell of the element.
static bool may_reach(const cau_session *session, const cau_tool *tool, int32_t element)
{
	double radius, reach = touch_m(session, tool);
	cau_vec3 middle;
	cau_tissue_cells_bound(session->heat.cells, element, session->vertices.position, &middle,
	                       &radius);
	return hot_distance(tool, middle) <= radius + reach;
}

// Finds the cells that tool `index` touches or reaches by sparks. Most elements have their cells
// one after another, so each element is tested only once.
static void find_touched(cau_session *session, int32_t index, const edge_visit *visit)
{
	cau_tissue_cells *cells = session->heat.cells;
	const cau_cells *grid = &cells->bioheat.cells;
	int32_t owner = -1;
	bool reached = false;
	cells->current.electrode_count = 0;
	for (int32_t cell = 0; cell < grid->count; cell++) {
		if (grid->severed[cell] || !is_in_box(grid, cell, visit))
			continue;
		if ((uint64_t)cell % STRETCH_TURNS == session->tick % STRETCH_TURNS)
			cau_tissue_cells_stretch(cells, cell, session->vertices.position);
		if (cells->owner[cell] != owner) {
			owner = cells->owner[cell];
			reached = may_reach(session, &session->tool[index], owner);
		}
		if (reached)
			touch_cell(session, index, cell);
	}
}

// ---- power

// Heats an ultrasonic blade by the friction of the tissue at the blade.
static void rub(const cau_session *session, cau_tool *tool)
{
	double power =
		session->heat.cells->current.electrode_count ? tool->state.definition.power_w : 0;
	tool->blade.temperature_c += power * session->solver.step_s / tool->blade.heat_capacity_j_k;
	tool->state.delivered_w = power;
}

// Whether an advanced bipolar generator has ended. As tissue dries, its load rises above the least
// load. The generator ends at the rise load_rise_off, and stays off until energy goes off and on
// again.
static bool has_ended(const cau_tool *tool)
{
	return tool->state.definition.load_rise_off > 0 && tool->least_ohm < 0;
}

// Whether the tool's generator, mode and shape produce sparks now.
static bool sparks(const cau_tool *tool)
{
	return tool->state.energized && !has_ended(tool) && tool->state.definition.peak_v >= spark_v &&
	       tool->state.definition.shape != CAU_TOOL_SHEARS && !is_bipolar(tool);
}

static void give_power(cau_session *session, cau_tool *tool)
{
	const cau_tool_def *def = &tool->state.definition;
	cau_current *current = &session->heat.cells->current;
	cau_bioheat *bioheat = &session->heat.cells->bioheat;
	cau_generator generator = {.power_w = def->power_w,
	                           .peak_v = def->peak_v,
	                           .current_a = def->current_max_a,
	                           .crest_factor = def->crest_factor};
	if (sparks(tool))
		strike(current);
	cau_current_solve(current, bioheat, reach_m, !is_bipolar(tool), residual_most, ITERATIONS);
	cau_output output = cau_generator_into(&generator, fmax(current->conductance_s, 0));
	cau_current_heat(current, bioheat, output.voltage_v);
	double far_w = current->far_w * output.voltage_v * output.voltage_v;
	bioheat->ledger.far_j += far_w * session->solver.step_s;
	tool->state.delivered_w = output.power_w - far_w;
	double conductance_s = current->conductance_s;
	tool->state.load_ohm = conductance_s > least_conductance_s ? 1 / conductance_s : 0;
}

static void follow_load(cau_tool *tool)
{
	double ohm = tool->state.load_ohm, rise = tool->state.definition.load_rise_off;
	if (rise <= 0 || ohm <= 0)
		return;
	if (tool->least_ohm <= 0 || ohm < tool->least_ohm)
		tool->least_ohm = ohm;
	else if (ohm >= rise * tool->least_ohm)
		tool->least_ohm = -1;
}

static void energize(cau_session *session, cau_tool *tool)
{
	tool->state.delivered_w = tool->state.load_ohm = 0;
	if (!tool->state.energized || has_ended(tool))
		return;
	if (tool->state.definition.shape == CAU_TOOL_SHEARS) {
		rub(session, tool);
	} else if (session->heat.cells->current.electrode_count) {
		give_power(session, tool);
		follow_load(tool);
	}
}

// ---- removal

// Removes the cells within reach of sparks that have lost enough water. Returns whether there were
// any, and the box of their grid positions.
static bool vaporise(cau_session *session, int32_t least[3], int32_t most[3])
{
	cau_bioheat *bioheat = &session->heat.cells->bioheat;
	bool any = false;
	for (int32_t k = 0; k < bioheat->contact_count; k++) {
		int32_t cell = bioheat->contact[k].cell;
		if (!sparks(&session->tool[bioheat->contact[k].blade]) ||
		    bioheat->water[cell] > burst_share || bioheat->cells.severed[cell])
			continue;
		for (int axis = 0; axis < 3; axis++) {
			int32_t at = bioheat->cells.place[cau_cell_axis(cell, axis)];
			least[axis] = any && least[axis] < at ? least[axis] : at;
			most[axis] = any && most[axis] > at ? most[axis] : at;
		}
		cau_bioheat_take_out(bioheat, cell);
		any = true;
	}
	return any;
}

static void lose_element(cau_session *session, int32_t element, uint32_t *layers)
{
	int32_t index;
	int primitive = cau_tissue_cells_primitive(&session->tissue, element, &index);
	*layers |= 1u << cau_tissue_layer_of(&session->tissue, primitive, index);
	cau_dissection_lose_element(&session->dissection, primitive, index);
}

// Removes the elements that have cells in the box and whose vertices are no longer joined by cells.
static void part(cau_session *session, const int32_t least[3], const int32_t most[3],
                 uint32_t *layers)
{
	cau_tissue_cells *cells = session->heat.cells;
	for (int32_t k = 0; k < cells->filled_count; k++) {
		int32_t element = cells->filled[k];
		if (lives(session, element) && cau_tissue_cells_meets(cells, element, least, most) &&
		    cau_tissue_cells_separated(cells, element))
			lose_element(session, element, layers);
	}
}

// Reassigns the cells of elements that were removed in this tick, also of torn ones. These cells
// are the lips of the cut: the mesh has lost their elements whole, but they still conduct heat and
// current.
static void keep_lips(cau_session *session)
{
	for (int32_t k = 0; k < session->dissection.removed_count; k++)
		if (session->dissection.removed[k].kind < CAU_PRIMITIVE_KINDS) {
			cau_tissue_cells_reassign(session->heat.cells, session->dissection.alive.element);
			return;
		}
}

// ---- a tick

static void begin(cau_session *session)
{
	cau_bioheat *bioheat = &session->heat.cells->bioheat;
	memset(bioheat->power_w, 0, (size_t)bioheat->cells.count * sizeof *bioheat->power_w);
	bioheat->contact_count = 0;
}

static void heat(cau_session *session)
{
	cau_blade blade[CAU_BLADES];
	_Static_assert((int)CAU_BLADES >= (int)CAU_MAX_TOOLS, "a blade for each tool");
	for (int32_t i = 0; i < session->tool_count; i++)
		blade[i] = session->tool[i].blade;
	bool stepped = cau_bioheat_step(&session->heat.cells->bioheat, blade, session->tool_count,
	                                session->solver.step_s);
	CAU_ASSERT(stepped, "heat needs more than %d parts of a tick", CAU_BIOHEAT_PARTS);
	(void)stepped;
	for (int32_t i = 0; i < session->tool_count; i++) {
		cau_tool *tool = &session->tool[i];
		if (fabs(blade[i].temperature_c - session->scene->ambient_c) <= cold_k)
			blade[i].temperature_c = session->scene->ambient_c;
		tool->blade = blade[i];
		tool->state.tip_temperature_c = blade[i].temperature_c;
		tool->state.energy_j += tool->state.delivered_w * session->solver.step_s;
	}
}

static bool is_idle(const cau_session *session)
{
	for (int32_t i = 0; i < session->tool_count; i++)
		if (session->tool[i].state.energized)
			return false;
	return cau_session_has_cooled(session);
}

void cau_session_operate(cau_session *session)
{
	int32_t first = session->dissection.removed_count, least[3] = {0}, most[3] = {0};
	uint32_t layers = 0;
	if (is_idle(session)) {
		keep_lips(session);
		return;
	}
	begin(session);
	cau_near_refit(&session->heat.near, session->vertices.position);
	for (int32_t i = 0; i < session->tool_count; i++) {
		cau_tool *tool = &session->tool[i];
		if (!has_hot_part(tool))
			continue;
		edge_visit visit = look_around(session, tool);
		find_touched(session, i, &visit);
		energize(session, tool);
	}
	follow_heat(session);
	heat(session);
	if (vaporise(session, least, most))
		part(session, least, most, &layers);
	keep_lips(session);
	cau_session_take_out(session, first);
	for (int32_t i = 0; i < session->tool_count; i++) {
		cau_tool *tool = &session->tool[i];
		tool->state.touched_layers = sparks(tool) ? (int32_t)layers : 0;
	}
}
