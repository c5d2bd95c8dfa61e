// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/coupling.h"

#include <math.h>

#include "cautery/assert.h"

cau_pose cau_coupling_pose(const cau_pose *anchor, cau_vec3 offset)
{
	cau_pose pose = *anchor;
	if (cau_dot(offset, offset) != 0) // adding 0 would change a -0 to 0
		cau_vec3_to(cau_add(cau_vec3_of(anchor->position_m), offset), pose.position_m);
	return pose;
}

// Returns |offset| over the spring's force. Beyond cau_coupling_reach_m the force is force_max_n.
static double compliance_of(const cau_contact_tool *tool)
{
	double most = tool->def->force_max_n;
	CAU_ASSERT(most > 0, "a tool that pushes with %g N at most", most);
	return fmax(cau_coupling_reach_m, cau_length(cau_vec3_of(tool->offset))) / most;
}

bool cau_coupling_begin(cau_contact_set *set)
{
	bool changed = false;
	for (int32_t i = 0; i < set->tool_count; i++) {
		cau_contact_tool *tool = &set->tool[i];
		double before = tool->compliance;
		tool->compliance = compliance_of(tool);
		changed = changed || tool->compliance != before;
		cau_vec3_to((cau_vec3){0, 0, 0}, tool->offset);
	}
	for (int32_t i = 0; i < set->row_count; i++)
		cau_coupling_take(&set->tool[set->row[i].tool], cau_vec3_of(set->row[i].reaction));
	return changed;
}

void cau_coupling_take(cau_contact_tool *tool, cau_vec3 by)
{
	cau_vec3_to(cau_add_scaled(cau_vec3_of(tool->offset), -tool->compliance, by), tool->offset);
}
