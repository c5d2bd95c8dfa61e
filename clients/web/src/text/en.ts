// SPDX-License-Identifier: GPL-3.0-or-later
// Every text of the page, in English. The groups are named after the modules that show them. A text with values is a
// function.
import type { Held, Lost } from '../hands/holds';
import type { TimelineEvent } from '../wire/messages.gen';
import type { EnergyOff } from '../wire/records';

export const en = {
  // ---- the document

  page: {
    /** accessible names of the elements of index.html, by id */
    labels: {
      mode: 'What the page shows',
      tissue: 'Tissue',
      picture: 'Tissue and instruments. Arrow keys move the tool, space holds energy on, G grasps.',
      said: 'At the tool',
      notices: 'Messages',
      handles: 'Tool',
      controls: 'Controls',
      tabs: 'Panels',
      time: 'Time',
    },
  },
  main: {
    notOpened: (session: string, reason: string) => `Session ${session} cannot be opened: ${reason}`,
    damaged: (file: string) => `The file ${file} was damaged during the download. Try again.`,
    moved: (session: string) => `The session has moved to another server. Its name is now ${session}.`,
  },

  // ---- panels, a to i

  // ---- panels, l to z

  // ---- hands, model and scene

  depth: {
    surface: 'at the surface',
    deep: (mm: string) => `${mm} mm deep`,
    above: (mm: string) => `${mm} mm above`,
  },
  energy: {
    /** how the user turns energy on again, for each kind of hold */
    again: {
      space: 'Release Space and press it again.',
      button: 'Release Energy and press it again.',
      trigger: 'Release the trigger and pull it again.',
      pointer: 'Lift and press again.',
      pedal: 'Lift the pedal and press it again.',
      cap: 'Release the 3D mouse’s button and press it again.',
      latch: 'Press Keep on again to continue.',
    } satisfies Record<Held, string>,
    againWithoutHold: 'Press again.',
    /** why energy went off while something was held; follows "Energy is off: ", and a full stop follows */
    lost: {
      watchdog: 'the server did not hear from this page in time. A busy computer can cause this',
      taken_over: 'another user took the tool over',
      restored: 'the session was rewound or restarted',
      never_enabled: 'the simulation turned energy off before it came on',
      commanded: 'another user turned energy off',
    } satisfies Record<EnergyOff, string>,
    paused: 'the session is paused',
    noConnection: 'the connection was lost',
    removed: 'the tool was removed from the session',
    noDriver: 'the tool no longer has a driver',
    takenOver: (person: string) => `${person} took the tool over`,
    latchOver: (seconds: number) => `Keep on lasts ${seconds} s at most`,
    /** why a hold ended without a release by the user; follows "Energy is off: " */
    letGo: {
      buttons: 'a second button was pressed. Release both and press again.',
      cancelled: 'the browser interrupted the press. Press again.',
      second: 'a second finger touched the picture. Lift both and press again.',
      focus: 'another control was selected. Press again.',
      typing: 'a text field was selected. Press again.',
      menu: 'a menu opened. Press again.',
      dialog: 'a dialog opened. Press again.',
      blur: 'another window was selected. Press again.',
      hidden: 'this page was hidden. Press again.',
      gone: 'the control that you held can no longer be used.',
      unplugged: 'the device was disconnected.',
      past: 'the picture shows a past view.',
    } satisfies Record<Exclude<Lost, 'released'>, string>,
    off: (reason: string) => `Energy is off: ${reason}`,
    offUntil: (reason: string, again: string) => `Energy is off: ${reason}. ${again}`,
  },
  keys: {
    /** keys and other inputs, and their effects */
    help: (latchS: number): readonly (readonly [string, string])[] => [
      ['Mouse', 'moves the tool over the tissue'],
      ['Press and drag', 'cut: energy is on while you press'],
      ['Arrows', 'move the tool'],
      ['Space', 'energy is on while you hold the key'],
      ['Wheel, W S', 'depth of the tool: W deeper, S nearer'],
      ['Q E, R F', 'Q and E turn the tool, R and F tilt the tool'],
      ['L', `keep energy on for at most ${latchS} s; L or Escape turns energy off`],
      ['G', 'close the jaws to grasp, or open them'],
      ['Right drag, Shift + drag', 'right drag turns the camera, Shift + drag moves it'],
      ['Ctrl + wheel, + −', 'zoom'],
      ['H', 'put the camera back to its first view'],
      ['Gamepad', 'the sticks move the tool, the right trigger cuts, A grasps'],
    ],
  },
  handsPast: {
    refused: 'This is a past view. Press Return to live to use the tools.',
  },
  pedal: {
    keyInUse: (key: string) => `${key} is already used by this page. Give the pedal another key with the program that came with the pedal.`,
  },
  taking: {
    failed: (tool: string, reason: string) => `The ${tool} could not be taken. ${reason}`,
    noConnection: 'There is no connection, so the tool cannot be moved.',
    watchOnly: 'You can only watch, because your access token does not allow you to use tools.',
    noTools: 'This session has no tools.',
    inUse: (person: string, tool: string) => `${person} is using the ${tool}.`,
    ask: (person: string) => `Ask ${person} for the tool`,
    asked: (person: string, tool: string) => `${person} has been asked for the ${tool}.`,
  },
  control: {
    inverted: (count: number, layer: string) => `${count} tetrahedra of ${layer} have been inverted (inside out) for half a second. Do not trust the tissue there. Rewind or reset the session.`,
    gained: (amount: string) => `The simulation gained energy that no tool gave (${amount}). Do not trust the motion of the tissue.`,
    creating: 'Creating the session',
    copying: 'Copying the session',
    rewinding: (time: string) => `Rewinding to ${time}`,
    resetting: 'Resetting',
    restoring: (snapshot: string) => `Restoring ${snapshot}`,
    noSession: 'no session is open; choose or create one',
    faulted: (reason: string) => `The simulation stopped because of a numerical error: ${reason}. Rewind or reset the session.`,
    takenOver: (person: string, tool: string) => `${person} now uses the ${tool}.`,
    refused: (tool: string, reason: string) => `The ${tool} does not follow your hand: ${reason}.`,
    ended: (session: string) => `The session ${session} no longer exists.`,
  },
  moments: {
    /** events of the timeline */
    events: {
      cut: 'cut',
      tear: 'tear',
      inverted: 'tissue inverted (inside out)',
      energy_gain: 'unexplained gain of energy',
      bleeding: 'bleeding',
      bleeding_stopped: 'bleeding stopped',
      sealed: 'vessel sealed',
      energy_on: 'energy on',
      energy_off: 'energy off',
      watchdog: 'energy off: no signal from the driver',
      fault: 'simulation error',
      snapshot: 'snapshot',
      rewind: 'rewind',
      reset: 'reset',
    } satisfies Partial<Record<TimelineEvent['kind'], string>>,
    /** "3.50 to 7.90 s"; the second time has the unit */
    span: (first: string, last: string) => `${first} to ${last}`,
  },
  person: {
    /** a made-up name is one of these and a number */
    trees: [
      'Alder', 'Ash', 'Aspen', 'Beech', 'Birch', 'Cedar', 'Cherry', 'Elm', 'Fir', 'Hazel', 'Holly', 'Larch', 'Laurel', 'Lime',
      'Maple', 'Oak', 'Olive', 'Pine', 'Plane', 'Poplar', 'Rowan', 'Spruce', 'Walnut', 'Willow',
    ],
    /** a program without a name */
    unnamed: (client: number) => `client ${client}`,
  },
  sentences: {
    nameRule: 'A name begins with a small letter and contains only small letters, digits and single - or _ between them, as in knee-2',
    /** words for members of messages, by their wire names such as hot_radius_m; without an entry here the words are
     * made of the wire name, which is English */
    members: {} as Record<string, string>,
    meshUnit: (mm: number) => `one unit is ${mm} mm`,
    meshTissue: { fat: '(tissue fat)', fascia: '(tissue fascia)' },
  },
  tissue: {
    /** the cut surfaces inside a layer, in a list of layers */
    inside: (layer: string) => `${layer} (inside)`,
  },
  vesselWords: {
    parted: 'parted',
    pierced: 'wall has a hole',
    sealed: 'sealed',
    shut: 'pressed shut',
    bleeding: 'bleeding',
    open: 'open',
    lost: (ml: string) => `${ml} ml lost`,
    bursts: (mmHg: number) => `bursts at ${mmHg} mmHg`,
    /** figures follow */
    bleeds: (names: string, count: number) => `${names} ${count === 1 ? 'bleeds' : 'bleed'}:`,
    bleedsNoLonger: (name: string) => `${name} no longer bleeds:`,
    isSealed: (name: string) => `${name} is sealed:`,
  },
  viewport: {
    noPicture: 'there is no picture to save yet',
    notWritten: 'the picture could not be written',
  },
};
