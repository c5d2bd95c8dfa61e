// SPDX-License-Identifier: GPL-3.0-or-later
// Properties of every shape and part: distances are signed and 1-Lipschitz, and gradients agree
// with central differences. Bounds contain the part. Segments agree with dense sampling. Also tests
// which points are between the jaws.
#include "tool/tool_shape.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "core/tool/tools.h"
#include "tool/family.h"

enum { POINTS = 2000 };

static const double BOX_M = 0.015;      // half the side of the box of random points
static const double ROUNDING_M = 1e-14; // largest error: rounding of distances near 0.1 m
static const double JAWS[] = {0, 0.3, 1};

typedef void (*check)(const cau_tool_def *tool, double jaw, cau_tool_part part);

// Sizes of tools that are tested: the defaults, a fine tool, a tool that is wider than long, a tool
// whose jaws are thicker than long, and the extremes that a scene allows.
static const double sizes[][3] = {
	{3e-3, 8e-3, 2.5e-3}, {4e-4, 1e-2, 2e-3}, {6e-3, 4e-3, 5e-3}, {4e-3, 1e-3, 4e-3},
	{0.05, 1e-3, 2e-4},   {0.05, 1e-3, 0.05}, {2e-4, 0.1, 0.05},  {2e-4, 1e-3, 2e-4},
};
enum { SIZES = sizeof sizes / sizeof *sizes };

static void for_every_part(check check_part)
{
	for (int shape = 0; shape < CAU_TOOL_SHAPE_COUNT; shape++)
		for (int size = 0; size < SIZES; size++)
			for (int j = 0; j < 3; j++)
				for (int part = CAU_PART_HOT; part <= CAU_PART_BOTH; part++) {
					cau_tool_def tool = tool_with_defaults(shape);
					tool.hot_radius_m = sizes[size][0];
					tool.tip_length_m = sizes[size][1];
					tool.shaft_radius_m = sizes[size][2];
					check_part(&tool, JAWS[j], (cau_tool_part)part);
				}
}

// Properties of each shape in the table of scene.h.
typedef struct table_row {
	bool hot, jaws;
	const cau_tool_family *family;
} table_row;

static const table_row rows[] = {
#define X(code, word, hot, jaws, meaning) {hot, jaws, &cau_shape_##word},
	CAU_TOOL_SHAPE_TABLE(X)
#undef X
};

static int lacks(const cau_tool_def *tool, cau_tool_part part)
{
	return !rows[tool->shape].hot && part == CAU_PART_HOT;
}

// The columns of the table in scene.h agree with the functions that a shape has.
static void test_rows_say_what_shapes_have(void **state)
{
	(void)state;
	for (int shape = 0; shape < CAU_TOOL_SHAPE_COUNT; shape++) {
		cau_tool_def tool = tool_with_defaults(shape);
		const cau_tool_family *family = rows[shape].family;
		// every shape has a cold part, which pushes
		assert_true(family->cold && family->cold_bound);
		assert_int_equal(family->hot != NULL, rows[shape].hot);
		assert_int_equal(family->hot_bound != NULL, rows[shape].hot);
		assert_int_equal(family->thinnest_hot != NULL, rows[shape].hot);
		assert_int_equal(isfinite(cau_tool_thinnest_hot_m(&tool)) != 0, rows[shape].hot);
		assert_int_equal(cau_tool_has_jaws(&tool), rows[shape].jaws);
	}
}

// Returns half the size of the box of random points about a tool. The box contains the tool's hot
// part.
static double box_of(const cau_tool_def *tool)
{
	return fmax(BOX_M,
	            1.5 * fmax(fmax(tool->hot_radius_m, tool->tip_length_m), tool->shaft_radius_m));
}

static void check_lipschitz(const cau_tool_def *tool, double jaw, cau_tool_part part)
{
	if (lacks(tool, part))
		return;
	uint64_t random = 5;
	for (int i = 0; i < POINTS; i++) {
		// both distant and near pairs of points
		double box = box_of(tool), reach = i % 2 ? box : box / 100;
		cau_vec3 a = random_point(&random, box);
		cau_vec3 b = cau_add(a, random_point(&random, reach));
		double change = cau_tool_distance(tool, jaw, part, a, NULL) -
		                cau_tool_distance(tool, jaw, part, b, NULL);
		assert_true(fabs(change) <= cau_length(cau_sub(a, b)) + ROUNDING_M);
	}
}

static void test_lipschitz(void **state)
{
	(void)state;
	for_every_part(check_lipschitz);
}

// Compares gradients with central differences of step h. On a crease the gradient is not unique.
// Where two surfaces meet at an angle, the differences do not have unit length. Where two surfaces
// are nearly in one plane, the gradient turns within the step, and the differences are between the
// gradients of both surfaces.
static void check_gradient(const cau_tool_def *tool, double jaw, cau_tool_part part)
{
	static const double H_M = 1e-7;
	// Largest error of a difference. Truncation is h^2 / (3 R^2), where R is the distance to a
	// core, at least 1e-5 m at the points that are compared. Rounding is 1e-17 / h.
	static const double TOLERANCE = 1e-4;
	if (lacks(tool, part))
		return;
	uint64_t random = 7;
	int compared = 0;
	for (int i = 0; i < POINTS; i++) {
		cau_vec3 p = random_point(&random, box_of(tool)), g, difference, above, below;
		double *out[3] = {&difference.x, &difference.y, &difference.z}, turned = 0;
		cau_tool_distance(tool, jaw, part, p, &g);
		assert_near(cau_length(g), 1, 1e-12);
		for (int axis = 0; axis < 3; axis++) {
			double step[3] = {0};
			step[axis] = H_M;
			cau_vec3 h = cau_vec3_of(step);
			*out[axis] = (cau_tool_distance(tool, jaw, part, cau_add(p, h), &above) -
			              cau_tool_distance(tool, jaw, part, cau_sub(p, h), &below)) /
			             (2 * H_M);
			turned = fmax(turned, cau_length(cau_sub(above, below)));
		}
		if (fabs(cau_length(difference) - 1) > TOLERANCE)
			continue;
		assert_true(cau_length(cau_sub(difference, g)) < fmax(TOLERANCE * 2, turned));
		compared++;
	}
	assert_true(compared > POINTS * 99 / 100); // few points are near creases
}

static void test_gradient(void **state)
{
	(void)state;
	for_every_part(check_gradient);
}

// A path against the gradient, from an outside point and as long as the distance there, ends on the
// surface. A micrometre further the path is inside. No point of the part is outside its bound.
static void check_surface_and_bound(const cau_tool_def *tool, double jaw, cau_tool_part part)
{
	if (lacks(tool, part))
		return;
	cau_vec3 center;
	double radius;
	cau_tool_bound(tool, part, &center, &radius);
	uint64_t random = 9;
	int outside = 0;
	for (int i = 0; i < POINTS; i++) {
		cau_vec3 g, p = random_point(&random, i % 2 ? box_of(tool) : 2 * tool->hot_radius_m);
		double d = cau_tool_distance(tool, jaw, part, p, &g);
		outside += d > 0;
		double to_bound = cau_length(cau_sub(p, center)) - radius;
		assert_true(d >= to_bound - ROUNDING_M);
		if (d > 0) {
			cau_vec3 foot = cau_add_scaled(p, -d, g);
			assert_near(cau_tool_distance(tool, jaw, part, foot, NULL), 0, 1e-12);
			cau_vec3 within = cau_add_scaled(foot, -1e-6, g);
			assert_true(cau_tool_distance(tool, jaw, part, within, NULL) < 0);
		}
	}
	assert_true(outside > 0);
}

static void test_surface_and_bound(void **state)
{
	(void)state;
	for_every_part(check_surface_and_bound);
}

// The cold part does not cover the surface of the hot part: no point is inside both.
static void check_not_covered(const cau_tool_def *tool, double jaw, cau_tool_part part)
{
	if (part != CAU_PART_BOTH || lacks(tool, CAU_PART_HOT))
		return;
	if (tool->tip_length_m < 2 * tool->hot_radius_m)
		return; // jaws that are wider than long turn into the shaft
	uint64_t random = 13;
	for (int i = 0; i < POINTS; i++) {
		cau_vec3 p = random_point(&random, box_of(tool));
		double hot = cau_tool_distance(tool, jaw, CAU_PART_HOT, p, NULL);
		double cold = cau_tool_distance(tool, jaw, CAU_PART_COLD, p, NULL);
		assert_true(hot + cold > -ROUNDING_M);
	}
}

static void test_hot_is_not_covered(void **state)
{
	(void)state;
	for_every_part(check_not_covered);
}

static void test_tip_is_hot(void **state)
{
	(void)state;
	for (int shape = 0; shape < CAU_TOOL_SHAPE_COUNT; shape++) {
		cau_tool_def tool = tool_with_defaults(shape);
		if (lacks(&tool, CAU_PART_HOT))
			continue;
		double d = cau_tool_distance(&tool, 0, CAU_PART_HOT, (cau_vec3){0, 0, 0}, NULL);
		if (shape == CAU_TOOL_BIPOLAR) // the tip is between the closed plates
			assert_near(d, 0, ROUNDING_M);
		else
			assert_near(d, -cau_tool_thinnest_hot_m(&tool), ROUNDING_M);
	}
}

// Points on the surfaces that README.md describes, with the normal there, for r 3 mm, L 8 mm, s 2.5
// mm, t 1.2 mm (grasper 1 mm).
static void test_known_surfaces(void **state)
{
	(void)state;
	static const double SQUARE = 0.70710678118654752;
	static const struct {
		int shape;
		cau_tool_part part;
		double jaw;
		cau_vec3 point, normal;
	} known[] = {
		{CAU_TOOL_SPHERE, CAU_PART_HOT, 0, {0, -3e-3, 0}, {0, -1, 0}},
		{CAU_TOOL_SPHERE, CAU_PART_COLD, 0, {0, 0, 3e-3}, {0, 0, -1}},
		{CAU_TOOL_SPHERE, CAU_PART_COLD, 0, {2.5e-3, 0, 50e-3}, {1, 0, 0}},
		{CAU_TOOL_SPHERE, CAU_PART_COLD, 0, {0, 0, 123e-3}, {0, 0, 1}},
		{CAU_TOOL_CAPSULE, CAU_PART_HOT, 0, {0, 0, -3e-3}, {0, 0, -1}},
		{CAU_TOOL_CAPSULE, CAU_PART_HOT, 0, {0, 3e-3, 7e-3}, {0, 1, 0}},
		{CAU_TOOL_HOOK, CAU_PART_HOT, 0, {7e-3, 0, 0}, {1, 0, 0}},
		{CAU_TOOL_HOOK, CAU_PART_HOT, 0, {-1e-3, 0, -3e-3}, {0, 0, -1}},
		{CAU_TOOL_HOOK, CAU_PART_HOT, 0, {-7e-3, 0, 2e-3}, {-1, 0, 0}},
		{CAU_TOOL_HOOK,
	     CAU_PART_HOT,
	     0,
	     {-2e-3 - 5e-3 * SQUARE, 0, 2e-3 - 5e-3 * SQUARE},
	     {-SQUARE, 0, -SQUARE}},
		// the neck's end on the heel
		{CAU_TOOL_HOOK, CAU_PART_COLD, 0, {-4e-3, 0, 5e-3}, {0, 0, -1}},
		{CAU_TOOL_SPATULA, CAU_PART_HOT, 0, {3e-3, 0, 4e-3}, {1, 0, 0}},
		{CAU_TOOL_SPATULA, CAU_PART_HOT, 0, {1e-3, 1.2e-3, 4e-3}, {0, 1, 0}},
		{CAU_TOOL_SPATULA, CAU_PART_HOT, 0, {1e-3, 0, -1.2e-3}, {0, 0, -1}},
		{CAU_TOOL_BIPOLAR, CAU_PART_HOT, 0, {2.4e-3, 0, 2e-3}, {1, 0, 0}},
		{CAU_TOOL_BIPOLAR, CAU_PART_HOT, 0, {-1.2e-3, 0, -1.2e-3}, {0, 0, -1}},
		{CAU_TOOL_BIPOLAR, CAU_PART_COLD, 0, {-4.8e-3, 0, 2e-3}, {-1, 0, 0}},
		{CAU_TOOL_SHEARS, CAU_PART_HOT, 1, {-3e-3, 0, 2e-3}, {-1, 0, 0}},
		{CAU_TOOL_SHEARS, CAU_PART_COLD, 0, {3e-3, 0, 4e-3}, {-1, 0, 0}},
		{CAU_TOOL_SHEARS, CAU_PART_COLD, 0, {5.4e-3, 0, 4e-3}, {1, 0, 0}},
		{CAU_TOOL_GRASPER, CAU_PART_COLD, 0, {-2e-3, 0, 2e-3}, {-1, 0, 0}},
		{CAU_TOOL_GRASPER, CAU_PART_COLD, 0, {1e-3, 2.5e-3, 2e-3}, {0, 1, 0}},
		/* a new shape's points go above this line */
	};
	for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
		cau_tool_def tool = tool_with_defaults(known[i].shape);
		cau_vec3 g, outside = cau_add_scaled(known[i].point, 1e-4, known[i].normal);
		double jaw = known[i].jaw;
		double d = cau_tool_distance(&tool, jaw, known[i].part, known[i].point, NULL);
		assert_near(d, 0, ROUNDING_M);
		d = cau_tool_distance(&tool, jaw, known[i].part, outside, &g);
		assert_near(d, 1e-4, ROUNDING_M);
		assert_near(cau_dot(g, known[i].normal), 1, 1e-9);
	}
}

// Opening turns the jaws about the hinge at z = L. The test follows the middle of a face, at an arm
// of 4 mm.
static void test_jaws_open(void **state)
{
	(void)state;
	for (int shape = CAU_TOOL_BIPOLAR; shape <= CAU_TOOL_GRASPER; shape++) {
		cau_tool_def tool = tool_with_defaults(shape);
		int shears = shape == CAU_TOOL_SHEARS;
		cau_tool_part part = shape == CAU_TOOL_BIPOLAR ? CAU_PART_HOT : CAU_PART_COLD;
		double face = shears ? tool.hot_radius_m : 0, arm = 4e-3;
		double angle = 0.5 * tool.jaw_open_rad / (shears ? 1 : 2);
		cau_vec3 point = {face * cos(angle) + arm * sin(angle), 0,
		                  tool.tip_length_m - arm * cos(angle) + face * sin(angle)};
		cau_vec3 g;
		assert_near(cau_tool_distance(&tool, 0.5, part, point, &g), 0, ROUNDING_M);
		assert_near(g.x, -cos(angle), 1e-9);
		assert_near(g.z, -sin(angle), 1e-9);
		point.x = -point.x; // the other jaw is the mirror image; shears have their blade there
		double mirrored = cau_tool_distance(&tool, 0.5, part, point, NULL);
		assert_true(shears ? mirrored > 1e-3 : fabs(mirrored) < ROUNDING_M);
	}
}

static void test_a_part_that_lacks_is_nowhere(void **state)
{
	(void)state;
	cau_tool_def tool = tool_with_defaults(CAU_TOOL_GRASPER);
	cau_vec3 origin = {0, 0, 0}, g;
	assert_true(isinf(cau_tool_distance(&tool, 0, CAU_PART_HOT, origin, &g)));
	assert_true(isinf(cau_tool_thinnest_hot_m(&tool)));
	assert_false(cau_tool_meets_segment(&tool, 0, CAU_PART_HOT, origin, (cau_vec3){1e-3, 0, 0}));
	assert_true(cau_tool_meets_segment(&tool, 0, CAU_PART_COLD, origin, (cau_vec3){1e-3, 0, 0}));
}

static void test_world_frame(void **state)
{
	(void)state;
	cau_tool_def tool = tool_with_defaults(CAU_TOOL_HOOK);
	cau_pose pose = pose_turned((cau_vec3){0.2, -0.1, 0.4}, (cau_vec3){1, 2, 3}, 0.8);
	uint64_t random = 3;
	for (int i = 0; i < 200; i++) {
		cau_vec3 local = random_point(&random, BOX_M), g, g_world;
		cau_vec3 world = cau_pose_to_world(&pose, local);
		double d = cau_tool_distance(&tool, 0, CAU_PART_BOTH, local, &g);
		double d_world = cau_tool_distance_at(&tool, &pose, 0, CAU_PART_BOTH, world, &g_world);
		assert_near(d, d_world, 1e-13);
		// The direction differs by about 1e-16 m / 1e-4 m, because the two computations round
		// differently.
		assert_true(cau_length(cau_sub(cau_rotate(pose.rotation, g), g_world)) < 1e-9);
	}
}

// Returns the end of a segment from `a` towards the nearest point of the part. The segment ends
// before that point or inside the part.
static cau_vec3 aimed(const cau_tool_def *tool, double jaw, cau_tool_part part, cau_vec3 a,
                      uint64_t *random)
{
	cau_vec3 g;
	double d = cau_tool_distance(tool, jaw, part, a, &g);
	return cau_add_scaled(a, -d * random_between(random, 0.5, 1.5), g);
}

// Compares with samples at the spacing `gap`: they give a segment's least distance to within gap /
// 2.
static void check_segments(const cau_tool_def *tool, double jaw, cau_tool_part part)
{
	enum { SEGMENTS = 400, SAMPLES = 300 };
	static const double EXACT_M = 1e-6;
	if (lacks(tool, part))
		return;
	uint64_t random = 17;
	int met = 0, missed = 0;
	for (int i = 0; i < SEGMENTS; i++) {
		// kind of segment, by i % 4: 0 long, 1 short, 2 near the tip, 3 towards the nearest point
		double box = box_of(tool);
		cau_vec3 a = random_point(&random, i % 4 == 2 ? tool->hot_radius_m : box);
		cau_vec3 b = i % 4 == 3 ? aimed(tool, jaw, part, a, &random)
		                        : cau_add(a, random_point(&random, i % 4 ? box / 10 : box));
		double gap = cau_length(cau_sub(b, a)) / SAMPLES, least = INFINITY;
		for (int k = 0; k <= SAMPLES; k++) {
			cau_vec3 p = cau_add_scaled(a, (double)k / SAMPLES, cau_sub(b, a));
			least = fmin(least, cau_tool_distance(tool, jaw, part, p, NULL));
		}
		int meets = cau_tool_meets_segment(tool, jaw, part, a, b);
		if (least <= 0)
			assert_true(meets);
		if (least > EXACT_M + gap / 2)
			assert_false(meets);
		met += meets;
		missed += !meets;
	}
	assert_true(met > 0 && missed > 0);
}

static void test_segments_against_sampling(void **state)
{
	(void)state;
	for_every_part(check_segments);
}

// Known results at and around the promised 1e-6 m.
static void test_segment_is_exact(void **state)
{
	(void)state;
	cau_tool_def tool = tool_with_defaults(CAU_TOOL_SPHERE);
	double r = tool.hot_radius_m;
	for (int i = 0; i < 3; i++) {
		double y = r + (double[]){-1e-6, 0.5e-6, 2e-6}[i];
		cau_vec3 a = {-0.01, y, 0}, b = {0.013, y, 0};
		assert_int_equal(cau_tool_meets_segment(&tool, 0, CAU_PART_HOT, a, b), i < 2);
	}
	cau_vec3 inside = {1e-4, 0, 0}; // a segment inside the part, and one of length 0
	assert_true(cau_tool_meets_segment(&tool, 0, CAU_PART_HOT, (cau_vec3){0, 0, 0}, inside));
	assert_true(cau_tool_meets_segment(&tool, 0, CAU_PART_HOT, inside, inside));
	cau_vec3 outside = {1, 0, 0};
	assert_false(cau_tool_meets_segment(&tool, 0, CAU_PART_HOT, outside, outside));
	cau_vec3 nowhere = {NAN, 0, 0};
	assert_false(cau_tool_meets_segment(&tool, 0, CAU_PART_HOT, nowhere, inside));
}

static void test_between_jaws(void **state)
{
	(void)state;
	static const int shapes[] = {CAU_TOOL_BIPOLAR, CAU_TOOL_SHEARS, CAU_TOOL_GRASPER};
	for (int i = 0; i < 3; i++) {
		cau_tool_def tool = tool_with_defaults(shapes[i]);
		int shears = shapes[i] == CAU_TOOL_SHEARS;
		double face = shears ? tool.hot_radius_m : 0;
		double low = shears ? 0 : -tool.jaw_open_rad / 2;
		double high = shears ? tool.jaw_open_rad : tool.jaw_open_rad / 2;
		// points at half the jaws' length below the hinge: on the faces and between them
		double arm = tool.tip_length_m / 2, previous = -2, coordinate;
		for (int k = 0; k <= 4; k++) {
			double angle = low + (high - low) * k / 4;
			cau_vec3 p = {face * cos(angle) + arm * sin(angle), 0,
			              tool.tip_length_m - arm * cos(angle) + face * sin(angle)};
			assert_true(cau_tool_between_jaws(&tool, 1, p, &coordinate));
			assert_true(coordinate > previous);
			if (k == 0 || k == 4)
				assert_near(coordinate, k ? 1 : -1, 0.1);
			if (k == 2 && !shears) // the hinge of shears is not in their faces' planes
				assert_near(coordinate, 0, 1e-12);
			previous = coordinate;
			p.y = 0.01; // the point is beside the jaws
			assert_false(cau_tool_between_jaws(&tool, 1, p, &coordinate));
		}
		cau_vec3 above = {face, 0, tool.tip_length_m + 1e-3}, below = {face, 0, -3e-3};
		assert_false(cau_tool_between_jaws(&tool, 1, above, NULL));
		assert_false(cau_tool_between_jaws(&tool, 1, below, NULL));
		cau_vec3 pressed = {face, 0, 1e-3}, beside = {face + 5e-3, 0, 1e-3};
		assert_true(cau_tool_between_jaws(&tool, 0, pressed, NULL)); // closed jaws hold it
		assert_false(cau_tool_between_jaws(&tool, 0, beside, NULL));
	}
	for (int shape = 0; shape < CAU_TOOL_SHAPE_COUNT; shape++) {
		cau_tool_def tool = tool_with_defaults(shape);
		if (!rows[shape].jaws)
			assert_false(cau_tool_between_jaws(&tool, 1, (cau_vec3){0, 0, 0}, NULL));
	}
}

// A point that turns with a jaw stays on the jaw's face, at the same distance from the hinge.
static void test_turning_with_jaws(void **state)
{
	(void)state;
	static const int shapes[] = {CAU_TOOL_BIPOLAR, CAU_TOOL_SHEARS, CAU_TOOL_GRASPER};
	for (int i = 0; i < 3; i++) {
		cau_tool_def tool = tool_with_defaults(shapes[i]);
		cau_tool_jaws jaws = cau_tool_describe_jaws(&tool);
		assert_near(jaws.share[0] + jaws.share[1], 1, 1e-12);
		double arm = tool.tip_length_m / 2;
		// 1 - cos 0.6 is less than 0.18
		double off = shapes[i] == CAU_TOOL_SHEARS ? tool.hot_radius_m * 0.18 : 1e-9;
		for (int side = 0; side < 2; side++) {
			double sign = side ? 1 : -1;
			cau_vec3 p = {jaws.face_m, 1e-3, tool.tip_length_m - arm};
			assert_near(cau_tool_jaw_angle(&jaws, p), 0, 1e-12);
			for (double jaw = 0.25; jaw <= 1; jaw += 0.25) {
				double angle = sign * jaws.share[side] * jaw * tool.jaw_open_rad;
				p = cau_tool_turn_with_jaw(&jaws, p, angle);
				assert_near(cau_tool_jaw_angle(&jaws, p), angle, 1e-12);
				assert_near(hypot(p.x - jaws.face_m, p.z - jaws.hinge_m), arm, 1e-12);
				assert_near(cau_tool_distance(&tool, jaw, CAU_PART_BOTH, p, NULL), 0, off);
				assert_near(p.y, 1e-3, 1e-15);
			}
		}
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_rows_say_what_shapes_have),
		cmocka_unit_test(test_lipschitz),
		cmocka_unit_test(test_gradient),
		cmocka_unit_test(test_surface_and_bound),
		cmocka_unit_test(test_hot_is_not_covered),
		cmocka_unit_test(test_tip_is_hot),
		cmocka_unit_test(test_known_surfaces),
		cmocka_unit_test(test_jaws_open),
		cmocka_unit_test(test_a_part_that_lacks_is_nowhere),
		cmocka_unit_test(test_world_frame),
		cmocka_unit_test(test_segments_against_sampling),
		cmocka_unit_test(test_segment_is_exact),
		cmocka_unit_test(test_between_jaws),
		cmocka_unit_test(test_turning_with_jaws),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
