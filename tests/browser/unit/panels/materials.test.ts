// SPDX-License-Identifier: GPL-3.0-or-later
// `material.set` replaces a material and refuses other members. So the form has an input for each member of the request, and
// no further ones.
import { readFileSync } from 'node:fs';

import { limitMembers } from '../../../../clients/web/src/panels/limits';
import { PARAMETERS } from '../../../../clients/web/src/wire/messages.gen';

const OF_REQUEST = ['session', 'client_sequence', 'tick', 'sequence', 'kind', 'layer', 'region'];
const KINDS = { fascia: 'MaterialSetFascia', membrane: 'MaterialSetMembrane', fat: 'MaterialSetFat', links: 'MaterialSetLinks' } as const;

interface Protocol {
  components: { schemas: Record<string, { properties: object }> };
}
const protocol = JSON.parse(readFileSync(new URL('../../../../protocol/asyncapi.json', import.meta.url), 'utf8')) as Protocol;

describe('the form of a material', () => {
  it.each(Object.keys(KINDS) as (keyof typeof KINDS)[])('of %s has what the request has', (kind) => {
    const members = Object.keys(protocol.components.schemas[KINDS[kind]].properties).filter((name) => !OF_REQUEST.includes(name));
    const inputs = [...PARAMETERS[kind].map(({ name }) => name), ...limitMembers(kind)];
    expect(inputs.sort()).toEqual(members.sort());
  });
});
