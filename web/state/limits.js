/** Sizes that the core's schema allows. */

/** Controllers that a line can have in addition to the first. */
export const MAX_ADDITIONAL_CONTROLLERS = 31;
/** Channels that a bus can have. */
export const MAX_CHANNELS = 16;
