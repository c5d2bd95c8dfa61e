// SPDX-License-Identifier: GPL-3.0-or-later
// The methods about profiles of instruments.
#include <stdio.h>
#include <string.h>

#include "cautery/instrument.h"
#include "rpc/internal.h"

enum { MOST_INSTRUMENTS = 64 };

static const char *shape_word(int shape)
{
#define X(code, word, ...) #word,
	static const char *const words[] = {CAU_TOOL_SHAPE_TABLE(X)};
#undef X
	return words[shape];
}

static void describe_mode(const cau_instrument_mode *from, cau_wire_instrument_mode *to)
{
	*to = (cau_wire_instrument_mode){.power_w = from->tool.power_w,
	                                 .power_least_w = from->power_least_w,
	                                 .power_most_w = from->power_most_w,
	                                 .peak_v = from->tool.peak_v,
	                                 .crest_factor = from->tool.crest_factor,
	                                 .current_max_a = from->tool.current_max_a,
	                                 .load_rise_off = from->tool.load_rise_off};
	snprintf(to->mode, sizeof to->mode, "%s", from->name);
	snprintf(to->description, sizeof to->description, "%s", from->description);
}

static void describe(const cau_instrument *from, cau_wire_instrument *to,
                     cau_wire_instrument_mode *modes)
{
	memset(to, 0, sizeof *to);
	snprintf(to->name, sizeof to->name, "%s", from->name);
	snprintf(to->description, sizeof to->description, "%s", from->description);
	snprintf(to->shape, sizeof to->shape, "%s", shape_word(from->modes[0].tool.shape));
	for (int32_t m = 0; m < from->mode_count; m++)
		describe_mode(&from->modes[m], &modes[m]);
	to->modes = (cau_wire_list){modes, from->mode_count, CAU_MAX_MODES};
}

void cau_call_instrument_list(cau_call *call)
{
	static cau_wire_instrument list[MOST_INSTRUMENTS]; // used by the network thread only
	static cau_wire_instrument_mode modes[MOST_INSTRUMENTS][CAU_MAX_MODES];
	cau_error error = {0};
	cau_wire_instrument_list result = {.instruments = {list, 0, MOST_INSTRUMENTS}};
	for (int32_t i = 0; i < cau_instrument_count(); i++) {
		cau_instrument read;
		if (cau_instrument_read(i, &read, &error)) {
			cau_call_fail(call, &error, 0);
			return;
		}
		describe(&read, &list[i], modes[i]);
		result.instruments.count++;
	}
	cau_call_result(call, &result);
}
