// SPDX-License-Identifier: GPL-3.0-or-later
// A simulated hand that holds a device: 50 g, 0.3 N s/m, and a spring of 100 N/m to its wanted
// position.
#pragma once

#include <math.h>
#include <string.h>

typedef struct simulated_hand {
	double place_m[3], velocity_m_s[3];
	double wanted_m[3];
	double most_n;  // largest force of the hand; 0 for no limit
	double given_j; // work of the rendered force on the hand
} simulated_hand;

static const double hand_mass_kg = 0.05, hand_damping_ns_m = 0.3, hand_stiffness_n_m = 100;

// Moves the hand for a millisecond under a constant force.
static inline void hand_move(simulated_hand *hand, const double force_n[3])
{
	enum { PARTS = 10 };
	const double part_s = 0.001 / PARTS;
	double before[3];
	memcpy(before, hand->place_m, sizeof before);
	for (int k = 0; k < PARTS; k++) {
		double own[3], length = 0;
		for (int i = 0; i < 3; i++) {
			own[i] = hand_stiffness_n_m * (hand->wanted_m[i] - hand->place_m[i]) -
			         hand_damping_ns_m * hand->velocity_m_s[i];
			length += own[i] * own[i];
		}
		length = sqrt(length);
		double share = hand->most_n > 0 && length > hand->most_n ? hand->most_n / length : 1;
		for (int i = 0; i < 3; i++) {
			hand->velocity_m_s[i] += part_s / hand_mass_kg * (share * own[i] + force_n[i]);
			hand->place_m[i] += part_s * hand->velocity_m_s[i];
		}
	}
	for (int i = 0; i < 3; i++)
		hand->given_j += force_n[i] * (hand->place_m[i] - before[i]);
}
