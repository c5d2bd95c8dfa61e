// SPDX-License-Identifier: GPL-3.0-or-later
// Computes when a client gave its newest sign of life, by the server's clock. A message may wait on
// its way, or in a socket while the server is stopped. So it proves that its sender was alive when
// it was sent, not when it was read. The sender's clock gives the time of sending.
//
// The difference between a message's arrival and its sender's clock is the offset of the clocks
// plus the delay. The least difference belongs to the shortest delay. So a message was sent at its
// sender's time plus the least difference, or earlier. The least difference must not be kept for
// ever: clocks drift, and a clock may be set back. So it is replaced by the least difference of the
// last CAU_SIGN_WINDOW_S once messages have arrived for that long without a gap. Messages that
// arrive all at once, as after a stop of the server, take none of that time.
//
// A clock that is set forward looks like a shorter delay. If the change exceeds the deadline, it is
// not trusted at once: for one deadline, messages only measure the clock and are no signs of life.
#pragma once

#include <stdbool.h>

#define CAU_SIGN_WINDOW_S 5.0
// Longest pause between two arrivals of one window, s. A longer pause begins a new window.
#define CAU_SIGN_GAP_S 1.0

typedef struct cau_sign_of_life {
	bool clocked;          // a message had a clock; from then on only messages with a clock count
	double least_s;        // the least difference that is used
	double window_from_s;  // arrival that began the window
	double window_least_s; // the least difference in the window
	double arrival_s;      // arrival of the newest message with a clock
	double client_s;       // clock of the sender in that message
	double measured_s;     // messages that arrive before this time are no signs of life
	double alive_s;        // the newest sign of life, monotonic
} cau_sign_of_life;

// Notes a message with a clock. `arrival_s` is monotonic and never decreases. `client_s` is the
// sender's clock, from any origin. `deadline_s` is the silence after which energy is cut off.
// Returns the time of the sender's newest sign of life: at most `arrival_s`, and never less than
// the last result.
double cau_sign_of_life_hear(cau_sign_of_life *sign, double arrival_s, double client_s,
                             double deadline_s);
