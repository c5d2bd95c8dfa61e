// SPDX-License-Identifier: GPL-3.0-or-later
#include "protocol/wire/chain.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

// Largest error of a decoded position, m: half a step, plus the rounding of the multiplication by 1
// / step.
static const double round_off_m = 0.5 * 5e-5 + 1e-12;

cau_frame_decoder *chain_new_decoder(const cau_stream_def *def)
{
	size_t bytes = cau_frame_decoder_bytes(def);
	cau_frame_decoder *decoder;
	assert_int_equal(cau_frame_decoder_init(malloc(bytes), bytes, def, &decoder, NULL), CAU_OK);
	return decoder;
}

void chain_init(chain *made, int32_t columns, int32_t rows)
{
	tissue_init(&made->tissue, columns, rows);
	made->def = tissue_stream_def(&made->tissue);
	size_t bytes = cau_frame_encoder_bytes(&made->def);
	assert_int_equal(
		cau_frame_encoder_init(malloc(bytes), bytes, &made->def, CHAIN_EPOCH, &made->encoder, NULL),
		CAU_OK);
	made->decoder = chain_new_decoder(&made->def);
	made->capacity = cau_frame_bytes_max(&made->def);
	made->bytes = malloc(made->capacity);
	made->byte_count = 0;
}

void chain_finish(chain *made)
{
	tissue_finish(&made->tissue);
	free(made->encoder);
	free(made->decoder);
	free(made->bytes);
}

void chain_encode(chain *of)
{
	cau_stream_sample sample = tissue_sample(&of->tissue);
	assert_int_equal(
		cau_frame_encode(of->encoder, &sample, of->bytes, of->capacity, &of->byte_count, NULL),
		CAU_OK);
}

void chain_pass(chain *of)
{
	chain_encode(of);
	cau_error error = {0};
	if (cau_frame_decode(of->decoder, of->bytes, of->byte_count, &error))
		fail_msg("%s: %s", error.path, error.reason);
}

static void assert_tools_equal(const cau_stream_tool *a, const cau_stream_tool *b)
{
	assert_string_equal(a->name, b->name);
	assert_int_equal(a->shape, b->shape);
	assert_true(a->sequence == b->sequence && a->driver == b->driver);
	assert_true(a->energized == b->energized && a->grasping == b->grasping &&
	            a->frozen == b->frozen);
	assert_true(a->behind == b->behind);
	assert_int_equal(a->energy_off, b->energy_off);
	assert_int_equal(a->contact_vertices, b->contact_vertices);
	for (int i = 0; i < 3; i++) {
		assert_true((float)a->pose.position_m[i] == (float)b->pose.position_m[i]);
		assert_true((float)(b->behind ? b->asked_pose : b->pose).position_m[i] ==
		            (float)a->asked_pose.position_m[i]);
		assert_true((float)a->force_n[i] == (float)b->force_n[i]);
		assert_true((float)a->torque_nm[i] == (float)b->torque_nm[i]);
		assert_true((float)a->raw_force_n[i] == (float)b->raw_force_n[i]);
		assert_true((float)a->raw_torque_nm[i] == (float)b->raw_torque_nm[i]);
	}
	assert_true(a->has_raw_force == b->has_raw_force);
	assert_true((float)a->force_filter_s == (float)b->force_filter_s);
	assert_true((float)a->jaw == (float)b->jaw && (float)a->asked_jaw == (float)b->asked_jaw);
	assert_true((float)a->jaw_force_n == (float)b->jaw_force_n);
	assert_true((float)a->delivered_w == (float)b->delivered_w);
	assert_true((float)a->load_ohm == (float)b->load_ohm);
	assert_true((float)a->tip_temperature_c == (float)b->tip_temperature_c);
}

static void assert_vessels_equal(const cau_vessel_state *a, const cau_vessel_state *b)
{
	assert_string_equal(a->name, b->name);
	assert_int_equal(a->flags, b->flags);
	assert_true((float)a->radius_m == (float)b->radius_m);
	assert_true((float)a->bleeding_m3_s == (float)b->bleeding_m3_s);
	assert_true((float)a->shed_m3 == (float)b->shed_m3 && (float)a->burst_pa == (float)b->burst_pa);
	assert_int_equal(a->point_count, b->point_count);
	assert_memory_equal(a->point, b->point, (size_t)a->point_count * sizeof *a->point);
}

static void assert_contacts_equal(const cau_tool_contact *a, const cau_tool_contact *b)
{
	assert_string_equal(a->name, b->name);
	assert_true(a->valid == b->valid && a->time_s == b->time_s);
	assert_memory_equal(&a->asked_pose, &b->asked_pose, sizeof a->asked_pose);
	assert_memory_equal(&a->pose, &b->pose, sizeof a->pose);
	assert_memory_equal(a->force_n, b->force_n, sizeof a->force_n);
	assert_memory_equal(a->compliance_m_n, b->compliance_m_n, sizeof a->compliance_m_n);
	assert_true(a->friction == b->friction && a->damping_ns_m == b->damping_ns_m);
	assert_true(a->grasp_n_m == b->grasp_n_m);
	assert_memory_equal(a->grasp_anchor_m, b->grasp_anchor_m, sizeof a->grasp_anchor_m);
	assert_int_equal(a->plane_count, b->plane_count);
	assert_memory_equal(a->plane, b->plane, (size_t)a->plane_count * sizeof *a->plane);
}

// Checks scalars to half a step plus the rounding of single precision.
static void assert_scalars_rounded(const cau_frame_decoder *decoder, const tissue *shown, int32_t v)
{
	const cau_stream_state *state = cau_frame_decoder_state(decoder);
	for (int i = 0; i < CAU_CHANNEL_COUNT; i++) {
		cau_channel_index channel = (cau_channel_index)i;
		const cau_channel_info *info = cau_channel_describe(channel);
		if (info->scalar < 0)
			continue;
		double step = cau_channel_step(cau_frame_decoder_def(decoder), channel);
		double told = info->least + step * state->scalar[info->scalar][v];
		assert_true(fabs(told - (double)shown->scalar[info->scalar][v]) <= 0.5001 * step);
	}
}

void chain_assert_holds(const cau_frame_decoder *decoder, const tissue *shown)
{
	const cau_stream_state *state = cau_frame_decoder_state(decoder);
	cau_stream_sample sample = tissue_sample(shown);
	double *position = malloc(sizeof(double) * 3 * (size_t)shown->vertex_count);
	cau_frame_decoder_position(decoder, position);
	assert_true(state->synced && state->tick == sample.tick && state->time_s == sample.time_s);
	for (int32_t v = 0; v < shown->vertex_count; v++) {
		if (!shown->visible[v])
			continue;
		for (int i = 0; i < 3; i++)
			assert_true(fabs(position[3 * v + i] - shown->position[3 * v + i]) <= round_off_m);
		assert_scalars_rounded(decoder, shown, v);
	}
	assert_memory_equal(state->face_mask, shown->mask, 4 * (size_t)((shown->face_count + 31) / 32));
	assert_int_equal(state->tool_count, sample.tool_count);
	for (int32_t i = 0; i < sample.tool_count; i++)
		assert_tools_equal(&state->tools[i], &sample.tools[i]);
	assert_memory_equal(&state->statistics, &shown->statistics, sizeof state->statistics);
	assert_int_equal(state->vessel_count, sample.vessel_count);
	for (int32_t i = 0; i < sample.vessel_count; i++)
		assert_vessels_equal(&state->vessels[i], sample.vessels[i]);
	assert_int_equal(state->contact_count, sample.contact_count);
	for (int32_t i = 0; i < sample.contact_count; i++)
		assert_contacts_equal(&state->contacts[i], &sample.contacts[i]);
	free(position);
}

void chain_assert_same(const cau_frame_decoder *a, const cau_frame_decoder *b)
{
	const cau_stream_state *x = cau_frame_decoder_state(a), *y = cau_frame_decoder_state(b);
	const cau_stream_def *def = cau_frame_decoder_def(a);
	size_t vertices = (size_t)def->vertex_count;
	assert_true(x->epoch == y->epoch && x->sequence == y->sequence && x->tick == y->tick);
	assert_memory_equal(x->quantised, y->quantised, 12 * vertices);
	assert_memory_equal(x->face_mask, y->face_mask, 4 * (size_t)((def->face_count + 31) / 32));
	for (int scalar = 0; scalar < CAU_SCALAR_COUNT; scalar++)
		assert_memory_equal(x->scalar[scalar], y->scalar[scalar], 4 * vertices);
	assert_int_equal(x->tool_count, y->tool_count);
	for (int32_t i = 0; i < x->tool_count; i++)
		assert_tools_equal(&x->tools[i], &y->tools[i]);
	assert_int_equal(x->vessel_count, y->vessel_count);
	for (int32_t i = 0; i < x->vessel_count; i++)
		assert_vessels_equal(&x->vessels[i], &y->vessels[i]);
	assert_int_equal(x->contact_count, y->contact_count);
	for (int32_t i = 0; i < x->contact_count; i++)
		assert_contacts_equal(&x->contacts[i], &y->contacts[i]);
}
