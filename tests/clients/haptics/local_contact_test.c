// SPDX-License-Identifier: GPL-3.0-or-later
#include "haptics/internal.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static const double rounding_n = 1e-7, most_n_m = 1e5;

// Returns the record of tissue of 500 N/m below z = 0, pressed by 2 mm, with a force along x that
// friction holds.
static cau_tool_contact floor_record(void)
{
	cau_tool_contact record = {
		.valid = true,
		.asked_pose = {.position_m = {0, 0, -0.002}, .rotation = {1, 0, 0, 0}},
		.force_n = {0.1, 0, 1},
		.plane_count = 1,
		.plane = {{.normal = {0, 0, 1}, .velocity_m_s = 0.01}},
		.compliance_m_n = {0.002, 0.002, 0.002},
		.friction = 0.2,
		.damping_ns_m = 0.3,
	};
	return record;
}

static void is_near(const double found[3], double x, double y, double z)
{
	assert_true(fabs(found[0] - x) < rounding_n);
	assert_true(fabs(found[1] - y) < rounding_n);
	assert_true(fabs(found[2] - z) < rounding_n);
}

// Returns the force (N) of a round tip by Hertz's law, where a linear contact would have a force of
// `share` newtons.
static double hertz(double share)
{
	return pow(1 + 2 * (share - 1) / 3, 1.5);
}

static void a_floor_pushes_as_far_as_it_is_pressed(void **state)
{
	(void)state;
	local_contact contact;
	cau_tool_contact record = floor_record();
	local_contact_set(&contact, &record, most_n_m);
	local_force at = local_contact_force(&contact, record.asked_pose.position_m);
	is_near(at.force_n, 0.1, 0, 1);
	assert_true(fabs(at.normal_n_m - 500) < 1e-6);
	assert_true(at.tissue_m_s == 0.01 && at.damping_ns_m == 0.3);
	at = local_contact_force(&contact, (double[]){0, 0, -0.003});
	is_near(at.force_n, 0.1 * cbrt(hertz(1.5)), 0, hertz(1.5));
	at = local_contact_force(&contact, (double[]){0, 0, 0});
	is_near(at.force_n, 0.2 * hertz(0), 0, hertz(0)); // the force along x is limited by friction
	at = local_contact_force(&contact, (double[]){0, 0, 0.00101});
	is_near(at.force_n, 0, 0, 0);
	assert_true(at.normal_n == 0 && at.normal[2] == 0);
}

static void friction_holds_up_to_coulombs_law(void **state)
{
	(void)state;
	local_contact contact;
	cau_tool_contact record = floor_record();
	local_contact_set(&contact, &record, most_n_m);
	local_force at = local_contact_force(&contact, (double[]){0.0001, 0, -0.002});
	is_near(at.force_n, 0.05, 0, 1);
	at = local_contact_force(&contact, (double[]){0.1, 0, -0.002});
	is_near(at.force_n, -0.2, 0, 1);
}

// In a groove of two planes at right angles each plane has a part of the force. When the tool
// leaves one plane, the other plane has the whole force.
static void planes_share_a_force(void **state)
{
	(void)state;
	const double s = sqrt(0.5);
	local_contact contact;
	cau_tool_contact record = {
		.valid = true,
		.asked_pose = {.position_m = {0, 0, -0.001}},
		.force_n = {0, 0, 1},
		.plane_count = 2,
		.plane = {{.normal = {s, 0, s}}, {.normal = {-s, 0, s}}},
		.compliance_m_n = {0.001, 0.001, 0.001},
	};
	local_contact_set(&contact, &record, most_n_m);
	local_force at = local_contact_force(&contact, record.asked_pose.position_m);
	is_near(at.force_n, 0, 0, 1);
	at = local_contact_force(&contact, (double[]){0.0005, 0, -0.001});
	double more = sqrt(sqrt(1.25)); // factor by Hertz's law: the root of the linear force over 1 N
	is_near(at.force_n, -0.5 * more, 0, more);
	// The tool leaves the first plane.
	at = local_contact_force(&contact, (double[]){0.0015, 0, -0.001});
	more = sqrt(1.2 * sqrt(2));
	is_near(at.force_n, -1.2 * more, 0, 1.2 * more);
}

static void a_grasp_pulls_both_ways(void **state)
{
	(void)state;
	local_contact contact;
	cau_tool_contact record = {.valid = true,
	                           .asked_pose = {.position_m = {0.01, 0, 0}},
	                           .force_n = {-1, 0, 0},
	                           .compliance_m_n = {1, 1, 1},
	                           .grasp_n_m = 200,
	                           .grasp_anchor_m = {0.005, 0, 0}};
	local_contact_set(&contact, &record, most_n_m);
	is_near(local_contact_force(&contact, (double[]){0.01, 0, 0}).force_n, -1, 0, 0);
	is_near(local_contact_force(&contact, (double[]){0, 0.001, 0}).force_n, 1, -0.2, 0);
	// With a limit of 100 N/m the grasp is half as stiff, with the same force at the record's
	// position.
	local_contact_set(&contact, &record, 100);
	is_near(local_contact_force(&contact, (double[]){0.01, 0, 0}).force_n, -1, 0, 0);
	is_near(local_contact_force(&contact, (double[]){0.015, 0, 0}).force_n, -1.5, 0, 0);
}

static void nothing_is_stiffer_than_the_bound(void **state)
{
	(void)state;
	local_contact contact;
	cau_tool_contact record = floor_record();
	record.compliance_m_n[0] = 0.01;
	record.compliance_m_n[3] = 0.001;
	local_contact_set(&contact, &record, 100);
	local_force at = local_contact_force(&contact, record.asked_pose.position_m);
	is_near(at.force_n, 0.1, 0, 1);
	at = local_contact_force(&contact, (double[]){0, 0, -0.012});
	assert_true(at.force_n[2] > 1 && at.force_n[2] <= hertz(1 + 100 * 0.01) + rounding_n);
}

static void damaged_records_never_push(void **state)
{
	(void)state;
	cau_tool_contact bad[12];
	local_contact contact;
	for (int i = 0; i < 12; i++)
		bad[i] = floor_record();
	bad[0].valid = false;
	bad[1].plane_count = CAU_CONTACT_PLANES + 1;
	bad[2].plane_count = -1;
	bad[3].plane[0].normal[2] = 1.1;
	bad[4].plane[0].offset_m = NAN;
	bad[5].force_n[1] = INFINITY;
	bad[6].compliance_m_n[2] = -0.002;
	bad[7].compliance_m_n[3] = 0.003; // a compliance that is not positive definite
	bad[8].friction = -1;
	bad[9].grasp_n_m = NAN;
	bad[10].asked_pose.position_m[0] = 1e9;
	bad[11].compliance_m_n[0] = 0;
	for (int i = 0; i < 12; i++) {
		local_contact_set(&contact, &bad[i], most_n_m);
		is_near(local_contact_force(&contact, (double[]){0, 0, -0.01}).force_n, 0, 0, 0);
		assert_true(!i || local_contact_check(&bad[i]));
	}
	cau_tool_contact good = floor_record();
	assert_null(local_contact_check(&good));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_floor_pushes_as_far_as_it_is_pressed),
		cmocka_unit_test(friction_holds_up_to_coulombs_law),
		cmocka_unit_test(planes_share_a_force),
		cmocka_unit_test(a_grasp_pulls_both_ways),
		cmocka_unit_test(nothing_is_stiffer_than_the_bound),
		cmocka_unit_test(damaged_records_never_push),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
