// SPDX-License-Identifier: GPL-3.0-or-later
// Jaws grasp vertices between them (touch.c) or, without such vertices, points of faces. Jaws that
// are smaller than the elements may have no vertex between them. A hold on a point pulls at the
// corners of its face by their weights, as contact does (solve/contact.h). So the tissue moves with
// the jaws from its position at closing, and nothing jumps.
#include "cautery/assert.h"
#include "session/session_internal.h"
#include "tool/tool_shape.h"

cau_grasp cau_session_hold_vertex(int32_t vertex)
{
	return (cau_grasp){.face = -1, .vertex = {vertex, -1, -1}, .weight = {1, 0, 0}};
}

cau_contact_row cau_session_row_of_hold(const cau_session *session, const cau_grasp *grasp,
                                        int32_t tool)
{
	CAU_ASSERT_INDEX(grasp->vertex[0], session->tissue.vertex_count);
	cau_contact_row row = cau_contact_at_vertex(grasp->vertex[0], tool);
	row.attached = true;
	if (grasp->face < 0)
		return row;
	row.corner_count = 3;
	row.face = grasp->face;
	for (int k = 0; k < 3; k++) {
		row.vertex[k] = grasp->vertex[k];
		row.weight[k] = grasp->weight[k];
		row.free[k] = !session->vertices.fixed[grasp->vertex[k]];
	}
	return row;
}

cau_grasp *cau_session_hold_of_row(cau_tool *tool, const cau_contact_row *row)
{
	for (int32_t k = 0; k < tool->grasp_count; k++) {
		cau_grasp *grasp = &tool->grasp[k];
		bool same = (grasp->face < 0) == (row->corner_count == 1);
		for (int c = 0; c < row->corner_count && same; c++)
			same = grasp->vertex[c] == row->vertex[c] && grasp->weight[c] == row->weight[c];
		if (same)
			return grasp;
	}
	return NULL;
}

static bool is_drawn(const cau_session *session, int32_t face)
{
	return !(session->dissection.face_mask[face >> 5] >> (face & 31) & 1);
}

bool cau_session_hold_is_left(const cau_session *session, const cau_grasp *grasp)
{
	if (grasp->face < 0)
		return !session->vertices.fixed[grasp->vertex[0]];
	bool movable = false;
	for (int k = 0; k < 3; k++)
		movable |= !session->vertices.fixed[grasp->vertex[k]];
	return movable && is_drawn(session, grasp->face);
}

// ---- faces between the jaws

// Steps of the search grid along each edge of a face. With 20 steps, jaws of a millimetre find a
// point of a face of ten millimetres.
enum { STEPS = 20 };

typedef struct holding {
	const cau_session *session;
	cau_tool *tool;
	double reach_m; // m; every point between the jaws is nearer to the tip
} holding;

static void weights_at(int i, int j, double weight[3])
{
	weight[0] = (double)i / STEPS;
	weight[1] = (double)j / STEPS;
	weight[2] = (double)(STEPS - i - j) / STEPS;
}

static cau_vec3 local_point(const holding *h, const int32_t vertex[3], const double weight[3])
{
	cau_vec3 sum = {0, 0, 0};
	for (int k = 0; k < 3; k++)
		sum = cau_add_scaled(sum, weight[k],
		                     cau_vec3_of(h->session->vertices.position + 3 * (size_t)vertex[k]));
	return cau_pose_to_local(&h->tool->state.pose, sum);
}

// Finds the two points of a face between jaws of this opening that are farthest apart along and
// across the jaws. A face that is held at two points cannot turn about one point. Returns how many
// points there are.
static int find_points(const holding *h, const int32_t vertex[3], double jaw, double weight[2][3])
{
	double least = HUGE_VAL, most = -HUGE_VAL;
	for (int i = 0; i <= STEPS; i++)
		for (int j = 0; j <= STEPS - i; j++) {
			double at[3];
			weights_at(i, j, at);
			cau_vec3 point = local_point(h, vertex, at);
			if (!cau_tool_between_jaws(&h->tool->state.definition, jaw, point, NULL))
				continue;
			double along = point.y + point.z;
			if (along < least)
				least = along, weights_at(i, j, weight[0]);
			if (along > most)
				most = along, weights_at(i, j, weight[1]);
		}
	return least > most ? 0 : least < most ? 2 : 1;
}

static void hold_face(holding *h, int32_t face)
{
	const int32_t *vertex = h->session->tissue.faces.vertex + 3 * (size_t)face;
	double weight[2][3];
	// points at the faces of closed jaws first, then points between the open jaws
	int count = find_points(h, vertex, 0, weight);
	if (!count)
		count = find_points(h, vertex, h->tool->state.jaw, weight);
	for (int p = 0; p < count && h->tool->grasp_count < CAU_MAX_GRASPED; p++) {
		cau_grasp grasp = {.face = face};
		for (int k = 0; k < 3; k++) {
			grasp.vertex[k] = vertex[k];
			grasp.weight[k] = weight[p][k];
		}
		cau_vec3 local = local_point(h, vertex, weight[p]);
		cau_vec3_to(local, grasp.local);
		cau_vec3_to(local, grasp.start);
		h->tool->grasp[h->tool->grasp_count++] = grasp;
	}
}

// Whether a corner of the face is already held or cannot move.
static bool is_held(const holding *h, const int32_t vertex[3])
{
	for (int k = 0; k < 3; k++) {
		if (h->session->vertices.fixed[vertex[k]])
			return true;
		for (int32_t g = 0; g < h->tool->grasp_count; g++)
			if (h->tool->grasp[g].face < 0 && h->tool->grasp[g].vertex[0] == vertex[k])
				return true;
	}
	return false;
}

static bool may_be_between(const holding *h, const int32_t vertex[3])
{
	const double third[3] = {1.0 / 3, 1.0 / 3, 1.0 / 3};
	cau_vec3 middle = local_point(h, vertex, third);
	double radius2 = 0;
	for (int k = 0; k < 3; k++) {
		cau_vec3 corner =
			cau_pose_to_local(&h->tool->state.pose,
		                      cau_vec3_of(h->session->vertices.position + 3 * (size_t)vertex[k]));
		radius2 = fmax(radius2, cau_dot(cau_sub(corner, middle), cau_sub(corner, middle)));
	}
	return cau_length(middle) <= h->reach_m + sqrt(radius2);
}

void cau_session_grasp_faces(const cau_session *session, cau_tool *tool)
{
	const cau_tool_def *def = &tool->state.definition;
	holding h = {session, tool, def->tip_length_m + 2 * def->shaft_radius_m};
	const cau_face_table *faces = &session->tissue.faces;
	for (int32_t f = 0; f < faces->face_count; f++) {
		const int32_t *vertex = faces->vertex + 3 * (size_t)f;
		if (is_drawn(session, f) && may_be_between(&h, vertex) && !is_held(&h, vertex))
			hold_face(&h, f);
	}
	tool->state.grasped_vertices = tool->grasp_count;
}
