// SPDX-License-Identifier: Apache-2.0
#include "cautery/fleet_json.h"
#include "json/value.h"

static bool is_there(const cau_fleet *fleet, const char *label)
{
	for (int32_t i = 0; i < fleet->count; i++)
		if (strcmp(fleet->labels[i], label) == 0)
			return true;
	return false;
}

static void read_label(cau_reader *reader, const cJSON *value, cau_fleet *fleet)
{
	char *label = fleet->labels[fleet->count];
	size_t mark = cau_reader_enter(reader, NULL, fleet->count);
	cau_read_name(reader, value, label);
	if (!reader->status && strchr(label, '-'))
		cau_reader_fail(reader, CAU_BAD_VALUE, NULL,
		                "a label must not contain \"-\", as \"%s\" does", label);
	if (!reader->status && is_there(fleet, label))
		cau_reader_fail(reader, CAU_BAD_VALUE, NULL, "\"%s\" is in the list twice", label);
	cau_reader_leave(reader, mark);
}

static void read_labels(cau_reader *reader, const cJSON *labels, cau_fleet *fleet)
{
	const cJSON *label = NULL;
	size_t mark = cau_reader_enter(reader, "labels", 0);
	if (cau_read_array(reader, labels, 0, CAU_FLEET_LABELS_MAX))
		cJSON_ArrayForEach(label, labels)
		{
			read_label(reader, label, fleet);
			if (reader->status)
				break;
			fleet->count++;
		}
	cau_reader_leave(reader, mark);
}

cau_status cau_fleet_from_json(const char *text, size_t bytes, cau_fleet *fleet, cau_error *error)
{
	cJSON *document = NULL;
	cau_reader reader;
	fleet->count = 0;
	cau_status status = cau_value_parse(text, bytes, CAU_FLEET_JSON_MAX_BYTES, &document, error);
	if (status)
		return status;
	cau_reader_begin(&reader, NULL, error);
	if (cau_read_object(&reader, document))
		read_labels(&reader, cau_value_member(document, "labels"), fleet);
	cJSON_Delete(document);
	if (reader.status)
		fleet->count = 0;
	return reader.status;
}
