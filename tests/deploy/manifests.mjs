// manifests.mjs FILE...: every object of these YAML files against Kubernetes' own schemas. The validators that
// kubernetes-models compiled from them find missing fields, wrong types and formats; its types for TypeScript find
// fields that do not exist.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import path from 'node:path';
import { parseAllDocuments } from 'yaml';

const here = import.meta.dirname ?? path.dirname(new URL(import.meta.url).pathname);
const mistakes = [];
const typed = [];
for (const file of process.argv.slice(2)) {
  for (const document of parseAllDocuments(readFileSync(file, 'utf8'))) {
    mistakes.push(...document.errors.map((error) => `${file}: ${error.message}`));
    const object = document.toJS();
    const name = `${object.kind} ${object.metadata?.name}`;
    const type = `kubernetes-models/${object.apiVersion}/${object.kind}`;
    let model;
    try {
      model = (await import(type))[object.kind];
    } catch {
      mistakes.push(`${name}: Kubernetes has no ${object.kind} in ${object.apiVersion}`);
      continue;
    }
    try {
      new model(object).validate();
    } catch (error) {
      mistakes.push(`${name}: ${error.message}`);
    }
    typed.push(
      `import type { I${object.kind} as T${typed.length} } from '${type}';`,
      `export const o${typed.length}: T${typed.length} = ${JSON.stringify(object, null, 1)};`,
    );
  }
}
if (typed.length === 0) mistakes.push('there is no object');

const folder = mkdtempSync(path.join(here, 'node_modules', '.manifests-'));
try {
  writeFileSync(path.join(folder, 'manifests.ts'), typed.join('\n') + '\n');
  const tsc = createRequire(import.meta.url).resolve('typescript/bin/tsc');
  const options = ['--noEmit', '--strict', '--skipLibCheck', '--module', 'nodenext'];
  execFileSync(process.execPath, [tsc, ...options, path.join(folder, 'manifests.ts')], { encoding: 'utf8' });
} catch (error) {
  mistakes.push(error.stdout || error.message);
} finally {
  rmSync(folder, { recursive: true });
}
for (const mistake of mistakes) console.error(mistake);
console.log(`${typed.length / 2} objects, ${mistakes.length} mistakes`);
process.exit(mistakes.length === 0 ? 0 : 1);
