// SPDX-License-Identifier: GPL-3.0-or-later
// When a client gave its newest sign of life, by the server's clock. A message that waited on its
// way, or in a socket while the server was stopped, proves that its sender lived when it was sent,
// not when it was read. The sender's own clock tells when that was.
//
// The difference between a message's arrival and its sender's clock is the offset of the clocks
// plus the delay. The least difference is that of the shortest delay, so a message was sent at its
// sender's time plus the least difference, or earlier. The least difference grows old: clocks
// drift, and a clock may be set back. So it becomes the least of the last CAU_SIGN_WINDOW_S once
// messages have arrived for that long without a gap. Messages that arrive at once, as after a stop
// of the server, take none of that time.
//
// A clock that is set forward looks like a shorter delay. Beyond the deadline it is not believed at
// once: for one deadline messages measure the clock and are no signs of life.
#pragma once

#include <stdbool.h>

#define CAU_SIGN_WINDOW_S 5.0
#define CAU_SIGN_GAP_S 1.0 // a longer pause between two arrivals begins another window

typedef struct cau_sign_of_life {
	bool clocked;          // a message had a clock: only those with one count from then on
	double least_s;        // the difference that counts
	double window_from_s;  // arrival that began the window
	double window_least_s; // the least difference in it
	double arrival_s;      // of the newest message with a clock
	double client_s;       // its clock
	double measured_s;     // no message that arrives before this is a sign of life
	double alive_s;        // the newest sign of life, monotonic
} cau_sign_of_life;

// Notes a message with a clock. `arrival_s` is monotonic and never goes back; `client_s` is what
// the sender's clock showed, from any origin; `deadline_s` is the silence after which energy is
// cut. Returns when the sender gave its newest sign of life: at most `arrival_s`, never less than
// the last answer.
double cau_sign_of_life_hear(cau_sign_of_life *sign, double arrival_s, double client_s,
                             double deadline_s);
