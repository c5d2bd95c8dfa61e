// SPDX-License-Identifier: GPL-3.0-or-later
#include "tissue/regions.h"

#include <stdlib.h>
#include <string.h>

#include "cautery/assert.h"

static int compare(const void *left, const void *right)
{
	int32_t a = *(const int32_t *)left, b = *(const int32_t *)right;
	return (a > b) - (a < b);
}

cau_status cau_region_list_make(cau_region_list *list, const int32_t *region, int32_t count,
                                cau_arena *arena, cau_error *error)
{
	CAU_ASSERT(count >= 0, "%d elements", count);
	int32_t *sorted = malloc(((size_t)count + 1) * sizeof *sorted);
	if (!sorted)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the regions");
	int32_t kept = 0;
	for (int32_t i = 0; i < count; i++) // many consecutive elements have the same region
		if (!kept || sorted[kept - 1] != region[i])
			sorted[kept++] = region[i];
	qsort(sorted, (size_t)kept, sizeof *sorted, compare);
	int32_t distinct = 0;
	for (int32_t i = 0; i < kept; i++)
		if (!distinct || sorted[distinct - 1] != sorted[i])
			sorted[distinct++] = sorted[i];
	list->count = distinct;
	list->region = cau_arena_copy(arena, sorted, (size_t)distinct, sizeof *sorted);
	free(sorted);
	return list->region ? CAU_OK
	                    : cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the regions");
}

cau_status cau_region_list_check(const cau_region_list *list, const char *layer, int32_t region,
                                 const char *path, cau_error *error)
{
	if (list->count && bsearch(&region, list->region, (size_t)list->count, sizeof region, compare))
		return CAU_OK;
	char names[160] = "none";
	size_t length = 0;
	for (int32_t i = 0; i < list->count && length < sizeof names - 24; i++)
		length += (size_t)snprintf(names + length, sizeof names - length, "%s%d", i ? ", " : "",
		                           list->region[i]);
	if (list->count && length >= sizeof names - 24)
		snprintf(names + length, sizeof names - length, ", ...");
	return cau_fail(error, CAU_NOT_FOUND, path,
	                "the mesh of layer \"%.48s\" has no region %d; its regions are: %s", layer,
	                region, names);
}
