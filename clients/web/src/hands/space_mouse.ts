// SPDX-License-Identifier: GPL-3.0-or-later
// A 3D mouse by WebHID. Its cap moves and turns the tool, and its first button keeps energy on while held. The browser
// shows a page only devices that the user has chosen.

/** The used part of WebHID, which the types of the DOM do not have. */
interface HidDevice extends EventTarget {
  readonly productName: string;
  readonly opened: boolean;
  open(): Promise<void>;
}
interface Hid extends EventTarget {
  getDevices(): Promise<HidDevice[]>;
  requestDevice(options: { filters: object[] }): Promise<HidDevice[]>;
}
interface HidConnection extends Event {
  readonly device: HidDevice;
}
interface InputReport extends Event {
  readonly reportId: number;
  readonly data: DataView;
}

/** Vendor ids: 3Dconnexion; Logitech with the usage page of multi-axis controllers. */
const FILTERS = [{ vendorId: 0x256f }, { vendorId: 0x046d, usagePage: 1, usage: 8 }];
const FULL = 350; // full deflection of the cap, in each direction
const REST = 0.06; // share of the full deflection that a resting hand causes
const SPEED_M_S = 0.045;
const TURN_RAD_S = 1.6;
const MOVED = 1, TURNED = 2, BUTTONS = 3;
const AXIS_BYTES = 2;

export interface LedByCap {
  nudge(right: number, up: number, nearer: number): void;
  turn(aboutShaft: number, tilt: number): void;
  hold(): void;
  letGo(unplugged: boolean): void;
}

export class SpaceMouse {
  /** deflections, -1 to 1: right, towards the hand, down, and the turns about these axes */
  private readonly axes = [0, 0, 0, 0, 0, 0];
  private device: HidDevice | null = null;
  /** last reported state of the button; kept while the mouse is unplugged, so that a held button is not a new press */
  private pressed = false;
  private last = performance.now();

  constructor(
    private readonly led: LedByCap,
    private readonly changed: () => void,
  ) {
    this.hid?.addEventListener('connect', (event) => {
      // A mouse that was chosen before was plugged in.
      if (!this.device) void this.use((event as HidConnection).device).catch(() => undefined);
    });
    this.hid?.addEventListener('disconnect', (event) => {
      if ((event as HidConnection).device === this.device) this.lose();
    });
    // The browser remembers a mouse that was chosen before.
    void this.hid?.getDevices().then(([known]) => (known ? this.use(known) : undefined), () => undefined);
  }

  get offered(): boolean {
    return this.hid !== undefined;
  }

  /** Returns the name of the mouse; null: no mouse is in use. */
  get name(): string | null {
    return this.device?.productName ?? null;
  }

  /** Opens the browser's dialog for choosing a device. */
  async choose(): Promise<void> {
    const [chosen] = (await this.hid?.requestDevice({ filters: FILTERS })) ?? [];
    if (chosen) await this.use(chosen);
  }

  /** Applies the cap; called once per animation frame. */
  advance(): void {
    const now = performance.now();
    const seconds = Math.min((now - this.last) / 1000, 0.1);
    this.last = now;
    const [x, y, z, pitch, , twist] = this.axes.map((share) => (Math.abs(share) > REST ? share : 0));
    const [step, turn] = [SPEED_M_S * seconds, TURN_RAD_S * seconds];
    if (x !== 0 || y !== 0 || z !== 0) this.led.nudge(x * step, -y * step, -z * step);
    if (pitch !== 0 || twist !== 0) this.led.turn(twist * turn, pitch * turn);
  }

  private get hid(): Hid | undefined {
    return (navigator as { hid?: Hid }).hid;
  }

  private async use(device: HidDevice): Promise<void> {
    if (!device.opened) await device.open();
    device.addEventListener('inputreport', this.report); // registered already if the mouse was plugged in again
    this.device = device;
    this.changed();
  }

  private readonly report = (event: Event): void => this.take(event as InputReport);

  private take({ reportId, data }: InputReport): void {
    if (reportId === BUTTONS) {
      this.press(data.byteLength > 0 && (data.getUint8(0) & 1) !== 0);
      return;
    }
    if (reportId !== MOVED && reportId !== TURNED) return;
    // Newer mice send all six axes in one report.
    const first = reportId === TURNED ? 3 : 0;
    const count = Math.min(Math.floor(data.byteLength / AXIS_BYTES), 6 - first);
    for (let i = 0; i < count; i++) this.axes[first + i] = Math.min(Math.max(data.getInt16(AXIS_BYTES * i, true) / FULL, -1), 1);
  }

  /** Handles the first button. Each report has all buttons, so only a change of the first button counts. */
  private press(down: boolean): void {
    if (down && !this.pressed) this.led.hold();
    if (!down && this.pressed) this.led.letGo(false);
    this.pressed = down;
  }

  private lose(): void {
    this.device = null;
    this.axes.fill(0);
    this.led.letGo(true);
    this.changed();
  }
}
