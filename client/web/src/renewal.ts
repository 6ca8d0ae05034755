// A token that ends is renewed: where the page knows an address beside it that gives others.
const MOST_TOKEN = 512; // characters
const MOST_LINE = 300;
const MOST_PATH = 60; // of the address, where it is shown
const ASK_MS = 10_000;

// Or why there is none, in one line. `login`: somebody has to sign in again, which takes a page that is loaded.
export type Renewal = { token: string } | { refusal: 'login' | 'token'; text: string };

const SIGNED_OUT: Renewal = { refusal: 'login', text: 'Your sign-in has ended: load this page again to sign in.' };
const none = (text: string): Renewal => ({ refusal: 'token', text });

function ownAddress(address: string): URL | undefined {
  try {
    const there = new URL(address, location.href);
    return there.origin === location.origin ? there : undefined;
  } catch {
    return undefined;
  }
}

// `address`: of the page's own origin, which gets its cookies; any other is not asked. Undefined: there is none.
export async function renewal(address: string | null): Promise<Renewal | undefined> {
  if (address === null) return undefined;
  const there = ownAddress(address);
  if (!there) return none('The token has ended, and token_url is no address of this page’s own site.');
  const failed = `The token has ended, and ${there.pathname.slice(0, MOST_PATH)}`;
  try {
    const answer = await fetch(there, {
      cache: 'no-store',
      credentials: 'same-origin',
      redirect: 'manual', // it leads to where people sign in
      signal: AbortSignal.timeout(ASK_MS),
    });
    if (answer.type === 'opaqueredirect' || answer.status === 401) return SIGNED_OUT;
    const text = (await answer.text()).trim();
    if (answer.status === 403 && text && !text.startsWith('<'))
      return none(text.split('\n')[0]?.slice(0, MOST_LINE) ?? '');
    if (!answer.ok) return none(`${failed} gives no other: it answers ${answer.status}.`);
    const good = text.length <= MOST_TOKEN && /^[\w-]+\.[\w-]+$/.test(text);
    return good ? { token: text } : SIGNED_OUT; // a page to sign in at, most likely
  } catch {
    return none(`${failed} does not answer.`);
  }
}
