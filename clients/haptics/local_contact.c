// SPDX-License-Identifier: Apache-2.0
// C is the compliance and n_i, o_i are the planes. The forces f_i >= 0 satisfy n_i . p - o_i + n_i
// . C f >= 0, complementary, with f = sum n_i f_i. This is the linear force F + K (p_record - p),
// projected onto the cone of the normals in the norm of C. The part that the projection removes is
// friction, within Coulomb's law.
//
// A tip is round: a larger force makes it touch more tissue, and the contact becomes stiffer. By
// Hertz's law the force grows with the depth to the power 1.5. So the record's stiffness K at its
// force F means a depth of 1.5 F / K, not F / K. The planes get this compliance along F. Their
// force is multiplied by the root of its share of F. So the force, its slope at the record, and the
// position where it becomes 0 follow Hertz's law.
#include "haptics/internal.h"

#include <string.h>

// Largest number of Gauss-Seidel sweeps over the planes (8 at most). They start from the last
// forces.
enum { SWEEPS = 32 };
static const double hertz = 1.5; // exponent of the depth in Hertz's law
// Largest force for which the stiffness grows, over the record's force.
static const double most_share = 2;
// Largest change of a force in a sweep, N, with which the iteration ends.
static const double settled = 1e-9;
// Largest accepted position (m), force (N) and compliance (m/N).
static const double most_m = 100, most_n = 1e5, most_m_n = 1e3;

static double least_eigenvalue(const double m[6])
{
	const double pi = 3.14159265358979323846;
	double off = m[3] * m[3] + m[4] * m[4] + m[5] * m[5], mean = (m[0] + m[1] + m[2]) / 3;
	double a = m[0] - mean, b = m[1] - mean, c = m[2] - mean;
	double size = sqrt((a * a + b * b + c * c + 2 * off) / 6);
	if (!(size > 0))
		return mean;
	double determinant = a * (b * c - m[5] * m[5]) - m[3] * (m[3] * c - m[5] * m[4]) +
	                     m[4] * (m[3] * m[5] - b * m[4]);
	double half = determinant / (2 * size * size * size);
	double angle = acos(fmin(fmax(half, -1), 1)) / 3;
	return mean + 2 * size * cos(angle + 2 * pi / 3);
}

static void invert(double to[6], const double m[6])
{
	double xx = m[1] * m[2] - m[5] * m[5], xy = m[4] * m[5] - m[3] * m[2];
	double xz = m[3] * m[5] - m[4] * m[1];
	double determinant = m[0] * xx + m[3] * xy + m[4] * xz;
	to[0] = xx / determinant;
	to[1] = (m[0] * m[2] - m[4] * m[4]) / determinant;
	to[2] = (m[0] * m[1] - m[3] * m[3]) / determinant;
	to[3] = xy / determinant;
	to[4] = xz / determinant;
	to[5] = (m[3] * m[4] - m[0] * m[5]) / determinant;
}

static bool is_within(const double *values, int count, double most)
{
	for (int i = 0; i < count; i++)
		if (!(fabs(values[i]) <= most)) // the comparison is also false for a NaN
			return false;
	return true;
}

const char *local_contact_check(const cau_tool_contact *record)
{
	const double tolerance = CAU_UNIT_TOLERANCE;
	_Static_assert(CAU_CONTACT_PLANES == 8, "the message below names the limit");
	if (record->plane_count < 0 || record->plane_count > CAU_CONTACT_PLANES)
		return "the count of planes is not within 0 to 8";
	for (int i = 0; i < record->plane_count; i++) {
		const cau_contact_plane *plane = &record->plane[i];
		if (!(fabs(length3(plane->normal) - 1) <= tolerance))
			return "the normal of a plane does not have length 1";
		if (!is_within(&plane->offset_m, 1, 2 * most_m) ||
		    !is_within(&plane->velocity_m_s, 1, most_m))
			return "a plane is out of range";
	}
	if (!is_within(record->asked_pose.position_m, 3, most_m) ||
	    !is_within(record->grasp_anchor_m, 3, 10 * most_m) ||
	    !is_within(record->force_n, 3, most_n))
		return "a position or a force of the contact is out of range";
	if (!is_within(record->compliance_m_n, 6, most_m_n) ||
	    !(least_eigenvalue(record->compliance_m_n) > 0))
		return "the compliance of the contact is not positive";
	const double scalars[] = {record->friction, record->damping_ns_m, record->grasp_n_m};
	for (int i = 0; i < 3; i++)
		if (!(scalars[i] >= 0) || !is_within(&scalars[i], 1, most_n))
			return "friction, damping or the grasp's stiffness is out of range";
	return NULL;
}

// Performs one Gauss-Seidel sweep. Returns the largest change of a force, N.
static double sweep(local_contact *contact, const double gap_m[CAU_CONTACT_PLANES])
{
	double change = 0;
	for (int i = 0; i < contact->plane_count; i++) {
		double apart = gap_m[i];
		for (int j = 0; j < contact->plane_count; j++)
			apart += contact->coupling[i][j] * contact->pressing_n[j];
		double before = contact->pressing_n[i];
		contact->pressing_n[i] = fmax(before - apart / contact->coupling[i][i], 0);
		change = fmax(change, fabs(contact->pressing_n[i] - before));
	}
	return change;
}

// Sums the planes' forces and computes the mean speed of the tissue behind the planes.
static void push(local_contact *contact, const double place_m[3], local_force *out)
{
	double gap_m[CAU_CONTACT_PLANES], sum = 0;
	for (int i = 0; i < contact->plane_count; i++)
		gap_m[i] = dot3(contact->plane[i].normal, place_m) - contact->plane[i].offset_m;
	for (int k = 0; k < SWEEPS && sweep(contact, gap_m) > settled; k++)
		;
	for (int i = 0; i < contact->plane_count; i++) {
		const cau_contact_plane *plane = &contact->plane[i];
		add_scaled3(out->force_n, out->force_n, contact->pressing_n[i], plane->normal);
		out->tissue_m_s += contact->pressing_n[i] * plane->velocity_m_s;
		sum += contact->pressing_n[i];
	}
	out->tissue_m_s /= sum > 0 ? sum : 1;
	out->pressed_n = sum;
}

static void couple_planes(local_contact *contact)
{
	for (int i = 0; i < contact->plane_count; i++)
		for (int j = 0; j < contact->plane_count; j++) {
			double moved[3];
			symmetric_times(moved, contact->compliance, contact->plane[j].normal);
			contact->coupling[i][j] = dot3(contact->plane[i].normal, moved);
		}
}

// Puts a spring in series, so that no direction is stiffer than `most`. The planes are moved by the
// spring's deflection, so their forces at the record's position stay the same.
static void bound_stiffness(local_contact *contact, double most)
{
	double more = fmax(1 / most - least_eigenvalue(contact->compliance), 0);
	contact->grasp_n_m = fmin(contact->grasp_n_m, most);
	if (more == 0)
		return;
	local_force at = {0};
	push(contact, contact->place_m, &at);
	for (int i = 0; i < 3; i++)
		contact->compliance[i] += more;
	for (int i = 0; i < contact->plane_count; i++)
		contact->plane[i].offset_m += more * dot3(contact->plane[i].normal, at.force_n);
	couple_planes(contact);
}

// Makes the planes 1.5 times as soft along the record's force, and no softer across it. The planes'
// force at the record's position stays the same.
static void round_tip(local_contact *contact)
{
	local_force at = {0};
	push(contact, contact->place_m, &at);
	contact->record_n = length3(at.force_n);
	if (!(contact->record_n > 0))
		return;
	double moved[3];
	symmetric_times(moved, contact->compliance, at.force_n);
	double share = (hertz - 1) / dot3(at.force_n, moved);
	static const int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
	for (int i = 0; i < 6; i++)
		contact->compliance[i] += share * moved[row[i]] * moved[column[i]];
	for (int i = 0; i < contact->plane_count; i++)
		contact->plane[i].offset_m += (hertz - 1) * dot3(contact->plane[i].normal, moved);
	couple_planes(contact);
}

void local_contact_set(local_contact *contact, const cau_tool_contact *record,
                       double stiffness_max_n_m)
{
	memset(contact, 0, sizeof *contact);
	contact->valid = record->valid && !local_contact_check(record);
	if (!contact->valid)
		return;
	memcpy(contact->place_m, record->asked_pose.position_m, sizeof contact->place_m);
	memcpy(contact->compliance, record->compliance_m_n, sizeof contact->compliance);
	contact->plane_count = record->plane_count;
	memcpy(contact->plane, record->plane, sizeof contact->plane);
	contact->friction = record->friction;
	contact->damping_ns_m = record->damping_ns_m;
	contact->grasp_n_m = record->grasp_n_m;
	double pull[3]; // force of the grasp in the record
	add_scaled3(pull, record->grasp_anchor_m, -1, contact->place_m);
	add_scaled3(contact->force_n, record->force_n, -record->grasp_n_m, pull);
	couple_planes(contact);
	bound_stiffness(contact, stiffness_max_n_m);
	// The grasp's spring gives the record's force at the record's position.
	if (contact->grasp_n_m > 0)
		add_scaled3(contact->grasp_anchor_m, contact->place_m,
		            record->grasp_n_m / contact->grasp_n_m, pull);
	round_tip(contact);
	invert(contact->stiffness, contact->compliance);
}

// Adds the part of the linear force that the cone removed, within Coulomb's law. In a dimple this
// part is not perpendicular to the planes' force, because friction on the sides carries load too.
static void add_friction(const local_contact *contact, const double place_m[3], local_force *out)
{
	double moved[3], pulled[3], linear[3], along[3];
	add_scaled3(moved, place_m, -1, contact->place_m);
	symmetric_times(pulled, contact->stiffness, moved);
	add_scaled3(linear, contact->force_n, -1, pulled);
	add_scaled3(along, linear, -1, out->force_n);
	double length = length3(along), most = contact->friction * out->pressed_n;
	double share = length > most ? most / length : 1;
	add_scaled3(out->force_n, out->force_n, share, along);
}

local_force local_contact_force(local_contact *contact, const double place_m[3])
{
	local_force out = {.grasp_n_m = contact->grasp_n_m};
	if (!contact->valid)
		return out;
	push(contact, place_m, &out);
	out.normal_n = length3(out.force_n);
	if (out.normal_n > 0) {
		double moved[3];
		add_scaled3(out.normal, (double[3]){0, 0, 0}, 1 / out.normal_n, out.force_n);
		symmetric_times(moved, contact->compliance, out.normal);
		out.normal_n_m = 1 / dot3(out.normal, moved);
		out.damping_ns_m = contact->damping_ns_m;
		add_friction(contact, place_m, &out);
		if (contact->record_n > 0) { // Hertz's law
			double factor = sqrt(fmin(out.normal_n / contact->record_n, most_share));
			for (int i = 0; i < 3; i++)
				out.force_n[i] *= factor;
			out.normal_n *= factor;
			out.normal_n_m *= hertz;
		}
	}
	double pull[3];
	add_scaled3(pull, contact->grasp_anchor_m, -1, place_m);
	add_scaled3(out.force_n, out.force_n, contact->grasp_n_m, pull);
	return out;
}
