// SPDX-License-Identifier: GPL-3.0-or-later
// Tests a video of the picture, saved by the browser's own recorder. A program of other authors reads it.
import { spawnSync } from 'node:child_process';
import { existsSync } from 'node:fs';

import { Stage } from './stage';

const FFPROBE = '/usr/bin/ffprobe';
const DRAWN = 15;
const SHARE_KEPT = 1 / 3; // least share of pictures in the video: the encoder leaves some out if the machine is busy

interface Probed {
  streams: { codec_type: string; codec_name: string; width: number; height: number; nb_read_frames: string }[];
}

describe('a video of what is seen', () => {
  const stage = new Stage(['--demo', 'fascia']);

  it('is saved where it is stopped, and has pictures in it', async (context) => {
    if (!existsSync(FFPROBE)) {
      process.stdout.write(`skipped: no ${FFPROBE} to read the video with (Debian's package ffmpeg has it)\n`);
      context.skip();
    }
    const viewer = await stage.open();
    const { page } = viewer;
    await viewer.live('d1-fascia');
    await page.getByRole('tab', { name: 'View' }).click();
    await page.getByRole('button', { name: 'Record a video' }).click();
    const stop = page.getByRole('button', { name: 'Stop and save the video' });
    await stop.waitFor();
    expect(await stop.getAttribute('aria-pressed')).toBe('true');
    const { picturesDrawn: before } = await viewer.state();
    let drawn = 0;
    await page.mouse.move(400, 300);
    await page.mouse.down({ button: 'right' });
    for (let i = 0; drawn < DRAWN; i++) {
      await page.mouse.move(400 + 4 * i, 300 + i); // turns the camera
      await viewer.drawn();
      drawn = (await viewer.state()).picturesDrawn - before;
    }
    await page.mouse.up({ button: 'right' });
    const [download] = await Promise.all([page.waitForEvent('download'), stop.click()]);
    expect(download.suggestedFilename()).toMatch(/^cautery-d1-fascia-\d+\.(webm|mp4)$/);
    await page.getByRole('button', { name: 'Record a video' }).waitFor();
    const made = spawnSync(FFPROBE, ['-v', 'error', '-count_frames', '-show_streams', '-of', 'json', await download.path()]);
    expect(made.stderr.toString()).toBe('');
    const { streams } = JSON.parse(made.stdout.toString()) as Probed;
    expect(streams).toHaveLength(1);
    const [video] = streams;
    process.stdout.write(`${video.codec_name}, ${video.width} x ${video.height}, ${video.nb_read_frames} pictures of ${drawn} drawn\n`);
    expect(video.codec_type).toBe('video');
    expect(Number(video.nb_read_frames)).toBeGreaterThanOrEqual(SHARE_KEPT * drawn);
    expect(video.width / video.height).toBeGreaterThan(0.5);
    expect(viewer.complaints).toEqual([]);
    await viewer.close();
  });
});
