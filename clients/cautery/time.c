// SPDX-License-Identifier: GPL-3.0-or-later
// The commands `pause`, `resume`, `step`, `speed` and `reset`.
#include <string.h>

#include "cautery/cli.h"

static cli_exit change(cli *c, cau_method method)
{
	cau_wire_session_change params = {0};
	cau_wire_session_summary summary = {0};
	cli_exit code = cli_connect(c);
	if (code)
		return code;
	CLI_CHANGE_PARAMS(c, &params);
	code = cli_call(c, method, &params, &summary);
	if (!code && !c->json)
		fprintf(c->out, "%s is %s at tick %lld\n", summary.session, cli_state_word(summary.state),
		        (long long)summary.tick);
	return code;
}

static cli_exit run_pause(cli *c)
{
	return change(c, CAU_METHOD_SESSION_PAUSE);
}

static cli_exit run_resume(cli *c)
{
	return change(c, CAU_METHOD_SESSION_RESUME);
}

static cli_exit run_step(cli *c)
{
	cau_wire_session_step params = {.has_ticks = true, .ticks = 1};
	cau_wire_tick_result result = {0};
	bool bad = false;
	params.ticks = (int64_t)cli_number(c, "ticks", 1, 100000, 1, &bad);
	cli_exit code = bad ? CLI_USAGE : cli_connect(c);
	if (code)
		return code;
	CLI_CHANGE_PARAMS(c, &params);
	code = cli_call(c, CAU_METHOD_SESSION_STEP, &params, &result);
	if (!code && !c->json)
		fprintf(c->out, "%s is at tick %lld\n", c->session, (long long)result.tick);
	return code;
}

static cli_exit run_speed(cli *c)
{
	cau_wire_session_speed params = {0};
	cau_wire_session_summary summary = {0};
	cli_exit code = CLI_USAGE;
	// SPEED is the last argument; a session may precede it.
	if (cli_read_number(c, "SPEED", c->arguments[c->argument_count - 1], 0.01, 10, &params.speed))
		code = cli_connect(c);
	if (code)
		return code;
	CLI_CHANGE_PARAMS(c, &params);
	code = cli_call(c, CAU_METHOD_SESSION_SPEED, &params, &summary);
	if (!code && !c->json)
		fprintf(c->out, "%s aims at %g simulated seconds a second\n", c->session, summary.speed);
	return code;
}

static cli_exit run_reset(cli *c)
{
	cau_wire_session_change params = {0};
	cau_wire_restored restored = {0};
	cli_exit code = cli_connect(c);
	if (code)
		return code;
	CLI_CHANGE_PARAMS(c, &params);
	code = cli_call(c, CAU_METHOD_SESSION_RESET, &params, &restored);
	if (!code && !c->json)
		fprintf(c->out, "%s is at tick %lld, branch %lld, energy off\n", c->session,
		        (long long)restored.tick, (long long)restored.branch);
	return code;
}

const cli_command cli_pause = {.name = "pause",
                               .arguments = "[SESSION]",
                               .summary = "pauses a session; energy goes off",
                               .session_optional = true,
                               .run = run_pause};

const cli_command cli_resume = {.name = "resume",
                                .arguments = "[SESSION]",
                                .summary = "resumes a paused session",
                                .session_optional = true,
                                .run = run_resume};

const cli_command cli_step = {.name = "step",
                              .arguments = "[SESSION]",
                              .summary = "advances a paused session",
                              .session_optional = true,
                              .options = {{"ticks", "N", "number of steps (default 1)"}},
                              .run = run_step};

const cli_command cli_speed = {.name = "speed",
                               .arguments = "[SESSION] SPEED",
                               .summary = "sets the speed: simulated over wall time, 0.01 to 10",
                               .least = 1,
                               .most = 1,
                               .session_optional = true,
                               .run = run_speed};

const cli_command cli_reset = {.name = "reset",
                               .arguments = "[SESSION]",
                               .summary =
                                   "resets a session to tick 0, on a new branch; energy goes off",
                               .session_optional = true,
                               .run = run_reset};
