// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures with smooth edges: four samples a pixel, in buffers beside the canvas. The canvas itself has one sample, since
// its number of samples is fixed, and in software four of them make a picture take two and a half times as long.
import type { WebGLRenderer } from 'three';

const COUNT = 4;

interface Target {
  framebuffer: WebGLFramebuffer | null;
  colour: WebGLRenderbuffer | null;
  depth: WebGLRenderbuffer | null;
}

export class Samples {
  private readonly gl: WebGL2RenderingContext;
  private many: Target | null = null;
  /** the mean of a pixel's samples: buffers of many samples are only copied to their own format, which the canvas may not have */
  private mean: Target | null = null;
  private size: readonly [number, number] = [0, 0];

  constructor(private readonly renderer: WebGLRenderer) {
    this.gl = renderer.getContext() as WebGL2RenderingContext;
  }

  /** The context was lost, and all buffers with it. */
  lose(): void {
    this.many = this.mean = null;
  }

  /** Calls `render`, which draws to the canvas, with the buffers in the canvas's place, and copies the picture to the canvas. */
  draw(render: () => void): void {
    const { gl, renderer: { state } } = this;
    const { many, mean } = this.targets();
    state.bindFramebuffer(gl.FRAMEBUFFER, many.framebuffer);
    render();
    gl.invalidateFramebuffer(gl.FRAMEBUFFER, [gl.DEPTH_ATTACHMENT]);
    for (const [from, to] of [[many, mean], [mean, null]] as const) {
      state.bindFramebuffer(gl.READ_FRAMEBUFFER, from.framebuffer);
      state.bindFramebuffer(gl.DRAW_FRAMEBUFFER, to?.framebuffer ?? null);
      gl.blitFramebuffer(0, 0, ...this.size, 0, 0, ...this.size, gl.COLOR_BUFFER_BIT, gl.NEAREST);
    }
    state.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  /** Of the canvas's size. */
  private targets(): { many: Target; mean: Target } {
    const { drawingBufferWidth: width, drawingBufferHeight: height } = this.gl;
    if (!this.many || !this.mean || this.size[0] !== width || this.size[1] !== height) {
      this.dispose();
      this.size = [width, height];
      this.many = this.make(COUNT, true);
      this.mean = this.make(0, false);
    }
    return { many: this.many, mean: this.mean };
  }

  private make(samples: number, withDepth: boolean): Target {
    const { gl, size, renderer: { state } } = this;
    const framebuffer = gl.createFramebuffer();
    state.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
    const attach = (format: number, attachment: number): WebGLRenderbuffer => {
      const buffer = gl.createRenderbuffer();
      gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
      gl.renderbufferStorageMultisample(gl.RENDERBUFFER, samples, format, ...size);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, attachment, gl.RENDERBUFFER, buffer);
      return buffer;
    };
    return { framebuffer, colour: attach(gl.RGBA8, gl.COLOR_ATTACHMENT0), depth: withDepth ? attach(gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT) : null };
  }

  private dispose(): void {
    for (const target of [this.many, this.mean]) {
      if (!target) continue;
      this.gl.deleteFramebuffer(target.framebuffer);
      for (const buffer of [target.colour, target.depth]) this.gl.deleteRenderbuffer(buffer);
    }
    this.lose();
  }
}
