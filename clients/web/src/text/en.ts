// SPDX-License-Identifier: GPL-3.0-or-later
// Every text of the page, in English. The groups are named after the modules that show them. A text with values is a
// function.
import type { FrameProgress, HelloResult, LIMITS, Layer, MODELS, PROJECTIONS } from '../wire/messages.gen';
import type { STAGES } from '../wire/records';

export const en = {
  // ---- the document

  // ---- panels, a to i

  // ---- panels, l to z
  limits: {
    choices: { limit: 'Strain limit', model: 'Model', projection: 'Projection' },
    // the options of the three choices
    options: {
      none: 'none',
      target: 'target',
      range: 'range',
      neohookean: 'neohookean',
      corotated: 'corotated',
      stvk: 'stvk',
      energy: 'energy',
      closed_form: 'closed form',
      linearised: 'linearised',
    } satisfies Record<(typeof LIMITS | typeof MODELS | typeof PROJECTIONS)[number], string>,
    vectors: { target: 'Target', strain_min: 'Least strain', strain_max: 'Largest strain', shrink: 'Shrink' },
    // directions of the material; x, y and z are axes
    entries: {
      'along-fibres': 'along fibres',
      'across': 'across',
      'through': 'through',
      'shear-along-across': 'shear along/across',
      'shear-along-through': 'shear along/through',
      'shear-across-through': 'shear across/through',
      'x': 'x',
      'y': 'y',
      'z': 'z',
    },
    /** the name of an input, as in 'Target along fibres' */
    entryOf: (vector: string, entry: string) => `${vector} ${entry}`,
    titles: {
      target: 'squared stretch to which the limit pulls the tissue (target of F^T F)',
      shrink: 'squared stretch to which the rims of cuts shrink; 1: no shrinking',
    },
    outOfRange: (vector: string, least: number, most: number) => `${vector} must be numbers from ${least} to ${most}`,
  },
  materials: {
    title: 'Materials',
    empty: 'Join a session to see its materials.',
    kinds: { fascia: 'fascia', membrane: 'membrane', fat: 'fat', links: 'links' } satisfies Record<Layer['kind'], string>,
    layer: (name: string, kind: string) => `${name} (${kind})`,
    region: (layer: string, region: number) => `${layer}, region ${region}`,
    apply: 'Apply',
    gravity: 'Gravity',
    gravityAlong: (axis: string) => `Gravity ${axis}`,
  },
  mode: {
    modes: {
      operate: { name: 'Operate', title: 'Instrument, power, time and camera' },
      research: { name: 'Research', title: 'All of Operate, and sessions, tools, materials, view and plots' },
    },
  },
  operate: {
    instrument: 'Instrument',
    inHand: 'Instrument in hand',
    power: 'Power',
    powerSlider: 'Power: temperature of the hot tip',
    tip: (celsius: string) => `${celsius} °C at the tip`,
    takeFirst: 'Take the tool first',
    you: 'You',
    yourName: 'Your name',
    yourNameTitle: 'other people in the session see this name',
    driver: (person: string, tool: string) => `${person} uses the ${tool}.`,
    session: 'Session',
    camera: 'Camera',
  },
  overlay: {
    connecting: 'Connecting…',
    roles: { view: 'view', operate: 'operate', admin: 'admin' } satisfies Record<HelloResult['role'], string>,
    online: (server: string, role: string) => `${server} · ${role}`,
    lost: (reason: string) => `No connection: ${reason}. Trying again.`,
    tokenNeeded: 'An access token is needed',
    noSession: 'no session',
    /** one paragraph each */
    mouseHint: [
      'Move the mouse over the tissue to move the tool. Press to cut.',
      'Go slowly. Tissue needs a few seconds of heat before it parts.',
      'Drag beside the tissue to turn the view. Use the timeline below to view an earlier time.',
    ],
    fingerHint: [
      'Touch the tissue to cut. Choose Move to move the tool without heat.',
      'Go slowly. Tissue needs a few seconds of heat before it parts.',
      'Use two fingers to turn the view. Use the timeline to view an earlier time.',
    ],
    allKeys: 'All keys',
    manual: 'Manual',
    understood: 'Understood',
    help: 'Help',
    dismiss: 'Dismiss',
    asks: (person: string, tool: string) => `${person} asks for the ${tool}.`,
    handOver: 'Hand over',
    keep: 'Keep it',
    // read out by screen readers
    faces: (layer: string, count: number) => `${layer} ${count} faces`,
    toolAt: (tool: string, position: string) => `${tool} at ${position} mm`,
    reading: (layers: string, tool: string) => `${layers}. ${tool}`,
  },
  parameters: {
    /** shown for a parameter under the pointer */
    title: (meaning: string, least: string, most: string) => `${meaning}; ${least} to ${most}`,
    outOfRange: (name: string, meaning: string, least: string, most: string, unit: string) => `${name} (${meaning}) must be from ${least} to ${most} ${unit}`.trimEnd(),
  },
  past: {
    loadingBar: 'Loading the past view',
    live: 'Return to live',
    /** a time in the other texts of this group */
    at: (seconds: string) => `t = ${seconds} s`,
    seen: (at: string) => `You see the past at ${at}. The session continues.`,
    notShown: (at: string, reason: string) => `${at} cannot be shown. ${reason}`,
    notShownNow: (at: string, reason: string) => `${at} cannot be shown now. ${reason}`,
    loading: (at: string) => `Loading ${at}…`,
    stages: {
      building: 'preparing a second copy of the tissue',
      reading: 'reading the stored state',
      restoring: 'restoring the stored state',
      replaying: 'replaying the commands',
    } satisfies Record<FrameProgress['stage'], string>,
    loadingStage: (at: string, stage: string) => `Loading ${at}: ${stage}…`,
  },
  plots: {
    title: 'Plots',
    csv: 'Save as CSV',
    last: (seconds: number) => `The last ${seconds} s`,
    // titles of the plots, and the names of their lines
    stageTimes: 'Time of each stage of a step, ms',
    stages: {
      commands: 'commands',
      predict: 'predict',
      local: 'local',
      global: 'global',
      contact: 'contact',
      heat: 'heat',
      dissect: 'dissect',
      frame: 'frame',
    } satisfies Record<(typeof STAGES)[number], string>,
    speed: 'Simulated time over real time',
    rate: 'rate',
    frameTimes: 'Latency of frames, and time to decode one, ms',
    latency: 'latency',
    decoding: 'decoding',
    frameSize: 'Size of a frame, KB',
    frame: 'frame',
    // figures above the plots, in one list
    frameRate: (frames: string) => `${frames} frames/s`,
    dataRate: (kilobytes: string) => `${kilobytes} KB/s`,
    noFrames: 'no frames received',
    skipped: (frames: number) => `${frames} skipped`,
  },
  ruler: {
    remove: 'Remove the ruler',
  },
  sceneRecording: {
    record: 'Record as MCAP',
    stop: 'Stop and save the MCAP file',
    workerFailed: 'The recording has failed: a part of this page stopped. Reload the page to record again.',
    failed: (reason: string) => `The recording has failed: ${reason}`,
    full: 'The recording has reached its limit of 1 GB and was saved.',
  },
  senses: {
    title: 'Smoke and sound',
    switches: { smoke: 'Smoke', tone: 'Activation tone', sizzle: 'Sizzle', alarm: 'Alarm when the connection fails' },
  },
  sessionPlots: {
    title: 'Tools over the session',
    temperature: 'Temperature of the tip, °C',
    force: 'Force, N',
    energy: 'Energy taken up by the tissue, J',
    /** the name of a plot for screen readers */
    over: (title: string) => `${title}, over the session`,
    noValues: 'No values are known for this time',
  },
  time: {
    pause: 'Pause',
    resume: 'Resume',
    step: 'Step',
    reset: 'Start over',
    resetTitle: 'Return to the whole tissue at time 0',
    resetQuestion: 'Start over?',
    resetLoss: 'This resets the tissue for everyone in the session.',
    speed: 'Speed',
    timeline: 'Timeline: time to view',
    /** before the time is known */
    rewindHere: 'Rewind here',
    rewindTo: (time: string) => `Rewind to ${time}`,
    rewindQuestion: (time: string) => `Rewind to ${time}?`,
    rewindLoss: 'This rewinds the session for everyone. The later history is kept as a branch.',
    rewind: 'Rewind',
    events: 'Events',
    eventsLabel: 'Events: choose one to view its time',
    // beside the time
    faulted: 'stopped by an error',
    paused: 'paused',
    tick: (tick: number) => `tick ${tick}`,
  },
  veil: {
    noGraphics: 'The picture needs WebGL 2, which this browser does not offer. Turn on hardware acceleration in the browser’s settings, or use another browser. Everything but the picture works.',
    lostGraphics: 'The graphics card lost the picture. The page is drawing the picture again.',
    reload: 'Reload the page',
    connecting: 'Connecting to the simulation…',
    lost: (reason: string) => `No connection: ${reason}. Trying again. The picture is old.`,
    tokenNeeded: 'This simulation needs an access token.',
    enterToken: 'Enter the token',
    progress: 'Under way',
    busy: (work: string) => `${work}…`,
    noSession: 'No session is open. Create one under Research > Sessions > New session.',
    starting: (session: string) => `${session} is being built…`,
    opening: (session: string) => `Opening ${session}…`,
    silent: (seconds: string) => `The simulation has sent nothing for ${seconds} s. The picture is old.`,
  },
  vessels: {
    title: 'Blood vessels',
    /** a vessel in the list, without figures */
    state: (vessel: string, state: string) => `${vessel}: ${state}`,
    stateAndFigures: (vessel: string, state: string, figures: string) => `${vessel}: ${state}; ${figures}`,
  },
  video: {
    record: 'Record a video',
    stop: 'Stop and save the video',
    unsupported: 'this browser cannot record video',
    stopped: 'The browser has stopped recording. The part so far is saved.',
  },
  view: {
    title: 'View',
    colour: 'Colour',
    colourings: {
      tissue: 'tissue',
      exposure: 'heat exposure',
      charring: 'charring',
      stress: 'stress',
      temperature: 'temperature',
    },
    // titles of the legend
    legends: {
      exposure: 'Heat exposure (1: tissue parts)',
      charring: 'Charring: share of edges that heat has parted',
      stress: 'Von Mises stress',
      temperature: 'Temperature',
    },
    /** at the legend of temperature, in place of the least temperature */
    noValues: 'no values',
    layers: 'Layers',
    wireframe: 'Wireframe',
    force: 'Show the force on the tool',
    theme: 'Theme',
    themes: { 'as the system': 'as the system', 'dark': 'dark', 'light': 'light' },
    png: 'Save the picture',
  },

  // ---- hands, model and scene
};
