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
  await page.mouse.wheel(0, -100);
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
  assertSame(await pixels(page), good);
  if (process.env.SCREENSHOTS) await page.screenshot({ path: join(process.env.SCREENSHOTS, 'error.png') });
  writeFileSync(join(place.path, 'scene.txt'), SCENE);
  await error.waitFor({ state: 'hidden' });
  await settled(page);
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

  await page.locator('#measure').click();
  await page.locator('.cost', { hasText: /(costs|saves) / }).nth(6).waitFor({ timeout: 60000 });

  const [download] = await Promise.all([page.waitForEvent('download'), page.locator('#save').click()]);
  assert.equal(download.suggestedFilename(), 'scene.png');
  execFileSync(program, ['render', '-q', 'scene.txt', '-o', 'render.png'],
    { cwd: place.path, env: { ...process.env, NODEVICE_SELECT: '1' } });
  assert.ok(readFileSync(await download.path()).equals(readFileSync(join(place.path, 'render.png'))), 'the files differ');
  if (process.env.SCREENSHOTS) await page.screenshot({ path: join(process.env.SCREENSHOTS, 'page.png') });
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
