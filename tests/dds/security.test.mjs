// SPDX-License-Identifier: GPL-3.0-or-later
// Tests DDS Security. A participant without an identity of the domain's authority, or without the permission, neither
// joins nor drives. A participant with both does.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import { chmodSync, copyFileSync, cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { Daemon } from './wire/daemon.mjs';
import { DOMAIN } from './domain.mjs';
import { Program } from './program.mjs';
import { Requester } from './requester.mjs';
import { watchSession } from './watch.mjs';

const LOOPBACK = process.env.LOOPBACK;
const MAKE = join(dirname(fileURLToPath(LOOPBACK)), 'security', 'make.sh');
const DEADLINE_MS = 500; // generous, because this test is not about being late

const folder = mkdtempSync(join(tmpdir(), 'cautery-keys-'));
const enclave = (name, store = 'keys') => join(folder, store, 'enclaves', name);
const make = (store, ...words) => execFileSync(MAKE, [join(folder, store), ...words], { stdio: 'pipe' });

const ROLES = { looker: 'view', worker: 'operate', chief: 'admin' };
const rolesFile = (name, text) => {
	writeFileSync(join(folder, name), text, { mode: 0o644 });
	return join(folder, name);
};

let daemon;
before(async () => {
	make('keys');
	make('keys', ...Object.keys(ROLES).flatMap((name) => ['controller', name]));
	const roles = rolesFile('roles', Object.entries(ROLES).map(([name, role]) => `${role} CN=${name},O=Cautery\n`).join(''));
	make('keys', '--session', 'd1-theirs', 'controller', 'guest');
	make('others', 'controller', 'stranger');
	daemon = await Daemon.start({ settings: { dds: true, dds_domain: DOMAIN, dds_security: enclave('daemon'), dds_roles: roles } });
});
after(async () => {
	await daemon?.end();
	rmSync(folder, { recursive: true });
});

// Returns the environment of a program with this identity; null: without an identity.
const settings = (identity) =>
	({ CYCLONEDDS_URI: identity ? `${LOOPBACK},file://${identity}/cyclonedds.xml` : LOOPBACK });

function secured(t, identity, program, words) {
	const made = new Program(program, words, { environment: settings(identity) });
	t.after(() => made.end());
	return made;
}

const controller = (t, session, identity) =>
	secured(t, identity, process.env.CONTROLLER, [DOMAIN, session, 'hook', 'native', DEADLINE_MS]);

const watched = (t, name) => watchSession(t, daemon, name);

async function drives(robot, { client, stream }) {
	await robot.event((e) => e.event === 'matched', 'matched');
	robot.tell('write on');
	await client.until(() => stream.tools[0].driver !== 0, 'it drives');
	robot.tell('energy 1');
	await client.until(() => stream.tools[0].energized, 'energy on');
}

test('only who has an identity of this authority joins and drives', async (t) => {
	const seen = await watched(t, 'ours');
	// The outsiders start first, and have as much time as the robot with an identity needs.
	const outsiders = [null, enclave('stranger', 'others')].map((identity) => {
		const robot = controller(t, seen.session, identity);
		robot.event((e) => e.event === 'matched', 'matched').then(() => (robot.joined = true), () => {});
		robot.tell('write on');
		robot.tell('energy 1');
		return robot;
	});
	for (const robot of outsiders)
		assert.equal((await robot.ask('state')).has, false);
	const ours = controller(t, seen.session, enclave('controller'));
	await drives(ours, seen);
	for (const robot of outsiders) {
		assert.equal((await robot.ask('state')).has, false, 'it sees no state');
		assert.ok(!robot.joined, 'it found nobody to write to');
	}
	const { drivers } = await seen.client.call('session.describe', { session: seen.session });
	await ours.until((s) => s.driver_name === drivers[0].name); // DDS may send this a little later than a frame
	assert.equal(daemon.lines.filter((line) => / event=dds_client /.test(line)).length, 1);
});

test('an identity does what its permissions say', async (t) => {
	const mine = await watched(t, 'mine'), theirs = await watched(t, 'theirs');
	for (const identity of ['viewer', 'guest'])
		assert.notEqual((await controller(t, mine.session, enclave(identity)).exited).code, 0,
			`${identity} may not write commands here`);
	await drives(controller(t, theirs.session, enclave('guest')), theirs);
	assert.equal(mine.stream.tools[0].driver, 0);
	// Requests may name any session, so only a controller of all sessions may send them.
	for (const identity of ['viewer', 'guest'])
		assert.notEqual((await secured(t, enclave(identity), process.env.REQUESTER, [DOMAIN, 1]).exited).code, 0);
	await (await requester(t, 'controller')).done('LIST');
	// A viewer may read status, key frame and deltas.
	const viewer = secured(t, enclave('viewer'), process.env.OBSERVER, [DOMAIN, theirs.session]);
	await viewer.event((e) => e.event === 'status', 'a status');
	await viewer.until((s) => s.deltas > 0);
});

const requester = (t, identity) => Requester.start(t, 1, settings(enclave(identity)));

test('an identity has the role that the file gives it: one that may view reads, and moves nothing', async (t) => {
	const seen = await watched(t, 'looked-at');
	const looker = controller(t, seen.session, enclave('looker'));
	await looker.event((e) => e.event === 'matched', 'matched');
	looker.tell('energy 1');
	looker.tell('write on');
	await daemon.log(/ event=dds_refused .*the role does not allow this/);
	await daemon.log(/ event=dds_client .*role=view subject="CN=looker,O=Cautery"/);
	assert.equal((await looker.ask('state')).has, true, 'it sees the state');
	const observer = secured(t, enclave('looker'), process.env.OBSERVER, [DOMAIN, seen.session]);
	await observer.event((e) => e.event === 'status', 'a status');
	await observer.until((s) => s.deltas > 0 && s.refused === 0);
	const asker = await requester(t, 'looker');
	assert.equal((await asker.request('LIST')).code, 0);
	assert.equal((await asker.request('PAUSE', { session: seen.session })).status, 'forbidden');
	assert.equal(seen.stream.tools[0].driver, 0);
	// While the viewer continues to write, a participant that may operate drives the tool.
	await drives(controller(t, seen.session, enclave('worker')), seen);
	await daemon.log(/ event=dds_client .*role=operate subject="CN=worker,O=Cautery"/);
});

test('only an identity with the role admin takes a tool from its driver', async (t) => {
	const seen = await watched(t, 'taken');
	const tool = { session: seen.session, tool: 'hook' };
	await seen.client.call('tool.take_over', tool);
	for (const name of ['worker', 'chief']) {
		const asker = await requester(t, name);
		await asker.open(seen.session);
		assert.equal((await asker.takeOver(seen.session, 'hook')).status, name === 'chief' ? '' : 'forbidden');
	}
	await seen.client.until(() => seen.stream.tools[0].driver !== seen.client.hello.client, 'the chief drives');
});

test("one identity does not get another's answers under its client_id", async (t) => {
	const asked = { scene: 'fascia', client_id: 'lasting' };
	const [chief, worker] = [await requester(t, 'chief'), await requester(t, 'worker')];
	const made = await chief.done('CREATE', { ...asked, name: 'of-chief' }, 1);
	assert.equal((await (await requester(t, 'chief')).done('CREATE', { ...asked, name: 'of-chief' }, 1)).session, made.session);
	const own = await worker.done('CREATE', { ...asked, name: 'of-worker' }, 1);
	assert.equal(own.session, 'd1-of-worker');
	for (const { session } of [made, own])
		await chief.done('DESTROY', { session }, chief.number + 1);
});

test('a guest with many writers in its session takes the places of nobody', async (t) => {
	const theirs = await watched(t, 'theirs'), mine = await watched(t, 'mine');
	const crowd = secured(t, enclave('guest'), process.env.CROWD, [DOMAIN, theirs.session, 200, DEADLINE_MS, 'hook']);
	await crowd.event((e) => e.event === 'matched', 'matched');
	crowd.tell('write good');
	await theirs.client.until(() => theirs.stream.tools[0].driver !== 0, 'one of them drives');
	await daemon.log(/ event=dds_no_place .*subject="CN=guest,O=Cautery"/);
	await drives(controller(t, mine.session, enclave('worker')), mine);
});

const start = (...flags) => spawnSync(process.env.CAUTERYD,
	['--port', '0', '--store', join(folder, 'start.db'), '--scenes', process.env.SCENES, '--dds', '--dds-domain', DOMAIN,
		...flags].map(String), { encoding: 'utf8', timeout: 60e3 });

test('the daemon says what is wrong with its DDS settings, and does not start', () => {
	const network = start('--dds-config', fileURLToPath(LOOPBACK));
	assert.equal(network.status, 2);
	assert.match(network.stderr, /path="dds_config" .*set dds_security, or dds_network/);

	const nowhere = start('--dds-security', join(folder, 'nowhere'));
	assert.equal(nowhere.status, 1);
	assert.match(nowhere.stderr, /path="dds_security" .*cannot read identity_ca.cert.pem/);

	cpSync(enclave('daemon'), enclave('mixed'), { recursive: true });
	copyFileSync(join(enclave('stranger', 'others'), 'cert.pem'), join(enclave('mixed'), 'cert.pem'));
	const mixed = start('--dds-security', enclave('mixed'));
	assert.equal(mixed.status, 1);
	assert.match(mixed.stderr, /made no participant with the identity in .*check that cert.pem fits key.pem/);
});

test('an identity that was taken back is let in no more', async (t) => {
	make('lists', 'daemon', 'daemon', 'controller', 'leaver', 'controller', 'stayer');
	// The leaver has only its old revocation list: its claims must have no effect.
	const leaver = join(folder, 'leaver-before'), its = join(leaver, 'cyclonedds.xml');
	cpSync(enclave('leaver', 'lists'), leaver, { recursive: true });
	writeFileSync(its, readFileSync(its, 'utf8').replaceAll(enclave('leaver', 'lists'), leaver));
	make('lists', '--revoke', 'leaver');
	assert.throws(() => make('lists', '--revoke', 'leaver'), /[Aa]lready revoked/);

	const strict = await Daemon.start({
		settings: { dds: true, dds_domain: DOMAIN, label: 'd3', dds_security: enclave('daemon', 'lists') },
	});
	t.after(() => strict.end());
	const seen = await watchSession(t, strict, 'list'), { session } = seen;
	const left = controller(t, session, leaver);
	left.event((e) => e.event === 'matched', 'matched').then(() => (left.joined = true), () => {});
	left.tell('write on');
	assert.equal((await left.ask('state')).has, false);
	await drives(controller(t, session, enclave('stayer', 'lists')), seen);
	assert.equal((await left.ask('state')).has, false, 'it sees no state');
	assert.ok(!left.joined, 'it found nobody to write to');
	// With the new list, the leaver itself sees that it is revoked.
	assert.notEqual((await controller(t, session, enclave('leaver', 'lists')).exited).code, 0);
});

// Returns the daemon's log line about the end of the reload.
async function reload(text) {
	const seen = daemon.lines.length;
	rolesFile('roles', text);
	daemon.process.kill('SIGHUP');
	while (!daemon.lines.some((line, i) => i >= seen && /event=reloaded/.test(line)))
		await new Promise((resolve) => daemon.waiters.push({ pattern: /event=reloaded/, resolve }));
	return daemon.lines.slice(seen);
}

test('roles are read anew: who may no longer drive stops, energy off, and drives again once it may', async (t) => {
	const usual = Object.entries(ROLES).map(([name, role]) => `${role} CN=${name},O=Cautery\n`).join('');
	const seen = await watched(t, 'demoted');
	const robot = controller(t, seen.session, enclave('worker'));
	await drives(robot, seen);
	const broken = await reload(`${usual}king CN=worker,O=Cautery\n`);
	assert.match(broken.find((line) => /reload_failed/.test(line)), /setting=dds_roles .*line 4/);
	assert.ok(seen.stream.tools[0].energized, 'a broken file changes nothing');
	await reload(usual.replace('operate CN=worker', 'view CN=worker'));
	await seen.client.until(() => !seen.stream.tools[0].energized && seen.stream.tools[0].driver === 0, 'it stops');
	const refused = await daemon.metric('session_refused_total', seen.session);
	while (await daemon.metric('session_refused_total', seen.session) < refused + 5)
		await robot.ask('state');
	assert.equal(seen.stream.tools[0].driver, 0);
	robot.tell('energy 0');
	await reload(usual);
	await seen.client.until(() => seen.stream.tools[0].driver !== 0, 'it drives again');
	robot.tell('energy 1');
	await seen.client.until(() => seen.stream.tools[0].energized, 'energy on again');
});

test('the daemon says what is wrong with a file of roles, and does not start', () => {
	const refuses = (text, reason) => {
		const { status, stderr } = start('--dds-security', enclave('daemon'), '--dds-roles', rolesFile('wrong', text));
		assert.equal(status, 1, stderr);
		assert.match(stderr, reason);
	};
	refuses('king CN=worker,O=Cautery\n', /path="dds_roles" .*line 1: roles are view, operate, admin/);
	refuses('# theirs\n\noperate worker\n', /line 3 must be `ROLE SUBJECT`/);
	refuses('view CN=a\nadmin CN=a\n', /line 2: CN=a has a role already/);
	const open = rolesFile('open', 'view CN=a\n');
	chmodSync(open, 0o666);
	assert.match(start('--dds-security', enclave('daemon'), '--dds-roles', open).stderr, /can be written by other users/);
	const alone = start('--dds-roles', open);
	assert.equal(alone.status, 2);
	assert.match(alone.stderr, /path="dds_roles" .*only with dds_security/);
});

test('with an identity a configuration of the network is taken without further words', async () => {
	const other = await Daemon.start({
		settings: {
			dds: true, dds_domain: DOMAIN, dds_security: enclave('daemon'), dds_config: fileURLToPath(LOOPBACK),
		},
	});
	await other.log(/ event=dds_open .*security="[^"]*enclaves\/daemon"/);
	await other.end();
});
