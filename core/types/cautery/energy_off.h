// SPDX-License-Identifier: Apache-2.0
// Why a tool's energy is off; shared by core, protocol and the server's watchdog.
//
//     #include "cautery/energy_off.h"
//
//     // Whether a user must look at the tool before its energy comes back.
//     static int was_lost(cau_energy_off reason)
//     {
//         return reason == CAU_ENERGY_OFF_WATCHDOG || reason == CAU_ENERGY_OFF_TAKEN_OVER;
//     }
#pragma once

// The entries: code, wire name.
#define CAU_ENERGY_OFF_TABLE(X)                                                                    \
	X(NEVER_ENABLED, "never_enabled")                                                              \
	X(COMMANDED, "commanded")                                                                      \
	X(WATCHDOG, "watchdog")                                                                        \
	X(RESTORED, "restored")                                                                        \
	X(TAKEN_OVER, "taken_over")

// The reason why energy is off: CAU_ENERGY_OFF_TABLE.
typedef enum cau_energy_off {
#define X(code, name) CAU_ENERGY_OFF_##code,
	CAU_ENERGY_OFF_TABLE(X)
#undef X
		CAU_ENERGY_OFF_COUNT
} cau_energy_off;
