// SPDX-License-Identifier: GPL-3.0-or-later
// Prints signed distances of the core for the viewer's tests. Each line "SHAPE HOT_RADIUS TIP
// SHAFT_RADIUS JAW PART X Y Z STEPS" on standard input (metres; PART 0 is hot, 1 cold) names a
// tool's part and a point. The program moves the point STEPS times towards the part's surface, by
// its distance along the gradient. The answer is the distance of the final point, and the point.
#include <stdio.h>
#include <stdlib.h>

#include "core/tool/tools.h"
#include "tool/tool_shape.h"

int main(void)
{
	int shape, part, steps;
	double hot, tip, shaft, jaw;
	cau_vec3 point;
	while (scanf("%d %lf %lf %lf %lf %d %lf %lf %lf %d", &shape, &hot, &tip, &shaft, &jaw, &part,
	             &point.x, &point.y, &point.z, &steps) == 10) {
		cau_tool_def tool = tool_with_defaults(shape);
		tool.hot_radius_m = hot;
		tool.tip_length_m = tip;
		tool.shaft_radius_m = shaft;
		cau_tool_part of = part == 0 ? CAU_PART_HOT : CAU_PART_COLD;
		cau_vec3 gradient = {0, 0, 0};
		double distance = cau_tool_distance(&tool, jaw, of, point, &gradient);
		for (int i = 0; i < steps; i++) {
			point = cau_add_scaled(point, -distance, gradient);
			distance = cau_tool_distance(&tool, jaw, of, point, &gradient);
		}
		printf("%.9g %.9g %.9g %.9g\n", distance, point.x, point.y, point.z);
	}
	return EXIT_SUCCESS;
}
