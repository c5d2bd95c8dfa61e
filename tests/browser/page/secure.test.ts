// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the page over https and its stream over wss, with TLS in the daemon itself.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

import { Stage } from './stage';
import { COARSE, ViewerPage } from './viewer_page';

const folder = mkdtempSync(join(tmpdir(), 'cautery-secure-'));
const [certificate, key] = [join(folder, 'cert.pem'), join(folder, 'key.pem')];
execFileSync('openssl', ['req', '-x509', '-newkey', 'ec', '-pkeyopt', 'ec_paramgen_curve:P-256', '-nodes', '-days', '2',
  '-keyout', key, '-out', certificate, '-subj', '/CN=viewer', '-addext', 'subjectAltName=IP:127.0.0.1'], { stdio: 'ignore' });

describe('a daemon with TLS', () => {
  const stage = new Stage(['--demo', 'fascia', '--tls-certificate', certificate, '--tls-key', key], COARSE);
  afterAll(() => rmSync(folder, { recursive: true, force: true }));

  it('serves a page that is live, and talks to it by wss alone', async () => {
    const url = stage.daemon.url.replace('http:', 'https:');
    // the browser does not know the certificate's authority
    const viewer = await ViewerPage.open(stage.browser, url, { ignoreHTTPSErrors: true, ...COARSE });
    await viewer.live('d1-fascia');
    expect([...viewer.schemes].sort()).toEqual(['https:', 'wss:']);
    expect(await viewer.page.evaluate(() => isSecureContext)).toBe(true);
    await viewer.page.keyboard.down('Space'); // takes the free tool and turns energy on
    await viewer.until(() => window.cautery.energized, null, 'energy is on');
    await viewer.page.keyboard.up('Space');
    await viewer.until(() => !window.cautery.energized, null, 'energy is off');
    expect(viewer.complaints).toEqual([]);
  });
});
