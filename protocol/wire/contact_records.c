// SPDX-License-Identifier: Apache-2.0
// Writes and reads the section of the channel `tool_contact` in frames. README.md in protocol/ has
// the layout.
#include "wire/records.h"

#include <math.h>
#include <string.h>

#include "cautery/assert.h"
#include "cautery/name.h"
#include "wire/bytes.h"

// Sizes of a record without its name and planes (RECORD_BYTES), and of a plane (PLANE_BYTES).
// Numbers are floats.
enum {
	HEAD_BYTES = 4,
	NUMBERS = 29,
	PLANE_NUMBERS = 5,
	RECORD_BYTES = HEAD_BYTES + 4 * NUMBERS,
	PLANE_BYTES = 4 * PLANE_NUMBERS,
	VALID = 1, // flag of a valid contact
};
_Static_assert(4 + CAU_MAX_TOOLS *
                           (RECORD_BYTES + CAU_NAME_BYTES + 3 + CAU_CONTACT_PLANES * PLANE_BYTES) <=
                   CONTACTS_BYTES_MAX,
               "the section of all tools");

// Lists the numbers of a record in the order of the payload.
static void list(const cau_tool_contact *contact, double numbers[NUMBERS])
{
	double *at = numbers;
	const cau_pose *poses[] = {&contact->asked_pose, &contact->pose};
	for (int i = 0; i < 2; i++, at += 7) {
		memcpy(at, poses[i]->position_m, sizeof poses[i]->position_m);
		memcpy(at + 3, poses[i]->rotation, sizeof poses[i]->rotation);
	}
	memcpy(at, contact->force_n, sizeof contact->force_n);
	memcpy(at + 3, contact->compliance_m_n, sizeof contact->compliance_m_n);
	at[9] = contact->friction;
	at[10] = contact->damping_ns_m;
	at[11] = contact->grasp_n_m;
	memcpy(at + 12, contact->grasp_anchor_m, sizeof contact->grasp_anchor_m);
}

static void take(cau_tool_contact *contact, const double numbers[NUMBERS])
{
	const double *at = numbers;
	cau_pose *poses[] = {&contact->asked_pose, &contact->pose};
	for (int i = 0; i < 2; i++, at += 7) {
		memcpy(poses[i]->position_m, at, sizeof poses[i]->position_m);
		memcpy(poses[i]->rotation, at + 3, sizeof poses[i]->rotation);
	}
	memcpy(contact->force_n, at, sizeof contact->force_n);
	memcpy(contact->compliance_m_n, at + 3, sizeof contact->compliance_m_n);
	contact->friction = at[9];
	contact->damping_ns_m = at[10];
	contact->grasp_n_m = at[11];
	memcpy(contact->grasp_anchor_m, at + 12, sizeof contact->grasp_anchor_m);
}

static void list_plane(const cau_contact_plane *plane, double numbers[PLANE_NUMBERS])
{
	memcpy(numbers, plane->normal, sizeof plane->normal);
	numbers[3] = plane->offset_m;
	numbers[4] = plane->velocity_m_s;
}

static bool are_finite(const double *numbers, int count)
{
	for (int i = 0; i < count; i++)
		if (!isfinite((float)numbers[i]))
			return false;
	return true;
}

const char *cau_tool_contact_check(const cau_tool_contact *contact)
{
	double numbers[NUMBERS];
	_Static_assert(CAU_CONTACT_PLANES == 8, "a message below names the limit");
	if (!cau_name_is_valid(contact->name))
		return "the name of the tool breaks the rule for names";
	if (contact->plane_count < 0 || contact->plane_count > CAU_CONTACT_PLANES)
		return "the count of planes is not within 0 to 8";
	list(contact, numbers);
	if (!are_finite(numbers, NUMBERS))
		return "a number of the contact is not finite";
	if (contact->friction < 0 || contact->damping_ns_m < 0 || contact->grasp_n_m < 0)
		return "friction, damping or the grasp's stiffness is below 0";
	for (int32_t i = 0; i < contact->plane_count; i++) {
		list_plane(&contact->plane[i], numbers);
		if (!are_finite(numbers, PLANE_NUMBERS))
			return "a plane of the contact is not finite";
	}
	return NULL;
}

static uint8_t *write_floats(uint8_t *at, const double *numbers, int count)
{
	for (int i = 0; i < count; i++, at += 4)
		store_f32(at, (float)numbers[i]);
	return at;
}

static uint8_t *write_contact(uint8_t *at, const cau_tool_contact *contact)
{
	size_t length = strlen(contact->name), padded = round_up_4(length);
	double numbers[NUMBERS];
	CAU_RULE(!cau_tool_contact_check(contact), "the contact of \"%s\" cannot be sent",
	         contact->name);
	at[0] = (uint8_t)length;
	at[1] = contact->valid ? VALID : 0;
	store_u16(at + 2, (uint16_t)contact->plane_count);
	list(contact, numbers);
	at = write_floats(at + HEAD_BYTES, numbers, NUMBERS);
	memset(at, 0, padded);
	memcpy(at, contact->name, length);
	at += padded;
	for (int32_t i = 0; i < contact->plane_count; i++) {
		list_plane(&contact->plane[i], numbers);
		at = write_floats(at, numbers, PLANE_NUMBERS);
	}
	return at;
}

size_t cau_contacts_write(uint8_t *out, const cau_tool_contact *contacts, int32_t count)
{
	uint8_t *at = out + 4;
	CAU_RULE(count >= 0 && count <= CAU_MAX_TOOLS, "contacts of %d tools", count);
	store_u32(out, (uint32_t)count);
	for (int32_t i = 0; i < count; i++)
		at = write_contact(at, &contacts[i]);
	return (size_t)(at - out);
}

static const uint8_t *read_floats(const uint8_t *at, double *numbers, int count)
{
	for (int i = 0; i < count; i++, at += 4)
		numbers[i] = (double)load_f32(at);
	return at;
}

// Reads a record. Returns the position after it, or NULL if it is damaged.
static const uint8_t *read_contact(const uint8_t *at, const uint8_t *end, cau_tool_contact *contact)
{
	double numbers[NUMBERS];
	if (end - at < RECORD_BYTES)
		return NULL;
	size_t length = at[0], padded = round_up_4(length), planes = load_u16(at + 2);
	if (length >= CAU_NAME_BYTES || planes > CAU_CONTACT_PLANES || (at[1] & ~VALID) != 0 ||
	    (size_t)(end - at) < RECORD_BYTES + padded + planes * PLANE_BYTES)
		return NULL;
	*contact = (cau_tool_contact){.valid = at[1] == VALID, .plane_count = (int32_t)planes};
	at = read_floats(at + HEAD_BYTES, numbers, NUMBERS);
	take(contact, numbers);
	memcpy(contact->name, at, length);
	at += padded;
	for (size_t i = 0; i < planes; i++) {
		at = read_floats(at, numbers, PLANE_NUMBERS);
		memcpy(contact->plane[i].normal, numbers, sizeof contact->plane[i].normal);
		contact->plane[i].offset_m = numbers[3];
		contact->plane[i].velocity_m_s = numbers[4];
	}
	return cau_tool_contact_check(contact) ? NULL : at;
}

const char *cau_contacts_read(const uint8_t *payload, size_t bytes, cau_tool_contact *contacts,
                              int32_t *count)
{
	const uint8_t *at = payload + 4, *end = payload + bytes;
	uint32_t announced = bytes >= 4 ? load_u32(payload) : UINT32_MAX;
	_Static_assert(CAU_MAX_TOOLS == 8, "the message below names the limit");
	if (bytes < 4)
		return "the list of contacts is shorter than its count of 4 bytes";
	if (announced > CAU_MAX_TOOLS)
		return "the list announces contacts of more than 8 tools";
	for (uint32_t i = 0; i < announced && at; i++)
		at = read_contact(at, end, &contacts[i]);
	*count = at ? (int32_t)announced : 0;
	if (!at)
		return "a contact in the list is damaged";
	return at == end ? NULL : "the list of contacts has bytes after its last contact";
}
