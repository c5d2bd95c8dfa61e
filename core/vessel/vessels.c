// SPDX-License-Identifier: GPL-3.0-or-later
#include "vessel/vessels.h"

#include <math.h>
#include <string.h>

#include "base/hash.h"
#include "cautery/assert.h"

// Stations on a length of one radius. A cut can be as thin as a wire, and must not pass between two
// stations.
enum { STATIONS_A_RADIUS = 4 };
static const double least_spacing_m = 1e-4;
// Least weight of a point that is inside a tetrahedron or on its surface, allowing for rounding.
static const double outside = -1e-6;

// Constants of the rate of fusion: ln A, with A in 1/s, and the activation energy. Fusion is the
// loss of birefringence of collagen (rat tail tendon), a first-order reaction with ln A = 130 and
// 89 kcal/mol (Maitland and Walsh 1997).
static const double fusion_log_rate = 130;
static const double fusion_energy_j_mol = 89 * 4184.0;
static const double gas_j_molk = 8.314462618, zero_k = 273.15;
// Tensile strength of two fused walls, Pa. The value is an assumption: a third of the strength of a
// fresh artery, which is about 1.5 MPa. No measurement of a fused wall was found.
static const double fused_pa = 5e5;
// Strain of the width of a round hole, over the strain of the solid around (Kirsch 1898, plane
// stress).
static const double hole_strain = 3;
// Discharge coefficient of an orifice with a sharp edge: the usual value.
static const double discharge = 0.6;
static const double pi = 3.14159265358979323846;

// ---- position of a vessel

// Computes the barycentric coordinates of a point, and returns the least coordinate. Stops early if
// a coordinate is at most `best`.
static double barycentric(const cau_tissue *tissue, int32_t tetrahedron, cau_vec3 at, double best,
                          double weight[4])
{
	const int32_t *vertex = tissue->tetrahedron + 4 * (size_t)tetrahedron;
	const double *inverse = tissue->tetrahedron_dm_inverse + 9 * (size_t)tetrahedron;
	cau_vec3 way = cau_sub(at, cau_vec3_of(tissue->rest + 3 * (size_t)vertex[0]));
	weight[0] = 1;
	double least = 1;
	for (int i = 0; i < 3 && least > best; i++) {
		weight[i + 1] = cau_dot(cau_vec3_of(inverse + 3 * (size_t)i), way);
		weight[0] -= weight[i + 1];
		least = fmin(least, weight[i + 1]);
	}
	return fmin(least, weight[0]);
}

// Finds the tetrahedron of the layer that contains the point. If no tetrahedron contains the point,
// finds the tetrahedron in which the point's least coordinate is greatest. Returns that least
// coordinate.
static double embed(const cau_tissue *tissue, const cau_tissue_layer *layer, cau_vec3 at,
                    cau_tube_point *point)
{
	double best = -INFINITY;
	*point = (cau_tube_point){.tetrahedron = -1, .rest = at};
	int32_t last = layer->first_tetrahedron + layer->tetrahedron_count;
	for (int32_t t = layer->first_tetrahedron; t < last && best < outside; t++) {
		double weight[4], least = barycentric(tissue, t, at, best, weight);
		if (least <= best)
			continue;
		best = least;
		point->tetrahedron = t;
		memcpy(point->weight, weight, sizeof weight);
	}
	return best;
}

static cau_vec3 place(const cau_tissue *tissue, const cau_tube_point *point, const double *position)
{
	const int32_t *vertex = tissue->tetrahedron + 4 * (size_t)point->tetrahedron;
	cau_vec3 at = {0};
	for (int i = 0; i < 4; i++)
		at = cau_add_scaled(at, point->weight[i], cau_vec3_of(position + 3 * (size_t)vertex[i]));
	return at;
}

static void find_across(cau_vec3 along, cau_vec3 across[2])
{
	const cau_vec3 axis = fabs(along.z) < 0.9 ? (cau_vec3){0, 0, 1} : (cau_vec3){1, 0, 0};
	across[0] = cau_unit_or(cau_cross(along, axis), (cau_vec3){0, 1, 0});
	across[1] = cau_cross(along, across[0]);
}

static cau_status make_station(const cau_tissue *tissue, const cau_vessel_def *def, cau_vec3 at,
                               cau_vec3 along, cau_station *station, cau_error *error)
{
	const cau_tissue_layer *layer = &tissue->layer[cau_tissue_find_layer(tissue, def->layer)];
	find_across(along, station->across);
	if (embed(tissue, layer, at, &station->point[0]) < outside)
		return cau_fail(error, CAU_BAD_VALUE, "vessels",
		                "the line of vessel \"%s\" leaves layer \"%s\" at (%.4g, %.4g, %.4g) m",
		                def->name, def->layer, at.x, at.y, at.z);
	double radius = def->radius_m - def->wall_m / 2;
	for (int i = 1; i < CAU_STATION_POINTS; i++) {
		double side = i % 2 ? radius : -radius;
		embed(tissue, layer, cau_add_scaled(at, side, station->across[(i - 1) / 2]),
		      &station->point[i]);
	}
	return CAU_OK;
}

static double spacing_m(const cau_vessel_def *def)
{
	return fmax(def->radius_m / STATIONS_A_RADIUS, least_spacing_m);
}

static double length_m(const cau_vessel_def *def)
{
	double sum = 0;
	for (int32_t i = 1; i < def->point_count; i++)
		sum +=
			cau_length(cau_sub(cau_vec3_of(def->points_m[i]), cau_vec3_of(def->points_m[i - 1])));
	return sum;
}

static int32_t station_count(const cau_vessel_def *def)
{
	return 1 + (int32_t)ceil(length_m(def) / spacing_m(def));
}

// Makes stations at equal distances along the line.
static cau_status make_stations(cau_vessels *vessels, int32_t index, cau_error *error)
{
	const cau_vessel_def *def = &vessels->def[index];
	const cau_vessel *vessel = &vessels->vessel[index];
	double step = length_m(def) / (vessel->count - 1), before = 0;
	int32_t part = 1;
	cau_status status = CAU_OK;
	for (int32_t k = 0; k < vessel->count && !status; k++) {
		cau_vec3 from = cau_vec3_of(def->points_m[part - 1]), to = cau_vec3_of(def->points_m[part]);
		double length = cau_length(cau_sub(to, from));
		while (k * step > before + length && part < def->point_count - 1) {
			before += length;
			from = cau_vec3_of(def->points_m[part]);
			to = cau_vec3_of(def->points_m[++part]);
			length = cau_length(cau_sub(to, from));
		}
		cau_vec3 along = cau_unit_or(cau_sub(to, from), (cau_vec3){1, 0, 0});
		double share = fmin((k * step - before), length);
		status = make_station(vessels->tissue, def, cau_add_scaled(from, share, along), along,
		                      &vessels->station[vessel->first + k], error);
	}
	return status;
}

static cau_status count_stations(cau_vessels *vessels, cau_error *error)
{
	for (int32_t i = 0; i < vessels->vessel_count; i++) {
		const cau_vessel_def *def = &vessels->def[i];
		cau_vessel *vessel = &vessels->vessel[i];
		int32_t layer = cau_tissue_find_layer(vessels->tissue, def->layer);
		if (layer < 0 || vessels->tissue->layer[layer].def.kind != CAU_LAYER_FAT)
			return cau_fail(error, CAU_NOT_FOUND, "vessels",
			                "vessel \"%s\": there is no layer of fat \"%.60s\"", def->name,
			                def->layer);
		if (length_m(def) > spacing_m(def) * CAU_STATIONS_MOST)
			return cau_fail(error, CAU_LIMIT, "vessels",
			                "vessel \"%s\" is too long: it needs more than %d sections, four for "
			                "each radius of length",
			                def->name, CAU_STATIONS_MOST);
		vessel->first = vessels->station_count;
		vessel->count = station_count(def);
		vessels->station_count += vessel->count;
		memcpy(vessel->state.name, def->name, sizeof vessel->state.name);
		vessel->state.radius_m = def->radius_m;
	}
	if (vessels->station_count > CAU_STATIONS_MOST)
		return cau_fail(error, CAU_LIMIT, "vessels",
		                "the vessels need %d sections, at most %d are allowed; a length of one "
		                "radius needs four",
		                vessels->station_count, CAU_STATIONS_MOST);
	return CAU_OK;
}

cau_status cau_vessels_create(cau_vessels *vessels, const cau_tissue *tissue,
                              const cau_scene_def *scene, cau_arena *arena, cau_error *error)
{
	*vessels =
		(cau_vessels){.tissue = tissue, .def = scene->vessels, .vessel_count = scene->vessel_count};
	vessels->vessel =
		cau_arena_array(arena, (size_t)vessels->vessel_count, sizeof *vessels->vessel);
	if (!vessels->vessel)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for vessels");
	cau_status status = count_stations(vessels, error);
	if (status)
		return status;
	size_t count = (size_t)vessels->station_count;
	vessels->station = cau_arena_array(arena, count, sizeof *vessels->station);
	vessels->fusion = cau_arena_array(arena, count, sizeof(double));
	vessels->open = cau_arena_array(arena, count, sizeof(double));
	vessels->parted = cau_arena_array(arena, count, 1);
	vessels->holes = cau_arena_array(arena, count, 1);
	if (!vessels->station || !vessels->fusion || !vessels->open || !vessels->parted ||
	    !vessels->holes)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for vessels");
	status = cau_blood_create(&vessels->blood, tissue, arena, error);
	for (int32_t i = 0; i < vessels->vessel_count && !status; i++)
		status = make_stations(vessels, i, error);
	return status;
}

// ---- present state of each station

static int32_t cell_of(const cau_tissue_cells *cells, const cau_tube_point *point)
{
	double side = cells->bioheat.cells.side_m;
	const int32_t at[] = {(int32_t)floor(point->rest.x / side),
	                      (int32_t)floor(point->rest.y / side),
	                      (int32_t)floor(point->rest.z / side)};
	return cau_cells_find(&cells->bioheat.cells, at);
}

static bool is_gone(const cau_vessel_surroundings *around, const cau_tube_point *point)
{
	if (!around->alive[point->tetrahedron])
		return true;
	int32_t cell = cell_of(around->cells, point);
	return cell >= 0 && around->cells->bioheat.cells.severed[cell];
}

// Returns the open share of the lumen, from the compression of the tissue across the vessel. A
// round hole loses hole_strain times the strain around it.
static double open_share(const cau_tissue *tissue, const cau_station *station,
                         const double *position)
{
	int32_t t = station->point[0].tetrahedron;
	const int32_t *vertex = tissue->tetrahedron + 4 * (size_t)t;
	const double *inverse = tissue->tetrahedron_dm_inverse + 9 * (size_t)t;
	cau_vec3 now[2] = {{0, 0, 0}, {0, 0, 0}},
			 origin = cau_vec3_of(position + 3 * (size_t)vertex[0]);
	for (int i = 0; i < 3; i++) {
		cau_vec3 edge = cau_sub(cau_vec3_of(position + 3 * (size_t)vertex[i + 1]), origin);
		for (int k = 0; k < 2; k++)
			now[k] = cau_add_scaled(
				now[k], cau_dot(cau_vec3_of(inverse + 3 * (size_t)i), station->across[k]), edge);
	}
	double a = cau_dot(now[0], now[0]), b = cau_dot(now[1], now[1]), c = cau_dot(now[0], now[1]);
	double flat2 = (a + b) / 2 - hypot((a - b) / 2, c);
	return fmax(fmin(1 - hole_strain * (1 - sqrt(fmax(flat2, 0))), 1), 0);
}

static void look_at_station(cau_vessels *vessels, int32_t index,
                            const cau_vessel_surroundings *around)
{
	const cau_station *station = &vessels->station[index];
	vessels->open[index] = open_share(vessels->tissue, station, around->position);
	vessels->parted[index] = is_gone(around, &station->point[0]);
	vessels->holes[index] = 0;
	for (int i = 1; i < CAU_STATION_POINTS; i++)
		vessels->holes[index] += is_gone(around, &station->point[i]);
	if (vessels->holes[index] == CAU_STATION_POINTS - 1)
		vessels->parted[index] = 1; // no part of the wall is left, so the vessel is parted
}

// ---- seals

double cau_seal_strength(const cau_vessel_def *def, double fusion)
{
	return fused_pa * -expm1(-fusion) * def->wall_m / def->radius_m;
}

// Returns the temperature of the coldest part of the wall that is left, degC. A seal is as strong
// as its weakest part.
static double wall_temperature(const cau_tissue_cells *cells, const cau_station *station)
{
	double coldest = INFINITY;
	for (int i = 0; i < CAU_STATION_POINTS; i++) {
		int32_t cell = cell_of(cells, &station->point[i]);
		double at = cell < 0 ? cells->bioheat.ambient_c : cells->bioheat.temperature[cell];
		if (cell < 0 || !cells->bioheat.cells.severed[cell])
			coldest = fmin(coldest, at);
	}
	return coldest;
}

static void fuse(cau_vessels *vessels, const cau_vessel_surroundings *around)
{
	if (around->cells->bioheat.cold)
		return;
	for (int32_t k = 0; k < vessels->station_count; k++) {
		if (vessels->parted[k] || vessels->open[k] > 0)
			continue;
		double kelvin = wall_temperature(around->cells, &vessels->station[k]) + zero_k;
		vessels->fusion[k] +=
			around->step_s * exp(fusion_log_rate - fusion_energy_j_mol / (gas_j_molk * kelvin));
	}
}

// ---- bleeding

// p = R Q + rho / 2 (Q / (C A))^2: laminar flow through the supplying tube, then an orifice.
double cau_vessel_outflow(const cau_vessel_def *def, double pressure_pa, double open)
{
	double lumen = def->radius_m - def->wall_m, area = pi * lumen * lumen * open;
	if (pressure_pa <= 0 || area <= 0)
		return 0;
	double tube = 8 * CAU_BLOOD_VISCOSITY_PA_S * def->supply_m / (pi * pow(lumen, 4));
	double orifice = CAU_BLOOD_DENSITY_KG_M3 / 2 / pow(discharge * area, 2);
	return (sqrt(tube * tube + 4 * orifice * pressure_pa) - tube) / (2 * orifice);
}

// The flow of blood from one end of a vessel.
typedef struct run {
	double flow_m3_s; // flow that leaves the vessel
	double open;      // area through which the flow leaves, over the lumen's area
	// strength of the best seal between this end and the cut, or the other end if there is no cut
	double best_seal_pa;
	bool sealed, shut; // a seal, or compression, stops the flow
} run;

typedef struct vessel_end { // the end of a vessel from which blood comes
	const cau_vessel_def *def;
	double pressure_pa;
	bool shed; // shed blood is added to the tissue's surface
} vessel_end;

// Lets blood leave the vessel at a station, through a share of the lumen's area. All openings share
// the supplying tube. So each opening adds only the flow by which its area raises the flow of the
// openings before it. If `end->shed` is set, the blood is added to the tissue's surface.
static void leave(cau_vessels *vessels, const cau_vessel_surroundings *around, int32_t station,
                  const vessel_end *end, double share, run *out)
{
	out->open += share;
	double flow_m3_s = cau_vessel_outflow(end->def, end->pressure_pa, out->open) - out->flow_m3_s;
	out->flow_m3_s += flow_m3_s;
	if (!end->shed || flow_m3_s <= 0)
		return;
	cau_vec3 at = place(vessels->tissue, &vessels->station[station].point[0], around->position);
	cau_blood_add(&vessels->blood, around->vertex_visible, around->position, at,
	              flow_m3_s * around->step_s);
}

// Follows the blood from one end, in direction `step`, 1 or -1. Blood leaves where the vessel is
// parted, and through holes of the wall. The blood stops at a seal that holds, or at a shut lumen.
static run follow(cau_vessels *vessels, int32_t index, int step, double pressure_pa,
                  const cau_vessel_surroundings *around, bool shed)
{
	const cau_vessel_def *def = &vessels->def[index];
	const cau_vessel *vessel = &vessels->vessel[index];
	vessel_end end = {.def = def, .pressure_pa = pressure_pa, .shed = shed};
	run out = {0};
	double open = 1;
	int32_t k = step > 0 ? vessel->first : vessel->first + vessel->count - 1;
	for (int32_t left = vessel->count; left > 0; left--, k += step) {
		if (vessels->parted[k]) {
			leave(vessels, around, left == vessel->count ? k : k - step, &end, open, &out);
			break;
		}
		double seal = cau_seal_strength(def, vessels->fusion[k]);
		out.best_seal_pa = fmax(out.best_seal_pa, seal);
		out.sealed |= seal > 0 && seal >= pressure_pa;
		out.shut |= vessels->open[k] <= 0;
		open = out.sealed ? 0 : fmin(open, vessels->open[k]);
		double hole = fmin(open, vessels->holes[k] / (double)(CAU_STATION_POINTS - 1));
		leave(vessels, around, k, &end, hole, &out);
		open -= hole;
	}
	return out;
}

// Returns the share of the lumen's area through which blood can pass.
static float passable(const cau_vessels *vessels, const cau_vessel_def *def, int32_t station)
{
	double seal = cau_seal_strength(def, vessels->fusion[station]);
	return seal > 0 && seal >= def->pressure_pa ? 0 : (float)vessels->open[station];
}

static void show_points(const cau_vessels *vessels, const cau_vessel_def *def, cau_vessel *vessel,
                        const double *position)
{
	cau_vessel_state *state = &vessel->state;
	int32_t stride = STATIONS_A_RADIUS;
	while ((vessel->count - 1) / stride + 2 > CAU_VESSEL_SHOWN_POINTS)
		stride++;
	state->point_count = 0;
	for (int32_t k = 0; k < vessel->count; k += stride) {
		cau_vessel_point *point = &state->point[state->point_count++];
		int32_t station = vessel->first + k, next = k + stride;
		cau_vec3 at = place(vessels->tissue, &vessels->station[station].point[0], position);
		*point = (cau_vessel_point){{(float)at.x, (float)at.y, (float)at.z},
		                            passable(vessels, def, station)};
		for (int32_t i = k; i < next && i < vessel->count; i++)
			if (vessels->parted[vessel->first + i])
				point->open = -1;
		if (next >= vessel->count && k < vessel->count - 1)
			k = vessel->count - 1 - stride; // the last station ends the shown line
	}
}

static void describe(cau_vessels *vessels, int32_t index, const run *from, const run *back,
                     const double *position)
{
	cau_vessel *vessel = &vessels->vessel[index];
	const cau_vessel_def *def = &vessels->def[index];
	bool cut = false, pierced = false;
	for (int32_t k = vessel->first; k < vessel->first + vessel->count; k++) {
		cut |= vessels->parted[k];
		pierced |= vessels->holes[k] > 0 && !vessels->parted[k];
	}
	bool both = cut && def->end_pressure_pa > 0; // both ends need a seal
	vessel->state.bleeding_m3_s = from->flow_m3_s + back->flow_m3_s;
	vessel->state.burst_pa =
		both ? fmin(from->best_seal_pa, back->best_seal_pa) : from->best_seal_pa;
	bool sealed = from->sealed && (!both || back->sealed);
	vessel->state.flags = (cut ? CAU_VESSEL_CUT : 0u) | (pierced ? CAU_VESSEL_PIERCED : 0u) |
	                      (from->shut ? CAU_VESSEL_SHUT : 0u) | (sealed ? CAU_VESSEL_SEALED : 0u) |
	                      (vessel->state.bleeding_m3_s > 0 ? CAU_VESSEL_BLEEDS : 0u);
	show_points(vessels, def, vessel, position);
}

static void update(cau_vessels *vessels, const cau_vessel_surroundings *around, bool shed)
{
	for (int32_t i = 0; i < vessels->vessel_count; i++) {
		const cau_vessel_def *def = &vessels->def[i];
		run from = follow(vessels, i, 1, def->pressure_pa, around, shed);
		run back = follow(vessels, i, -1, def->end_pressure_pa, around, shed);
		describe(vessels, i, &from, &back, around->position);
		if (shed)
			vessels->vessel[i].state.shed_m3 +=
				vessels->vessel[i].state.bleeding_m3_s * around->step_s;
	}
}

static void look(cau_vessels *vessels, const cau_vessel_surroundings *around)
{
	for (int32_t k = 0; k < vessels->station_count; k++)
		look_at_station(vessels, k, around);
}

void cau_vessels_look(cau_vessels *vessels, const cau_vessel_surroundings *around)
{
	look(vessels, around);
	update(vessels, around, false);
	cau_blood_recount(&vessels->blood);
}

void cau_vessels_step(cau_vessels *vessels, const cau_vessel_surroundings *around)
{
	look(vessels, around);
	fuse(vessels, around);
	update(vessels, around, true);
	cau_blood_flow(&vessels->blood, &vessels->tissue->edges, around->vertex_visible,
	               around->position, around->gravity_m_s2, around->step_s);
}

bool cau_vessels_flow(const cau_vessels *vessels)
{
	if (vessels->blood.flows)
		return true;
	for (int32_t i = 0; i < vessels->vessel_count; i++)
		if (vessels->vessel[i].state.flags & CAU_VESSEL_BLEEDS)
			return true;
	return false;
}

uint64_t cau_vessels_hash(const cau_vessels *vessels, uint64_t hash)
{
	hash = cau_hash_bytes(hash, vessels->fusion, (size_t)vessels->station_count * sizeof(double));
	return cau_hash_bytes(hash, vessels->blood.volume_m3,
	                      (size_t)vessels->blood.vertex_count * sizeof(double));
}
