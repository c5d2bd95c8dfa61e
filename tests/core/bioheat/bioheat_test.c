// SPDX-License-Identifier: GPL-3.0-or-later
// Tests heat in cells against closed forms, within 1 %: conduction, perfusion, boiling, a boiling
// front, a blade, damage. Also tests the energy ledger.
#include "bioheat/bioheat.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "bar.h"

static const double PI = 3.14159265358979323846, SIDE_M = 1e-4;
static const double WATER_HEAT = 4186, BOILING = 2.257e6, DRY_W_MK = 0.2;

// Returns the share that is left of a cosine of temperature over the bar, 10 K high, after a time.
static double cosine_left(double pull, double seconds)
{
	enum { LENGTH = 40 };
	cau_arena arena = {0};
	cau_bioheat bar = bar_of(&plain_tissue, LENGTH, SIDE_M, 37, &arena);
	for (int i = 0; i < LENGTH; i++) {
		bar.temperature[i] += 10 * cos(PI * (i + 0.5) / LENGTH);
		for (int axis = 0; axis < 3; axis++)
			bar.cells.pull[3 * i + axis] = (float)pull;
	}
	run(&bar, NULL, seconds);
	double left = (bar.temperature[0] - 37) / (10 * cos(PI * 0.5 / LENGTH));
	cau_arena_finish(&arena);
	return left;
}

static void a_cosine_decays_by_diffusivity(void **state)
{
	(void)state;
	double diffusivity = 0.52 / (1079 * 3540), wave = PI / (40 * SIDE_M);
	for (double seconds = 1; seconds <= 16; seconds *= 4)
		assert_within(cosine_left(1, seconds), exp(-diffusivity * wave * wave * seconds), 0.01);
}

// Tissue that is stretched to 1.5 times its length conducts over 1.5 times the distance. Tissue
// that is compressed to half its length conducts over half the distance.
static void stretched_tissue_conducts_over_its_length(void **state)
{
	(void)state;
	double diffusivity = 0.52 / (1079 * 3540);
	const double stretches[] = {1.5, 0.5};
	for (int i = 0; i < 2; i++) {
		double wave = PI / (stretches[i] * 40 * SIDE_M);
		assert_within(cosine_left(1 / (stretches[i] * stretches[i]), 2),
		              exp(-diffusivity * wave * wave * 2), 0.02);
	}
}

static void blood_carries_heat_away(void **state)
{
	(void)state;
	cau_bioheat_material perfused = plain_tissue;
	perfused.perfusion_w_m3k = 40000;
	cau_arena arena = {0};
	cau_bioheat bar = bar_of(&perfused, 3, SIDE_M, 37, &arena);
	for (int i = 0; i < 3; i++)
		bar.temperature[i] = 60;
	run(&bar, NULL, 60);
	assert_within(bar.temperature[1] - 37, 23 * exp(-40000.0 / (1079 * 3540) * 60), 0.01);
	bar.damage[1] = 1; // the cell's blood vessels have closed
	bar.temperature[0] = bar.temperature[1] = bar.temperature[2] = 40;
	double before = bar.ledger.perfused_j, volume = SIDE_M * SIDE_M * SIDE_M;
	run(&bar, NULL, 1.0 / 60);
	assert_within(bar.ledger.perfused_j - before, 2 * 40000 * volume * 3 / 60, 0.01);
	cau_arena_finish(&arena);
}

// The steady state of a perfused bar at a wall of constant temperature is exp(-x sqrt(omega / k)).
static void a_perfused_bar_at_a_wall(void **state)
{
	(void)state;
	enum { LENGTH = 120 };
	cau_bioheat_material perfused = plain_tissue;
	perfused.perfusion_w_m3k = 400000;
	cau_arena arena = {0};
	cau_bioheat bar = bar_of(&perfused, LENGTH, SIDE_M, 37, &arena);
	cau_blade wall = {.temperature_c = 60, .heat_capacity_j_k = 1e9};
	bar.contact[bar.contact_count++] = (cau_contact_cell){.cell = 0, .over_length_m = 2 * SIDE_M};
	run(&bar, &wall, 60);
	double inverse_m = sqrt(400000 / 0.52);
	for (int i = 0; i < 30; i += 5)
		assert_within(bar.temperature[i] - 37, 23 * exp(-(i + 0.5) * SIDE_M * inverse_m), 0.01);
	cau_arena_finish(&arena);
}

// 1 mm^3 of tissue takes up 1.9 J until it is dry.
static void water_boils_off_by_its_enthalpy(void **state)
{
	(void)state;
	cau_arena arena = {0};
	cau_bioheat bar = bar_of(&plain_tissue, 1, 1e-3, 37, &arena);
	double mass = 1079e-9, warm = mass * 3540 * 63, boil = mass * 0.7 * BOILING;
	assert_within(cau_bioheat_until_dry(&bar, 0), warm + boil, 1e-12);
	assert_within(warm + boil, 1.94, 0.01);
	bar.power_w[0] = 1;
	run(&bar, NULL, warm);
	assert_near(bar.temperature[0], 100, 1e-6);
	assert_near(bar.water[0], 1, 1e-6);
	run(&bar, NULL, boil / 2);
	assert_near(bar.temperature[0], 100, 1e-6);
	assert_near(bar.water[0], 0.5, 1e-6);
	run(&bar, NULL, boil);
	assert_near(bar.water[0], 0, 0);
	assert_within(bar.ledger.delivered_j, warm + boil, 1e-9); // a dry cell takes up no more
	cau_arena_finish(&arena);
}

// Returns lambda of Neumann's solution for one phase: lambda exp(lambda^2) erf(lambda) = St /
// sqrt(pi).
static double front_factor(double stefan)
{
	double least = 0, most = 5;
	for (int i = 0; i < 100; i++) {
		double lambda = (least + most) / 2;
		if (lambda * exp(lambda * lambda) * erf(lambda) < stefan / sqrt(PI))
			least = lambda;
		else
			most = lambda;
	}
	return least;
}

// A wall at 300 degC dries tissue that is at 100 degC. The front moves with the square root of
// time.
static void a_boiling_front_moves_with_the_root_of_time(void **state)
{
	(void)state;
	enum { LENGTH = 150 };
	cau_arena arena = {0};
	cau_bioheat bar = bar_of(&plain_tissue, LENGTH, 2e-5, 100, &arena);
	cau_blade wall = {.temperature_c = 300, .heat_capacity_j_k = 1e9};
	bar.contact[bar.contact_count++] = (cau_contact_cell){.cell = 0, .over_length_m = 2 * 2e-5};
	double dry_heat = 3540 - 0.7 * WATER_HEAT, diffusivity = DRY_W_MK / (1079 * dry_heat);
	double lambda = front_factor(dry_heat * 200 / (0.7 * BOILING)), time = 0;
	for (int step = 0; step < 3; step++) {
		for (double until = time + 10; time < until; time += 0.005)
			assert_true(cau_bioheat_step(&bar, &wall, 1, 0.005));
		double front = 0;
		for (int i = 0; i < LENGTH; i++)
			front += (1 - bar.water[i]) * 2e-5;
		assert_within(front, 2 * lambda * sqrt(diffusivity * time), 0.01);
	}
	cau_arena_finish(&arena);
}

// A cube cools in gas, through its six sides.
static void a_surface_cools_in_gas(void **state)
{
	(void)state;
	cau_arena arena = {0};
	cau_bioheat bar = bar_of(&plain_tissue, 1, 1e-3, 37, &arena);
	bar.surface_w_m2k = 20;
	bar.temperature[0] = 60;
	run(&bar, NULL, 20);
	double per_s = 6 * 20 * 1e-6 / (1079e-9 * 3540);
	assert_within(bar.temperature[0] - 37, 23 * exp(-20 * per_s), 0.01);
	assert_within(bar.ledger.ambient_j, 1079e-9 * 3540 * 23 * (1 - exp(-20 * per_s)), 0.01);
	cau_arena_finish(&arena);
}

static void a_blade_cools_and_gives_its_heat(void **state)
{
	(void)state;
	cau_arena arena = {0};
	cau_bioheat bar = bar_of(&plain_tissue, 1, SIDE_M, 37, &arena);
	cau_blade blade = {.temperature_c = 200, .heat_capacity_j_k = 0.05, .cooling_w_k = 1e-3};
	run(&bar, &blade, 30);
	assert_within(blade.temperature_c - 37, 163 * exp(-30 * 1e-3 / 0.05), 0.01);
	// The blade has three times the heat capacity C of the cell. The temperature difference decays
	// at a rate in proportion to 1 / C + 1 / (3 C).
	double capacity = cau_bioheat_capacity(&bar, 0), rate = 0.52 * 1e-6 * 4 / (3 * capacity);
	blade = (cau_blade){.temperature_c = 77, .heat_capacity_j_k = 3 * capacity};
	bar.contact[bar.contact_count++] = (cau_contact_cell){.cell = 0, .over_length_m = 1e-6};
	run(&bar, &blade, 1 / rate);
	assert_within(blade.temperature_c - bar.temperature[0], 40 * exp(-1), 0.01);
	assert_within(bar.temperature[0] + 3 * blade.temperature_c, 37 + 3 * 77, 1e-9);
	cau_arena_finish(&arena);
}

// A blade that is much lighter than the cell it touches reaches the cell's temperature, and never
// passes it.
static void a_light_blade_is_stable(void **state)
{
	(void)state;
	cau_arena arena = {0};
	cau_bioheat bar = bar_of(&plain_tissue, 1, SIDE_M, 37, &arena);
	double capacity = cau_bioheat_capacity(&bar, 0);
	cau_blade blade = {.temperature_c = 77, .heat_capacity_j_k = capacity / 100};
	bar.contact[bar.contact_count++] = (cau_contact_cell){.cell = 0, .over_length_m = 2 * SIDE_M};
	bar.temperature[0] = 57;
	double mean = 57 + 20.0 / 101;
	for (int tick = 0; tick < 20; tick++) {
		run(&bar, &blade, 1.0 / 60);
		assert_true(blade.temperature_c <= 77 && blade.temperature_c >= mean - 1e-9);
	}
	assert_near(blade.temperature_c, mean, 1e-6);
	assert_near(bar.temperature[0], mean, 1e-6);
	cau_arena_finish(&arena);
}

// The shaft cools the blade within less than a step. The blade touches no tissue here.
static void a_blade_that_cools_fast_is_stable(void **state)
{
	(void)state;
	cau_arena arena = {0};
	cau_bioheat bar = bar_of(&plain_tissue, 1, SIDE_M, 37, &arena);
	cau_blade blade = {.temperature_c = 237, .heat_capacity_j_k = 0.01, .cooling_w_k = 1};
	double before_c = 237;
	for (int tick = 0; tick < 20; tick++) {
		run(&bar, &blade, 1.0 / 60);
		assert_true(blade.temperature_c <= before_c && blade.temperature_c >= 37 - 1e-9);
		before_c = blade.temperature_c;
	}
	assert_near(blade.temperature_c, 37, 1e-6);
	cau_arena_finish(&arena);
}

static void damage_follows_arrhenius(void **state)
{
	(void)state;
	cau_bioheat_material liver = plain_tissue;
	liver.damage_log_rate = log(7.39e39);
	liver.damage_energy_j_mol = 2.577e5;
	cau_arena arena = {0};
	cau_bioheat bar = bar_of(&liver, 2, SIDE_M, 37, &arena);
	bar.temperature[0] = bar.temperature[1] = 60;
	run(&bar, NULL, 10);
	assert_within(bar.damage[0], 10 * 7.39e39 * exp(-2.577e5 / (8.314462618 * 333.15)), 1e-6);
	bar.temperature[0] = bar.temperature[1] = 42;
	double before = bar.damage[0];
	run(&bar, NULL, 10);
	assert_near(bar.damage[0], before, 0);
	cau_arena_finish(&arena);
}

// With all effects at once, the energy that enters equals the energy that the ledger finds.
static void the_ledger_closes(void **state)
{
	(void)state;
	enum { LENGTH = 60 };
	cau_bioheat_material perfused = plain_tissue;
	perfused.perfusion_w_m3k = 40000;
	cau_arena arena = {0};
	cau_bioheat bar = bar_of(&perfused, LENGTH, SIDE_M, 37, &arena);
	bar.surface_w_m2k = 20;
	cau_blade blade = {.temperature_c = 150, .heat_capacity_j_k = 0.01, .cooling_w_k = 1e-4};
	bar.contact[bar.contact_count++] = (cau_contact_cell){.cell = 0, .over_length_m = 2 * SIDE_M};
	for (int i = 20; i < 40; i++)
		bar.power_w[i] = 1e-4 * i;
	run(&bar, &blade, 2);
	cau_bioheat_take_out(&bar, 30);
	run(&bar, &blade, 1);
	const cau_energy_ledger *ledger = &bar.ledger;
	double stored = 0;
	for (int i = 0; i < LENGTH; i++)
		stored += cau_bioheat_capacity(&bar, i) * (bar.temperature[i] - 37);
	assert_true(ledger->boiled_j > 0.1 * ledger->delivered_j);
	assert_true(ledger->perfused_j > 0 && ledger->shed_j > 0 && ledger->blade_j > 0);
	assert_within(ledger->stored_j, stored, 1e-9);
	assert_within(
		ledger->delivered_j + ledger->blade_j,
		stored + ledger->boiled_j + ledger->perfused_j + ledger->ambient_j + ledger->shed_j, 1e-9);
	cau_arena_finish(&arena);
}

static void nothing_flows_through_a_cell_that_is_gone(void **state)
{
	(void)state;
	cau_arena arena = {0};
	cau_bioheat bar = bar_of(&plain_tissue, 5, SIDE_M, 37, &arena);
	cau_bioheat_take_out(&bar, 2);
	bar.temperature[0] = bar.temperature[1] = 80;
	run(&bar, NULL, 5);
	assert_near(bar.temperature[0], 80, 1e-9);
	assert_near(bar.temperature[3], 37, 0);
	cau_arena_finish(&arena);
}

// If all cells are within half a degree of ambient, they are set to ambient in one step. The ledger
// adds their heat to the perfused heat.
static void the_last_warmth_is_forgotten(void **state)
{
	(void)state;
	cau_arena arena = {0};
	cau_bioheat bar = bar_of(&plain_tissue, 5, SIDE_M, 37, &arena);
	bar.power_w[2] = 60 * 0.4 * cau_bioheat_capacity(&bar, 2);
	run(&bar, NULL, 1.0 / 60);
	assert_false(bar.cold);
	bar.power_w[2] = 0;
	run(&bar, NULL, 1.0 / 60);
	assert_true(bar.cold);
	for (int i = 0; i < 5; i++)
		assert_true(bar.temperature[i] == 37);
	assert_within(bar.ledger.perfused_j, bar.ledger.delivered_j, 1e-9);
	assert_true(bar.ledger.stored_j == 0);
	cau_arena_finish(&arena);
}

static void a_step_that_is_too_long_is_refused(void **state)
{
	(void)state;
	cau_arena arena = {0};
	cau_bioheat bar = bar_of(&plain_tissue, 5, 1e-6, 37, &arena);
	assert_false(cau_bioheat_step(&bar, NULL, 0, 1));
	cau_arena_finish(&arena);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_cosine_decays_by_diffusivity),
		cmocka_unit_test(stretched_tissue_conducts_over_its_length),
		cmocka_unit_test(blood_carries_heat_away),
		cmocka_unit_test(a_perfused_bar_at_a_wall),
		cmocka_unit_test(water_boils_off_by_its_enthalpy),
		cmocka_unit_test(a_boiling_front_moves_with_the_root_of_time),
		cmocka_unit_test(a_surface_cools_in_gas),
		cmocka_unit_test(a_blade_cools_and_gives_its_heat),
		cmocka_unit_test(a_light_blade_is_stable),
		cmocka_unit_test(a_blade_that_cools_fast_is_stable),
		cmocka_unit_test(damage_follows_arrhenius),
		cmocka_unit_test(the_ledger_closes),
		cmocka_unit_test(nothing_flows_through_a_cell_that_is_gone),
		cmocka_unit_test(the_last_warmth_is_forgotten),
		cmocka_unit_test(a_step_that_is_too_long_is_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
