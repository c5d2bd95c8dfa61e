// SPDX-License-Identifier: GPL-3.0-or-later
// Whole sessions against finite elements. Every case of tests/reference runs to static equilibrium
// and is compared with the stored solution on the same mesh. The stored solution of an indentation
// keeps only vertices outside the ball. It is solved further here with contact of faces.
#include "core/session/indent.h"

#include <dirent.h>
#include <stdio.h>

#include "reference/case.h"
#include "session/session_internal.h"

// Largest error, as a share of the case's largest displacement or largest force component.
static const double tolerance = 1e-3;

enum { MOVING_TICKS = 40, SETTLING_TICKS = 80, ITERATIONS = 100 };
// Relative residual of each step, far below the tolerances.
static const double residual = 1e-7;
// Damping of motion, 1/s: near critical damping for the cantilever, the softest case.
static const double damping_per_s = 26;
static const double longest_step = 1.0 / 30; // s; with a long step, inertia is least

static char *mesh_text(const cau_reference_case *reference, size_t *bytes)
{
	size_t capacity = 200 + 100 * (size_t)(reference->vertex_count + reference->tetrahedron_count);
	char *text = malloc(capacity), *at = text;
	assert_non_null(text);
	at +=
		sprintf(at, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n%d\n", reference->vertex_count);
	for (int32_t v = 0; v < reference->vertex_count; v++) {
		const double *x = reference->position + 3 * (size_t)v;
		at += sprintf(at, "%d %.17g %.17g %.17g\n", v + 1, x[0], x[1], x[2]);
	}
	at += sprintf(at, "$EndNodes\n$Elements\n%d\n", reference->tetrahedron_count);
	for (int32_t t = 0; t < reference->tetrahedron_count; t++) {
		const int32_t *v = reference->tetrahedron + 4 * (size_t)t;
		at += sprintf(at, "%d 4 0 %d %d %d %d\n", t + 1, v[0] + 1, v[1] + 1, v[2] + 1, v[3] + 1);
	}
	at += sprintf(at, "$EndElements\n");
	*bytes = (size_t)(at - text);
	return text;
}

// Pins the box around some vertices. All supports of the cases are whole faces of a block.
static void pin_face(cau_scene_def *scene, const cau_reference_case *reference, int32_t count,
                     const int32_t *vertex)
{
	const double slack = 1e-9; // m, margin of the box, far below the length of an edge
	double least[3] = {INFINITY, INFINITY, INFINITY}, most[3] = {-INFINITY, -INFINITY, -INFINITY};
	for (int32_t k = 0; k < count; k++)
		for (size_t c = 0; c < 3; c++) {
			double x = reference->position[3 * (size_t)vertex[k] + c];
			least[c] = fmin(least[c], x - slack);
			most[c] = fmax(most[c], x + slack);
		}
	if (count)
		stage_pin_box(scene, least, most);
}

static cau_scene_def *scene_of(const cau_reference_case *reference, const char *text, size_t bytes)
{
	const double any_size[3] = {1, 1, 1};
	const int32_t any_cells[3] = {1, 1, 1};
	cau_scene_def *scene = stage_scene(CAU_PRECISION_DOUBLE);
	cau_layer_def *fat = stage_add_slab(scene, "body", any_size, any_cells);
	cau_mesh_def *mesh = stage_mesh_of(scene, fat);
	mesh->source = CAU_MESH_BYTES;
	strcpy(mesh->file, "case.msh");
	mesh->bytes = text;
	mesh->byte_count = bytes;
	fat->fat[0].model = reference->model;
	fat->fat[0].young_modulus_pa = reference->young_modulus_pa;
	fat->fat[0].poisson_ratio = reference->poisson_ratio;
	fat->fat[0].density_kg_m3 = reference->density_kg_m3;
	memcpy(scene->gravity_m_s2, reference->gravity_m_s2, sizeof scene->gravity_m_s2);
	scene->step_s = longest_step;
	scene->damping_per_s = damping_per_s;
	scene->iterations = ITERATIONS;
	scene->tolerance = residual;
	pin_face(scene, reference, reference->fixed_count, reference->fixed);
	pin_face(scene, reference, reference->prescribed_count, reference->prescribed);
	if (reference->sphere_radius_m > 0) {
		cau_tool_def *ball = stage_add_tool(scene, "ball", CAU_TOOL_SPHERE, 0, 0, 0);
		ball->hot_radius_m = reference->sphere_radius_m;
		ball->friction = 0;
		// The coupling yields by 4 um/N, so the ball is practically at its commanded pose.
		ball->force_max_n = 1000;
		ball->pose.position_m[2] = reference->sphere_radius_m + 1e-4; // just above the body
	}
	return scene;
}

static void lead_supports(cau_session *session, const cau_reference_case *reference, double share)
{
	double *place = malloc(3 * (size_t)reference->prescribed_count * sizeof *place + 1);
	assert_non_null(place);
	for (size_t k = 0; k < (size_t)reference->prescribed_count; k++)
		for (size_t c = 0; c < 3; c++)
			place[3 * k + c] = reference->position[3 * (size_t)reference->prescribed[k] + c] +
			                   share * reference->prescribed_move[3 * k + c];
	cau_error error = {0};
	assert_int_equal(cau_session_drive(session, reference->prescribed_count, reference->prescribed,
	                                   place, &error),
	                 CAU_OK);
	free(place);
}

static void run_to_rest(cau_session *session, const cau_reference_case *reference)
{
	const double *end = reference->sphere_center_m, above = reference->sphere_radius_m + 1e-4;
	for (int tick = 1; tick <= MOVING_TICKS + SETTLING_TICKS; tick++) {
		double share = fmin((double)tick / MOVING_TICKS, 1);
		lead_supports(session, reference, share);
		if (reference->sphere_radius_m > 0)
			stage_move(session, "ball", end[0], end[1], above + share * (end[2] - above));
		stage_step(session, 1);
	}
}

// Returns the force that holds some vertices: the sum of the elements' gradient, less the vertices'
// weight.
static void hold_force(const cau_session *session, int32_t count, const int32_t *vertex,
                       double force[3])
{
	memset(force, 0, 3 * sizeof *force);
	for (int32_t k = 0; k < count; k++)
		for (int c = 0; c < 3; c++)
			force[c] += cau_real_get(session->solver.iterate.gradient,
			                         session->solver.elements.single, 4 * (int64_t)vertex[k] + c) -
			            session->tissue.mass[vertex[k]] * session->scene->gravity_m_s2[c];
}

static double largest(const double *numbers, int32_t count)
{
	double most = 0;
	for (int32_t i = 0; i < count; i++)
		most = fmax(most, fabs(numbers[i]));
	return most;
}

static double difference(const double a[3], const double b[3])
{
	return cau_length(cau_sub(cau_vec3_of(a), cau_vec3_of(b)));
}

// Returns the largest error of a displacement, relative to the largest displacement.
static double displacement_error(const cau_session *session, const cau_reference_case *reference)
{
	cau_frame frame = stage_frame(session);
	size_t n = 3 * (size_t)reference->vertex_count;
	double *expected = malloc(n * sizeof *expected);
	assert_non_null(expected);
	for (size_t i = 0; i < n; i++)
		expected[i] = reference->position[i] + reference->displacement[i];
	double error = stage_farthest(&frame, expected, reference->vertex_count);
	free(expected);
	return error / largest(reference->displacement, 3 * reference->vertex_count);
}

static double force_error(cau_session *session, const cau_reference_case *reference)
{
	double reaction[3], hold[3];
	stage_balance(session); // leaves the elements' gradient in the solver
	hold_force(session, reference->fixed_count, reference->fixed, reaction);
	hold_force(session, reference->prescribed_count, reference->prescribed, hold);
	double error =
		fmax(difference(reaction, reference->reaction_n), difference(hold, reference->hold_n));
	if (reference->sphere_radius_m > 0) {
		cau_vec3 felt = cau_vec3_of(stage_tool(session, "ball")->raw_force_n);
		double on_body[3];
		cau_vec3_to(cau_scale(-1, felt), on_body);
		error = fmax(error, difference(on_body, reference->contact_n));
	}
	return error / largest(reference->reaction_n, 3);
}

// ---- contact of the ball with faces

static int32_t top_faces_of(const cau_reference_case *reference, int32_t *face)
{
	int32_t count = 0;
	for (int32_t t = 0; t < reference->tetrahedron_count; t++)
		for (int left_out = 0; left_out < 4; left_out++) {
			bool top = true;
			for (int k = 1; k < 4; k++) {
				int32_t v = reference->tetrahedron[4 * (size_t)t + (size_t)((left_out + k) % 4)];
				top = top && reference->position[3 * (size_t)v + 2] > -1e-9;
				face[3 * (size_t)count + (size_t)k - 1] = v;
			}
			count += top;
		}
	return count;
}

static void *room(size_t count, size_t bytes)
{
	void *made = calloc(count, bytes);
	assert_non_null(made);
	return made;
}

// Replaces the solution for contact with vertices by that for contact with faces. The solver starts
// from the solution for contact with vertices.
static void let_faces_bear(cau_reference_case *reference)
{
	size_t n = (size_t)reference->vertex_count, faces = 4 * (size_t)reference->tetrahedron_count;
	int32_t *surface = room(n, sizeof *surface), *face = room(3 * faces, sizeof *face);
	bool *fixed = room(n, sizeof *fixed);
	double *position = room(3 * n, sizeof *position);
	for (int32_t k = 0; k < reference->fixed_count; k++)
		fixed[reference->fixed[k]] = true;
	for (size_t i = 0; i < 3 * n; i++)
		position[i] = reference->position[i] + reference->displacement[i];
	cau_indented_body body = {.vertex_count = reference->vertex_count,
	                          .tetrahedron_count = reference->tetrahedron_count,
	                          .surface_count = cau_reference_case_top(reference, surface),
	                          .rest = reference->position,
	                          .tetrahedron = reference->tetrahedron,
	                          .surface = surface,
	                          .face_count = top_faces_of(reference, face),
	                          .face = face,
	                          .fixed = fixed,
	                          .model = reference->model,
	                          .young_modulus_pa = reference->young_modulus_pa,
	                          .poisson_ratio = reference->poisson_ratio};
	cau_indenting_ball ball = {.radius_m = reference->sphere_radius_m,
	                           .dip_m = indent_dip_m(reference->sphere_radius_m)};
	memcpy(ball.centre_m, reference->sphere_center_m, sizeof ball.centre_m);
	cau_indented solved = {0};
	assert_true(cau_indented_solve(&body, &ball, position, &solved));
	for (size_t i = 0; i < 3 * n; i++)
		reference->displacement[i] = position[i] - reference->position[i];
	for (int c = 0; c < 3; c++) { // the body has no weight
		reference->contact_n[c] = -solved.force_n[c];
		reference->reaction_n[c] = solved.force_n[c];
	}
	free(surface);
	free(face);
	free(fixed);
	free(position);
}

static void compare(const char *path)
{
	cau_reference_case reference = {0};
	cau_error error = {0};
	if (cau_reference_case_read(path, &reference, &error))
		fail_msg("%s: %s", path, error.reason);
	size_t bytes;
	char *text = mesh_text(&reference, &bytes);
	cau_scene_def *scene = scene_of(&reference, text, bytes);
	cau_session *session = stage_open(scene, 1);
	cau_session_info info = stage_info(session);
	assert_int_equal(info.vertex_count, reference.vertex_count);
	assert_memory_equal(info.rest_position, reference.position,
	                    3 * (size_t)reference.vertex_count * sizeof(double));
	double started = stage_seconds();
	run_to_rest(session, &reference);
	if (reference.sphere_radius_m > 0)
		let_faces_bear(&reference);
	double moved = displacement_error(session, &reference),
		   pushed = force_error(session, &reference);
	print_message(
		"%-32s displacement %.1e, force %.1e of the same mesh's; mesh against a converged "
		"one %+.1f %%; %.1f s\n",
		reference.name, moved, pushed, 100 * (reference.measure / reference.measure_converged - 1),
		stage_seconds() - started);
	if (!(moved <= tolerance && pushed <= tolerance))
		fail_msg("%s: displacement off by %g, force by %g, allowed %g", reference.name, moved,
		         pushed, tolerance);
	cau_session_destroy(session);
	free(scene);
	free(text);
	cau_reference_case_finish(&reference);
}

static void each_case(const char *prefix, int least_count)
{
	DIR *folder = opendir(CAU_TEST_REFERENCE);
	assert_non_null(folder);
	int count = 0;
	for (struct dirent *entry; (entry = readdir(folder));) {
		size_t length = strlen(entry->d_name);
		if (strncmp(entry->d_name, prefix, strlen(prefix)) != 0 || length < 5 ||
		    strcmp(entry->d_name + length - 5, ".case") != 0)
			continue;
		char path[1024];
		snprintf(path, sizeof path, "%s/%s", CAU_TEST_REFERENCE, entry->d_name);
		compare(path);
		count++;
	}
	closedir(folder);
	assert_true(count >= least_count);
}

static void a_pulled_block(void **state)
{
	(void)state;
	each_case("block_", 3);
}

static void a_cantilever(void **state)
{
	(void)state;
	each_case("cantilever_", 4);
}

static void a_twisted_beam(void **state)
{
	(void)state;
	each_case("twist_", 2);
}

static void an_indentation(void **state)
{
	(void)state;
	each_case("indentation_", 3);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_pulled_block),
		cmocka_unit_test(a_cantilever),
		cmocka_unit_test(a_twisted_beam),
		cmocka_unit_test(an_indentation),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
