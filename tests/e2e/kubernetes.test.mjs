// SPDX-License-Identifier: GPL-3.0-or-later
// deploy/fleet/kubernetes.yaml against the schemas of Kubernetes: types, what must be there, and, since these schemas
// let unknown members pass, that each member is one that they look at.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { StatefulSet } from 'kubernetes-models/apps/v1/StatefulSet';
import { PodDisruptionBudget } from 'kubernetes-models/policy/v1/PodDisruptionBudget';
import { Service } from 'kubernetes-models/v1/Service';
import { parseAllDocuments } from 'yaml';

const KINDS = { PodDisruptionBudget, Service, StatefulSet };
const FILE = join(process.env.PAGES, 'deploy', 'fleet', 'kubernetes.yaml');

function read() {
	return parseAllDocuments(readFileSync(FILE, 'utf8'), { strict: true }).map((document) => {
		assert.deepEqual(document.errors, []);
		return document.toJS();
	});
}

// Notes in `unread` the places of members, and takes away those that are looked at.
function watched(value, place, unread) {
	if (value === null || typeof value !== 'object') return value;
	const members = Object.fromEntries(Object.entries(value).map(([name, member]) => {
		if (!Array.isArray(value)) unread.add(`${place}.${name}`);
		return [name, watched(member, `${place}.${name}`, unread)];
	}));
	const copy = Array.isArray(value) ? Object.values(members) : members;
	return new Proxy(copy, {
		get(target, name) {
			unread.delete(`${place}.${String(name)}`);
			return Reflect.get(target, name);
		},
	});
}

// What is wrong with a resource: members that are not known; types and what is missing throw.
function unknownMembers(resource) {
	const unread = new Set();
	const model = new KINDS[resource.kind](resource);
	for (const name of Object.keys(resource)) model[name] = watched(resource[name], name, unread);
	model.validate();
	return [...unread];
}

test('every resource is one of Kubernetes', () => {
	const resources = read();
	assert.deepEqual(resources.map(({ kind }) => kind).sort(), Object.keys(KINDS).sort());
	for (const resource of resources) assert.deepEqual(unknownMembers(resource), []);
});

test('what is wrong in one is found', () => {
	const broken = (change) => {
		const set = read().find(({ kind }) => kind === 'StatefulSet');
		change(set.spec.template.spec.containers[0], set.spec);
		return unknownMembers(set);
	};
	assert.deepEqual(broken((container) => (container.imagePullPolice = 'Always')),
		['spec.template.spec.containers.0.imagePullPolice']);
	assert.throws(() => broken((container) => (container.ports[0].containerPort = 'http')), /containerPort/);
	assert.throws(() => broken((container) => delete container.name), /name/);
	assert.throws(() => broken((_, spec) => delete spec.selector), /selector/);
});

test('the daemon takes its arguments, and what belongs together has the same names', () => {
	const [service, budget, set] = read();
	const { spec } = set.spec.template;
	const [container] = spec.containers;
	const config = JSON.parse(execFileSync(process.env.CAUTERYD, [...container.args, '--label=d0', '--print-config'], { env: {} }));
	assert.deepEqual([config.port, config.agent_port], container.ports.map(({ containerPort }) => containerPort));
	assert.deepEqual(service.spec.ports.map(({ port }) => port), [config.port, config.agent_port]);
	const labels = JSON.stringify(set.spec.template.metadata.labels);
	for (const selector of [service.spec.selector, budget.spec.selector.matchLabels, set.spec.selector.matchLabels])
		assert.equal(JSON.stringify(selector), labels);
	assert.equal(set.spec.serviceName, service.metadata.name);
	const volumes = [...spec.volumes, ...set.spec.volumeClaimTemplates.map(({ metadata }) => metadata)].map(({ name }) => name);
	for (const mount of [...container.volumeMounts, ...spec.initContainers[0].volumeMounts]) assert.ok(volumes.includes(mount.name));
	assert.ok(spec.terminationGracePeriodSeconds > config.drain_s);
	const patience = container.startupProbe.periodSeconds * container.startupProbe.failureThreshold;
	assert.ok(patience > 2 * config.etcd_ttl_s);
});
