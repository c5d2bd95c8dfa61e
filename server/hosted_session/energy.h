// SPDX-License-Identifier: GPL-3.0-or-later
// Passes changes of drivers and energy on to the core and the log. server/session/drive.c decides
// who drives and which energy is on.
#pragma once

#include "hosted_session/identity.h"
#include "hosted_session/present_core.h"

// Applies an energy-off or a hold, which cannot fail. Returns false if the command is of another
// kind.
bool cau_energy_off_or_hold(const cau_hosted_identity *identity, cau_present_core *core,
                            const cau_command *command);
// Turns the tool's energy off by the daemon itself. The log entry names no client.
void cau_energy_turn_off(cau_hosted *h, const char *tool);
// Carries out an energy cut-off of the decisions. Stops the tool where it is if its drive says
// `freeze`.
void cau_energy_cut(cau_hosted *h, const cau_action *action);
