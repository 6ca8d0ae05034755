// A server's line with a full stop, and with a capital letter unless it begins with the name of a file or an option.
export function sentence(text: string): string {
  const isName = /^(-|\S*[./]\S)/.test(text);
  const first = isName ? text : text.charAt(0).toUpperCase() + text.slice(1);
  return /[.!?…]$/.test(first) ? first : `${first}.`;
}

// What is said while no tick comes. `why`: the server's own line.
export const standstillText = (why: string): string => sentence(`The scene stands still: ${why}`);
