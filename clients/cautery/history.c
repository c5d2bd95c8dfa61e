// SPDX-License-Identifier: GPL-3.0-or-later
// The commands `rewind`, `fork`, `snapshot`, `snapshots` and `restore`.
#include <stdlib.h>
#include <string.h>

#include "cautery/cli.h"

// Reads the option --name. Complains and returns false if the name is too long.
static bool take_name(cli *c, bool *has, char name[CAU_NAME_BYTES])
{
	const char *given = cli_value(c, "name");
	*has = given;
	if (given && strlen(given) >= CAU_NAME_BYTES) {
		cli_complain(c, "--name is longer than %d bytes", CAU_NAME_BYTES - 1);
		return false;
	}
	snprintf(name, CAU_NAME_BYTES, "%s", given ? given : "");
	return true;
}

static void print_restored(const cli *c, const cau_wire_restored *restored)
{
	if (!c->json)
		fprintf(c->out, "%s is at tick %lld, branch %lld, energy off%s\n", c->session,
		        (long long)restored->tick, (long long)restored->branch,
		        restored->exact ? "" : "; not bit-exact, because another build wrote the state");
}

static cli_exit run_rewind(cli *c)
{
	cau_wire_session_rewind params = {0};
	cau_wire_restored restored = {0};
	double tick;
	if (!cli_read_number(c, "TICK", c->arguments[c->argument_count - 1], 0, cli_tick_max, &tick))
		return CLI_USAGE;
	cli_exit code = cli_connect(c);
	if (code)
		return code;
	params.tick = (int64_t)tick;
	CLI_CHANGE_PARAMS(c, &params);
	code = cli_call(c, CAU_METHOD_SESSION_REWIND, &params, &restored);
	if (!code)
		print_restored(c, &restored);
	return code;
}

static cli_exit run_restore(cli *c)
{
	cau_wire_session_restore params = {0};
	cau_wire_restored restored = {0};
	cli_exit code = cli_connect(c);
	if (code)
		return code;
	snprintf(params.name, sizeof params.name, "%s", c->arguments[0]);
	CLI_CHANGE_PARAMS(c, &params);
	code = cli_call(c, CAU_METHOD_SESSION_RESTORE, &params, &restored);
	if (!code)
		print_restored(c, &restored);
	return code;
}

static cli_exit run_snapshot(cli *c)
{
	cau_wire_session_snapshot params = {0};
	cau_wire_snapshot_result result = {0};
	cli_exit code = take_name(c, &params.has_name, params.name) ? cli_connect(c) : CLI_USAGE;
	if (code)
		return code;
	CLI_CHANGE_PARAMS(c, &params);
	code = cli_call(c, CAU_METHOD_SESSION_SNAPSHOT, &params, &result);
	if (!code && !c->json)
		fprintf(c->out, "%s: tick %lld, hash %016llx, %lld bytes\n", result.name,
		        (long long)result.tick, (unsigned long long)result.hash,
		        (long long)result.byte_count);
	return code;
}

enum { SNAPSHOTS_MAX = 64 }; // largest number of snapshots of a session

static cli_exit run_snapshots(cli *c)
{
	cau_wire_session_ref params = {0};
	cau_wire_named_snapshot named[SNAPSHOTS_MAX] = {0};
	cau_wire_snapshot_list list = {.snapshots = {named, 0, SNAPSHOTS_MAX}};
	cli_exit code = cli_connect(c);
	if (code)
		return code;
	CLI_SESSION_PARAMS(c, &params);
	code = cli_call(c, CAU_METHOD_SESSION_SNAPSHOTS, &params, &list);
	for (int32_t i = 0; !code && !c->json && i < list.snapshots.count; i++)
		fprintf(c->out, "%9lld  %s, branch %lld\n", (long long)named[i].tick, named[i].name,
		        (long long)named[i].branch);
	return code;
}

static cli_exit run_fork(cli *c)
{
	cau_wire_layer_description layers[CAU_MAX_LAYERS];
	cau_wire_driver drivers[CAU_MAX_TOOLS];
	cau_wire_session_description d = {.layers = {layers, 0, CAU_MAX_LAYERS},
	                                  .drivers = {drivers, 0, CAU_MAX_TOOLS}};
	cau_wire_session_fork params = {
		.has_tick = cli_value(c, "tick"), .has_paused = true, .paused = cli_value(c, "paused")};
	bool bad = !take_name(c, &params.has_name, params.name);
	params.tick = (int64_t)cli_number(c, "tick", 0, cli_tick_max, 0, &bad);
	cli_exit code = bad ? CLI_USAGE : cli_connect(c);
	if (code)
		return code;
	CLI_CHANGE_PARAMS(c, &params);
	d.definition = calloc(1, sizeof *d.definition);
	code = d.definition ? cli_call(c, CAU_METHOD_SESSION_FORK, &params, &d) : cli_fail_memory(c);
	if (!code && !c->json)
		fprintf(c->out, "%s\n", d.summary.session);
	free(d.definition);
	return code;
}

const cli_command cli_rewind = {.name = "rewind",
                                .arguments = "[SESSION] TICK",
                                .summary =
                                    "rewinds a session to a tick, on a new branch; energy goes off",
                                .help = "`cautery events` shows the earliest tick.\n",
                                .least = 1,
                                .most = 1,
                                .session_optional = true,
                                .run = run_rewind};

const cli_command cli_fork = {
	.name = "fork",
	.arguments = "[SESSION]",
	.summary = "creates a new session from the state of this session",
	.session_optional = true,
	.options = {{"name", "N", "name of the new session, without the daemon's label"},
                {"tick", "K", "tick of the state (default: the present tick)"},
                {"paused", NULL, "the new session starts paused"}},
	.run = run_fork};

const cli_command cli_snapshot = {
	.name = "snapshot",
	.arguments = "[SESSION]",
	.summary = "stores the state under a name",
	.session_optional = true,
	.options = {{"name", "N", "name of the snapshot (default: chosen by the server)"}},
	.run = run_snapshot};

const cli_command cli_snapshots = {.name = "snapshot ls",
                                   .also = "snapshots",
                                   .arguments = "[SESSION]",
                                   .summary = "lists the snapshots that `restore` can restore",
                                   .session_optional = true,
                                   .run = run_snapshots};

const cli_command cli_restore = {.name = "restore",
                                 .arguments = "[SESSION] NAME",
                                 .summary = "restores a snapshot, on a new branch; energy goes off",
                                 .least = 1,
                                 .most = 1,
                                 .session_optional = true,
                                 .run = run_restore};
