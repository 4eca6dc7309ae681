// Times in lists as people say them: "14:20", "yesterday 16:40", "9 Nov 16:40", "9 Nov 2025".
import { language } from '../languages/index.js';
import { say } from './later_words.js';

const locale = language === 'en' ? 'en-GB' : language; // days before months

const dayMs = 86400000;
const midnight = (ms) => new Date(ms).setHours(0, 0, 0, 0);
const clockTime = (ms) => new Date(ms).toLocaleTimeString('sv', { hour: '2-digit', minute: '2-digit' });

/** "27 Nov", with the year when it is not this one. */
export function day(ms, now = Date.now()) {
  const isThisYear = new Date(ms).getFullYear() === new Date(now).getFullYear();
  return new Date(ms).toLocaleDateString(locale, { day: 'numeric', month: 'short', ...(isThisYear ? {} : { year: 'numeric' }) });
}

/** "stated by Anna Weiss, 27 Nov", of a patient's identity. @param {{by: string, time_ms: number}} said */
export const statedWords = ({ by, time_ms: ms }) => say.statedBy({ by, date: day(ms) });

/** When something was, as near as a list needs. */
export function when(ms, now = Date.now()) {
  const days = Math.round((midnight(now) - midnight(ms)) / dayMs);
  const time = clockTime(ms);
  if (days === 0) return time;
  if (days === 1) return say.yesterday({ time });
  return now - ms < 300 * dayMs ? `${day(ms, now)} ${time}` : day(ms, now);
}

/** The day of a DICOM date, "20261109": "9 Nov 2026"; '' where it is none. */
export const dicomDay = (date) =>
  /^\d{8}$/.test(date)
    ? new Date(Number(date.slice(0, 4)), Number(date.slice(4, 6)) - 1, Number(date.slice(6))).toLocaleDateString(locale, {
        day: 'numeric',
        month: 'short',
        year: 'numeric',
      })
    : '';

/** The name of a room: the given one, else that of its plan and its first day. @param {{name: string, created_at: string}} room @param {string} plan label or name of its plan */
export const roomName = (room, plan) => room.name || say.roomOfDay({ plan, day: day(Date.parse(room.created_at)) });
