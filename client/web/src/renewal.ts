// A token that ends is renewed: where the page knows an address beside it that gives others.
const MOST_TOKEN = 512; // characters
const ASK_MS = 10_000;

// `address`: of the page's own origin, which gets its cookies; any other is not asked. Undefined: there is none, nobody
// answers with a token, or somebody has to log in again.
export async function renewedToken(address: string | null): Promise<string | undefined> {
  if (address === null) return undefined;
  try {
    const there = new URL(address, location.href);
    if (there.origin !== location.origin) return undefined;
    const answer = await fetch(there, {
      cache: 'no-store',
      credentials: 'same-origin',
      signal: AbortSignal.timeout(ASK_MS),
    });
    if (!answer.ok) return undefined;
    const token = (await answer.text()).trim();
    return token.length <= MOST_TOKEN && /^[\w-]+\.[\w-]+$/.test(token) ? token : undefined;
  } catch {
    return undefined;
  }
}
