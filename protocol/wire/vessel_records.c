// SPDX-License-Identifier: Apache-2.0
// Writes and reads the section of the channel `vessels` in frames. README.md in protocol/ has the
// layout.
#include "wire/records.h"

#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "cautery/name.h"
#include "wire/bytes.h"

// Sizes of a vessel without its name and points, and of one of its points.
enum { VESSEL_BYTES = 20, POINT_BYTES = 16 };
_Static_assert(4 + CAU_MAX_VESSELS * (VESSEL_BYTES + CAU_NAME_BYTES + 3 +
                                      CAU_VESSEL_SHOWN_POINTS * POINT_BYTES) <=
                   VESSELS_BYTES_MAX,
               "the section of all vessels");

const char *cau_vessel_state_check(const cau_vessel_state *vessel)
{
	if (!cau_name_is_valid(vessel->name))
		return "the name of the vessel breaks the rule for names";
	_Static_assert(CAU_VESSEL_SHOWN_POINTS == 64, "the message below names the limit");
	if (vessel->point_count < 0 || vessel->point_count > CAU_VESSEL_SHOWN_POINTS)
		return "the count of the vessel's points is not within 0 to 64";
	const double scalars[] = {vessel->radius_m, vessel->bleeding_m3_s, vessel->shed_m3,
	                          vessel->burst_pa};
	for (size_t i = 0; i < sizeof scalars / sizeof *scalars; i++)
		if (!isfinite((float)scalars[i]) || scalars[i] < 0)
			return "a number of the vessel is not finite, or below 0";
	for (int32_t i = 0; i < vessel->point_count; i++) {
		const cau_vessel_point *point = &vessel->point[i];
		if (!isfinite(point->position_m[0]) || !isfinite(point->position_m[1]) ||
		    !isfinite(point->position_m[2]) || !isfinite(point->open))
			return "a point of the vessel is not finite";
	}
	return vessel->flags & ~(uint32_t)CAU_VESSEL_FLAGS ? "a vessel has an unknown flag" : NULL;
}

static uint8_t *write_vessel(uint8_t *at, const cau_vessel_state *vessel)
{
	const double scalars[] = {vessel->radius_m, vessel->bleeding_m3_s, vessel->shed_m3,
	                          vessel->burst_pa};
	size_t length = strlen(vessel->name), padded = round_up_4(length);
	CAU_RULE(!cau_vessel_state_check(vessel), "vessel \"%s\" cannot be sent", vessel->name);
	at[0] = (uint8_t)length;
	at[1] = (uint8_t)vessel->flags;
	store_u16(at + 2, (uint16_t)vessel->point_count);
	at += 4;
	for (size_t i = 0; i < sizeof scalars / sizeof *scalars; i++, at += 4)
		store_f32(at, (float)scalars[i]);
	memset(at, 0, padded);
	memcpy(at, vessel->name, length);
	at += padded;
	for (int32_t i = 0; i < vessel->point_count; i++, at += POINT_BYTES) {
		for (int axis = 0; axis < 3; axis++)
			store_f32(at + (ptrdiff_t)4 * axis, vessel->point[i].position_m[axis]);
		store_f32(at + 12, vessel->point[i].open);
	}
	return at;
}

size_t cau_vessels_write(uint8_t *out, const cau_vessel_state *vessels, int32_t count)
{
	uint8_t *at = out + 4;
	CAU_RULE(count >= 0 && count <= CAU_MAX_VESSELS, "%d vessels", count);
	store_u32(out, (uint32_t)count);
	for (int32_t i = 0; i < count; i++)
		at = write_vessel(at, &vessels[i]);
	return (size_t)(at - out);
}

// Reads a vessel. Returns the position after it, or NULL if it is damaged.
static const uint8_t *read_vessel(const uint8_t *at, const uint8_t *end, cau_vessel_state *vessel)
{
	if (end - at < VESSEL_BYTES)
		return NULL;
	size_t length = at[0], padded = round_up_4(length), points = load_u16(at + 2);
	if (length >= CAU_NAME_BYTES || points > CAU_VESSEL_SHOWN_POINTS ||
	    (size_t)(end - at) < VESSEL_BYTES + padded + points * POINT_BYTES)
		return NULL;
	*vessel = (cau_vessel_state){.flags = at[1],
	                             .radius_m = (double)load_f32(at + 4),
	                             .bleeding_m3_s = (double)load_f32(at + 8),
	                             .shed_m3 = (double)load_f32(at + 12),
	                             .burst_pa = (double)load_f32(at + 16),
	                             .point_count = (int32_t)points};
	memcpy(vessel->name, at + VESSEL_BYTES, length);
	at += VESSEL_BYTES + padded;
	for (size_t i = 0; i < points; i++, at += POINT_BYTES) {
		for (int axis = 0; axis < 3; axis++)
			vessel->point[i].position_m[axis] = load_f32(at + (ptrdiff_t)4 * axis);
		vessel->point[i].open = load_f32(at + 12);
	}
	return cau_vessel_state_check(vessel) ? NULL : at;
}

const char *cau_vessels_read(const uint8_t *payload, size_t bytes, cau_vessel_state *vessels,
                             int32_t *count)
{
	const uint8_t *at = payload + 4, *end = payload + bytes;
	uint32_t announced = bytes >= 4 ? load_u32(payload) : UINT32_MAX;
	_Static_assert(CAU_MAX_VESSELS == 8, "the message below names the limit");
	if (bytes < 4)
		return "the list of vessels is shorter than its count of 4 bytes";
	if (announced > CAU_MAX_VESSELS)
		return "the list announces more than 8 vessels";
	for (uint32_t i = 0; i < announced && at; i++)
		at = read_vessel(at, end, &vessels[i]);
	*count = at ? (int32_t)announced : 0;
	if (!at)
		return "a vessel in the list is damaged";
	return at == end ? NULL : "the list of vessels has bytes after its last vessel";
}
