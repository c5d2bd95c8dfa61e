// SPDX-License-Identifier: GPL-3.0-or-later
// Strict readers of the two formats of /metrics, written from their specifications alone: OpenMetrics
// 1.0.0, and Prometheus' text format 0.0.4. Stricter where a scraper is lenient: blank lines, comments,
// blanks beyond the one that separates, families without a type, timestamps and exemplars are refused.
const NAME = '[a-zA-Z_:][a-zA-Z0-9_:]*';
const LABEL = /^([a-zA-Z_][a-zA-Z0-9_]*)="((?:[^"\\\n]|\\[n"\\])*)"/;
const NUMBER = /^(?:[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?|[+-]Inf|NaN)$/;
const METADATA = new RegExp(`^# (TYPE|UNIT|HELP) (${NAME})(?: (.*))?$`, 'su');
const SAMPLE = new RegExp(`^(${NAME})(?:\\{(.*)\\})? (\\S+)$`, 'su');
const ENDINGS = { counter: ['_total', '_created'], gauge: [''], histogram: ['_bucket', '_sum', '_count', '_created'] };

function fail(number, why) {
	throw new Error(`line ${number}: ${why}`);
}

function readLabels(text, number) {
	const labels = new Map();
	for (let rest = text; rest; ) {
		const match = LABEL.exec(rest);
		if (!match)
			fail(number, `labels at ${rest}`);
		const [all, name, value] = match;
		if (labels.has(name) || name.startsWith('__'))
			fail(number, `the label ${name}`);
		labels.set(name, value.replace(/\\(.)/g, (_, c) => (c === 'n' ? '\n' : c)));
		rest = rest.slice(all.length);
		if (rest && !/^,[^,]/.test(rest))
			fail(number, `labels at ${rest}`);
		rest = rest.slice(1);
	}
	return labels;
}

// Names that may stand in a family's samples; in the older format a counter's own name is its samples'.
function sampleNames(family, open) {
	const endings = ENDINGS[family.type];
	return open || family.type === 'histogram' ? endings.map((ending) => family.name + ending) : [family.name];
}

// A histogram's samples: of each set of labels buckets whose ends and counts rise, the last to +Inf, and a
// count that is the last bucket's.
function checkHistogram({ name, samples }) {
	const series = new Map();
	for (const [key, { labels, value }] of samples) {
		const ending = JSON.parse(key)[0].slice(name.length), end = labels.get('le');
		const others = JSON.stringify([...labels].filter(([label]) => label !== 'le'));
		if ((ending === '_bucket') !== (end !== undefined))
			throw new Error(`${key} and le`);
		if (!series.has(others))
			series.set(others, { ends: [], counts: [] });
		const one = series.get(others);
		if (end === undefined)
			one[ending] = value;
		else {
			one.ends.push(Number(end.replace('Inf', 'Infinity')));
			one.counts.push(value);
		}
	}
	const rises = (list, less) => list.every((value, i) => i === 0 || less(list[i - 1], value));
	for (const [others, { ends, counts, _count, _sum }] of series)
		if (!rises(ends, (a, b) => a < b) || !rises(counts, (a, b) => a <= b) || ends.at(-1) !== Infinity
			|| _count !== counts.at(-1) || !(_sum >= 0))
			throw new Error(`the histogram ${name} of ${others}`);
}

class Reader {
	constructor(open) {
		this.open = open;
		this.families = new Map();
		this.taken = new Set(); // names that belong to a family
		this.family = null;
	}

	begin(name, number) {
		if (this.families.has(name))
			fail(number, `${name} is told twice, or not in one piece`);
		this.family = { name, samples: new Map() };
		this.families.set(name, this.family);
	}

	metadata(word, name, text, number) {
		if (this.family?.name !== name)
			this.begin(name, number);
		const family = this.family, member = word.toLowerCase();
		if (member in family || family.samples.size)
			fail(number, `${word} of ${name} again, or behind its samples`);
		family[member] = text ?? '';
		if (word === 'TYPE')
			this.type(family, number);
		if (word === 'UNIT' && (!this.open || !text || !name.endsWith(`_${text}`)))
			fail(number, `${name} has not the unit ${text}`);
		if (word === 'HELP' && !(this.open ? /^(?:[^"\\]|\\[n"\\])*$/u : /^(?:[^\\]|\\[n\\])*$/u).test(text ?? ''))
			fail(number, `help of ${name}`);
	}

	type(family, number) {
		const { name, type } = family;
		if (!ENDINGS[type])
			fail(number, `${name} is ${type}`);
		if (type === 'counter' && name.endsWith('_total') === this.open)
			fail(number, `${name} is a counter`);
		if (type === 'gauge' && name.endsWith('_total'))
			fail(number, `${name} is no counter`);
		for (const claimed of new Set([name, ...sampleNames(family, this.open)])) {
			if (this.taken.has(claimed))
				fail(number, `${claimed} belongs to another family`);
			this.taken.add(claimed);
		}
	}

	sample(name, labelText, valueText, number) {
		const family = this.family;
		if (!family?.type || !sampleNames(family, this.open).includes(name))
			fail(number, `${name} is not of the family ${family?.name}`);
		const labels = readLabels(labelText ?? '', number);
		if (!NUMBER.test(valueText))
			fail(number, `${valueText} is no number`);
		const value = Number(valueText.replace('Inf', 'Infinity'));
		if (family.type === 'counter' && !(value >= 0 && value < Infinity))
			fail(number, `a counter of ${valueText}`);
		const key = JSON.stringify([name, ...[...labels].sort()]);
		if (family.samples.has(key))
			fail(number, `${key} twice`);
		family.samples.set(key, { labels, value });
	}

	line(text, number) {
		const metadata = METADATA.exec(text), sample = SAMPLE.exec(text);
		if (metadata)
			this.metadata(metadata[1], metadata[2], metadata[3], number);
		else if (sample)
			this.sample(sample[1], sample[2], sample[3], number);
		else
			fail(number, `neither metadata nor sample: ${text}`);
	}
}

// Reads an exposition: families by name, each with type, unit, help and samples. Throws at the first
// thing that its specification does not have.
export function readExposition(bytes, { open }) {
	const lines = new TextDecoder('utf-8', { fatal: true, ignoreBOM: true }).decode(bytes).split('\n');
	if (lines.pop() !== '')
		fail(lines.length + 1, 'the last line does not end');
	if (open && lines.pop() !== '# EOF')
		fail(lines.length + 1, 'the end is not # EOF');
	const reader = new Reader(open);
	lines.forEach((line, i) => reader.line(line, i + 1));
	for (const family of reader.families.values())
		if (family.type === 'histogram')
			checkHistogram(family);
	return reader.families;
}
