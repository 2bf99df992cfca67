// What the browser tests share: the program, a browser, pictures.
import { spawn, execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { chromium } from 'playwright-core';

const root = join(dirname(fileURLToPath(import.meta.url)), '..', '..');
export const program = process.env.TRUERAY ?? join(root, 'target', 'release', 'trueray');

/** A folder of its own for a test; `remove` at the end. */
export function folder() {
  const path = mkdtempSync(join(tmpdir(), 'trueray-view-'));
  return { path, remove: () => rmSync(path, { recursive: true, force: true, maxRetries: 5 }) };
}

/** Starts `trueray view`; resolves with the page's address. */
export async function view(scene, { cwd, options = [] }) {
  const started = performance.now();
  const child = spawn(program, ['view', scene, ...options], {
    cwd, env: { ...process.env, NODEVICE_SELECT: '1' }, stdio: ['ignore', 'pipe', 'pipe'],
  });
  let errors = '';
  child.stderr.on('data', (data) => { errors += data; });
  const url = await new Promise((resolve, reject) => {
    let text = '';
    child.stdout.on('data', (data) => {
      text += data;
      if (text.includes('\n')) resolve(text.trim());
    });
    child.on('exit', (code) => reject(new Error(`trueray view ended with ${code}: ${errors}`)));
  });
  return {
    url, pid: child.pid, started, errors: () => errors, running: () => child.exitCode === null,
    stop: () => new Promise((resolve) => {
      if (child.exitCode !== null) return resolve();
      child.once('exit', resolve);
      child.kill();
    }),
  };
}

/** A browser with nothing in its profile, that asks nothing of other hosts. */
export async function browser() {
  const found = [process.env.CHROMIUM, '/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'];
  const executablePath = found.find((path) => path && existsSync(path));
  if (!executablePath) throw new Error('no Chromium; CHROMIUM=PATH names one');
  return chromium.launch({
    executablePath,
    args: ['--headless', '--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run',
      '--disable-background-networking', '--disable-component-update', '--disable-sync'],
  });
}

/** Opens the page; whatever goes wrong in it lands in `page.problems`. */
export async function open(browser, url, viewport = { width: 1300, height: 800 }) {
  const page = await browser.newPage({ viewport });
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(String(error)));
  page.on('console', (message) => { if (message.type() === 'error') page.problems.push(message.text()); });
  page.on('request', (request) => {
    if (!request.url().startsWith(url.split('#')[0]) && !/^(blob|data):/.test(request.url())) page.problems.push(`asks for ${request.url()}`);
  });
  await page.goto(url);
  return page;
}

/** Waits until the page shows the full picture of a state with the property. */
export async function settled(page, property = () => true) {
  // The page's policy forbids to hand it text as a function; the state comes after the pixels.
  const deadline = performance.now() + 60000;
  for (;;) {
    const state = await page.evaluate(() => window.trueray.state);
    if (state && state.finished && property(state)) return state;
    if (performance.now() > deadline) throw new Error(`never: ${property} in ${JSON.stringify(state)}`);
    await new Promise((resolve) => { setTimeout(resolve, 10); });
  }
}

/** The pixels that the page shows, 3 bytes each. */
export async function pixels(page) {
  const shown = await page.evaluate(() => {
    const canvas = document.getElementById('picture');
    const rgba = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
    let text = '';
    for (let i = 0; i < rgba.length; i += 4) text += String.fromCharCode(rgba[i], rgba[i + 1], rgba[i + 2]);
    return { width: canvas.width, height: canvas.height, rgb: btoa(text) };
  });
  return { ...shown, rgb: Buffer.from(shown.rgb, 'base64') };
}

/** What `trueray render` gives. */
export function rendered(cwd, scene, options = []) {
  const file = execFileSync(program, ['render', '-q', '--format', 'p6', ...options, scene, '-o', '-'],
    { cwd, maxBuffer: 1 << 30, env: { ...process.env, NODEVICE_SELECT: '1' } });
  const header = /^P6\n(\d+) (\d+)\n255\n/.exec(file.subarray(0, 40).toString('latin1'));
  return { width: Number(header[1]), height: Number(header[2]), rgb: file.subarray(header[0].length) };
}
