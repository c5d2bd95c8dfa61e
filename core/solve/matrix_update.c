// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/matrix_update.h"

#include <math.h>
#include <string.h>

#include "cautery/assert.h"

// time, s, from the start of a new factor's computation to its use
static const double swap_after_s = 1.0 / 60.0;

enum { PER_UPDATE = CAU_UPDATE_RANK / 3 }; // elements that always fit in one update

static cau_status no_memory(cau_error *error)
{
	return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory to keep the factor in step with cuts");
}

static void copy_alive(uint8_t *const to[CAU_ELEMENT_KINDS], const cau_alive *alive,
                       const cau_tissue *tissue)
{
	for (int kind = 0; kind < CAU_ELEMENT_KINDS; kind++)
		memcpy(to[kind], alive->element[kind], (size_t)cau_tissue_element_count(tissue, kind));
}

static double least_mass_pivot(const cau_step_solver *solver)
{
	double least = INFINITY;
	for (int32_t r = 0; r < solver->system.row_count; r++)
		least = fmin(least, solver->tissue->mass[solver->system.vertex_of_row[r]]);
	return least / (2 * solver->inertia_s * solver->inertia_s);
}

cau_status cau_matrix_update_create(cau_matrix_update *update, cau_step_solver *solver,
                                    const cau_alive *alive, cau_arena *arena, cau_error *error)
{
	CAU_ASSERT(!update->background && !update->waiting_capacity, "made twice, with room for %d",
	           update->waiting_capacity);
	const cau_tissue *tissue = solver->tissue;
	update->solver = solver;
	bool missing = false;
	for (int kind = 0; kind < CAU_ELEMENT_KINDS; kind++) {
		size_t count = (size_t)cau_tissue_element_count(tissue, kind);
		update->canonical[kind] = cau_arena_array(arena, count, 1);
		update->next_canonical[kind] = cau_arena_array(arena, count, 1);
		missing |= !update->canonical[kind] || !update->next_canonical[kind];
		update->waiting_capacity += (int32_t)count;
	}
	update->waiting =
		cau_arena_array(arena, (size_t)update->waiting_capacity, sizeof *update->waiting);
	update->operation = cau_arena_array(arena, CAU_DOWNDATES_AT_MOST, sizeof *update->operation);
	if (missing || !update->waiting || !update->operation)
		return no_memory(error);
	copy_alive(update->canonical, alive, tissue);
	if (solver->settings.diagonal)
		return CAU_OK;
	update->least_pivot_bound = least_mass_pivot(solver);
	update->touched = cau_arena_array(arena, (size_t)solver->sweep.supernode_count, 1);
	update->background = cau_background_create();
	return update->touched && update->background ? CAU_OK : no_memory(error);
}

cau_status cau_matrix_update_adopt(cau_matrix_update *update, cau_error *error)
{
	if (!update->background)
		return CAU_OK;
	cau_background *own = cau_background_create();
	if (!own)
		return no_memory(error);
	cau_background_destroy(update->background); // waits for the old thread's work
	update->background = own;
	return CAU_OK;
}

void cau_matrix_update_finish(cau_matrix_update *update)
{
	cau_background_destroy(update->background);
	cau_sweep_finish_panels(&update->next_panels);
	update->background = NULL;
}

// Subtracts a removed element from the diagonal, which bounds drag in char. The diagonal never
// falls below the inertia.
static void take_off_diagonal(cau_step_solver *solver, int kind, int32_t element)
{
	cau_element_map map;
	cau_tissue_element_map(solver->tissue, kind, element, &map);
	double omega = map.weight * cau_element_map_scale(&map);
	CAU_ASSERT(omega >= 0, "element %d of kind %d adds %g N/m", element, kind, omega);
	for (int k = 0; k < map.vertex_count; k++) {
		int32_t v = map.vertex[k];
		double inertia = solver->tissue->mass[v] / (solver->inertia_s * solver->inertia_s);
		solver->system.diagonal[v] = fmax(solver->system.diagonal[v] - omega, inertia);
	}
}

void cau_matrix_update_remove(cau_matrix_update *update, int kind, int32_t element, uint64_t tick)
{
	CAU_ASSERT(update->waiting_count < update->waiting_capacity, "%d elements wait in room for %d",
	           update->waiting_count, update->waiting_capacity);
	CAU_ASSERT(!update->waiting_count || tick >= update->waiting[update->waiting_count - 1].tick,
	           "an element is removed for tick %llu, after one of tick %llu",
	           (unsigned long long)tick,
	           (unsigned long long)update->waiting[update->waiting_count - 1].tick);
	take_off_diagonal(update->solver, kind, element);
	update->waiting[update->waiting_count++] = (cau_waiting){kind, element, tick};
}

static void forget_waiting(cau_matrix_update *update, int32_t count, uint64_t tick)
{
	CAU_ASSERT(count >= 0 && count <= update->waiting_count, "%d of %d elements that wait", count,
	           update->waiting_count);
	CAU_ASSERT(!count || tick >= update->waiting[count - 1].tick, "tick %llu comes after tick %llu",
	           (unsigned long long)update->waiting[count ? count - 1 : 0].tick,
	           (unsigned long long)tick);
	for (int32_t k = 0; k < count; k++)
		if (tick - update->waiting[k].tick > update->longest_wait)
			update->longest_wait = tick - update->waiting[k].tick;
	update->waiting_count -= count;
	memmove(update->waiting, update->waiting + count,
	        (size_t)update->waiting_count * sizeof *update->waiting);
}

// ---- exact downdates

// Adds the columns of as many elements from `list` as one update of rank 8 holds. Returns their
// number.
static int32_t fill_update(const cau_matrix_update *update, const cau_waiting *list, int32_t count,
                           int32_t *columns, int32_t *first, int32_t *row, double *value)
{
	int32_t taken = 0;
	*columns = first[0] = 0;
	for (; taken < count; taken++) {
		cau_element_map map;
		cau_tissue_element_map(update->solver->tissue, list[taken].kind, list[taken].element, &map);
		CAU_ASSERT(map.rank >= 1 && map.rank <= CAU_UPDATE_RANK, "an element of rank %d", map.rank);
		if (*columns + map.rank > CAU_UPDATE_RANK)
			break;
		cau_system_columns(&update->solver->system, &map, columns, first, row, value);
	}
	CAU_ASSERT(taken > 0 && *columns <= CAU_UPDATE_RANK, "%d columns of %d elements", *columns,
	           taken);
	return taken;
}

static void mark_columns(cau_matrix_update *update, int32_t entries, const int32_t *row,
                         const int32_t *place_of_row)
{
	for (int32_t k = 0; k < entries; k++)
		cau_sweep_mark_path(&update->solver->sweep, place_of_row[row[k]], update->touched);
}

cau_status cau_matrix_update_downdate(cau_matrix_update *update, const cau_waiting *list,
                                      int32_t count, int32_t *taken, cau_error *error)
{
	CAU_ASSERT(count > 0, "%d elements to take out", count);
	CAU_ASSERT(!update->making, "the factor is being made for tick %llu",
	           (unsigned long long)update->swap_tick);
	int32_t first[CAU_UPDATE_RANK + 1], row[CAU_UPDATE_RANK * 8], columns;
	double value[CAU_UPDATE_RANK * 8];
	*taken = fill_update(update, list, count, &columns, first, row, value);
	if (!columns)
		return CAU_OK;
	cau_status status =
		cau_factor_update(update->solver->factor, columns, first, row, value, 0, error);
	if (!status)
		mark_columns(update, first[columns], row, cau_factor_places(update->solver->factor));
	return status;
}

double cau_matrix_update_pack(cau_matrix_update *update)
{
	CAU_ASSERT(!update->making, "the factor is being made for tick %llu",
	           (unsigned long long)update->swap_tick);
	const cau_step_solver *solver = update->solver;
	double least =
		cau_sweep_pack_touched(&solver->sweep, solver->factor, update->touched, solver->pool);
	update->solver->age.version++;
	return least;
}

static void note_operations(cau_matrix_update *update, const cau_waiting *list, int32_t count)
{
	CAU_ASSERT(update->operation_count + count <= CAU_DOWNDATES_AT_MOST,
	           "%d elements out, and %d more", update->operation_count, count);
	for (int32_t k = 0; k < count; k++)
		update->operation[update->operation_count++] =
			(cau_operation){list[k].kind, list[k].element, update->group_count};
	update->group_count++;
}

// Returns the number of updates for this tick. Normally half of the waiting elements are downdated,
// so that a tick that parts many elements shares the work with the next tick. If the oldest element
// has waited long enough, the tick does as many updates as it can.
static int updates_due(const cau_matrix_update *update, uint64_t tick)
{
	CAU_ASSERT(update->waiting_count > 0, "updates are due for %d elements", update->waiting_count);
	CAU_ASSERT(tick >= update->waiting[0].tick, "tick %llu, and the oldest waits since %llu",
	           (unsigned long long)tick, (unsigned long long)update->waiting[0].tick);
	int32_t half = (update->waiting_count + 1) / 2, due = (half + PER_UPDATE - 1) / PER_UPDATE;
	if (due > CAU_MOST_UPDATES || tick - update->waiting[0].tick >= CAU_WAITING_TICKS)
		return CAU_MOST_UPDATES;
	return due < CAU_LEAST_UPDATES ? CAU_LEAST_UPDATES : due;
}

// Does a few exact downdates, the oldest removal first.
void cau_matrix_update_take_out(void *context)
{
	cau_matrix_update *update = context;
	CAU_ASSERT(update->updates_due >= 0 && update->updates_due <= CAU_MOST_UPDATES,
	           "%d updates are due", update->updates_due);
	update->due_status = CAU_OK;
	update->done = 0;
	for (int i = 0; i < update->updates_due && update->done < update->waiting_count; i++) {
		const cau_waiting *list = update->waiting + update->done;
		int32_t taken = 0;
		update->due_status = cau_matrix_update_downdate(
			update, list, update->waiting_count - update->done, &taken, &update->due_error);
		if (update->due_status)
			return;
		note_operations(update, list, taken);
		update->done += taken;
	}
}

cau_status cau_matrix_update_end(cau_matrix_update *update, const cau_alive *alive, uint64_t tick,
                                 cau_error *error)
{
	if (!update->updates_due)
		return CAU_OK;
	if (update->due_status) {
		if (error)
			*error = update->due_error;
		return update->due_status;
	}
	CAU_ASSERT(update->done <= update->waiting_count, "%d taken out of %d", update->done,
	           update->waiting_count);
	forget_waiting(update, update->done, tick);
	update->updates_due = 0;
	if (!update->done || cau_matrix_update_pack(update) >= update->least_pivot_bound)
		return CAU_OK;
	return cau_matrix_update_refactor(update, alive, error);
}

// ---- a new factor in the background
static void make_next(void *context)
{
	cau_matrix_update *update = context;
	cau_step_solver *solver = update->solver;
	cau_alive alive;
	memcpy(alive.element, update->next_canonical, sizeof alive.element);
	const cau_matrix *matrix = &solver->system.matrix;
	cau_system_assemble(&solver->system, solver->tissue, &alive, solver->inertia_s, matrix->value);
	update->next_status = cau_factor_refactor(solver->factor, matrix, NULL);
	if (!update->next_status &&
	    (update->next_panels.panel ||
	     !cau_sweep_create_panels(&solver->sweep, &update->next_panels, NULL)))
		cau_sweep_pack_panels(&solver->sweep, &update->next_panels, solver->factor);
}

static void release_panels(void *context)
{
	cau_matrix_update *update = context;
	cau_sweep_finish_panels(&update->next_panels);
}

void cau_matrix_update_start(cau_matrix_update *update, uint64_t swap_tick)
{
	CAU_ASSERT(!update->making, "a factor is being made already, for tick %llu",
	           (unsigned long long)update->swap_tick);
	CAU_ASSERT(!update->solver->settings.diagonal && update->background,
	           "the diagonal system has no factor to make, for tick %llu",
	           (unsigned long long)swap_tick);
	cau_background_wait(update->background); // the thread may still release old panels
	update->making = true;
	update->swap_tick = swap_tick;
	cau_background_start(update->background, make_next, update);
}

static cau_status swap(cau_matrix_update *update, uint64_t tick, cau_error *error)
{
	CAU_ASSERT(update->making && tick >= update->swap_tick, "swapped at tick %llu instead of %llu",
	           (unsigned long long)tick, (unsigned long long)update->swap_tick);
	CAU_ASSERT(update->waiting_at_start <= update->waiting_count, "%d waited at the start, %d now",
	           update->waiting_at_start, update->waiting_count);
	cau_background_wait(update->background);
	update->making = false;
	if (update->next_status)
		return cau_fail(error, update->next_status, NULL, "the system could not be factored again");
	cau_step_solver *solver = update->solver;
	if (update->next_panels.panel)
		cau_sweep_swap_panels(&solver->sweep, &update->next_panels);
	else
		cau_sweep_pack(&solver->sweep, solver->factor);
	solver->age.version++;
	for (int kind = 0; kind < CAU_ELEMENT_KINDS; kind++) {
		uint8_t *canonical = update->canonical[kind];
		update->canonical[kind] = update->next_canonical[kind];
		update->next_canonical[kind] = canonical;
	}
	forget_waiting(update, update->waiting_at_start, tick);
	update->operation_count = update->group_count = 0;
	update->refactorisations++;
	return CAU_OK;
}

static uint64_t swap_delay(const cau_matrix_update *update)
{
	double ticks = swap_after_s / update->solver->step_s;
	CAU_ASSERT(ticks > 0 && ticks < 1e6, "a swap after %g ticks", ticks);
	return ticks < 1 ? 1 : (uint64_t)(ticks + 0.5);
}

// True if two ticks might not be enough to downdate all waiting elements.
static bool too_many(const cau_matrix_update *update)
{
	return update->waiting_count > 2 * CAU_MOST_UPDATES * PER_UPDATE;
}

static void advance_diagonal(cau_matrix_update *update, const cau_alive *alive)
{
	cau_step_solver *solver = update->solver;
	if (!update->waiting_count)
		return;
	cau_system_assemble_diagonal(&solver->system, solver->tissue, alive, solver->inertia_s);
	solver->age.version++;
	update->waiting_count = 0;
}

// Chooses how many of the waiting elements are downdated in this tick, or starts a new factor if
// there are too many.
static void serve(cau_matrix_update *update, const cau_alive *alive, uint64_t tick)
{
	CAU_ASSERT(!update->making && update->waiting_count > 0, "%d elements to serve",
	           update->waiting_count);
	bool worn = update->operation_count + update->waiting_count > CAU_DOWNDATES_AT_MOST;
	if (!too_many(update) && !worn) {
		update->updates_due = updates_due(update, tick);
		return;
	}
	update->waiting_at_start = update->waiting_count;
	copy_alive(update->next_canonical, alive, update->solver->tissue);
	cau_matrix_update_start(update, tick + swap_delay(update));
}

cau_status cau_matrix_update_begin(cau_matrix_update *update, const cau_alive *alive, uint64_t tick,
                                   cau_error *error)
{
	update->updates_due = 0;
	if (update->solver->settings.diagonal) {
		advance_diagonal(update, alive);
		return CAU_OK;
	}
	cau_status status = CAU_OK;
	bool due = update->making && tick >= update->swap_tick;
	if (due)
		status = swap(update, tick, error);
	if (!status && !update->making && update->waiting_count)
		serve(update, alive, tick);
	if (due && !update->making) // a new factor that has just been started needs the old panels
		cau_background_start(update->background, release_panels, update);
	return status;
}

void cau_matrix_update_await(const cau_matrix_update *update)
{
	if (update->background)
		cau_background_wait(update->background);
}

void cau_matrix_update_stop(cau_matrix_update *update)
{
	cau_matrix_update_await(update);
	cau_sweep_finish_panels(&update->next_panels);
	update->making = false;
}

cau_status cau_matrix_update_refactor(cau_matrix_update *update, const cau_alive *alive,
                                      cau_error *error)
{
	cau_step_solver *solver = update->solver;
	cau_matrix_update_stop(update);
	cau_system_assemble_diagonal(&solver->system, solver->tissue, alive, solver->inertia_s);
	update->waiting_count = update->operation_count = update->group_count = 0;
	copy_alive(update->canonical, alive, solver->tissue);
	solver->age.version++;
	solver->age.epoch++;
	if (solver->settings.diagonal)
		return CAU_OK;
	cau_system_assemble(&solver->system, solver->tissue, alive, solver->inertia_s,
	                    solver->system.matrix.value);
	cau_status status = cau_factor_refactor(solver->factor, &solver->system.matrix, error);
	if (!status)
		cau_sweep_pack(&solver->sweep, solver->factor);
	update->refactorisations++;
	return status;
}
