// SPDX-License-Identifier: GPL-3.0-or-later
#include "tool/tool_shape.h"

#include "cautery/assert.h"
#include "tool/distance.h"
#include "tool/family.h"

enum { TRACE_STEPS = 1024 };
// largest distance, m, from the part at which a segment is taken to meet it
static const double TOUCH_M = 1e-6;

static const cau_tool_family *family_of(const cau_tool_def *tool)
{
#define X(code, word, ...) &cau_shape_##word,
	static const cau_tool_family *const families[] = {CAU_TOOL_SHAPE_TABLE(X)};
#undef X
	CAU_ASSERT_INDEX(tool->shape, CAU_TOOL_SHAPE_COUNT);
	return families[tool->shape];
}

static double part_distance(cau_part_distance distance, const cau_tool_def *tool, double jaw,
                            cau_vec3 point, cau_vec3 *gradient)
{
	if (distance)
		return distance(tool, jaw, point, gradient);
	if (gradient)
		*gradient = (cau_vec3){0, 0, -1};
	return INFINITY;
}

double cau_tool_distance(const cau_tool_def *tool, double jaw, cau_tool_part part, cau_vec3 point,
                         cau_vec3 *gradient)
{
	CAU_ASSERT(part >= CAU_PART_HOT && part <= CAU_PART_BOTH, "part %d", (int)part);
	const cau_tool_family *family = family_of(tool);
	jaw = fmin(fmax(jaw, 0), 1);
	if (part == CAU_PART_HOT)
		return part_distance(family->hot, tool, jaw, point, gradient);
	if (part == CAU_PART_COLD)
		return part_distance(family->cold, tool, jaw, point, gradient);
	cau_vec3 cold_gradient;
	double hot = part_distance(family->hot, tool, jaw, point, gradient);
	double cold = part_distance(family->cold, tool, jaw, point, gradient ? &cold_gradient : NULL);
	return cau_distance_nearer(hot, gradient, cold, &cold_gradient);
}

double cau_tool_distance_at(const cau_tool_def *tool, const cau_pose *pose, double jaw,
                            cau_tool_part part, cau_vec3 point, cau_vec3 *gradient)
{
	double distance = cau_tool_distance(tool, jaw, part, cau_pose_to_local(pose, point), gradient);
	if (gradient)
		*gradient = cau_rotate(pose->rotation, *gradient);
	return distance;
}

static cau_ball part_bound(const cau_tool_def *tool, cau_tool_part part)
{
	CAU_ASSERT(part >= CAU_PART_HOT && part <= CAU_PART_BOTH, "part %d", (int)part);
	const cau_tool_family *family = family_of(tool);
	if (part == CAU_PART_HOT)
		return family->hot_bound ? family->hot_bound(tool) : (cau_ball){{0, 0, 0}, 0};
	cau_ball cold = family->cold_bound(tool);
	if (part == CAU_PART_COLD || !family->hot_bound)
		return cold;
	return cau_ball_join(family->hot_bound(tool), cold);
}

void cau_tool_bound(const cau_tool_def *tool, cau_tool_part part, cau_vec3 *center,
                    double *radius_m)
{
	cau_ball ball = part_bound(tool, part);
	*center = ball.center;
	*radius_m = ball.radius_m;
}

double cau_tool_thinnest_hot_m(const cau_tool_def *tool)
{
	const cau_tool_family *family = family_of(tool);
	return family->thinnest_hot ? family->thinnest_hot(tool) : INFINITY;
}

bool cau_tool_has_jaws(const cau_tool_def *tool)
{
	return family_of(tool)->between != NULL;
}

bool cau_tool_between_jaws(const cau_tool_def *tool, double jaw, cau_vec3 point,
                           double *jaw_coordinate)
{
	const cau_tool_family *family = family_of(tool);
	return family->between && family->between(tool, fmin(fmax(jaw, 0), 1), point, jaw_coordinate);
}

cau_tool_jaws cau_tool_describe_jaws(const cau_tool_def *tool)
{
	const cau_tool_family *family = family_of(tool);
	CAU_ASSERT(family->jaws, "shape %d has no jaws", tool->shape);
	return family->jaws(tool);
}

double cau_tool_jaw_angle(const cau_tool_jaws *jaws, cau_vec3 point)
{
	return atan2(point.x - jaws->face_m, jaws->hinge_m - point.z);
}

cau_vec3 cau_tool_turn_with_jaw(const cau_tool_jaws *jaws, cau_vec3 point, double angle_rad)
{
	double arm = hypot(point.x - jaws->face_m, jaws->hinge_m - point.z);
	return (cau_vec3){jaws->face_m + arm * sin(angle_rad), point.y,
	                  jaws->hinge_m - arm * cos(angle_rad)};
}

// A part's distance d is 1-Lipschitz, so no point within d can be inside the part. The function
// moves both ends of the segment inwards by their distances until one end meets the part or the
// ends pass each other.
bool cau_tool_meets_segment(const cau_tool_def *tool, double jaw, cau_tool_part part, cau_vec3 a,
                            cau_vec3 b)
{
	cau_ball ball = part_bound(tool, part);
	if (!(cau_distance_capsule(ball.center, a, b, ball.radius_m + TOUCH_M, NULL) <= 0))
		return false;
	cau_vec3 along = cau_sub(b, a);
	double length = cau_length(along);
	along = cau_unit_or(along, (cau_vec3){0, 0, 0});
	double from = 0, to = length;
	for (int i = 0; i < TRACE_STEPS; i++) {
		double first = cau_tool_distance(tool, jaw, part, cau_add_scaled(a, from, along), NULL);
		double last = cau_tool_distance(tool, jaw, part, cau_add_scaled(a, to, along), NULL);
		if (first <= TOUCH_M || last <= TOUCH_M)
			return true;
		from += first;
		to -= last;
		if (from >= to)
			return false;
	}
	return true;
}
