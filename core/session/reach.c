// SPDX-License-Identifier: GPL-3.0-or-later
// Contact with faces: faces that a tool meets between vertices, or has passed within a tick.
//
// Every step has contact constraints for the vertices near a tool (touch.c). A tool that is smaller
// than the elements could pass between these vertices. A fast tool could pass a face within one
// tick. So after each solve, each drawn face is followed along its motion in the tick, relative to
// the tool (conservative advancement, B. Mirtich 1996). At first contact, the gradient of the
// distance says on which side of the face the tool is. A face that ended beyond the tool, or deep
// inside it, becomes a contact constraint (solve/contact.h), and the step continues. The side is
// stored relative to the face. A side relative to the tool would change while the tool slides along
// the face.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"
#include "session/session_internal.h"
#include "tool/tool_shape.h"

static const double touch_m = 1e-5; // a face nearer than this touches the tool
// Two depths of a face in a tool. A face deeper than `dip` gets a contact constraint from the next
// step on. `stand` is the depth that the constraint still permits, because a flat face and a round
// tip may differ by this depth. A face held exactly at the surface would be pressed as if the tip
// were larger. Both limits are the smaller of a length and a share of the tip's radius.
static const double dip_m = 6e-5, dip_share = 0.3;
static const double stand_m = 8e-5, stand_share = 0.03;
// Height, m, by which a round tip curves away from a face between two constraints of this face. A
// second constraint nearer than that is not needed.
static const double beside_m = 2e-5;
static const double same_m = 1e-5; // m; points closer together than this count as one
// Distance, m, from the tool beyond which a pushed face is released.
static const double most_margin_m = 2e-3;
// CANDIDATES: largest number of faces in the list. STEPS_ON_WAY: largest number of steps along the
// motion of a face. A grazing approach has ever shorter steps. After this many steps the face
// counts as not reached in this tick.
enum { CANDIDATES = 4 * CAU_MAX_POINT_ROWS, STEPS_ON_WAY = 64 };

typedef struct cau_candidate {
	cau_contact_row row;
	double depth; // m; the deepest candidates get constraints first
	bool kept;    // the side of the face was known before
} cau_candidate;

typedef struct reach {
	cau_session *session;
	const cau_tool *tool;
	const cau_tool_def *def;
	int32_t index;
	cau_tool_part part;
	double most_way; // m, farthest motion of a point of the tissue, relative to the tool
	double turning;  // extra motion by turning, m per m of distance beyond the tool's size
	int32_t count;
	bool kept_missed;    // the list contains a face whose side was known before
	cau_candidate *list; // (CANDIDATES)
} reach;

// The motion of a face in the tick, in the tool's frame.
typedef struct passage {
	cau_vec3 start[3], end[3];
	double weight[3];
	double way;      // m, motion of the corner that moves farthest
	cau_vec3 normal; // unit normal at the tick's start; 0 if the face has no area
} passage;

static double distance_at(const reach *r, const passage *p, double when, double weight[3],
                          cau_vec3 *gradient)
{
	cau_vec3 corner[3];
	for (int32_t k = 0; k < 3; k++)
		corner[k] = cau_add_scaled(cau_scale(1 - when, p->start[k]), when, p->end[k]);
	return cau_tool_face_distance(r->def, r->tool->state.jaw, r->part, corner, weight, gradient);
}

static void follow(const reach *r, const cau_contact_row *row, passage *p)
{
	const cau_session *session = r->session;
	p->way = 0;
	for (int32_t k = 0; k < 3; k++) {
		size_t at = 3 * (size_t)row->vertex[k];
		p->start[k] =
			cau_pose_to_local(&r->tool->pose_before, cau_vec3_of(session->vertices.start + at));
		p->end[k] =
			cau_pose_to_local(&r->tool->state.pose, cau_vec3_of(session->vertices.position + at));
		p->weight[k] = 1.0 / 3;
		double way = cau_length(cau_sub(p->end[k], p->start[k]));
		p->way = way > p->way || isnan(way) ? way : p->way;
	}
	p->normal = cau_cross(cau_sub(p->start[1], p->start[0]), cau_sub(p->start[2], p->start[0]));
	p->normal = cau_unit_or(p->normal, (cau_vec3){0, 0, 0});
}

// Returns the memory of a face that was inside the tool, or pushed by it, at the last step's end.
// NULL: the face was neither.
static const cau_contact_memory *remembered(const reach *r, int32_t face)
{
	return cau_contact_recall(&r->session->contact, r->index, face);
}

// Returns the direction that takes the face out of the tool: away from the tool's side.
static cau_vec3 way_back(const passage *p, int32_t above)
{
	return cau_scale(-above, p->normal);
}

static void place(const reach *r, const passage *p, int32_t above, double start_m,
                  cau_contact_row *row)
{
	CAU_ASSERT(row->corner_count == 3, "a row of %d corners on a face", row->corner_count);
	row->above = above;
	cau_vec3_to(way_back(p, above), row->side);
	row->way_m = p->way + 2 * r->def->hot_radius_m;
	double stand = fmin(stand_m, stand_share * r->def->hot_radius_m);
	row->slack_m = fmax(cau_contact_slack(start_m, r->session->substep.length_s), stand);
	memcpy(row->weight, p->weight, sizeof row->weight);
}

// Returns how far a point of the face would have to move, along `side`, to be outside the tool.
static double way_out(const reach *r, const passage *p, const double weight[3], cau_vec3 side,
                      double most_m)
{
	cau_vec3 point = {0, 0, 0}, gradient;
	for (int32_t k = 0; k < 3; k++)
		point = cau_add_scaled(point, weight[k], p->end[k]);
	return cau_tool_way_out(r->def, r->tool->state.jaw, r->part, point, side, most_m, &gradient);
}

// Follows the face until it first touches the tool from outside. p->weight gets the point of
// contact. Returns the side of the face on which the tool is: 1 or -1. Returns 0 if the face does
// not touch, or touches with an edge, which has no side.
static int32_t find_touch(const reach *r, passage *p, double distance, cau_vec3 gradient)
{
	CAU_ASSERT(p->way >= 0, "a way of %g m", p->way);
	const double least_share = 0.3; // least share of the gradient along the normal
	double when = 0;
	for (int step = 0; step < STEPS_ON_WAY && distance > touch_m && when < 1; step++) {
		when = fmin(when + distance / p->way, 1);
		distance = distance_at(r, p, when, p->weight, &gradient);
	}
	double along = cau_dot(gradient, p->normal);
	if (!(distance <= touch_m) || !(fabs(along) > least_share))
		return 0;
	return along < 0 ? 1 : -1;
}

// Follows a face through the tick, and stores the side of a face that ends inside or beyond the
// tool. Returns whether the face is deep. Then its constraint is at the point of first contact, or
// at the deepest point if that is deeper.
static bool is_missed(reach *r, cau_candidate *c)
{
	passage p;
	cau_vec3 gradient;
	follow(r, &c->row, &p);
	double start = distance_at(r, &p, 0, p.weight, &gradient);
	if (!(start <= p.way + touch_m)) // true also if a position is not a number
		return false;
	const cau_contact_memory *kept = remembered(r, c->row.face);
	int32_t above = 0; // 0: no side, as for tissue that was inside when the tool began to push
	if (kept)
		above = kept->above;
	else if (start >= -touch_m)
		above = find_touch(r, &p, start, gradient);
	if (!above)
		return false;
	cau_vec3 side = way_back(&p, above);
	double most = p.way + 2 * r->def->hot_radius_m, weight[3];
	memcpy(weight, p.weight, sizeof weight);
	double end = distance_at(r, &p, 1, weight, &gradient);
	c->depth = way_out(r, &p, p.weight, side, most);
	double deepest = way_out(r, &p, weight, side, most);
	if (end <= touch_m || c->depth > 0 || deepest > 0)
		cau_contact_touch(&r->session->contact, r->index, c->row.face, above,
		                  fmax(c->depth, deepest) > fmin(dip_m, dip_share * r->def->hot_radius_m));
	if (deepest > c->depth) {
		c->depth = deepest;
		memcpy(p.weight, weight, sizeof weight);
	}
	if (!(c->depth > cau_missed_share * r->def->hot_radius_m))
		return false;
	c->kept = kept != NULL;
	place(r, &p, above, start, &c->row);
	return true;
}

// Fills in the constraint's members about its corners. If no corner can move, the tool yields.
// Returns false if only some corners can move: a face that is partly fixed may have nowhere to go.
static bool describe_corners(const reach *r, cau_contact_row *row)
{
	const cau_session *session = r->session;
	int free_count = 0;
	for (int32_t k = 0; k < 3; k++) {
		int32_t v = row->vertex[k];
		CAU_ASSERT_INDEX(v, session->tissue.vertex_count);
		row->free[k] = !session->vertices.fixed[v];
		free_count += row->free[k];
		cau_vec3 local = cau_pose_to_local(&r->tool->pose_before,
		                                   cau_vec3_of(session->vertices.start + 3 * (size_t)v));
		cau_vec3_to(cau_pose_to_world(&r->tool->anchor, local), row->no_slip[k]);
	}
	return free_count == 0 || free_count == 3;
}

// Returns the squared distance, m^2, of two points.
static double apart2(const reach *r, const cau_contact_row *a, const cau_contact_row *b)
{
	cau_vec3 off = cau_sub(cau_contact_point(a, r->session->vertices.start),
	                       cau_contact_point(b, r->session->vertices.start));
	return cau_dot(off, off);
}

// Whether a constraint already acts at that point, as for another face at the same edge. On the
// same face a constraint at a small distance suffices, because a round tip is hardly deeper there.
static bool has_row(const reach *r, const cau_contact_row *row)
{
	const double near2 = 2 * r->def->hot_radius_m * beside_m;
	const cau_contact_set *set = &r->session->contact;
	for (int32_t i = 0; i < set->row_count; i++) {
		const cau_contact_row *other = &set->row[i];
		if (other->tool != row->tool || other->corner_count != row->corner_count || other->attached)
			continue;
		if (apart2(r, other, row) < (other->face == row->face ? near2 : same_m * same_m))
			return true;
	}
	return false;
}

// Adds the constraints of a face that was pushed in the last step: at the points where it was
// pushed, and at its present nearest point if that is not close to them. A face that is too far
// away gets no constraint. The old points are kept, because points that follow the nearest point
// would make resting tissue tilt to and fro.
static void take_up(const reach *r, const cau_contact_memory *kept, cau_contact_row *row)
{
	passage p;
	cau_vec3 gradient;
	follow(r, row, &p);
	double start = distance_at(r, &p, 0, p.weight, &gradient);
	if (!(start <= fmin(cau_session_margin(r->def) + p.way, most_margin_m)))
		return;
	place(r, &p, kept->above, start, row);
	CAU_ASSERT_INDEX(kept->point_count, CAU_MAX_POINTS + 1);
	for (int32_t k = 0; k < kept->point_count; k++) {
		memcpy(row->weight, kept->point[k], sizeof row->weight);
		if (!has_row(r, row))
			cau_contact_add(&r->session->contact, row);
	}
	memcpy(row->weight, p.weight, sizeof row->weight);
	if (!has_row(r, row))
		cau_contact_add(&r->session->contact, row);
}

static cau_candidate candidate_of(const reach *r, int32_t face)
{
	cau_candidate c = {.row = {.corner_count = 3, .tool = r->index, .face = face}};
	memcpy(c.row.vertex, r->session->tissue.faces.vertex + 3 * (size_t)face, sizeof c.row.vertex);
	return c;
}

static void offer(reach *r, int32_t face)
{
	cau_candidate c = candidate_of(r, face);
	if (!describe_corners(r, &c.row) || !is_missed(r, &c) || has_row(r, &c.row))
		return;
	r->kept_missed = r->kept_missed || c.kept;
	if (r->count < CANDIDATES)
		r->list[r->count++] = c;
	else
		r->session->contact.left_out_count++;
}

static bool is_drawn(const cau_session *session, int32_t face)
{
	return !(session->dissection.face_mask[face >> 5] >> (face & 31) & 1);
}

// Returns the middle of the box; *half_m gets the distance of its corners from there.
static cau_vec3 middle_of(const cau_box *box, double *half_m)
{
	cau_vec3 middle, half;
	double *m = &middle.x, *h = &half.x;
	for (int c = 0; c < 3; c++) {
		m[c] = 0.5 * ((double)box->least[c] + (double)box->most[c]);
		h[c] = 0.5 * ((double)box->most[c] - (double)box->least[c]);
	}
	*half_m = cau_length(half);
	return middle;
}

bool cau_session_may_meet(const cau_tool *tool, cau_tool_part part, const cau_box *box,
                          double margin_m)
{
	double half_m;
	cau_vec3 middle = middle_of(box, &half_m);
	double distance = cau_tool_distance_at(&tool->state.definition, &tool->state.pose,
	                                       tool->state.jaw, part, middle, NULL);
	return !(distance > half_m + margin_m);
}

// Returns the face's middle; *radius_m gets the greatest distance, m, of its corners from there.
static cau_vec3 middle_of_face(const double *position, const int32_t *vertex, double *radius_m)
{
	cau_vec3 corner[3], middle = {0, 0, 0};
	double radius2 = 0;
	for (int32_t k = 0; k < 3; k++) {
		corner[k] = cau_vec3_of(position + 3 * (size_t)vertex[k]);
		middle = cau_add_scaled(middle, 1.0 / 3, corner[k]);
	}
	for (int32_t k = 0; k < 3; k++) {
		cau_vec3 half = cau_sub(corner[k], middle);
		double half2 = cau_dot(half, half);
		radius2 = half2 > radius2 ? half2 : radius2;
	}
	*radius_m = sqrt(radius2);
	return middle;
}

static double distance_of(const reach *r, const cau_pose *pose, cau_vec3 point)
{
	return cau_tool_distance_at(r->def, pose, r->tool->state.jaw, r->part, point, NULL);
}

// Whether the face can have met the tool in the tick. First test: its distance at the tick's start
// is within the greatest motion since. When the tool turns, a corner beyond the tool's own size
// moves farther. Second test: the same with the distance at the present position. Faces that fail
// would be refused by is_missed, after a longer search.
static bool may_be_met(const reach *r, int32_t face)
{
	const int32_t *vertex = r->session->tissue.faces.vertex + 3 * (size_t)face;
	double radius;
	cau_vec3 middle = middle_of_face(r->session->vertices.start, vertex, &radius);
	double distance = distance_of(r, &r->tool->pose_before, middle);
	double beyond = fabs(distance) + 2 * radius;
	if (distance > radius + r->most_way + r->turning * beyond + 2 * touch_m)
		return false;
	middle = middle_of_face(r->session->vertices.position, vertex, &radius);
	distance = distance_of(r, &r->tool->state.pose, middle);
	return !(distance > radius + 2 * r->most_way + 2 * touch_m);
}

static void search_block(reach *r, int32_t block)
{
	const cau_near *near = &r->session->heat.near;
	for (int32_t i = near->face_first[block]; i < near->face_first[block + 1]; i++)
		if (is_drawn(r->session, near->face[i]) && may_be_met(r, near->face[i]))
			offer(r, near->face[i]);
}

// Finds the farthest motion of a vertex in the tick, m. Uses four independent maxima and sums, so
// that no operation waits for the result of another operation. The sums detect a motion that is not
// a number.
double cau_session_farthest(const cau_session *session)
{
	const double *position = session->vertices.position, *start = session->vertices.start;
	double most2[4] = {0}, sum[4] = {0};
	for (int32_t v = 0; v < session->tissue.vertex_count; v++) {
		size_t at = 3 * (size_t)v;
		cau_vec3 way = cau_sub(cau_vec3_of(position + at), cau_vec3_of(start + at));
		double way2 = cau_dot(way, way);
		most2[v & 3] = way2 > most2[v & 3] ? way2 : most2[v & 3];
		sum[v & 3] += way2;
	}
	double low = most2[0] > most2[1] ? most2[0] : most2[1];
	double high = most2[2] > most2[3] ? most2[2] : most2[3];
	double all = sum[0] + sum[1] + sum[2] + sum[3];
	return isnan(all) ? all : sqrt(low > high ? low : high);
}

// Finds the greatest motion, relative to the tool, that a point of the tissue may have in the tick.
static void find_most_way(reach *r, double reach_m)
{
	const cau_pose *from = &r->tool->pose_before, *to = &r->tool->state.pose;
	double way = cau_length(cau_sub(cau_vec3_of(to->position_m), cau_vec3_of(from->position_m)));
	double turn = 0;
	for (int i = 0; i < 4; i++)
		turn += from->rotation[i] * to->rotation[i];
	double half_turn = sqrt(fmax(1 - turn * turn, 0));
	r->turning = 2 * half_turn;
	r->most_way = r->session->touch.farthest_m + way + 2 * reach_m * half_turn;
}

static int compare(const void *a, const void *b)
{
	const cau_candidate *x = a, *y = b;
	if (x->depth != y->depth)
		return x->depth > y->depth ? -1 : 1;
	return memcmp(x->row.vertex, y->row.vertex, sizeof x->row.vertex);
}

cau_candidate *cau_session_make_reach(cau_arena *arena)
{
	return cau_arena_array(arena, CANDIDATES, sizeof(cau_candidate));
}

static reach begin(cau_session *session, int32_t index, cau_tool_part part)
{
	CAU_ASSERT_INDEX(index, session->tool_count);
	const cau_tool *tool = &session->tool[index];
	return (reach){.session = session,
	               .tool = tool,
	               .def = &tool->state.definition,
	               .index = index,
	               .part = part,
	               .list = session->touch.candidate};
}

bool cau_session_feels_faces(const cau_tool *tool)
{
	return !tool->state.grasping;
}

void cau_session_reach_again(cau_session *session, int32_t index, cau_tool_part part)
{
	reach r = begin(session, index, part);
	for (int32_t i = 0; i < session->contact.sides.memory_count; i++) {
		const cau_contact_memory *kept = &session->contact.sides.memory[i];
		if (kept->tool != index || !kept->pushed || !is_drawn(session, kept->face))
			continue;
		cau_candidate c = candidate_of(&r, kept->face);
		if (describe_corners(&r, &c.row))
			take_up(&r, kept, &c.row);
	}
}

void cau_session_reach(cau_session *session, int32_t index, cau_tool_part part)
{
	reach r = begin(session, index, part);
	cau_vec3 center;
	double radius;
	cau_tool_bound(r.def, part, &center, &radius);
	find_most_way(&r, cau_length(center) + radius);
	for (int32_t b = 0; b < session->heat.near.block_count; b++)
		if (cau_session_may_meet(r.tool, part, &session->heat.near.edge_box[b], r.most_way))
			search_block(&r, b);
	session->contact.tool[index].passing = r.count > 0;
	qsort(r.list, (size_t)r.count, sizeof *r.list, compare);
	// A face that touches only because the tool passed other faces may get a wrong side. So faces
	// of known side are held first.
	for (int32_t k = 0; k < r.count; k++)
		if (r.list[k].kept || !r.kept_missed)
			cau_contact_add(&session->contact, &r.list[k].row);
}
