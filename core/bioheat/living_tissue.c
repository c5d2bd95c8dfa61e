// SPDX-License-Identifier: GPL-3.0-or-later
#include "bioheat/living_tissue.h"

#include "cautery/assert.h"

// The damage constants of liver, which are used for all tissues: ln of 7.39e39 1/s, and E_a.
// README.md says what that means for fat.
#define DAMAGE .damage_log_rate = 91.8, .damage_energy_j_mol = 2.577e5

#define MUSCLE                                                                                     \
	{                                                                                              \
		.conductivity_w_mk = 0.49, .density_kg_m3 = 1090, .specific_heat_j_kgk = 3421,             \
		.water = 0.75, .electric_s_m = 0.4, .perfusion_w_m3k = 12960, DAMAGE                       \
	}

static const cau_bioheat_material tissues[CAU_LIVING_COUNT] = {
	[CAU_LIVING_CONNECTIVE] = MUSCLE,
	[CAU_LIVING_FAT] = {.conductivity_w_mk = 0.21,
                        .density_kg_m3 = 911,
                        .specific_heat_j_kgk = 2348,
                        .water = 0.2,
                        .electric_s_m = 0.03,
                        .perfusion_w_m3k = 8065,
                        DAMAGE},
	[CAU_LIVING_LIVER] = {.conductivity_w_mk = 0.52,
                          .density_kg_m3 = 1079,
                          .specific_heat_j_kgk = 3540,
                          .water = 0.7,
                          .electric_s_m = 0.15,
                          .perfusion_w_m3k = 40000,
                          DAMAGE},
	[CAU_LIVING_MUSCLE] = MUSCLE,
};

cau_bioheat_material cau_living_tissue(int tissue)
{
	CAU_ASSERT_INDEX(tissue, CAU_LIVING_COUNT);
	return tissues[tissue];
}
