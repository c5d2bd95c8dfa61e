# SPDX-License-Identifier: GPL-3.0-or-later
"""Takes out each rule of a session's decisions, one at a time, and sees the property test fail.

Usage: mutants.py SOURCE_FOLDER COMPILER
A mutant is a piece of the source and what stands in its place. One that the test lets pass, or whose
piece is not in the source any more, is a failure of this test.
"""

import os
import subprocess
import sys
import tempfile

ROOM = "server/session"
SEQUENCES = "400000"  # the rarest of these is found within a tenth of them

MUTANTS = (
    ("an enable takes back a cut", "drive.c",
     "\tif (!drives || !counts(drive, order))\n", "\tif (!drives)\n"),
    ("an enable that a cut has overtaken is taken and enables", "drive.c",
     "\treturn !order->cut_moment && order->moment > drive->cut_moment;",
     "\treturn !order->cut_moment;"),
    ("looking away does not reach what waits", "logic.c",
     "\t\tcau_drive_cut_client(logic, event->client, cause, effects);\n\t\tcau_queue_cut(logic, event->client);",
     "\t\tcau_drive_cut_client(logic, event->client, cause, effects);"),
    ("looking away does not switch off", "logic.c",
     "\t\tcau_drive_cut_client(logic, event->client, cause, effects);", ""),
    ("the watchdog sees no silence", "drive.c",
     " : silent_from_s(drive) <= now_s;", " : false && now_s > 0;"),
    ("a silent driver enables", "drive.c",
     "\tif (!by_ticks && alive_s + drive->driver.deadline_s <= logic->now_s)", "\tif (false && by_ticks)"),
    ("a stranger enables", "drive.c",
     "\t\treturn drives ? allows_enable(logic, drive, order, action) : refuse_stranger(drive, action);",
     "\t\treturn allows_enable(logic, drive, order, action);"),
    ("anybody takes over", "drive.c",
     "asked->asker.role == CAU_ROLE_ADMIN)\n\t\treturn true;", "true)\n\t\treturn true;"),
    ("a tool is removed with its energy on", "logic.c", "\tif (!drive->energized)\n\t\treturn true;\n", "\treturn true;\n"),
    ("a tool changes its driver with its energy on", "drive.c", "\tif (drive->energized)\n\t\treturn false;\n", ""),
    ("a tick begins before the core is told", "logic.c",
     "\tif (cau_drive_next_cut(logic, true, action))\n\t\treturn true;\n\tconst cau_waiting *waits =",
     "\tconst cau_waiting *waits ="),
    ("a tick begins while a pause waits", "logic.c", "\tif (waits) {", "\tif (false && waits) {"),
    ("off waits in the queue", "queue.c", "\t\tturn_off(logic, asked, asked->tool, !status, effects);", "\t\t;"),
    ("off is refused where there is no room", "queue.c",
     "\tif (status && take_without_room(logic, asked, effects))\n\t\treturn;\n", ""),
    ("a full store leaves tools energized", "logic.c", "\tif (!event->store_takes)", "\tif (false)"),
    ("a pause leaves tools energized", "logic.c",
     "\tcau_drive_cut_energized(logic, order->moment, CAU_ENERGY_OFF_COMMANDED, \"paused\", effects);", ""),
    ("what was gone to comes up energized", "drive.c",
     "\t\tmade->enabled = made->frozen = made->by_order = false;",
     "\t\tmade->enabled = event->tools[i].energized; made->frozen = made->by_order = false;"),
    # Not of the machine: a core as it was, whose full queue refuses a cut that nobody asks about.
    ("the core may refuse to turn energy off", "world.c",
     "\t\tif (w->action.was_energized)\n\t\t\toracle_book", "\t\tif (w->action.was_energized && more % 4)\n\t\t\toracle_book"),
    ("the gone drive on", "drive.c", "\t\tdrive->driver = (cau_asker){0};", ""),
    ("what is asked for before a tool is added lights it", "drive.c",
     "newest(newest(order->moment, order->off_moment),", "newest(order->off_moment,"),
    ("what switches all off spares tools that are to be added", "drive.c",
     "newest(newest(order->moment, order->off_moment), logic->all_off_moment)",
     "newest(order->moment, order->off_moment)"),
    ("what switches all off spares tools that come by going back", "drive.c",
     "\t\tmade->cut_moment = newest(made->cut_moment, logic->all_off_moment);\n", ""),
    ("off of a tool that is still to come does nothing", "queue.c",
     "\t\tcau_queue_switch_off(logic, tool, logic->moment);\n", ""),
    ("a silent driver's enable that waits is not cut", "logic.c",
     "\tcau_queue_cut_silent(logic, now_s);\n", ""),
    ("a void order is done", "logic.c",
     "\tif (order->cut_moment &&\n", "\tif (false && order->cut_moment &&\n"),
    ("who drove a tool before moves it yet", "logic.c",
     "\t\tcau_queue_change_hands(logic, &before, order->moment);", "\t\t;"),
    ("looking away leaves what moves a tool", "queue.c",
     "\tcase CAU_ASK_ENERGY_ON:\n\tcase CAU_ASK_TOOL_USE:\n\tcase CAU_ASK_MOTION:\n\tcase CAU_ASK_ADVANCE:\n\t\treturn true;",
     "\tcase CAU_ASK_TOOL_USE:\n\tcase CAU_ASK_MOTION:\n\t\treturn false;\n\tcase CAU_ASK_ENERGY_ON:\n\t\treturn true;"),
    ("who is gone leaves what is for later", "queue.c",
     "\tif (order->asked.asker.client == client && waits_for_later(logic, order))\n", "\tif (false)\n"),
    ("a later off of who drove before switches off who drives now", "queue.c",
     "\t\tif (its_own && order->moment < moment && (off || is_of_hold(logic, order)))",
     "\t\tif (its_own && order->moment < moment && ((off && false) || is_of_hold(logic, order)))"),
    ("what is cancelled is done", "queue.c",
     "\t\tmake_void(logic, order, CAU_VOIDED_CANCELLED);", "\t\t;"),
    ("an enable has no end", "logic.c", "\tcau_drive_cut_limits(logic, effects);\n", ""),
    ("an enable has the end of the one before", "drive.c",
     "\tdrive->limit_tick = limit ? logic->tick + limit : 0;",
     "\tif (!drive->limit_tick && limit)\n\t\tdrive->limit_tick = logic->tick + limit;"),
    ("one client takes all room for later ticks", "queue.c",
     "\tif (count_later(logic, client) >= most)", "\tif (false)"),
    ("what is for later takes the room of what is for now", "queue.c",
     "\tif (logic->count - count_later(logic, 0) >= logic->capacity)",
     "\tif (logic->count >= logic->capacity)"),
    ("a command for later is done now", "queue.c",
     "\treturn asked->tick > logic->tick && !logic->ended;", "\treturn false;"),
    ("a tool is added twice", "drive.c", "\tif (cau_drive_find(logic, tool)) {", "\tif (false) {"),
    ("removal leaves what waits for the tool", "logic.c",
     "\t\tcau_queue_remove_tool(logic, order->asked.tool, order->moment);\n", ""),
    ("a heartbeat that is read late undoes the silence", "logic.c",
     "\t\tcut_silent(logic, event->time_s, effects);\n\t\ttake_life(", "\t\ttake_life("),
    ("an order that is read late undoes the silence", "logic.c",
     "\t\tcut_silent(logic, event->time_s, effects);\n\t\t// Any", "\t\t// Any"),
    ("an order of a client that sends its clock is a sign of life", "queue.c",
     "\treturn asked->alive_s > 0 ? fmin(asked->alive_s, now_s) : now_s;", "\treturn now_s;"),
    ("a heartbeat lives from when it is read", "logic.c",
     "event->alive_s > 0 ? event->alive_s : event->time_s", "event->time_s"),
    ("lock-step outlives its client's connection", "drive.c",
     "\tif (client == logic->lockstep)\n\t\tcau_drive_end_lockstep(logic);\n\tfor (int32_t i = 0; i < logic->drive_count; i++)\n\t\tif (client &&",
     "\tfor (int32_t i = 0; i < logic->drive_count; i++)\n\t\tif (client &&"),
    ("lock-step outlives its client", "drive.c",
     "\tif (client == logic->lockstep)\n\t\tcau_drive_end_lockstep(logic);\n\tfor (int32_t i = 0; i < logic->drive_count; i++) {",
     "\tfor (int32_t i = 0; i < logic->drive_count; i++) {"),
    ("what switches all off leaves lock-step", "drive.c",
     "\tcau_drive_end_lockstep(logic);\n\tlogic->all_off_moment", "\tlogic->all_off_moment"),
    ("an advance burns beyond its client's ticks", "drive.c",
     "\treturn logic->steps_left > 0 && (double)(logic->tick - logic->advance_tick) >= most;", "\treturn most < 0;"),
    ("lock-step counts seconds", "drive.c",
     "\treturn logic->lockstep && drive->driver.client == logic->lockstep;", "\treturn !drive;"),
    ("anybody's tool is in lock-step", "drive.c",
     "\treturn logic->lockstep && drive->driver.client == logic->lockstep;",
     "\treturn logic->lockstep && drive;"),
    ("a resume leaves energy of lock-step on", "time.c", "\tif (!logic->lockstep)\n\t\treturn true;",
     "\tcau_drive_end_lockstep(logic);\n\tif (!logic->lockstep)\n\t\treturn true;"),
    ("anybody advances", "time.c", "\tif (logic->lockstep && logic->lockstep != client)", "\tif (false && client)"),
    ("an advance of one who is lost makes ticks", "time.c",
     "\tif (order->cut_moment)\n\t\treturn;\n\tlogic->steps_left", "\tlogic->steps_left"),
    ("an advance uses a stranger's tool", "drive.c", "\tif ((part->uses || part->on) && !drives)",
     "\tif (false && !drives)"),
    ("an advance enables what was turned off since", "drive.c",
     "\treturn !part->on || allows_enable(logic, drive, order, action);", "\treturn true;"),
    ("what an advance turns off waits", "queue.c", "\t\tturn_parts_off(logic, asked, effects);", "\t\t;"),
    ("looking away leaves an advance that waits", "queue.c",
     "\tcase CAU_ASK_MOTION:\n\tcase CAU_ASK_ADVANCE:\n\t\treturn true;",
     "\tcase CAU_ASK_MOTION:\n\t\treturn true;"),
    ("silence leaves an advance that waits", "queue.c",
     "\t\t\torder->asked.ask == CAU_ASK_ADVANCE || strcmp(order->asked.tool, drive->tool) == 0;", "\t\t\tstrcmp(order->asked.tool, drive->tool) == 0;"),
    ("off of a tool that is still to come does nothing to an advance", "queue.c",
     "\t\telse if (turns_on(&order->asked, tool))\n\t\t\tmake_void(logic, order, CAU_VOIDED_DARKENED);\n", ""),
    ("a resend is answered and done", "logic.c",
     "\telse\n\t\tcau_queue_remove(logic, order);", "\telse\n\t\torder->looked = true;"),
)


class Bench:
    """The property test's objects, of the sources as they are, and what makes a program of them and a mutant."""

    def __init__(self, folder, root, compiler):
        self.folder, self.root = folder, root
        self.compile = [compiler, "-O1", "-DNDEBUG", "-D_GNU_SOURCE", "-std=gnu17", "-I" + root + "/server",
                        "-I" + root + "/core/types", "-I" + root + "/protocol/include", "-I" + root + "/tests"]
        tests = [os.path.join("tests", ROOM, name) for name in ("logic_test.c", "oracle.c", "world.c")]
        rooms = [os.path.join(ROOM, name) for name in os.listdir(os.path.join(root, ROOM)) if name.endswith(".c")]
        self.objects = {}
        for source in [*tests, *rooms, "core/types/assert.c"]:
            name = os.path.basename(source)
            self.objects[name] = self.make(os.path.join(root, source), source, name + ".o")

    def make(self, path, source, name):
        """The object of the text at PATH, which stands for SOURCE and sees what lies beside it."""
        made = os.path.join(self.folder, name)
        beside = "-iquote" + os.path.join(self.root, os.path.dirname(source))
        subprocess.run([*self.compile, beside, "-c", path, "-o", made], check=True)
        return made

    def program(self, mutant):
        """The path of the program with MUTANT in it; None where its piece is not in its source once."""
        _, name, piece, instead = mutant
        source = os.path.join("tests" if name == "world.c" else "", ROOM, name)
        with open(os.path.join(self.root, source), encoding="utf-8") as file:
            text = file.read()
        if text.count(piece) != 1:
            print(f"not in {name} once: {piece!r}")
            return None
        changed = os.path.join(self.folder, name)
        with open(changed, "w", encoding="utf-8") as file:
            file.write(text.replace(piece, instead))
        objects = {**self.objects, name: self.make(changed, source, "mutant.o")}
        program = os.path.join(self.folder, "mutant")
        subprocess.run([self.compile[0], *objects.values(), "-lm", "-o", program], check=True)
        return program


def survives(bench, mutant):
    program = bench.program(mutant)
    return not program or subprocess.run([program, SEQUENCES], capture_output=True, check=False).returncode == 0


def main(root, compiler):
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(folder, root, compiler)
        lived = [mutant[0] for mutant in MUTANTS if survives(bench, mutant)]
    for name in lived:
        print(f"nobody noticed: {name}")
    print(f"{len(MUTANTS) - len(lived)} of {len(MUTANTS)} mutants were noticed")
    sys.exit(1 if lived else 0)


if __name__ == "__main__":
    main(*sys.argv[1:])
