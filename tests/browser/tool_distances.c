// SPDX-License-Identifier: GPL-3.0-or-later
// The core's signed distances for the viewer's tests: of every line "SHAPE HOT_RADIUS TIP
// SHAFT_RADIUS JAW PART X Y Z" (metres; PART 0 hot, 1 cold) on standard input, the distance and its
// gradient.
#include <stdio.h>
#include <stdlib.h>

#include "core/tool/tools.h"
#include "tool/tool_shape.h"

int main(void)
{
	int shape, part;
	double hot, tip, shaft, jaw;
	cau_vec3 point;
	while (scanf("%d %lf %lf %lf %lf %d %lf %lf %lf", &shape, &hot, &tip, &shaft, &jaw, &part,
	             &point.x, &point.y, &point.z) == 9) {
		cau_tool_def tool = tool_with_defaults(shape);
		tool.hot_radius_m = hot;
		tool.tip_length_m = tip;
		tool.shaft_radius_m = shaft;
		cau_vec3 gradient = {0, 0, 0};
		double distance = cau_tool_distance(&tool, jaw, part == 0 ? CAU_PART_HOT : CAU_PART_COLD,
		                                    point, &gradient);
		printf("%.9g %.9g %.9g %.9g\n", distance, gradient.x, gradient.y, gradient.z);
	}
	return EXIT_SUCCESS;
}
