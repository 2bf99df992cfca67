// How fast a page is: first pixels, frames while moving, key press to changed pixels.
// Usage: node speed.js [SCENE [OPTION OF view]…], such as: node speed.js scene.txt --res 1920x1080
import { dirname, basename, resolve } from 'node:path';
import { browser, open, settled, view } from './support.js';

const scene = resolve(process.argv[2] ?? '../../scenes/show/showcase.txt');
const options = process.argv.slice(3);
const median = (values) => values.toSorted((a, b) => a - b)[Math.floor(values.length / 2)];
const chromium = await browser();

/** The time from the command to the first pixels, of a client that connects as soon as it knows where. */
async function firstPixels() {
  const server = await view(basename(scene), { cwd: dirname(scene), options });
  const socket = new WebSocket(`${server.url.replace('http', 'ws')}ws`, { headers: { origin: new URL(server.url).origin } });
  socket.binaryType = 'arraybuffer';
  const time = await new Promise((done, failed) => {
    socket.onerror = (event) => failed(event.error ?? new Error('no connection'));
    socket.onmessage = ({ data }) => { if (typeof data !== 'string') done(performance.now() - server.started); };
  });
  socket.close();
  await server.stop();
  return time;
}

try {
  if (globalThis.WebSocket) {
    const times = [];
    for (let i = 0; i < 5; i += 1) times.push(await firstPixels());
    console.log(`first pixels after the command: median ${median(times).toFixed(0)} ms, ` +
      `${Math.min(...times).toFixed(0)} … ${Math.max(...times).toFixed(0)} ms`);
  } else {
    console.log('first pixels after the command: not measured, needs Node 22 or node --experimental-websocket');
  }

  const server = await view(basename(scene), { cwd: dirname(scene), options });
  const page = await open(chromium, server.url);
  await settled(page);
  const drawn = await page.evaluate(() => performance.getEntriesByType('navigation')[0].duration);
  console.log(`page loaded in ${drawn.toFixed(0)} ms`);
  await page.locator('#picture').focus();

  // Latency: from a key press at rest to the next patch that is drawn.
  const latencies = [];
  for (let i = 0; i < 15; i += 1) {
    latencies.push(await page.evaluate(() => new Promise((done) => {
      const start = performance.now();
      const before = window.trueray.patches;
      const look = () => {
        if (window.trueray.patches > before) {
          dispatchEvent(new KeyboardEvent('keyup', { code: 'ArrowLeft' }));
          done(performance.now() - start);
        } else {
          setTimeout(look, 0);
        }
      };
      document.body.dispatchEvent(new KeyboardEvent('keydown', { code: 'ArrowLeft', bubbles: true }));
      look();
    })));
    await page.waitForTimeout(150);
    await settled(page);
  }
  console.log(`key press to changed pixels: median ${median(latencies).toFixed(0)} ms, greatest ` +
    `${Math.max(...latencies).toFixed(0)} ms`);

  for (const key of ['ArrowLeft', 'KeyD']) {
    const before = await page.evaluate(() => [performance.now(), window.trueray.patches]);
    const [steps, parts] = [[], []];
    await page.keyboard.down(key);
    for (let i = 0; i < 30; i += 1) {
      await page.waitForTimeout(100);
      const { step, sampled, size } = await page.evaluate(() => window.trueray.state);
      steps.push(step);
      parts.push(sampled ? sampled.pixels / (size[0] * size[1]) : 1);
    }
    const after = await page.evaluate(() => [performance.now(), window.trueray.patches]);
    await page.keyboard.up(key);
    const rate = (after[1] - before[1]) / (after[0] - before[0]) * 1000;
    console.log(`moving with ${key}: ${rate.toFixed(1)} pictures a second, every ${median(steps)}th pixel, ` +
      `${(100 * median(parts)).toFixed(1)} % of them sampled (medians)`);
    await page.waitForTimeout(300);
    await settled(page);
  }
  await server.stop();
} finally {
  await chromium.close();
}
