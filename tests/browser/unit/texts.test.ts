// SPDX-License-Identifier: GPL-3.0-or-later
// Tests that every text of the page is in the catalogue (clients/web/src/text), and that the page uses every text there.
import { readdirSync, readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import ts from 'typescript';

import { en } from '../../../clients/web/src/text/en';

const WEB = fileURLToPath(new URL('../../../clients/web/', import.meta.url));
const SRC = `${WEB}src/`;
const CATALOGUE = `${SRC}text/en.ts`;

/** Strings that look like texts and are none: file, string with ◌ for each value, reason. */
const EXCEPTIONS: readonly (readonly [file: string, string: string, reason: string])[] = [
  ['hands/holds.ts', 'pointer ◌', 'key of a hold'],
  ['hands/holds.ts', 'key ◌', 'key of a hold'],
  ['hands/keys.ts', 'Equal', 'KeyboardEvent.code'],
  ['hands/keys.ts', 'Minus', 'KeyboardEvent.code'],
  ['hands/keys.ts', 'Space', 'KeyboardEvent.code'],
  ['model/person.ts', '◌, viewer ◌', 'name of the client for the daemon'],
  ['model/scene_update.ts', 'tool ◌', 'name of an entity in MCAP files'],
  ['model/tool_parts.ts', 'the tool ◌ has no shape', 'assertion'],
  ['model/vessel_words.ts', '◌ sealed', 'key of a message'],
  ['panels/dom.ts', 'the page has no #◌', 'assertion'],
  ['panels/invite.ts', 'M◌ ◌h1v1h-1z', 'path of SVG'],
  ['panels/plot.ts', '11px system-ui, sans-serif', 'CSS'],
  ['panels/said.ts', 'transient ◌', 'key of a message'],
  ['panels/upload.ts', 'Files', 'type of a DataTransfer'],
  ['panels/view.ts', 'as the system', 'value that the browser stores'],
  ['scene/smoke.ts', '(prefers-reduced-motion: reduce)', 'media query'],
];

const files = readdirSync(SRC, { recursive: true, encoding: 'utf8' }).filter((file) => file.endsWith('.ts') && !file.endsWith('.d.ts'));
const program = ts.createProgram(files.map((file) => SRC + file), {
  noResolve: true, // types of packages are not needed here, and take seconds
  types: [],
  lib: ['lib.es2022.d.ts'],
  target: ts.ScriptTarget.ES2022,
  module: ts.ModuleKind.ESNext,
  moduleResolution: ts.ModuleResolutionKind.Bundler,
});
const checker = program.getTypeChecker(); // gives nodes their parents, too
const sources = files.map((file) => ({ file, source: program.getSourceFile(SRC + file)! }));

function visit(node: ts.Node, take: (node: ts.Node) => void): void {
  take(node);
  node.forEachChild((child) => visit(child, take));
}

// ---- strings that look like texts

/** Letter, space, letter, with punctuation between them; ◌ is a value of a template. */
const TWO_WORDS = /[\p{L}\d◌][,;:.!?…)’"]* ["(‘]?[\p{L}◌]/u;
const CAPITAL = /(?<![\p{L}\d_$-])\p{Lu}\p{Ll}+(?![\p{L}\d_$-])/u;
/** Units that are the same in all languages. */
const UNITS = /(?<![\p{L}\d_])(°C|GB|Hz|J|KB\/s|KB|MB|N|Pa|V|W|Ω|kPa|m\/s|m|mN|ml\/s|ml|mm|mmHg|ms|px|s)(?![\p{L}\d_])/gu;
/** Properties and functions whose strings are shown, so that a single small word is a text, too. */
const SHOWN_PROPERTIES = ['title', 'placeholder', 'alt', 'textContent', 'innerText', 'ariaLabel', 'words', 'label', 'description'];
const SHOWN_ARGUMENTS: Readonly<Record<string, (index: number) => boolean>> = {
  Option: (index) => index === 0,
  append: () => true,
  button: (index) => index === 0,
  check: (index) => index === 0,
  element: (index) => index >= 2,
  field: (index) => index !== 1,
  notice: (index) => index === 1,
  prepend: () => true,
  replaceChildren: () => true,
  say: (index) => index === 1,
  setAttribute: (index) => index === 1,
  setCustomValidity: () => true,
};
const SHOWN_ATTRIBUTES = /^'(title|placeholder|alt|aria-(label|description|placeholder|roledescription|valuetext))'$/;
const SELECTORS = ['querySelector', 'querySelectorAll', 'closest', 'matches', 'matchMedia'];

/** Returns the string with ◌ for each value. */
function stringOf(node: ts.Node): string | null {
  if (ts.isStringLiteralLike(node)) return node.text;
  if (!ts.isTemplateExpression(node)) return null;
  return [node.head.text, ...node.templateSpans.map((span) => span.literal.text)].join('◌');
}

/** Returns the expression that has the string as its value, or as one of its values. */
function whole(node: ts.Node): ts.Node {
  const { parent } = node;
  const goesOn =
    ts.isParenthesizedExpression(parent) || (ts.isConditionalExpression(parent) && parent.condition !== node) ||
    (ts.isBinaryExpression(parent) && ['||', '??', '+'].includes(parent.operatorToken.getText()));
  return goesOn ? whole(parent) : node;
}

function calledName(call: ts.CallExpression | ts.NewExpression): string {
  return ts.isPropertyAccessExpression(call.expression) ? call.expression.name.text : call.expression.getText();
}

/** True if the place of the string shows that it is part of the program. */
function isCode(node: ts.Node): boolean {
  const { parent } = node;
  if (/\/\* glsl \*\/\s*$/.test(node.getSourceFile().text.slice(node.getFullStart(), node.getStart()))) return true;
  if (ts.isImportDeclaration(parent) || ts.isExportDeclaration(parent) || ts.isLiteralTypeNode(parent)) return true;
  if (ts.isElementAccessExpression(parent) || ('name' in parent && parent.name === node)) return true;
  const at = whole(node).parent;
  if (ts.isPropertyAssignment(at)) return ['class', 'className'].includes(at.name.getText());
  if (ts.isBinaryExpression(at)) return /(^|\.)(key|code|className|style\.\w+)$/.test(at.left.getText());
  if (!ts.isCallExpression(at)) return false;
  const name = calledName(at);
  if (name === 'setAttribute') return node === at.arguments[0] || !SHOWN_ATTRIBUTES.test(at.arguments[0].getText());
  return SELECTORS.includes(name) || at.expression.getText().includes('.classList.');
}

/** True if the place of the string shows that users see it. */
function isShown(node: ts.Node): boolean {
  const at = whole(node).parent;
  if (ts.isPropertyAssignment(at)) return SHOWN_PROPERTIES.includes(at.name.getText());
  if (ts.isBinaryExpression(at)) return SHOWN_PROPERTIES.some((name) => at.left.getText().endsWith(`.${name}`));
  if (!ts.isCallExpression(at) && !ts.isNewExpression(at)) return false;
  const name = calledName(at);
  return name in SHOWN_ARGUMENTS && SHOWN_ARGUMENTS[name](at.arguments!.indexOf(whole(node) as ts.Expression));
}

function textsOf(source: ts.SourceFile): string[] {
  const found: string[] = [];
  visit(source, (node) => {
    const string = stringOf(node);
    if (string === null || isCode(node)) return;
    const bare = string.replace(UNITS, '');
    const looks = TWO_WORDS.test(string) || CAPITAL.test(bare) || isShown(node);
    if (looks && /\p{L}/u.test(bare)) found.push(string);
  });
  return found;
}

// ---- texts that the page uses

type Text = ts.PropertyAssignment;

/** Returns the literal object of a text or group of the catalogue; undefined: it is a single text. */
function groupOf({ initializer }: Text): ts.ObjectLiteralExpression | undefined {
  const value = ts.isSatisfiesExpression(initializer) ? initializer.expression : initializer;
  return ts.isObjectLiteralExpression(value) ? value : undefined;
}

function textsIn(group: ts.ObjectLiteralExpression): Text[] {
  return group.properties.flatMap((member) => {
    if (!ts.isPropertyAssignment(member)) throw new Error(`${member.getText()} is not written as "key: text"`);
    const inner = groupOf(member);
    return inner ? textsIn(inner) : [member];
  });
}

function nameOfText({ name, parent }: Text): string {
  const group = parent.parent;
  const above = ts.isSatisfiesExpression(group) ? group.parent : group;
  return ts.isPropertyAssignment(above) ? `${nameOfText(above)}.${name.getText()}` : name.getText();
}

/** Returns the text or group of the catalogue that a name in the page means, for example `title` of text.sessions.title. */
function meant(name: ts.Node): Text | undefined {
  const { parent } = name;
  const pattern = ts.isBindingElement(parent) && (parent.propertyName ?? parent.name) === name ? parent.parent : null;
  const symbol = pattern ? checker.getTypeAtLocation(pattern).getProperty(name.getText()) : checker.getSymbolAtLocation(name);
  return symbol?.declarations?.filter(ts.isPropertyAssignment).find((one) => one.getSourceFile().fileName === CATALOGUE);
}

/** True if an expression for a group is used in another way than for one of its members by name, or for a local name. */
function usedWhole(group: ts.Expression): boolean {
  const { parent } = group;
  if (ts.isPropertyAccessExpression(parent)) return parent.expression !== group;
  return !(ts.isVariableDeclaration(parent) && parent.initializer === group && parent.type === undefined);
}

/** Returns the group of the catalogue that is the type of an expression, but not the catalogue itself or a module's group:
 * these must be used text by text, because this test would not find an unused text otherwise. */
function innerGroup(expression: ts.Expression): ts.ObjectLiteralExpression | null {
  const made = checker.getTypeAtLocation(expression).symbol?.declarations?.find(ts.isObjectLiteralExpression);
  if (made?.getSourceFile().fileName !== CATALOGUE) return null;
  const holder = ts.isSatisfiesExpression(made.parent) ? made.parent.parent : made.parent;
  return ts.isPropertyAssignment(holder) && ts.isPropertyAssignment(holder.parent.parent) ? made : null;
}

function usedTexts(source: ts.SourceFile, names: ReadonlySet<string>): Text[] {
  const used: Text[] = [];
  if (!/from '[^']*\/text'/.test(source.text)) return used;
  visit(source, (node) => {
    if (ts.isIdentifier(node) && names.has(node.text)) used.push(...[meant(node)].filter((text) => text !== undefined));
    const expression = ts.isPropertyAccessExpression(node) || (ts.isIdentifier(node) && ts.isExpression(node) && !ts.isPropertyAccessExpression(node.parent));
    if (!expression || !usedWhole(node)) return;
    const group = innerGroup(node);
    if (group) used.push(...textsIn(group));
  });
  return used;
}

function catalogue(): ts.ObjectLiteralExpression {
  let found: ts.ObjectLiteralExpression | null = null;
  visit(program.getSourceFile(CATALOGUE)!, (node) => {
    if (ts.isVariableDeclaration(node) && node.name.getText() === 'en') found = node.initializer as ts.ObjectLiteralExpression;
  });
  return found!;
}

const CHECKED_MS = 60_000; // the compiler checks the types of the whole viewer, which takes 5 s on a busy machine

describe('the texts of the page', () => {
  // The messages of the wire library are for programs.
  const searched = sources.filter(({ file }) => !/^(text|wire)\//.test(file));
  const found = searched.flatMap(({ file, source }) => textsOf(source).map((string) => ({ file, string })));
  const knows = ([of, known]: (typeof EXCEPTIONS)[number], { file, string }: { file: string; string: string }): boolean => of === file && known === string;

  const folders = [...new Set(searched.map(({ file }) => file.split('/')[0]))];
  it.each(folders)('are in the catalogue, not in %s', (folder) => {
    const left = found.filter((one) => one.file.split('/')[0] === folder && !EXCEPTIONS.some((exception) => knows(exception, one)));
    expect(left.map(({ file, string }) => `${file}: ${string}`)).toEqual([]);
  });

  it('have no exception that no longer exists', () => {
    expect(EXCEPTIONS.filter((exception) => !found.some((one) => knows(exception, one)))).toEqual([]);
  });

  it.each([
    ["button('undo', go)", ['undo']],
    ["element('p', { class: 'One two', title: on ? 'on' : 'off' }, 'x')", ['on', 'off', 'x']],
    ['const words = [`${count} removed`, `${mm} mm`];', ['◌ removed']],
    ["place.textContent = name || 'none'; place.className = 'One two';", ['none']],
    ["place.setAttribute('aria-label', 'time'); place.setAttribute('class', 'One two'); place.setAttribute('aria-hidden', 'true');", ['time']],
    ["const KINDS = { sphere: 'in a sphere', box: 'Box' }; const KEYS = ['sphere', 'tool.move'];", ['in a sphere', 'Box']],
    ["throw new Error('choose a file')", ['choose a file']],
    ["if (code === 'Escape') place.querySelector('p span'); const LOOK = /* glsl */ `void main() {}`;", []],
  ])('are found in %s', (code, texts) => {
    expect(textsOf(ts.createSourceFile('code.ts', code, ts.ScriptTarget.ES2022, true))).toEqual(texts);
  });

  it('in the catalogue are all used', () => {
    const all = textsIn(catalogue());
    expect(all.length).toBeGreaterThan(80); // otherwise the catalogue is not read
    const names = new Set(all.map(({ name }) => name.getText()));
    const used = new Set(sources.flatMap(({ source }) => usedTexts(source, names)));
    expect(all.filter((text) => !used.has(text)).map(nameOfText)).toEqual([]);
  }, CHECKED_MS);

  it('in index.html are only texts that are needed before the script runs', () => {
    const html = readFileSync(`${WEB}index.html`, 'utf8');
    expect([...html.matchAll(/ (title|placeholder|alt|aria-label|aria-description)=/g)].map(([attribute]) => attribute)).toEqual([]);
    expect(Object.keys(en.page.labels).filter((id) => !html.includes(` id="${id}"`))).toEqual([]);
    const shown = html.replace(/<(title|h1|noscript)>.*?<\/\1>/g, '').replace(/<[^>]+>/g, '');
    expect(shown.trim()).toBe('');
  });
});
