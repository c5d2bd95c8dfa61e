// SPDX-License-Identifier: GPL-3.0-or-later
// Decodes frames as protocol/README.md describes them, and nothing else; which scalars there are it
// reads in the machine-readable document.
import { readFileSync } from 'node:fs';
import { MeshoptDecoder } from 'meshoptimizer';

await MeshoptDecoder.ready;

const document = JSON.parse(readFileSync(new URL('asyncapi.json', import.meta.url)));
const SCALARS = document['x-stream-channels'].filter((channel) => 'most' in channel);

const KEY = 1, DELTA = 2, TOPOLOGY = 3;
const NONE = 0, PREVIOUS = 1, HELD = 2;

export function header(bytes) {
	const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
	if (bytes.length < 72 || view.getUint32(0, true) !== 0x46554143)
		throw new Error('not a frame');
	return {
		view,
		version: view.getUint8(4),
		kind: view.getUint8(5),
		flags: view.getUint16(6, true),
		byteCount: view.getUint32(8, true),
		session: view.getUint32(12, true),
		epoch: view.getBigUint64(16, true),
		sequence: view.getBigUint64(24, true),
		base: view.getBigUint64(32, true),
		tick: Number(view.getBigUint64(40, true)),
		time: view.getFloat64(48, true),
		published: Number(view.getBigUint64(56, true)),
		profile: view.getUint16(64, true),
		sections: view.getUint16(66, true),
	};
}

export function* sections(bytes, head) {
	let at = 72;
	for (let i = 0; i < head.sections; i++) {
		const length = head.view.getUint32(at + 4, true);
		yield [head.view.getUint8(at), bytes.subarray(at + 8, at + 8 + length)];
		at += 8 + length;
	}
	if (at !== head.byteCount || at !== bytes.length)
		throw new Error('the frame does not end where its sections do');
}

function runs(list) {
	const indices = [];
	let at = 0, element = 0;
	const number = () => {
		let value = 0, shift = 0;
		for (;;) {
			const byte = list[at++];
			value += (byte & 127) * 2 ** shift;
			if (byte < 128)
				return value;
			shift += 7;
		}
	};
	while (at < list.length) {
		element += number();
		for (let left = number(); left > 0; left--)
			indices.push(element++);
	}
	return indices;
}

function numbers(data, count, width, components, coding) {
	const total = count * components;
	let bytes = data, stride = width * components;
	if (coding === 1) {
		const length = new DataView(data.buffer, data.byteOffset).getUint32(0, true);
		const packed = data.subarray(4, 4 + length);
		const wide = components > 1;
		stride = wide ? (width * components + 3) & ~3 : 4;
		const rows = wide ? count : Math.ceil((count * width) / 4);
		bytes = new Uint8Array(rows * stride);
		MeshoptDecoder.decodeVertexBuffer(bytes, rows, stride, packed);
		if (!wide)
			stride = width;
	}
	const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
	const out = new Array(total);
	for (let i = 0; i < count; i++)
		for (let c = 0; c < components; c++) {
			const at = i * stride + c * width;
			out[i * components + c] =
				width === 1 ? view.getUint8(at) : width === 2 ? view.getUint16(at, true) : view.getUint32(at, true);
		}
	return out;
}

// Balanced digits: every byte counts as signed.
const BALANCE = { 1: 0x80, 2: 0x8080, 4: 0x80808080 };
const signed = (value, width) => ((value ^ BALANCE[width]) >>> 0) - BALANCE[width];

// The records of a section of vessels.
function vesselRecords(payload) {
	const view = new DataView(payload.buffer, payload.byteOffset, payload.byteLength);
	const found = [];
	let at = 4;
	for (let i = 0; i < view.getUint32(0, true); i++) {
		const length = payload[at], points = view.getUint16(at + 2, true);
		const floats = (from, count) => Array.from({ length: count }, (_, k) => view.getFloat32(from + 4 * k, true));
		const [radiusM, bleedingM3s, shedM3, burstPa] = floats(at + 4, 4);
		const first = at + 20 + 4 * Math.ceil(length / 4);
		found.push({
			name: new TextDecoder().decode(payload.subarray(at + 20, at + 20 + length)), flags: payload[at + 1],
			radiusM, bleedingM3s, shedM3, burstPa, points: Array.from({ length: points }, (_, k) => floats(first + 16 * k, 4)) });
		at = first + 16 * points;
	}
	if (at !== payload.length)
		throw new Error(`vessels end at byte ${at} of ${payload.length}`);
	return found;
}

// The records of a section of tools' contacts.
function contactRecords(payload) {
	const view = new DataView(payload.buffer, payload.byteOffset, payload.byteLength);
	const found = [];
	let at = 4;
	for (let i = 0; i < view.getUint32(0, true); i++) {
		const length = payload[at], planes = view.getUint16(at + 2, true);
		const floats = (from, count) => Array.from({ length: count }, (_, k) => view.getFloat32(from + 4 * k, true));
		const first = at + 120 + 4 * Math.ceil(length / 4);
		found.push({
			name: new TextDecoder().decode(payload.subarray(at + 120, at + 120 + length)), valid: payload[at + 1] === 1,
			asked: floats(at + 4, 3), position: floats(at + 32, 3), force: floats(at + 60, 3), compliance: floats(at + 72, 6),
			planes: Array.from({ length: planes }, (_, k) => floats(first + 20 * k, 5)) });
		at = first + 20 * planes;
	}
	if (at !== payload.length)
		throw new Error(`contacts end at byte ${at} of ${payload.length}`);
	return found;
}

// Writes a section's elements into `held`; returns how many there were.
function elements(payload, held) {
	const view = new DataView(payload.buffer, payload.byteOffset, payload.byteLength);
	const width = payload[0], components = payload[1], coding = payload[2], reference = payload[3];
	const count = view.getUint32(4, true), runBytes = view.getUint32(8, true);
	const indices = runs(payload.subarray(12, 12 + runBytes));
	if (indices.length !== count)
		throw new Error('runs and count differ');
	const data = payload.subarray(12 + ((runBytes + 3) & ~3));
	const values = numbers(data, count, width, components, coding);
	const previous = new Array(components).fill(0);
	indices.forEach((element, i) => {
		for (let c = 0; c < components; c++) {
			const at = element * components + c, value = values[i * components + c];
			let decoded = value;
			if (reference === PREVIOUS)
				decoded = previous[c] + signed(value, width);
			else if (reference === HELD)
				decoded = held[at] + signed(value, width);
			held[at] = decoded;
			previous[c] = held[at];
		}
	});
	return count;
}

function toolNames(payload) {
	const view = new DataView(payload.buffer, payload.byteOffset, payload.byteLength);
	const names = [];
	let at = 4;
	for (let i = 0; i < view.getUint32(0, true); i++) {
		const length = payload[at + 1];
		names.push({ shape: payload[at], name: Buffer.from(payload.subarray(at + 2, at + 2 + length)).toString() });
		at += 2 + length;
	}
	return names;
}

const OFF = ['never_enabled', 'commanded', 'watchdog', 'restored', 'taken_over'];

function toolRecords(payload, names) {
	const view = new DataView(payload.buffer, payload.byteOffset, payload.byteLength);
	const floats = (at, count) => Array.from({ length: count }, (_, i) => view.getFloat32(at + 4 * i, true));
	return names.map((named, i) => {
		const at = 84 * i;
		return {
			...named,
			sequence: Number(view.getBigUint64(at, true)),
			position: floats(at + 8, 3),
			rotation: floats(at + 20, 4),
			jaw: view.getFloat32(at + 36, true),
			force: floats(at + 40, 3),
			temperature: view.getFloat32(at + 64, true),
			driver: view.getUint32(at + 72, true),
			energized: (view.getUint8(at + 76) & 1) !== 0,
			grasping: (view.getUint8(at + 76) & 2) !== 0,
			frozen: (view.getUint8(at + 76) & 4) !== 0,
			energyOff: OFF[view.getUint8(at + 77)],
			deliveredW: 0,
			loadOhm: 0,
			raw: null,
		};
	});
}

// One stream's state. take() returns 'key', 'delta', 'topology' or 'skipped'.
export class Decoder {
	constructor(description) {
		this.description = description;
		const vertices = description.vertex_count, faces = description.face_count;
		this.quantised = new Int32Array(3 * vertices);
		this.mask = new Uint32Array(Math.ceil(faces / 32));
		this.scalars = {}; // by section
		for (const { name, section, most } of SCALARS)
			this.scalars[section] = this[name] = most > 255 ? new Uint16Array(vertices) : new Uint8Array(vertices);
		this.faces = new Int32Array(3 * faces);
		this.faceLayers = new Uint8Array(faces);
		this.texture = new Uint32Array(6 * faces);
		this.rest = new Int32Array(3 * vertices);
		this.names = [];
		this.tools = [];
		this.synced = false;
		this.counts = { key: 0, delta: 0, topology: 0, skipped: 0 };
	}

	take(bytes) {
		const head = header(bytes);
		const kind = this.apply(bytes, head);
		this.counts[kind]++;
		return kind;
	}

	apply(bytes, head) {
		if (head.version !== 1 || head.session !== this.description.session_number ||
			head.profile !== this.description.profile)
			return 'skipped';
		if (head.kind === DELTA &&
			(!this.synced || head.epoch !== this.epoch || head.base !== this.sequence))
			return 'skipped';
		if (head.kind === KEY) {
			for (const array of [this.quantised, this.mask, ...Object.values(this.scalars)])
				array.fill(0);
			this.names = [];
		}
		this.moved = 0;
		for (const [type, payload] of sections(bytes, head))
			this.section(type, payload);
		if (head.kind === TOPOLOGY)
			return 'topology';
		Object.assign(this, {
			synced: true, epoch: head.epoch, sequence: head.sequence, tick: head.tick, flags: head.flags,
			published: head.published,
		});
		return head.kind === KEY ? 'key' : 'delta';
	}

	section(type, payload) {
		if (type === 1)
			this.moved = elements(payload, this.quantised);
		else if (type === 6)
			this.names = toolNames(payload);
		else if (type === 7)
			this.tools = toolRecords(payload, this.names);
		else if (type === 34) {
			const view = new DataView(payload.buffer, payload.byteOffset, payload.byteLength);
			this.tools.forEach((tool, i) => Object.assign(tool, { deliveredW: view.getFloat32(8 * i, true), loadOhm: view.getFloat32(8 * i + 4, true) }));
		} else if (type === 35) {
			const view = new DataView(payload.buffer, payload.byteOffset, payload.byteLength);
			const floats = (at, count) => Array.from({ length: count }, (_, i) => view.getFloat32(at + 4 * i, true));
			this.tools.forEach((tool, i) => Object.assign(tool, {
				raw: { force: floats(28 * i, 3), torque: floats(28 * i + 12, 3), filterS: view.getFloat32(28 * i + 24, true) } }));
		} else if (type === 10) {
			this.vessels = vesselRecords(payload);
		} else if (type === 12) {
			this.contacts = contactRecords(payload);
		} else if (type === 8) {
			const view = new DataView(payload.buffer, payload.byteOffset);
			this.realtimeFactor = view.getFloat32(0, true);
			this.stepCost = view.getFloat32(4, true);
		} else {
			const arrays = {
				2: this.mask, ...this.scalars,
				16: this.faces, 17: this.faceLayers, 18: this.texture, 19: this.rest,
			};
			if (arrays[type])
				elements(payload, arrays[type]);
		}
	}

	position(vertex) {
		const { origin_m: origin, step_m: step } = this.description;
		return [0, 1, 2].map((c) => origin[c] + step * this.quantised[3 * vertex + c]);
	}

	removed() {
		let count = 0;
		for (const word of this.mask)
			for (let w = word; w; w &= w - 1)
				count++;
		return count;
	}

	isRemoved(face) {
		return ((this.mask[face >>> 5] >>> (face & 31)) & 1) === 1;
	}
}
