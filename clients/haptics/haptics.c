// SPDX-License-Identifier: Apache-2.0
// One render adds the newest record's linear contact at the device's position, the part of the
// record's jump that is not blended in yet, and damping of fast motion. The sum fades with the
// record's age. Then the guard limits it.
#include "cautery/haptics.h"

#include <math.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "cautery/channels.h"
#include "haptics/internal.h"

// ---- mailbox of records ------------------------------------------------------------------------
// Passes the newest record from one thread to another without waiting. There are three slots. One
// is the writer's, one is the reader's, and the third is between them: each of them exchanges its
// own slot for it.
enum { MAILBOX_FRESH = 4 }; // flag in `between`: the record in the third slot is unread

typedef struct mailbox {
	cau_tool_contact slot[3];
	// number of the third slot, plus MAILBOX_FRESH if its record is unread
	_Atomic unsigned between;
	unsigned writing; // the writer's slot; only the writer uses it
	unsigned reading; // the reader's slot; only the reader uses it
} mailbox;

static void mailbox_begin(mailbox *mail)
{
	atomic_init(&mail->between, 0);
	mail->writing = 1;
	mail->reading = 2;
}

// Copies a record into the mailbox. An unread older record is lost.
static void mailbox_put(mailbox *mail, const cau_tool_contact *record)
{
	mail->slot[mail->writing] = *record;
	mail->writing = atomic_exchange_explicit(&mail->between, mail->writing | MAILBOX_FRESH,
	                                         memory_order_acq_rel) &
	                ~(unsigned)MAILBOX_FRESH;
}

// Returns the newest record if it is unread, else NULL. The record belongs to the reader until the
// next call.
static cau_tool_contact *mailbox_get(mailbox *mail)
{
	if (!(atomic_load_explicit(&mail->between, memory_order_relaxed) & MAILBOX_FRESH))
		return NULL;
	mail->reading = atomic_exchange_explicit(&mail->between, mail->reading, memory_order_acq_rel) &
	                ~(unsigned)MAILBOX_FRESH;
	return &mail->slot[mail->reading];
}

// ---- the renderer ------------------------------------------------------------------------------
// Periods of delay: one until a render sees an arrived record, and one to spare.
enum { LATE_PERIODS = 2 };

struct cau_haptics {
	cau_haptics_def def;
	double zero_s; // age of the newest record at which the wanted force is 0
	mailbox mail;
	local_contact contact;
	energy_guard guard;
	bool begun;
	// time of the last render; time of the render that took the newest record
	double now_s, taken_s;
	double jump_n[3];   // the old contact's force minus the new contact's force at the time of the
	                    // last record
	double slow_m_s[3]; // low-pass velocity of the device, below damping_hz
	cau_haptics_report report;
};

cau_haptics_def cau_default_haptics_def(void)
{
	return (cau_haptics_def){
		.period_s = 0.001,
		.blend_s = 1.0 / 60,
		.fade_s = 0.05,
		.mass_kg = 0.05,
		.hand_n = 5,
		.reserve_j = 5e-4,
		.tank_j = 0.05,
		.damping_ratio = 0.2,
		.damping_hz = 6,
		.stiffness_max_n_m = 2000,
		.force_max_n = 5,
	};
}

// Returns the age at which the wanted force is 0. It leaves the guard enough time to reduce the
// largest force to 0 before CAU_HAPTICS_SILENCE_S.
static double zero_age(const cau_haptics_def *def)
{
	return CAU_HAPTICS_SILENCE_S - LATE_PERIODS * def->period_s -
	       def->force_max_n / CAU_HAPTICS_SLEW_N_S;
}

static cau_status check(const cau_haptics_def *def, cau_error *error)
{
	const struct {
		const char *name;
		double value, least, most;
	} members[] = {
		{"period_s", def->period_s, 1e-4, 2e-3},
		{"blend_s", def->blend_s, 0, 0.1},
		{"fade_s", def->fade_s, 0, 0.1},
		{"mass_kg", def->mass_kg, 1e-3, 100},
		{"hand_n", def->hand_n, 0, 100},
		{"reserve_j", def->reserve_j, 0, 1},
		{"tank_j", def->tank_j, 0, 100},
		{"damping_ratio", def->damping_ratio, 0, 2},
		{"damping_hz", def->damping_hz, 0, 100},
		{"stiffness_max_n_m", def->stiffness_max_n_m, 1, 1e5},
		{"force_max_n", def->force_max_n, 0.01, 0.02 * CAU_HAPTICS_SLEW_N_S},
	};
	for (size_t i = 0; i < sizeof members / sizeof *members; i++)
		if (!(members[i].value >= members[i].least && members[i].value <= members[i].most))
			return cau_fail(error, CAU_BAD_VALUE, members[i].name, "%g is not within %g to %g",
			                members[i].value, members[i].least, members[i].most);
	if (def->fade_s >= zero_age(def))
		return cau_fail(
			error, CAU_BAD_VALUE, "fade_s",
			"%g s is too late: the force of %g N must begin to fall at %g s to reach 0 in time",
			def->fade_s, def->force_max_n, zero_age(def));
	return CAU_OK;
}

cau_status cau_haptics_create(const cau_haptics_def *def, cau_haptics **haptics, cau_error *error)
{
	cau_status status = check(def, error);
	if (status)
		return status;
	cau_haptics *made = calloc(1, sizeof *made);
	if (!made)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the haptic renderer");
	made->def = *def;
	made->zero_s = zero_age(def);
	made->guard.def = (energy_guard_def){
		.period_s = def->period_s,
		.slew_n = CAU_HAPTICS_SLEW_N_S * def->period_s,
		.mass_kg = def->mass_kg,
		.hand_n = def->hand_n,
		.reserve_j = def->reserve_j,
		.tank_j = fmax(def->tank_j, def->reserve_j),
	};
	made->taken_s = -INFINITY;
	mailbox_begin(&made->mail);
	*haptics = made;
	return CAU_OK;
}

void cau_haptics_destroy(cau_haptics *haptics)
{
	free(haptics);
}

void cau_haptics_take(cau_haptics *haptics, const cau_tool_contact *record)
{
	mailbox_put(&haptics->mail, record);
}

// Returns the share of the wanted force that remains at the newest record's age.
static double fade(const cau_haptics *haptics)
{
	double age = haptics->now_s - haptics->taken_s;
	double share = (haptics->zero_s - age) / (haptics->zero_s - haptics->def.fade_s);
	return fmin(fmax(share, 0), 1);
}

// Returns the share of the last jump that is not blended in yet.
static double unblended(const cau_haptics *haptics)
{
	double age = haptics->now_s - haptics->taken_s;
	return age < haptics->def.blend_s ? 1 - age / haptics->def.blend_s : 0;
}

// Takes a new record. The jump between the old and the new force is kept and blended out, so the
// felt force stays continuous.
static void take_record(cau_haptics *haptics, const cau_tool_contact *record,
                        const double place_m[3])
{
	double share = fade(haptics), left = unblended(haptics), felt[3];
	local_force old = local_contact_force(&haptics->contact, place_m);
	add_scaled3(felt, old.force_n, left, haptics->jump_n);
	local_contact_set(&haptics->contact, record, haptics->def.stiffness_max_n_m);
	local_force new = local_contact_force(&haptics->contact, place_m);
	for (int i = 0; i < 3; i++)
		haptics->jump_n[i] = share * felt[i] - new.force_n[i];
	haptics->taken_s = haptics->now_s;
}

// Subtracts damping * velocity from the force. Across the contact the damping is limited by
// friction. Along the normal it is limited by the pressing force, because tissue does not pull.
static void damp_contact(double force_n[3], const local_force *at, double damping_ns_m,
                         const double fast_m_s[3], const double velocity_m_s[3], double friction)
{
	double across[3], fast = dot3(fast_m_s, at->normal);
	double relative = dot3(velocity_m_s, at->normal) - at->tissue_m_s;
	double along = damping_ns_m * fast + at->damping_ns_m * relative;
	add_scaled3(force_n, force_n, -fmin(along, at->normal_n), at->normal);
	add_scaled3(across, fast_m_s, -fast, at->normal);
	double length = length3(across), most = friction * at->normal_n;
	if (length > 0)
		add_scaled3(force_n, force_n, -fmin(damping_ns_m, most / length), across);
}

static void add_damping(const cau_haptics *haptics, const local_force *at,
                        const double velocity_m_s[3], double force_n[3])
{
	double twice = 2 * haptics->def.damping_ratio, mass = haptics->def.mass_kg, fast[3];
	add_scaled3(fast, velocity_m_s, -1, haptics->slow_m_s);
	if (at->normal_n > 0)
		damp_contact(force_n, at, twice * sqrt(mass * at->normal_n_m), fast, velocity_m_s,
		             haptics->contact.friction);
	if (at->grasp_n_m > 0)
		add_scaled3(force_n, force_n, -twice * sqrt(mass * at->grasp_n_m), fast);
}

static void follow_velocity(cau_haptics *haptics, const double velocity_m_s[3], double passed_s)
{
	const double pi = 3.14159265358979323846;
	double turned = 2 * pi * haptics->def.damping_hz * passed_s;
	for (int i = 0; i < 3; i++)
		haptics->slow_m_s[i] += turned / (1 + turned) * (velocity_m_s[i] - haptics->slow_m_s[i]);
}

static void bound_length(double force_n[3], double most)
{
	double length = length3(force_n);
	if (length > most)
		for (int i = 0; i < 3; i++)
			force_n[i] *= most / length;
}

// Computes the wanted force, before the guard.
static void want(cau_haptics *haptics, const cau_haptics_device *device, double force_n[3])
{
	const double *place = device->pose.position_m, *velocity = device->velocity_m_s;
	local_force at = local_contact_force(&haptics->contact, place);
	add_scaled3(force_n, at.force_n, unblended(haptics), haptics->jump_n);
	add_damping(haptics, &at, velocity, force_n);
	double share = fade(haptics);
	for (int i = 0; i < 3; i++)
		force_n[i] *= share;
	bound_length(force_n, haptics->def.force_max_n);
	haptics->report.touching = at.normal_n > 0 || at.grasp_n_m > 0;
	haptics->report.fading = share < 1 || !haptics->contact.valid;
}

// True if the device's state is finite and the clock does not run backwards.
static bool is_sound(const cau_haptics *haptics, const cau_haptics_device *device, double now_s)
{
	return isfinite(now_s) && (!haptics->begun || now_s >= haptics->now_s) &&
	       is_finite3(device->pose.position_m) && is_finite3(device->velocity_m_s);
}

void cau_haptics_render(cau_haptics *haptics, const cau_haptics_device *device, double now_s,
                        double force_n[3])
{
	static const double still[3] = {0, 0, 0};
	bool sound = is_sound(haptics, device, now_s);
	const cau_tool_contact *record = sound ? mailbox_get(&haptics->mail) : NULL;
	const double *place = sound ? device->pose.position_m : haptics->guard.place_m;
	const double *velocity = sound ? device->velocity_m_s : still;
	double passed_s = sound && haptics->begun ? now_s - haptics->now_s : 0;
	energy_guard_account(&haptics->guard, place);
	if (sound)
		haptics->now_s = now_s;
	haptics->begun = haptics->begun || sound;
	if (record)
		take_record(haptics, record, place);
	follow_velocity(haptics, velocity, passed_s);
	memset(force_n, 0, 3 * sizeof *force_n);
	haptics->report.touching = false;
	haptics->report.fading = true;
	if (sound)
		want(haptics, device, force_n);
	haptics->report.limited = energy_guard_bound(&haptics->guard, velocity, force_n);
	haptics->report.given_j = haptics->guard.given_j;
	haptics->report.tank_j = haptics->guard.tank_j;
	haptics->report.age_s = haptics->now_s - haptics->taken_s;
}

void cau_haptics_describe(const cau_haptics *haptics, cau_haptics_report *report)
{
	*report = haptics->report;
}
