// The viewer's token, and what its role allows.
import { keptNames } from './address';
import { Role as WireRole } from './wire/brume/wire/role';

export type Role = 'viewer' | 'pusher' | 'controller' | 'presenter' | 'operator';

const ROLES: Record<number, Role> = {
  [WireRole.viewer]: 'viewer',
  [WireRole.pusher]: 'pusher',
  [WireRole.presenter]: 'presenter',
  [WireRole.controller]: 'controller',
  [WireRole.operator]: 'operator',
};

// A role that this page does not know counts as viewer.
export const roleOf = (role: number): Role => ROLES[role] ?? 'viewer';

const RANKS: readonly Role[] = ['viewer', 'pusher', 'controller', 'presenter', 'operator'];
export const atLeast = (role: Role, least: Role): boolean => RANKS.indexOf(role) >= RANKS.indexOf(least);
export const mayPush = (role: Role): boolean => role !== 'viewer';
export const mayControl = (role: Role): boolean => atLeast(role, 'controller');
export const mayOperate = (role: Role): boolean => role === 'operator';

// The token in a fragment such as '#token=abc'; undefined in any other.
export function tokenIn(fragment: string): string | undefined {
  return new URLSearchParams(fragment.replace(/^#/, '')).get('token') ?? undefined;
}

// For this tab, when it is loaded again.
export function keepToken(token: string): void {
  try {
    sessionStorage.setItem(keptNames('brume-token', location.pathname)[0], token);
  } catch {
    // Without storage the page renews it again.
  }
}

// The token of the page's address or, after a reload, of this tab. Browsers do not send a fragment, so no server logs
// it. It is removed from the address bar at once, so that nobody copies it with the address. A page without one
// has that of a page above it in the same tab: /r/NAME/ that of /.
export function takeToken(): string | undefined {
  const given = tokenIn(location.hash);
  const names = keptNames('brume-token', location.pathname);
  try {
    if (given !== undefined) sessionStorage.setItem(names[0], given);
    const kept = given ?? names.map((name) => sessionStorage.getItem(name)).find((token) => token !== null);
    return kept ? kept : undefined;
  } catch {
    return given; // without storage the token is lost when the page is loaded again
  } finally {
    if (given !== undefined) history.replaceState(history.state, '', location.pathname + location.search);
  }
}
