// SPDX-License-Identifier: GPL-3.0-or-later
// Blood vessels: tubes in layers of fat. The code finds what opens them, what seals them, and how
// much they bleed. README.md describes the model.
#pragma once

#include "base/vector.h"
#include "bioheat/tissue_cells.h"
#include "cautery/channels.h"
#include "tissue/tissue.h"
#include "vessel/blood.h"

enum {
	CAU_STATION_POINTS = 5, // one on the centre line, four in the wall around it
	CAU_STATIONS_MOST = 4096,
};

// A point that moves with a tetrahedron.
typedef struct cau_tube_point {
	int32_t tetrahedron;
	double weight[4]; // weights of the tetrahedron's vertices
	cau_vec3 rest;    // position at rest, m
} cau_tube_point;

// A cross section of a vessel.
typedef struct cau_station {
	cau_tube_point point[CAU_STATION_POINTS]; // point[0] is on the centre line
	cau_vec3 across[2];                       // unit vectors at rest, at right angles to the line
} cau_station;

typedef struct cau_vessel {
	int32_t first, count;   // index of the vessel's first station, and number of its stations
	cau_vessel_state state; // after the last step
} cau_vessel;

typedef struct cau_vessels {
	const cau_tissue *tissue;
	const cau_vessel_def *def; // (vessel_count)
	int32_t vessel_count;
	cau_vessel *vessel; // (vessel_count)
	int32_t station_count;
	cau_station *station; // (station_count)
	// State of the seals: damage integral Omega (no unit) of the wall's collagen while the lumen
	// was shut.
	double *fusion;  // (station_count)
	double *open;    // (station_count): share of the lumen's area that is open
	uint8_t *parted; // (station_count): 1: the vessel is parted at the station
	uint8_t *holes;  // (station_count): number of wall points that are gone
	cau_blood blood;
} cau_vessels;

// The tissue around the vessels in a step.
typedef struct cau_vessel_surroundings {
	const cau_tissue_cells *cells;
	const uint8_t *alive;          // (tetrahedron_count): 1: the tetrahedron exists
	const uint8_t *vertex_visible; // (vertex_count)
	const double *position;        // m, (vertex_count x 3)
	const double *gravity_m_s2;
	double step_s;
} cau_vessel_surroundings;

// Makes the vessels of a checked scene. The scene's definitions are borrowed. Errors: CAU_NOT_FOUND
// (the layer is not a layer of fat), CAU_BAD_VALUE (a vessel leaves its layer), CAU_LIMIT,
// CAU_NO_MEMORY.
cau_status cau_vessels_create(cau_vessels *vessels, const cau_tissue *tissue,
                              const cau_scene_def *scene, cau_arena *arena, cau_error *error);

// Finds, from the tissue and the seals, which sections are open, parted or sealed, how much blood
// leaves, and the points that clients see. Changes no state.
void cau_vessels_look(cau_vessels *vessels, const cau_vessel_surroundings *around);
// Does the same as cau_vessels_look, and advances seals, shed blood and the blood on the surface by
// one step.
void cau_vessels_step(cau_vessels *vessels, const cau_vessel_surroundings *around);

// True if blood leaves a vessel, or flows on the tissue.
bool cau_vessels_flow(const cau_vessels *vessels);

// Returns the pressure at which a seal of this damage opens, Pa.
double cau_seal_strength(const cau_vessel_def *def, double fusion);

// Returns the flow from a vessel at this pressure, through the share `open` of its lumen, m^3/s.
double cau_vessel_outflow(const cau_vessel_def *def, double pressure_pa, double open);

// Continues `hash` with the state of seals and blood.
uint64_t cau_vessels_hash(const cau_vessels *vessels, uint64_t hash);
