// SPDX-License-Identifier: GPL-3.0-or-later
#include "backup/backup.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#include "hosted_session/hosted.h"
#include "log/log.h"
#include "store/store.h"

// Approximate bytes that a copy reads, writes, syncs and checks in a second. The builder orders its
// jobs by the time that follows from this.
#define COPY_BYTES_PER_S 50e6

typedef struct copying {
	cau_job job; // must be the first member
	cau_backups *backups;
	cau_reply reply;
	char folder[CAU_CONFIG_TEXT_BYTES + 16];
	char file[CAU_CONFIG_TEXT_BYTES + 16 + CAU_NAME_BYTES + 8];
} copying;

static void finish(copying *what, const cau_error *error, const cau_outcome *done)
{
	what->backups->copying = false;
	if (error)
		cau_reply_fail(&what->reply, error, 0);
	else
		cau_reply_answer(&what->reply, done);
	free(what);
}

static void drop(cau_job *job)
{
	cau_error error = {.status = CAU_BAD_STATE, .reason = "the server is shutting down"};
	finish((copying *)job, &error, NULL);
}

// Makes the folder beside the store when it is first needed. A folder that the settings name must
// exist; if not, the copy fails with an error.
static cau_status make_folder(const copying *what, cau_error *error)
{
	bool named = *what->backups->config->backups;
	if (named || mkdir(what->folder, 0700) == 0 || errno == EEXIST)
		return CAU_OK;
	return cau_fail(error, CAU_IO, "", "cannot create the folder %.150s: %s", what->folder,
	                strerror(errno));
}

static cau_status copy(const copying *what, cau_outcome *done, cau_error *error)
{
	struct stat made;
	cau_wire_store_copy result = {0};
	cau_status status = make_folder(what, error);
	if (!status)
		status = cau_store_backup(what->backups->config->store, what->file, error);
	if (status)
		return status;
	if (stat(what->file, &made) == 0)
		result.byte_count = made.st_size;
	snprintf(result.file, sizeof result.file, "%s", what->file);
	done->text = cau_answer_text(what->reply.method, &result, &done->text_bytes, error);
	return done->text ? CAU_OK : error->status;
}

static void run(cau_job *job)
{
	copying *what = (copying *)job;
	cau_error error = {0};
	cau_outcome done = {0};
	cau_status status = copy(what, &done, &error);
	char *text = (char *)done.text;
	if (status)
		cau_log(CAU_LOG_ERROR, NULL, "backup_failed", "file=\"%s\" status=%s reason=\"%s\"",
		        what->file, cau_status_name(status), error.reason);
	else
		cau_log(CAU_LOG_NOTICE, NULL, "backed_up", "store=\"%s\" file=\"%s\"",
		        what->backups->config->store, what->file);
	finish(what, status ? &error : NULL, &done);
	free(text);
}

static void name_copy(copying *what, const char *name)
{
	const cau_config *config = what->backups->config;
	char made_up[CAU_NAME_BYTES];
	time_t now = time(NULL);
	struct tm utc;
	if (*config->backups) {
		snprintf(what->folder, sizeof what->folder, "%s", config->backups);
	} else {
		const char *slash = strrchr(config->store, '/');
		int bytes = slash ? (int)(slash - config->store) + 1 : 0;
		snprintf(what->folder, sizeof what->folder, "%.*sbackups", bytes, config->store);
	}
	if (!*name) {
		strftime(made_up, sizeof made_up, "%Y%m%dT%H%M%SZ", gmtime_r(&now, &utc));
		name = made_up;
	}
	snprintf(what->file, sizeof what->file, "%s/%s.db", what->folder, name);
}

static double expected_s(const cau_backups *backups)
{
	cau_store_metrics metrics;
	cau_store_get_metrics(backups->store, &metrics);
	return (double)metrics.database_bytes / COPY_BYTES_PER_S;
}

cau_status cau_backups_make(cau_backups *backups, const char *name, const cau_reply *reply,
                            cau_error *error)
{
	if (atomic_exchange(&backups->copying, true))
		return cau_fail(error, CAU_BAD_STATE, "",
		                "the store is already being copied: try again when that is done");
	copying *what = calloc(1, sizeof *what);
	if (!what) {
		backups->copying = false;
		return cau_fail(error, CAU_NO_MEMORY, "", "no memory for the copy");
	}
	what->job = (cau_job){.run = run, .drop = drop, .expected_s = expected_s(backups)};
	what->backups = backups;
	what->reply = *reply;
	name_copy(what, name);
	cau_builder_submit(backups->builder, &what->job);
	return CAU_OK;
}
