// SPDX-License-Identifier: GPL-3.0-or-later
#include "bioheat/generator.h"

#include <math.h>

#include "cautery/assert.h"

cau_output cau_generator_into(const cau_generator *generator, double conductance_s)
{
	CAU_ASSERT(conductance_s >= 0, "a load of %g S", conductance_s);
	CAU_ASSERT(generator->crest_factor >= 1, "a crest factor of %g", generator->crest_factor);
	double voltage = generator->peak_v / generator->crest_factor;
	if (conductance_s > 0) {
		voltage = fmin(voltage, sqrt(generator->power_w / conductance_s));
		voltage = fmin(voltage, generator->current_a / conductance_s);
	}
	double current = voltage * conductance_s;
	return (cau_output){.voltage_v = voltage, .current_a = current, .power_w = voltage * current};
}
