// SPDX-License-Identifier: GPL-3.0-or-later
// The daemon: everything put together, started and ended in order.
#pragma once

#include <signal.h>

#include "cautery/status.h"
#include "config/config.h"

typedef struct cau_daemon cau_daemon;

// Opens what the settings say, resumes what the store holds, listens. `config` is borrowed; its
// port becomes the real one.
cau_status cau_daemon_start(cau_daemon **daemon, cau_config *config, cau_error *error);
// Waits for one of the signals, telling systemd meanwhile that all threads live. A hang-up of the
// terminal is told as SIGTERM, one that a program sent as SIGHUP. Non-zero: the daemon cannot go
// on.
int cau_daemon_wait(cau_daemon *daemon, const sigset_t *signals, int *signal_number);
// Reads the files of tokens and of DDS roles anew. One that is wrong is logged, with the line, and
// what it said before stays. Connections whose token was taken back, or has a lesser role now, are
// closed, energy off; who has a lesser role on DDS loses its tools; nobody else notices.
void cau_daemon_reload(cau_daemon *daemon);
// From now on the agent-check says `drain`, or the load again: a proxy in front brings no new
// sessions. Those that are here go on, and whoever is connected may still make some.
void cau_daemon_stand_aside(cau_daemon *daemon, bool aside);
// Checkpoints every session, closes connections with a reason, ends the threads, frees all.
void cau_daemon_stop(cau_daemon *daemon);
