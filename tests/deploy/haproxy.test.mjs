import { proves } from './checks.mjs';

proves('HAProxy');
proves('HAProxy with http-reuse always');
