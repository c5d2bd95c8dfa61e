// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics.h"

#include <math.h>
#include <string.h>
#include <sys/stat.h>

static const double first_bucket_s = 10e-6;

double cau_store_time_bucket_s(int bucket)
{
	return first_bucket_s * exp2(0.25 * bucket);
}

int cau_store_time_bucket(double seconds)
{
	if (!(seconds > first_bucket_s))
		return 0;
	double bucket = ceil(4.0 * log2(seconds / first_bucket_s));
	return bucket < CAU_STORE_TIME_BUCKETS - 1 ? (int)bucket : CAU_STORE_TIME_BUCKETS - 1;
}

void cau_store_count_commit(struct cau_store_queue *queue, int batches, double seconds)
{
	int size = 0;
	while (size < CAU_STORE_SIZE_BUCKETS - 1 && (1 << size) < batches)
		size++;
	pthread_mutex_lock(&queue->mutex);
	queue->metrics.commits++;
	queue->metrics.group_size[size]++;
	queue->metrics.commit_s += seconds;
	queue->metrics.commit_time[cau_store_time_bucket(seconds)]++;
	pthread_mutex_unlock(&queue->mutex);
}

// Returns the upper end of the bucket that contains the given share of all counts; 0 if there are
// none.
static double quantile(const uint64_t count[CAU_STORE_TIME_BUCKETS], double share)
{
	uint64_t total = 0, seen = 0;
	for (int i = 0; i < CAU_STORE_TIME_BUCKETS; i++)
		total += count[i];
	for (int i = 0; i < CAU_STORE_TIME_BUCKETS; i++) {
		seen += count[i];
		if (seen && (double)seen >= share * (double)total)
			return cau_store_time_bucket_s(i);
	}
	return 0.0;
}

static uint64_t file_bytes(const char *path, const char *suffix)
{
	char name[4200];
	struct stat file;
	snprintf(name, sizeof name, "%s%s", path, suffix);
	return stat(name, &file) == 0 ? (uint64_t)file.st_size : 0;
}

void cau_store_get_metrics(cau_store *store, cau_store_metrics *metrics)
{
	uint64_t answer_time[CAU_STORE_TIME_BUCKETS];
	pthread_mutex_lock(&store->queue.mutex);
	*metrics = store->queue.metrics;
	memcpy(answer_time, store->queue.answer_time, sizeof answer_time);
	pthread_mutex_unlock(&store->queue.mutex);
	metrics->commit_p50_s = quantile(metrics->commit_time, 0.50);
	metrics->commit_p99_s = quantile(metrics->commit_time, 0.99);
	metrics->answer_p50_s = quantile(answer_time, 0.50);
	metrics->answer_p99_s = quantile(answer_time, 0.99);
	metrics->database_bytes = file_bytes(store->path, "");
	metrics->wal_bytes = file_bytes(store->path, "-wal");
}
