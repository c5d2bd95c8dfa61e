// SPDX-License-Identifier: Apache-2.0
// Force for the hand a thousand times a second, from contact records that come sixty times a
// second and late. It has no thread, no clock, and neither reads nor writes anything else.
//
//     #include "cautery/haptics.h"
//
//     // One period of a device: the newest record, or NULL, and what the motors are to give.
//     static void serve(cau_haptics *haptics, const cau_tool_contact *record, double now_s,
//                       const cau_haptics_device *device, double force_n[3])
//     {
//         if (record)
//             cau_haptics_take(haptics, record);
//         cau_haptics_render(haptics, device, now_s, force_n);
//     }
//
// The force is that of the record's linear contact at the place where the device is now. So a
// link's delay does not soften it. A new record is blended in. Three rules hold whatever the
// records say:
//
//   - Over any time the device gets no more energy than it gave, and reserve_j. That holds as long
//     as the device has at least mass_kg, a hand pushes it with hand_n at most, and the calls come
//     every period_s.
//   - From call to call the force changes by CAU_HAPTICS_SLEW_N_S times period_s at most.
//   - CAU_HAPTICS_SILENCE_S after the last record it is 0.
//
// It renders force alone, no torque.
#pragma once

#include <stdbool.h>

#include "cautery/channels.h"
#include "cautery/scene.h"
#include "cautery/status.h"

#ifdef __cplusplus
extern "C" {
#endif

#define CAU_HAPTICS_SLEW_N_S 300.0 // 0.3 N in a millisecond
#define CAU_HAPTICS_SILENCE_S 0.1  // without a record; the force is 0 by then

typedef struct cau_haptics cau_haptics; // one device that leads one tool; opaque

// What cau_haptics_create makes a renderer of. cau_default_haptics_def fills it.
typedef struct cau_haptics_def {
	double period_s;          // from call to call, 1e-4 to 2e-3; 0.001
	double blend_s;           // in which the jump of a new record is blended in, 0 to 0.1; a tick
	double fade_s;            // age of the last record at which the force begins to fade; 0.05
	double mass_kg;           // least mass that device and hand have at the tip; 0.05
	double hand_n;            // force that the hand gives at most; 5
	double reserve_j;         // energy that the device may get beyond the energy it gave; 5e-4
	double tank_j;            // most of the device's energy that is kept to give back; 0.05
	double damping_ratio;     // of the device on the contact's spring, above damping_hz; 0.2
	double damping_hz;        // slower motion is not damped; 6
	double stiffness_max_n_m; // stiffer contact is rendered with this; 2000
	double force_max_n;       // of the device, at most CAU_HAPTICS_SLEW_N_S * 0.02 s; 5
} cau_haptics_def;

// A definition with every member at its default.
cau_haptics_def cau_default_haptics_def(void);

// Makes a renderer; the caller destroys it. Errors: CAU_BAD_VALUE with the path of the member,
// CAU_NO_MEMORY.
cau_status cau_haptics_create(const cau_haptics_def *def, cau_haptics **haptics, cau_error *error);
void cau_haptics_destroy(cau_haptics *haptics); // takes NULL

// Hands over a copy of a new record. It acts from the next render on. One thread may call this
// while another one renders; neither waits. A record that cannot be rendered counts as one that is
// not valid: there is no contact.
void cau_haptics_take(cau_haptics *haptics, const cau_tool_contact *record);

// What a period begins with.
typedef struct cau_haptics_device {
	cau_pose pose;          // of the tool's tip in the world: what the device commands
	double velocity_m_s[3]; // of the tip
} cau_haptics_device;

// The force (N, in the world) for the next period. `now_s` is any clock that does not go back. It
// allocates nothing and takes a few microseconds. A pose, velocity or time that is not finite
// lets the force fade.
void cau_haptics_render(cau_haptics *haptics, const cau_haptics_device *device, double now_s,
                        double force_n[3]);

// What the last call of cau_haptics_render found.
typedef struct cau_haptics_report {
	double given_j; // energy given to the device since creation, minus the energy that the device
	                // gave
	double tank_j;  // energy that may be given now
	double age_s;   // of the newest record
	bool touching;  // the record's contact pushes
	bool limited;   // energy kept the force from being that of the contact
	bool fading;    // the newest record is too old, or not valid, or the device's state is bad
} cau_haptics_report;
// Fills *report. Called by the thread that renders.
void cau_haptics_describe(const cau_haptics *haptics, cau_haptics_report *report);

#ifdef __cplusplus
}
#endif
