// SPDX-License-Identifier: GPL-3.0-or-later
// The answer to session.advance, with the memory for its lists.
#include <stdlib.h>
#include <string.h>

#include "hosted_session/internal.h"
#include "hosted_session/slice.h"

typedef struct observation {
	cau_frame frame;
	const cau_advance *wanted;
	int32_t vertex_count; // vertices in positions and scalars
	cau_wire_advanced result;
	cau_wire_observed_scalar scalars[CAU_SCALAR_COUNT];
	cau_wire_observed_tool tools[CAU_MAX_TOOLS];
	cau_wire_observed_vessel vessels[CAU_MAX_VESSELS];
	cau_wire_region_damage regions[CAU_ADVANCE_REGIONS];
} observation;

static int scalar_count(uint32_t channels)
{
	int count = 0;
	for (int scalar = 0; scalar < CAU_SCALAR_COUNT; scalar++)
		count += (channels & cau_scalar_channel((cau_scalar)scalar)) != 0;
	return count;
}

cau_status cau_advance_check(const cau_session_info *info, const cau_advance *advance,
                             cau_error *error)
{
	int64_t vertices = advance->chosen ? advance->vertex_count : info->vertex_count;
	int64_t each = scalar_count(advance->channels);
	each += advance->channels & CAU_CHANNEL_POSITIONS ? 3 : 0;
	for (int32_t i = 0; i < advance->vertex_count; i++)
		if (advance->vertices[i] >= info->vertex_count) {
			cau_fail(error, CAU_BAD_VALUE, "", "not a vertex of the session, which has %d vertices",
			         info->vertex_count);
			snprintf(error->path, sizeof error->path, "params.observe.vertices[%d]", i);
			return CAU_BAD_VALUE;
		}
	if (vertices * each > CAU_ADVANCE_NUMBERS)
		return cau_fail(error, CAU_LIMIT, "params.observe",
		                "%lld numbers, at most %d are sent in an answer: choose vertices, or call "
		                "session.join, whose frames hold all of them",
		                (long long)(vertices * each), CAU_ADVANCE_NUMBERS);
	return CAU_OK;
}

// Returns the vertex at this index of the answer.
static int32_t vertex_at(const observation *o, int32_t place)
{
	return o->wanted->chosen ? o->wanted->vertices[place] : place;
}

static double *numbers(cau_wire_list *list, int32_t count)
{
	*list = (cau_wire_list){malloc(8 * (size_t)count + 1), count, count};
	return list->items;
}

static bool observe_positions(observation *o)
{
	if (!(o->wanted->channels & CAU_CHANNEL_POSITIONS))
		return true;
	double *to = numbers(&o->result.positions_m, 3 * o->vertex_count);
	for (int32_t i = 0; i < o->vertex_count && to; i++)
		memcpy(to + 3 * (size_t)i, o->frame.position + 3 * (size_t)vertex_at(o, i), 3 * sizeof *to);
	o->result.has_positions_m = true;
	return to != NULL;
}

static bool observe_scalar(observation *o, int scalar)
{
	cau_wire_observed_scalar *made = &o->scalars[o->result.scalars.count++];
	uint32_t bit = cau_scalar_channel((cau_scalar)scalar);
	while (bit >> made->channel != 1)
		made->channel++;
	double *to = numbers(&made->values, o->vertex_count);
	for (int32_t i = 0; i < o->vertex_count && to; i++)
		to[i] = (double)o->frame.scalar[scalar][vertex_at(o, i)];
	return to != NULL;
}

static bool observe_scalars(observation *o)
{
	o->result.scalars = (cau_wire_list){o->scalars, 0, CAU_SCALAR_COUNT};
	for (int scalar = 0; scalar < CAU_SCALAR_COUNT; scalar++) {
		bool wanted = o->wanted->channels & cau_scalar_channel((cau_scalar)scalar);
		if (wanted && !observe_scalar(o, scalar))
			return false;
	}
	o->result.has_scalars = o->result.scalars.count > 0;
	return true;
}

static bool observe_mask(observation *o, int32_t face_count)
{
	int32_t count = (face_count + 31) / 32;
	if (!(o->wanted->channels & CAU_CHANNEL_MASK))
		return true;
	int64_t *to = (int64_t *)(void *)numbers(&o->result.mask, count);
	for (int32_t i = 0; i < count && to; i++)
		to[i] = o->frame.face_mask[i];
	o->result.has_mask = true;
	return to != NULL;
}

static void observe_tool(cau_hosted_decisions *decisions, const cau_tool_state *from,
                         cau_wire_observed_tool *to)
{
	cau_drive drive = {.energy_off = CAU_ENERGY_OFF_NEVER_ENABLED};
	cau_decisions_find(decisions, from->name, &drive);
	*to = (cau_wire_observed_tool){.jaw = from->jaw,
	                               .energized = from->energized,
	                               .has_energy_off = !from->energized,
	                               .energy_off = drive.energy_off,
	                               .tip_temperature_c = from->tip_temperature_c,
	                               .energy_j = from->energy_j,
	                               .power_w = from->delivered_w,
	                               .load_ohm = from->load_ohm,
	                               .contact_vertices = from->contact_vertices,
	                               .grasped_vertices = from->grasped_vertices,
	                               .sequence = (int64_t)from->sequence};
	memcpy(to->tool, from->name, sizeof to->tool);
	memcpy(to->position_m, from->pose.position_m, sizeof to->position_m);
	memcpy(to->rotation, from->pose.rotation, sizeof to->rotation);
	memcpy(to->force_n, from->force_n, sizeof to->force_n);
	memcpy(to->torque_nm, from->torque_nm, sizeof to->torque_nm);
	memcpy(to->raw_force_n, from->raw_force_n, sizeof to->raw_force_n);
	memcpy(to->raw_torque_nm, from->raw_torque_nm, sizeof to->raw_torque_nm);
}

static void observe_tools(cau_hosted_decisions *decisions, observation *o)
{
	o->result.has_tools = o->wanted->channels & CAU_CHANNEL_TOOLS;
	o->result.tools = (cau_wire_list){o->tools, o->frame.tool_count, CAU_MAX_TOOLS};
	for (int32_t i = 0; o->result.has_tools && i < o->frame.tool_count; i++)
		observe_tool(decisions, &o->frame.tools[i], &o->tools[i]);
}

static void observe_vessels(observation *o)
{
	o->result.has_vessels = o->wanted->channels & CAU_CHANNEL_VESSELS;
	o->result.vessels = (cau_wire_list){o->vessels, o->frame.vessel_count, CAU_MAX_VESSELS};
	for (int32_t i = 0; o->result.has_vessels && i < o->frame.vessel_count; i++) {
		const cau_vessel_state *from = o->frame.vessels[i];
		o->vessels[i] =
			(cau_wire_observed_vessel){.parted = (from->flags & CAU_VESSEL_CUT) != 0,
		                               .pierced = (from->flags & CAU_VESSEL_PIERCED) != 0,
		                               .shut = (from->flags & CAU_VESSEL_SHUT) != 0,
		                               .sealed = (from->flags & CAU_VESSEL_SEALED) != 0,
		                               .bleeds = (from->flags & CAU_VESSEL_BLEEDS) != 0,
		                               .bleeding_m3_s = from->bleeding_m3_s,
		                               .shed_m3 = from->shed_m3,
		                               .burst_pa = from->burst_pa};
		memcpy(o->vessels[i].vessel, from->name, sizeof o->vessels[i].vessel);
	}
}

static cau_wire_observed_damage wire_damage(const cau_damage *from)
{
	return (cau_wire_observed_damage){.removed_count = from->removed_count,
	                                  .removed_m3 = from->removed_m3,
	                                  .damaged_m3 = from->damaged_m3};
}

static void observe_regions(const cau_session *core, observation *o)
{
	o->result.has_regions = o->wanted->region_count > 0;
	o->result.regions = (cau_wire_list){o->regions, o->wanted->region_count, CAU_ADVANCE_REGIONS};
	for (int32_t i = 0; i < o->wanted->region_count; i++) {
		const cau_advance_region *region = &o->wanted->regions[i];
		cau_damage inside, outside;
		cau_session_damage(core, &region->where, &inside, &outside);
		memcpy(o->regions[i].name, region->name, sizeof o->regions[i].name);
		o->regions[i].inside = wire_damage(&inside);
		o->regions[i].outside = wire_damage(&outside);
	}
}

static void observe_energy(const cau_session *core, observation *o)
{
	cau_energy_ledger ledger;
	o->result.has_energy = o->wanted->energy;
	if (!o->wanted->energy)
		return;
	cau_session_read_ledger(core, &ledger);
	o->result.energy = (cau_wire_observed_energy){.delivered_j = ledger.delivered_j,
	                                              .blade_j = ledger.blade_j,
	                                              .far_j = ledger.far_j,
	                                              .stored_j = ledger.stored_j,
	                                              .boiled_j = ledger.boiled_j,
	                                              .perfused_j = ledger.perfused_j,
	                                              .ambient_j = ledger.ambient_j,
	                                              .shed_j = ledger.shed_j,
	                                              .coagulated_m3 = cau_session_coagulated(core),
	                                              .vapour_kg_s = cau_session_vapour(core)};
}

// Fills the answer. The core computes the costly channels that this answer or a stream needs.
static bool observe(cau_hosted *h, observation *o)
{
	cau_session_watch(h->core.session,
	                  cau_streams_watched(&h->frames.streams) | o->wanted->channels);
	cau_session_frame(h->core.session, &o->frame);
	observe_tools(&h->decisions, o);
	observe_vessels(o);
	observe_regions(h->core.session, o);
	observe_energy(h->core.session, o);
	return observe_positions(o) && observe_scalars(o) && observe_mask(o, h->core.info.face_count);
}

static void finish(observation *o)
{
	free(o->result.positions_m.items);
	free(o->result.mask.items);
	for (int32_t i = 0; i < o->result.scalars.count; i++)
		free(o->scalars[i].values.items);
	free(o);
}

char *cau_advance_text(cau_hosted *h, const cau_order *order, size_t *bytes, cau_error *error)
{
	char *text = NULL;
	observation *o = calloc(1, sizeof *o);
	if (o) {
		o->wanted = order->as.advance;
		o->vertex_count = o->wanted->chosen ? o->wanted->vertex_count : h->core.info.vertex_count;
		o->result.tick = (int64_t)h->core.tick;
		o->result.time_s = (double)h->core.tick * h->core.info.step_s;
		o->result.ticks = (int64_t)(h->core.tick - o->wanted->began_tick);
		o->result.stored = !h->identity.around->ephemeral;
		if (observe(h, o))
			text = cau_answer_text(order->reply.method, &o->result, bytes, error);
		else
			cau_fail(error, CAU_NO_MEMORY, "", "no memory for the answer");
		finish(o);
	} else {
		cau_fail(error, CAU_NO_MEMORY, "", "no memory for the answer");
	}
	return text;
}
