// SPDX-License-Identifier: GPL-3.0-or-later
// Blood vessels: tubes in layers of fat. What opens them, what seals them, and how much they bleed.
// The model is in README.md.
#pragma once

#include "base/vector.h"
#include "bioheat/tissue_cells.h"
#include "cautery/channels.h"
#include "tissue/tissue.h"
#include "vessel/blood.h"

enum {
	CAU_STATION_POINTS = 5, // one on the middle line, four in the wall around it
	CAU_STATIONS_MOST = 4096,
};

// A place that moves with a tetrahedron.
typedef struct cau_tube_point {
	int32_t tetrahedron;
	double weight[4]; // of its vertices
	cau_vec3 rest;    // m
} cau_tube_point;

// A cross section of a vessel.
typedef struct cau_station {
	cau_tube_point point[CAU_STATION_POINTS]; // the first is on the middle line
	cau_vec3 across[2];                       // unit vectors at rest, across the line
} cau_station;

typedef struct cau_vessel {
	int32_t first, count;   // its stations
	cau_vessel_state state; // after the last step
} cau_vessel;

typedef struct cau_vessels {
	const cau_tissue *tissue;
	const cau_vessel_def *def; // (vessel_count)
	int32_t vessel_count;
	cau_vessel *vessel; // (vessel_count)
	int32_t station_count;
	cau_station *station; // (station_count)
	// Damage of the wall's collagen while the lumen was shut (Omega, 1): the state of the seals.
	double *fusion;  // (station_count)
	double *open;    // (station_count): share of the lumen's area that is open
	uint8_t *parted; // (station_count): the vessel is parted there
	uint8_t *holes;  // (station_count): points of the wall that are gone, where it is not parted
	cau_blood blood;
} cau_vessels;

// The tissue around the vessels in a step.
typedef struct cau_vessel_surroundings {
	const cau_tissue_cells *cells;
	const uint8_t *alive;          // (tetrahedron_count), 1: it exists
	const uint8_t *vertex_visible; // (vertex_count)
	const double *position;        // m, (vertex_count x 3)
	const double *gravity_m_s2;
	double step_s;
} cau_vessel_surroundings;

// The vessels of a checked scene. The scene's definitions are borrowed. Errors: CAU_NOT_FOUND (the
// layer is none of fat), CAU_BAD_VALUE (a vessel leaves its layer), CAU_LIMIT, CAU_NO_MEMORY.
cau_status cau_vessels_create(cau_vessels *vessels, const cau_tissue *tissue,
                              const cau_scene_def *scene, cau_arena *arena, cau_error *error);

// cau_vessels_look finds from the tissue and the seals which sections are open, parted or sealed,
// how much blood leaves, and the points that clients see. It changes no state. cau_vessels_step
// does the same, and advances seals, shed blood and the blood on the surface by a step.
void cau_vessels_look(cau_vessels *vessels, const cau_vessel_surroundings *around);
void cau_vessels_step(cau_vessels *vessels, const cau_vessel_surroundings *around);

// Whether blood leaves a vessel, or flows on the tissue.
bool cau_vessels_flow(const cau_vessels *vessels);

// Pa at which a seal of this damage opens.
double cau_seal_strength(const cau_vessel_def *def, double fusion);

// m^3/s from a vessel with the pressure through the share `open` of its lumen.
double cau_vessel_outflow(const cau_vessel_def *def, double pressure_pa, double open);

// Continues `hash` over seals and blood.
uint64_t cau_vessels_hash(const cau_vessels *vessels, uint64_t hash);
