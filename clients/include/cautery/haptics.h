// SPDX-License-Identifier: Apache-2.0
// Computes the force of a haptic device a thousand times a second. The contact records arrive sixty
// times a second and late. The renderer has no thread and no clock, and does no input or output.
//
//     #include "cautery/haptics.h"
//
//     // One period of a device. `record` is new, or NULL. The motors get force_n.
//     static void serve(cau_haptics *haptics, const cau_tool_contact *record, double now_s,
//                       const cau_haptics_device *device, double force_n[3])
//     {
//         if (record)
//             cau_haptics_take(haptics, record);
//         cau_haptics_render(haptics, device, now_s, force_n);
//     }
//
// The force is computed from the record's linear contact at the device's present position. So the
// delay of a link does not soften the contact. A new record is blended in. Three rules hold for any
// records:
//
//   - Over any time the device gets at most the energy that it gave plus reserve_j. This holds if
//     the device has at least mass_kg, the hand pushes with hand_n at most, and the calls come
//     every period_s.
//   - From call to call the force changes by CAU_HAPTICS_SLEW_N_S times period_s at most.
//   - The force is 0 CAU_HAPTICS_SILENCE_S after the last record.
//
// The renderer computes a force and no torque.
#pragma once

#include <stdbool.h>

#include "cautery/channels.h"
#include "cautery/scene.h"
#include "cautery/status.h"

#ifdef __cplusplus
extern "C" {
#endif

#define CAU_HAPTICS_SLEW_N_S 300.0 // largest change of the force, N/s: 0.3 N in a millisecond
#define CAU_HAPTICS_SILENCE_S 0.1  // time from the last record until the force is 0, s

typedef struct cau_haptics cau_haptics; // renderer for one device that drives one tool; opaque

// The definition of a renderer, filled by cau_default_haptics_def. Each comment ends with the
// default.
typedef struct cau_haptics_def {
	double period_s;  // time between two calls, 1e-4 to 2e-3; 0.001
	double blend_s;   // time in which the jump of a new record is blended in, 0 to 0.1; one tick
	double fade_s;    // age of the last record at which the force begins to fade; 0.05
	double mass_kg;   // smallest mass of device and hand at the tip; 0.05
	double hand_n;    // largest force of the hand; 5
	double reserve_j; // energy that the device may get beyond the energy that it gave; 5e-4
	double tank_j;    // largest stored energy of the device that can be given back; 0.05
	// damping ratio of the device on the contact's spring, above damping_hz; 0.2
	double damping_ratio;
	double damping_hz;        // slower motion is not damped; 6
	double stiffness_max_n_m; // stiffer contact is rendered with this stiffness; 2000
	double force_max_n; // largest force of the device, at most CAU_HAPTICS_SLEW_N_S * 0.02 s; 5
} cau_haptics_def;

// Returns a definition with every member at its default.
cau_haptics_def cau_default_haptics_def(void);

// Creates a renderer. The caller destroys it. Errors: CAU_BAD_VALUE with the path of the member,
// CAU_NO_MEMORY.
cau_status cau_haptics_create(const cau_haptics_def *def, cau_haptics **haptics, cau_error *error);
void cau_haptics_destroy(cau_haptics *haptics); // takes NULL

// Copies a new record into the renderer. The next render uses it. One thread may call this while
// another renders; neither waits. A record that cannot be rendered counts as not valid: there is no
// contact.
void cau_haptics_take(cau_haptics *haptics, const cau_tool_contact *record);

// State of the device at the beginning of a period.
typedef struct cau_haptics_device {
	cau_pose pose;          // pose of the tool's tip in the world, which is the commanded pose
	double velocity_m_s[3]; // velocity of the tip
} cau_haptics_device;

// Computes the force (N, in the world) for the next period. `now_s` is any clock that does not run
// backwards. The function allocates nothing and takes a few microseconds. If a pose, velocity or
// time is not finite, the force fades.
void cau_haptics_render(cau_haptics *haptics, const cau_haptics_device *device, double now_s,
                        double force_n[3]);

// Results of the last call of cau_haptics_render.
typedef struct cau_haptics_report {
	// energy given to the device since creation, minus the energy that the device gave
	double given_j;
	double tank_j; // energy that may be given now
	double age_s;  // age of the newest record
	bool touching; // the newest record's contact pushes
	bool limited;  // the energy limit changed the force
	bool fading;   // the newest record is too old or not valid, or the device's state is not finite
} cau_haptics_report;
// Fills *report. Call it from the rendering thread.
void cau_haptics_describe(const cau_haptics *haptics, cau_haptics_report *report);

#ifdef __cplusplus
}
#endif
