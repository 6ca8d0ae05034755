// Who this viewer is to the server: its token, and what its role may do.
import { Role as WireRole } from './wire/brume/wire/role';

export type Role = 'viewer' | 'controller' | 'operator';

const ROLES: Record<number, Role> = {
  [WireRole.viewer]: 'viewer',
  [WireRole.controller]: 'controller',
  [WireRole.operator]: 'operator',
};

// One that this page does not know looks and does not touch.
export const roleOf = (role: number): Role => ROLES[role] ?? 'viewer';

export const mayControl = (role: Role): boolean => role !== 'viewer';
export const mayOperate = (role: Role): boolean => role === 'operator';

const KEY = 'brume-token';

// '#token=abc' says abc; any other fragment says nothing.
export function tokenIn(fragment: string): string | undefined {
  return new URLSearchParams(fragment.replace(/^#/, '')).get('token') ?? undefined;
}

// The token of the page's address or, after a reload, of this tab. A fragment is neither sent nor logged; it leaves the address bar
// at once, so that it is not copied with it.
export function takeToken(): string | undefined {
  const given = tokenIn(location.hash);
  try {
    if (given !== undefined) sessionStorage.setItem(KEY, given);
    const kept = given ?? sessionStorage.getItem(KEY) ?? undefined;
    return kept === '' ? undefined : kept;
  } catch {
    return given; // no storage: good until the page is loaded again
  } finally {
    if (given !== undefined) history.replaceState(history.state, '', location.pathname + location.search);
  }
}
