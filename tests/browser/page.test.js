// The page of `trueray view` in a real browser.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, afterEach, before, beforeEach, test } from 'node:test';
import { browser, folder, open, pixels, program, rendered, settled, view } from './support.js';
import { execFileSync } from 'node:child_process';

const SCENE = `NEAR 1
LEFT -1
RIGHT 1
BOTTOM -1
TOP 1
RES 200 160
SPHERE red 0 0 -10 2 4 2 0.5 0 0 1 1 0.9 0 50
SPHERE mirror 4 4 -10 1 2 1 0 0.5 0 1 1 0.9 0.4 50
LIGHT l 0 0 0 0.9 0.9 0.9
LIGHT m 10 10 -10 0.9 0.9 0
BACK 0.8 0.9 1
AMBIENT 0.2 0.2 0.2
`;

let chromium;
let place;
let server;
let page;

before(async () => { chromium = await browser(); });
after(async () => { await chromium?.close(); });

beforeEach(async () => {
  place = folder();
  writeFileSync(join(place.path, 'scene.txt'), SCENE);
  server = await view('scene.txt', { cwd: place.path });
  page = await open(chromium, server.url);
});

afterEach(async () => {
  const problems = page?.problems ?? [];
  await page?.close();
  const ran = server?.running();
  await server?.stop();
  place?.remove();
  assert.ok(ran, `the program has ended: ${server?.errors()}`);
  assert.deepEqual(problems, []);
});

function assertSame(a, b) {
  assert.deepEqual([a.width, a.height], [b.width, b.height]);
  assert.equal(Buffer.compare(a.rgb, b.rgb), 0, 'the pixels differ');
}

/** What the page says of its picture, and shows by it. */
async function shows(kind, words, on = page) {
  await on.locator(`#stage[data-picture=${kind}]`).waitFor();
  assert.match(await on.locator('#status').textContent(), words);
  const canvas = await on.locator('#picture').evaluate((canvas) => [getComputedStyle(canvas).visibility, getComputedStyle(canvas).opacity]);
  // The opacity is on its way.
  if (kind === 'none') assert.equal(canvas[0], 'hidden');
  else assert.equal(canvas[0], 'visible');
}

async function screenshot(name, on = page) {
  if (process.env.SCREENSHOTS) await on.screenshot({ path: join(process.env.SCREENSHOTS, `${name}.png`) });
}

/** Waits until all that is told of a pixel is there. */
async function told(on = page) {
  await on.waitForFunction(() => window.trueray.table && !window.trueray.table.waits);
}

/** The options that the page shows, as `trueray render` takes them. */
const options = (state) => state.options.split(' ').filter(Boolean);

test('the page shows the pixels of render', async () => {
  const state = await settled(page);
  assert.equal(state.options, '');
  assertSame(await pixels(page), rendered(place.path, 'scene.txt'));
});

test('keys, mouse and wheel move the eye, and R brings it back', async () => {
  const first = await settled(page);
  await page.locator('#picture').focus();
  await page.keyboard.down('KeyW');
  await page.waitForFunction(() => window.trueray.state.eye[2] < -0.2);
  await page.keyboard.up('KeyW');
  await page.waitForTimeout(200);
  let state = await settled(page, (state) => state.eye[2] < -0.2);
  assertSame(await pixels(page), rendered(place.path, 'scene.txt', options(state)));

  const box = await page.locator('#picture').boundingBox();
  const middle = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(...middle);
  await page.mouse.down();
  await page.mouse.move(middle[0] - 40, middle[1] + 20, { steps: 5 });
  await page.mouse.up();
  await page.waitForTimeout(200);
  state = await settled(page, (state) => state.eye[0] > 0.5 && state.eye[1] > 0.2);
  assertSame(await pixels(page), rendered(place.path, 'scene.txt', options(state)));

  const { version } = state;
  await page.keyboard.down('Shift');
  await page.mouse.wheel(0, -100);
  await page.keyboard.up('Shift');
  state = await settled(page, (state) => state.version > version);
  assertSame(await pixels(page), rendered(place.path, 'scene.txt', options(state)));

  await page.locator('#picture').focus();
  await page.keyboard.press('KeyR');
  state = await settled(page, (state) => state.options === '');
  assert.deepEqual(state.eye, first.eye);
  assertSame(await pixels(page), rendered(place.path, 'scene.txt'));
});

test('toggles change the picture as the options of render do', async () => {
  await settled(page);
  await page.locator('#effect-shadows').click();
  let state = await settled(page, (state) => !state.effects.find((row) => row.effect === 'shadows').on);
  assert.match(state.options, /--effects=/);
  assertSame(await pixels(page), rendered(place.path, 'scene.txt', options(state)));
  assert.match(await page.locator('label.effect', { hasText: 'shadows' }).textContent(), /forced off/);
  await page.locator('#auto').click();
  await page.locator('#convention').selectOption('exact');
  await page.locator('#precision').selectOption('double');
  await page.locator('#spp').selectOption('4');
  await page.locator('#depth').fill('1');
  await page.locator('#res').fill('150x90');
  await page.keyboard.press('Enter');
  state = await settled(page, (state) => state.size[0] === 150 && state.controls.max_depth === 1 && state.samples === 4);
  for (const option of ['--convention exact', '--precision double', '--spp 4', '--max-depth 1', '--res 150x90']) {
    assert.ok(state.options.includes(option), `${option} in ${state.options}`);
  }
  assertSame(await pixels(page), rendered(place.path, 'scene.txt', options(state)));
});

test('the scene is watched, and an error keeps the last picture', async () => {
  await settled(page);
  const edited = SCENE.replace('BACK 0.8', 'BACK 0.1');
  writeFileSync(join(place.path, 'scene.txt'), edited);
  await page.waitForFunction(() => {
    const [red] = document.getElementById('picture').getContext('2d').getImageData(0, 0, 1, 1).data;
    return red === 25;
  });
  await settled(page);
  assertSame(await pixels(page), rendered(place.path, 'scene.txt'));
  const good = await pixels(page);
  writeFileSync(join(place.path, 'scene.txt'), edited.replace('LIGHT l 0 0 0', 'LIGHT l 0 zero 0'));
  const error = page.locator('#error');
  await error.waitFor({ state: 'visible' });
  assert.match(await error.textContent(), /line 9[^]*zero/);
  await shows('stale', /the scene file has an error/);
  assertSame(await pixels(page), good);
  if (process.env.SCREENSHOTS) await page.screenshot({ path: join(process.env.SCREENSHOTS, 'error.png') });
  writeFileSync(join(place.path, 'scene.txt'), SCENE);
  await error.waitFor({ state: 'hidden' });
  await settled(page);
  await shows('full', /the full picture/);
  assertSame(await pixels(page), rendered(place.path, 'scene.txt'));
});

test('a click tells what a pixel shows, and the picture is saved as render writes it', async () => {
  await settled(page);
  const box = await page.locator('#picture').boundingBox();
  await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
  await page.locator('#pixel', { hasText: 'red (index 0)' }).waitFor();
  const { x, y, rgb } = await page.evaluate(() => window.trueray.pixel);
  const picture = rendered(place.path, 'scene.txt');
  assert.deepEqual(rgb, [...picture.rgb.subarray((y * picture.width + x) * 3, (y * picture.width + x) * 3 + 3)]);
  const mark = await page.locator('#mark').boundingBox();
  assert.ok(Math.abs(mark.x + mark.width / 2 - box.x - (x + 0.5) * box.width / picture.width) < 1, JSON.stringify(mark));
  assert.ok(Math.abs(mark.y + mark.height / 2 - box.y - (y + 0.5) * box.height / picture.height) < 1, JSON.stringify(mark));
  assert.match(await page.locator('#table').textContent(), /taken: the least root that counts/);

  // The reference, its source in f32, and each tier of the device: what the command tells.
  await told();
  const command = (...more) => execFileSync(program, ['pixel', 'scene.txt', `${x}`, `${y}`, ...more],
    { cwd: place.path, encoding: 'utf8', env: { ...process.env, NODEVICE_SELECT: '1' } });
  const json = JSON.parse(command('--json'));
  const groups = await page.locator('#beside tbody').evaluateAll((bodies) => bodies.map((body) => [...body.querySelectorAll('th, td')].map((cell) => cell.textContent)));
  const nine = (value) => Number(value.toPrecision(9)).toString();
  const ulp = (tier) => `, off in ulp of ${tier.ulps_f64 ? 'f64' : 'f32'}`;
  const expected = [['CPU reference in f64', json.reference], [`its source in f32${ulp(json.single)}`, json.single],
    ...json.tiers.map((tier) => [tier.tier + ulp(tier), tier])];
  assert.deepEqual(groups.slice(0, expected.length).map((cells) => cells.slice(0, 4)), expected.map(([name, { color }]) => [name, ...color.map(nine)]));
  const signed = (off) => `${off < 0 ? '−' : '+'}${Math.abs(off).toFixed(1)}`;
  json.tiers.forEach((tier, index) => assert.deepEqual(groups[index + 2].slice(4, 7), (tier.ulps_f64 ?? tier.ulps).map(signed)));
  assert.match(groups[0][4], /^levels \d+ \d+ \d+; nearest decision: [a-z ]+, margin [\d.e-]+$/);
  json.tiers.forEach(({ verdict }, index) => assert.equal(groups[index + 2].at(-1) === 'the same levels', verdict === 'same'));
  if (json.device) assert.equal(await page.locator('#table').textContent(), command());
  await screenshot('pixel');

  await page.locator('#measure').click();
  await page.locator('.cost', { hasText: /(costs|saves) / }).nth(6).waitFor({ timeout: 60000 });

  const [download] = await Promise.all([page.waitForEvent('download'), page.locator('#save').click()]);
  assert.equal(download.suggestedFilename(), 'scene.png');
  execFileSync(program, ['render', '-q', 'scene.txt', '-o', 'render.png'],
    { cwd: place.path, env: { ...process.env, NODEVICE_SELECT: '1' } });
  assert.ok(readFileSync(await download.path()).equals(readFileSync(join(place.path, 'render.png'))), 'the files differ');
  if (process.env.SCREENSHOTS) await page.screenshot({ path: join(process.env.SCREENSHOTS, 'page.png') });

  // Another eye sees something else there.
  await page.locator('#picture').focus();
  await page.keyboard.press('ArrowLeft');
  await page.locator('#pixel-title', { hasText: 'Pixel of an earlier view' }).waitFor();
});

test('a recorded path is what --views renders', async () => {
  await settled(page);
  await page.locator('#record').click();
  await page.locator('#picture').focus();
  await page.keyboard.down('KeyW');
  await page.waitForFunction(() => window.trueray.state.eye[2] < -0.2);
  await page.keyboard.up('KeyW');
  await page.waitForTimeout(200);
  await settled(page, (state) => state.eye[2] < -0.2);
  const [download] = await Promise.all([page.waitForEvent('download'), page.locator('#record').click()]);
  assert.equal(download.suggestedFilename(), 'views.csv');
  const path = await download.path();
  const frames = readFileSync(path, 'utf8').trim().split('\n').length - 1;
  assert.ok(frames > 1, `${frames} frames`);
  execFileSync(program, ['render', '-q', '--views', path, 'scene.txt', '-o', 'f%d.ppm'],
    { cwd: place.path, env: { ...process.env, NODEVICE_SELECT: '1' } });
  execFileSync(program, ['render', '-q', 'scene.txt', '-o', 'first.ppm'],
    { cwd: place.path, env: { ...process.env, NODEVICE_SELECT: '1' } });
  assert.ok(readFileSync(join(place.path, 'f1.ppm')).equals(readFileSync(join(place.path, 'first.ppm'))));
  const last = readFileSync(join(place.path, `f${frames}.ppm`));
  assert.equal(Buffer.compare((await pixels(page)).rgb, last.subarray(-200 * 160 * 3)), 0, 'the last view');
});

test('pages have their own views, and a page that goes away harms nobody', async () => {
  await settled(page);
  const other = await open(chromium, server.url);
  await settled(other);
  await other.locator('#picture').focus();
  await other.keyboard.down('KeyD');
  await other.waitForFunction(() => window.trueray.state.eye[0] > 0.3);
  await other.close();
  const { eye } = await page.evaluate(() => window.trueray.state);
  assert.deepEqual(eye, [0, 0, 0]);
  await page.locator('#effect-diffuse').click();
  const state = await settled(page, (state) => !state.effects.find((row) => row.effect === 'diffuse').on);
  assertSame(await pixels(page), rendered(place.path, 'scene.txt', options(state)));
});

test('a window of one pixel and a picture of eight thousand', async () => {
  await page.setViewportSize({ width: 1, height: 1 });
  await settled(page);
  await page.setViewportSize({ width: 1300, height: 800 });
  await page.locator('#res').fill('1x1');
  await page.keyboard.press('Enter');
  let state = await settled(page, (state) => state.size[0] === 1);
  assertSame(await pixels(page), rendered(place.path, 'scene.txt', options(state)));
  await page.locator('#res').fill('8000x40');
  await page.keyboard.press('Enter');
  state = await settled(page, (state) => state.size[0] === 8000);
  assertSame(await pixels(page), rendered(place.path, 'scene.txt', options(state)));
});

test('a moving picture has fewer samples, or fewer pixels, and at rest it is that of render', async () => {
  await settled(page);
  await page.locator('#res').fill('1800x1400');
  await page.keyboard.press('Enter');
  await settled(page, (state) => state.size[0] === 1800);
  const move = async (key, property) => {
    await page.locator('#picture').focus();
    await page.keyboard.down(key);
    await page.waitForFunction(property);
    if (process.env.SCREENSHOTS) await page.screenshot({ path: join(process.env.SCREENSHOTS, `moving-${key}.png`) });
    await page.keyboard.up(key);
    await page.waitForTimeout(300);
    const state = await settled(page);
    assertSame(await pixels(page), rendered(place.path, 'scene.txt', options(state)));
  };
  const box = await page.locator('#picture').boundingBox();
  await page.mouse.move(box.x + box.width / 4, box.y + box.height / 2);
  await move('ArrowLeft', () => window.trueray.sampled > 2 && window.trueray.state.sampled?.density.fovea?.center[0] === 450);
  assert.match(await page.locator('#shown').textContent(), /the full picture/);
  await page.locator('#mode').selectOption('sparse');
  await page.locator('#least').selectOption('0.0625');
  await move('ArrowRight', () => window.trueray.state.sampled && !window.trueray.state.sampled.density.fovea);
  await page.locator('#mode').selectOption('coarse');
  await move('ArrowUp', () => window.trueray.state.step > 1);
});

/** Where the picture is, and how many pixels of the screen one of its own takes. */
async function shown() {
  const box = await page.locator('#picture').boundingBox();
  return { ...box, scale: box.width / 200 };
}

test('the picture is magnified pixel by pixel, and a click finds the same pixel', async () => {
  await settled(page);
  const fit = await shown();
  assert.equal(fit.scale, 4, 'as large as fits, in whole pixels');
  await page.locator('#actual').click();
  assert.equal((await shown()).scale, 1);
  assert.equal(await page.locator('#scale').textContent(), '100 %');
  await page.locator('#fit').click();
  assert.deepEqual(await shown(), fit);
  assert.equal(await page.locator('#picture').evaluate((canvas) => getComputedStyle(canvas).imageRendering), 'pixelated');

  // What is under the pointer stays there, and the eye where it is.
  const at = [fit.x + fit.width * 0.42 + 1, fit.y + fit.height * 0.57 + 1];
  const under = ({ x, y, scale }) => [(at[0] - x) / scale, (at[1] - y) / scale];
  const { version } = await page.evaluate(() => window.trueray.state);
  await page.mouse.move(...at);
  for (let notch = 0; notch < 4; notch += 1) await page.mouse.wheel(0, -100);
  await page.waitForFunction(() => document.getElementById('picture').clientWidth > 2900);
  const large = await shown();
  const [first, after] = [under(fit), under(large)];
  assert.ok(Math.hypot(first[0] - after[0], first[1] - after[1]) < 0.3, `${first}, ${after}`);
  await page.mouse.click(...at);
  await page.waitForFunction(() => window.trueray.pixel);
  const { x, y } = await page.evaluate(() => window.trueray.pixel);
  assert.deepEqual([x, y], after.map(Math.floor));
  const mark = await page.locator('#mark').boundingBox();
  assert.ok(mark.x < at[0] && at[0] < mark.x + mark.width && mark.y < at[1] && at[1] < mark.y + mark.height);
  await screenshot('magnified');
  await page.locator('#smaller').click();
  const marked = await page.locator('#mark').boundingBox();
  const smaller = await shown();
  assert.ok(Math.abs(marked.x + marked.width / 2 - smaller.x - (x + 0.5) * smaller.scale) < 1, 'the mark follows');

  await page.keyboard.down('Control');
  await page.mouse.move(...at);
  await page.mouse.down();
  await page.mouse.move(at[0] + 60, at[1] + 30, { steps: 6 });
  await page.mouse.up();
  await page.keyboard.up('Control');
  const moved = await shown();
  assert.ok(moved.x - smaller.x > 50 && moved.y - smaller.y > 20, 'moved');
  await page.keyboard.press('0');
  assert.deepEqual(await shown(), fit);
  await page.keyboard.press('+');
  assert.equal((await shown()).scale, 6);
  await page.keyboard.press('1');
  assert.equal((await shown()).scale, 1);
  assert.equal((await page.evaluate(() => window.trueray.state)).version, version, 'the eye has not moved');
});

test('two fingers magnify the picture, and one of them orbits', async () => {
  await settled(page);
  await page.locator('#actual').click();
  const box = await shown();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  const session = await page.context().newCDPSession(page);
  await session.send('Emulation.setTouchEmulationEnabled', { enabled: true, maxTouchPoints: 2 });
  const touch = (type, ...points) => session.send('Input.dispatchTouchEvent',
    { type, touchPoints: points.map(([px, py], id) => ({ x: px, y: py, id })) });
  await touch('touchStart', [x - 20, y]);
  await touch('touchStart', [x - 20, y], [x + 20, y]);
  for (let apart = 25; apart <= 60; apart += 5) await touch('touchMove', [x - apart, y], [x + apart, y]);
  await touch('touchEnd');
  const { scale } = await shown();
  assert.ok(Math.abs(scale - 3) < 0.1, `${scale}`);
  let state = await page.evaluate(() => window.trueray.state);
  assert.equal(state.options, '', 'the eye has not moved');
  assert.equal(await page.evaluate(() => window.trueray.pixel), undefined, 'nor is it a click');
  await touch('touchStart', [x, y]);
  for (let way = 5; way <= 40; way += 5) await touch('touchMove', [x + way, y]);
  await touch('touchEnd');
  state = await settled(page, (state) => state.options !== '');
  assert.ok(state.eye[0] < -0.1, `${state.eye}`);
});

test('the camera is in the address', async () => {
  await settled(page);
  assert.equal(await page.evaluate(() => location.hash), '');
  const steps = await page.evaluate(() => history.length);
  await page.locator('#picture').focus();
  await page.keyboard.down('KeyD');
  await page.waitForFunction(() => window.trueray.state.eye[0] > 0.3);
  await page.keyboard.up('KeyD');
  await page.waitForFunction(() => location.hash.startsWith('#eye='));
  await page.waitForTimeout(300);
  const state = await settled(page);
  assert.equal(await page.evaluate(() => history.length), steps, 'the way back is as long as before');
  const expected = await pixels(page);
  const address = page.url();
  const other = await open(chromium, address);
  assert.equal((await settled(other, (newest) => newest.options === state.options)).eye[0], state.eye[0]);
  assertSame(await pixels(other), expected);
  await other.reload();
  await settled(other, (newest) => newest.options === state.options);
  assert.equal(other.url(), address);

  // Another address by hand is another view, and what is none is said.
  await other.evaluate(() => { location.hash = '#eye=1,2,3&look-at=0,0,-10&up=0,1,0'; });
  await settled(other, (newest) => newest.eye[1] === 2);
  await other.evaluate(() => { location.hash = '#eye=1,2&look-at=0,0,-10&up=0,1,0'; });
  await other.evaluate(() => { document.getElementById('effect-shadows').click(); });
  await settled(other, (newest) => newest.options.includes('--effects'));
  await other.evaluate(() => { location.hash = '#eye=1,1,1&look-at=1,1,1&up=0,1,0'; });
  await other.locator('#error', { hasText: 'the same point' }).waitFor();
  assert.deepEqual(other.problems, []);
  await other.close();
  await page.keyboard.press('KeyR');
  await page.waitForFunction(() => location.hash === '');
});

test('an address that names no view is said', async () => {
  const other = await open(chromium, `${server.url}#eye=here`);
  await other.locator('#error', { hasText: 'The address of this page names no view' }).waitFor();
  await other.close();
});

test('the page says where there is no picture yet, or an old one', async () => {
  // A server that answers nothing.
  const silent = await chromium.newPage({ viewport: { width: 390, height: 844 } });
  await silent.routeWebSocket(/ws$/, () => {});
  await silent.goto(server.url);
  await shows('none', /rendering the first picture/, silent);
  await screenshot('none-390', silent);
  await silent.close();

  await settled(page);
  await shows('full', /the full picture/);
  assert.equal(await page.locator('#status').getAttribute('aria-live'), 'polite');
  process.kill(server.pid, 'SIGSTOP');
  try {
    await page.locator('#effect-shadows').click();
    await shows('stale', /the picture before the change/);
    await page.waitForFunction(() => getComputedStyle(document.getElementById('picture')).opacity === '0.5');
    await screenshot('stale');
  } finally {
    process.kill(server.pid, 'SIGCONT');
  }
  await shows('full', /the full picture/);
  // What changes nothing is answered, too.
  await page.locator('#reset').click();
  await page.waitForTimeout(600);
  await shows('full', /the full picture/);

  // A full picture of an older view is none of the newest.
  const behind = await chromium.newPage();
  await behind.routeWebSocket(/ws$/, (socket) => {
    const line = socket.connectToServer();
    line.onMessage((message) => socket.send(typeof message === 'string' ? message.replace(/"heard":\d+/, '"heard":0') : message));
  });
  await behind.goto(server.url);
  await settled(behind);
  await shows('full', /the full picture/, behind);
  await behind.locator('#effect-shadows').click();
  await settled(behind, (state) => state.options.includes('--effects'));
  await behind.waitForTimeout(600);
  await shows('stale', /the picture before the change/, behind);
  await behind.close();

  const own = await view('scene.txt', { cwd: place.path });
  const other = await open(chromium, own.url);
  await settled(other);
  await own.stop();
  await shows('stale', /connection lost, trying again/, other);
  await other.close();
});

test('times are told as median and spread', async () => {
  await settled(page);
  await page.locator('#picture').focus();
  await page.keyboard.down('KeyD');
  await page.locator('#frame', { hasText: /^[\d.]+ ms, half of the last \d+ frames within [\d.]+–[\d.]+$/ }).waitFor();
  await page.keyboard.up('KeyD');
  assert.match(await page.locator('#stages').textContent(), /^render [\d.]+ \([\d.]+–[\d.]+\), prepare .*, compile .* ms$/);
  // Other settings, other times.
  await page.locator('#effect-shadows').click();
  await page.locator('#frame', { hasText: /^[\d.]+ ms$/ }).waitFor();
});

/** Contrast of two colours in words of CSS, as WCAG has it. */
function contrast(a, b) {
  const luminance = (color) => {
    const [red, green, blue] = /\d+, \d+, \d+/.exec(color)[0].split(', ').map((level) => level / 255)
      .map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4));
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
  };
  const [light, dark] = [luminance(a), luminance(b)].sort((x, y) => y - x);
  return (light + 0.05) / (dark + 0.05);
}

test('it is readable in both themes, on a phone and on a desk', async () => {
  await settled(page);
  await page.locator('#picture').click();
  await told();
  const grounds = {};
  for (const colorScheme of ['dark', 'light']) {
    await page.emulateMedia({ colorScheme });
    for (const [width, height] of [[390, 844], [1440, 900]]) {
      await page.setViewportSize({ width, height });
      assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), `${width}: wider than the window`);
      // The page is laid out anew in the frame after.
      await page.waitForFunction(() => {
        const [box, bar] = ['picture', 'bar'].map((id) => document.getElementById(id).getBoundingClientRect());
        return box.left >= 0 && box.right <= innerWidth && box.bottom <= bar.top;
      });
      await screenshot(`${colorScheme}-${width}`);
      await page.locator('#beside').scrollIntoViewIfNeeded();
      assert.ok(await page.locator('#beside').evaluate((grid) => grid.scrollWidth <= grid.clientWidth
        && grid.getBoundingClientRect().right <= innerWidth), `${width}: the table is cut`);
      await screenshot(`pixel-${colorScheme}-${width}`);
    }
    const colors = await page.evaluate(() => Object.fromEntries(['aside', 'dt', 'dd', 'h2', '#scale', 'button', '.cost', 'small', 'pre',
      '#beside th', '#beside td', '#beside .off', '#beside .words']
      .map((name) => [name, getComputedStyle(document.querySelector(name))]).map(([name, style]) => [name, [style.color, style.backgroundColor]])));
    const panel = colors.aside[1];
    for (const [name, [color, ground]] of Object.entries(colors)) {
      const on = /, 0\)$/.test(ground) ? panel : ground;
      assert.ok(contrast(color, on) >= 4.5, `${colorScheme}, ${name}: ${color} on ${on}`);
    }
    grounds[colorScheme] = panel;
  }
  assert.notEqual(grounds.dark, grounds.light);
});
