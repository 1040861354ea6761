//! STEP, DIR and EN of one channel (CONTROLLER G1.1, G4).
//!
//! ```text
//! EN    ─────────────┐         EN changes and a pulse is cut one cycle after their cause in c;
//! STEP  _┌──┐__┌─────┘____     so does the reset of DIR after power-off and restart
//!               c    c + 1
//! ```

const NEVER: u64 = u64::MAX;

#[derive(Clone, Debug)]
pub(crate) struct Pins {
    pub(crate) step: bool,
    pub(crate) dir: bool,
    pub(crate) en: bool,
    fall: u64,
    last_fall: Option<u64>,
    /// When DIR changes.
    turn: u64,
    next_en: bool,
    is_cut: bool,
    clears_dir: bool,
    /// When the effects in `next_en`, `is_cut` and `clears_dir` take place.
    pending: u64,
}

impl Pins {
    pub(crate) const fn new() -> Self {
        Self {
            step: false,
            dir: false,
            en: true,
            fall: NEVER,
            last_fall: None,
            turn: NEVER,
            next_en: true,
            is_cut: false,
            clears_dir: false,
            pending: NEVER,
        }
    }

    /// Keeps the driver off from cycle 0 on.
    pub(crate) const fn stay_off(&mut self) {
        (self.en, self.next_en) = (false, false);
    }

    pub(crate) fn apply_pending(&mut self, now: u64) {
        if self.pending > now {
            return;
        }
        self.pending = NEVER;
        self.en = self.next_en;
        if self.is_cut {
            (self.step, self.fall, self.last_fall) = (false, NEVER, Some(now));
        }
        if self.clears_dir {
            self.dir = false;
        }
        (self.is_cut, self.clears_dir) = (false, false);
    }

    pub(crate) const fn fall_and_turn(&mut self, now: u64) {
        if self.fall <= now {
            (self.step, self.fall, self.last_fall) = (false, NEVER, Some(now));
        }
        if self.turn <= now {
            self.dir = !self.dir;
            self.turn = NEVER;
        }
    }

    pub(crate) const fn rise(&mut self, now: u64, width: u64) {
        self.step = true;
        self.fall = now.saturating_add(width);
    }

    /// Sets the direction of a move. DIR changes if needed, at least `hold` cycles after the last fall.
    pub(crate) fn turn(&mut self, now: u64, right: bool, hold: u64) {
        self.turn = if right == self.dir {
            NEVER
        } else {
            let held = self.last_fall.map_or(0, |fall| fall.saturating_add(hold));
            held.max(now.saturating_add(1))
        };
    }

    /// Cancels a pending change of DIR.
    pub(crate) const fn keep_dir(&mut self) {
        self.turn = NEVER;
    }

    /// Sets EN to 0 and cuts a high pulse, both in the next cycle.
    pub(crate) const fn power_off(&mut self, now: u64) {
        self.is_cut = self.step;
        self.turn = NEVER;
        self.set_en(now, false);
    }

    pub(crate) const fn power_on(&mut self, now: u64) {
        self.set_en(now, true);
    }

    pub(crate) const fn clear_dir(&mut self, now: u64) {
        self.clears_dir = true;
        self.schedule(now);
    }

    const fn set_en(&mut self, now: u64, en: bool) {
        self.next_en = en;
        if self.is_cut || self.en != en {
            self.schedule(now);
        } else if !self.clears_dir {
            self.pending = NEVER;
        }
    }

    const fn schedule(&mut self, now: u64) {
        self.pending = now.saturating_add(1);
    }

    pub(crate) fn due(&self) -> u64 {
        self.fall.min(self.turn).min(self.pending)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cut_pulse_falls_in_the_next_cycle_and_the_hold_time_of_dir_begins() {
        let mut pins = Pins::new();
        pins.rise(10, 8);
        pins.power_off(12);
        assert!(pins.step && pins.en && pins.due() == 13);
        pins.apply_pending(13);
        assert!(!pins.step && !pins.en && pins.due() == NEVER);
        // Begin of a move, hold, change of DIR.
        for (now, hold, expected) in [(13, 0, 14), (13, 4, 17), (20, 4, 21)] {
            pins.turn(now, true, hold);
            assert_eq!(pins.due(), expected, "{now} {hold}");
        }
        pins.turn(20, false, 4);
        assert_eq!(pins.due(), NEVER, "DIR has its level already");
    }

    #[test]
    fn changes_reverted_in_the_same_cycle_have_no_effect() {
        let mut pins = Pins::new();
        pins.power_off(5);
        pins.power_on(5);
        assert_eq!(pins.due(), NEVER);
        pins.clear_dir(5);
        pins.power_on(5);
        assert_eq!(pins.due(), 6);
    }
}
