# SPDX-License-Identifier: GPL-3.0-or-later
"""Validation: which test holds which number, to what. `run_test.py` looks whether each is there."""

QUICK = "tests/paper/expected.json"  # of the test paper_quick; a figure of it, or the beginning of some

# What, to what it is held, and by which tests: a file and a function in it.
HELD = (
    ("block, cantilever, twisted beam against the stored references", "0.1 %",
     (("tests/core/session/equilibrium_test.c", "a_pulled_block"), ("tests/core/session/equilibrium_test.c", "a_cantilever"),
      ("tests/core/session/equilibrium_test.c", "a_twisted_beam"), (QUICK, "elements."))),
    ("indentation against the stored references", "1 %", (("tests/core/session/equilibrium_test.c", "an_indentation"), (QUICK, "elements.indentation"))),
    ("heat against the Gaussian, by cells", "1 % at 1 mm, a quarter at 0.5 mm",
     (("tests/core/heat/heat_grid_test.c", "test_gaussian"), (QUICK, "heat.gaussian"))),
    ("heat about a ball at rest, with cells of a sixth of the ball's radius, after 1 to 600 s and in the steady state", "2 % of tool minus ambient",
     (("tests/core/heat/heat_surface_test.c", "test_around_a_ball"),
      ("tests/core/heat/heat_surface_test.c", "test_steady_around_a_ball"), (QUICK, "heat.ball"))),
    ("heat about a ball at rest after 0.1 s, where cells of a sixth have an error above 2 %: with cells of a twelfth", "2 %, and a third of the error with cells of a sixth",
     (("tests/core/heat/heat_surface_test.c", "test_soon_after_the_beginning"),)),
    ("heat about a ball that moves at 5, 10, 20 mm/s, with cells of a sixth, up to one radius from the ball's surface", "2 %, rms",
     (("tests/core/heat/heat_surface_test.c", "test_a_moving_ball"),)),
    ("heat about a ball that moves at 50 mm/s, over a cube of 14 mm (up to one radius from the ball's surface the error is 3.4 %)", "2 %, rms",
     (("tests/core/heat/heat_surface_test.c", "test_a_moving_ball"),)),
    ("momentum of a free body", "1e-9",
     (("tests/core/session/balance_test.c", "a_free_body_keeps_its_momentum"), (QUICK, "conservation.momentum"))),
    ("angular momentum and energy of a spinning block", "3 % and 1 % in the page's flight",
     (("tests/core/session/spin_test.c", "a_free_block_turns_as_a_rigid_one"),
      ("tests/core/session/spin_test.c", "it_goes_on_for_long"), (QUICK, "conservation."))),
    ("energy without a source", "none",
     (("tests/core/session/energy_test.c", "rest_reads_nothing"), (QUICK, "conservation.swing.gained"))),
    ("strain limits: the allowed strain and the largest strain", "0.3 % of strain about figure 4's, 0.1 % at one load",
     ((QUICK, "figure_4."), (QUICK, "loads."))),
    ("true error of steps that end at the scene's accuracy: fascia, fat, fat-neohookean, layers", "1 %, 95 of 100",
     (("tests/core/session/accuracy_test.c", "a_taut_sheet_is_right"), ("tests/core/session/accuracy_test.c", "fat_is_right"),
      (QUICK, "errors."))),
    ("true error of steps of a free sheet by Newton's method", "1 %, 95 of 100",
     (("tests/core/session/free_sheet_test.c", "a_hanging_sheet_is_right"), (QUICK, "errors.hanging"))),
    ("volume of a cut of 40 mm by elements, mean of eight paths, between meshes", "15 % at 1 to 2 x the cells, 30 % at 0.5 x",
     (("tests/core/session/cut_by_mesh_test.c", "half_the_cells_take_as_much"),
      ("tests/core/session/cut_by_mesh_test.c", "finer_cells_take_as_much"),
      ("tests/core/dissect/doses_test.c", "what_a_cut_takes_is_not_the_meshs"))),
    ("volume of a cut of 40 mm by elements, with other steps and iterations", "10 %",
     (("tests/core/session/cut_by_mesh_test.c", "steps_and_iterations_take_as_much"),)),
    ("`layers` and scenes of mesh files part by elements, the paper's by edges", "as said",
     (("tests/core/session/cut_by_mesh_test.c", "scenes_have_their_rule"),
      ("tests/server/sim/mesh_scene_test.c", "a_scene_is_made_around_the_mesh"), (QUICK, "parting."))),
    ("a ball's force against the solution of the same mesh, and this solution against the stored references", "1 % and 1e-5",
     (("tests/core/session/force_test.c", "it_is_the_solution_of_the_same_mesh"),
      ("tests/reference/indented_test.c", "it_is_the_finite_element_packages"), (QUICK, "contact.off_the_solution"))),
    ("a ball's force over meshes of four or more cells a patch, and on the finest mesh against Hertz; finer meshes in `core_session_force_long`", "10 %",
     (("tests/core/session/force_test.c", "it_hardly_depends_on_the_mesh_and_is_hertzs"),
      ("tests/core/session/force_test.c", "nor_on_finer_meshes"), (QUICK, "contact.over_meshes"), (QUICK, "contact.off_hertz"))),
    ("change of a ball's force as the ball slides over cells", "3 % at four cells a patch, 10 % at two",
     (("tests/core/session/force_test.c", "sliding_over_four_cells_it_hardly_changes"),
      ("tests/core/session/force_test.c", "over_two_cells_it_changes_little"), (QUICK, "contact.sliding."))),
    ("vertices inside a ball that is drawn at 2 cm/s; at rest", "0.02 mm; 0.001 mm",
     (("tests/core/session/touch_test.c", "nothing_is_inside_a_cold_tool"), (QUICK, "contact.vertices_inside"))),
    ("faces inside a ball at rest", "0.1 mm",
     (("tests/core/session/proxy_matrix_test.c", "nothing_crosses"), ("tests/core/session/crossing_test.c", "nothing_crosses"),
      (QUICK, "contact.faces_inside"))),
    ("no tool crosses in the presses: a ninth of the presses in each run, all 280 in `core_session_proxy_matrix_all` (long)", "none",
     (("tests/core/session/proxy_matrix_test.c", "nothing_crosses"), ("tests/core/session/crossing_test.c", "nothing_crosses"),
      ("tests/core/session/crossing_test.c", "what_a_tick_takes_past_a_face_is_held_too"), (QUICK, "contact.crossed"))),
    ("tissue that cannot yield stops a tool, which pushes with `force_max_n` at most", "as said",
     (("tests/core/session/proxy_test.c", "tissue_that_cannot_yield_stops_it"),
      ("tests/core/session/proxy_test.c", "it_pushes_with_what_it_has"))),
    ("tissue against tissue crosses nowhere; 10,000 motions of tools in `core_session_self_contact_long`", "none, no energy gained",
     (("tests/core/session/self_contact_test.c", "lips_that_are_pushed_together_never_cross"),
      ("tests/core/session/self_contact_test.c", "a_flap_that_is_laid_back_stays"),
      ("tests/core/session/self_contact_test.c", "a_hanging_sheet_folds_and_never_crosses"),
      ("tests/core/session/self_contact_test.c", "many_motions_of_tools"))),
    ("VTU has temperature, exposure, stress, tools", "their values",
     (("tests/server/sim/vtu_writer_test.c", "files_tell_scalars_and_tools"),)),
    ("CSV has energies, forces, stage times", "their values",
     (("tests/server/sim/program_test.c", "ticks_tell_energies_and_times"),
      ("tests/server/sim/program_test.c", "ticks_tell_forces"))),
    ("ignition after 2.35 s and 1.44 s", "a tick in scenes",
     (("tests/core/session/burn_test.c", "fascia_parts_after_2_35_s"), ("tests/core/session/burn_test.c", "fat_parts_after_1_44_s"),
      (QUICK, "ignition."))),
)


def named(test):
    path, name = test
    return f"`{name}`" if path == QUICK else f"`{name}` in [{path.split('/')[-1]}](../../{path})"


def table():
    """The section, without figures of a run: what it says is in the tests."""
    rows = [f"| {what} | {to} | {', '.join(named(test) for test in tests)} |" for what, to, tests in HELD]
    return f"""## What tests hold

A change that makes one of these results worse fails a test. The column "by" names the tests. Names without a file are
figures of `expected.json`, or the beginnings of such figures' names; the test `paper_quick` checks them. Three kinds of
results have no test. The first kind is the errors of free sheets with the scenes' own steps (in the tables above). The
second kind is all times, among them the cost of a drawn tool. The third kind is strains beyond a limit at loads that
`paper_quick` does not compute.

| what | to | by |
|---|---|---|
{chr(10).join(rows)}
"""
