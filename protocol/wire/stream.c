// SPDX-License-Identifier: Apache-2.0
#include "cautery/stream.h"

#include <math.h>

#include "cautery/frame_codec.h"

_Static_assert(CAU_CHANNEL_COUNT <= 31, "a stream's channels are the bits of one word");
// A client that names no channels gets the default channels of its version. So these channels must
// not change within a version.
_Static_assert(CAU_FRAME_VERSION != 1 || CAU_CHANNELS_BY_DEFAULT == 0x2f,
               "within a version no channel is added to those of a stream by default");

#define OWN(X, code, name_, section_, when, meaning_)                                              \
	{.name = #name_,                                                                               \
	 .section = (section_),                                                                        \
	 .by_default = CAU_##when == CAU_BY_DEFAULT,                                                   \
	 .scalar = -1,                                                                                 \
	 .unit = "",                                                                                   \
	 .meaning = (meaning_)},
#define SCALAR(X, code, name_, section_, when, least_, step_, most_, unit_, meaning_)              \
	{.name = #name_,                                                                               \
	 .section = (section_),                                                                        \
	 .by_default = CAU_##when == CAU_BY_DEFAULT,                                                   \
	 .scalar = CAU_SCALAR_##code,                                                                  \
	 .least = (least_),                                                                            \
	 .step = (step_),                                                                              \
	 .most = (most_),                                                                              \
	 .unit = (unit_),                                                                              \
	 .meaning = (meaning_)},
static const cau_channel_info channels[CAU_CHANNEL_COUNT] = {CAU_CHANNEL_ROWS(OWN, SCALAR, )};
#undef OWN
#undef SCALAR

const cau_channel_info *cau_channel_describe(cau_channel_index channel)
{
	return &channels[channel];
}

double cau_channel_step(const cau_stream_def *def, cau_channel_index channel)
{
	return channels[channel].step > 0 ? channels[channel].step : def->stress_step_pa;
}

cau_stream_def cau_default_stream_def(void)
{
	return (cau_stream_def){
		.channels = CAU_CHANNELS_BY_DEFAULT,
		.step_m = 5e-5,
		.stress_step_pa = 10.0,
	};
}

cau_status cau_stream_def_check(const cau_stream_def *def, cau_error *error)
{
	if (def->vertex_count < 1 || def->vertex_count > CAU_STREAM_ELEMENTS_MAX)
		return cau_fail(error, CAU_BAD_VALUE, "vertex_count", "%d is not within 1 and %d",
		                def->vertex_count, CAU_STREAM_ELEMENTS_MAX);
	if (def->face_count < 0 || def->face_count > CAU_STREAM_ELEMENTS_MAX)
		return cau_fail(error, CAU_BAD_VALUE, "face_count", "%d is not within 0 and %d",
		                def->face_count, CAU_STREAM_ELEMENTS_MAX);
	if (def->profile >= CAU_STREAM_PROFILES_MAX)
		return cau_fail(error, CAU_BAD_VALUE, "profile", "%d is not below %d", def->profile,
		                CAU_STREAM_PROFILES_MAX);
	if (def->channels & ~(uint32_t)CAU_CHANNEL_ALL)
		return cau_fail(error, CAU_BAD_VALUE, "channels",
		                "a bit of the set of channels has no channel");
	if (!(def->step_m >= 1e-7 && def->step_m <= 1e-2))
		return cau_fail(error, CAU_BAD_VALUE, "step_m", "%g m is not within 1e-7 m and 0.01 m",
		                def->step_m);
	if (!(def->stress_step_pa >= 1e-3 && def->stress_step_pa <= 1e9))
		return cau_fail(error, CAU_BAD_VALUE, "stress_step_pa",
		                "%g Pa is not within 0.001 Pa and 1e9 Pa", def->stress_step_pa);
	for (int i = 0; i < 3; i++) {
		if (!(fabs(def->origin_m[i]) <= 1e6))
			return cau_fail(error, CAU_BAD_VALUE, "origin_m", "%g m is not within 1e6 m of zero",
			                def->origin_m[i]);
	}
	return CAU_OK;
}
