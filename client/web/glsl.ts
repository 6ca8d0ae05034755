// A vite plugin for shaders: `import text from '.../phase.h?glsl'` is the text of that header and of those that it
// includes, each once, as WebGL 2 takes it. So the page draws with the server's own formulas.
import { readFileSync } from 'node:fs';
import { dirname, resolve } from 'node:path';
import type { Plugin } from 'vite';

const QUERY = '?glsl';
const COMMENT = /[ \t]*\/\/.*$/gm;
// Nothing in such a part of a header is conditional again.
const FOR_CPP = /^#ifdef __cplusplus\n([^]*?)^#endif\n/gm;
const INCLUDE = /^#include "(.*)"$/gm;
// GLSL ES has constants in functions only of what is known when it compiles.
const CONSTANT = /^( +)const /gm;
const MARGIN = /^\s+/gm; // and blank lines

// `known`: files that are included already; those of this one are added.
export function glslOf(file: string, known = new Set<string>()): string {
  if (known.has(file)) return '';
  known.add(file);
  return readFileSync(file, 'utf8')
    .replace(COMMENT, '')
    .replace(FOR_CPP, (_, part: string) => part.split('#else\n')[1] ?? '')
    .replace(INCLUDE, (_, name: string) => glslOf(resolve(dirname(file), name), known))
    .replace(CONSTANT, '$1')
    .replace(MARGIN, '');
}

export const glsl = (): Plugin => ({
  name: 'glsl',
  load(id) {
    if (!id.endsWith(QUERY)) return null;
    const files = new Set<string>();
    const text = glslOf(id.slice(0, -QUERY.length), files);
    for (const file of files) this.addWatchFile(file);
    return `export default ${JSON.stringify(text)};`;
  },
});
