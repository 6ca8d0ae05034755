// Whether the server has another page than this one, and when this one is loaded again because of that.

// The files of a page by their addresses, as its markup or this document names them: with a hash of their content.
export const filesIn = (markup: string): string[] => [
  ...new Set([...markup.matchAll(/\b(?:src|href)="([^"#?]+\.(?:js|css))"/g)].map(([, file]) => file ?? '')),
];

// True: a page of ours that has other files. What is no page of ours says nothing: a proxy's error, an empty answer.
export function isOther(own: readonly string[], markup: string): boolean {
  if (!/<brume-view\b/.test(markup)) return false;
  const there = filesIn(markup);
  return there.length > 0 && [...there].sort().join() !== [...own].sort().join();
}

const FIRST_MS = 60_000; // between two loads that did not help
const LONGEST_MS = 3_600_000;

// What a tab remembers of loads that did not help.
export interface Reloads {
  count: number;
  at: number; // ms since 1970, of the last
}

// ms to wait before the next load: 0 after one that helped. A clock that was set back does not hold it up.
export function reloadWait({ count, at }: Reloads, now: number): number {
  if (count === 0) return 0;
  const since = now - at;
  const apart = Math.min(LONGEST_MS, FIRST_MS * 2 ** Math.min(count - 1, 10));
  return since < 0 ? 0 : Math.max(0, apart - since);
}

const KEY = 'brume-reloads';

function remembered(): Reloads {
  const { count, at } = JSON.parse(sessionStorage.getItem(KEY) ?? '{}') as Partial<Reloads>;
  return typeof count === 'number' && typeof at === 'number' ? { count, at } : { count: 0, at: 0 };
}

// Asks the server for its page, and loads it if it is another whose files are all there. Never more often than
// reloadWait() says; a browser that cannot remember never does it.
export async function loadIfOther(own: readonly string[], reload = (): void => location.reload()): Promise<void> {
  const ask = async (address: string): Promise<Response> => {
    const answer = await fetch(new URL(address, location.href), {
      cache: 'no-cache',
      signal: AbortSignal.timeout(10_000),
    });
    if (!answer.ok) throw new Error(`${address} is not there`);
    return answer;
  };
  try {
    const markup = await (await ask(location.pathname)).text();
    if (!isOther(own, markup)) {
      sessionStorage.removeItem(KEY); // the last one helped
      return;
    }
    const loads = remembered();
    const now = Date.now();
    if (reloadWait(loads, now) > 0) return;
    for (const file of filesIn(markup)) await (await ask(file)).arrayBuffer();
    sessionStorage.setItem(KEY, JSON.stringify({ count: loads.count + 1, at: now }));
    reload();
  } catch {
    // Nobody answers, half a page is there, or nothing can be remembered: this page goes on.
  }
}
