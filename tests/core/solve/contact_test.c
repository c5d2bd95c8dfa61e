// SPDX-License-Identifier: GPL-3.0-or-later
// Contact and attachment at the solver's fixed point: no penetration, no pull, friction within its
// cone, and reactions that balance the gradient of eq. 4.
#include "solve/contact.h"

#include <stdlib.h>
#include <string.h>

#include "core/rig/rig.h"

// Largest error of a force, relative to the largest reaction, for a step that has converged to a
// residual of 1e-10.
static const double FORCE_TOLERANCE = 1e-5;
static const double GAP_TOLERANCE_M = 1e-8;
static const double RADIUS_M = 0.02, DEPTH_M = 0.004, MARGIN_M = 0.008;

typedef struct pressed {
	rig r;
	cau_tool_def tool;
	cau_contact_set *set;
} pressed;

// Makes a block that is pinned at its bottom.
static void make_of(pressed *p, double friction, int32_t along, int32_t across, int32_t deep)
{
	rig_begin(&p->r);
	rig_add_slab(&p->r, along, across, deep)->fat[0].young_modulus_pa = 4000;
	rig_pin_box(&p->r, (double[]){-1, -1, -1}, (double[]){1, 1, -0.0299});
	rig_build(&p->r, NULL, 1);
	rig_factor(&p->r);
	p->r.solver.settings.iterations = 600;
	p->r.solver.settings.tolerance = 1e-10;
	p->tool = tool_with_defaults(CAU_TOOL_SPHERE);
	p->tool.hot_radius_m = RADIUS_M;
	p->tool.friction = friction;
	p->set = cau_arena_array(&p->r.arena, 1, sizeof *p->set);
	assert_int_equal(
		cau_contact_create(p->set, &p->r.tissue, p->r.solver.kernels->vectors, &p->r.arena, NULL),
		CAU_OK);
	p->set->tool_count = 1;
	p->set->tool[0] = (cau_contact_tool){
		.def = &p->tool,
		.anchor = pose_at(0.004, -0.003, RADIUS_M - DEPTH_M),
		.part = CAU_PART_BOTH,
	};
}

static void make(pressed *p, double friction)
{
	make_of(p, friction, 12, 10, 4);
}

static double gap_of(const pressed *p, int32_t vertex, cau_vec3 *normal)
{
	const cau_contact_tool *tool = &p->set->tool[0];
	cau_pose pose = cau_coupling_pose(&tool->anchor, cau_vec3_of(tool->offset));
	return cau_tool_distance_at(tool->def, &pose, tool->jaw, CAU_PART_BOTH,
	                            cau_vec3_of(p->r.solver.position + 3 * vertex), normal);
}

static void touch(pressed *p, double slide_m)
{
	for (int32_t v = 0; v < p->r.tissue.vertex_count; v++) {
		if (p->r.fixed[v] || gap_of(p, v, NULL) > MARGIN_M)
			continue;
		cau_contact_row row = cau_contact_at_vertex(v, 0);
		memcpy(row.no_slip[0], p->r.tissue.rest + 3 * v, sizeof row.no_slip[0]);
		row.no_slip[0][0] += slide_m; // a vertex that stuck would have moved with the tool
		assert_true(cau_contact_add(p->set, &row));
	}
	assert_true(p->set->row_count > 4);
}

static void solve(pressed *p)
{
	cau_contact_prepare(p->set, &p->r.solver);
	p->r.solver.contact = p->set;
	assert_int_equal(cau_solver_run(&p->r.solver, NULL), CAU_OK);
	cau_solver_evaluate(&p->r.solver); // computes the gradient without reactions
}

// Checks that the gradient less the reactions is 0 at all vertices.
static void assert_balance(const pressed *p)
{
	size_t n = 3 * (size_t)p->r.tissue.vertex_count;
	double *left = calloc(n, sizeof *left), largest = 0;
	for (size_t i = 0; i < n; i++)
		left[i] = ((double *)p->r.solver.iterate.gradient)[4 * (i / 3) + i % 3];
	for (int32_t k = 0; k < p->set->row_count; k++) {
		const cau_contact_row *row = &p->set->row[k];
		largest = fmax(largest, cau_length(cau_vec3_of(row->reaction)));
		for (int c = 0; c < 3; c++)
			left[3 * row->vertex[0] + c] -= row->reaction[c];
	}
	assert_true(largest > 0);
	for (size_t i = 0; i < n; i++)
		if (!(fabs(left[i]) < FORCE_TOLERANCE * largest))
			fail_msg("%g N of %g are left over at %zu", left[i], largest, i);
	free(left);
}

static void test_pressed_without_and_with_friction(void **state)
{
	(void)state;
	static const double frictions[] = {0, 0.3, 2};
	for (size_t f = 0; f < 3; f++) {
		pressed p;
		make(&p, frictions[f]);
		touch(&p, 0.001);
		solve(&p);
		assert_balance(&p);
		double largest = 0, sideways = 0;
		int32_t pushing = 0, idle = 0;
		for (int32_t k = 0; k < p.set->row_count; k++)
			largest = fmax(largest, cau_length(cau_vec3_of(p.set->row[k].reaction)));
		for (int32_t k = 0; k < p.set->row_count; k++) {
			const cau_contact_row *row = &p.set->row[k];
			cau_vec3 normal, reaction = cau_vec3_of(row->reaction);
			double gap = gap_of(&p, row->vertex[0], &normal), push = cau_dot(reaction, normal);
			cau_vec3 tangent = cau_add_scaled(reaction, -push, normal);
			assert_true(gap > -GAP_TOLERANCE_M);            // no penetration
			assert_true(push > -FORCE_TOLERANCE * largest); // no pull
			assert_true(push < FORCE_TOLERANCE * largest ||
			            gap < GAP_TOLERANCE_M); // either a push or a gap
			assert_true(cau_length(tangent) <= frictions[f] * push + FORCE_TOLERANCE * largest);
			pushing += push > FORCE_TOLERANCE * largest;
			idle += gap > 1e-4;
			sideways += tangent.x;
		}
		assert_true(pushing > 3 && idle > 0);
		assert_true(frictions[f] == 0 || sideways > 0); // the tool carries the vertex along
		for (int32_t v = 0; v < p.r.tissue.vertex_count; v++)
			assert_true(gap_of(&p, v, NULL) > -GAP_TOLERANCE_M);
		rig_finish(&p.r);
	}
}

// Checks that the kept columns have the same values as S.
static void assert_columns_are_whole(const pressed *p)
{
	for (int32_t i = 0; i < p->set->columns.count; i++)
		for (int32_t k = 0; k < p->set->columns.count; k++)
			assert_near(p->r.solver.kernels->vectors->at(p->set->columns.whole[i],
			                                             p->set->columns.vertex[k]),
			            p->set->columns.inverse[i * CAU_MAX_COLUMNS + k], 1e-12);
}

// Solves with more constraints than whole columns, then with few constraints again. The solution
// satisfies the same conditions in both cases.
static void test_rows_beyond_whole_columns(void **state)
{
	(void)state;
	const double shallow_m = 0.001;
	pressed p;
	make_of(&p, 0.3, 20, 18, 2);
	p.tool.hot_radius_m = 0.2;
	for (int round = 0; round < 2; round++) {
		p.set->tool[0].anchor = pose_at(0.004, -0.003, 0.2 - (round ? shallow_m : DEPTH_M));
		cau_contact_clear(p.set);
		memcpy(p.r.solver.position, p.r.tissue.rest,
		       3 * (size_t)p.r.tissue.vertex_count * sizeof *p.r.solver.position);
		for (int32_t v = 0; v < p.r.tissue.vertex_count; v++) {
			cau_contact_row row = cau_contact_at_vertex(v, 0);
			memcpy(row.no_slip[0], p.r.tissue.rest + 3 * v, sizeof row.no_slip[0]);
			if (!p.r.fixed[v] && p.r.tissue.rest[3 * v + 2] > -1e-9 &&
			    gap_of(&p, v, NULL) < (round ? shallow_m : MARGIN_M))
				assert_true(cau_contact_add(p.set, &row));
		}
		assert_true(cau_contact_is_wide(p.set) == !round);
		solve(&p);
		assert_true(p.set->columns.count <= CAU_WHOLE_COLUMNS || !round);
		if (round)
			assert_columns_are_whole(&p);
		assert_balance(&p);
		for (int32_t v = 0; v < p.r.tissue.vertex_count; v++)
			assert_true(gap_of(&p, v, NULL) > -GAP_TOLERANCE_M);
	}
	rig_finish(&p.r);
}

static int32_t top_vertex(const pressed *p)
{
	for (int32_t v = 0; v < p->r.tissue.vertex_count; v++) {
		const double *x = p->r.tissue.rest + 3 * v;
		if (fabs(x[0]) < 1e-9 && fabs(x[1]) < 1e-9 && x[2] > -1e-9)
			return v;
	}
	fail();
	return -1;
}

// A grasped vertex is pulled to its anchor by a spring, at most with the slip force.
static void test_attachment_is_a_spring_that_slips(void **state)
{
	(void)state;
	static const double slips[] = {100, 0.02};
	for (int s = 0; s < 2; s++) {
		pressed p;
		make(&p, 0);
		p.tool.slip_force_n = slips[s];
		int32_t v = top_vertex(&p);
		cau_contact_row row = cau_contact_at_vertex(v, 0);
		row.attached = true;
		memcpy(row.anchor, p.r.tissue.rest + 3 * v, sizeof row.anchor);
		row.anchor[2] += 0.01;
		row.anchor[0] += 0.003;
		assert_true(cau_contact_add(p.set, &row));
		solve(&p);
		assert_balance(&p);
		cau_vec3 reaction = cau_vec3_of(p.set->row[0].reaction);
		cau_vec3 offset = cau_vec3_of(p.set->tool[0].offset); // the tool yields by this offset
		cau_vec3 away = cau_sub(cau_add(cau_vec3_of(row.anchor), offset),
		                        cau_vec3_of(p.r.solver.position + 3 * v));
		double force = p.tool.grasp_stiffness_n_m * cau_length(away);
		assert_int_equal(p.set->row[0].slipping, s);
		assert_near(cau_length(reaction), s ? slips[s] : force, FORCE_TOLERANCE * force);
		assert_true(!s || force > slips[s]);         // the spring would pull harder
		cau_vec3 across = cau_cross(reaction, away); // the reaction is along the spring
		assert_true(cau_length(across) < 1e-4 * cau_length(reaction) * cau_length(away));
		rig_finish(&p.r);
	}
}

static void test_a_full_set_says_so(void **state)
{
	(void)state;
	pressed p;
	make(&p, 0);
	cau_contact_row row = cau_contact_at_vertex(top_vertex(&p), 0);
	for (int k = 0; k < CAU_MAX_CONTACTS; k++)
		assert_true(cau_contact_add(p.set, &row));
	assert_false(cau_contact_add(p.set, &row));
	assert_int_equal(p.set->row_count, CAU_MAX_CONTACTS);
	assert_int_equal(p.set->left_out_count, 1);
	rig_finish(&p.r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_pressed_without_and_with_friction),
		cmocka_unit_test(test_rows_beyond_whole_columns),
		cmocka_unit_test(test_attachment_is_a_spring_that_slips),
		cmocka_unit_test(test_a_full_set_says_so),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
