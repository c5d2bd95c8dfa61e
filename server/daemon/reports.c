// SPDX-License-Identifier: GPL-3.0-or-later
#include "daemon/reports.h"

#include <math.h>
#include <systemd/sd-daemon.h>
#include <time.h>

#include "clock/clock.h"
#include "log/log.h"

// ---- load ---------------------------------------------------------------------------------------

// Length of the window in which the busy share is measured, s. A shorter window would show single
// steps; a longer one, sessions that have ended.
#define WINDOW_S 0.5

static double process_cpu_s(void)
{
	struct timespec now;
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void cau_load_meter_init(cau_load_meter *meter, const cau_config *config, cau_hub *hub,
                         int32_t worker_count)
{
	*meter = (cau_load_meter){.config = config,
	                          .hub = hub,
	                          .worker_count = worker_count,
	                          .window_s = cau_monotonic_s(),
	                          .window_cpu_s = process_cpu_s()};
}

// Measures the processor time of all threads, because builders and network use the same cores as
// the workers.
static void measure_cores(cau_load_meter *meter)
{
	double now_s = cau_monotonic_s(), cpu_s = process_cpu_s();
	double wall_s = now_s - meter->window_s;
	if (wall_s < WINDOW_S)
		return;
	meter->busy_share = fmin(1, (cpu_s - meter->window_cpu_s) / (wall_s * meter->worker_count));
	meter->window_s = now_s;
	meter->window_cpu_s = cpu_s;
}

void cau_load_meter_read(cau_load_meter *meter, cau_load *load)
{
	measure_cores(meter);
	load->busy_share = meter->busy_share;
	load->session_count = cau_hub_count(meter->hub);
	load->session_count_most = (int32_t)meter->config->max_sessions;
	load->session_bytes = cau_hub_memory(meter->hub);
	load->session_bytes_most = meter->config->max_sessions_bytes;
	load->pace_share_min = cau_hub_pace_share_min(meter->hub);
}

// ---- progress of a restart ----------------------------------------------------------------------

#define PACE_S 2.0 // time between two lines of the log

void cau_restart_begin(cau_restart *restart, cau_hub *hub, int32_t sessions)
{
	*restart =
		(cau_restart){.hub = hub, .of = sessions, .left = sessions, .began_s = cau_monotonic_s()};
	restart->told_s = restart->began_s;
}

void cau_restart_tell(cau_restart *restart)
{
	if (restart->left == 0)
		return;
	int32_t left = cau_hub_resuming(restart->hub);
	if (left >= restart->left)
		return;
	restart->left = left;
	int32_t done = restart->of - left;
	double now_s = cau_monotonic_s();
	if (!left || now_s >= restart->told_s + PACE_S) {
		cau_log(CAU_LOG_NOTICE, NULL, left ? "resuming" : "all_resumed",
		        "sessions=%d of=%d seconds=%.1f", done, restart->of, now_s - restart->began_s);
		restart->told_s = now_s;
	}
	sd_notifyf(0, left ? "STATUS=%d of %d sessions are up" : "STATUS=", done, restart->of);
}
