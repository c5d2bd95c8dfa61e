// SPDX-License-Identifier: GPL-3.0-or-later
#include "cautery/words.h"

#include <string.h>

#include "cautery/message_choices.h"

#define X(code, word) word,
static const char *const states[] = {CAU_SESSION_STATE_TABLE(X)};
static const char *const layers[] = {CAU_LAYER_TABLE(X)};
static const char *const reasons[] = {CAU_ENERGY_OFF_TABLE(X)};
static const char *const events[] = {CAU_EVENT_TABLE(X)};
#undef X
#define X(code, word, ...) #word,
static const char *const shapes[] = {CAU_TOOL_SHAPE_TABLE(X)};
#undef X

#define WORD(table, index)                                                                         \
	((uint32_t)(index) < sizeof(table) / sizeof *(table) ? (table)[(uint32_t)(index)] : "?")

const char *cli_state_word(int32_t state)
{
	return WORD(states, state);
}

const char *cli_layer_word(int32_t kind)
{
	return WORD(layers, kind);
}

const char *cli_shape_word(int32_t shape)
{
	return WORD(shapes, shape);
}

const char *cli_energy_off_word(int32_t reason)
{
	return WORD(reasons, reason);
}

const char *cli_event_word(int32_t kind)
{
	return WORD(events, kind);
}

int32_t cli_shape_of_word(const char *word)
{
	for (int32_t i = 0; i < CAU_TOOL_SHAPE_COUNT; i++)
		if (strcmp(word, shapes[i]) == 0)
			return i;
	return -1;
}
