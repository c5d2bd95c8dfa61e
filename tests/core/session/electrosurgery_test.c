// SPDX-License-Identifier: GPL-3.0-or-later
// Energy `tissue`: a needle that cuts a taut sheet by its power, the energy ledger, the effect of
// energy off, and that all of this is part of the state.
#include "core/session/stage.h"

#include "session/session_internal.h"

enum { DWELL_TICKS = 60, DRAWN_TICKS = CAU_TEST_SANITIZED ? 30 : 120 };
static const double speed_m_s = 0.006, before_m = -0.012, under_m = -0.002;

static cau_scene_def *needle_over_sheet(double power_w)
{
	cau_scene_def *scene = stage_scene(CAU_PRECISION_SINGLE);
	scene->energy = CAU_ENERGY_TISSUE;
	scene->parting = CAU_PARTING_ELEMENTS;
	cau_layer_def *sheet = stage_add_sheet(scene, "fascia", 0.04, 0.024, 20, 12);
	sheet->sheet[0].target[0] = sheet->sheet[0].target[1] = 0.1;
	scene->pin_count = 1;
	cau_default_selection(&scene->pins[0], CAU_SELECT_RIM);
	cau_tool_def *needle = stage_add_tool(scene, "hook", CAU_TOOL_CAPSULE, before_m, 0, 1e-3);
	needle->hot_radius_m = needle->grid_step_m = 5e-4;
	needle->power_w = power_w;
	return scene;
}

// Presses the energized needle to `z_m`, holds it there for DWELL_TICKS, then draws it on.
static void go_at(cau_session *session, double z_m, int first, int end)
{
	for (int tick = first; tick < end; tick++) {
		double drawn = tick < DWELL_TICKS ? 0 : (tick - DWELL_TICKS) * speed_m_s / 60;
		if (tick == 0)
			stage_energize(session, "hook", 1);
		stage_move(session, "hook", before_m + drawn, 0, z_m);
		stage_step(session, 1);
	}
}

static void go(cau_session *session, int first, int end)
{
	go_at(session, under_m, first, end);
}

static cau_session *cut_with(double power_w, int32_t threads)
{
	cau_scene_def *scene = needle_over_sheet(power_w);
	cau_session *session = stage_open(scene, threads);
	go(session, 0, DWELL_TICKS + DRAWN_TICKS);
	free(scene);
	return session;
}

static int32_t parted(const cau_session *session)
{
	return stage_frame(session).statistics.elements_removed;
}

// The energy given equals the energy found. Both sums are independent; the stored heat is counted
// again.
static void assert_ledger_closes(const cau_session *session)
{
	cau_energy_ledger ledger;
	cau_session_read_ledger(session, &ledger);
	const cau_bioheat *bioheat = &session->heat.cells->bioheat;
	double stored = 0;
	for (int32_t i = 0; i < bioheat->cells.count; i++)
		stored += cau_bioheat_capacity(bioheat, i) * (bioheat->temperature[i] - bioheat->ambient_c);
	double found = stored + ledger.boiled_j + ledger.perfused_j + ledger.ambient_j + ledger.shed_j;
	assert_true(fabs(ledger.stored_j - stored) <= 1e-6 * ledger.delivered_j);
	assert_true(fabs(ledger.delivered_j + ledger.blade_j - found) <= 1e-6 * ledger.delivered_j);
}

// No more is cut than the power can boil: a part of the delivered energy left as steam.
static void thirty_watts_cut_at_the_hand_s_speed(void **state)
{
	(void)state;
	cau_session *session = cut_with(30, 1);
	const cau_tool_state *needle = stage_tool(session, "hook");
	double behind = before_m + (DRAWN_TICKS - 1) * speed_m_s / 60 - needle->pose.position_m[0];
	assert_true(parted(session) >= (CAU_TEST_SANITIZED ? 4 : 12));
	assert_true(fabs(behind) < 1e-3);
	assert_ledger_closes(session);
	cau_energy_ledger ledger;
	cau_session_read_ledger(session, &ledger);
	assert_true(ledger.delivered_j > 1 && ledger.delivered_j < 30 * 3.1);
	assert_true(ledger.boiled_j > 0.3 * ledger.delivered_j);
	cau_session_destroy(session);
}

// The cells at the lips of the cut belong to removed elements, and move with existing elements.
static void lips_move_with_what_is_left(void **state)
{
	(void)state;
	cau_session *session = cut_with(30, 1);
	const cau_tissue_cells *cells = session->heat.cells;
	const cau_tissue *tissue = &session->tissue;
	const uint8_t *alive = session->dissection.alive.element[CAU_ELEMENT_TRIANGLE];
	int32_t lips = 0;
	for (int32_t i = 0; i < cells->bioheat.cells.count; i++) {
		if (cells->bioheat.cells.severed[i])
			continue;
		assert_true(cells->owner[i] < tissue->triangle_count && alive[cells->owner[i]]);
		const float *local = cells->local + cau_cell_axis(i, 0);
		lips += local[0] < -0.3F || local[1] < -0.3F || local[0] + local[1] > 1.3F;
	}
	assert_true(parted(session) > 0 && lips > 0);
	assert_true(cau_session_vaporised(session) > 0);
	cau_session_destroy(session);
}

// Tissue that one watt does not part holds the needle up: at rest 2 mm deep, and drawn 1 mm deep. A
// needle that is drawn deeper may pass through whole faces of this mesh (.github/KNOWN_BUGS.md).
static void one_watt_holds_the_needle_up(void **state)
{
	(void)state;
	const double depth_m[] = {2e-3, 1e-3};
	const int end[] = {DWELL_TICKS, DWELL_TICKS + DRAWN_TICKS};
	for (int i = 0; i < 2; i++) {
		cau_scene_def *scene = needle_over_sheet(1);
		cau_session *session = stage_open(scene, 1);
		go_at(session, -depth_m[i], 0, end[i]);
		assert_int_equal(parted(session), 0);
		assert_true(stage_tool(session, "hook")->raw_force_n[2] > 0);
		assert_ledger_closes(session);
		cau_session_destroy(session);
		free(scene);
	}
}

// Energy off ends the power in the same tick. Stored heat spreads further; then everything cools
// down and rests.
static void off_ends_the_power_and_not_the_heat(void **state)
{
	(void)state;
	cau_session *session = cut_with(30, 1);
	cau_energy_ledger before, after;
	stage_energize(session, "hook", 0);
	cau_session_read_ledger(session, &before);
	stage_step(session, 60);
	cau_session_read_ledger(session, &after);
	assert_true(after.delivered_j == before.delivered_j);
	assert_true(stage_tool(session, "hook")->delivered_w == 0);
	assert_true(after.stored_j > 0);
	// The tissue beside the cut is dead: less than a sheet of 0.5 mm thickness has under 4 mm
	// around the path.
	double dead_m3 = cau_session_coagulated(session);
	assert_true(dead_m3 > 1e-10 && dead_m3 < 5e-4 * 4e-3 * 0.04);
	assert_ledger_closes(session);
	cau_session_destroy(session);
}

// The sum of the rate of vapour agrees with the energy that it carried away. No vapour leaves at
// rest.
static void vapour_adds_up_to_what_has_boiled(void **state)
{
	(void)state;
	cau_scene_def *scene = needle_over_sheet(30);
	cau_session *session = stage_open(scene, 1);
	double mass_kg = 0, j_kg = 2.257e6 + 4186 * (100 - scene->ambient_c);
	assert_true(cau_session_vapour(session) == 0);
	for (int tick = 0; tick < DWELL_TICKS + DRAWN_TICKS; tick++) {
		go(session, tick, tick + 1);
		mass_kg += cau_session_vapour(session) / 60;
	}
	cau_energy_ledger ledger;
	cau_session_read_ledger(session, &ledger);
	assert_true(ledger.boiled_j > 1);
	assert_true(fabs(mass_kg * j_kg - ledger.boiled_j) <= 1e-9 * ledger.boiled_j);
	stage_energize(session, "hook", 0);
	stage_step(session, 120);
	assert_true(cau_session_vapour(session) == 0);
	cau_session_destroy(session);
	free(scene);
}

static void threads_and_a_restore_change_no_bit(void **state)
{
	(void)state;
	cau_session *session = cut_with(30, 1), *threaded = cut_with(30, 2);
	assert_true(cau_session_hash(session) == cau_session_hash(threaded));
	stage_bytes bytes = stage_snapshot(session);
	cau_scene_def *scene = needle_over_sheet(30);
	cau_session *restored = stage_open(scene, 1);
	bool exact = false;
	assert_int_equal(cau_session_restore(restored, bytes.bytes, bytes.count, &exact, NULL), CAU_OK);
	assert_true(exact);
	assert_true(cau_session_hash(restored) == cau_session_hash(session));
	int end = DWELL_TICKS + DRAWN_TICKS;
	go(session, end, end + 20);
	go(restored, end, end + 20);
	assert_true(cau_session_hash(restored) == cau_session_hash(session));
	assert_ledger_closes(restored);
	free(bytes.bytes);
	free(scene);
	cau_session_destroy(session);
	cau_session_destroy(threaded);
	cau_session_destroy(restored);
}

// Below 200 V there are no sparks: tissue coagulates, and does not part. The temperature channel
// shows the heat, and ambient temperature far away.
static void soft_coagulation_heats_and_parts_nothing(void **state)
{
	(void)state;
	cau_scene_def *scene = needle_over_sheet(30);
	scene->tools[0].peak_v = 150;
	cau_session *session = stage_open(scene, 1);
	cau_session_watch(session, CAU_CHANNEL_TEMPERATURE);
	go(session, 0, DWELL_TICKS);
	cau_frame frame = stage_frame(session);
	float most = 0, least = 1000, damage = 0;
	for (int32_t v = 0; v < session->tissue.vertex_count; v++) {
		most = fmaxf(most, frame.temperature[v]);
		least = fminf(least, frame.temperature[v]);
	}
	for (int32_t i = 0; i < session->heat.cells->bioheat.cells.count; i++)
		damage = fmaxf(damage, (float)session->heat.cells->bioheat.damage[i]);
	assert_true(most > 60 && most <= 101);
	assert_true(least == 37);
	assert_true(damage > 1);
	assert_int_equal(parted(session), 0);
	free(scene);
	cau_session_destroy(session);
}

// Coagulated tissue shrinks by its layer's S; fresh tissue does not.
static void coagulated_tissue_shrinks(void **state)
{
	(void)state;
	static const double SQUARED = 0.67;
	cau_scene_def *scene = needle_over_sheet(30);
	scene->tools[0].peak_v = 150;
	scene->layers[0].sheet[0].target[0] = scene->layers[0].sheet[0].target[1] = 1;
	scene->layers[0].sheet[0].shrink[0] = scene->layers[0].sheet[0].shrink[1] = SQUARED;
	cau_session *session = stage_open(scene, 1);
	go(session, 0, DWELL_TICKS);
	stage_energize(session, "hook", 0);
	// Each element is visited within 60 ticks, and shrinks for 12 ticks (0.2 s).
	stage_step(session, 60 + 12);
	int32_t shrunk = 0;
	for (int32_t t = 0; t < session->tissue.triangle_count; t++) {
		double root[6], share = cau_dissection_coagulated(&session->dissection, 0, t);
		cau_elements_target(&session->solver.elements, &session->solver.slots, 0, t, root);
		assert_int_equal(session->shrink.shrunk[0][t], share >= 0.5);
		if (share >= 0.5)
			assert_true(fabs(root[0] - sqrt(SQUARED)) < 1e-6 && fabs(root[2]) < 1e-6);
		shrunk += share >= 0.5;
	}
	assert_true(shrunk > 0 && shrunk < session->tissue.triangle_count / 4);
	free(scene);
	cau_session_destroy(session);
}

// The cells of a sheet keep the thickness with which the sheet was created, even if a command
// changes the thickness later.
static void a_changed_thickness_is_restored(void **state)
{
	(void)state;
	cau_scene_def *scene = needle_over_sheet(30);
	cau_session *session = stage_open(scene, 1), *restored = stage_open(scene, 1);
	cau_command thicker = stage_command(CAU_COMMAND_SET_MATERIAL);
	thicker.as.material.kind = CAU_LAYER_FASCIA;
	thicker.as.material.sheet = scene->layers[0].sheet[0];
	thicker.as.material.sheet.thickness_m = 1.3e-3;
	stage_submit(session, &thicker);
	go(session, 0, 20);
	stage_bytes bytes = stage_snapshot(session);
	assert_int_equal(cau_session_restore(restored, bytes.bytes, bytes.count, NULL, NULL), CAU_OK);
	assert_true(cau_session_hash(restored) == cau_session_hash(session));
	assert_int_equal(cau_session_restore(session, bytes.bytes, bytes.count, NULL, NULL), CAU_OK);
	assert_true(cau_session_hash(restored) == cau_session_hash(session));
	free(bytes.bytes);
	free(scene);
	cau_session_destroy(session);
	cau_session_destroy(restored);
}

// Returns a session in which an instrument's closed jaws hold the sheet's edge and were energized
// for a second.
static cau_session *clamped(int shape)
{
	cau_scene_def *scene = needle_over_sheet(10);
	scene->tools[0].shape = shape;
	scene->tools[0].grid_step_m = 2e-4; // the jaws are thin
	scene->tools[0].peak_v = 190;
	scene->tools[0].pose = (cau_pose){.position_m = {0, 0, -2e-3}, .rotation = {1, 0, 0, 0}};
	cau_session *session = stage_open(scene, 1);
	stage_energize(session, "hook", 1);
	stage_step(session, 60);
	free(scene);
	return session;
}

// Current flows from jaw to jaw, and none leaves through the body.
static void bipolar_jaws_heat_what_lies_between(void **state)
{
	(void)state;
	cau_session *session = clamped(CAU_TOOL_BIPOLAR);
	cau_energy_ledger ledger;
	cau_session_read_ledger(session, &ledger);
	assert_true(ledger.delivered_j > 0.1);
	assert_true(ledger.far_j == 0);
	assert_int_equal(parted(session), 0);
	assert_ledger_closes(session);
	cau_session_destroy(session);
}

// Friction warms the blade, and the blade warms the tissue. There is no current.
static void a_rubbing_blade_heats_tissue(void **state)
{
	(void)state;
	cau_session *session = clamped(CAU_TOOL_SHEARS);
	cau_energy_ledger ledger;
	cau_session_read_ledger(session, &ledger);
	assert_true(stage_tool(session, "hook")->tip_temperature_c > 45);
	assert_true(ledger.blade_j > 0);
	assert_true(ledger.delivered_j == 0 && ledger.far_j == 0);
	cau_session_destroy(session);
}

static int32_t living_links(const cau_session *session)
{
	int32_t count = 0;
	for (int32_t l = 0; l < session->tissue.link_count; l++)
		count += session->dissection.alive.element[CAU_ELEMENT_LINK][l];
	return count;
}

// y of the ball's path, m. The links of the fascia's middle row (y = 0) lead to vertices of the fat
// at y = -3 mm. The ball passes half way between.
static const double half_way_m = -1.5e-3;

static void draw_between_layers(cau_session *session, int first, int end)
{
	for (int tick = first; tick < end; tick++) {
		stage_move(session, "hook", before_m + tick * speed_m_s / 60, half_way_m, 1e-3);
		stage_step(session, 1);
	}
}

// A ball is drawn between fascia and fat. Current flows through the links, and they part. The
// links' cells are part of the state.
static void power_parts_links(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_layered();
	scene->energy = CAU_ENERGY_TISSUE;
	scene->parting = CAU_PARTING_ELEMENTS;
	scene->cell_m = 5e-4; // elements of the fat are 6 mm large and would use up all cells
	scene->tools[0].shape = CAU_TOOL_SPHERE;
	scene->tools[0].hot_radius_m = scene->tools[0].grid_step_m = 4e-4;
	scene->tools[0].power_w = 30;
	cau_session *session = stage_open(scene, 1), *other = stage_open(scene, 2);
	int32_t links = living_links(session);
	stage_move(session, "hook", before_m, half_way_m, 1e-3);
	stage_step(session, 30);
	stage_energize(session, "hook", 1);
	draw_between_layers(session, 0, 60);
	stage_bytes bytes = stage_snapshot(session);
	assert_int_equal(cau_session_restore(other, bytes.bytes, bytes.count, NULL, NULL), CAU_OK);
	free(bytes.bytes);
	draw_between_layers(session, 60, 200);
	draw_between_layers(other, 60, 200);
	assert_true(cau_session_hash(session) == cau_session_hash(other));
	assert_in_range(living_links(session), 1, links - 3);
	cau_energy_ledger ledger;
	cau_session_read_ledger(session, &ledger);
	assert_true(ledger.far_j > 0);
	assert_ledger_closes(session);
	cau_session_destroy(session);
	cau_session_destroy(other);
	free(scene);
}

// A ball coagulates at one point for a minute. Its heat spreads to tissue 6 mm away, where no tool
// has been.
static void heat_goes_on_beyond_the_tool(void **state)
{
	(void)state;
	cau_scene_def *scene = stage_scene(CAU_PRECISION_SINGLE);
	scene->energy = CAU_ENERGY_TISSUE;
	scene->parting = CAU_PARTING_ELEMENTS;
	scene->cell_m = 1e-3;
	scene->step_s = 1.0 / 30;
	cau_layer_def *liver =
		stage_add_slab(scene, "liver", (double[]){0.032, 0.032, 0.012}, (int32_t[]){16, 16, 6});
	liver->tissue = CAU_LIVING_LIVER;
	liver->perfusion = 0;
	stage_pin_box(scene, (double[]){-0.02, -0.02, -0.013}, (double[]){0.02, 0.02, -0.011});
	cau_tool_def *ball = stage_add_tool(scene, "hook", CAU_TOOL_SPHERE, 0, 0, 1e-3);
	ball->hot_radius_m = 2e-3;
	ball->power_w = 4;
	ball->peak_v = 60;
	cau_session *session = stage_open(scene, 1);
	int32_t far = 0; // the vertex nearest to (8 mm, 0, 0)
	for (int32_t v = 0; v < session->tissue.vertex_count; v++) {
		const double *rest = session->tissue.rest + 3 * (size_t)v;
		const double *best = session->tissue.rest + 3 * (size_t)far;
		if (hypot(hypot(rest[0] - 8e-3, rest[1]), rest[2]) <
		    hypot(hypot(best[0] - 8e-3, best[1]), best[2]))
			far = v;
	}
	stage_energize(session, "hook", 1);
	stage_step(session, 30);
	assert_true(cau_tissue_cells_temperature(session->heat.cells, far) == scene->ambient_c);
	stage_step(session, CAU_TEST_SANITIZED ? 900 : 1800);
	assert_true(cau_tissue_cells_temperature(session->heat.cells, far) > scene->ambient_c + 0.5);
	assert_int_equal(parted(session), 0);
	assert_ledger_closes(session);
	cau_session_destroy(session);
	free(scene);
}

static void edges_cannot_part_by_power(void **state)
{
	(void)state;
	cau_error error = {0};
	cau_scene_def *scene = needle_over_sheet(30);
	scene->parting = CAU_PARTING_EDGES;
	stage_refuse(scene, CAU_BAD_VALUE, &error);
	assert_string_equal(error.path, "parting");
	free(scene);
}

// If the definition has no numbers for the blade, the blade has the numbers of the tool's shape, to
// the bit.
static void the_same_blade_by_numbers_changes_no_bit(void **state)
{
	(void)state;
	cau_scene_def *scene = needle_over_sheet(30);
	cau_session *silent = stage_open(scene, 1);
	scene->tools[0].blade_heat_j_k = 0.05;
	scene->tools[0].blade_cooling_w_k = 2e-3;
	cau_session *said = stage_open(scene, 1);
	scene->tools[0].blade_heat_j_k = 0.5;
	cau_session *heavy = stage_open(scene, 1);
	go(silent, 0, DWELL_TICKS);
	go(said, 0, DWELL_TICKS);
	go(heavy, 0, DWELL_TICKS);
	double tip_c = stage_tool(silent, "hook")->tip_temperature_c;
	assert_true(tip_c == stage_tool(said, "hook")->tip_temperature_c);
	assert_true(cau_session_hash(silent) == cau_session_hash(said));
	// The tissue is much warmer than both blades, so both take up about the same heat.
	double rise = tip_c - 37, heavy_rise = stage_tool(heavy, "hook")->tip_temperature_c - 37;
	assert_true(rise > 0.1 && heavy_rise > rise / 20 && heavy_rise < rise / 5);
	cau_session_destroy(silent);
	cau_session_destroy(said);
	cau_session_destroy(heavy);
	free(scene);
}

// A new setting of the blade keeps the blade's temperature.
static void a_new_blade_is_as_warm(void **state)
{
	(void)state;
	cau_session *session = cut_with(30, 1);
	stage_energize(session, "hook", 0);
	double before_c = stage_tool(session, "hook")->tip_temperature_c;
	cau_command lighter = stage_command(CAU_COMMAND_TOOL_CONFIGURE);
	strcpy(lighter.tool, "hook");
	lighter.as.definition = stage_tool(session, "hook")->definition;
	lighter.as.definition.blade_heat_j_k = 0.4;
	lighter.as.definition.blade_cooling_w_k = 0.04;
	stage_submit(session, &lighter);
	stage_step(session, 1);
	assert_true(fabs(stage_tool(session, "hook")->tip_temperature_c - before_c) < 1);
	assert_true(session->tool[0].blade.heat_capacity_j_k == 0.4);
	assert_true(session->tool[0].blade.cooling_w_k == 0.04);
	cau_session_destroy(session);
}

static void blades_that_no_step_can_follow_are_refused(void **state)
{
	(void)state;
	static const struct {
		double heat_j_k, rise;
		const char *path;
	} rows[] = {{0.005, 0, "tools[0].blade_heat_j_k"},
	            {0, 0.5, "tools[0].load_rise_off"},
	            {0, 1, "tools[0].load_rise_off"}};
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
		cau_error error = {0};
		cau_scene_def *scene = needle_over_sheet(30);
		scene->tools[0].blade_heat_j_k = rows[i].heat_j_k;
		scene->tools[0].load_rise_off = rows[i].rise;
		stage_refuse(scene, CAU_BAD_VALUE, &error);
		assert_string_equal(error.path, rows[i].path);
		free(scene);
	}
}

enum { SEAL_TICKS_MOST = 600 };

static cau_session *sealing(double rise)
{
	cau_scene_def *scene = needle_over_sheet(10);
	scene->tools[0].shape = CAU_TOOL_BIPOLAR;
	scene->tools[0].grid_step_m = 2e-4;
	scene->tools[0].peak_v = 190;
	scene->tools[0].load_rise_off = rise;
	scene->tools[0].pose = (cau_pose){.position_m = {0, 0, -2e-3}, .rotation = {1, 0, 0, 0}};
	cau_session *session = stage_open(scene, 1);
	stage_energize(session, "hook", 1);
	free(scene);
	return session;
}

// Steps until no power is given. Returns the number of ticks with power; gives the least and the
// last load.
static int seal(cau_session *session, double *least_ohm, double *last_ohm)
{
	int ticks = 0;
	for (stage_step(session, 1); ticks < SEAL_TICKS_MOST; ticks++, stage_step(session, 1)) {
		const cau_tool_state *jaws = stage_tool(session, "hook");
		if (jaws->delivered_w <= 0)
			return ticks;
		*last_ohm = jaws->load_ohm;
		*least_ohm = ticks ? fmin(*least_ohm, *last_ohm) : *last_ohm;
	}
	return ticks;
}

// Advanced bipolar: the power ends when the load has risen, and stays off until energy goes off and
// on again. This is part of the state.
static void power_ends_when_the_load_has_risen(void **state)
{
	(void)state;
	double least = 0, last = 0, other_least = 0, other_last = 0;
	cau_session *session = sealing(4), *other = sealing(4);
	stage_step(session, 10);
	stage_bytes bytes = stage_snapshot(session);
	assert_int_equal(cau_session_restore(other, bytes.bytes, bytes.count, NULL, NULL), CAU_OK);
	free(bytes.bytes);
	int ticks = seal(session, &least, &last);
	assert_in_range(ticks, 1, SEAL_TICKS_MOST - 1);
	assert_true(last >= 4 * least && stage_tool(session, "hook")->energized);
	assert_int_equal(seal(other, &other_least, &other_last), ticks);
	assert_true(cau_session_hash(session) == cau_session_hash(other));
	stage_step(session, 30);
	assert_true(stage_tool(session, "hook")->delivered_w == 0);
	// Energy is on already, so this command does not end and restart it.
	stage_energize(session, "hook", 1);
	stage_step(session, 1);
	assert_true(stage_tool(session, "hook")->delivered_w == 0);
	stage_energize(session, "hook", 0);
	stage_energize(session, "hook", 1);
	stage_step(session, 1);
	assert_true(stage_tool(session, "hook")->delivered_w > 0);
	cau_session_destroy(session);
	cau_session_destroy(other);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(thirty_watts_cut_at_the_hand_s_speed),
		cmocka_unit_test(lips_move_with_what_is_left),
		cmocka_unit_test(one_watt_holds_the_needle_up),
		cmocka_unit_test(off_ends_the_power_and_not_the_heat),
		cmocka_unit_test(vapour_adds_up_to_what_has_boiled),
		cmocka_unit_test(threads_and_a_restore_change_no_bit),
		cmocka_unit_test(heat_goes_on_beyond_the_tool),
		cmocka_unit_test(soft_coagulation_heats_and_parts_nothing),
		cmocka_unit_test(coagulated_tissue_shrinks),
		cmocka_unit_test(a_changed_thickness_is_restored),
		cmocka_unit_test(bipolar_jaws_heat_what_lies_between),
		cmocka_unit_test(a_rubbing_blade_heats_tissue),
		cmocka_unit_test(the_same_blade_by_numbers_changes_no_bit),
		cmocka_unit_test(a_new_blade_is_as_warm),
		cmocka_unit_test(blades_that_no_step_can_follow_are_refused),
		cmocka_unit_test(power_ends_when_the_load_has_risen),
		cmocka_unit_test(power_parts_links),
		cmocka_unit_test(edges_cannot_part_by_power),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
