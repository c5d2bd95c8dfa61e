// SPDX-License-Identifier: GPL-3.0-or-later
// The daemons, each on its machine. They use the daemon's own start and end, with the double of the
// core.
#include <assert.h>
#include <signal.h>
#include <string.h>

#include "daemon/daemon.h"
#include "simulation/promises.h"
#include "simulation/world.h"

typedef struct machine {
	enum { DOWN, STARTING, UP, ENDING } state;
	int boots;
	bool end_wanted;
	cau_config config;
	cau_error error; // error of a failed start
} machine;

static machine machines[DISK_MACHINES];
static sim_profile profile_now;

void daemons_begin(const sim_profile *profile)
{
	memset(machines, 0, sizeof machines);
	profile_now = *profile;
}

const char *daemons_label(int m)
{
	static const char *const labels[DISK_MACHINES] = {"d1", "d2"};
	return labels[m];
}

static void configure(int m)
{
	cau_config *config = &machines[m].config;
	cau_config_default(config);
	snprintf(config->store, sizeof config->store, "/sim%d/store.db", m);
	snprintf(config->label, sizeof config->label, "%s", daemons_label(m));
	snprintf(config->scenes, sizeof config->scenes, "%s", SIM_SCENES);
	snprintf(config->viewer, sizeof config->viewer, "%s", SIM_VIEWER);
	snprintf(config->tokens, sizeof config->tokens, "%s", profile_now.tokens ? SIM_TOKENS : "");
	config->workers = profile_now.workers;
	config->queue_commands = profile_now.queue_commands;
	config->subscriber_bytes = profile_now.subscriber_bytes;
	config->store_bytes = profile_now.store_bytes;
	config->checkpoint_s = profile_now.checkpoint_s;
}

static void *live(void *argument)
{
	machine *m = argument;
	cau_daemon *daemon;
	int signal_number = 0;
	sigset_t none;
	sigemptyset(&none);
	sim_set_name(sim_self(), "cauteryd");
	if (cau_daemon_start(&daemon, &m->config, &m->error)) {
		sim_say("no start: %s %s", m->error.path, m->error.reason);
		m->state = DOWN;
		return NULL;
	}
	m->state = UP;
	promises_started((int)(m - machines));
	while (!m->end_wanted)
		cau_daemon_wait(daemon, &none, &signal_number);
	m->state = ENDING;
	cau_daemon_stop(daemon);
	promises_killed((int)(m - machines));
	m->state = DOWN;
	return NULL;
}

void daemons_start(int m)
{
	if (machines[m].state != DOWN)
		return;
	configure(m);
	machines[m].state = STARTING;
	machines[m].end_wanted = false;
	machines[m].boots++;
	sim_say("start of machine %d", m);
	sim_enter_machine(m);
	sim_let_go(sim_start(live, &machines[m]));
	sim_enter_machine(SIM_WORLD);
}

void daemons_end(int m)
{
	machines[m].end_wanted = true;
}

void daemons_kill(int m, bool power)
{
	sim_say("kill of machine %d, power %d", m, power);
	sim_kill_machine(m);
	sim_network_kill(m);
	disk_kill(m, power);
	sim_calls_kill(m);
	machines[m].state = DOWN;
	promises_killed(m);
}

bool daemons_up(int m)
{
	return machines[m].state == UP;
}

bool daemons_down(int m)
{
	return machines[m].state == DOWN;
}

const char *daemons_trouble(int m)
{
	return machines[m].error.reason;
}

int daemons_boots(int m)
{
	return machines[m].boots;
}
