import { proves } from './checks.mjs';

proves('Apache with mod_auth_openidc');
