// SPDX-License-Identifier: GPL-3.0-or-later
// The elements of a tissue as structure-of-arrays, in groups of one law, for the element kernels.
//
// Every element has a slot. Slots of one group are contiguous and padded to whole batches; padding
// has weight 0 and vertex 0. Arrays marked `real` are float or double, as the session's precision
// says. A removed element keeps its slot with weight 0.
//
// Triangles and tetrahedra are handled in pairs that share an edge or a face (elements_pairs.c).
// The first element of a pair is in a batch with an even number, the second in the same lane of the
// next batch. Both elements list their shared vertices in the same order, and the apex last. D_m
// follows this order.
//
// The local step is divided into shares of consecutive slots. A share has a record for each vertex
// of its elements: four reals (x, y, z, 0). The share first copies its vertices' displacements, in
// the order of its records, onto the stack. It then adds the gradients of the elements' energies
// (N) to the records, slot by slot. Afterwards each vertex sums its records in share order. So the
// sums do not depend on the threads that run the shares. The data of a share stay in the nearest
// cache, and an element names its vertices in sixteen bits.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "cautery/scene.h"

enum {
	CAU_BATCH = 16, // slots in a batch; a multiple of the number of lanes in each precision
	CAU_SHARE = 16 * CAU_BATCH,            // slots in a share of the local step, at most
	CAU_SHARE_RECORDS = 1 + 4 * CAU_SHARE, // most records of a share; the first is for padding
	CAU_MAX_GROUPS = CAU_MAX_LAYERS * CAU_MAX_MATERIALS,
};

// Largest stiffness of a slack triangle in its softest direction, as a share of A's stiffness.
// Sheets that are cut or hang free have slack triangles, taut sheets have none. The value was
// measured on fascia: with 0.1, tabs along a cut are missed; with 0.4, sheets are included for
// which A is good enough.
static const double CAU_SLACK = 0.25;

// A range of slots with one law.
typedef struct cau_sheet_group {
	int32_t first_slot, slot_count, layer, material;
	int limit, projection;                 // values CAU_LIMIT_* and CAU_PROJECTION_*
	double stretch_min[2], stretch_max[2]; // for RANGE: limits of sqrt(k_aa)
	double shear_max;
	double viscosity_s; // retardation time, s; 0: the layer is not viscous
} cau_sheet_group;

typedef struct cau_fat_group {
	int32_t first_slot, slot_count, layer, material;
	int model;          // one of CAU_MODEL_*
	int keeps_rotation; // 1: the law needs a rotation, which `polar` keeps, even if there is no
	                    // limit
	int limit, projection;
	int plastic;            // 1: `plastic` holds C_p^(-1/2) - I
	double mu, lambda;      // Pa, of the energy as it is evaluated (cau_law)
	double stiffness;       // Pa: stiffness k with which the energy counts in A
	double limit_stiffness; // Pa: stiffness of the strain limit
	double target[6];       // TARGET: T^(1/2) of slots without a target of their own
	double stretch_min[3], stretch_max[3];
	double shear_max;
	double yield_strain, plastic_strain_max;
	// Pa s: Lame parameters at small strain, times the retardation time
	double viscous_mu, viscous_lambda;
} cau_fat_group;

// Fascia and membrane. F = F_0 + [du_1 du_2] D_m'^-1 (eq. 8-10), 3 x 2.
typedef struct cau_sheet_set {
	int32_t slot_count, group_count;
	cau_sheet_group *group;
	uint16_t *record_at[3]; // (slot_count): 4 x the vertex's record, counted from the share's first
	                        // record
	void *dm_inverse[4];    // real, 1/m: row-major D_m'^-1
	void *rest[6];          // real: columns of F_0 = F at rest
	void *weight;           // real, N m: k x area x thickness; 0 once removed
	void *target[3];        // real: T^(1/2): 00, 11, 01
	void *polar[6];         // real: Q of the last evaluation; used again where F loses rank
	void *position_scale;   // real, m^2: |G|^2 of the element, for the diagonal system
	void *strain[3]; // real: reference strain R of viscosity: 00, 11, 01; NULL: no layer is viscous
} cau_sheet_set;

// Fat. F = I + [du_1 du_2 du_3] D_m^-1, world axes.
typedef struct cau_fat_set {
	int32_t slot_count, group_count;
	cau_fat_group *group;
	uint16_t *record_at[4];
	void *dm_inverse[9]; // real, 1/m: row-major D_m^-1
	void *volume;        // real, m^3: volume of the element; 0 once removed
	// real, N m: limit stiffness x volume if a limit or shrinkage acts, else 0. Kernels read it
	// only if shrinkage acts and the law has no limit. With a limit, every slot's weight follows
	// from its volume.
	void *limit_weight;
	void *target[6];         // real: T^(1/2): 00, 11, 22, 01, 02, 12
	void *polar[4];          // real: rotation of the limit, or of corotated fat: w, x, y, z
	void *plastic[6];        // real: C_p^(-1/2) - I, where C_p is the plastic metric
	void *plastic_strain[6]; // real: plastic strain e_p, with C_p = I + 2 e_p
	uint8_t *limited;        // (slot_count / CAU_BATCH): a slot of the batch has limit_weight > 0
	uint8_t *targeted; // (slot_count / CAU_BATCH): a slot of the batch has a target other than its
	                   // group's
	uint8_t *flowed;   // (slot_count / CAU_BATCH): a slot of the batch has plastic strain
	void *position_scale;
	void *strain[6]; // real: reference strain R of viscosity: 00, 11, 22, 01, 02, 12; NULL: no
	                 // layer is viscous
} cau_fat_set;

// Trusses (section 5.2, last paragraph): elements with two vertices and a rest length.
typedef struct cau_link_set {
	int32_t slot_count;
	uint16_t *record_at[2];
	void *rest[3];     // real, m: edge vector at rest
	void *rest_length; // real, m: length at rest
	void *weight;      // real, N/m: E A / L; 0 once removed
} cau_link_set;

// Bending elements, with e = sum of c_i x_i over the four vertices of two triangles that share an
// edge.
typedef struct cau_hinge_set {
	int32_t slot_count;
	uint16_t *record_at[4];
	void *coefficient[4]; // real: coefficients c_i, sum 0
	void *rest[3];        // real, m: e at rest
	void *rest_length;    // real, m: |e| at rest
	void *weight;         // real, N/m: bending weight; 0 once removed
} cau_hinge_set;

typedef struct cau_elements {
	bool single; // precision of the real arrays
	cau_sheet_set sheet;
	cau_fat_set fat;
	cau_link_set link;
	cau_hinge_set hinge;
	void *gradient; // real: the records, (record_count x 4)
	int32_t record_count;
	int32_t *record_vertex; // (record_count): 4 x the record's vertex; 0 for padding
	double *energy;         // (number of shares): energy of each share, J
	double rate_per_s;      // 1/h of viscosity; 0: no viscosity
	// (number of shares): viscosity's part of `energy`, J; NULL: no layer is viscous
	double *viscous_j;
	bool *slack; // (number of shares): whether a triangle of the share is slack
} cau_elements;

static inline double cau_real_get(const void *array, bool single, int64_t index)
{
	return single ? (double)((const float *)array)[index] : ((const double *)array)[index];
}
static inline void cau_real_set(void *array, bool single, int64_t index, double value)
{
	if (single)
		((float *)array)[index] = (float)value;
	else
		((double *)array)[index] = value;
}
static inline size_t cau_real_bytes(bool single)
{
	return single ? sizeof(float) : sizeof(double);
}

// ---- laws of fat
// Properties of a law of fat that the solver needs in addition to its stress. Each is an entry of
// CAU_MODEL_TABLE.
typedef struct cau_law {
	const char *word;    // name in JSON
	double poisson_most; // largest Poisson's ratio that is accepted
	bool has_energy;     // the stress is the gradient of an energy, which the solver may compare
	bool keeps_rotation; // the law uses a rotation that `polar` of the slot keeps between
	                     // evaluations
	double lambda_mu, mu_mu; // Lame parameters as evaluated: lambda + lambda_mu mu and mu_mu mu
	const char *meaning;
} cau_law;

// Returns the properties of a law; `model` is CAU_MODEL_*.
const cau_law *cau_law_of(int model);
