// SPDX-License-Identifier: GPL-3.0-or-later
// Places between what is on the disk and what is said of it. Here they do nothing; a test puts a
// function of its own in this one's place, which ends the process there.
#pragma once

void cau_fault_point(const char *name);
