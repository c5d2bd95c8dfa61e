// SPDX-License-Identifier: GPL-3.0-or-later
#include "retention.h"

#include <stdlib.h>

#include "cautery/assert.h"
#include "file.h"

enum {
	// divisor of an age: thinning may remove a checkpoint if its two neighbours are at most
	// age / AGE_SHARE ticks apart, where `age` is that of the later neighbour
	AGE_SHARE = 4,
	// number of newest checkpoints that always stay: if the last cannot be restored, the one before
	// can
	NEWEST_KEPT = 2,
};

// ---- reading --------------------------------------------------------------------------
// Returns the array with space for one more element of `size` bytes. The array is full at powers of
// two.
static void *grow(void *array, int count, size_t size)
{
	CAU_ASSERT(count >= 0 && size > 0, "%d elements of %zu bytes", count, size);
	bool full = (count & (count - 1)) == 0;
	return full ? realloc(array, (count ? 2 * (size_t)count : 1) * size) : array;
}

static bool add_point(struct cau_store_course *course, sqlite3_stmt *statement)
{
	void *grown = grow(course->point, course->point_count, sizeof *course->point);
	if (!grown)
		return false;
	course->point = grown;
	course->point[course->point_count++] = (struct cau_store_point){
		.branch = sqlite3_column_int64(statement, 0),
		.tick = sqlite3_column_int64(statement, 1),
		.bytes = sqlite3_column_int64(statement, 2),
		.marked = sqlite3_column_int(statement, 3) != 0,
	};
	return true;
}

static bool add_hole(struct cau_store_course *course, sqlite3_stmt *statement)
{
	void *grown = grow(course->hole, course->hole_count, sizeof *course->hole);
	if (!grown)
		return false;
	course->hole = grown;
	course->hole[course->hole_count++] = (struct cau_store_hole){
		.from_tick = sqlite3_column_int64(statement, 0),
		.before_tick = sqlite3_column_int64(statement, 1),
	};
	return true;
}

static cau_status collect(sqlite3 *database, const char *sql, int64_t session, int64_t branch,
                          bool (*add)(struct cau_store_course *, sqlite3_stmt *),
                          struct cau_store_course *course, cau_error *error)
{
	sqlite3_stmt *statement = NULL;
	cau_status status = CAU_OK;
	int code = sqlite3_prepare_v2(database, sql, -1, &statement, NULL);
	if (!code)
		code = sqlite3_bind_int64(statement, 1, session);
	if (!code)
		code = sqlite3_bind_int64(statement, 2, branch);
	while (!code && !status && (code = sqlite3_step(statement)) == SQLITE_ROW) {
		code = SQLITE_OK;
		if (!add(course, statement))
			status = cau_fail(error, CAU_NO_MEMORY, NULL, "reading a session's checkpoints");
	}
	if (!status && code != SQLITE_DONE)
		status = cau_store_fault(database, code, "reading checkpoints", error);
	sqlite3_finalize(statement);
	return status;
}

// Reads checkpoints first, then holes. A hole that opens in between is seen; at worst it hides a
// checkpoint.
cau_status cau_store_course_read(sqlite3 *database, int64_t session, int64_t branch,
                                 struct cau_store_course *course, cau_error *error)
{
	cau_status status =
		collect(database,
	            CAU_STORE_LINE "SELECT c.branch, c.tick, c.bytes,"
	                           " EXISTS(SELECT 1 FROM marks AS m WHERE m.session = ?1"
	                           "  AND m.branch = c.branch AND m.tick = c.tick)"
	                           " FROM line CROSS JOIN checkpoints AS c ON c.session = ?1"
	                           " AND c.branch = line.branch AND c.tick <= line.before_tick"
	                           " ORDER BY c.tick, line.depth DESC",
	            session, branch, add_point, course, error);
	if (status)
		return status;
	return collect(database,
	               CAU_STORE_LINE
	               "SELECT g.from_tick, min(g.before_tick, line.before_tick)"
	               " FROM line CROSS JOIN gaps AS g ON g.session = ?1 AND g.branch = line.branch"
	               " AND g.from_tick < line.before_tick ORDER BY 1",
	               session, branch, add_hole, course, error);
}

void cau_store_course_finish(struct cau_store_course *course)
{
	free(course->point);
	free(course->hole);
	*course = (struct cau_store_course){0};
}

// ---- reachable ticks ------------------------------------------------------------------
// Returns the last tick that a replay from a checkpoint at `tick` reaches: the start of the first
// hole that does not end by that tick.
static int64_t end_of_way(const struct cau_store_course *course, int64_t tick)
{
	CAU_ASSERT(tick >= 0, "the way from tick %lld", (long long)tick);
	for (int i = 0; i < course->hole_count; i++)
		if (course->hole[i].before_tick > tick)
			return course->hole[i].from_tick > tick ? course->hole[i].from_tick : tick;
	return INT64_MAX;
}

bool cau_store_course_range(const struct cau_store_course *course, int64_t after,
                            struct cau_store_range *range)
{
	for (int i = 0; i < course->point_count; i++) {
		int64_t tick = course->point[i].tick;
		*range = (struct cau_store_range){tick, end_of_way(course, tick)};
		if (range->to_tick > after)
			return true;
	}
	return false;
}

// ---- removable checkpoints ------------------------------------------------------------
// True if a hole ends at `tick`. Without the checkpoint there, ticks after the hole could not be
// reached.
static bool ends_a_hole(const struct cau_store_course *course, int64_t tick)
{
	for (int i = 0; i < course->hole_count; i++)
		if (course->hole[i].before_tick == tick)
			return true;
	return false;
}

static bool may_go(const struct cau_store_course *course, int index)
{
	CAU_ASSERT_INDEX(index, course->point_count);
	const struct cau_store_point *point = &course->point[index];
	return index > 0 && index < course->point_count - NEWEST_KEPT && !point->marked &&
	       !ends_a_hole(course, point->tick);
}

// Returns the number of ticks between the checkpoint's two neighbours. *age: the age of the later
// neighbour, in ticks before the newest checkpoint.
static int64_t span_around(const struct cau_store_course *course, int index, int64_t *age)
{
	CAU_ASSERT(index > 0 && index < course->point_count - 1,
	           "checkpoint %d of %d has no two neighbours", index, course->point_count);
	const struct cau_store_point *point = course->point;
	*age = point[course->point_count - 1].tick - point[index + 1].tick;
	CAU_ASSERT(*age >= 0, "checkpoint %d is %lld ticks old", index, (long long)*age);
	return point[index + 1].tick - point[index - 1].tick;
}

int cau_store_course_thin(const struct cau_store_course *course, int64_t spacing)
{
	CAU_ASSERT(spacing > 0, "a spacing of %lld ticks", (long long)spacing);
	for (int i = 1; i < course->point_count - NEWEST_KEPT; i++) {
		int64_t age, span = span_around(course, i, &age);
		int64_t most = age / AGE_SHARE > spacing ? age / AGE_SHARE : spacing;
		if (span <= most && may_go(course, i))
			return i;
	}
	return -1;
}

int cau_store_course_oldest(const struct cau_store_course *course)
{
	for (int i = 1; i < course->point_count - NEWEST_KEPT; i++)
		if (may_go(course, i))
			return i;
	return -1;
}

int cau_store_course_coarsen(const struct cau_store_course *course, int64_t spacing)
{
	CAU_ASSERT(spacing > 0, "a spacing of %lld ticks", (long long)spacing);
	int least = -1;
	double least_ratio = 0;
	for (int i = 1; i < course->point_count - NEWEST_KEPT; i++) {
		int64_t age, span = span_around(course, i, &age);
		double ratio = (double)span / (double)(age + spacing);
		if (may_go(course, i) && (least < 0 || ratio < least_ratio)) {
			least = i;
			least_ratio = ratio;
		}
	}
	return least;
}
