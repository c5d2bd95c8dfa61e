// SPDX-License-Identifier: GPL-3.0-or-later
// The part of /metrics about the whole daemon: answers, network, store, times, process, disk.
#include <dirent.h>
#include <malloc.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "rpc/internal.h"

// ---- answers to each method, counted from any thread
// The words of the columns. Column 0 is for results, the others are for errors.
static const struct {
	int32_t code;
	const char *word;
} columns[CAU_ANSWER_COLUMNS] = {{0, "ok"},
#define X(number, code, word, sentence) {(number), word},
                                 CAU_RPC_ERROR_TABLE(X)
#undef X
};

void cau_answers_count(cau_service *service, cau_method method, int32_t code)
{
	int column = 0;
	while (column < CAU_ANSWER_COLUMNS - 1 && columns[column].code != code)
		column++;
	atomic_fetch_add_explicit(&service->answers[method][column], 1, memory_order_relaxed);
}

const char *cau_answers_method_name(cau_method method)
{
	return method == CAU_METHOD_COUNT ? "none" : cau_method_describe(method)->name;
}

static void write_calls(cau_service *service, cau_metrics_format format, FILE *out)
{
	static const cau_metric_family family = {"calls", CAU_METRIC_COUNTER, "",
	                                         "Requests and notifications on WebSocket, by method"};
	cau_metrics_begin(out, format, &family);
	for (int m = 0; m < CAU_METHOD_COUNT; m++)
		if (cau_method_describe((cau_method)m)->form != CAU_FORM_PUSH)
			cau_metrics_sample(out, format, &family, "method",
			                   cau_answers_method_name((cau_method)m), (double)service->calls[m]);
}

// True if the count is written to /metrics. The counts of results begin with 0 for each method that
// clients may call, so that the first call shows as an increase. The counts of errors begin with
// the first error, because there are too many to write them all.
static bool is_told(int method, int column, uint64_t count)
{
	cau_method_form form =
		method < CAU_METHOD_COUNT ? cau_method_describe((cau_method)method)->form : CAU_FORM_PUSH;
	return count > 0 || (column == 0 && (form == CAU_FORM_REQUEST || form == CAU_FORM_EITHER_WAY));
}

static void write_answers(cau_service *service, cau_metrics_format format, FILE *out)
{
	static const cau_metric_family family = {
		"answers", CAU_METRIC_COUNTER, "",
		"Answers on WebSocket by method and code; method none: answers to invalid requests"};
	cau_metrics_begin(out, format, &family);
	for (int m = 0; m <= CAU_METHOD_COUNT; m++)
		for (int c = 0; c < CAU_ANSWER_COLUMNS; c++) {
			uint64_t count = service->answers[m][c];
			cau_metric_label labels[] = {{"method", cau_answers_method_name((cau_method)m)},
			                             {"code", columns[c].word}};
			if (is_told(m, c, count))
				cau_metrics_sample_labelled(out, format, &family, labels, 2, (double)count);
		}
}

// ---- network, store, times, process, disk
#ifndef CAUTERY_VERSION
#define CAUTERY_VERSION "0"
#endif

typedef struct exposition {
	FILE *out;
	cau_metrics_format format;
} exposition;

// Writes a family that has one sample.
static void single(const exposition *to, const char *name, cau_metric_type type, const char *unit,
                   const char *help, double value)
{
	cau_metric_family family = {name, type, unit, help};
	cau_metrics_begin(to->out, to->format, &family);
	cau_metrics_sample(to->out, to->format, &family, NULL, NULL, value);
}

static void gauge(const exposition *to, const char *name, const char *unit, const char *help,
                  double value)
{
	single(to, name, CAU_METRIC_GAUGE, unit, help, value);
}

static void counter(const exposition *to, const char *name, const char *unit, const char *help,
                    double value)
{
	single(to, name, CAU_METRIC_COUNTER, unit, help, value);
}

static void write_network(cau_service *service, const exposition *to)
{
	cau_network_counts n = cau_network_count(service->network);
	gauge(to, "connections", "", "WebSocket connections open", (double)n.connections);
	gauge(to, "connections_served", "", "WebSocket connections that have sent hello",
	      (double)n.served);
	counter(to, "connections_accepted", "", "WebSocket connections accepted", (double)n.accepted);
	counter(to, "handshakes_refused", "", "Upgrade requests refused", (double)n.refused_handshakes);
	counter(to, "connections_closed_slow", "", "Connections closed for slowness",
	        (double)n.closed_slow);
	counter(to, "connections_closed_error", "", "Connections closed because they broke a rule",
	        (double)n.closed_errors);
	counter(to, "connections_closed_without_hello", "",
	        "Connections without hello that were closed to accept newer connections",
	        (double)n.strangers_closed);
	counter(to, "messages_received", "", "Messages from clients", (double)n.messages_in);
	counter(to, "received_bytes", "bytes", "Bytes of messages from clients", (double)n.bytes_in);
	counter(to, "messages_sent", "", "Messages to clients", (double)n.messages_out);
	counter(to, "sent_bytes", "bytes", "Bytes of messages to clients", (double)n.bytes_out);
	counter(to, "requests", "", "Text messages read", (double)service->requests);
	counter(to, "request_errors", "", "Requests refused before they reached a session",
	        (double)service->errors);
}

// Writes the durations of commits. The store counts in quarter octaves; the metrics have whole
// octaves.
static void write_commits(const exposition *to, const cau_store_metrics *m)
{
	enum { OCTAVES = 20, QUARTERS = 4 }; // OCTAVES: from 10 us to 10 s
	static const cau_metric_family family = {"store_commit_seconds", CAU_METRIC_HISTOGRAM,
	                                         "seconds", "Time of a commit, with its sync"};
	double bounds[OCTAVES + 1];
	uint64_t counts[OCTAVES + 2] = {0};
	for (int i = 0; i <= OCTAVES; i++)
		bounds[i] = cau_store_time_bucket_s(QUARTERS * i);
	for (int i = 0; i < CAU_STORE_TIME_BUCKETS; i++) {
		int octave = (i + QUARTERS - 1) / QUARTERS;
		counts[octave <= OCTAVES ? octave : OCTAVES + 1] += m->commit_time[i];
	}
	cau_metrics_begin(to->out, to->format, &family);
	cau_metrics_histogram(to->out, to->format, &family, NULL, 0,
	                      &(cau_buckets){bounds, OCTAVES + 1, counts, m->commit_s});
}

static void write_store(cau_service *service, const exposition *to)
{
	cau_store_metrics m;
	cau_store_health health;
	cau_store_get_metrics(service->store, &m);
	cau_store_get_health(service->store, &health);
	gauge(to, "store_ready", "", "1 if the store takes requests", health.state == CAU_STORE_READY);
	counter(to, "store_commits", "", "Groups of batches committed", (double)m.commits);
	counter(to, "store_records", "", "Rows committed", (double)m.records);
	counter(to, "store_failed_batches", "", "Batches that could not be committed",
	        (double)m.failed_batches);
	counter(to, "store_full", "", "Number of times that the disk was full", (double)m.full_count);
	gauge(to, "store_queue_batches", "", "Batches waiting", m.queue_batches);
	gauge(to, "store_commit_p99_seconds", "seconds", "99th percentile of the time of commits",
	      m.commit_p99_s);
	gauge(to, "store_database_bytes", "bytes", "Size of the store", (double)m.database_bytes);
	gauge(to, "store_log_bytes", "bytes", "Size of the store's write-ahead log",
	      (double)m.wal_bytes);
	counter(to, "store_retired_rows", "", "Records removed to keep the store's bounds",
	        (double)m.retired_rows);
	gauge(to, "store_kept_bytes", "bytes", "Size of the pages in use in the store, all tables",
	      (double)m.kept_bytes);
	gauge(to, "store_budget_bytes", "bytes", "Largest size of the pages in use; 0: no bound",
	      (double)service->config->store_bytes);
	counter(to, "store_budget_checkpoints", "", "Checkpoints removed to keep the store's budget",
	        (double)m.budget_dropped);
	gauge(to, "store_beyond_budget", "",
	      "1 if sessions exceed the store's budget and nothing can be removed",
	      m.budget == CAU_STORE_BUDGET_BEYOND);
	write_commits(to, &m);
}

// ---- the store's disk
static void write_disk(const cau_service *service, const exposition *to)
{
	struct statvfs disk;
	if (statvfs(service->config->store, &disk))
		return;
	gauge(to, "disk_free_bytes", "bytes", "Free space on the disk of the store, for this user",
	      (double)disk.f_bavail * (double)disk.f_frsize);
	gauge(to, "disk_size_bytes", "bytes", "Size of the store's disk",
	      (double)disk.f_blocks * (double)disk.f_frsize);
}

// Returns the second number of /proc/self/statm, the resident pages; 0 if the file cannot be read.
static long resident_pages(void)
{
	char line[128] = "", *resident = line;
	FILE *statm = fopen("/proc/self/statm", "r");
	if (!statm)
		return 0;
	if (fgets(line, sizeof line, statm))
		strtol(line, &resident, 10);
	fclose(statm);
	return strtol(resident, NULL, 10);
}

// Returns the bytes of live allocations, in all arenas and in mappings of their own; 0 under
// sanitizers.
static double heap_bytes(void)
{
	struct mallinfo2 heap = mallinfo2();
	return (double)heap.uordblks + (double)heap.hblkhd;
}

static double open_files(void)
{
	double count = -1; // starts at -1, because the folder that is read is open too
	DIR *folder = opendir("/proc/self/fd");
	if (!folder)
		return 0;
	for (const struct dirent *entry; (entry = readdir(folder));)
		count += entry->d_name[0] != '.';
	closedir(folder);
	return count;
}

// Returns the start of the process in Unix time, from field 22 of /proc/self/stat: clock ticks
// since the boot.
static double start_time_s(void)
{
	char line[1024] = "";
	struct timespec up;
	FILE *stat = fopen("/proc/self/stat", "r");
	const char *at = stat && fgets(line, sizeof line, stat) ? strrchr(line, ')') : NULL;
	if (stat)
		fclose(stat);
	for (int field = 2; at && field < 22; field++)
		at = strchr(at + 1, ' ');
	if (!at || clock_gettime(CLOCK_BOOTTIME, &up))
		return 0;
	double since_boot_s = strtod(at, NULL) / (double)sysconf(_SC_CLK_TCK);
	double up_s = (double)up.tv_sec + 1e-9 * (double)up.tv_nsec;
	return 1e-6 * (double)cau_wall_us() - up_s + since_boot_s;
}

static void write_process(const exposition *to)
{
	static double started_s; // computed once, because the clock may be set later
	struct rusage usage;
	struct rlimit files;
	getrusage(RUSAGE_SELF, &usage);
	double user_s = (double)usage.ru_utime.tv_sec + 1e-6 * (double)usage.ru_utime.tv_usec;
	double system_s = (double)usage.ru_stime.tv_sec + 1e-6 * (double)usage.ru_stime.tv_usec;
	started_s = started_s > 0 ? started_s : start_time_s();
	gauge(to, "resident_bytes", "bytes", "Resident memory of the process",
	      (double)resident_pages() * (double)sysconf(_SC_PAGESIZE));
	gauge(to, "heap_bytes", "bytes", "Memory in live allocations", heap_bytes());
	counter(to, "cpu_seconds", "seconds", "Processor time used", user_s + system_s);
	gauge(to, "start_time_seconds", "seconds", "Start time of the process, Unix time", started_s);
	gauge(to, "open_files", "", "File descriptors in use", open_files());
	if (!getrlimit(RLIMIT_NOFILE, &files))
		gauge(to, "open_files_most", "", "File descriptors that the process may use",
		      (double)files.rlim_cur);
}

static void write_build(const cau_service *service, const exposition *to)
{
	static const cau_metric_family family = {
		"build_info", CAU_METRIC_GAUGE, "", "Always 1; labels: the build, and whether DDS is open"};
	const cau_metric_label labels[] = {{"version", CAUTERY_VERSION},
	                                   {"compiler", __VERSION__},
	                                   {"dds", service->config->dds ? "on" : "off"}};
	cau_metrics_begin(to->out, to->format, &family);
	cau_metrics_sample_labelled(to->out, to->format, &family, labels,
	                            sizeof labels / sizeof labels[0], 1);
}

// ---- times of all sessions
static void write_histogram(const exposition *to, const cau_metric_family *family,
                            const cau_metric_label *label, const cau_histogram *histogram)
{
	uint64_t counts[CAU_HISTOGRAM_BOUNDS + 1];
	cau_buckets buckets = {cau_histogram_bounds_s, CAU_HISTOGRAM_BOUNDS, counts, 0};
	cau_histogram_read(histogram, counts, &buckets.sum);
	cau_metrics_histogram(to->out, to->format, family, label, label != NULL, &buckets);
}

static void write_times(const cau_hosted_times *times, const exposition *to)
{
	const struct {
		cau_metric_family family;
		const cau_histogram *histogram;
	} rows[] = {
		{{"step_seconds", CAU_METRIC_HISTOGRAM, "seconds", "Time of a step"}, &times->step},
		{{"lateness_seconds", CAU_METRIC_HISTOGRAM, "seconds",
	      "Delay with which a tick of a running session begins"},
	     &times->lateness},
		{{"command_to_frame_seconds", CAU_METRIC_HISTOGRAM, "seconds",
	      "Time from the arrival of a command to the first frame that shows the command, for "
	      "watched sessions"},
	     &times->command_to_frame},
	};
	const cau_metric_family stage = {"step_stage_seconds", CAU_METRIC_HISTOGRAM, "seconds",
	                                 "Share of each stage in the time of a step"};
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
		cau_metrics_begin(to->out, to->format, &rows[i].family);
		write_histogram(to, &rows[i].family, NULL, rows[i].histogram);
	}
	cau_metrics_begin(to->out, to->format, &stage);
	for (int i = 0; i < CAU_HOSTED_STAGES; i++)
		write_histogram(to, &stage, &(cau_metric_label){"stage", cau_hosted_stage_name(i)},
		                &times->stage[i]);
}

static void write_refused_tokens(cau_service *service, const exposition *to)
{
	static const cau_metric_family family = {
		"authentication_failures", CAU_METRIC_COUNTER, "",
		"Requests whose token was missing, unknown or expired"};
	cau_network_counts counts = cau_network_count(service->network);
	cau_metrics_begin(to->out, to->format, &family);
	cau_metrics_sample(to->out, to->format, &family, "door", "hello",
	                   (double)service->tokens_refused);
	cau_metrics_sample(to->out, to->format, &family, "door", "http", (double)counts.refused_tokens);
}

void cau_service_daemon_metrics(cau_service *service, cau_metrics_format format, FILE *out)
{
	exposition to = {out, format};
	write_build(service, &to);
	gauge(&to, "longest_slice_seconds", "seconds",
	      "Processor time of the longest work on a worker thread, without steps",
	      cau_hub_longest_slice_s(service->hub));
	write_times(cau_hub_times(service->hub), &to);
	write_network(service, &to);
	write_calls(service, format, out);
	write_answers(service, format, out);
	write_refused_tokens(service, &to);
	write_store(service, &to);
	write_disk(service, &to);
	write_process(&to);
}
