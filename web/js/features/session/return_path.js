// The address that a sign-in leads back to. Pure.

/** A path of this server that may be told by anybody: no other server, no script, nothing that a browser reads as one. @param {string|null} text @returns {string} "/" for all that is not one */
export function ownPath(text) {
  const isPath = /^\/(?![/\\])[^\\\p{C}]*$/u.test(text ?? '');
  return isPath && new URL(text, 'http://own.invalid').origin === 'http://own.invalid' ? text : '/';
}
