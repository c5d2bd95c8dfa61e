// SPDX-License-Identifier: GPL-3.0-or-later
// Kinds of tissue as heat and current find them. Sources: README.md.
#pragma once

#include "bioheat/bioheat.h"

// `tissue`: CAU_LIVING_*. Its `sheet` is false: current spreads in space.
cau_bioheat_material cau_living_tissue(int tissue);
