// SPDX-License-Identifier: GPL-3.0-or-later
// Plays the sounds that model/sounds.ts chooses. All are computed. A browser allows sound only after a press on the page.
import { heardOf, heartbeatLost, type Heard } from '../model/sounds';
import type { Model } from '../model/model';
import type { ToolState } from '../wire/records';

export type Sound = 'tone' | 'sizzle' | 'alarm';

const TONE_GAIN = 0.05;
const SIZZLE_GAIN = 0.10;
const ALARM_GAIN = 0.14;
const ALARM_HZ = [1180, 880, 1180, 880] as const; // no frequency of an activation tone, and always several tones
const BEEP_S = 0.16;
const FADE_S = 0.012; // fade time, so that sounds begin and end without a click
const NOISE_S = 2;
const SIZZLE_HZ = 5200;
const SILENT_MS = 400; // time without frames after which it is unknown whether energy is on
const REST_MS = 5000; // silence after which the browser stops computing sound

interface Voices {
  context: AudioContext;
  tone: OscillatorNode;
  toneGain: GainNode;
  sizzleGain: GainNode;
}

/** Returns noise whose loudness jumps, like boiling drops. */
function crackle(context: AudioContext): AudioBufferSourceNode {
  const buffer = context.createBuffer(1, NOISE_S * context.sampleRate, context.sampleRate);
  const samples = buffer.getChannelData(0);
  let loud = 0;
  for (let i = 0; i < samples.length; i++) {
    if (Math.random() < 0.0012) loud = Math.random();
    loud *= 0.9985;
    samples[i] = (0.25 + loud) * (2 * Math.random() - 1);
  }
  return new AudioBufferSourceNode(context, { buffer, loop: true });
}

function makeVoices(): Voices {
  const context = new AudioContext();
  const tone = new OscillatorNode(context, { type: 'triangle' });
  const [toneGain, sizzleGain] = [new GainNode(context, { gain: 0 }), new GainNode(context, { gain: 0 })];
  const noise = crackle(context);
  tone.connect(toneGain).connect(context.destination);
  noise.connect(new BiquadFilterNode(context, { type: 'bandpass', frequency: SIZZLE_HZ, Q: 0.6 })).connect(sizzleGain).connect(context.destination);
  tone.start();
  noise.start();
  return { context, tone, toneGain, sizzleGain };
}

export class Sounds {
  /** what sounds now: the instruments' sounds that the user's settings allow */
  heard: Heard = { toneHz: 0, sizzle: 0 };
  /** number of alarms since the page was loaded */
  alarms = 0;
  private voices: Voices | null = null;
  private readonly on: Record<Sound, boolean> = { tone: true, sizzle: true, alarm: true };
  private before: readonly ToolState[] = [];
  /** instrument that this page drove at the last frame; null without a connection */
  private led: string | null = null;
  private faces: number | null = null;
  private framedAt = 0;
  private soundedAt = 0;

  constructor(private readonly model: Model) {
    const begin = (): void => this.begin();
    for (const event of ['pointerdown', 'keydown'] as const) window.addEventListener(event, begin, { capture: true });
    model.on('frame', () => this.listen());
    model.on('joined', () => this.silence());
    model.on('link', ({ state }) => {
      if (state === 'online') return;
      if (this.before.some(({ name, energized }) => energized && name === this.led)) this.alarm();
      this.silence();
    });
    setInterval(() => {
      if (performance.now() - this.framedAt > SILENT_MS) this.make({ toneHz: 0, sizzle: 0 });
      if (performance.now() - this.soundedAt > REST_MS) void this.voices?.context.suspend();
    }, SILENT_MS / 2);
  }

  turn(sound: Sound, on: boolean): void {
    this.on[sound] = on;
    this.make(this.heard);
  }

  private begin(): void {
    if (typeof AudioContext === 'undefined') return;
    this.voices ??= makeVoices();
    this.wake(this.voices.context);
  }

  private wake(context: AudioContext): void {
    this.soundedAt = performance.now();
    if (context.state === 'suspended') void context.resume();
  }

  private listen(): void {
    const { frame, tools } = this.model;
    if (!frame) return;
    this.framedAt = performance.now();
    const faces = Object.values(frame.drawnFaces).reduce((sum, count) => sum + count, 0);
    const removed = Math.max((this.faces ?? faces) - faces, 0);
    if (heartbeatLost(this.before, frame.tools)) this.alarm();
    this.before = frame.tools;
    this.led = this.model.driving ? this.model.selectedTool : null;
    this.faces = faces;
    this.make(frame.paused ? { toneHz: 0, sizzle: 0 } : heardOf(tools, frame.tools, removed));
  }

  private silence(): void {
    this.before = [];
    this.faces = null;
    this.make({ toneHz: 0, sizzle: 0 });
  }

  private make({ toneHz, sizzle }: Heard): void {
    this.heard = { toneHz: this.on.tone ? toneHz : 0, sizzle: this.on.sizzle ? sizzle : 0 };
    if (!this.voices) return;
    const { context, tone, toneGain, sizzleGain } = this.voices;
    const now = context.currentTime;
    if (this.heard.toneHz > 0 || this.heard.sizzle > 0) this.wake(context);
    if (this.heard.toneHz > 0) tone.frequency.setValueAtTime(this.heard.toneHz, now);
    toneGain.gain.setTargetAtTime(this.heard.toneHz > 0 ? TONE_GAIN : 0, now, FADE_S);
    sizzleGain.gain.setTargetAtTime(SIZZLE_GAIN * this.heard.sizzle, now, 4 * FADE_S);
  }

  private alarm(): void {
    if (!this.on.alarm) return;
    this.alarms++;
    if (!this.voices) return;
    const { context } = this.voices;
    this.wake(context);
    ALARM_HZ.forEach((frequency, i) => {
      const beep = new OscillatorNode(context, { type: 'square', frequency });
      const at = context.currentTime + i * BEEP_S;
      beep.connect(new GainNode(context, { gain: ALARM_GAIN })).connect(context.destination);
      beep.start(at);
      beep.stop(at + 0.8 * BEEP_S);
    });
  }
}
