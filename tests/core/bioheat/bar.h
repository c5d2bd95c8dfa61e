// SPDX-License-Identifier: GPL-3.0-or-later
// A bar of cells along x, and a tissue for these cells. Include after cmocka.h.
#pragma once

#include <math.h>
#include <stddef.h>

#include "bioheat/bioheat.h"

#define assert_near(value, expected, tolerance)                                                    \
	assert_true(fabs((value) - (expected)) <= (tolerance))

static inline void assert_within(double found, double wanted, double share)
{
	if (!(fabs(found - wanted) <= share * fabs(wanted)))
		fail_msg("%.9g, but %.9g is wanted within %g %%", found, wanted, 100 * share);
}

// Properties of liver, without perfusion and damage, so that closed forms hold.
static const cau_bioheat_material plain_tissue = {.conductivity_w_mk = 0.52,
                                                  .density_kg_m3 = 1079,
                                                  .specific_heat_j_kgk = 3540,
                                                  .water = 0.7,
                                                  .electric_s_m = 0.15,
                                                  .damage_log_rate = -1000};

static inline cau_bioheat bar_of(const cau_bioheat_material *material, int32_t length,
                                 double side_m, double ambient_c, cau_arena *arena)
{
	cau_bioheat bar;
	assert_int_equal(cau_bioheat_create(&bar, side_m, length, material, 1, ambient_c, arena, NULL),
	                 CAU_OK);
	for (int32_t i = 0; i < length; i++)
		assert_int_equal(cau_bioheat_add(&bar, (int32_t[]){i, 0, 0}, 0, 1), i);
	return bar;
}

static inline void run(cau_bioheat *bioheat, cau_blade *blade, double seconds)
{
	static const double tick_s = 1.0 / 60;
	for (double left = seconds; left > 1e-9; left -= tick_s)
		assert_true(cau_bioheat_step(bioheat, blade, blade ? 1 : 0, left < tick_s ? left : tick_s));
}
