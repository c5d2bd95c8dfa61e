// SPDX-License-Identifier: GPL-3.0-or-later
// Jaws stop at what lies between them. They turn towards where they are asked to be, and what they
// hold goes with their faces: first it is pushed to where both touch it, then it is pressed
// together evenly, between the faces, about the hinge. The holds are springs in the solve
// (solve/hold.c), so the tissue answers with its own stiffness, and the work of their reactions
// along that way is the moment that the jaws press against. They stand where it is that of
// close_force_n at their tips.
//
// A tick turns them as far as the holds' own springs would let them if the tissue behind did not
// yield at all. It does, so they come to rest without ever pressing harder, whatever it is.
//
// Tissue that is squeezed far resists far more than these laws say: the stress in organs between a
// grasper's jaws grows exponentially, and livers and kidneys fail at about half their thickness and
// some 0.3 MPa, which is what 8 N are on such faces (J. Rosen et al. 2008). So nothing is pressed
// to less than a share of its thickness, a sheet's own among it, and jaws do not close whole on it.
#include "cautery/assert.h"
#include "session/session_internal.h"
#include "tool/tool_shape.h"

static const double jaw_per_s = 8; // a full stroke takes an eighth of a second
static const double least_share = 0.4;

typedef struct extent { // of what is held, or of the room between the faces
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

// What is inside a jaw's body, where it has sunk in or slipped to, stays as far beyond its face.
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

// ---- taking hold

static double thickness_m(const cau_session *session, const cau_grasp *grasp)
{
	const cau_tissue *tissue = &session->tissue;
	int32_t index = 0;
	if (grasp->face >= 0)
		index = session->face_layer[grasp->face];
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
		double arm = fmax(jaws.hinge_m - grasp->local[2], jaws.hinge_m / 2); // not at the hinge
		thickest = fmax(thickest, thickness_m(session, grasp) / arm);
	}
	double least = least_share * (held.high - held.low + thickest);
	tool->least_open_rad = fmin(least, open_now(tool)); // they need not open for it
}

// ---- what is pressed

// Where a hold goes as the jaws close, m per rad: 0 for all until both faces touch.
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

// By how much the jaws may turn on, rad: less than 0 where they press harder than they can.
static double yield_of(const cau_tool *tool)
{
	const cau_tool_def *def = &tool->state.definition;
	cau_tool_jaws jaws = cau_tool_describe_jaws(def);
	extent faces = faces_at(tool, open_now(tool)), held = extent_held(tool, &jaws, faces);
	double stiffness = 0; // N m/rad, of the holds alone
	for (int32_t k = 0; k < tool->grasp_count; k++) {
		cau_vec3 way = way_of(&jaws, held, faces, &tool->grasp[k]);
		stiffness += def->grasp_stiffness_n_m * cau_dot(way, way);
	}
	double left = (def->close_force_n - tool->state.jaw_force_n) * def->tip_length_m;
	return stiffness > 0 ? left / stiffness : HUGE_VAL;
}

// What is held goes with the faces, which were open by `before`.
static void squeeze(cau_tool *tool, double before)
{
	cau_tool_jaws jaws = cau_tool_describe_jaws(&tool->state.definition);
	extent were = faces_at(tool, before), faces = faces_at(tool, open_now(tool));
	extent held = extent_held(tool, &jaws, were);
	double width = held.high - held.low, room = faces.high - faces.low;
	double share = width > room ? room / width : 1;
	double low = fmin(fmax(held.low, faces.low), faces.high - share * width);
	if (share == 1 && low == held.low)
		return; // the faces have not come to it yet
	for (int32_t k = 0; k < tool->grasp_count; k++) {
		cau_grasp *grasp = &tool->grasp[k];
		double angle = angle_of(&jaws, grasp);
		double between = fmin(fmax(angle, were.low), were.high);
		double by = low + share * (between - held.low) - between;
		cau_vec3 was = cau_vec3_of(grasp->local),
				 is = cau_tool_turn_with_jaw(&jaws, was, angle + by);
		cau_vec3_to(is, grasp->local);
		// what it is pressed is no way that it slipped
		cau_vec3_to(cau_add(cau_vec3_of(grasp->start), cau_sub(is, was)), grasp->start);
	}
}

static double towards(double from, double to, double most)
{
	double way = to - from;
	return fabs(way) <= (1 + 1e-9) * most ? to : from + (way > 0 ? most : -most);
}

// A part of the tick alone turns them by that part.
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
