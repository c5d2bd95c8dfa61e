// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the events of a session, and those that a branch sees.
#include <stdlib.h>

#include "file.h"
#include "store_state.h"

// ?1: session, ?2: kind or NULL, ?3: branch or -1, ?4 and ?5: ticks, ?6: count
static const char newest_events[] =
	"SELECT branch, tick, level, kind, text, time_ms FROM events WHERE session = ?1"
	" AND (?2 IS NULL OR kind = ?2) AND (?3 < 0 OR branch = ?3) AND tick BETWEEN ?4 AND ?5"
	" ORDER BY key DESC LIMIT ?6";

typedef struct wanted {
	int64_t key; // key of the session
	const char *session, *kind;
	int64_t branch, from_tick, to_tick;
	int32_t count; // events still wanted
	cau_store_visit_event visit;
	void *user;
} wanted;

static cau_status visit_rows(struct cau_store_reader *reader, sqlite3_stmt *statement, wanted *w,
                             cau_error *error)
{
	cau_status status = CAU_OK;
	while (!status && !(status = cau_store_next_row(reader, statement, error))) {
		cau_store_event event = {
			.session = w->session,
			.branch = sqlite3_column_int64(statement, 0),
			.tick = (uint64_t)sqlite3_column_int64(statement, 1),
			.level = sqlite3_column_int(statement, 2),
			.kind = cau_store_column_text(statement, 3),
			.text = cau_store_column_text(statement, 4),
			.time_ms = sqlite3_column_int64(statement, 5),
		};
		w->count--;
		cau_status visited = w->visit(w->user, &event);
		if (visited)
			return visited;
	}
	return cau_store_end_is_fine(status);
}

static cau_status read_some(struct cau_store_reader *reader, wanted *w, cau_error *error)
{
	sqlite3_stmt *statement = NULL;
	cau_status status = cau_store_prepare(reader, newest_events, &statement, error);
	if (!status) {
		sqlite3_bind_int64(statement, 1, w->key);
		// a NULL pointer binds SQL NULL
		sqlite3_bind_text(statement, 2, w->kind, -1, SQLITE_STATIC);
		sqlite3_bind_int64(statement, 3, w->branch);
		sqlite3_bind_int64(statement, 4, w->from_tick);
		sqlite3_bind_int64(statement, 5, w->to_tick);
		sqlite3_bind_int64(statement, 6, w->count > 0 ? w->count : 0);
		status = visit_rows(reader, statement, w, error);
	}
	sqlite3_finalize(statement);
	return status;
}

cau_status cau_store_read_events(cau_store *store, const char *session, const char *kind,
                                 int32_t count, cau_store_visit_event visit, void *user,
                                 cau_error *error)
{
	struct cau_store_reader *reader = &store->reading;
	wanted w = {0, session, kind, -1, 0, INT64_MAX, count, visit, user};
	pthread_mutex_lock(&reader->mutex);
	cau_status status = session ? cau_store_find_session(reader, session, &w.key, error) : CAU_OK;
	if (!status)
		status = read_some(reader, &w, error);
	pthread_mutex_unlock(&reader->mutex);
	return status;
}

static int64_t least(uint64_t a, int64_t b)
{
	return a < (uint64_t)b ? (int64_t)a : b;
}

cau_status cau_store_read_timeline(cau_store *store, const char *session, int64_t branch,
                                   uint64_t from_tick, uint64_t to_tick, int32_t count,
                                   cau_store_visit_event visit, void *user, cau_error *error)
{
	struct cau_store_reader *reader = &store->reading;
	struct cau_store_stretch *line = NULL;
	int stretches = 0;
	wanted w = {0, session, NULL, branch, least(from_tick, INT64_MAX), 0, count, visit, user};
	pthread_mutex_lock(&reader->mutex);
	cau_status status = cau_store_find_session(reader, session, &w.key, error);
	if (!status)
		status = cau_store_find_line(reader, w.key, branch, &line, &stretches, error);
	for (int i = 0; i < stretches && !status && w.count > 0; i++) {
		w.branch = line[i].branch;
		w.to_tick = least(to_tick, line[i].before_tick);
		status = read_some(reader, &w, error);
	}
	pthread_mutex_unlock(&reader->mutex);
	free(line);
	return status;
}
