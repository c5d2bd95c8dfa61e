// SPDX-License-Identifier: GPL-3.0-or-later
// What the core and the log get of drivers and energy. Who drives, and which energy is on, is
// decided in server/session/drive.c.
#pragma once

#include "hosted_session/identity.h"
#include "hosted_session/present_core.h"

// Does an energy off or a hold, which cannot fail. False: the command is another.
bool cau_energy_off_or_hold(const cau_hosted_identity *identity, cau_present_core *core,
                            const cau_command *command);
// Energy off by the daemon itself, in the log without a client.
void cau_energy_turn_off(cau_hosted *h, const char *tool);
// Energy off and the tool where it is, as was decided.
void cau_energy_cut(cau_hosted *h, const cau_action *action);
