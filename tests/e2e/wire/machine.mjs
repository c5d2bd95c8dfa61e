// SPDX-License-Identifier: GPL-3.0-or-later
// How slow this machine is: bounds in seconds are those of the machine on which they were set.

const ROUNDS = 3_000_000;
const ROUNDS_S = 0.005; // there: the least of many trials
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

// By how much a bound in seconds is longer here: processor time of a calculation, at least 1.
export function slowness() {
	return Math.max(1, Math.min(...Array.from({ length: TRIALS }, timed)) / ROUNDS_S);
}
