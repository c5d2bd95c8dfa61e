// SPDX-License-Identifier: GPL-3.0-or-later
// The protocol's words for the numbers of enumerations. A number that this version does not know
// gives "?".
#pragma once

#include <stdint.h>

const char *cli_state_word(int32_t state);       // CAU_SESSION_*
const char *cli_layer_word(int32_t kind);        // CAU_LAYER_*
const char *cli_shape_word(int32_t shape);       // CAU_TOOL_*
const char *cli_energy_off_word(int32_t reason); // CAU_ENERGY_OFF_*
const char *cli_event_word(int32_t kind);        // CAU_EVENT_*
int32_t cli_shape_of_word(const char *word);     // -1 if the word is not a shape
