// SPDX-License-Identifier: GPL-3.0-or-later
// Jaws stop at the tissue between them. They turn towards their commanded opening. The held tissue
// moves with the faces of the jaws. First a face pushes the tissue until both faces touch it. Then
// the tissue is pressed evenly between the faces, about the hinge. The holds are springs in the
// solve (solve/hold.c), so the tissue answers with its own stiffness. The work of the holds'
// reactions per angle is the moment against which the jaws press. The jaws stop when this moment is
// that of close_force_n at their tips.
//
// In each tick the jaws turn as far as the springs of the holds would permit if the tissue behind
// did not yield at all. Tissue does yield, so the jaws come to rest without pressing harder than
// close_force_n, whatever the tissue is.
//
// Strongly squeezed tissue resists far more than these laws say. The stress in organs between a
// grasper's jaws grows exponentially. Livers and kidneys fail at about half their thickness and at
// some 0.3 MPa, which is 8 N on such faces (J. Rosen et al. 2008). So tissue is never pressed below
// a share of its thickness. The thickness of a sheet counts too: jaws do not close completely on a
// sheet.
#include "cautery/assert.h"
#include "session/session_internal.h"
#include "tool/tool_shape.h"

static const double jaw_per_s = 8;     // full strokes of the jaws in a second
static const double least_share = 0.4; // least share of the thickness at grasping

typedef struct extent { // angles of the held points, or of the faces of the jaws
	double low, high;   // rad
} extent;

static extent faces_at(const cau_tool *tool, double open_rad)
{
	cau_tool_jaws jaws = cau_tool_describe_jaws(&tool->state.definition);
	return (extent){-jaws.share[0] * open_rad, jaws.share[1] * open_rad};
}

static double angle_of(const cau_tool_jaws *jaws, const cau_grasp *grasp)
{
	return cau_tool_jaw_angle(jaws, cau_vec3_of(grasp->local));
}

// Returns the angles of the held points. A point inside a jaw's body, which has sunk in or slipped,
// counts as a point on the face. Its depth in the jaw stays as it is.
static extent extent_held(const cau_tool *tool, const cau_tool_jaws *jaws, extent faces)
{
	CAU_ASSERT(tool->grasp_count > 0, "%d points are held", tool->grasp_count);
	extent held = {faces.high, faces.low};
	for (int32_t k = 0; k < tool->grasp_count; k++) {
		double angle = fmin(fmax(angle_of(jaws, &tool->grasp[k]), faces.low), faces.high);
		held.low = fmin(held.low, angle);
		held.high = fmax(held.high, angle);
	}
	return held;
}

static double open_now(const cau_tool *tool)
{
	return tool->state.jaw * tool->state.definition.jaw_open_rad;
}

// ---- grasping

static double thickness_m(const cau_session *session, const cau_grasp *grasp)
{
	const cau_tissue *tissue = &session->tissue;
	int32_t index = 0;
	if (grasp->face >= 0)
		index = session->view.face_layer[grasp->face];
	else
		for (; index < tissue->layer_count; index++) {
			const cau_tissue_layer *layer = &tissue->layer[index];
			if (grasp->vertex[0] >= layer->first_vertex &&
			    grasp->vertex[0] < layer->first_vertex + layer->vertex_count)
				break;
		}
	CAU_ASSERT_INDEX(index, tissue->layer_count);
	const cau_layer_def *def = &tissue->layer[index].def;
	return def->kind == CAU_LAYER_FAT || def->kind == CAU_LAYER_LINKS ? 0
	                                                                  : def->sheet[0].thickness_m;
}

void cau_session_begin_pinch(const cau_session *session, cau_tool *tool)
{
	tool->least_open_rad = 0;
	if (!tool->grasp_count)
		return;
	cau_tool_jaws jaws = cau_tool_describe_jaws(&tool->state.definition);
	extent held = extent_held(tool, &jaws, faces_at(tool, open_now(tool)));
	double thickest = 0;
	for (int32_t k = 0; k < tool->grasp_count; k++) {
		const cau_grasp *grasp = &tool->grasp[k];
		// The arm is at least half the jaw's length, so that the angle stays finite at the hinge.
		double arm = fmax(jaws.hinge_m - grasp->local[2], jaws.hinge_m / 2);
		thickest = fmax(thickest, thickness_m(session, grasp) / arm);
	}
	double least = least_share * (held.high - held.low + thickest);
	tool->least_open_rad = fmin(least, open_now(tool)); // a grasp does not open the jaws
}

// ---- pressing

// Returns the motion of a grasped point per angle of the jaws, m/rad. The motion is 0 for all
// points until both faces touch the tissue.
static cau_vec3 way_of(const cau_tool_jaws *jaws, extent held, extent faces, const cau_grasp *grasp)
{
	double width = held.high - held.low;
	if (!(width > 0) || width < (1 - 1e-9) * (faces.high - faces.low))
		return (cau_vec3){0, 0, 0};
	double angle = fmin(fmax(angle_of(jaws, grasp), held.low), held.high);
	double turn = jaws->share[0] - (angle - held.low) / width;
	return (cau_vec3){turn * (jaws->hinge_m - grasp->local[2]), 0,
	                  turn * (grasp->local[0] - jaws->face_m)};
}

void cau_session_read_pinch(cau_session *session, cau_tool *tool, int32_t index)
{
	tool->state.jaw_force_n = 0;
	if (!tool->grasp_count)
		return;
	cau_tool_jaws jaws = cau_tool_describe_jaws(&tool->state.definition);
	extent faces = faces_at(tool, open_now(tool)), held = extent_held(tool, &jaws, faces);
	double moment = 0;
	for (int32_t k = 0; k < session->contact.row_count; k++) {
		const cau_contact_row *row = &session->contact.row[k];
		const cau_grasp *grasp =
			row->attached && row->tool == index ? cau_session_hold_of_row(tool, row) : NULL;
		if (!grasp)
			continue;
		cau_vec3 way = cau_rotate(tool->state.pose.rotation, way_of(&jaws, held, faces, grasp));
		moment += cau_dot(cau_vec3_of(row->reaction), way);
	}
	tool->state.jaw_force_n = fmax(moment, 0) / tool->state.definition.tip_length_m;
}

// Returns the angle, rad, by which the jaws may still close. The angle is below 0 if the jaws press
// too hard.
static double yield_of(const cau_tool *tool)
{
	const cau_tool_def *def = &tool->state.definition;
	cau_tool_jaws jaws = cau_tool_describe_jaws(def);
	extent faces = faces_at(tool, open_now(tool)), held = extent_held(tool, &jaws, faces);
	double stiffness = 0; // N m/rad, of the holds' springs alone
	for (int32_t k = 0; k < tool->grasp_count; k++) {
		cau_vec3 way = way_of(&jaws, held, faces, &tool->grasp[k]);
		stiffness += def->grasp_stiffness_n_m * cau_dot(way, way);
	}
	double left = (def->close_force_n - tool->state.jaw_force_n) * def->tip_length_m;
	return stiffness > 0 ? left / stiffness : HUGE_VAL;
}

// Moves the held points with the faces of the jaws, which were open by `before`, rad.
static void squeeze(cau_tool *tool, double before)
{
	cau_tool_jaws jaws = cau_tool_describe_jaws(&tool->state.definition);
	extent were = faces_at(tool, before), faces = faces_at(tool, open_now(tool));
	extent held = extent_held(tool, &jaws, were);
	double width = held.high - held.low, room = faces.high - faces.low;
	double share = width > room ? room / width : 1;
	double low = fmin(fmax(held.low, faces.low), faces.high - share * width);
	if (share == 1 && low == held.low)
		return; // no face touches the tissue yet
	for (int32_t k = 0; k < tool->grasp_count; k++) {
		cau_grasp *grasp = &tool->grasp[k];
		double angle = angle_of(&jaws, grasp);
		double between = fmin(fmax(angle, were.low), were.high);
		double by = low + share * (between - held.low) - between;
		cau_vec3 was = cau_vec3_of(grasp->local),
				 is = cau_tool_turn_with_jaw(&jaws, was, angle + by);
		cau_vec3_to(is, grasp->local);
		// the motion by pressing is not part of the slip
		cau_vec3_to(cau_add(cau_vec3_of(grasp->start), cau_sub(is, was)), grasp->start);
	}
}

static double towards(double from, double to, double most)
{
	double way = to - from;
	return fabs(way) <= (1 + 1e-9) * most ? to : from + (way > 0 ? most : -most);
}

// Turns the jaws in a `part` of the tick.
void cau_session_turn_jaws(cau_tool *tool, double step_s, double part)
{
	cau_tool_state *state = &tool->state;
	const double open = state->definition.jaw_open_rad, most = jaw_per_s * step_s * part;
	double before = state->jaw, wanted;
	tool->jaw_before = before;
	state->asked_jaw = towards(state->asked_jaw, tool->jaw_target, most);
	wanted = state->asked_jaw;
	if (tool->grasp_count) {
		double yield = part * yield_of(tool);
		wanted = fmax(wanted, tool->least_open_rad / open);
		wanted = fmax(wanted, before - yield / open);
	}
	state->jaw = fmin(towards(before, wanted, most), 1);
	CAU_ASSERT(state->jaw >= 0, "a jaw at %g", state->jaw);
	if (tool->grasp_count && state->jaw != before)
		squeeze(tool, before * open);
}
