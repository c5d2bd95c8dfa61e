// SPDX-License-Identifier: GPL-3.0-or-later
// One tick. cau_session_step lists all stages; each line names the stage and the file of its
// equations.
#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "cautery/assert.h"
#include "session/session_internal.h"

// ---- invariants

// Checks the invariants of tools, energy and waiting commands as a step begins, in every build. A
// violation is an error in this program, and a further step could heat tissue by mistake. So the
// step faults its session, only that session, and reports the finding.

static cau_status unsound(cau_error *error, const char *tool, const char *what)
{
	return cau_fail(error, CAU_FAULTED, NULL,
	                "a safety rule was broken before the step: tool \"%.64s\" %s", tool, what);
}

static bool is_pose(const cau_pose *pose)
{
	double length2 = 0;
	for (int c = 0; c < 4; c++)
		length2 += pose->rotation[c] * pose->rotation[c];
	return isfinite(pose->position_m[0]) && isfinite(pose->position_m[1]) &&
	       isfinite(pose->position_m[2]) && length2 > 0.5 && length2 < 2;
}

static cau_status check_tool(const cau_tool *tool, cau_error *error)
{
	const cau_tool_state *state = &tool->state;
	const char *name = state->name;
	if (!memchr(name, 0, sizeof state->name) || !*name)
		return unsound(error, "", "has no name");
	if (state->definition.shape < 0 || state->definition.shape >= CAU_TOOL_SHAPE_COUNT)
		return unsound(error, name, "has a shape that does not exist");
	if (!is_pose(&state->pose) || !is_pose(&tool->target) || !is_pose(&tool->anchor))
		return unsound(error, name, "has a pose that is not finite");
	if (!(state->jaw >= 0) || !isfinite(state->jaw) || !isfinite(tool->jaw_target))
		return unsound(error, name, "has an opening of its jaws that is not finite");
	if (tool->grasp_count < 0 || tool->grasp_count > CAU_MAX_GRASPED)
		return unsound(error, name, "holds more points than jaws can");
	if (tool->grasp_count > 0 && !state->grasping)
		return unsound(error, name, "holds tissue with open jaws");
	if (!tool->grid.field[0].temperature)
		return unsound(error, name, "has no heat grid");
	return CAU_OK;
}

static cau_status check_names(const cau_session *session, cau_error *error)
{
	for (int32_t i = 0; i < session->tool_count; i++)
		for (int32_t k = 0; k < i; k++)
			if (strcmp(session->tool[i].state.name, session->tool[k].state.name) == 0)
				return unsound(error, session->tool[i].state.name, "exists twice");
	return CAU_OK;
}

static cau_status check_sound(const cau_session *session, cau_error *error)
{
	cau_status status = CAU_OK;
	if (session->tool_count < 0 || session->tool_count > CAU_MAX_TOOLS)
		return unsound(error, "", "is beyond the largest number of tools");
	if (session->queue.count < 0 || session->queue.count > session->queue.capacity)
		return unsound(error, "", "has more waiting commands than the queue can hold");
	for (int32_t i = 0; i < session->tool_count && !status; i++)
		status = check_tool(&session->tool[i], error);
	return status ? status : check_names(session, error);
}

// ---- the step

void cau_session_stage_begin(cau_session *session)
{
	if (session->timing.now_s)
		session->timing.stage_start = session->timing.now_s();
}

void cau_session_stage_end(cau_session *session, int stage)
{
	CAU_ASSERT_INDEX(stage, CAU_STAGE_COUNT);
	if (!session->timing.now_s)
		return;
	double now = session->timing.now_s();
	session->timing.stage_s[stage] += now - session->timing.stage_start;
	session->timing.stage_start = now;
}

typedef struct settling {
	const cau_step_solver *solver;
	_Atomic int32_t inverted;
} settling;

static void settle_part(void *context, int32_t index)
{
	settling *work = context;
	const cau_step_solver *solver = work->solver;
	CAU_ASSERT_INDEX(index, solver->slots.work_count);
	atomic_fetch_add(&work->inverted,
	                 solver->kernels->settle(&solver->elements, &solver->slots.work[index],
	                                         solver->iterate.displacement));
}

// Computes plastic flow and counts the inverted tetrahedra (plasticity_kernel.h).
void cau_session_settle(cau_session *session)
{
	const cau_step_solver *solver = &session->solver;
	settling work = {.solver = solver};
	cau_pool_run(solver->pool, solver->slots.work_count, settle_part, &work);
	session->inversion.count = work.inverted;
	CAU_ASSERT(session->inversion.count <= session->tissue.tetrahedron_count,
	           "%d of %d tetrahedra are inverted", session->inversion.count,
	           session->tissue.tetrahedron_count);
}

// Freezes vertices whose last element was removed. They keep their row in the system and their
// position.
static void freeze_isolated(cau_session *session)
{
	if (!session->dissection.removed_count)
		return;
	for (int32_t v = 0; v < session->tissue.vertex_count; v++)
		if (!session->vertices.fixed[v] && !session->dissection.live_elements[v]) {
			session->vertices.fixed[v] = 1;
			session->vertices.frozen_count++;
			CAU_ASSERT(session->vertices.frozen_count <= session->tissue.vertex_count,
			           "%d vertices frozen of %d", session->vertices.frozen_count,
			           session->tissue.vertex_count);
			memset(session->vertices.velocity + 3 * (size_t)v, 0, 3 * sizeof(double));
		}
	cau_session_drop_frozen_grasps(session);
}

static void do_nothing(void *context)
{
	(void)context;
}

// Makes the first local step. In the tick's first substep, also removes the elements from the
// factor that were cut in the last ticks (section 7.2).
static cau_status begin_solve(cau_session *session, cau_error *error)
{
	cau_matrix_update *update = &session->update;
	const cau_alive *alive = &session->dissection.alive;
	session->solver.contact = session->contact.row_count ? &session->contact : NULL;
	if (session->substep.index) {
		cau_solver_begin(&session->solver, do_nothing, NULL);
		return CAU_OK;
	}
	cau_status status = cau_matrix_update_begin(update, alive, session->tick, error);
	cau_session_stage_end(session, CAU_STAGE_DISSECT);
	if (status)
		return status;
	cau_solver_begin(&session->solver, cau_matrix_update_take_out, update);
	cau_session_stage_end(session, CAU_STAGE_GLOBAL);
	status = cau_matrix_update_end(update, alive, session->tick, error);
	cau_session_stage_end(session, CAU_STAGE_DISSECT);
	return status;
}

// Largest number of rounds of a step, and of a step on the last attempt. Tissue that is pushed
// aside may meet the tool elsewhere. Then the step continues for one more round, with these
// contacts too. If tissue is still not held, the tick is solved again with a shorter motion of the
// tool. On the last attempt the tool does not move. More rounds are useful there, because a
// solution exists: the tissue was outside the tool. Tissue that is then still deep in the tool is
// handled in the next tick. Tissue beyond the tool loses its constraints and passes.
enum { MOST_ROUNDS = 2, LAST_ROUNDS = 8 };

static cau_status descend(cau_session *session, cau_error *error)
{
	cau_error refusal = {0};
	cau_status status = cau_solver_descend(&session->solver, &refusal);
	if (!status)
		return CAU_OK;
	cau_session_locate(session, &refusal);
	return cau_fail(error, status, NULL, "%s", refusal.reason);
}

// Solves the step in at most `rounds` rounds. Returns whether tools would pass tissue in the
// result, or the tissue diverged.
static bool hold(cau_session *session, int rounds, cau_status *status, cau_error *error)
{
	cau_step_solver *solver = &session->solver;
	*status = descend(session, error);
	for (int round = 0; !*status && cau_session_find_missed(session); round++) { // touch.c
		if (round == rounds)
			return true;
		solver->contact = &session->contact;
		solver->result.objective = cau_solver_evaluate(solver);
		*status = descend(session, error);
	}
	session->contact.crossing = !*status && cau_session_find_thrown(session);
	return session->contact.crossing;
}

static void begin_again(cau_session *session)
{
	cau_step_solver *solver = &session->solver;
	cau_session_begin_collide(session);
	cau_session_find_contacts(session);
	solver->contact = session->contact.row_count ? &session->contact : NULL;
	solver->result.objective = cau_solver_evaluate(solver);
}

// Whether a tool has open jaws. Tissue between open jaws cannot leave one jaw without entering the
// other, so the last, longer attempt is skipped.
static bool has_open_jaws(const cau_session *session)
{
	for (int32_t i = 0; i < session->tool_count; i++) {
		const cau_tool_state *tool = &session->tool[i].state;
		if (cau_tool_has_jaws(&tool->definition) && tool->jaw > 0)
			return true;
	}
	return false;
}

static cau_status solve(cau_session *session, cau_error *error)
{
	cau_step_solver *solver = &session->solver;
	cau_status status = CAU_OK;
	int rounds = MOST_ROUNDS;
	for (int attempt = 0; hold(session, rounds, &status, error); attempt++) {
		if (cau_session_hold_back(session, attempt)) { // proxy.c
			begin_again(session);
			bool last = attempt == CAU_ATTEMPTS - 1 && !has_open_jaws(session);
			rounds = last ? LAST_ROUNDS : MOST_ROUNDS;
			continue;
		}
		if (!session->contact.crossing)
			break;
		cau_session_let_through(session);
		solver->result.objective = cau_solver_evaluate(solver);
		cau_solver_displace(solver);
		break;
	}
	cau_session_let_follow(session); // proxy.c
	return status;
}

static void begin_tick(cau_session *session)
{
	CAU_ASSERT(!session->faulted, "tick %llu of a faulted session",
	           (unsigned long long)session->tick);
	size_t bytes = 3 * (size_t)session->tissue.vertex_count * sizeof(double);
	memcpy(session->vertices.start, session->vertices.position, bytes);
	memset(session->timing.stage_s, 0, sizeof session->timing.stage_s);
	session->queue.refusal_count = 0;
	cau_session_begin_substeps(session);
	cau_dissection_begin(&session->dissection);
}

static cau_status fault(cau_session *session, cau_status status)
{
	CAU_ASSERT(status != CAU_OK, "a fault without a reason at tick %llu",
	           (unsigned long long)session->tick);
	size_t bytes = 3 * (size_t)session->tissue.vertex_count * sizeof(double);
	memcpy(session->vertices.position, session->vertices.start, bytes);
	memset(session->vertices.velocity, 0, bytes);
	session->faulted = true;
	return status;
}

// Splits the solver's time into its local share, its contact share and the rest.
static void end_solve_stages(cau_session *session)
{
	cau_session_stage_end(session, CAU_STAGE_GLOBAL);
	session->timing.stage_s[CAU_STAGE_LOCAL] = session->solver.result.local_s;
	session->timing.stage_s[CAU_STAGE_CONTACT] = session->solver.result.contact_s;
	session->timing.stage_s[CAU_STAGE_GLOBAL] -=
		session->solver.result.local_s + session->solver.result.contact_s;
}

// Computes the tick's motion, in one or two substeps (motion.c).
static cau_status move(cau_session *session, cau_status status, cau_error *error)
{
	for (int32_t k = 0; k < session->substep.count; k++) {
		if (k) {
			cau_session_next_substep(session);
			cau_session_lead_tools_on(session); // tool_motion.c
		} else {
			cau_solver_take_strain(&session->solver, 1);
		}
		cau_session_predict(session);       // eq. 4: motion.c
		cau_session_lead_driven(session);   // pins.c
		cau_session_begin_collide(session); // meet.c
		cau_session_find_contacts(session); // touch.c
		cau_session_stage_end(session, CAU_STAGE_PREDICT);
		if (!status)
			status = begin_solve(session, error); // above; solve/matrix_update.c
		if (!status)
			status = solve(session, error); // eq. 6 and 7: solve/descend.c
		cau_session_stage_end(session, CAU_STAGE_GLOBAL);
		if (status)
			break;
	}
	cau_session_end_substeps(session);
	if (session->substep.index)
		cau_session_keep_tick_poses(session); // tool_motion.c
	return status;
}

// Makes one tick: calls every stage in order.
cau_status cau_session_step(cau_session *session, cau_error *error)
{
	if (session->faulted)
		return cau_fail(error, CAU_FAULTED, NULL, "the session is faulted: restore a snapshot");
	cau_status sound = check_sound(session, error);
	if (sound) {
		session->faulted = true; // the faulted session is not changed any more
		return sound;
	}
	if (cau_session_rests(session)) // rest.c
		return cau_session_rest_tick(session, error);
	cau_session_stage_begin(session);
	begin_tick(session);
	cau_status status = cau_session_apply_commands(session, error); // command.c
	cau_session_move_tools(session);                                // tool_motion.c
	cau_session_begin_energy(session);                              // energy.c
	cau_session_stage_end(session, CAU_STAGE_COMMANDS);
	status = move(session, status, error); // above
	if (!status)
		status = cau_session_check_motion(session, error); // possible.c
	if (status)
		return fault(session, status);
	cau_session_end_energy(session);                     // energy.c
	cau_session_update_velocities(session);              // eq. 2: motion.c
	cau_session_settle(session);                         // plasticity, section 5.2
	cau_session_follow_inversion(session);               // possible.c
	status = cau_session_check_inverted(session, error); // possible.c
	if (status)
		return fault(session, status);
	cau_session_read_forces(session); // touch.c
	end_solve_stages(session);
	cau_session_read_contact(session); // tool_contact.c
	cau_session_tear(session);         // burn.c
	if (session->heat.cells)
		cau_session_operate(session); // electrosurgery.c
	else
		cau_session_burn(session); // eq. 18-21: burn.c
	cau_session_end_burn(session);
	cau_session_stage_end(session, CAU_STAGE_HEAT);
	freeze_isolated(session);
	cau_session_stop_strays(session); // possible.c
	cau_session_stage_end(session, CAU_STAGE_DISSECT);
	cau_frame_update(&session->view.frame, &session->dissection, session->vertices.start,
	                 session->vertices.position); // frame/frame_state.c
	cau_session_bleed(session);                   // bleed.c
	cau_session_show_scalars(session);            // view.c
	cau_session_fall_asleep(session);             // rest.c
	cau_session_stage_end(session, CAU_STAGE_FRAME);
	session->tick++;
	return CAU_OK;
}
