// SPDX-License-Identifier: GPL-3.0-or-later
// Which past ticks of a branch can be reached.
#include <string.h>

#include "retention.h"
#include "store_state.h"

// Reads the branch's course on the connection `reading`.
static cau_status read_course(cau_store *store, const char *session, int64_t branch,
                              struct cau_store_course *course, cau_error *error)
{
	struct cau_store_reader *reader = &store->reading;
	int64_t key;
	pthread_mutex_lock(&reader->mutex);
	cau_status status = cau_store_find_session(reader, session, &key, error);
	if (!status)
		status = cau_store_course_read(reader->database, key, branch, course, error);
	pthread_mutex_unlock(&reader->mutex);
	return status;
}

// Writes the ranges as text, such as "0 to 300, 450, 900 on": all, or as many as fit.
static void list_ranges(const struct cau_store_course *course, char *text, size_t capacity)
{
	struct cau_store_range range;
	size_t used = 0;
	const char *comma = "";
	for (int64_t after = -1; cau_store_course_range(course, after, &range);
	     after = range.to_tick, comma = ", ") {
		char one[64];
		int length;
		if (range.to_tick == INT64_MAX)
			length = snprintf(one, sizeof one, "%s%lld on", comma, (long long)range.from_tick);
		else if (range.to_tick == range.from_tick)
			length = snprintf(one, sizeof one, "%s%lld", comma, (long long)range.from_tick);
		else
			length = snprintf(one, sizeof one, "%s%lld to %lld", comma, (long long)range.from_tick,
			                  (long long)range.to_tick);
		if (used + (size_t)length + sizeof ", ..." > capacity) {
			memcpy(text + used, ", ...", sizeof ", ...");
			return;
		}
		memcpy(text + used, one, (size_t)length + 1);
		used += (size_t)length;
		if (range.to_tick == INT64_MAX)
			return;
	}
}

cau_status cau_store_check_reach(cau_store *store, const char *session, int64_t branch,
                                 uint64_t tick, cau_error *error)
{
	struct cau_store_course course = {0};
	struct cau_store_range range;
	char reached[200] = "none";
	cau_status status = read_course(store, session, branch, &course, error);
	if (!status) {
		int64_t wanted = tick < INT64_MAX ? (int64_t)tick : INT64_MAX;
		bool found = cau_store_course_range(&course, wanted - 1, &range);
		if (!found || range.from_tick > wanted) {
			list_ranges(&course, reached, sizeof reached);
			status = cau_fail(error, CAU_BAD_VALUE, "params.tick",
			                  "tick %lld cannot be reached any more; ticks that can be reached: %s",
			                  (long long)wanted, reached);
		}
	}
	cau_store_course_finish(&course);
	return status;
}

cau_status cau_store_read_oldest_tick(cau_store *store, const char *session, int64_t branch,
                                      uint64_t *tick, cau_error *error)
{
	struct cau_store_course course = {0};
	struct cau_store_range range;
	cau_status status = read_course(store, session, branch, &course, error);
	if (!status && !cau_store_course_range(&course, INT64_MAX - 1, &range))
		status = cau_fail(error, CAU_NOT_FOUND, "branch", "no checkpoint on branch %lld",
		                  (long long)branch);
	if (!status)
		*tick = (uint64_t)range.from_tick;
	cau_store_course_finish(&course);
	return status;
}
