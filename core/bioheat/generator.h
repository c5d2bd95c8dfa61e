// SPDX-License-Identifier: GPL-3.0-or-later
// A generator of high-frequency current. Its power is constant over a range of loads, within its
// limits of voltage and current.
#pragma once

// A mode of a generator at a setting.
typedef struct cau_generator {
	double power_w;      // set power
	double peak_v;       // limit of the voltage, peak
	double current_a;    // limit of the current, root mean square
	double crest_factor; // peak voltage over its root mean square, at least sqrt(2)
} cau_generator;

typedef struct cau_output { // root mean squares
	double voltage_v, current_a, power_w;
} cau_output;

// Returns the output into a load of `conductance_s` (S, at least 0): the set power, or less at a
// limit.
cau_output cau_generator_into(const cau_generator *generator, double conductance_s);
