// Steps of one session in Chromium, each on what those before it have left.

import assert from 'node:assert/strict';
import {existsSync, writeFileSync} from 'node:fs';
import {join} from 'node:path';
import {test} from 'node:test';
import {kChromium} from './chromium.mjs';
import {kSupple} from './supple_view.mjs';

/// The part that these tests lack, or false; an error where they must run (SUPPLE_BROWSER_REQUIRED).
export const missing = !kChromium ? 'no chromium' : !existsSync(kSupple) ? `no ${kSupple}` : false;
if (process.env.SUPPLE_BROWSER_REQUIRED && missing) throw new Error(missing);

/// Makes the function step(name, run) of a session; `page` gives its page. After a failure the others are skipped,
/// since they would only repeat it.
export function stepsOf(page, timeout = 120000) {
  let failed = false;
  return (name, run) => test(name, {skip: missing, timeout}, async (t) => {
    if (failed) return t.skip('an earlier step failed');
    failed = true;
    await run(t);
    assert.deepEqual(page().errors, [], 'errors on the console');
    failed = false;
  });
}

/// Keeps what a page shows in the folder SUPPLE_KEEP, for people to look at.
export async function keep(page, name) {
  if (process.env.SUPPLE_KEEP) writeFileSync(join(process.env.SUPPLE_KEEP, name), await page.picture());
}
