// SPDX-License-Identifier: GPL-3.0-or-later
#include "daemon/restart.h"

#include <systemd/sd-daemon.h>

#include "clock/clock.h"
#include "log/log.h"

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
