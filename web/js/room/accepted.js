// The acceptances of a room that count, by pair of parts. Pure; the rest is in fits.js, which most plans do not need.

export const pairKey = (thing, other) => [thing, other].sort().join(' ');

/** @param {Map<string, object>} rows of the room's items @param {string[]} counting ids @returns {Map<string, object>} rows by pair */
export const acceptedPairs = (rows, counting) =>
  new Map(
    counting
      .map((id) => rows.get(id))
      .filter(Boolean)
      .map((row) => [pairKey(row.body.thing, row.body.with), row]),
  );
