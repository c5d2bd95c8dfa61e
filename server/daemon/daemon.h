// SPDX-License-Identifier: GPL-3.0-or-later
// The daemon: creates all parts, starts them, and ends them in order.
#pragma once

#include <signal.h>

#include "cautery/status.h"
#include "config/config.h"

typedef struct cau_daemon cau_daemon;

// Opens the parts that the settings name, resumes the sessions of the store, and listens. `config`
// is borrowed; its port becomes the real one.
cau_status cau_daemon_start(cau_daemon **daemon, cau_config *config, cau_error *error);
// Waits for one of the signals, and notifies systemd meanwhile that all threads run. A hang-up of
// the terminal is returned as SIGTERM, a SIGHUP from a program as SIGHUP. Returns non-zero if the
// daemon cannot continue.
int cau_daemon_wait(cau_daemon *daemon, const sigset_t *signals, int *signal_number);
// Reads the files of tokens and of DDS roles again. A wrong file is logged with the line, and the
// old tokens or roles stay. A connection is closed, with energy off, if its token was revoked or
// now has a lower role. A DDS client with a lower role loses its tools. No other client is
// affected.
void cau_daemon_reload(cau_daemon *daemon);
// Sets the agent-check's answer: `drain` if `aside`, else the load. With `drain` a proxy sends no
// new sessions here. Present sessions continue, and connected clients may still create sessions.
void cau_daemon_stand_aside(cau_daemon *daemon, bool aside);
// Checkpoints every session, closes connections with a reason, ends the threads, and frees
// everything.
void cau_daemon_stop(cau_daemon *daemon);
