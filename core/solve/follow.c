// SPDX-License-Identifier: GPL-3.0-or-later
// Moves the contact point of a face to the point that is nearest to the tool, in every iteration.
// The nearest point changes as the face tilts.
//
// A move to the nearest point in one go would oscillate. A face that is pushed at its nearest point
// tilts away there. Then another point is nearest, and a push there tilts the face back. But the
// tilt can be predicted. If the point of a push r moves by dw, in weights, the face tilts by r S
// dw, where S belongs to the face's corners. The nearest point of a tip of radius R then moves by r
// R L S dw, in weights, with L_kl = grad w_k . grad w_l. So of the way dw_n to the nearest point,
// the contact point moves by
//
//     (I + r R L S)^-1 dw_n.
//
// The moved point is then the nearest one, if the face responds linearly.
#include <string.h>

#include "cautery/assert.h"
#include "solve/contact.h"
#include "tool/tool_shape.h"

// Depth of a point inside the tool, as a share of the tip's radius, from which the point is not
// moved along its face and only pushed out.
static const double passed_share = 0.5;

static void corners_of(const cau_contact_set *set, const cau_step_solver *solver,
                       const cau_contact_row *row, cau_vec3 corner[3])
{
	const cau_contact_tool *tool = &set->tool[row->tool];
	cau_pose pose = cau_coupling_pose(&tool->anchor, cau_vec3_of(tool->offset));
	for (int32_t k = 0; k < 3; k++)
		corner[k] =
			cau_pose_to_local(&pose, cau_vec3_of(solver->position + 3 * (size_t)row->vertex[k]));
}

// Computes tilt = r R L S for the constraint's corners. Fixed corners contribute 0.
static void find_tilt(const cau_contact_set *set, const cau_contact_row *row,
                      const cau_vec3 corner[3], double tilt[3][3])
{
	double push = cau_dot(cau_vec3_of(row->reaction), cau_vec3_of(row->normal));
	double radius = set->tool[row->tool].def->hot_radius_m;
	cau_vec3 side[3],
		area = cau_cross(cau_sub(corner[1], corner[0]), cau_sub(corner[2], corner[0]));
	double scale = push * radius / cau_dot(area, area);
	for (int k = 0; k < 3; k++)
		side[k] = cau_sub(corner[(k + 2) % 3], corner[(k + 1) % 3]);
	for (int k = 0; k < 3; k++)
		for (int l = 0; l < 3; l++) {
			tilt[k][l] = 0;
			for (int m = 0; m < 3; m++) {
				int32_t a = row->column[m], b = row->column[l];
				if (a >= 0 && b >= 0)
					tilt[k][l] += scale * cau_dot(side[k], side[m]) *
					              set->columns.inverse[(size_t)a * CAU_MAX_COLUMNS + (size_t)b];
			}
		}
}

// Replaces `way` by (I + tilt)^-1 way, by Cramer's rule. Returns false if there is no inverse.
static bool shorten(double tilt[3][3], double way[3])
{
	cau_vec3 column[3];
	for (int l = 0; l < 3; l++)
		column[l] = (cau_vec3){(l == 0) + tilt[0][l], (l == 1) + tilt[1][l], (l == 2) + tilt[2][l]};
	cau_vec3 right = cau_vec3_of(way);
	double whole = cau_dot(column[0], cau_cross(column[1], column[2]));
	if (!(whole > 0.5)) // the determinant is at least 1, because L and S are positive
		return false;
	way[0] = cau_dot(right, cau_cross(column[1], column[2])) / whole;
	way[1] = cau_dot(column[0], cau_cross(right, column[2])) / whole;
	way[2] = cau_dot(column[0], cau_cross(column[1], right)) / whole;
	return true;
}

void cau_contact_follow(cau_contact_set *set, const cau_step_solver *solver, int32_t index)
{
	CAU_ASSERT_INDEX(index, set->row_count);
	cau_contact_row *row = &set->row[index];
	const cau_contact_tool *tool = &set->tool[row->tool];
	cau_vec3 corner[3], gradient;
	double nearest[3], way[3], tilt[3][3], sum = 0;
	row->went = 0;
	memcpy(nearest, row->weight, sizeof nearest);
	corners_of(set, solver, row, corner);
	double distance = cau_tool_face_distance(tool->def, tool->jaw, (cau_tool_part)tool->part,
	                                         corner, nearest, &gradient);
	if (!(distance > -passed_share * tool->def->hot_radius_m) ||
	    !(cau_dot(gradient, cau_vec3_of(row->side)) > 0))
		return;
	for (int k = 0; k < 3; k++)
		way[k] = nearest[k] - row->weight[k];
	find_tilt(set, row, corner, tilt);
	if (!shorten(tilt, way))
		return;
	for (int k = 0; k < 3; k++)
		// weights before they are scaled to the sum 1
		sum += way[k] = fmax(row->weight[k] + way[k], 0);
	for (int k = 0; k < 3; k++) {
		row->went += fabs(way[k] / sum - row->weight[k]);
		row->weight[k] = way[k] / sum;
	}
	cau_contact_find_answer(set, index);
}
