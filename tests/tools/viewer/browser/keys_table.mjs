// The keys of docs/viewer.md from the table that the page itself reads; `--write` renews them.

import {readFileSync, writeFileSync} from 'node:fs';
import {kBindings, kGestures, shownKeys} from '../../../../tools/viewer/page/bindings.js';

const kPage = new URL('../../../../docs/viewer.md', import.meta.url);
const kBegin = '<!-- keys of the viewer: node tests/tools/viewer/browser/keys_table.mjs --write -->\n';
const kEnd = '<!-- end of the keys -->\n';

export function keysTable() {
  const groups = [...new Set(kBindings.map(({group}) => group))];
  const tables = groups.map((group) => `| ${group} | |\n|---|---|\n` + kBindings.filter((b) => b.group === group)
    .map((binding) => `| ${shownKeys(binding).map((key) => '`' + key + '`').join(' ')} | ${binding.text} |\n`).join(''));
  return [...tables, '| Mouse and touch | |\n|---|---|\n' + kGestures.map(([what, text]) => `| ${what} | ${text} |\n`).join('')].join('\n');
}

/// The page with the table as it is, and as it should be.
export function documented() {
  const text = readFileSync(kPage, 'utf8');
  const [from, to] = [text.indexOf(kBegin), text.indexOf(kEnd)];
  if (from < 0 || to < from) throw new Error('docs/viewer.md has no place for the keys');
  return {text, wanted: text.slice(0, from + kBegin.length) + keysTable() + text.slice(to)};
}

if (process.argv[2] === '--write') writeFileSync(kPage, documented().wanted);
