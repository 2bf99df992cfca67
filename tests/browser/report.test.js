// The pages of `trueray compare --report` and `trueray grade --html` in a real browser.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { browser, folder, open, program } from './support.js';

const SCENE = `NEAR 1
LEFT -1
RIGHT 1
BOTTOM -1
TOP 1
RES 120 80
SPHERE red 0 0 -10 2 4 2 0.5 0 0 1 1 0.9 0 50
SPHERE a-mirror-whose-name-is-longer-than-others 4 4 -10 1 2 1 0 0.5 0 1 1 0.9 0.4 50
LIGHT l 0 0 0 0.9 0.9 0.9
BACK 0.8 0.9 1
AMBIENT 0.2 0.2 0.2
`;

let chromium;
let place;

before(async () => {
  chromium = await browser();
  place = folder();
  const run = (...options) => {
    try {
      execFileSync(program, options, { cwd: place.path, stdio: 'ignore' });
    } catch (error) {
      assert.equal(error.status, 1, 'the pictures differ');
    }
  };
  for (const name of ['scenes', 'theirs', 'theirs/ann', 'theirs/bob']) mkdirSync(join(place.path, name));
  writeFileSync(join(place.path, 'scenes', 'two.txt'), SCENE);
  run('render', '-q', '--device', 'cpu', 'scenes/two.txt', '-o', 'theirs/ann/two.png');
  run('render', '-q', '--device', 'cpu', '--max-depth', '0', 'scenes/two.txt', '-o', 'theirs/bob/two.png');
  run('grade', '--device', 'cpu', '--scenes', 'scenes', '--theirs', 'theirs', '--html', 'grades.html');
});
after(async () => {
  await chromium?.close();
  place?.remove();
});

const url = (name) => `file://${join(place.path, name)}`;
const page = (name, viewport) => open(chromium, url(name), viewport);

test('nothing is cut off, in light and in dark', async () => {
  for (const name of ['grades.html', 'grades_files/001-ann-two.html', 'grades_files/002-bob-two.html']) {
    for (const width of [390, 1440]) {
      const shown = await page(name, { width, height: 900 });
      const papers = [];
      for (const colorScheme of ['light', 'dark']) {
        await shown.emulateMedia({ colorScheme });
        papers.push(await shown.evaluate(() => getComputedStyle(document.body).backgroundColor));
        const beyond = await shown.evaluate(() => [...document.querySelectorAll('body *')]
          .filter((part) => part.getBoundingClientRect().right > innerWidth + 1 && !part.closest('.wide'))
          .map((part) => part.outerHTML.slice(0, 80)));
        assert.deepEqual(beyond, [], `${name} at ${width}`);
      }
      assert.notEqual(papers[0], papers[1]);
      assert.deepEqual(shown.problems, []);
      await shown.close();
    }
  }
});

test('a row leads to its page, which the keyboard works', async () => {
  const shown = await page('grades.html');
  await shown.keyboard.press('Tab');
  await shown.keyboard.press('Tab');
  await shown.keyboard.press('Enter');
  await shown.waitForURL(url('grades_files/002-bob-two.html'));
  assert.equal(await shown.title(), 'two, bob');
  const visible = () => shown.evaluate(() => [...document.querySelectorAll('.stack img')]
    .filter((image) => getComputedStyle(image).visibility === 'visible').map((image) => image.className).join(' '));
  const split = () => shown.evaluate(() => getComputedStyle(document.querySelector('.stack .a')).clipPath);
  assert.equal(await visible(), 'b a');
  const half = await split();
  await shown.focus('input[type=range]');
  await shown.keyboard.press('ArrowRight');
  assert.notEqual(await split(), half);
  await shown.focus('input[value=slider]');
  await shown.keyboard.press('ArrowRight');
  await shown.waitForFunction(() => document.querySelector('.viewer').dataset.show === 'b');
  await shown.waitForFunction(() => document.querySelector('.viewer').dataset.show === 'a');
  for (const mode of ['a', 'b', 'heat']) {
    await shown.keyboard.press('ArrowRight');
    assert.equal(await visible(), mode);
  }
  assert.deepEqual(shown.problems.filter((problem) => !problem.startsWith('asks for file:')), []);
  await shown.close();
});
