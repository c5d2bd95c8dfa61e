// SPDX-License-Identifier: GPL-3.0-or-later
// Rotation of pieces that nothing holds. If a piece turns by an angle a in a tick, x + dt v is on
// the tangent, and v is the last chord. So implicit Euler (eq. 4) leaves the piece 1 - a^2 of its
// angular momentum. Here the piece's target s is turned about its centre of mass by the missing
// angle, some 2/3 a^3.
//
// Notation: c is the centre of mass, r = x_t - c, u the velocity less its mean, C = sum m r r^T.
// Forces inside a piece have no torque, so the step's solution x' has sum m x' x (s - c) = 0. Its
// angular momentum is sum m r x (x' - c) / dt. A piece that keeps its shape has x' - c = R r. R is
// the rotation with sum m r x R r = dt L, where L = sum m r x u. Q is the rotation with sum m R r x
// Q (r + dt u) = 0. Then s becomes c' + Q (r + dt u) + dt^2 f / m. The kinetic energy must not grow
// by it, so R may not have more than u has. The first guess is c' + R (P r + dt u): the motion of a
// rigid piece whose last tick was undone by P, with sum m r x P r = -dt L.
//
// A piece is the tissue that living elements connect. Pieces are found again after cuts. A piece
// that is attached to anything, or that extends only along a line, is not corrected. Nor is a piece
// that turns by less than a milliradian in a tick (it loses 1e-6 of its momentum), or so fast that
// no chord has its momentum.
#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "session/session_internal.h"

static const double least_turn = 1e-3; // rad in a tick; slower pieces are not corrected
// Least determinant of the inertia, relative to the cube of its trace.
static const double thinnest = 1e-9;

typedef double matrix[3][3]; // m[row][column]

cau_status cau_session_make_spin(cau_session *session, cau_error *error)
{
	size_t n = (size_t)session->tissue.vertex_count;
	cau_spin *spin = &session->spin;
	spin->piece = cau_arena_array(&session->memory.arena, n, sizeof *spin->piece);
	spin->member = cau_arena_array(&session->memory.arena, n, sizeof *spin->member);
	spin->first = cau_arena_array(&session->memory.arena, n + 1, sizeof *spin->first);
	spin->stale = true;
	if (!spin->piece || !spin->member || !spin->first)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for a session");
	return CAU_OK;
}

// ---- pieces

// Returns the least vertex that is known to be connected with `vertex`. The search shortens the
// paths that it follows (union-find with path halving).
static int32_t least_of(int32_t *piece, int32_t vertex)
{
	while (piece[vertex] != vertex) {
		CAU_ASSERT(piece[vertex] < vertex, "vertex %d leads to %d", vertex, piece[vertex]);
		piece[vertex] = piece[piece[vertex]];
		vertex = piece[vertex];
	}
	return vertex;
}

static void join(int32_t *piece, const int32_t *vertex, int count)
{
	CAU_ASSERT(count >= 2 && count <= 4, "an element of %d vertices", count);
	int32_t a = least_of(piece, vertex[0]);
	for (int i = 1; i < count; i++) {
		int32_t b = least_of(piece, vertex[i]);
		if (a < b)
			piece[b] = a;
		else
			piece[a] = b;
		a = a < b ? a : b;
	}
}

static void join_elements(cau_session *session)
{
	const cau_tissue *tissue = &session->tissue;
	// A hinge connects only vertices that its two triangles connect already.
	const struct {
		int kind, corners;
		int32_t count;
		const int32_t *vertex;
	} part[] = {
		{CAU_ELEMENT_TRIANGLE, 3, tissue->triangle_count, tissue->triangle},
		{CAU_ELEMENT_TETRAHEDRON, 4, tissue->tetrahedron_count, tissue->tetrahedron},
		{CAU_ELEMENT_LINK, 2, tissue->link_count, tissue->link},
	};
	for (size_t k = 0; k < sizeof part / sizeof part[0]; k++) {
		const uint8_t *alive = session->dissection.alive.element[part[k].kind];
		for (int32_t e = 0; e < part[k].count; e++)
			if (alive[e])
				join(session->spin.piece, part[k].vertex + (size_t)part[k].corners * (size_t)e,
				     part[k].corners);
	}
}

// Finds the members of each piece, in the order of vertices. Pieces are ordered by their least
// vertex. A vertex without elements is a piece of its own.
static void find_pieces(cau_session *session)
{
	cau_spin *spin = &session->spin;
	int32_t n = session->tissue.vertex_count, count = 0;
	for (int32_t v = 0; v < n; v++)
		spin->piece[v] = v;
	join_elements(session);
	memset(spin->first, 0, ((size_t)n + 1) * sizeof *spin->first);
	// The least vertex of a piece gets the piece's number before the other vertices.
	for (int32_t v = 0; v < n; v++) {
		int32_t least = least_of(spin->piece, v);
		spin->member[v] = least == v ? count++ : spin->member[least];
	}
	for (int32_t v = 0; v < n; v++) {
		spin->piece[v] = spin->member[v];
		spin->first[spin->piece[v] + 1]++;
	}
	for (int32_t p = 0; p < count; p++)
		spin->first[p + 1] += spin->first[p];
	CAU_ASSERT(spin->first[count] == n, "%d of %d vertices in pieces", spin->first[count], n);
	for (int32_t v = n - 1; v >= 0; v--) // each end is counted down until it is the beginning
		spin->member[--spin->first[spin->piece[v] + 1]] = v;
	memmove(spin->first, spin->first + 1, (size_t)count * sizeof *spin->first);
	spin->first[count] = n;
	spin->piece_count = count;
	spin->removed = session->dissection.elements_removed;
	spin->stale = false;
}

static bool is_free(const cau_session *session, int32_t piece)
{
	const cau_spin *spin = &session->spin;
	CAU_ASSERT_INDEX(piece, spin->piece_count);
	if (spin->first[piece + 1] - spin->first[piece] < 3)
		return false;
	for (int32_t k = spin->first[piece]; k < spin->first[piece + 1]; k++)
		if (session->vertices.fixed[spin->member[k]])
			return false;
	return true;
}

// ---- rotations
static void times(matrix a, matrix b, matrix out)
{
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			out[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
}

static double trace(matrix a)
{
	return a[0][0] + a[1][1] + a[2][2];
}

static cau_vec3 apply(matrix a, cau_vec3 v)
{
	return (cau_vec3){a[0][0] * v.x + a[0][1] * v.y + a[0][2] * v.z,
	                  a[1][0] * v.x + a[1][1] * v.y + a[1][2] * v.z,
	                  a[2][0] * v.x + a[2][1] * v.y + a[2][2] * v.z};
}

// Returns sum b x a of a matrix sum a b^T.
static cau_vec3 axial(matrix a)
{
	return (cau_vec3){a[2][1] - a[1][2], a[0][2] - a[2][0], a[1][0] - a[0][1]};
}

// Sets `out` to the rotation by the angle |turn| about the axis `turn` (Rodrigues).
static void rotation_of(cau_vec3 turn, matrix out)
{
	double angle2 = cau_dot(turn, turn), angle = sqrt(angle2);
	double one = angle > 1e-4 ? sin(angle) / angle : 1 - angle2 / 6;
	double two = angle > 1e-4 ? (1 - cos(angle)) / angle2 : 0.5 - angle2 / 24;
	const double t[3] = {turn.x, turn.y, turn.z};
	matrix cross = {{0, -t[2], t[1]}, {t[2], 0, -t[0]}, {-t[1], t[0], 0}};
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			out[i][j] = (i == j) * (1 - two * angle2) + one * cross[i][j] + two * t[i] * t[j];
}

// Sets `out` to trace(a) 1 - a: the derivative of the axial vector when a is turned. For a
// symmetric a this is the inertia.
static void inertia_of(matrix a, matrix out)
{
	double sum = trace(a);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			out[i][j] = (i == j) * sum - a[i][j];
}

static double determinant(matrix a)
{
	cau_vec3 row[3] = {cau_vec3_of(a[0]), cau_vec3_of(a[1]), cau_vec3_of(a[2])};
	return cau_dot(row[0], cau_cross(row[1], row[2]));
}

// Returns a^-1 b by Cramer's rule; a must not be singular.
static cau_vec3 solve(matrix a, cau_vec3 b)
{
	double det = determinant(a);
	CAU_ASSERT(det != 0, "a matrix of trace %g is singular", trace(a));
	cau_vec3 row[3] = {cau_vec3_of(a[0]), cau_vec3_of(a[1]), cau_vec3_of(a[2])};
	cau_vec3 sum = cau_scale(b.x, cau_cross(row[1], row[2]));
	sum = cau_add_scaled(sum, b.y, cau_cross(row[2], row[0]));
	return cau_scale(1 / det, cau_add_scaled(sum, b.z, cau_cross(row[0], row[1])));
}

// Finds, by Newton's method, the rotation near the identity for which the turned matrix a has the
// axial vector `wanted`. Returns false if none is found.
static bool turn_until(matrix a, cau_vec3 wanted, matrix rotation)
{
	enum { TRIES = 20 };
	matrix turned, slope, step, before;
	double enough = 1e-14 * fabs(trace(a));
	rotation_of((cau_vec3){0, 0, 0}, rotation);
	memcpy(turned, a, sizeof turned);
	for (int k = 0; k < TRIES; k++) {
		cau_vec3 wanting = cau_sub(wanted, axial(turned));
		if (cau_length(wanting) <= enough)
			return true;
		inertia_of(turned, slope);
		double sum = trace(slope);
		if (!(determinant(slope) > thinnest * sum * sum * sum))
			return false;
		rotation_of(solve(slope, wanting), step);
		memcpy(before, rotation, sizeof before);
		times(step, before, rotation);
		times(rotation, a, turned);
	}
	return false;
}

// ---- a piece
typedef struct motion {
	double mass;
	cau_vec3 centre, velocity; // of the centre of mass
	matrix spread;             // sum m r r^T, kg m^2
	matrix flow;               // sum m u r^T, kg m^2/s
	double kinetic_j;          // sum m u^2 / 2
} motion;

static void measure_motion(const cau_session *session, int32_t first, int32_t last, motion *out)
{
	*out = (motion){0};
	const double *mass = session->tissue.mass;
	for (int32_t k = first; k < last; k++) {
		size_t v = (size_t)session->spin.member[k];
		out->mass += mass[v];
		out->centre =
			cau_add_scaled(out->centre, mass[v], cau_vec3_of(session->vertices.start + 3 * v));
		out->velocity =
			cau_add_scaled(out->velocity, mass[v], cau_vec3_of(session->vertices.velocity + 3 * v));
	}
	CAU_ASSERT(out->mass > 0, "a piece of %g kg", out->mass);
	out->centre = cau_scale(1 / out->mass, out->centre);
	out->velocity = cau_scale(1 / out->mass, out->velocity);
	for (int32_t k = first; k < last; k++) {
		size_t v = (size_t)session->spin.member[k];
		double r[3], u[3];
		cau_vec3_to(cau_sub(cau_vec3_of(session->vertices.start + 3 * v), out->centre), r);
		cau_vec3_to(cau_sub(cau_vec3_of(session->vertices.velocity + 3 * v), out->velocity), u);
		for (int i = 0; i < 3; i++) {
			out->kinetic_j += mass[v] * u[i] * u[i] / 2;
			for (int j = 0; j < 3; j++) {
				out->spread[i][j] += mass[v] * r[i] * r[j];
				out->flow[i][j] += mass[v] * u[i] * r[j];
			}
		}
	}
}

// Reduces the rotation r, so that the energy of its chords is at most the present kinetic energy.
static void keep_energy(motion *m, double dt, matrix r)
{
	matrix turned;
	times(r, m->spread, turned);
	double chords_j = (trace(m->spread) - trace(turned)) / (dt * dt);
	CAU_ASSERT(m->kinetic_j >= 0, "an energy of %g J", m->kinetic_j);
	if (!(chords_j > m->kinetic_j))
		return;
	cau_vec3 axis = axial(r); // its length is twice the sine of the angle
	double sine = cau_length(axis) / 2, angle = atan2(sine, (trace(r) - 1) / 2);
	if (sine > 0)
		rotation_of(cau_scale(angle * sqrt(m->kinetic_j / chords_j) / (2 * sine), axis), r);
}

// Finds the rotations R, P and Q of the comment above. Returns false if the piece is not to be
// corrected.
static bool find_turn(motion *m, double dt, matrix r, matrix p, matrix q)
{
	matrix inertia, ahead, seen;
	inertia_of(m->spread, inertia);
	double sum = trace(inertia);
	if (!(determinant(inertia) > thinnest * sum * sum * sum))
		return false;
	cau_vec3 wanted = cau_scale(dt, axial(m->flow));
	cau_vec3 turn = solve(inertia, wanted);
	if (!(cau_length(turn) >= least_turn) || !turn_until(m->spread, wanted, r) ||
	    !turn_until(m->spread, cau_scale(-1, wanted), p))
		return false;
	keep_energy(m, dt, r);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			ahead[i][j] = m->spread[i][j] + dt * m->flow[i][j];
	matrix back = {
		{r[0][0], r[1][0], r[2][0]}, {r[0][1], r[1][1], r[2][1]}, {r[0][2], r[1][2], r[2][2]}};
	times(ahead, back, seen);
	if (!turn_until(seen, (cau_vec3){0, 0, 0}, q))
		return false;
	// With a longer correction than the turn itself, the piece does not turn as a whole.
	return cau_length(axial(q)) / 2 < cau_length(turn);
}

static void turn_piece(cau_session *session, int32_t first, int32_t last)
{
	double dt = session->solver.step_s;
	motion m;
	matrix r, p, q;
	measure_motion(session, first, last, &m);
	if (!find_turn(&m, dt, r, p, q))
		return;
	for (int32_t k = first; k < last; k++) {
		size_t v = (size_t)session->spin.member[k];
		cau_vec3 start = cau_vec3_of(session->vertices.start + 3 * v);
		cau_vec3 velocity = cau_vec3_of(session->vertices.velocity + 3 * v);
		cau_vec3 guess = cau_add_scaled(start, dt, velocity);
		cau_vec3 pushed = cau_sub(cau_vec3_of(session->solver.predicted + 3 * v), guess);
		cau_vec3 centre = cau_add_scaled(m.centre, dt, m.velocity);
		cau_vec3 target = cau_add(centre, apply(q, cau_sub(guess, centre)));
		cau_vec3_to(cau_add(target, pushed), session->solver.predicted + 3 * v);
		cau_vec3 before = apply(p, cau_sub(start, m.centre));
		before = cau_add_scaled(before, dt, cau_sub(velocity, m.velocity));
		cau_vec3_to(cau_add(centre, apply(r, before)), session->vertices.position + 3 * v);
	}
}

// ---- ticks with two substeps

// The state at the end of the second substep, about the piece's centre of mass.
typedef struct ending {
	cau_vec3 centre;
	cau_vec3 momentum; // kg m^2/s, computed with v2
	matrix spread;     // sum m r2 r2^T, kg m^2
} ending;

static void measure_ending(const cau_session *session, int32_t first, int32_t last, ending *out)
{
	*out = (ending){0};
	double mass = 0, h = session->solver.inertia_s;
	for (int32_t k = first; k < last; k++) {
		size_t v = (size_t)session->spin.member[k];
		double m = session->tissue.mass[v];
		mass += m;
		out->centre =
			cau_add_scaled(out->centre, m, cau_vec3_of(session->vertices.position + 3 * v));
	}
	CAU_ASSERT(mass > 0, "a piece of %g kg", mass);
	out->centre = cau_scale(1 / mass, out->centre);
	for (int32_t k = first; k < last; k++) {
		size_t v = (size_t)session->spin.member[k];
		double m = session->tissue.mass[v], r[3];
		cau_vec3 at = cau_vec3_of(session->vertices.position + 3 * v),
				 arm = cau_sub(at, out->centre);
		cau_vec3 way = cau_sub(at, cau_vec3_of(session->substep.base + 3 * v));
		out->momentum = cau_add_scaled(out->momentum, m / h, cau_cross(arm, way));
		cau_vec3_to(arm, r);
		for (int i = 0; i < 3; i++)
			for (int j = 0; j < 3; j++)
				out->spread[i][j] += m * r[i] * r[j];
	}
}

// Corrects the angular momentum of a piece. In both substeps the forces have no torque about the
// positions where they act. For a turning piece, a1 is half of the acceleration that holds the
// piece on its circle, because v is along the circle and v1 along a chord. So sum m x2 x v2 differs
// from the angular momentum L at the tick's start. So the function adds to v2 the rotation that
// restores L.
static void keep_momentum(cau_session *session, int32_t first, int32_t last)
{
	motion m;
	ending end;
	matrix inertia;
	measure_motion(session, first, last, &m);
	measure_ending(session, first, last, &end);
	inertia_of(end.spread, inertia);
	double sum = trace(inertia), h = session->solver.inertia_s;
	if (!(determinant(inertia) > thinnest * sum * sum * sum))
		return;
	cau_vec3 momentum = axial(m.flow); // sum m r x u
	if (!(cau_length(solve(inertia, momentum)) * session->solver.step_s >= least_turn))
		return;
	cau_vec3 more = cau_scale(-h, solve(inertia, cau_sub(momentum, end.momentum)));
	for (int32_t k = first; k < last; k++) {
		size_t v = (size_t)session->spin.member[k];
		double *base = session->substep.base + 3 * v;
		cau_vec3 arm = cau_sub(cau_vec3_of(session->vertices.position + 3 * v), end.centre);
		cau_vec3_to(cau_add(cau_vec3_of(base), cau_cross(more, arm)), base);
	}
}

static void turn_pieces(cau_session *session,
                        void (*turn)(cau_session *session, int32_t first, int32_t last))
{
	cau_spin *spin = &session->spin;
	// The paper's diagonal solver has no such correction.
	if (session->scene->solver == CAU_SOLVER_DIAGONAL)
		return;
	if (spin->stale || spin->removed != session->dissection.elements_removed)
		find_pieces(session);
	for (int32_t p = 0; p < spin->piece_count; p++)
		if (is_free(session, p))
			turn(session, spin->first[p], spin->first[p + 1]);
}

void cau_session_turn_prediction(cau_session *session)
{
	turn_pieces(session, turn_piece);
}

void cau_session_keep_momentum(cau_session *session)
{
	const cau_collide *collide = session->solver.collide;
	if (!session->contact.row_count && !session->solver.forces.drag_count &&
	    !(collide && collide->result.touching_count))
		turn_pieces(session, keep_momentum);
}
