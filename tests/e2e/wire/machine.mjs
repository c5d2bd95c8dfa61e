// SPDX-License-Identifier: GPL-3.0-or-later
// How slow this machine is. Tests have bounds in seconds. Those are true of the machine on which they were set: an AMD EPYC
// of family 25, model 17.

const ROUNDS = 3_000_000;
const ROUNDS_S = 0.005; // processor time of ROUNDS on that machine, the least of many trials
const TRIALS = 20;

function calculate() {
	let x = 0.5;
	for (let i = 0; i < ROUNDS; i++)
		x = 3.9 * x * (1 - x);
	return x;
}

function timed() {
	const began = process.cpuUsage().user;
	calculate();
	return (process.cpuUsage().user - began) / 1e6;
}

// The factor by which a bound in seconds is longer on this machine, at least 1. It is processor time, so other programs do
// not add to it.
export function slowness() {
	return Math.max(1, Math.min(...Array.from({ length: TRIALS }, timed)) / ROUNDS_S);
}
