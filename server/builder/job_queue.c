// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/job_queue.h"

void cau_job_queue_put(cau_job_queue *queue, cau_job *job, double now_s)
{
	job->rank = now_s + CAU_JOB_PATIENCE * job->expected_s;
	cau_job **place = &queue->first;
	while (*place && (*place)->rank <= job->rank) // jobs of equal rank stay in order
		place = &(*place)->next;
	job->next = *place;
	*place = job;
	queue->count++;
}

cau_job *cau_job_queue_take(cau_job_queue *queue)
{
	cau_job *job = queue->first;
	if (job) {
		queue->first = job->next;
		job->next = NULL;
		queue->count--;
	}
	return job;
}
