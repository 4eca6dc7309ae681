// Facts of a room that a tab keeps over reloads: {member, secret} that it was, user: whose that is, the token of the link that lets it in, the plan, with which it goes on after the room.

/** @returns {object} the part of what is kept that is for this person. Of another one nothing is but a link that nobody came in by yet. @param {object} kept @param {string} user who is signed in, '' for nobody */
export function keptFor(kept, user) {
  const of = kept.user ?? (kept.isGuest ? '' : user);
  if (!user || of === user) return kept;
  return kept.isNew ? { link: kept.link, isNew: true } : {};
}

/** True where it has to be known who is signed in, before the room is opened with what is kept. */
export const isPersonal = ({ user, isGuest }) => Boolean(user || isGuest);
