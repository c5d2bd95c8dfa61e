// SPDX-License-Identifier: GPL-3.0-or-later
// Thermal and electric properties of kinds of tissue. Sources: README.md.
#pragma once

#include "bioheat/bioheat.h"

// Returns the properties of `tissue` (CAU_LIVING_*). Its `sheet` is false: current spreads in
// space.
cau_bioheat_material cau_living_tissue(int tissue);
