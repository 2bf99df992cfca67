// Random input from several pages for a while: the program must live, its memory stay bounded, and input be answered.
// Usage: node soak.js [SECONDS] [SEED]; SECONDS is 300 without it.
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { browser, folder, open, pixels, rendered, settled, view } from './support.js';

const seconds = Number(process.argv[2] ?? 300);
const seed = Number(process.argv[3] ?? 1);
/** What the program may take more at the end than after the first third, in MiB. */
const MAX_GROWTH = 200;
/** 95 of 100 inputs must be answered within this, in ms: kernels are compiled in between. */
const MAX_LATENCY = 1500;

let state = seed;
const random = () => {
  // mulberry32
  state = (state + 0x6d2b79f5) | 0;
  let t = Math.imul(state ^ (state >>> 15), 1 | state);
  t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
  return ((t ^ (t >>> 14)) >>> 0) / 2 ** 32;
};
const pick = (list) => list[Math.floor(random() * list.length)];

function scene() {
  const count = 1 + Math.floor(random() * 20);
  const number = (low, high) => (low + random() * (high - low)).toFixed(3);
  const spheres = Array.from({ length: count }, (_, i) =>
    `SPHERE s${i} ${number(-4, 4)} ${number(-4, 4)} ${number(-14, -4)} ${number(0.2, 2)} ${number(0.2, 2)} ${number(0.2, 2)} ` +
    `${number(0, 1)} ${number(0, 1)} ${number(0, 1)} 0.3 0.7 0.5 ${pick(['0', '0', '0.4'])} 30`);
  return `NEAR 1\nLEFT -1\nRIGHT 1\nBOTTOM -1\nTOP 1\nRES 400 300\n${spheres.join('\n')}\n` +
    'LIGHT a 5 5 5 0.8 0.8 0.8\nAMBIENT 0.3 0.3 0.3\nBACK 0.1 0.2 0.3\n';
}

const memory = (pid) => Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${pid}/status`, 'utf8'))[1]) / 1024;
const place = folder();
const file = join(place.path, 'scene.txt');
writeFileSync(file, scene());
const server = await view('scene.txt', { cwd: place.path });
const chromium = await browser();
const problems = [];
let pages = [await open(chromium, server.url)];
await settled(pages[0]);

const actions = {
  async key(page) {
    await page.locator('#picture').focus();
    await page.keyboard.press(pick(['KeyW', 'KeyA', 'KeyS', 'KeyD', 'KeyE', 'KeyQ', 'ArrowLeft', 'ArrowUp', 'KeyR', '+', '-', '0', '1']),
      { delay: random() * 150 });
  },
  async drag(page) {
    const box = await page.locator('#picture').boundingBox();
    if (!box) return;
    await page.mouse.move(box.x + box.width * random(), box.y + box.height * random());
    await page.mouse.down();
    await page.mouse.move(box.x + box.width * random(), box.y + box.height * random(), { steps: 4 });
    await page.mouse.up();
  },
  async wheel(page) {
    if (random() < 0.5) await page.keyboard.down('Shift');
    await page.mouse.wheel(0, pick([-100, 100]));
    await page.keyboard.up('Shift');
  },
  async effect(page) { await page.locator('.effect input').nth(Math.floor(random() * 8)).click(); },
  async auto(page) { await page.locator('#auto').click(); },
  async choose(page) {
    const [id, values] = pick([['#spp', ['1', '4', '9']], ['#precision', ['auto', 'fast', 'double']],
      ['#convention', ['classic', 'exact']]]);
    await page.locator(id).selectOption(pick(values));
  },
  async size(page) {
    await page.locator('#res').fill(pick(['', '', '1x1', '640x480', '1500x900', '0x0', '3000x2']));
    await page.keyboard.press('Enter');
  },
  async pixel(page) {
    const box = await page.locator('#picture').boundingBox();
    if (box) await page.mouse.click(box.x + box.width * random() * 0.99, box.y + box.height * random() * 0.99);
  },
  async measure(page) { if (random() < 0.2) await page.locator('#measure').click(); },
  async edit() { writeFileSync(file, random() < 0.2 ? `${scene()}NONSENSE 1\n` : scene()); },
  async come() { if (pages.length < 4) pages.push(await open(chromium, server.url)); },
  async go() {
    if (pages.length < 2) return;
    const [page] = pages.splice(Math.floor(random() * pages.length), 1);
    problems.push(...page.problems);
    await page.close();
  },
};

/** From a movement to the next picture that the page draws. */
const latency = (page) => page.evaluate(() => new Promise((done) => {
  const [start, before] = [performance.now(), window.trueray.patches];
  for (const kind of ['keydown', 'keyup']) document.body.dispatchEvent(new KeyboardEvent(kind, { code: 'ArrowLeft', bubbles: true }));
  const look = () => {
    const waited = performance.now() - start;
    if (window.trueray.patches > before || waited > 20000) done(waited);
    else setTimeout(look, 1);
  };
  look();
}));

const latencies = [];
const sizes = [];
const start = performance.now();
const elapsed = () => (performance.now() - start) / 1000;
let count = 0;
let checked = 0;
while (elapsed() < seconds) {
  await actions[pick(Object.keys(actions))](pick(pages));
  count += 1;
  sizes.push([elapsed(), memory(server.pid)]);
  if (count % 5 === 0) {
    const page = pick(pages);
    // A picture of one colour does not change when the eye moves: only the state tells.
    const waited = await latency(page);
    if (waited < 20000) latencies.push(waited);
  }
  if (count % 40 === 0) {
    writeFileSync(file, scene());
    await pages[0].locator('#res').fill('200x100');
    await pages[0].keyboard.press('Enter');
    await pages[0].waitForTimeout(500);
    const now = await settled(pages[0], (s) => s.size[0] === 200 && !s.error);
    const expected = rendered(place.path, 'scene.txt', now.options.split(' ').filter(Boolean));
    if (Buffer.compare((await pixels(pages[0])).rgb, expected.rgb) !== 0) problems.push(`differs from render ${now.options}`);
    checked += 1;
  }
  if (!server.running()) { problems.push(`the program has ended: ${server.errors()}`); break; }
}
for (const page of pages) problems.push(...page.problems);
await chromium.close();
await server.stop();
place.remove();

const greatest = (list) => list.reduce((most, [, size]) => Math.max(most, size), 0);
const [early, late] = [sizes.filter(([at]) => at < seconds / 3), sizes.filter(([at]) => at >= seconds / 3)];
const growth = greatest(late) - greatest(early);
latencies.sort((a, b) => a - b);
const at = (part) => latencies[Math.floor((latencies.length - 1) * part)] ?? 0;
console.log(`${count} inputs in ${elapsed().toFixed(0)} s, ${checked} pictures compared with render`);
console.log(`memory: ${sizes[0][1].toFixed(0)} MiB at first, at most ${greatest(early).toFixed(0)} MiB in the first third and ` +
  `${greatest(late).toFixed(0)} MiB after`);
console.log(`input to changed pixels: median ${at(0.5).toFixed(0)} ms, 95 of 100 within ${at(0.95).toFixed(0)} ms, ` +
  `greatest ${at(1).toFixed(0)} ms`);
if (growth > MAX_GROWTH) problems.push(`memory has grown by ${growth.toFixed(0)} MiB`);
if (at(0.95) > MAX_LATENCY) problems.push(`input is answered after ${at(0.95).toFixed(0)} ms`);
for (const problem of problems) console.error(`problem: ${problem}`);
process.exit(problems.length > 0 ? 1 : 0);
